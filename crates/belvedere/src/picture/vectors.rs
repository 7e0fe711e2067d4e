//! The shapes of a picture whose marks become vectors.

use super::options::PictureOptions;
use crate::print::REFERENCE_DPI;
use crate::scene_file::LayerDoc;
use crate::vectors::{VectorContent, VectorPicture, areas, is_blank, tolerance_px};
use crate::{BelvedereError, Session};
use belvedere_composite::traced_marks::mark_shapes;
use belvedere_core::plain::escaped;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Frame, Layer, LayerKind, RenderJob};
use belvedere_sight::sections::Sections;

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

/// Layers that a text names at most.
const NAMED: usize = 4;

/// The warning about layers that no vector draws, counted; the ground is left out of vectors on purpose and not counted.
///
/// * `has_more`: whether a grid or furniture is drawn beside the layers.
///
/// # Errors
/// [`BelvedereError::NothingAsVectors`] where nothing else is in the scene.
pub(super) fn left_out(session: &Session, has_more: bool) -> Result<Option<Warning>, BelvedereError> {
    let scene = session.scene();
    let has_ground = scene.terrain().is_some();
    // Sections of a style may hide areas in part.
    let whole = scene.representations.is_empty();
    let is_drawn = |kind: &LayerKind| match kind {
        LayerKind::Line(_) | LayerKind::Point(_) => true,
        LayerKind::Area(area) => area.outline.is_some() || has_ground && whole,
        LayerKind::Molecule(molecule) => molecule.label_px.is_some(),
        LayerKind::Terrain(_) | LayerKind::Boxes(_) | LayerKind::Mesh(_) | LayerKind::Own(_) | LayerKind::Volume(_) => {
            false
        }
    };
    let left: Vec<&Layer> = scene.layers.iter().filter(|layer| !is_drawn(&layer.kind)).collect();
    if left.len() == scene.layers.len() && !has_more {
        return Err(BelvedereError::NothingAsVectors { layers: named(session, &left) });
    }
    let left: Vec<&Layer> = left.into_iter().filter(|layer| layer.kind.terrain().is_none()).collect();
    Ok((!left.is_empty()).then(|| {
        let (count, layers) = (left.len(), if left.len() == 1 { "layer has" } else { "layers have" });
        let text = format!("{count} {layers} no vectors and is left out: {}", named(session, &left));
        Warning::new(WarningKind::Ignored, text).with("count", count as f64)
    }))
}

/// Layers in words, each with its kind.
fn named(session: &Session, layers: &[&Layer]) -> String {
    let documents = session.resolved().map_or(&[][..], |document| &document.layer);
    // A city is a mesh in the scene.
    let stated = |layer: &Layer| documents.iter().find(|other| other.id() == layer.id).map(LayerDoc::kind);
    let kind = |layer: &Layer| stated(layer).unwrap_or_else(|| layer.kind.name());
    let mut words: Vec<String> =
        layers.iter().take(NAMED).map(|layer| format!("{} ({})", escaped(&layer.id), kind(layer))).collect();
    if layers.len() > NAMED {
        words.push(format!("{} more", layers.len() - NAMED));
    }
    words.join(", ")
}

/// Whether the vectors show nothing of the scene.
pub(super) fn is_empty(vectors: &VectorPicture) -> bool {
    let marks = &vectors.marks;
    vectors.areas.is_empty() && marks.names.is_empty() && is_blank(&marks.under) && is_blank(&marks.layers)
}

/// The warning about vectors of which nothing lies in the picture.
pub(super) fn blank(vectors: &VectorPicture) -> Option<Warning> {
    (is_empty(vectors) && !vectors.over_raster).then(|| {
        let text = "no line, area, point or name of the scene is seen in the picture, and no vector draws one; look at it from elsewhere";
        Warning::new(WarningKind::Hidden, text)
    })
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
