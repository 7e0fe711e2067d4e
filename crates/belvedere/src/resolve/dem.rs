//! Terrain from files.

use super::layers::Loader;
use crate::BelvedereError;
use crate::scene_file::TerrainDoc;
use belvedere_io::terrain::{CrsChoice, TerrainRequest, load_terrain};
use belvedere_scene::{Crs, Heightfield};

/// The heights and the coordinate system they bring.
pub(super) fn load(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &TerrainDoc,
    wanted: Option<Crs>,
) -> Result<(Heightfield, Crs), BelvedereError> {
    let files = loader.files(index, "source", &doc.source)?;
    let crs = match wanted {
        None => CrsChoice::Auto,
        Some(Crs::Epsg(code)) => CrsChoice::Epsg(code),
        Some(Crs::Local) => CrsChoice::Local,
    };
    let source_crs = match &doc.source_crs {
        None => None,
        Some(text) => Some(super::epsg(text).ok_or_else(|| {
            loader.fail(index, "source_crs", format!("source_crs \"{text}\" is not known; give \"EPSG:n\""))
        })?),
    };
    let request = TerrainRequest {
        crs,
        fill_voids: doc.fill_voids,
        largest_hole: doc.largest_hole.unwrap_or(1.0),
        source_crs,
        nodata: doc.nodata,
        limits: loader.options.limits(),
        ..TerrainRequest::default()
    };
    let loaded = load_terrain(&files, &request, &loader.options.progress)?;
    loader.note(index, loaded.warnings);
    Ok((loaded.value.heightfield, loaded.value.crs))
}
