//! TIFF of a finished picture: strips, deflate, resolution. Georeferenced grids are written by [`crate::geotiff`].

use super::PictureFile;
use flate2::{Compression, write::ZlibEncoder};
use rayon::prelude::*;
use std::io::{self, Seek, SeekFrom, Write};
use tempfile::SpooledTempFile;

/// Bytes of a strip before it is compressed, about.
const STRIP: usize = 1 << 20;
/// Strips that are compressed together.
const AT_ONCE: usize = 32;
/// Compressed strips from which on they go to a file without a name in the folder of temporary files, bytes; there is none in a browser.
const SPOOLED: usize = if cfg!(target_family = "wasm") { usize::MAX } else { 128 << 20 };

/// A field of the directory: tag, type, count, bytes.
struct Field(u16, u16, u32, Vec<u8>);

fn short(tag: u16, values: &[u16]) -> Field {
    Field(tag, 3, values.len() as u32, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn long(tag: u16, values: &[u32]) -> Field {
    Field(tag, 4, values.len() as u32, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn text(tag: u16, words: &str) -> Field {
    let bytes: Vec<u8> = words.bytes().filter(|b| *b != 0).chain([0]).collect();
    Field(tag, 2, bytes.len() as u32, bytes)
}

/// Thousandths of a number, > 0.
fn rational(tag: u16, value: f64) -> Field {
    let numerator = (value * 1000.0).round().clamp(1.0, f64::from(u32::MAX)) as u32;
    Field(tag, 5, 1, [numerator, 1000].iter().flat_map(|v| v.to_le_bytes()).collect())
}

/// Header, directory, and the values that do not fit into it; the fields sorted by tag.
fn directory(fields: &[Field]) -> Vec<u8> {
    let mut values_at = 8 + 2 + 12 * fields.len() + 4;
    let mut out = b"II*\0\x08\0\0\0".to_vec();
    out.extend((fields.len() as u16).to_le_bytes());
    let mut values = Vec::new();
    for Field(tag, kind, count, bytes) in fields {
        out.extend(tag.to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(count.to_le_bytes());
        if bytes.len() <= 4 {
            out.extend(bytes.iter().copied().chain(std::iter::repeat(0)).take(4));
            continue;
        }
        out.extend((values_at as u32).to_le_bytes());
        let even = bytes.len() + bytes.len() % 2;
        values.extend(bytes.iter().copied().chain(std::iter::repeat(0)).take(even));
        values_at += even;
    }
    out.extend([0; 4]);
    out.extend(values);
    out
}

/// A directory with a description alone, as EXIF has it.
pub(super) fn description_only(words: &str) -> Vec<u8> {
    directory(&[text(270, words)])
}

/// Collects rows into strips, which are compressed several at a time and kept until their directory is written.
struct Strips {
    row: usize,
    /// Bytes of a strip before it is compressed.
    size: usize,
    waiting: Vec<u8>,
    file: SpooledTempFile,
    /// Compressed sizes.
    counts: Vec<u32>,
}

impl Strips {
    /// Compresses what waits: whole strips, and with `all` the rest.
    fn compress(&mut self, all: bool) -> io::Result<()> {
        let whole = if all { self.waiting.len() } else { self.waiting.len() / self.size * self.size };
        let strips: Vec<Vec<u8>> = self.waiting[..whole]
            .par_chunks(self.size)
            .map(|strip| compress(strip, self.row))
            .collect::<io::Result<_>>()?;
        self.waiting.drain(..whole);
        for strip in strips {
            self.counts.push(u32::try_from(strip.len()).map_err(|_| too_large())?);
            self.file.write_all(&strip)?;
        }
        Ok(())
    }
}

impl Write for Strips {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let most = AT_ONCE * self.size;
        let taken = bytes.len().min(most - self.waiting.len());
        self.waiting.extend_from_slice(&bytes[..taken]);
        if self.waiting.len() >= most {
            self.compress(false)?;
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn too_large() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, "the TIFF would need 4 GiB or more; write a PNG, or fewer pixels")
}

/// * `rows`: writes the rows of the picture.
pub(super) fn encode(
    picture: &PictureFile<'_>,
    out: &mut dyn Write,
    pixels: &dyn Fn(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let row = 3 * picture.width;
    let rows = (STRIP / row).clamp(1, picture.height);
    let (size, file) = (rows * row, tempfile::spooled_tempfile(SPOOLED));
    let mut strips = Strips { row, size, waiting: Vec::with_capacity(AT_ONCE * size), file, counts: Vec::new() };
    pixels(&mut strips)?;
    strips.compress(true)?;
    let Strips { mut file, counts, .. } = strips;
    if counts.len() != picture.height.div_ceil(rows) {
        let (found, wanted) = (counts.len(), picture.height.div_ceil(rows));
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("{found} of {wanted} strips were written")));
    }
    let fields = |offsets: &[u32]| {
        let mut fields = vec![
            long(256, &[picture.width as u32]),
            long(257, &[picture.height as u32]),
            short(258, &[8, 8, 8]),
            short(259, &[8]),
            short(262, &[2]),
            long(273, offsets),
            short(277, &[3]),
            long(278, &[rows as u32]),
            long(279, &counts),
            short(284, &[1]),
            short(317, &[2]),
        ];
        let words = [(270, picture.words()), (305, picture.program().to_owned())];
        fields.extend(words.iter().filter(|(_, words)| !words.is_empty()).map(|(tag, words)| text(*tag, words)));
        if let Some(dpi) = picture.dpi {
            fields.extend([rational(282, dpi), rational(283, dpi), short(296, &[2])]);
        }
        fields.sort_by_key(|field| field.0);
        fields
    };
    let mut at = directory(&fields(&vec![0; counts.len()])).len() as u64;
    let mut offsets = Vec::with_capacity(counts.len());
    for count in &counts {
        offsets.push(u32::try_from(at).map_err(|_| too_large())?);
        at += u64::from(*count);
    }
    u32::try_from(at).map_err(|_| too_large())?;
    out.write_all(&directory(&fields(&offsets)))?;
    file.seek(SeekFrom::Start(0))?;
    io::copy(&mut file, out).map(|_| ())
}

fn compress(strip: &[u8], row: usize) -> io::Result<Vec<u8>> {
    let mut rows = strip.to_vec();
    for row in rows.chunks_exact_mut(row) {
        for i in (3..row.len()).rev() {
            row[i] = row[i].wrapping_sub(row[i - 3]);
        }
    }
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(strip.len() / 2), Compression::fast());
    encoder.write_all(&rows)?;
    encoder.finish()
}
