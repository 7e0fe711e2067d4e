//! How one image of a file is cut into chunks (strips or tiles), and of which type its samples are.

use super::ifd::{Container, Ifd, tag};
use crate::raster::SampleType;
use std::ops::Range;

/// Compression of the chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Lzw,
    Deflate,
    PackBits,
    Zstd,
    Jpeg,
}

impl Compression {
    fn from_code(code: u64) -> Result<Self, String> {
        let name = match code {
            1 => return Ok(Self::None),
            5 => return Ok(Self::Lzw),
            8 | 32946 => return Ok(Self::Deflate),
            32773 => return Ok(Self::PackBits),
            50000 => return Ok(Self::Zstd),
            7 => return Ok(Self::Jpeg),
            2..=4 | 32771 => "CCITT fax",
            6 => "old-style JPEG",
            34712 => "JPEG 2000",
            34887 => "LERC",
            34925 => "LZMA",
            50001 => "WebP",
            50002 | 52546 => "JPEG XL",
            _ => "unknown",
        };
        Err(format!(
            "compression {code} ({name}) is not supported; convert it to deflate, LZW or ZSTD, for example with gdal_translate -co COMPRESS=DEFLATE"
        ))
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Lzw => "LZW",
            Self::Deflate => "deflate",
            Self::PackBits => "PackBits",
            Self::Zstd => "ZSTD",
            Self::Jpeg => "JPEG",
        }
    }

    /// Whether the predictor tag means something; elsewhere it is ignored, as libtiff does.
    pub(super) fn takes_predictor(self) -> bool {
        matches!(self, Self::Lzw | Self::Deflate | Self::Zstd)
    }

    /// Decoded bytes per stored byte at most; a file that claims more is damaged or hostile.
    fn max_ratio(self) -> u64 {
        match self {
            Self::None => 1,
            Self::PackBits => 64,
            Self::Deflate => 1040,
            Self::Lzw => 4096,
            Self::Jpeg => 8192,
            Self::Zstd => 65536,
        }
    }
}

/// Bits of a stored sample and what they mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stored {
    /// As in memory, but for byte order.
    Plain(SampleType),
    /// Unsigned, 1, 2 or 4 bits, becomes uint8.
    Packed(u8),
    /// Floating point of 16 bits, becomes float32.
    Half,
}

impl Stored {
    pub(super) fn sample_type(self) -> SampleType {
        match self {
            Self::Plain(t) => t,
            Self::Packed(_) => SampleType::U8,
            Self::Half => SampleType::F32,
        }
    }

    pub(super) fn bits(self) -> u64 {
        match self {
            Self::Plain(t) => 8 * t.size() as u64,
            Self::Packed(bits) => u64::from(bits),
            Self::Half => 16,
        }
    }

    fn new(bits: u64, format: u64) -> Result<Self, String> {
        use SampleType as T;
        Ok(match (format, bits) {
            (1 | 4, 1 | 2 | 4) => Self::Packed(bits as u8),
            (1 | 4, 8) => Self::Plain(T::U8),
            (1 | 4, 16) => Self::Plain(T::U16),
            (1 | 4, 32) => Self::Plain(T::U32),
            (1 | 4, 64) => Self::Plain(T::U64),
            (2, 8) => Self::Plain(T::I8),
            (2, 16) => Self::Plain(T::I16),
            (2, 32) => Self::Plain(T::I32),
            (2, 64) => Self::Plain(T::I64),
            (3, 16) => Self::Half,
            (3, 32) => Self::Plain(T::F32),
            (3, 64) => Self::Plain(T::F64),
            (5 | 6, _) => return Err("samples are complex numbers; extract the real part first".to_owned()),
            _ => {
                return Err(format!(
                    "samples have {bits} bits in format {format}; integers of 1, 2, 4, 8, 16, 32, 64 bits and floats of 16, 32, 64 bits are supported"
                ));
            }
        })
    }
}

/// One image of a file: size, samples, chunks.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) bands: usize,
    pub(super) stored: Stored,
    pub(super) compression: Compression,
    pub(super) predictor: u64,
    /// Whether every band has chunks of its own.
    pub(super) planar: bool,
    pub(super) tiled: bool,
    pub(super) photometric: u64,
    pub(super) chunk_width: usize,
    pub(super) chunk_height: usize,
    /// Chunks side by side and one below the other.
    pub(super) chunks: [usize; 2],
    offsets: Vec<u64>,
    counts: Vec<u64>,
    pub(super) jpeg_tables: Vec<u8>,
}

/// Largest sensible width or height.
const MAX_SIDE: u64 = i32::MAX as u64;

fn side(container: &Container, ifd: &Ifd, number: u16, what: &str) -> Result<usize, String> {
    let value = container.uint_tag(ifd, number)?.ok_or_else(|| format!("has no {what} (tag {number})"))?;
    if value == 0 || value > MAX_SIDE {
        return Err(format!("{what} is {value} pixels, 1 to {MAX_SIDE} are possible"));
    }
    usize::try_from(value).map_err(|_| format!("{what} of {value} pixels is too large for this machine"))
}

impl Layout {
    pub(super) fn new(container: &Container, ifd: &Ifd) -> Result<Self, String> {
        let one = |number: u16, default: u64| Ok::<_, String>(container.uint_tag(ifd, number)?.unwrap_or(default));
        let side = |number: u16, what: &str| side(container, ifd, number, what);
        let (width, height) = (side(tag::WIDTH, "width")?, side(tag::HEIGHT, "height")?);
        let bands = one(tag::SAMPLES_PER_PIXEL, 1)?;
        if bands == 0 || bands > 65535 {
            return Err(format!("has {bands} samples per pixel, 1 to 65535 are possible"));
        }
        let same = |number: u16, default: u64, what: &str| -> Result<u64, String> {
            let values = container.uints(ifd, number)?.unwrap_or_default();
            let first = values.first().copied().unwrap_or(default);
            if let Some(other) = values.iter().find(|&&v| v != first) {
                return Err(format!("bands differ in {what} ({first} and {other}); convert them to one type"));
            }
            Ok(first)
        };
        let bits = same(tag::BITS, 1, "bits per sample")?;
        let stored = Stored::new(bits, same(tag::SAMPLE_FORMAT, 1, "sample format")?)?;
        let compression = Compression::from_code(one(tag::COMPRESSION, 1)?)?;
        let predictor = one(tag::PREDICTOR, 1)?;
        let tiled = ifd.has(tag::TILE_WIDTH);
        let [chunk_width, chunk_height] = if tiled {
            [side(tag::TILE_WIDTH, "tile width")?, side(tag::TILE_HEIGHT, "tile height")?]
        } else {
            let rows = one(tag::ROWS_PER_STRIP, u64::MAX)?;
            if rows == 0 {
                return Err("has strips of 0 rows; the file is damaged".to_owned());
            }
            [width, rows.min(height as u64) as usize]
        };
        let (offsets, counts) = if tiled && ifd.has(tag::TILE_OFFSETS) {
            (tag::TILE_OFFSETS, tag::TILE_BYTES)
        } else {
            (tag::STRIP_OFFSETS, tag::STRIP_BYTES)
        };
        let offsets = container.uints(ifd, offsets)?.ok_or("lists no strips or tiles; there are no pixels in it")?;
        let counts = container.uints(ifd, counts)?.unwrap_or_default();
        let mut this = Self {
            width,
            height,
            bands: bands as usize,
            stored,
            compression,
            predictor,
            planar: bands > 1 && one(tag::PLANAR, 1)? == 2,
            tiled,
            photometric: one(tag::PHOTOMETRIC, 1)?,
            chunk_width,
            chunk_height,
            chunks: [width.div_ceil(chunk_width), height.div_ceil(chunk_height)],
            offsets,
            counts,
            jpeg_tables: container.blob(ifd, tag::JPEG_TABLES)?.unwrap_or_default(),
        };
        this.check(one(tag::FILL_ORDER, 1)?)?;
        this.check_chunks(container.source.len())?;
        Ok(this)
    }

    fn check(&self, fill_order: u64) -> Result<(), String> {
        let bits = self.stored.bits();
        let fits = match self.predictor {
            1 => true,
            2 => matches!(self.stored, Stored::Plain(_)),
            3 => matches!(self.stored, Stored::Half | Stored::Plain(SampleType::F32 | SampleType::F64)),
            _ => false,
        };
        if !fits && self.compression.takes_predictor() {
            return Err(format!("predictor {} does not go with samples of {bits} bits", self.predictor));
        }
        if bits < 8 && (self.planar || self.bands > 1) {
            return Err(format!("{} bands of {bits} bits are not supported; convert them to 8 bits", self.bands));
        }
        if fill_order != 1 && bits < 8 {
            return Err(format!("bits are stored in fill order {fill_order}, only 1 is supported"));
        }
        if self.compression == Compression::Jpeg && self.stored != Stored::Plain(SampleType::U8) {
            return Err(format!("JPEG with samples of {bits} bits is not supported, only 8 bits"));
        }
        match self.photometric {
            0..=4 | 6 if self.photometric != 6 || self.compression == Compression::Jpeg => Ok(()),
            5 => Err("colours are CMYK; convert them to RGB".to_owned()),
            6 => Err("colours are YCbCr without JPEG; convert them to RGB".to_owned()),
            other => Err(format!("photometric interpretation {other} is not supported; convert it to RGB or grey")),
        }
    }

    /// The lists of chunks must be long enough, the chunks inside the file and not impossibly small.
    fn check_chunks(&mut self, file_len: u64) -> Result<(), String> {
        let planes = if self.planar { self.bands as u64 } else { 1 };
        let needed = (self.chunks[0] as u64)
            .checked_mul(self.chunks[1] as u64)
            .and_then(|n| n.checked_mul(planes))
            .ok_or("has too many strips or tiles")?;
        let kind = self.kind();
        if (self.offsets.len() as u64) < needed {
            return Err(format!("lists {} {kind}s, {needed} are needed; the file is damaged", self.offsets.len()));
        }
        let bytes = self.chunk_bytes(self.chunk_height)?;
        if self.counts.is_empty() && self.compression == Compression::None {
            self.counts = (0..needed).map(|i| self.plain_bytes(i)).collect::<Result<_, _>>()?;
        }
        if (self.counts.len() as u64) < needed {
            return Err(format!("lists {} sizes of {kind}s, {needed} are needed", self.counts.len()));
        }
        for (i, (&at, &count)) in self.offsets.iter().zip(&self.counts).take(needed as usize).enumerate() {
            if count == 0 || at == 0 {
                continue;
            }
            if at.checked_add(count).is_none_or(|end| end > file_len) {
                return Err(format!(
                    "{kind} {} of {needed} should be {count} bytes at byte {at}, but the file ends at byte {file_len}; it is truncated or damaged, fetch it again",
                    i + 1
                ));
            }
            let expected = if self.tiled { bytes } else { self.plain_bytes(i as u64)? };
            let most = count.saturating_add(64).saturating_mul(self.compression.max_ratio());
            let enough = if self.compression == Compression::None { count >= expected } else { most >= expected };
            if !enough {
                return Err(format!(
                    "{kind} {} of {needed} has {count} bytes, which cannot hold the {expected} bytes it should; the file is damaged",
                    i + 1
                ));
            }
        }
        Ok(())
    }

    /// The same, `by` bytes later in the file.
    pub(super) fn moved(&self, by: u64) -> Self {
        Self { offsets: self.offsets.iter().map(|at| at.saturating_add(by)).collect(), ..self.clone() }
    }

    /// `strip` or `tile`.
    pub(super) fn kind(&self) -> &'static str {
        if self.tiled { "tile" } else { "strip" }
    }

    /// Bands in one chunk.
    pub(super) fn chunk_bands(&self) -> usize {
        if self.planar { 1 } else { self.bands }
    }

    /// Bytes of one row of a chunk as stored (after decompression).
    pub(super) fn row_bytes(&self) -> Result<u64, String> {
        (self.chunk_width as u64)
            .checked_mul(self.chunk_bands() as u64)
            .and_then(|n| n.checked_mul(self.stored.bits()))
            .map(|bits| bits.div_ceil(8))
            .ok_or_else(|| format!("one row of a {} is too large", self.kind()))
    }

    /// Bytes of `rows` rows of a chunk.
    pub(super) fn chunk_bytes(&self, rows: usize) -> Result<u64, String> {
        self.row_bytes()?.checked_mul(rows as u64).ok_or_else(|| format!("a {} is too large", self.kind()))
    }

    /// Rows stored in a chunk of chunk row `row`: the last strip may be shorter, tiles are always whole.
    pub(super) fn rows_in(&self, row: usize) -> usize {
        if self.tiled { self.chunk_height } else { self.chunk_height.min(self.height - row * self.chunk_height) }
    }

    fn plain_bytes(&self, index: u64) -> Result<u64, String> {
        let per_plane = (self.chunks[0] * self.chunks[1]).max(1) as u64;
        self.chunk_bytes(self.rows_in((index % per_plane) as usize / self.chunks[0]))
    }

    /// Position and size of a chunk; `None` if it was left out (all no data).
    pub(super) fn chunk(&self, plane: usize, row: usize, col: usize) -> Option<(u64, u64)> {
        let index = (plane * self.chunks[1] + row) * self.chunks[0] + col;
        let (at, count) = (*self.offsets.get(index)?, *self.counts.get(index)?);
        (at != 0 && count != 0).then_some((at, count))
    }

    /// Columns and rows of samples around all chunks that were not left out; `None` if all were.
    pub(super) fn stored(&self) -> Option<[Range<usize>; 2]> {
        let planes = if self.planar { self.bands } else { 1 };
        let [across, down] = self.chunks;
        let there = |row: usize, col: usize| (0..planes).any(|plane| self.chunk(plane, row, col).is_some());
        let mut found: Option<[usize; 4]> = None;
        for (row, col) in (0..down).flat_map(|r| (0..across).map(move |c| (r, c))).filter(|(r, c)| there(*r, *c)) {
            let [left, top, right, bottom] = found.unwrap_or([col, row, col, row]);
            found = Some([left.min(col), top.min(row), right.max(col), bottom.max(row)]);
        }
        let [left, top, right, bottom] = found?;
        let (width, height) = (self.chunk_width, self.chunk_height);
        let samples = |from: usize, to: usize, side: usize, all: usize| from * side..((to + 1) * side).min(all);
        Some([samples(left, right, width, self.width), samples(top, bottom, height, self.height)])
    }

    /// Positions in the file of the chunks of these columns and rows of chunks, in all planes.
    pub(super) fn positions(&self, cols: Range<usize>, rows: Range<usize>) -> impl Iterator<Item = u64> {
        let planes = if self.planar { self.bands } else { 1 };
        let line = move |plane: usize, row: usize| {
            let first = (plane * self.chunks[1] + row) * self.chunks[0];
            self.offsets.get(first + cols.start..first + cols.end).unwrap_or(&[])
        };
        (0..planes)
            .flat_map(move |plane| rows.clone().map(move |row| (plane, row)))
            .flat_map(move |(p, r)| line(p, r))
            .copied()
    }

    /// Bytes of the samples of a `cols` x `rows` window in memory.
    pub(super) fn decoded_bytes(&self, cols: usize, rows: usize) -> Result<u64, String> {
        (cols as u64)
            .checked_mul(rows as u64)
            .and_then(|n| n.checked_mul(self.bands as u64))
            .and_then(|n| n.checked_mul(self.stored.sample_type().size() as u64))
            .ok_or_else(|| format!("{cols} x {rows} pixels of {} bands are too many", self.bands))
    }
}
