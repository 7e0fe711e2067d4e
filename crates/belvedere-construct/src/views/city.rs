//! Views of something in a city: oblique, filling the frame, from outside of all buildings.

use super::models::fitted;
use crate::ConstructError;
use crate::rays::{Target, TargetSight};
use belvedere_core::{Aabb, DVec3, View};
use belvedere_scene::{LayerKind, OwnLayer, Scene};
use rayon::prelude::*;

/// Headings, degrees clockwise from north, those along the light first.
const HEADINGS: [f64; 12] = [30.0, 330.0, 60.0, 300.0, 0.0, 90.0, 270.0, 120.0, 240.0, 150.0, 210.0, 180.0];
/// Pitches, degrees, and the visible share that a steep one must gain.
const PITCHES: [(f64, f64); 4] = [(30.0, 0.0), (40.0, 0.01), (52.0, 0.03), (68.0, 0.12)];
/// The same for the last of the headings.
const WORTH: f64 = 0.03;
/// Views for which bends are searched, at most.
const KEPT: usize = 4;
/// Factors by which routes and buildings are widened, so that they end within the frame and have surroundings.
const MARGINS: [f64; 2] = [1.12, 1.45];
/// Least distance around a building, metres.
const AROUND_M: f64 = 3.0;
/// Distance of the eye from buildings, and height over terrain, at least, metres.
const CLEAR_M: f64 = 4.0;

/// Points that the picture is to hold.
pub fn city_region(target: &Target) -> Vec<DVec3> {
    let center = target.center();
    let is_solid = !target.own_layers.is_empty() || target.own_parts.is_some();
    let factor = MARGINS[usize::from(is_solid)];
    let wide = |p: &DVec3| {
        let off = *p - center;
        center + factor * off + if is_solid { AROUND_M * off.normalize_or_zero() } else { DVec3::ZERO }
    };
    target.points.iter().map(wide).collect()
}

/// The views that are worth a search for bends, the best first; only one if it shows the whole target.
///
/// * `lens`: size of the picture, pixels, and full vertical field of view, radians; `most`: number of views at most; `None` = 4.
///
/// # Errors
/// [`ConstructError::NoRoom`] if no eye has room.
pub fn around_in_city(
    (scene, sight): (&Scene, &TargetSight<'_>),
    target: &Target,
    lens: ([u32; 2], f64),
    most: Option<usize>,
) -> Result<Vec<View>, ConstructError> {
    let points = city_region(target);
    let mut views = Vec::new();
    for (pitch, price) in PITCHES {
        for (k, heading) in HEADINGS.into_iter().enumerate() {
            let ((sin, cos), (down, ahead)) = (heading.to_radians().sin_cos(), f64::to_radians(pitch).sin_cos());
            let forward = DVec3::new(ahead * sin, ahead * cos, -down);
            let price = price + WORTH * k as f64 / HEADINGS.len() as f64;
            views.push((price, View::straight(fitted(&points, target, (forward, DVec3::Z), lens)?)));
        }
    }
    let judged = views
        .into_par_iter()
        .filter(|(_, view)| has_room(scene, view.pinhole().eye))
        .map(|(price, view)| (sight.share(&view, 0.0) - price, view));
    let mut judged: Vec<(f64, View)> = judged.collect();
    judged.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<View> = Vec::new();
    for (_, view) in judged {
        // Views from the same side are alike.
        let ahead = view.pinhole().forward;
        if kept.iter().all(|k| k.pinhole().forward.truncate().angle_to(ahead.truncate()).abs() > 0.4) {
            kept.push(view);
        }
    }
    kept.truncate(most.unwrap_or(KEPT));
    match kept.is_empty() {
        true => Err(ConstructError::NoRoom),
        false => Ok(kept),
    }
}

/// Whether an eye stands outside of everything and above the ground.
fn has_room(scene: &Scene, eye: DVec3) -> bool {
    let above = scene.terrain().and_then(|t| t.surface_at(eye.truncate())).is_none_or(|z| eye.z > z + CLEAR_M);
    let clear = |kind: &LayerKind| match kind {
        LayerKind::Mesh(layer) | LayerKind::Own(OwnLayer { surface: layer, .. }) => {
            let mesh = &layer.mesh;
            let near = |t: usize| {
                let bounds = Aabb::of(mesh.corners(t));
                (eye - eye.clamp(bounds.min, bounds.max)).length() < CLEAR_M
            };
            !(0..mesh.triangles().len()).any(near)
        }
        _ => true,
    };
    above && scene.layers.iter().all(|layer| clear(&layer.kind))
}
