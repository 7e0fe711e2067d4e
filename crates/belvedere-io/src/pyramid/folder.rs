//! Folders of tiles: zoom/column/row.png or .webp, rows from the north.

use super::key::Key;
use super::store::{ENDINGS, Listed, Store, Tile};
use crate::{Fault, IoError, fs};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Files beside the zooms that state the encoding.
const METADATA: [&str; 3] = ["metadata.json", "tiles.json", "tilejson.json"];
/// Most bytes of such a file.
const MOST_METADATA: u64 = 1 << 20;

/// Whether a folder holds folders of a zoom and a column with the file of a row, of any kind.
pub(super) fn is_pyramid(folder: &Path) -> bool {
    let is_row = |path: &PathBuf| row_of(path).is_some();
    numbered(folder).any(|(_, zoom)| numbered(&zoom).any(|(_, column)| entries(&column).any(|path| is_row(&path))))
}

/// Lists the tiles of a folder.
///
/// # Errors
/// A predicate, if there are none.
pub(super) fn list(folder: &Path) -> Result<Listed, Fault> {
    let (mut tiles, mut odd, mut other) = (Vec::new(), 0, None);
    for (zoom, of_zoom) in numbered(folder) {
        for (column, of_column) in numbered(&of_zoom) {
            for path in entries(&of_column) {
                let Some((row, ending)) = row_of(&path) else { continue };
                let key = u8::try_from(zoom).ok().and_then(|zoom| Key::new(zoom, column, row));
                match (ENDINGS.iter().position(|known| *known == ending), key) {
                    (Some(at), Some(key)) => tiles.push(Tile { key, at: at as u64, length: 0 }),
                    (Some(_), None) => odd += 1,
                    (None, _) => other = Some(ending),
                }
            }
        }
    }
    if tiles.is_empty() {
        return Err(without_tiles(other.as_deref()).into());
    }
    Ok(Listed { tiles, store: Store::Folder(folder.to_owned()), encoding: encoding(folder), odd, file: None })
}

fn without_tiles(other: Option<&str>) -> String {
    match other {
        Some("pbf" | "mvt") => super::picture::VECTORS.into(),
        Some("jpg" | "jpeg") => super::picture::PHOTOS.into(),
        _ => "is a folder without elevation models and without tiles of heights (zoom/column/row.png or .webp); name a folder of tiles, or a file".into(),
    }
}

/// Folders in a folder whose names are numbers.
fn numbered(folder: &Path) -> impl Iterator<Item = (u64, PathBuf)> {
    entries(folder).filter_map(|path| {
        let number = path.file_name()?.to_str()?.parse().ok()?;
        path.is_dir().then_some((number, path))
    })
}

fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    std::fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()))
}

/// The row that a file name says, and its ending.
fn row_of(path: &Path) -> Option<(u64, String)> {
    let (row, ending) = path.file_name()?.to_str()?.split_once('.')?;
    Some((row.parse().ok()?, ending.to_ascii_lowercase()))
}

/// The encoding that a file of metadata states.
fn encoding(folder: &Path) -> Option<String> {
    METADATA.iter().find_map(|name| {
        let path = fs::beside(&folder.join("a"), name).ok()?;
        let size = fs::metadata(&path).map_err(|e| IoError::os(&path, e)).ok()?.len();
        let text = fs::read(&path).ok().filter(|_| size <= MOST_METADATA)?;
        encoding_in(&text)
    })
}

/// The member `encoding` of a JSON document.
pub(super) fn encoding_in(json: &[u8]) -> Option<String> {
    let document: Value = serde_json::from_slice(json).ok()?;
    Some(document.get("encoding")?.as_str()?.to_owned())
}
