//! One slice as a picture: PNG with its 8 or 16 bits, JPEG, TIFF of one page.

use crate::formats::ends;
use crate::geotiff::Pages;
use crate::{Fault, InputFile, IoError, Limits, Photometric, Raster, RasterInfo, SampleType, Samples, budget, fs, png};
use std::path::Path;
use zune_jpeg::zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};

/// Longest side of a JPEG, pixels.
const LARGEST: usize = 65_535;

/// The pixels of a slice and the record of its file.
pub(super) fn read(path: &Path, limits: &Limits) -> Result<(Raster, InputFile), IoError> {
    if ends(path, &[".tif", ".tiff"]) {
        let pages = Pages::open(path, *limits)?;
        return Ok((pages.read(0).map_err(|e| IoError::format(path, e))?, pages.input()?));
    }
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    limits.ask("a slice", length).map_err(|e| IoError::format(path, e))?;
    let (bytes, record) = InputFile::read(path)?;
    let raster = if bytes.starts_with(b"\xff\xd8") {
        jpeg(path, &bytes, limits).map_err(|e| IoError::format(path, e))?
    } else {
        png::read_stored(path, &bytes, limits)?
    };
    Ok((raster, record))
}

/// Decodes a JPEG of 8 bits, grey or colours.
pub(super) fn jpeg(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Raster, Fault> {
    let bad = |e: String| Fault::from(format!("is a JPEG that cannot be read ({e}); it is damaged, get it again"));
    let options = DecoderOptions::default().set_max_width(LARGEST).set_max_height(LARGEST).set_strict_mode(true);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| bad(format!("{e:?}")))?;
    let (width, height) = decoder.info().map_or((0, 0), |i| (usize::from(i.width), usize::from(i.height)));
    let wanted = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => ColorSpace::Luma,
        _ => ColorSpace::RGB,
    };
    decoder.set_options(options.jpeg_set_out_colorspace(wanted));
    let bands = wanted.num_components();
    limits.ask("a slice", 2 * (bands as u64) * width as u64 * height as u64)?;
    let mut samples = budget::room("a slice", width * height * bands)?;
    samples.extend(decoder.decode().map_err(|e| bad(format!("{e:?}")))?);
    if samples.len() != width * height * bands || samples.is_empty() {
        return Err(bad(format!("{} samples of {width} x {height} pixels", samples.len())));
    }
    let mut info = RasterInfo::new(path, width, height, SampleType::U8);
    info.bands = bands;
    if bands == 3 {
        info.photometric = Photometric::Rgb([0, 1, 2]);
    }
    Ok(Raster { info, samples: Samples::U8(samples), mask: None })
}
