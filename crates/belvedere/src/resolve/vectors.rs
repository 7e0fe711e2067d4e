//! Lines, areas, points and pictures from files, laid on the terrain.

use super::Ground;
use super::layers::Loader;
use crate::BelvedereError;
use belvedere_core::Aabb;
use belvedere_scene::{AreaFeature, Crs, Drape, LineFeature, PointFeature};
use std::path::{Path, PathBuf};

fn not_yet(loader: &Loader<'_>, index: usize) -> BelvedereError {
    loader.fail(index, "source", "files of this kind cannot be read by this version yet")
}

/// Lines of files, draped.
pub(super) fn lines(
    loader: &mut Loader<'_>,
    index: usize,
    _files: &[PathBuf],
    _ground: &Ground<'_>,
) -> Result<Vec<LineFeature>, BelvedereError> {
    Err(not_yet(loader, index))
}

/// Areas of files, clipped.
pub(super) fn areas(
    loader: &mut Loader<'_>,
    index: usize,
    _files: &[PathBuf],
    _ground: &Ground<'_>,
) -> Result<Vec<AreaFeature>, BelvedereError> {
    Err(not_yet(loader, index))
}

/// Points of files, on the ground.
pub(super) fn points(
    loader: &mut Loader<'_>,
    index: usize,
    _files: &[PathBuf],
    _ground: &Ground<'_>,
) -> Result<Vec<PointFeature>, BelvedereError> {
    Err(not_yet(loader, index))
}

/// A georeferenced picture.
pub(super) fn drape(
    loader: &mut Loader<'_>,
    index: usize,
    _file: &Path,
    _crs: Crs,
    _bounds: Option<Aabb>,
) -> Result<Drape, BelvedereError> {
    Err(not_yet(loader, index))
}
