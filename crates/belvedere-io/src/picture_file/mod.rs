//! Finished pictures as files of several formats, with their resolution.

mod jpeg;
mod tiff;

use crate::png::{self, Channels};
use image_webp::{ColorType, WebPEncoder};
use std::io::{self, Write};
use std::path::Path;

/// Format of a picture file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// PNG.
    Png,
    /// TIFF: deflate, horizontal differences.
    Tiff,
    /// JPEG of quality 92.
    Jpeg,
    /// WebP without loss.
    WebP,
}

impl PictureFormat {
    /// The format that the ending of a file name says; `None` for other endings and for names without one.
    ///
    /// ```
    /// use belvedere_io::picture_file::PictureFormat;
    /// assert_eq!(PictureFormat::of("map.TIF".as_ref()), Some(PictureFormat::Tiff));
    /// assert_eq!(PictureFormat::of("map.bmp".as_ref()), None);
    /// ```
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match ending.as_str() {
            "png" => Self::Png,
            "tif" | "tiff" => Self::Tiff,
            "jpg" | "jpeg" => Self::Jpeg,
            "webp" => Self::WebP,
            _ => return None,
        })
    }

    /// Name of the format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Tiff => "TIFF",
            Self::Jpeg => "JPEG",
            Self::WebP => "WebP",
        }
    }

    /// Most pixels along a side.
    pub fn most_side(self) -> usize {
        match self {
            Self::Png | Self::Tiff => i32::MAX as usize,
            Self::Jpeg => 65_535,
            Self::WebP => 16_384,
        }
    }
}

/// A finished picture of 8 bits per channel, sRGB, row 0 first.
#[derive(Debug, Clone, Copy)]
pub struct PictureFile<'a> {
    /// Width, pixels.
    pub width: usize,
    /// Height, pixels.
    pub height: usize,
    /// Red, green and blue of every pixel.
    pub pixels: &'a [u8],
    /// Pixels per inch, > 0; `None` for a picture without a size on paper.
    pub dpi: Option<f64>,
    /// Keywords and texts: all of them in PNG; program, title and comment in the other formats.
    pub text: &'a [(&'a str, &'a str)],
}

impl PictureFile<'_> {
    /// Writes the picture; the same input gives the same bytes.
    ///
    /// # Errors
    /// [`io::ErrorKind::InvalidInput`] for a size that does not fit the pixels or that the format cannot hold, else what `out` says.
    pub fn encode(&self, format: PictureFormat, out: &mut dyn Write) -> io::Result<()> {
        let (width, height, most) = (self.width, self.height, format.most_side());
        let bad = |message: String| io::Error::new(io::ErrorKind::InvalidInput, message);
        if width.checked_mul(height).and_then(|n| n.checked_mul(3)) != Some(self.pixels.len()) || width * height == 0 {
            return Err(bad(format!("{width} x {height} pixels cannot be made of {} bytes", self.pixels.len())));
        }
        if width.max(height) > most {
            let name = format.name();
            return Err(bad(format!(
                "a {name} has at most {most} pixels along a side, the picture has {width} x {height}; write a PNG or a TIFF"
            )));
        }
        match format {
            PictureFormat::Png => png::encode_at(out, (width, height), Channels::Rgb, self.pixels, self.text, self.dpi),
            PictureFormat::Tiff => tiff::encode(self, out, &|rows| rows.write_all(self.pixels)),
            PictureFormat::Jpeg => jpeg::encode(self, out),
            PictureFormat::WebP => WebPEncoder::new(out)
                .encode(self.pixels, width as u32, height as u32, ColorType::Rgb8)
                .map_err(|e| io::Error::other(e.to_string())),
        }
    }

    /// Whether a format is written row by row, see [`PictureFile::encode_rows`].
    pub fn has_rows(format: PictureFormat) -> bool {
        match format {
            PictureFormat::Png | PictureFormat::Tiff => true,
            PictureFormat::Jpeg => jpeg::HAS_ROWS,
            PictureFormat::WebP => false,
        }
    }

    /// [`PictureFile::encode`] without the pixels in memory: `rows` writes them, row after row, in pieces of any size. The same pixels give the
    /// same bytes.
    ///
    /// # Errors
    /// As [`PictureFile::encode`]; [`io::ErrorKind::Unsupported`] for formats without rows; what `rows` says.
    pub fn encode_rows(
        &self,
        format: PictureFormat,
        out: &mut dyn Write,
        rows: &dyn Fn(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<()> {
        let size = (self.width, self.height);
        match format {
            PictureFormat::Png => png::encode_rows(out, size, Channels::Rgb, (self.text, self.dpi), rows),
            PictureFormat::Tiff => tiff::encode(self, out, rows),
            PictureFormat::Jpeg if jpeg::HAS_ROWS => jpeg::encode_rows(self, out, rows),
            other => {
                let reason = format!("a {} is not written row by row; write a PNG or a TIFF", other.name());
                Err(io::Error::new(io::ErrorKind::Unsupported, reason))
            }
        }
    }

    /// Title and comment in one line; empty without both.
    fn words(&self) -> String {
        let of = |key: &str| self.text.iter().find(|(k, _)| *k == key).map(|(_, v)| *v);
        let words: Vec<&str> = [of("Title"), of("Comment")].into_iter().flatten().collect();
        words.join(": ")
    }

    fn program(&self) -> &str {
        self.text.iter().find(|(key, _)| *key == "Software").map_or("", |(_, value)| value)
    }
}
