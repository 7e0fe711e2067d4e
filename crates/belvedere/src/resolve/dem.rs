//! Terrain from files.

use super::layers::Loader;
use crate::BelvedereError;
use crate::scene_file::TerrainDoc;
use belvedere_scene::{Crs, Heightfield};

/// The heights and the coordinate system they bring.
pub(super) fn load(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &TerrainDoc,
    _wanted: Option<Crs>,
) -> Result<(Heightfield, Crs), BelvedereError> {
    loader.files(index, "source", &doc.source)?;
    Err(loader.fail(index, "source", "terrain files cannot be read by this version yet"))
}
