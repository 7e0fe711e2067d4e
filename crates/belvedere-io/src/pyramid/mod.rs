//! Pyramids of tiles whose pixels are heights (terrain-RGB, Terrarium): folders, MBTiles and PMTiles.
//!
//! The ground is a mosaic on the lattice of the deepest zoom, in EPSG:3857. Of what several zooms cover the deepest counts; lower zooms are
//! reduced copies. Tiles that are absent are void.

mod encoding;
mod folder;
mod key;
mod mbtiles;
mod mosaic;
mod picture;
mod pmtiles;
mod store;

use crate::{
    Affine, CrsKind, Fault, InputFile, IoError, Limits, Loaded, RasterInfo, SampleType, SourceCrs, budget, recognise,
};
use belvedere_core::{Warning, WarningKind};
use encoding::Encoding;
use key::Key;
use picture::Picture;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use store::{Listed, Store, Tile};

/// Half the side of the square of Web Mercator, metres.
const HALF_M: f64 = std::f64::consts::PI * 6_378_137.0;
/// Tiles by which the encoding is judged.
const JUDGED: usize = 16;

/// A pyramid that was opened: the places of its tiles, and how they hold heights.
pub(crate) struct Pyramid {
    path: PathBuf,
    limits: Limits,
    store: Store,
    /// By their keys, each once.
    tiles: Vec<Tile>,
    encoding: Encoding,
    /// Samples along a side of a tile.
    side: usize,
    /// The deepest zoom.
    zoom: u8,
    /// Columns and rows of tiles of that zoom.
    area: [Range<u64>; 2],
    read: Mutex<Read>,
}

/// What reading tiles leaves behind.
#[derive(Default)]
struct Read {
    /// Files of a folder.
    files: BTreeMap<Key, InputFile>,
    /// Why tiles cannot be read.
    damaged: BTreeMap<Key, String>,
    /// The last tile that stood in for others below it.
    above: Option<(Key, Arc<[f32]>)>,
}

/// Whether a path is a pyramid of tiles: MBTiles or PMTiles by name or content, or a folder of folders of zooms, columns and rows.
pub fn is_pyramid(path: &Path) -> bool {
    if path.is_dir() { folder::is_pyramid(path) } else { is_packed(path) }
}

fn is_packed(path: &Path) -> bool {
    matches!(recognise::ending(path).as_str(), "mbtiles" | "pmtiles")
}

impl Pyramid {
    /// Lists the tiles and judges their encoding.
    ///
    /// # Errors
    /// [`IoError`] if there are none, if the file is damaged, or if they hold no heights.
    pub(crate) fn open(path: &Path, limits: Limits) -> Result<Loaded<Self>, IoError> {
        let _work = budget::work_on(path);
        let listed = match recognise::ending(path).as_str() {
            _ if path.is_dir() => folder::list(path).map_err(|e| IoError::format(path, e))?,
            "mbtiles" => mbtiles::list(path, &limits)?,
            _ => pmtiles::list(path, &limits)?,
        };
        Self::of(path, listed, limits).map_err(|e| IoError::format(path, e))
    }

    fn of(path: &Path, listed: Listed, limits: Limits) -> Result<Loaded<Self>, Fault> {
        let Listed { mut tiles, store, encoding: stated, odd, file } = listed;
        tiles.sort_unstable();
        tiles.dedup_by_key(|tile| tile.key);
        let Some(zoom) = tiles.last().map(|tile| tile.key.zoom()) else {
            return Err("holds no tiles; get it again".into());
        };
        let area = area(&tiles, zoom);
        let (encoding, side) = (Encoding::Mapbox, 0);
        let read = Mutex::default();
        let mut out = Self { path: path.to_owned(), limits, store, tiles, encoding, side, zoom, area, read };
        let mut warnings = Vec::new();
        let pictures = out.some()?;
        out.side = pictures.first().map_or(0, |picture| picture.side);
        let said = Encoding::of(stated.as_deref(), &pictures)?;
        out.encoding = said.0;
        warnings.extend(said.1);
        let what = "tiles lie outside of their zoom, or deeper than zoom 24, and are left out";
        warnings.extend(Warning::counted(WarningKind::Ignored, odd, what));
        let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
        Ok(Loaded { value: out, warnings, files: file.into_iter().collect() })
    }

    /// Some tiles of the deepest zoom, all of one side.
    fn some(&self) -> Result<Vec<Picture>, Fault> {
        let first = self.tiles.partition_point(|tile| tile.key.zoom() < self.zoom);
        let deepest = &self.tiles[first..];
        let mut out: Vec<Picture> = Vec::new();
        let mut fault = None;
        for tile in deepest.iter().step_by(deepest.len().div_ceil(JUDGED)) {
            let (bytes, _) = self.store.read(tile, &self.limits)?;
            match Picture::of(&bytes, &self.limits) {
                Ok(picture) => out.push(picture),
                Err(e) if e.is_of_memory() => return Err(e),
                Err(e) => match picture::other_kind(&bytes) {
                    Some(reason) => return Err(reason.into()),
                    None => fault = Some(e.placed(format_args!("its tile {} cannot be read", name(tile.key)))),
                },
            }
        }
        let side = out.first().map(|picture| picture.side);
        out.retain(|picture| Some(picture.side) == side);
        match fault {
            Some(fault) if out.is_empty() => Err(fault),
            _ => Ok(out),
        }
    }

    /// Number of levels: the deepest zoom, and those above it.
    pub(crate) fn levels(&self) -> usize {
        usize::from(self.zoom) + 1
    }

    /// Columns and rows of samples of a level, 0 the deepest zoom.
    fn part(&self, level: usize) -> [Range<u64>; 2] {
        let side = self.side as u64;
        self.area.clone().map(|tiles| (tiles.start * side) >> level..(tiles.end * side).div_ceil(1 << level))
    }

    /// Number of samples of a level.
    pub(crate) fn samples(&self, level: usize) -> usize {
        let [cols, rows] = self.part(level).map(|range| usize::try_from(range.end - range.start).unwrap_or(usize::MAX));
        cols.saturating_mul(rows)
    }

    /// A level as raster; without samples.
    pub(crate) fn info(&self, level: usize) -> RasterInfo {
        let [cols, rows] = self.part(level);
        let [width, height] =
            [&cols, &rows].map(|range| usize::try_from(range.end - range.start).unwrap_or(usize::MAX));
        let mut info = RasterInfo::new(&self.path, width, height, SampleType::F32);
        let across = (self.side as u64) << (usize::from(self.zoom) - level);
        let step = 2.0 * HALF_M / across as f64;
        let (left, top) = (cols.start as f64 * step - HALF_M, HALF_M - rows.start as f64 * step);
        info.pixel_to_model = Some(Affine([step, 0.0, left, 0.0, -step, top]));
        (info.crs, info.crs_kind) = (SourceCrs::Epsg(3857), CrsKind::Projected);
        info.vertical_unit_said = true;
        info
    }

    /// What reading left behind: files, and a warning about tiles that could not be read.
    pub(crate) fn left_behind(&self) -> (Vec<InputFile>, Option<Warning>) {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let damaged = read.damaged.iter().next().map(|(key, reason)| {
            let count = read.damaged.len();
            let text =
                format!("{count} tiles cannot be read and count as absent, the first is {} ({reason})", name(*key));
            Warning::new(WarningKind::Repaired, text).with("count", count as f64).in_file(&self.path)
        });
        (read.files.values().cloned().collect(), damaged)
    }

    /// A tile that is stored.
    fn find(&self, key: Key) -> Option<&Tile> {
        self.tiles.binary_search_by_key(&key, |tile| tile.key).ok().map(|at| &self.tiles[at])
    }

    /// Whether a tile that is stored lies below another place.
    fn is_refined(&self, key: Key) -> bool {
        has_below(&self.tiles, key, self.zoom)
    }
}

/// Zoom, column and row, as in the name of a file.
fn name(key: Key) -> String {
    let [column, row] = key.place();
    format!("{}/{column}/{row}", key.zoom())
}

fn has_below(tiles: &[Tile], key: Key, deepest: u8) -> bool {
    (1..=deepest.saturating_sub(key.zoom())).any(|steps| {
        let [first, end] = key.range_below(steps);
        let at = tiles.partition_point(|tile| tile.key < first);
        tiles.get(at).is_some_and(|tile| tile.key < end)
    })
}

/// Columns and rows of the deepest zoom around the tiles below which there is none.
fn area(tiles: &[Tile], deepest: u8) -> [Range<u64>; 2] {
    let leaves = tiles.iter().filter(|tile| !has_below(tiles, tile.key, deepest));
    let (mut first, mut end) = ([u64::MAX; 2], [0; 2]);
    for tile in leaves {
        let steps = deepest - tile.key.zoom();
        for (axis, n) in tile.key.place().into_iter().enumerate() {
            first[axis] = first[axis].min(n << steps);
            end[axis] = end[axis].max((n + 1) << steps);
        }
    }
    [first[0]..end[0], first[1]..end[1]]
}
