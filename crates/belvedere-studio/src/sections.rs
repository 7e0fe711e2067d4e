//! Edits of styling sections that need more than the presets: layers of their own.

use belvedere::core::presets::PresetDocument;
use belvedere::core::sections::TagPoint;
use belvedere::scene_file::{CityDoc, CityStyleDoc, Document, LayerDoc, PresetsDoc, StageDoc};

/// Name of sections that name no representation.
const UNNAMED: &str = "all";
/// Half width of the transitions between new sections, shares of the curve's length.
const DELTA: f64 = 0.05;
/// Colours of blocks, and of blocks between main streets: paler the more abstract.
const PALE: [[&str; 2]; 2] = [["#d9b08c", "#eee6d8"], ["#e2cfb4", "#f0e9dc"]];

/// The document with three sections in a preset of its spline, near to far: the buildings of a city, blocks between its streets, and blocks
/// between its main streets. Layers of the city that are missing are added behind it.
///
/// * `presets`: those that the spline shows; the document states them from now on. `chosen`: position of the preset.
///
/// # Errors
/// One sentence if there is no such city or preset.
pub fn with_levels(
    document: &Document,
    presets: &PresetDocument,
    chosen: usize,
    city: &str,
) -> Result<Document, String> {
    let mut next = document.clone();
    let found = next.layer.iter().position(|layer| layer.id() == city);
    let Some((at, LayerDoc::City(base))) = found.and_then(|at| Some((at, next.layer.get(at)?.clone()))) else {
        return Err(format!("there is no city {city}; choose a layer of kind city"));
    };
    let mut presets = presets.clone();
    let Some(preset) = presets.presets.get_mut(chosen) else { return Err(no_preset(chosen)) };
    let mut levels = Vec::new();
    for (loa, name) in ["buildings", "blocks", "main blocks"].into_iter().enumerate() {
        let known = next.layer.iter().find_map(|layer| match layer {
            LayerDoc::City(other) if usize::from(other.loa) == loa && other.source == base.source => Some(&other.id),
            _ => None,
        });
        let id = match known {
            Some(id) => id.clone(),
            None => {
                let id = free_id(&next, &format!("{city}, {name}"));
                let style = match loa.checked_sub(1).map(|i| PALE[i]) {
                    Some([roof, wall]) => {
                        CityStyleDoc { roof: roof.to_owned(), wall: wall.to_owned(), ..base.style.clone() }
                    }
                    None => base.style.clone(),
                };
                let layer =
                    CityDoc { id: id.clone(), loa: loa as u8, must_see: false, select: None, style, ..base.clone() };
                next.layer.insert(at + levels.len().max(1), LayerDoc::City(layer));
                id
            }
        };
        levels.push(id);
    }
    preset.tags = [1.0, 2.0].map(|i| TagPoint { u: i / 3.0, delta: DELTA }).to_vec();
    preset.sections = levels;
    state(&mut next, presets)?;
    Ok(next)
}

/// The document with a copy of a layer that only one section shows, so that it has a style of its own there; and the id of the copy.
///
/// * `presets`, `chosen`: as in [`with_levels`]. `section`: position of the section.
///
/// # Errors
/// One sentence if there is no such layer, preset or section.
pub fn with_own_style(
    document: &Document,
    presets: &PresetDocument,
    [chosen, section]: [usize; 2],
    layer: &str,
) -> Result<(Document, String), String> {
    let mut next = document.clone();
    let Some(at) = next.layer.iter().position(|other| other.id() == layer) else {
        return Err(format!("there is no layer {layer}; choose another one"));
    };
    let mut presets = presets.clone();
    let shown = presets.presets.get(chosen).ok_or_else(|| no_preset(chosen))?.sections.get(section).cloned();
    let shown = shown.ok_or_else(|| format!("there is no section {}; add one first", section + 1))?;
    let copy = free_id(&next, &format!("{layer}, section {}", section + 1));
    let own = renamed(&next.layer[at], &copy)?;
    next.layer.insert(at + 1, own);
    // A layer of no representation is shown everywhere, so the other sections name the original.
    for (i, preset) in presets.presets.iter_mut().enumerate() {
        for (j, name) in preset.sections.iter_mut().enumerate() {
            if [i, j] != [chosen, section] && name == UNNAMED {
                *name = layer.to_owned();
            }
        }
    }
    let members = next.representations.get(&shown).filter(|members| members.iter().any(|member| member == layer));
    let name = match members.cloned() {
        Some(members) => {
            let members = members.into_iter().map(|member| if member == layer { copy.clone() } else { member });
            let name = free_id(&next, &format!("{shown}, section {}", section + 1));
            next.representations.insert(name.clone(), members.collect());
            name
        }
        None => copy.clone(),
    };
    presets.presets[chosen].sections[section] = name;
    state(&mut next, presets)?;
    Ok((next, copy))
}

fn no_preset(chosen: usize) -> String {
    format!("there is no preset {}; choose another one", chosen + 1)
}

/// States presets in the spline of a document.
fn state(document: &mut Document, presets: PresetDocument) -> Result<(), String> {
    presets.validate().map_err(|e| e.to_string())?;
    let spline = document.stage.iter_mut().find_map(|stage| match stage {
        StageDoc::SplineBend(stage) => Some(stage),
        _ => None,
    });
    let stage = spline.ok_or("the scene has no spline; choose a preset first")?;
    stage.presets = PresetsDoc::Inline(Box::new(presets));
    Ok(())
}

/// A name that no layer and no representation has.
fn free_id(document: &Document, wanted: &str) -> String {
    let is_taken =
        |id: &str| document.representations.contains_key(id) || document.layer.iter().any(|layer| layer.id() == id);
    let numbered = (2..).map(|n| format!("{wanted} {n}"));
    std::iter::once(wanted.to_owned()).chain(numbered).find(|id| !is_taken(id)).unwrap_or_default()
}

/// A layer under another id.
fn renamed(layer: &LayerDoc, id: &str) -> Result<LayerDoc, String> {
    let mut copy = layer.with_must_see(false);
    *match &mut copy {
        LayerDoc::Terrain(l) => &mut l.id,
        LayerDoc::Line(l) => &mut l.id,
        LayerDoc::Area(l) => &mut l.id,
        LayerDoc::Point(l) => &mut l.id,
        LayerDoc::Boxes(l) => &mut l.id,
        LayerDoc::Mesh(l) => &mut l.id,
        LayerDoc::Molecule(l) => &mut l.id,
        LayerDoc::City(l) => &mut l.id,
        LayerDoc::Volume(l) => &mut l.id,
    } = id.to_owned();
    Ok(copy)
}

#[cfg(test)]
mod tests;
