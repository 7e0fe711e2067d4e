//! Terrain in several files: tiles named one by one, or all of a folder or an archive.

use crate::BelvedereError;
use crate::scene_file::Paths;
use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::formats::{Reader, of_content};
use belvedere_io::{IoError, Vectors, load_vectors, split_table};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Bytes that tell a grid in text.
const HEAD: u64 = 200;

/// Files by what they hold.
pub(super) struct Tiles {
    /// Elevation models.
    pub(super) ground: Vec<String>,
    /// Routes, areas, points.
    pub(super) features: Vec<String>,
}

/// Sorts files: elevation models among `features`, by their names, are tiles of the terrain beside `dem`, which may be a folder.
pub(super) fn of(dem: &str, features: &[String]) -> Result<Tiles, BelvedereError> {
    let is_ground =
        |name: &&String| !name.starts_with("builtin:") && Reader::Terrain.reads(split_table(Path::new(name)).0);
    let (more, features): (Vec<&String>, Vec<&String>) = features.iter().partition(is_ground);
    let is_file = || Path::new(dem).is_file();
    let mut ground = match Path::new(dem).is_dir() {
        true => in_folder(Path::new(dem))?,
        false if is_file() => {
            belvedere_io::tiles(Path::new(dem))?.iter().map(|path| text(path)).collect::<Result<_, _>>()?
        }
        false => Vec::new(),
    };
    if ground.is_empty() {
        ground.push(dem.to_owned());
    }
    ground.extend(more.into_iter().cloned());
    Ok(Tiles { ground, features: features.into_iter().cloned().collect() })
}

/// The error of files none of which holds features: they may be given in the wrong order.
pub(super) fn without_features(dem: &str, features: &[String]) -> BelvedereError {
    let held = |name: &str| belvedere_io::readable(Path::new(name)).ok().flatten();
    let first = held(dem).filter(|format| format.reader == Some(Reader::Features));
    match (first, features) {
        (Some(format), []) => BelvedereError::Target(format!(
            "{dem} is {} ({}); {}",
            format.name,
            format.holds,
            without_terrain(Path::new(dem)).unwrap_or_default()
        )),
        (None, []) => BelvedereError::GroundAlone { ground: dem.to_owned() },
        (Some(format), [ground, ..]) => BelvedereError::Target(format!(
            "{dem} is {} ({}), not an elevation model; the elevation model comes first, then the features: {ground} {dem}",
            format.name, format.holds
        )),
        (None, _) => BelvedereError::Target(format!(
            "no features are given: {} is read as an elevation model; name at least one file of routes, areas or points",
            features.join(", ")
        )),
    }
}

/// What is missing where a file of features is given alone: an elevation model, with the tile that covers them; `None` of other files.
pub fn without_terrain(path: &Path) -> Option<String> {
    let format = belvedere_io::readable(path).ok().flatten().filter(|f| f.reader == Some(Reader::Features));
    format?;
    let tile = load_vectors(path).ok().and_then(|loaded| tile_of(&loaded.value));
    let tile = tile.map_or_else(String::new, |tile| format!(" (for {tile} of Copernicus or SRTM)"));
    Some(format!("the terrain is missing: give an elevation model first, then the features{tile}"))
}

/// The middle of features, and the tile of one degree in which it lies, as worldwide models name it; `None` of features without a place on the
/// earth.
fn tile_of(features: &Vectors) -> Option<String> {
    let [low, high] = features.extent().filter(|_| !features.crs.is_local())?;
    let middle =
        Transform::new(&features.crs, &CoordinateSystem::wgs84().ok()?).ok()?.forward_one(0.5 * (low + high))?;
    let named = |value: f64, [plus, minus]: [char; 2]| if value < 0.0 { minus } else { plus };
    let ([north, east], corner) = ([named(middle.y, ['N', 'S']), named(middle.x, ['E', 'W'])], middle.floor());
    let [of_north, of_east] = [named(corner.y, ['N', 'S']), named(corner.x, ['E', 'W'])];
    Some(format!(
        "{:.1}{north} {:.1}{east} the tile {of_north}{:02}{of_east}{:03}",
        middle.y.abs(),
        middle.x.abs(),
        corner.y.abs(),
        corner.x.abs()
    ))
}

fn text(path: &Path) -> Result<String, BelvedereError> {
    path.to_str().map(str::to_owned).ok_or_else(|| BelvedereError::not_utf8(&path.display().to_string()))
}

/// The elevation models of a folder, by name; a pyramid of tiles is one.
fn in_folder(folder: &Path) -> Result<Vec<String>, BelvedereError> {
    if belvedere_io::is_pyramid(folder) {
        return Ok(vec![text(folder)?]);
    }
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|e| IoError::os(folder, e))? {
        let path = entry.map_err(|e| IoError::os(folder, e))?.path();
        if path.is_file() && is_tile(&path) {
            found.push(text(&path)?);
        }
    }
    found.sort();
    if found.is_empty() {
        let reason = "is a folder without elevation models (GeoTIFF, .hgt, ESRI ASCII, or tiles zoom/column/row.png); name a folder of tiles, or a file";
        return Err(IoError::format(folder, reason).into());
    }
    Ok(found)
}

/// Whether a file of a folder is a tile. Texts are told by their first word: notes lie beside data.
fn is_tile(path: &Path) -> bool {
    let is_text = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("txt"));
    Reader::Terrain.reads(path) && (!is_text || begins_as_grid(path).unwrap_or(false))
}

fn begins_as_grid(path: &Path) -> std::io::Result<bool> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(of_content(&head).is_some_and(|format| format.reader == Some(Reader::Terrain)))
}

/// One file as itself, several as a list.
pub(super) fn paths(mut files: Vec<String>) -> Paths {
    match files.len() {
        1 => Paths::One(files.remove(0)),
        _ => Paths::Many(files),
    }
}
