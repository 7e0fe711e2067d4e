//! The shapes of a picture whose marks become vectors.

use super::options::PictureOptions;
use crate::print::REFERENCE_DPI;
use crate::vectors::{VectorContent, VectorPicture, areas, tolerance_px};
use crate::{BelvedereError, Session};
use belvedere_composite::sections::Sections;
use belvedere_cpu::mark_shapes;
use belvedere_scene::{Frame, RenderJob};

/// Refuses pictures whose marks cannot be told as shapes.
pub(super) fn check(session: &Session, request: &PictureOptions) -> Result<(), BelvedereError> {
    let refused = [
        (request.camera.is_some(), "pictures of the camera"),
        (!request.straight && session.view().split_rays().is_some(), "views whose rays part"),
    ];
    match refused.into_iter().find(|(is, _)| *is) {
        Some((_, what)) => Err(BelvedereError::NoVectors(what)),
        None => Ok(()),
    }
}

/// Marks and areas of a job over its drawn surfaces.
///
/// * `job`: with its marks; `frame`: without them, with world points.
pub(super) fn of_marks(job: &RenderJob<'_>, frame: &Frame, request: &PictureOptions) -> VectorPicture {
    let tolerance = tolerance_px(request.print.map_or(REFERENCE_DPI, |sheet| sheet.dpi));
    // Sections of a style may hide areas in part.
    let whole = Sections::new(job).is_none();
    VectorPicture {
        marks: mark_shapes(job, &frame.depth),
        areas: if whole { areas((job.scene, job.view), frame, tolerance) } else { Vec::new() },
        furniture: Vec::new(),
        layers: job.scene.layers.iter().map(|layer| layer.id.clone()).collect(),
        over_raster: request.vectors == VectorContent::OverRaster,
    }
}
