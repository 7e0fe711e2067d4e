//! Terrain from files and arrays.

use super::loader::Loader;
use crate::BelvedereError;
use belvedere_document::{TerrainDoc, VerticalUnit};
use belvedere_io::terrain::{CrsChoice, TerrainRequest, load_original, load_terrain};
use belvedere_scene::{Crs, Heightfield};

/// The heights and their coordinate system.
pub(super) fn load(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &TerrainDoc,
    wanted: Option<Crs>,
) -> Result<(Heightfield, Crs), BelvedereError> {
    let files = loader.sources_or_folders(index, &doc.source)?;
    let crs = match wanted {
        None => CrsChoice::Auto,
        Some(Crs::Epsg(code)) => CrsChoice::Epsg(code),
        Some(Crs::Local) => CrsChoice::Local,
    };
    let source_crs = match &doc.source_crs {
        None => None,
        Some(text) => Some(super::ground::epsg(text).ok_or_else(|| {
            loader.fail(index, "source_crs", format!("source_crs \"{text}\" is not known; give \"EPSG:n\""))
        })?),
    };
    let request = TerrainRequest {
        crs,
        fill_voids: doc.fill_voids,
        largest_hole: doc.largest_hole.unwrap_or(1.0),
        source_crs,
        nodata: doc.nodata,
        vertical_unit_m: doc.vertical_unit.map(VerticalUnit::metres),
        sea: doc.style.sea,
        arrays: loader.options.arrays.clone(),
        limits: loader.options.limits(),
        ..TerrainRequest::default()
    };
    let progress = &loader.options.progress;
    let loaded = match &files[..] {
        [file] if loader.keep_original => {
            let original = load_original(file, &request, progress)?;
            let loaded = original.value.in_scene(&request, progress)?;
            loader.original = Some(loader.take(index, original));
            loaded
        }
        files => load_terrain(files, &request, progress)?,
    };
    let terrain = loader.take(index, loaded);
    Ok((terrain.heightfield, terrain.crs))
}
