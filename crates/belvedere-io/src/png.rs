//! PNG pictures with provenance in text chunks.

use crate::fs::File;
use crate::{Alpha, IoError, Limits, Photometric, Raster, RasterInfo, Samples, atomic, budget};
use png::{BitDepth, ColorType, Compression, Encoder, Filter, PixelDimensions, SrgbRenderingIntent, Unit};
use std::io::{self, BufRead, BufReader, Seek, Write};
use std::path::Path;

/// Longest keyword that the format allows, bytes.
const MAX_KEYWORD: usize = 79;
/// Bytes of compressed pixels in a chunk.
const PIECE: usize = 1 << 20;

/// Channels of a picture of 8 bits per channel, sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channels {
    /// Brightness.
    Gray,
    /// Red, green, blue.
    Rgb,
    /// Red, green, blue and straight alpha.
    Rgba,
}

impl Channels {
    /// Bytes per pixel.
    pub fn count(self) -> usize {
        match self {
            Self::Gray => 1,
            Self::Rgb => 3,
            Self::Rgba => 4,
        }
    }
}

/// Writes a picture of `width` x `height` pixels, row 0 first, as PNG; the same input gives the same bytes.
///
/// `text` holds keyword and text of each text chunk, in order: `tEXt` where both are ASCII, `iTXt` else. Keywords need
/// 1 to 79 printable ASCII characters.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] for a size that does not fit `pixels` or a bad keyword, else what `out` says.
pub fn encode(
    out: &mut dyn Write,
    width: usize,
    height: usize,
    channels: Channels,
    pixels: &[u8],
    text: &[(&str, &str)],
) -> io::Result<()> {
    encode_at(out, (width, height), channels, pixels, text, None)
}

/// [`encode`] with a physical size in a `pHYs` chunk.
///
/// * `dpi`: pixels per inch, > 0.
///
/// # Errors
/// As [`encode`].
pub fn encode_at(
    out: &mut dyn Write,
    (width, height): (usize, usize),
    channels: Channels,
    pixels: &[u8],
    text: &[(&str, &str)],
    dpi: Option<f64>,
) -> io::Result<()> {
    let expected = width.checked_mul(height).and_then(|n| n.checked_mul(channels.count()));
    if expected != Some(pixels.len()) {
        let bytes = pixels.len();
        let reason = format!("a PNG of {width} x {height} pixels with {channels:?} cannot be made of {bytes} bytes");
        return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    }
    encode_rows(out, (width, height), channels, (text, dpi), &|rows| rows.write_all(pixels))
}

/// [`encode_at`] without the pixels in memory: `rows` writes them, row after row, in pieces of any size. The same pixels give the same bytes.
///
/// # Errors
/// As [`encode`]; what `rows` says.
pub fn encode_rows(
    out: &mut dyn Write,
    (width, height): (usize, usize),
    channels: Channels,
    (text, dpi): (&[(&str, &str)], Option<f64>),
    rows: &dyn Fn(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let bad = |message: String| io::Error::new(io::ErrorKind::InvalidInput, message);
    let side = |n: usize| u32::try_from(n).ok().filter(|n| (1..=i32::MAX as u32).contains(n));
    let (Some(w), Some(h)) = (side(width), side(height)) else {
        return Err(bad(format!("a PNG of {width} x {height} pixels with {channels:?} cannot be made")));
    };
    let mut encoder = Encoder::new(out, w, h);
    encoder.set_color(match channels {
        Channels::Gray => ColorType::Grayscale,
        Channels::Rgb => ColorType::Rgb,
        Channels::Rgba => ColorType::Rgba,
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Adaptive);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    if let Some(dpi) = dpi {
        let per_metre = (dpi / 0.0254).round().clamp(1.0, f64::from(u32::MAX)) as u32;
        encoder.set_pixel_dims(Some(PixelDimensions { xppu: per_metre, yppu: per_metre, unit: Unit::Meter }));
    }
    for (keyword, value) in text {
        let printable = keyword.bytes().all(|b| (0x20..0x7f).contains(&b)) && keyword.trim() == *keyword;
        if keyword.is_empty() || keyword.len() > MAX_KEYWORD || !printable {
            return Err(bad(format!("PNG keyword {keyword:?} is not 1 to {MAX_KEYWORD} printable ASCII characters")));
        }
        // a zero byte ends a text chunk
        let value = value.replace('\0', " ");
        let added = if value.is_ascii() {
            encoder.add_text_chunk((*keyword).to_owned(), value)
        } else {
            encoder.add_itxt_chunk((*keyword).to_owned(), value)
        };
        added.map_err(io_error)?;
    }
    let mut writer = encoder.write_header().map_err(io_error)?;
    let mut image = writer.stream_writer_with_size(PIECE).map_err(io_error)?;
    rows(&mut image)?;
    image.finish().map_err(io_error)?;
    writer.finish().map_err(io_error)
}

fn io_error(e: png::EncodingError) -> io::Error {
    match e {
        png::EncodingError::IoError(e) => e,
        other => io::Error::other(other.to_string()),
    }
}

/// [`encode`] into a file, see [`atomic::write_atomic`].
///
/// # Errors
/// [`IoError::Exists`], [`IoError::Os`].
pub fn write(
    path: &Path,
    overwrite: bool,
    width: usize,
    height: usize,
    channels: Channels,
    pixels: &[u8],
    text: &[(&str, &str)],
) -> Result<(), IoError> {
    atomic::write_atomic(path, overwrite, |out| encode(out, width, height, channels, pixels, text))
}

/// Reads a PNG picture as 8-bit RGBA without georeference.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] if it is damaged or larger than the limit.
pub fn read(path: &Path, limits: &Limits) -> Result<Raster, IoError> {
    let file = File::open(path).map_err(|e| IoError::os(path, e))?;
    let wanted = png::Transformations::normalize_to_color8() | png::Transformations::ALPHA;
    decoded(path, BufReader::new(file), wanted, limits)
}

/// Reads the bytes of a PNG as it is stored, of 8 or 16 bits, without an alpha band that is not there.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_stored(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Raster, IoError> {
    decoded(path, io::Cursor::new(bytes), png::Transformations::EXPAND, limits)
}

fn decoded(
    path: &Path,
    source: impl BufRead + Seek,
    wanted: png::Transformations,
    limits: &Limits,
) -> Result<Raster, IoError> {
    let bad = |e: png::DecodingError| match e {
        png::DecodingError::IoError(e) if e.kind() != io::ErrorKind::UnexpectedEof => IoError::os(path, e),
        e => IoError::format(path, format!("the PNG cannot be read ({e}); it is damaged, get it again")),
    };
    let bytes = usize::try_from(limits.max_bytes).unwrap_or(usize::MAX);
    let mut decoder = png::Decoder::new_with_limits(source, png::Limits { bytes });
    decoder.set_transformations(wanted);
    let mut reader = decoder.read_info().map_err(bad)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    // Samples, and colours made of them.
    limits.check(8 * width as u64 * height as u64).map_err(|reason| IoError::format(path, reason))?;
    let size = reader.output_buffer_size().unwrap_or(0);
    let mut samples = budget::room("the picture", size).map_err(|reason| IoError::format(path, reason))?;
    samples.resize(size, 0);
    let frame = reader.next_frame(&mut samples).map_err(bad)?;
    samples.truncate(frame.buffer_size());
    let samples = match frame.bit_depth {
        BitDepth::Sixteen => Samples::U16(samples.as_chunks::<2>().0.iter().map(|b| u16::from_be_bytes(*b)).collect()),
        _ => Samples::U8(samples),
    };
    let mut info = RasterInfo::new(path, width, height, samples.sample_type());
    (info.bands, info.photometric, info.alpha) = match frame.color_type {
        ColorType::Grayscale => (1, Photometric::Gray, Alpha::None),
        ColorType::GrayscaleAlpha => (2, Photometric::Gray, Alpha::Straight(1)),
        ColorType::Rgb => (3, Photometric::Rgb([0, 1, 2]), Alpha::None),
        _ => (4, Photometric::Rgb([0, 1, 2]), Alpha::Straight(3)),
    };
    if samples.len() != width * height * info.bands {
        return Err(IoError::format(path, format!("the PNG holds {} samples, not what its size says", samples.len())));
    }
    Ok(Raster { info, samples, mask: None })
}
