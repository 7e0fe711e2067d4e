//! Names of the frames of a film, placed over surfaces that are drawn without anything else.

use super::options::PictureOptions;
use super::plan::{self, Pass, Plan};
use crate::{BelvedereError, Session};
use belvedere_composite::marks::{Marks, NameMemory, Patience};
use belvedere_composite::traced_marks::next_names;
use belvedere_overlay::furniture::with_distances;
use belvedere_scene::Progress;

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
    let view = plan::view(session, request);
    let plan = Plan::new(session, request, (session.scene(), view), progress)?;
    let depth = plan.draw(Pass::Depths)?.depth;
    plan.with(Pass::Marks, |job| next_names(job, &depth, (before, patience)))
}
