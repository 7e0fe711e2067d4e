//! Composes the picture of the camera.

use super::subject::{CameraFigure, CameraPicture, DARK, Subject};
use super::{position, rays, spline, turns};
use belvedere_core::{PinholeError, Stage, View};
use belvedere_scene::{Overlay, Scene};
use belvedere_sight::trace::Tracer;

/// Draws the camera of a view of a scene.
///
/// * `reach`: depth at which rays end, scene units.
///
/// # Errors
/// [`PinholeError`] if eye and target of the figure are no camera.
pub fn figure(
    (scene, view): (&Scene, &View),
    reach: f64,
    picture: CameraPicture,
) -> Result<CameraFigure, PinholeError> {
    let tracer = Tracer::new(scene, view);
    let hits = rays::hits(view, &tracer);
    let far = if hits.is_empty() { reach } else { hits.iter().fold(0.0f64, |m, h| m.max(h.depth)).min(reach) * 1.02 };
    let bounds = scene.bounds();
    let extent = if bounds.is_empty() { far } else { (bounds.max - bounds.min).truncate().max_element() };
    let subject = Subject { view, tracer, far, extent };
    let mut overlay = Overlay::default();
    let mut legend = vec![(DARK, "eye and image".to_owned())];
    subject.eye(&mut overlay);
    rays::draw(&subject, &mut overlay, &mut legend);
    for stage in view.stages() {
        match stage {
            Stage::SplineBend(bend) => spline::draw(&subject, bend, &mut overlay, &mut legend),
            Stage::CurvedRays(rays) => {
                turns::draw(&subject, &[(rays, &rays::corners(view))], &mut overlay, &mut legend);
            }
            Stage::SplitRays(split) => {
                let ways: Vec<_> = split.branches().iter().map(|b| (&b.rays, b.region.corners())).collect();
                turns::draw(&subject, &ways, &mut overlay, &mut legend);
            }
            _ => {}
        }
    }
    let view = position::view((scene, view), picture, &overlay)?;
    Ok(CameraFigure { view, overlay, legend })
}
