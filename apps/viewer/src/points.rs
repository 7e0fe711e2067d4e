//! Points of the world: what they lie in, where the window shows them, and their coordinates in words.

use crate::language::{fill, tr};
use crate::model::Model;
use belvedere::core::DVec3;
use belvedere::scene::Unit;
use belvedere::scene_file::Document;
use eframe::egui::{Pos2, Rect, Vec2};
use std::sync::Arc;

/// Whether two documents have the same things in the same places.
pub(crate) fn has_same_layers(a: &Arc<Document>, b: &Arc<Document>) -> bool {
    Arc::ptr_eq(a, b) || (a.layer == b.layer && a.hidden == b.hidden && a.crs == b.crs)
}

/// Position in the window at which the picture shows a world point.
pub(crate) fn image_of(point: DVec3, rect: Rect, model: &Model) -> Option<Pos2> {
    let shown = model.shown.as_ref()?;
    let view = if model.look.bent { shown.session.view().clone() } else { shown.session.view().straightened() };
    let at = view.project(point).ok()?.pixel;
    let [w, h] = view.pinhole().image.map(f64::from);
    let share = Vec2::new((at.x / w) as f32, (at.y / h) as f32);
    Some(rect.min + share * rect.size()).filter(|at| rect.contains(*at))
}

/// Position and height in the scene's own system.
pub(crate) fn coordinates(point: DVec3, unit: Unit) -> String {
    match unit {
        Unit::Metre => {
            let [e, n, height] = point.to_array().map(|value| format!("{value:.0}"));
            fill(tr("E {0}  N {1}  height {2} m"), &[&e, &n, &height])
        }
        _ => format!("x {:.2}  y {:.2}  z {:.2}", point.x, point.y, point.z),
    }
}
