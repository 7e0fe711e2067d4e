//! Land cover of a terrain layer, from its file.

use super::loader::Loader;
use super::vectors;
use crate::BelvedereError;
use belvedere_document::TerrainDoc;
use belvedere_io::land_cover::{land_cover_of_areas, load_land_cover};
use belvedere_io::{Arrays, Known, formats::Reader};
use belvedere_scene::{CoverMap, Crs, Heightfield};
use std::sync::Arc;

/// The land cover that a terrain layer states; `None` if it states none, or if its style shows no materials.
pub(super) fn load(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &TerrainDoc,
    ground: &Heightfield,
    crs: Crs,
) -> Result<Option<Arc<CoverMap>>, BelvedereError> {
    let Some(paths) = doc.land_cover.as_ref().filter(|_| doc.style.materials) else { return Ok(None) };
    let files = loader.files(index, "land_cover", paths)?;
    let mut all: Vec<CoverMap> = Vec::new();
    for file in &files {
        let known = Known::of(file, &Arrays::default()).map_err(|e| loader.fail(index, "land_cover", e))?;
        let loaded = match known.reader {
            Some(Reader::Features | Reader::City) => {
                let read = vectors::read(file, &loader.options.arrays);
                let read = read.map_err(|e| loader.fail(index, "land_cover", e))?;
                let areas = loader.take(index, read);
                land_cover_of_areas(&areas, crs, ground)
            }
            _ => load_land_cover(file, crs, ground, loader.options.limits(), &loader.options.progress),
        };
        let loaded = loaded.map_err(|e| loader.fail(index, "land_cover", e))?;
        all.push(loader.take(index, loaded));
    }
    let Some(first) = all.first() else { return Ok(None) };
    let mut land = first.clone();
    for later in &all[1..] {
        land.add(later);
    }
    Ok(Some(Arc::new(land)))
}
