//! A cloud-optimised GeoTIFF: tiles and overviews, in the order in which programs read them over a network.
//!
//! The order is the one of GDAL's driver COG: a note on the structure, all directories from the largest image to the smallest, then the
//! tiles of the smallest first. Each tile stands between its size and a copy of its last four bytes, as the note says, so that a reader
//! can fetch it by its position alone.

use super::ifd::tag;
use super::overview::halved;
use super::write::{TOO_LARGE, Value, check, compress, directory, geo_entries, image_entries, little_endian};
use crate::IoError;
use crate::atomic::write_atomic;
use crate::raster::Raster;
use rayon::prelude::*;
use std::path::Path;

/// Columns and rows of a tile.
const TILE: usize = 512;
/// Subfile type of an overview.
const REDUCED: u32 = 1;
/// What the note says; the space at its end is room for the word YES.
const STRUCTURE: &str = "LAYOUT=IFDS_BEFORE_DATA\nBLOCK_ORDER=ROW_MAJOR\nBLOCK_LEADER=SIZE_AS_UINT4\n\
    BLOCK_TRAILER=LAST_4_BYTES_REPEATED\nKNOWN_INCOMPATIBLE_EDITION=NO\n ";

/// Writes a raster as a cloud-optimised GeoTIFF: as [`super::write_geotiff`], in tiles of 512 x 512 pixels, with overviews by halves down
/// to one tile. Same raster, same bytes.
///
/// Overviews are means of the samples that are known, weighted by area; colours are not weighted by their alpha.
///
/// # Errors
/// As [`super::write_geotiff`].
pub fn write_cloud_geotiff(path: &Path, raster: &Raster, overwrite: bool) -> Result<(), IoError> {
    let bytes = encode(raster).map_err(|reason| IoError::format(path, reason))?;
    write_atomic(path, overwrite, |out| out.write_all(&bytes))
}

fn encode(raster: &Raster) -> Result<Vec<u8>, String> {
    check(raster)?;
    let mut levels = vec![Level::of(raster)?];
    let mut coarser: Option<Raster> = None;
    loop {
        let last = coarser.as_ref().unwrap_or(raster);
        if last.info.width.max(last.info.height) <= TILE {
            break;
        }
        let next = halved(last);
        levels.push(Level::of(&next)?);
        coarser = Some(next);
    }
    if let Some((image, overviews)) = levels.split_first_mut() {
        image.entries.extend(geo_entries(&raster.info)?);
        overviews.iter_mut().for_each(|o| o.entries.push((tag::NEW_SUBFILE_TYPE, Value::Longs(vec![REDUCED]))));
    }
    assemble(&mut levels)
}

/// One image of the file.
struct Level {
    entries: Vec<(u16, Value)>,
    /// Compressed, row by row.
    tiles: Vec<Vec<u8>>,
}

impl Level {
    fn of(raster: &Raster) -> Result<Self, String> {
        let info = &raster.info;
        let bytes = little_endian(raster);
        let [across, down] = [info.width, info.height].map(|n| n.div_ceil(TILE));
        let tile = |i: usize| compress(&cut(&bytes, raster, i % across, i / across), info, TILE * pixel(raster));
        let tiles = (0..across * down).into_par_iter().map(tile).collect::<Result<Vec<_>, _>>()?;
        let counts = tiles.iter().map(|t| u32::try_from(t.len())).collect::<Result<Vec<_>, _>>();
        let mut entries = image_entries(info)?;
        entries.push((tag::PLANAR, Value::Shorts(vec![1])));
        entries.push((tag::TILE_WIDTH, Value::Shorts(vec![TILE as u16])));
        entries.push((tag::TILE_HEIGHT, Value::Shorts(vec![TILE as u16])));
        entries.push((tag::TILE_OFFSETS, Value::Longs(vec![0; tiles.len()])));
        entries.push((tag::TILE_BYTES, Value::Longs(counts.map_err(|_| TOO_LARGE)?)));
        Ok(Self { entries, tiles })
    }
}

/// Bytes of a pixel.
fn pixel(raster: &Raster) -> usize {
    raster.info.bands * raster.info.sample_type.size()
}

/// The samples of a tile; beyond the image, its last column and row are repeated, which compresses best.
fn cut(bytes: &[u8], raster: &Raster, column: usize, row: usize) -> Vec<u8> {
    let pixel = pixel(raster);
    let stride = raster.info.width * pixel;
    let columns = TILE.min(raster.info.width - column * TILE);
    let mut out = Vec::with_capacity(TILE * TILE * pixel);
    for y in row * TILE..(row + 1) * TILE {
        let start = y.min(raster.info.height - 1) * stride + column * TILE * pixel;
        let line = &bytes[start..start + columns * pixel];
        out.extend_from_slice(line);
        for _ in columns..TILE {
            out.extend_from_slice(&line[line.len() - pixel..]);
        }
    }
    out
}

/// The file: its header, note, directories and tiles.
fn assemble(levels: &mut [Level]) -> Result<Vec<u8>, String> {
    let mut note = format!("GDAL_STRUCTURAL_METADATA_SIZE={:06} bytes\n{STRUCTURE}", STRUCTURE.len()).into_bytes();
    // Directories begin at even positions.
    note.resize(note.len().next_multiple_of(2), 0);
    let first = 8 + note.len();
    levels.iter_mut().for_each(|level| level.entries.sort_by_key(|(number, _)| *number));
    // The directories come first, so their sizes must be known before the positions of the tiles are.
    let mut at = first + directories(levels, first)?.len();
    for level in levels.iter_mut().rev() {
        let mut offsets = Vec::with_capacity(level.tiles.len());
        for tile in &level.tiles {
            offsets.push(u32::try_from(at + 4).map_err(|_| TOO_LARGE)?);
            at += tile.len() + 8;
        }
        if let Some((_, value)) = level.entries.iter_mut().find(|(number, _)| *number == tag::TILE_OFFSETS) {
            *value = Value::Longs(offsets);
        }
    }
    u32::try_from(at).map_err(|_| TOO_LARGE)?;
    let mut out = Vec::with_capacity(at);
    out.extend_from_slice(b"II\x2a\0");
    out.extend((first as u32).to_le_bytes());
    out.extend(note);
    out.extend(directories(levels, first)?);
    for tile in levels.iter().rev().flat_map(|level| &level.tiles) {
        out.extend((tile.len() as u32).to_le_bytes());
        out.extend_from_slice(tile);
        // Compressed tiles are longer than four bytes.
        out.extend_from_slice(&tile[tile.len().saturating_sub(4)..]);
    }
    Ok(out)
}

/// All directories, from byte `at` on.
fn directories(levels: &[Level], at: usize) -> Result<Vec<u8>, String> {
    let mut out = Vec::new();
    for (i, level) in levels.iter().enumerate() {
        out.extend(directory(&level.entries, at + out.len(), i + 1 < levels.len())?);
    }
    Ok(out)
}
