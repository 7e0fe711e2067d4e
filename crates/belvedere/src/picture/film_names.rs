//! Names of the frames of a film, placed over surfaces that are drawn without anything else.

use super::furniture;
use super::options::PictureOptions;
use crate::overlays::furniture::with_distances;
use crate::overlays::{grid, highlight, widths};
use crate::{BelvedereError, Session};
use belvedere_composite::marks::{Marks, NameMemory, Patience};
use belvedere_composite::traced_marks::next_names;
use belvedere_scene::{Progress, RenderJob, RenderOptions};

/// Whether the names of a film of a session can be placed beforehand: whether it has any, and every frame is one drawing of the scene.
pub(crate) fn are_placed(session: &Session, request: &PictureOptions) -> bool {
    let document = session.resolved.description.as_ref().map(|d| &d.source.document);
    let falls_back = document.and_then(|d| d.constructor.as_ref()).is_some_and(|c| !c.fallback.is_empty());
    let is_one = request.straight || (!falls_back && session.view().split_rays().is_none());
    let scene = with_distances(session.scene(), &session.resolved.furniture);
    request.camera.is_none() && is_one && Marks::are_named(&scene)
}

/// The names of a frame, each where it was in the frame before while it can stay there.
///
/// * `request`: how the frame is drawn, without names of its own; `before` and `patience` as of [`Marks::next_names`].
pub(crate) fn placed(
    session: &Session,
    request: &PictureOptions,
    (before, patience): (&NameMemory, Patience),
    progress: &Progress,
) -> Result<NameMemory, BelvedereError> {
    let view = if request.straight { session.view().straightened() } else { session.view().clone() };
    let wanted = &session.resolved.overlay;
    let (marks, heatmap) = highlight::chosen((&request.highlight, request.heatmap), wanted)?;
    let scene = with_distances(session.scene(), &session.resolved.furniture);
    let scene = &*widths::scaled(&scene, request.density);
    let mut options = RenderOptions { names: None, density: request.density, ..request.quality.clone() };
    options.max_bytes = session.bytes_for_picture(options.max_bytes);
    let surfaces = RenderOptions { samples: 1, exposures: 1, marks: false, ..options.clone() };
    let job = RenderJob { scene, view: &view, light: session.light(), options: &surfaces, progress };
    let depth = session.renderer(&request.renderer)?.render(&job)?.depth;
    let lines = grid::wanted(session.scene(), request.grid.or(grid::stated(wanted)));
    options.overlay.under.extend(lines.into_iter().map(|line| widths::line(line, request.density)));
    let furnished = furniture::plan(session, (session.scene(), &view), request, (!marks.is_empty(), heatmap));
    options.keep_clear = furnished.keep_clear;
    Ok(next_names(&RenderJob { options: &options, ..job }, &depth, (before, patience)))
}
