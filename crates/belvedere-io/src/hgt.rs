//! SRTM elevation tiles: `.hgt`.
//!
//! A square of big-endian 16-bit heights of one degree by one degree, north-west first; rows and columns on both edges
//! are shared with the neighbours. The name gives the south-west corner: `N42E001.hgt`. Source: NASA, SRTM user's guide.

use crate::fs::File;
use crate::{Affine, CrsKind, InputFile, IoError, Limits, Loaded, Raster, RasterInfo, SampleType, Samples, SourceCrs};
use rayon::prelude::*;
use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;

/// Stored value of a void.
pub const VOID: i16 = -32768;
/// Samples per side of the finest tiles (SRTM1).
const MAX_SIDE: usize = 3601;

/// Reads a tile.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] if neither the name nor that of the archive gives a corner, the size is no tile's (a
/// truncated file), or the tile passes the limit.
pub fn read(path: &Path, limits: &Limits) -> Result<Loaded<Raster>, IoError> {
    let Tile { name, bytes, file } = plain(path)?;
    let bad = |reason: String| IoError::format(path, reason);
    let Some([lon, lat]) = corner(&name).or_else(|| corner(&file_name(path.parent().unwrap_or(path)))) else {
        return Err(bad(format!(
            "the name {name:?} does not tell the tile's south-west corner; rename it like N42E001.hgt"
        )));
    };
    let side = side_of(bytes.len()).ok_or_else(|| {
        bad(format!(
            "{} bytes are not a whole tile (2,884,802 for 1201 x 1201 or 25,934,402 for 3601 x 3601); it is probably truncated, get it again",
            bytes.len()
        ))
    })?;
    limits.check(bytes.len() as u64).map_err(|e| IoError::format(path, e))?;
    let samples = bytes.par_chunks_exact(2).map(|b| i16::from_be_bytes([b[0], b[1]])).collect();
    let mut info = RasterInfo::new(path, side, side, SampleType::I16);
    let step = 1.0 / (side - 1) as f64;
    info.pixel_to_model = Some(Affine([step, 0.0, lon - step / 2.0, 0.0, -step, lat + 1.0 + step / 2.0]));
    info.pixel_is_point = true;
    info.crs = SourceCrs::Epsg(4326);
    info.crs_kind = CrsKind::Geographic;
    info.vertical_epsg = Some(5773);
    info.vertical_unit_said = true;
    info.nodata = Some(f64::from(VOID));
    Ok(Loaded::clean(Raster { info, samples: Samples::I16(samples), mask: None }).with_file(file))
}

fn file_name(path: &Path) -> String {
    path.file_name().map(OsStr::to_string_lossy).unwrap_or_default().into_owned()
}

/// A tile as stored.
struct Tile {
    name: String,
    bytes: Vec<u8>,
    file: InputFile,
}

fn plain(path: &Path) -> Result<Tile, IoError> {
    let os = |e| IoError::os(path, e);
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(os)?;
    // one byte more than the largest tile has, to recognise larger files
    file.take(max_bytes() + 1).read_to_end(&mut bytes).map_err(os)?;
    let file = InputFile::of(path, &bytes);
    Ok(Tile { name: file_name(path), bytes, file })
}

fn max_bytes() -> u64 {
    2 * (MAX_SIDE as u64).pow(2)
}

/// Longitude and latitude of the south-west corner by the name.
fn corner(name: &str) -> Option<[f64; 2]> {
    let sign = |letter: u8, plus: u8, minus: u8| match letter.to_ascii_uppercase() {
        l if l == plus => Some(1.0),
        l if l == minus => Some(-1.0),
        _ => None,
    };
    let bytes = name.as_bytes();
    let digits = |range: std::ops::Range<usize>| -> Option<f64> {
        let digits = bytes.get(range)?;
        digits.iter().all(u8::is_ascii_digit).then(|| digits.iter().fold(0.0, |n, d| 10.0 * n + f64::from(d - b'0')))
    };
    let lat = sign(*bytes.first()?, b'N', b'S')? * digits(1..3)?;
    let lon = sign(*bytes.get(3)?, b'E', b'W')? * digits(4..7)?;
    ((-90.0..90.0).contains(&lat) && (-180.0..180.0).contains(&lon)).then_some([lon, lat])
}

/// Samples per side of a tile, by its size in bytes; `None` if it is not a tile: its step must divide the degree evenly.
fn side_of(bytes: usize) -> Option<usize> {
    let side = ((bytes / 2) as f64).sqrt().round() as usize;
    ((2..=MAX_SIDE).contains(&side) && 2 * side * side == bytes && 3600usize.is_multiple_of(side - 1)).then_some(side)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_corners() {
        assert_eq!(corner("N42E001.hgt"), Some([1.0, 42.0]));
        assert_eq!(corner("s34w071.SRTMGL1.hgt"), Some([-71.0, -34.0]));
        for bad in ["", "N42", "X42E001.hgt", "N4xE001.hgt", "N99E001.hgt", "N42E200.hgt", "é42E001"] {
            assert_eq!(corner(bad), None, "{bad}");
        }
    }

    #[test]
    fn sizes_tell_tiles() {
        assert_eq!(side_of(2_884_802), Some(1201));
        assert_eq!(side_of(25_934_402), Some(3601));
        for bad in [0, 2, 777_777, 2_884_800, 2 * 1200 * 1200, usize::MAX] {
            assert_eq!(side_of(bad), None, "{bad}");
        }
    }
}
