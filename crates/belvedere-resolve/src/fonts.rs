//! Fonts for names whose letters the embedded font lacks, and names that no font sets.

use super::loader::Loader;
use crate::BelvedereError;
use belvedere_composite::canvas::{Fonts, fonts_in};
use belvedere_core::{Warning, WarningKind};
use belvedere_document::{Paths, TextDoc};
use belvedere_io::{InputFile, IoError};
use belvedere_scene::{FontFile, Layer, LayerKind};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Largest font file that is read, bytes.
const MAX_BYTES: u64 = 64 << 20;
/// Most bytes of fonts of the system that are looked through.
const MAX_SEARCHED: u64 = 512 << 20;

/// The fonts that names of the layers need; notes names that none of them sets.
///
/// * `words`: further texts, such as the title.
pub(super) fn choose(
    loader: &mut Loader<'_>,
    layers: &[Option<Layer>],
    text: Option<&TextDoc>,
    words: &str,
) -> Result<Vec<FontFile>, BelvedereError> {
    let named: Vec<(usize, Vec<&str>)> = layers
        .iter()
        .enumerate()
        .filter_map(|(i, layer)| Some((i, names(&layer.as_ref()?.kind))))
        .filter(|(_, names)| !names.is_empty())
        .collect();
    let mut fonts = given(loader, text)?;
    // Names are many, their letters are few.
    let in_legend = layers.iter().flatten().filter_map(|layer| layer.kind.only_name());
    let all = named.iter().flat_map(|(_, names)| names.iter().copied()).chain(in_legend).chain([words]);
    let letters: String = all.flat_map(str::chars).collect::<BTreeSet<char>>().into_iter().collect();
    let mut lacking = Fonts::with(&fonts).lacks(&letters);
    if !lacking.is_empty() && text.is_none_or(|text| text.system_fonts) {
        fonts.extend(of_system(loader, lacking));
        lacking = Fonts::with(&fonts).lacks(&letters);
    }
    for (index, names) in named {
        loader.note(index, unset(&lacking, &names));
    }
    Ok(fonts)
}

/// Names that a layer writes.
fn names(kind: &LayerKind) -> Vec<&str> {
    match kind {
        LayerKind::Line(l) if l.label_px.is_some() => l.features.iter().map(|f| f.name.as_str()).collect(),
        LayerKind::Area(a) if a.label_px.is_some() => a.features.iter().map(|f| f.name.as_str()).collect(),
        LayerKind::Point(p) if p.style.label_px.is_some() => p.features.iter().map(|f| f.name.as_str()).collect(),
        _ => Vec::new(),
    }
}

/// Fonts of the options, then those of the scene.
fn given(loader: &mut Loader<'_>, text: Option<&TextDoc>) -> Result<Vec<FontFile>, BelvedereError> {
    let mut files = loader.options.fonts.clone();
    let of_scene = text.and_then(|text| text.fonts.as_ref()).map(Paths::as_slice).unwrap_or_default();
    for name in of_scene {
        let found = loader.roots.resolve(name);
        files.push(found.map_err(|e| loader.origin.refusal(&["text", "fonts"], "fonts: ", e))?);
    }
    let mut fonts = Vec::new();
    for path in files {
        let size = belvedere_io::fs::metadata(&path).map_err(|e| IoError::os(&path, e))?.len();
        if size > MAX_BYTES {
            let reason = format!("is a font of {} MiB, the limit is {}; choose another", size >> 20, MAX_BYTES >> 20);
            return Err(IoError::format(&path, reason).into());
        }
        let (bytes, record) = InputFile::read(&path)?;
        let count = fonts_in(&bytes, &BTreeSet::new(), false).len();
        let bytes = Arc::new(bytes);
        let faces = (0..count as u32).map(|index| FontFile { name: name_of(&path), bytes: bytes.clone(), index });
        let faces: Vec<FontFile> = faces.collect();
        if faces.is_empty() || Fonts::with(&faces).families().is_empty() {
            return Err(
                IoError::format(&path, "is no font; give a TrueType or OpenType file (.ttf, .otf, .ttc)").into()
            );
        }
        loader.inputs.push(record);
        fonts.extend(faces);
    }
    Ok(fonts)
}

/// Fonts of the system for letters, each with letters that those before lack: first those that set their scripts by rules.
fn of_system(loader: &mut Loader<'_>, mut lacking: BTreeSet<char>) -> Vec<FontFile> {
    let files = belvedere_io::system_fonts();
    let mut fonts = Vec::new();
    for shaped in [true, false] {
        let mut searched = 0;
        for path in &files {
            if lacking.is_empty() || loader.options.progress.is_cancelled() {
                break;
            }
            let Ok(size) = belvedere_io::fs::metadata(path).map(|meta| meta.len()) else { continue };
            if size > MAX_BYTES || searched + size > MAX_SEARCHED {
                continue;
            }
            searched += size;
            let Ok(bytes) = belvedere_io::fs::read(path) else { continue };
            let faces = fonts_in(&bytes, &lacking, shaped);
            let best = faces.into_iter().enumerate().rev().max_by_key(|(_, drawn)| drawn.len());
            let Some((index, drawn)) = best.filter(|(_, drawn)| !drawn.is_empty()) else { continue };
            lacking.retain(|letter| !drawn.contains(letter));
            loader.inputs.push(InputFile::of(path, &bytes));
            fonts.push(FontFile { name: name_of(path), bytes: Arc::new(bytes), index: index as u32 });
        }
    }
    fonts
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Warning with the number of names with letters that no font has, and the first of them.
fn unset(lacking: &BTreeSet<char>, names: &[&str]) -> Option<Warning> {
    let unset: Vec<&&str> = names.iter().filter(|name| name.chars().any(|c| lacking.contains(&c))).collect();
    let first = unset.first()?;
    let letters: String = first.chars().filter(|c| lacking.contains(c)).take(8).collect();
    let first: String = first.chars().take(40).collect();
    let what = format!(
        "names have letters that no font here sets, the first is \"{first}\" ({letters}); they stand as empty boxes; give a font with these letters: fonts under [text]"
    );
    Warning::counted(WarningKind::Ignored, unset.len(), &what).map(|said| said.settled_by("fonts"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_scripts_that_are_not_set_are_counted() {
        let of = |names: &[&str]| unset(&Fonts::default().lacks(&names.concat()), names);
        assert_eq!(of(&["Tälchen", "Эльбрус", "Όλυμπος", "", "a b"]), None);
        let said = of(&["Fuji", "富士山", "עין גדי"]).expect("said");
        assert!(said.text().starts_with("2 names") && said.text().contains("富士山"), "{said}");
        assert!(said.text().chars().count() < 400);
    }
}
