//! Points of the world: what they lie in, where the window shows them, and their coordinates in words.

use crate::language::{fill, tr};
use crate::model::Model;
use belvedere::core::{DVec3, View};
use belvedere::scene::Unit;
use belvedere::scene_file::Document;
use eframe::egui::{Pos2, Rect, Vec2};
use std::borrow::Cow;
use std::sync::Arc;

/// Whether two documents have the same things in the same places.
pub(crate) fn has_same_layers(a: &Arc<Document>, b: &Arc<Document>) -> bool {
    Arc::ptr_eq(a, b) || (a.layer == b.layer && a.hidden == b.hidden && a.crs == b.crs)
}

/// Where the window shows points of the world.
pub(crate) struct Places<'m> {
    view: Cow<'m, View>,
    rect: Rect,
}

impl<'m> Places<'m> {
    /// * `rect`: where the picture is in the window. `None` before the first picture.
    pub(crate) fn of(rect: Rect, model: &'m Model) -> Option<Self> {
        let view = model.shown.as_ref()?.session.view();
        let view = if model.look.bent { Cow::Borrowed(view) } else { Cow::Owned(view.straightened()) };
        Some(Self { view, rect })
    }

    /// Position in the window at which the picture shows a point.
    pub(crate) fn at(&self, point: DVec3) -> Option<Pos2> {
        let at = self.view.project(point).ok()?.pixel;
        let [w, h] = self.view.pinhole().image.map(f64::from);
        let share = Vec2::new((at.x / w) as f32, (at.y / h) as f32);
        Some(self.rect.min + share * self.rect.size()).filter(|at| self.rect.contains(*at))
    }
}

/// Position in the window at which the picture shows one point; for several, see [`Places`].
pub(crate) fn image_of(point: DVec3, rect: Rect, model: &Model) -> Option<Pos2> {
    Places::of(rect, model)?.at(point)
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
