//! The picture of one tile: red, green, blue and alpha of its pixels, without loss.

use crate::{Fault, IoError, LiftedBy, Limits, Samples, png};
use image_webp::WebPDecoder;
use std::io::Cursor;
use std::path::Path;

/// Fewest and most pixels along a side of a tile, without its border.
const SIDES: [usize; 2] = [16, 4096];

/// Why tiles of features are no ground, and of photographs.
pub(super) const VECTORS: &str =
    "holds vector tiles (pbf), which are map features and no heights; ogr2ogr turns them into GeoJSON";
pub(super) const PHOTOS: &str = "holds tiles of pictures (JPEG), which are no heights; gdal_translate turns them into a GeoTIFF, which is drawn over terrain as a drape";

/// A square picture.
pub(super) struct Picture {
    /// Pixels along a side; a power of two.
    pub(super) side: usize,
    pub(super) pixels: Vec<[u8; 4]>,
}

/// Columns, rows and pixels of a picture of any shape.
type Shaped = (usize, usize, Vec<[u8; 4]>);

impl Picture {
    /// Decodes PNG or lossless WebP; a border of one pixel around a power of two, which lies over the neighbours, is cut off.
    ///
    /// # Errors
    /// A predicate for what is no such picture.
    pub(super) fn of(bytes: &[u8], limits: &Limits) -> Result<Self, Fault> {
        let (width, height, pixels) = match bytes {
            [0x89, b'P', b'N', b'G', ..] => of_png(bytes, limits)?,
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => of_webp(bytes, limits)?,
            _ => return Err("is neither PNG nor WebP".into()),
        };
        let border = usize::from(!width.is_power_of_two());
        let side = width.saturating_sub(2 * border);
        if width != height || !side.is_power_of_two() || !(SIDES[0]..=SIDES[1]).contains(&side) {
            let [least, most] = SIDES;
            let reason =
                format!("has {width} x {height} pixels, a square of a power of two from {least} to {most} is needed");
            return Err(reason.into());
        }
        if border == 0 {
            return Ok(Self { side, pixels });
        }
        let rows = pixels.chunks(width).skip(1).take(side);
        Ok(Self { side, pixels: rows.flat_map(|row| row[1..=side].iter().copied()).collect() })
    }
}

/// Why tiles of other kinds are no ground, if their first bytes tell.
pub(super) fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xff, 0xd8, 0xff, ..] => Some(PHOTOS),
        // Layers of vector tiles are fields of the number 3, most often packed by gzip.
        [0x1f, 0x8b, ..] | [0x1a, ..] => Some(VECTORS),
        _ => None,
    }
}

fn of_png(bytes: &[u8], limits: &Limits) -> Result<Shaped, Fault> {
    let raster = png::read_stored(Path::new("a tile"), bytes, limits).map_err(|e| match e {
        IoError::Format { reason, lifted_by: LiftedBy::OtherFile, .. } => Fault::from(reason),
        other => other.into(),
    })?;
    let Samples::U8(samples) = raster.samples else {
        return Err("has 16 bits per sample, 8 are needed".into());
    };
    Ok((raster.info.width, raster.info.height, with_alpha(&samples, raster.info.bands)?))
}

fn of_webp(bytes: &[u8], limits: &Limits) -> Result<Shaped, Fault> {
    let bad = |e: image_webp::DecodingError| Fault::from(format!("is a damaged WebP ({e})"));
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(bad)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    limits.ask("a tile", 8 * width as u64 * height as u64)?;
    if decoder.is_lossy() {
        return Err("is a WebP with loss, which keeps no heights; lossless WebP and PNG do".into());
    }
    let size = decoder.output_buffer_size().ok_or("is too large")?;
    let mut samples = vec![0; size];
    decoder.read_image(&mut samples).map_err(bad)?;
    let bands = if decoder.has_alpha() { 4 } else { 3 };
    Ok((width, height, with_alpha(&samples, bands)?))
}

fn with_alpha(samples: &[u8], bands: usize) -> Result<Vec<[u8; 4]>, String> {
    match bands {
        3 => Ok(samples.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 255]).collect()),
        4 => Ok(samples.as_chunks::<4>().0.to_vec()),
        other => Err(format!("has {other} bands, red, green and blue are needed")),
    }
}
