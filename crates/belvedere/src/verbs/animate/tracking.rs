//! Bends of target tracking, planned over all frames of a film before the first is drawn.

use crate::camera_path::CameraPath;
use crate::{BelvedereError, Session};
use belvedere_construct::rays::{FilmPlanner, PlannedBend};
use belvedere_resolve::constructor;
use belvedere_scene::Progress;

/// The bend of every frame: to the left and right where that shows the whole target throughout, else also up and diagonally.
/// Empty without target tracking.
pub(super) fn plan(
    session: &Session,
    path: &CameraPath,
    progress: &Progress,
) -> Result<Vec<PlannedBend>, BelvedereError> {
    if !session.resolved.description.as_ref().is_some_and(|d| constructor::tracks_target(&d.source)) {
        return Ok(Vec::new());
    }
    let mut planner = None;
    loop {
        pass(session, path, &mut planner, progress)?;
        if !planner.as_mut().is_some_and(FilmPlanner::wants_more) {
            return Ok(planner.map_or_else(Vec::new, FilmPlanner::finish));
        }
    }
}

fn pass(
    session: &Session,
    path: &CameraPath,
    planner: &mut Option<FilmPlanner>,
    progress: &Progress,
) -> Result<(), BelvedereError> {
    for frame in 0..path.len() {
        progress.tick("planning how the target stays in sight", frame as f64 / path.len() as f64)?;
        let framed = path.session(session, frame, None)?;
        if let Some(description) = &framed.resolved.description {
            let (scene, base) = (framed.scene(), framed.view());
            constructor::plan_frame(&description.source, scene, base, 1.0 / path.fps, planner)?;
        }
    }
    Ok(())
}
