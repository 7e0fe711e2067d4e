//! From the stages of a document to displacements.

use super::Ground;
use super::camera::ResolvedCamera;
use crate::BelvedereError;
use crate::scene_file::paths::Roots;
use crate::scene_file::{SourceDocument, StageDoc};
use belvedere_core::{DVec3, Stage};
use std::path::PathBuf;

/// Normal of the reference plane of the first spline stage.
pub(super) fn plane_normal(source: &SourceDocument) -> Option<DVec3> {
    source.document.stage.iter().find_map(|stage| match stage {
        StageDoc::SplineBend(spline) => Some(spline.plane.as_ref().map_or(DVec3::Z, |p| DVec3::from_array(p.normal))),
        _ => None,
    })
}

/// The stages and their documents with every rule replaced by its value.
pub(super) fn resolve(
    source: &SourceDocument,
    _roots: &Roots,
    _ground: &Ground<'_>,
    _camera: &ResolvedCamera,
    _inputs: &mut [PathBuf],
    _warnings: &mut [String],
) -> Result<(Vec<Stage>, Vec<StageDoc>), BelvedereError> {
    if let Some((i, stage)) = source.document.stage.iter().enumerate().next() {
        return Err(source.error(
            &["stage", &i.to_string()],
            format!("stage {} cannot be resolved by this version yet; remove it", stage.kind()),
        ));
    }
    Ok((Vec::new(), Vec::new()))
}
