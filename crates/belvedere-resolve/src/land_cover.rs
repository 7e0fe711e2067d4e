//! Land cover of a terrain layer, from its file.

use super::loader::Loader;
use super::vectors;
use crate::BelvedereError;
use belvedere_core::{Warning, WarningKind};
use belvedere_document::{Paths, TerrainDoc};
use belvedere_io::land_cover::{land_cover_of_areas, load_land_cover};
use belvedere_io::{Arrays, Known, formats::Reader};
use belvedere_scene::{CoverMap, Crs, Heightfield, Palette, PaletteName};
use std::sync::Arc;

/// The land cover that a terrain layer states; `None` if it states none, and with a warning if its style shows no materials.
///
/// * `palette`: that of the style.
pub(super) fn load(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &TerrainDoc,
    palette: &Palette,
    ground: &Heightfield,
    crs: Crs,
) -> Result<Option<Arc<CoverMap>>, BelvedereError> {
    let Some(paths) = &doc.land_cover else { return Ok(None) };
    if let Some(unshown) = unshown(paths, doc.style.materials, palette) {
        loader.note(index, [unshown]);
        return Ok(None);
    }
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

/// The warning that a style shows no land cover, if that is so.
fn unshown(paths: &Paths, materials: bool, palette: &Palette) -> Option<Warning> {
    let tint = match palette {
        Palette::Ramp(_) => Some("that of its file".to_owned()),
        Palette::Named(name) | Palette::Placed(name, ..) if !name.has_materials() => {
            PaletteName::ALL.iter().find(|(_, known)| known == name).map(|(word, _)| format!("\"{word}\""))
        }
        _ => None,
    };
    let (why, key) = match tint {
        Some(tint) => {
            let remedy = "give one of the palettes auto, swiss, winter and autumn";
            (format!("the palette, {tint}, colours by height alone; {remedy}, or leave the land cover out"), "palette")
        }
        None if materials => return None,
        None => {
            ("the ground is drawn without materials; leave materials = false or the land cover out".into(), "materials")
        }
    };
    let files = match paths.as_slice() {
        [one] => format!("the land cover {one}"),
        several => format!("the land cover in {} files", several.len()),
    };
    Some(Warning::new(WarningKind::Ignored, format!("{files} is not drawn, because {why}")).settled_by(key))
}
