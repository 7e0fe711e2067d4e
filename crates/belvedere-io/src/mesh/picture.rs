//! Pictures on meshes: PNG and JPEG.

use crate::{Fault, Limits, budget};
use belvedere_scene::{Texture, Wrap};
use std::io::Cursor;
use std::sync::Arc;
use zune_jpeg::zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};

/// Longest side that is read, pixels.
const LARGEST: usize = 16_384;
/// Bytes of a pixel at the peak of decoding.
const PEAK: u64 = 12;

/// Decodes a picture; an error states what is wrong and what to do.
pub(crate) fn read(bytes: &[u8], wrap: [Wrap; 2], limits: &Limits) -> Result<Texture, Fault> {
    let (width, height, pixels) = if bytes.starts_with(b"\x89PNG") {
        png(bytes, limits)?
    } else if bytes.starts_with(b"\xff\xd8") {
        jpeg(bytes, limits)?
    } else {
        return Err("is neither PNG nor JPEG; turn it into one of them".into());
    };
    Texture::new(width, height, pixels, wrap).ok_or_else(|| "has no pixels; it is damaged".into())
}

/// What `limits` leave beside pictures that were read.
pub(crate) fn beside(limits: &Limits, read: &[Arc<Texture>]) -> Limits {
    if budget::held() > 0 {
        return *limits;
    }
    // With the mip pyramid.
    let taken: u64 = read.iter().map(|t| 6 * t.size().iter().product::<usize>() as u64).sum();
    Limits { max_bytes: limits.max_bytes.saturating_sub(taken) }
}

type Pixels = (usize, usize, Vec<[u8; 4]>);

fn fits(width: usize, height: usize, limits: &Limits) -> Result<(), Fault> {
    if width > LARGEST || height > LARGEST {
        return Err(format!("has {width} x {height} pixels, at most {LARGEST} a side are read; make it smaller").into());
    }
    // Samples as decoded, pixels, and the mip pyramid.
    let asked = limits.ask("a picture", PEAK * width as u64 * height as u64);
    asked.map_err(|refusal| Fault::from(refusal).placed("is too large"))
}

fn png(bytes: &[u8], limits: &Limits) -> Result<Pixels, Fault> {
    let bad = |e: png::DecodingError| format!("is a PNG that cannot be read ({e}); it is damaged, get it again");
    let bytes_allowed = usize::try_from(limits.max_bytes).unwrap_or(usize::MAX);
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: bytes_allowed });
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(bad)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    fits(width, height, limits)?;
    let size = reader.output_buffer_size().unwrap_or(0);
    let mut samples = budget::room("a picture", size)?;
    samples.resize(size, 0);
    let frame = reader.next_frame(&mut samples).map_err(bad)?;
    samples.truncate(frame.buffer_size());
    let pixels = match frame.color_type {
        png::ColorType::GrayscaleAlpha => samples.chunks_exact(2).map(|p| [p[0], p[0], p[0], p[1]]).collect(),
        _ => samples.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect(),
    };
    Ok((width, height, pixels))
}

fn jpeg(bytes: &[u8], limits: &Limits) -> Result<Pixels, Fault> {
    let bad = |e: String| format!("is a JPEG that cannot be read ({e}); it is damaged, get it again");
    let options = DecoderOptions::default().set_max_width(LARGEST).set_max_height(LARGEST);
    let options = options.jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| bad(format!("{e:?}")))?;
    let (width, height) = decoder.info().map_or((0, 0), |i| (usize::from(i.width), usize::from(i.height)));
    fits(width, height, limits)?;
    let samples = decoder.decode().map_err(|e| bad(format!("{e:?}")))?;
    Ok((width, height, samples.chunks_exact(3).map(|p| [p[0], p[1], p[2], 255]).collect()))
}
