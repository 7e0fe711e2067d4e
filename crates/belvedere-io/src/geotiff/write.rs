//! A plain GeoTIFF from a raster: deflate strips, predictor, georeference, no data.

use super::ifd::tag;
use crate::IoError;
use crate::atomic::write_atomic;
use crate::raster::{Affine, CrsKind, Photometric, Raster, RasterInfo, SampleType, SourceCrs, with_samples};
use flate2::{Compression, write::ZlibEncoder};
use rayon::prelude::*;
use std::io::Write;
use std::path::Path;

/// Writes a raster as a little-endian classic GeoTIFF: strips, deflate, predictor 2 for integers and 3 for floats, EPSG
/// code, affine placement (rotated ones too), no-data value. All or nothing: see [`crate::atomic::write_atomic`].
///
/// Pixels that the mask excludes get the no-data value. Same raster, same bytes.
///
/// # Errors
/// [`IoError`] if the file cannot be written, `samples` do not match width, height and bands, the raster has a palette,
/// scaling, or a mask without a no-data value, its CRS has no EPSG code, or the file would need 4 GiB or more.
pub fn write_geotiff(path: &Path, raster: &Raster, overwrite: bool) -> Result<(), IoError> {
    let bytes = encode(raster).map_err(|reason| IoError::format(path, reason))?;
    write_atomic(path, overwrite, |out| out.write_all(&bytes))
}

/// Why a file cannot be written.
pub(super) const TOO_LARGE: &str = "would need 4 GiB or more, which classic TIFF cannot hold; write a smaller part";

/// Value of a directory entry.
pub(super) enum Value {
    Shorts(Vec<u16>),
    Longs(Vec<u32>),
    Doubles(Vec<f64>),
    Text(String),
}

impl Value {
    fn kind_count_bytes(&self) -> (u16, usize, Vec<u8>) {
        match self {
            Self::Shorts(v) => (3, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::Longs(v) => (4, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::Doubles(v) => (12, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::Text(t) => (2, t.len() + 1, t.bytes().chain([0]).collect()),
        }
    }
}

/// The bytes of the file.
fn encode(raster: &Raster) -> Result<Vec<u8>, String> {
    let info = &raster.info;
    check(raster)?;
    let row_bytes = info.width * info.bands * info.sample_type.size();
    let rows_per_strip = ((1 << 18) / row_bytes.max(1)).clamp(1, info.height);
    let bytes = little_endian(raster);
    let strips = bytes.par_chunks(rows_per_strip * row_bytes).map(|strip| compress(strip, info, row_bytes));
    let strips: Vec<Vec<u8>> = strips.collect::<Result<_, _>>()?;
    let mut entries = image_entries(info)?;
    entries.push((tag::ROWS_PER_STRIP, Value::Longs(vec![u32::try_from(rows_per_strip).map_err(|_| TOO_LARGE)?])));
    entries.extend(geo_entries(info)?);
    let counts = strips.iter().map(|s| u32::try_from(s.len())).collect::<Result<Vec<_>, _>>();
    let counts = counts.map_err(|_| TOO_LARGE)?;
    // The directory comes first, so its size must be known before the positions of the strips are.
    entries.push((tag::STRIP_OFFSETS, Value::Longs(vec![0; strips.len()])));
    entries.push((tag::STRIP_BYTES, Value::Longs(counts.clone())));
    entries.sort_by_key(|(number, _)| *number);
    let mut at =
        u32::try_from(HEADER.len() + directory(&entries, HEADER.len(), false)?.len()).map_err(|_| TOO_LARGE)?;
    let mut offsets = Vec::with_capacity(counts.len());
    for count in counts {
        offsets.push(at);
        at = at.checked_add(count).ok_or(TOO_LARGE)?;
    }
    for (number, value) in &mut entries {
        if *number == tag::STRIP_OFFSETS {
            *value = Value::Longs(std::mem::take(&mut offsets));
        }
    }
    let mut out = HEADER.to_vec();
    out.extend(directory(&entries, HEADER.len(), false)?);
    strips.iter().for_each(|strip| out.extend_from_slice(strip));
    Ok(out)
}

pub(super) fn check(raster: &Raster) -> Result<(), String> {
    let info = &raster.info;
    let needed = info.width.checked_mul(info.height).and_then(|n| n.checked_mul(info.bands));
    if needed != Some(raster.samples.len()) || raster.samples.is_empty() {
        return Err(format!(
            "{} x {} pixels of {} bands do not match {} samples",
            info.width,
            info.height,
            info.bands,
            raster.samples.len()
        ));
    }
    if raster.samples.sample_type() != info.sample_type {
        return Err(format!(
            "samples are {}, the raster says {}",
            raster.samples.sample_type().name(),
            info.sample_type.name()
        ));
    }
    if info.width > u32::MAX as usize || info.height > u32::MAX as usize || info.bands > usize::from(u16::MAX) {
        return Err("is larger than TIFF allows".to_owned());
    }
    if matches!(info.photometric, Photometric::Palette(_)) || !info.scaling.is_empty() {
        return Err("palettes and scaled values cannot be written; convert the samples first".to_owned());
    }
    if raster.mask.is_some() && info.nodata.is_none() {
        return Err("has a mask but no no-data value to write in its place; set one".to_owned());
    }
    Ok(())
}

pub(super) fn little_endian(raster: &Raster) -> Vec<u8> {
    let mut bytes: Vec<u8> = with_samples!(&raster.samples, v => v.iter().flat_map(|x| x.to_le_bytes()).collect());
    let (Some(mask), Some(nodata)) = (&raster.mask, raster.info.nodata) else { return bytes };
    let cell = match raster.info.sample_type {
        SampleType::I8 => (nodata as i8).to_le_bytes().to_vec(),
        SampleType::U8 => (nodata as u8).to_le_bytes().to_vec(),
        SampleType::I16 => (nodata as i16).to_le_bytes().to_vec(),
        SampleType::U16 => (nodata as u16).to_le_bytes().to_vec(),
        SampleType::I32 => (nodata as i32).to_le_bytes().to_vec(),
        SampleType::U32 => (nodata as u32).to_le_bytes().to_vec(),
        SampleType::I64 => (nodata as i64).to_le_bytes().to_vec(),
        SampleType::U64 => (nodata as u64).to_le_bytes().to_vec(),
        SampleType::F32 => (nodata as f32).to_le_bytes().to_vec(),
        SampleType::F64 => nodata.to_le_bytes().to_vec(),
    };
    let pixels = bytes.chunks_exact_mut(cell.len() * raster.info.bands);
    for (pixel, _) in pixels.zip(mask).filter(|(_, valid)| !**valid) {
        pixel.chunks_exact_mut(cell.len()).for_each(|c| c.copy_from_slice(&cell));
    }
    bytes
}

fn is_float(kind: SampleType) -> bool {
    matches!(kind, SampleType::F32 | SampleType::F64)
}

/// Rows of little-endian samples, predicted and deflated.
pub(super) fn compress(strip: &[u8], info: &RasterInfo, row_bytes: usize) -> Result<Vec<u8>, String> {
    let size = info.sample_type.size();
    let mut rows = strip.to_vec();
    for row in rows.chunks_exact_mut(row_bytes) {
        if is_float(info.sample_type) {
            float_predictor(row, info.bands, size);
        } else {
            difference(row, info.bands * size, size);
        }
    }
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(strip.len() / 2), Compression::default());
    let written = encoder.write_all(&rows).and_then(|()| encoder.finish());
    written.map_err(|e| format!("cannot be compressed: {e}"))
}

/// Horizontal differencing of little-endian integers of `size` bytes, `stride` bytes from pixel to pixel.
fn difference(row: &mut [u8], stride: usize, size: usize) {
    for i in (stride..row.len()).step_by(size).rev() {
        let mut borrow = false;
        for k in i..i + size {
            let (d, b1) = row[k].overflowing_sub(row[k - stride]);
            let (d, b2) = d.overflowing_sub(u8::from(borrow));
            row[k] = d;
            borrow = b1 | b2;
        }
    }
}

/// Byte planes, most significant first, differenced.
fn float_predictor(row: &mut [u8], bands: usize, size: usize) {
    let cells = row.to_vec();
    let plane = row.len() / size;
    for (i, cell) in cells.chunks_exact(size).enumerate() {
        for (k, &byte) in cell.iter().rev().enumerate() {
            row[k * plane + i] = byte;
        }
    }
    for i in (bands..row.len()).rev() {
        row[i] = row[i].wrapping_sub(row[i - bands]);
    }
}

/// What a directory says of the samples of an image.
pub(super) fn image_entries(info: &RasterInfo) -> Result<Vec<(u16, Value)>, String> {
    let long = |v: usize| u32::try_from(v).map(|v| Value::Longs(vec![v])).map_err(|e| e.to_string());
    let format = match info.sample_type {
        SampleType::F32 | SampleType::F64 => 3,
        SampleType::I8 | SampleType::I16 | SampleType::I32 | SampleType::I64 => 2,
        _ => 1,
    };
    let bits = 8 * info.sample_type.size() as u16;
    let (photometric, colors) = match info.photometric {
        Photometric::GrayInverted => (0, 1),
        Photometric::Rgb([0, 1, 2]) => (2, 3),
        _ => (1, 1),
    };
    let kind_of = |band: usize| match info.alpha {
        crate::raster::Alpha::Straight(b) if b == band => 2,
        crate::raster::Alpha::Premultiplied(b) if b == band => 1,
        _ => 0,
    };
    let mut entries = vec![
        (tag::WIDTH, long(info.width)?),
        (tag::HEIGHT, long(info.height)?),
        (tag::BITS, Value::Shorts(vec![bits; info.bands])),
        (tag::COMPRESSION, Value::Shorts(vec![8])),
        (tag::PHOTOMETRIC, Value::Shorts(vec![photometric])),
        (tag::SAMPLES_PER_PIXEL, Value::Shorts(vec![info.bands as u16])),
        (tag::PREDICTOR, Value::Shorts(vec![if is_float(info.sample_type) { 3 } else { 2 }])),
        (tag::SAMPLE_FORMAT, Value::Shorts(vec![format; info.bands])),
    ];
    if info.bands > colors {
        entries.push((tag::EXTRA_SAMPLES, Value::Shorts((colors..info.bands).map(kind_of).collect())));
    }
    if let Some(nodata) = info.nodata {
        let text = if nodata.is_nan() { "nan".to_owned() } else { nodata.to_string() };
        entries.push((tag::GDAL_NODATA, Value::Text(text)));
    }
    Ok(entries)
}

/// What a directory says of the place of an image.
pub(super) fn geo_entries(info: &RasterInfo) -> Result<Vec<(u16, Value)>, String> {
    let mut entries = Vec::new();
    if let Some(map) = info.pixel_to_model {
        let map = if info.pixel_is_point { map.after_scale_and_shift(1.0, 1.0, 0.5, 0.5) } else { map };
        let Affine([a, b, c, d, e, f]) = map;
        if map.is_north_up() {
            entries.push((tag::PIXEL_SCALE, Value::Doubles(vec![a, -e, 0.0])));
            entries.push((tag::TIEPOINT, Value::Doubles(vec![0.0, 0.0, 0.0, c, f, 0.0])));
        } else {
            let matrix = vec![a, b, 0.0, c, d, e, 0.0, f, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
            entries.push((tag::TRANSFORMATION, Value::Doubles(matrix)));
        }
    }
    let (model, key) = match info.crs_kind {
        CrsKind::Geographic => (2, 2048),
        CrsKind::Geocentric => (3, 2048),
        CrsKind::Projected => (1, 3072),
        CrsKind::Unknown if info.crs == SourceCrs::Unknown => (0, 0),
        CrsKind::Unknown => {
            return Err(format!("is in {}, but whether that is projected or geographic is not said; say it", info.crs));
        }
    };
    let code = match &info.crs {
        SourceCrs::Unknown => None,
        SourceCrs::Epsg(code) => Some(
            u16::try_from(*code).map_err(|_| format!("EPSG:{code} is too large for a GeoTIFF, 65535 is the limit"))?,
        ),
        other => return Err(format!("coordinate system {other} has no EPSG code to write; give one")),
    };
    if info.pixel_to_model.is_none() && code.is_none() {
        return Ok(entries);
    }
    let raster_type = if info.pixel_is_point { 2 } else { 1 };
    let mut keys = vec![[1025, 0, 1, raster_type]];
    if let Some(code) = code {
        keys.insert(0, [1024, 0, 1, model]);
        keys.push([key, 0, 1, code]);
    }
    let head = [1, 1, 0, keys.len() as u16];
    entries.push((tag::GEO_KEYS, Value::Shorts(head.into_iter().chain(keys.into_iter().flatten()).collect())));
    Ok(entries)
}

/// Mark of little-endian classic TIFF, and the position of the first directory, which follows.
const HEADER: [u8; 8] = *b"II\x2a\0\x08\0\0\0";

/// A directory that begins at byte `at`, and its values that do not fit into it; `followed`: by another one.
pub(super) fn directory(entries: &[(u16, Value)], at: usize, followed: bool) -> Result<Vec<u8>, String> {
    let values_at = at + 2 + 12 * entries.len() + 4;
    let (mut out, mut values) = (Vec::new(), Vec::new());
    out.extend((entries.len() as u16).to_le_bytes());
    for (number, value) in entries {
        let (kind, count, mut bytes) = value.kind_count_bytes();
        let too_long = |_| format!("tag {number} has {count} values, too many");
        out.extend(number.to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(u32::try_from(count).map_err(too_long)?.to_le_bytes());
        if bytes.len() <= 4 {
            bytes.resize(4, 0);
            out.extend(bytes);
        } else {
            out.extend(u32::try_from(values_at + values.len()).map_err(too_long)?.to_le_bytes());
            bytes.resize(bytes.len().next_multiple_of(2), 0);
            values.extend(bytes);
        }
    }
    let next = if followed { values_at + values.len() } else { 0 };
    out.extend(u32::try_from(next).map_err(|_| TOO_LARGE)?.to_le_bytes());
    out.extend(values);
    Ok(out)
}
