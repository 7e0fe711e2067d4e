//! Header, image file directories and tag values of classic TIFF and BigTIFF, in both byte orders.

use super::source::Source;
use belvedere_core::{Warning, WarningKind};
use std::collections::{BTreeMap, BTreeSet};

/// Tag numbers (TIFF 6.0, GeoTIFF 1.1 and GDAL's private ones).
pub(super) mod tag {
    pub(in super::super) const NEW_SUBFILE_TYPE: u16 = 254;
    pub(in super::super) const WIDTH: u16 = 256;
    pub(in super::super) const HEIGHT: u16 = 257;
    pub(in super::super) const BITS: u16 = 258;
    pub(in super::super) const COMPRESSION: u16 = 259;
    pub(in super::super) const PHOTOMETRIC: u16 = 262;
    pub(in super::super) const FILL_ORDER: u16 = 266;
    pub(in super::super) const DESCRIPTION: u16 = 270;
    pub(in super::super) const STRIP_OFFSETS: u16 = 273;
    pub(in super::super) const SAMPLES_PER_PIXEL: u16 = 277;
    pub(in super::super) const ROWS_PER_STRIP: u16 = 278;
    pub(in super::super) const STRIP_BYTES: u16 = 279;
    pub(in super::super) const X_RESOLUTION: u16 = 282;
    pub(in super::super) const Y_RESOLUTION: u16 = 283;
    pub(in super::super) const PLANAR: u16 = 284;
    pub(in super::super) const ARTIST: u16 = 315;
    pub(in super::super) const COPYRIGHT: u16 = 33432;
    pub(in super::super) const PREDICTOR: u16 = 317;
    pub(in super::super) const COLOR_MAP: u16 = 320;
    pub(in super::super) const TILE_WIDTH: u16 = 322;
    pub(in super::super) const TILE_HEIGHT: u16 = 323;
    pub(in super::super) const TILE_OFFSETS: u16 = 324;
    pub(in super::super) const TILE_BYTES: u16 = 325;
    pub(in super::super) const SUB_IFDS: u16 = 330;
    pub(in super::super) const EXTRA_SAMPLES: u16 = 338;
    pub(in super::super) const SAMPLE_FORMAT: u16 = 339;
    pub(in super::super) const JPEG_TABLES: u16 = 347;
    pub(in super::super) const PIXEL_SCALE: u16 = 33550;
    pub(in super::super) const TIEPOINT: u16 = 33922;
    pub(in super::super) const TRANSFORMATION: u16 = 34264;
    pub(in super::super) const GEO_KEYS: u16 = 34735;
    pub(in super::super) const GEO_DOUBLES: u16 = 34736;
    pub(in super::super) const GEO_ASCII: u16 = 34737;
    pub(in super::super) const GDAL_METADATA: u16 = 42112;
    pub(in super::super) const GDAL_NODATA: u16 = 42113;
}

const MAX_DIRECTORIES: usize = 16_384;
const MAX_ENTRIES: u64 = 4096;
/// Most entries of all directories together.
const MAX_ALL_ENTRIES: usize = 1 << 20;

/// Type, number and position of the values of a tag.
#[derive(Debug, Clone, Copy)]
struct Entry {
    kind: u16,
    count: u64,
    at: u64,
}

/// One image file directory.
#[derive(Debug)]
pub(super) struct Ifd {
    entries: BTreeMap<u16, Entry>,
    next: u64,
}

/// A file whose header made sense.
#[derive(Debug)]
pub(super) struct Container {
    pub(super) source: Source,
    pub(super) big_endian: bool,
    /// Whether positions have 64 bits.
    pub(super) big: bool,
    first: u64,
}

fn kind_size(kind: u16) -> Option<u64> {
    Some(match kind {
        1 | 2 | 6 | 7 => 1,
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16 | 17 | 18 => 8,
        _ => return None,
    })
}

impl Container {
    pub(super) fn new(source: Source) -> Result<Self, String> {
        const NOT_TIFF: &str = "is not a TIFF file: it does not start with II or MM and 42 or 43";
        let head = source.read(0, source.len().min(16), "the header")?;
        let big_endian = match head.get(..2) {
            Some(b"II") => false,
            Some(b"MM") => true,
            _ => return Err(NOT_TIFF.to_owned()),
        };
        let mut this = Self { source, big_endian, big: false, first: 0 };
        this.big = match this.uint(head.get(2..4).unwrap_or(&[])) {
            42 => false,
            43 => true,
            _ => return Err(NOT_TIFF.to_owned()),
        };
        let first = if this.big { head.get(8..16) } else { head.get(4..8) };
        this.first = this.uint(first.ok_or("ends inside its header; it is truncated, fetch it again")?);
        Ok(this)
    }

    /// Unsigned integer of up to 8 bytes in the byte order of the file.
    pub(super) fn uint(&self, bytes: &[u8]) -> u64 {
        let step = |acc: u64, &b: &u8| acc << 8 | u64::from(b);
        if self.big_endian { bytes.iter().fold(0, step) } else { bytes.iter().rev().fold(0, step) }
    }

    /// All directories of the main chain, in order, and a warning if the chain had to be cut.
    pub(super) fn directories(&self) -> Result<(Vec<Ifd>, Option<Warning>), String> {
        let mut seen = BTreeSet::new();
        let mut found = Vec::new();
        let (mut at, mut entries) = (self.first, 0);
        while at != 0 {
            if !seen.insert(at) {
                return Err(format!(
                    "its directories form a loop through byte {at}; the file is damaged, write it again"
                ));
            }
            if found.len() == MAX_DIRECTORIES || entries > MAX_ALL_ENTRIES {
                let text = format!("more than {} directories, the rest is ignored", found.len());
                return Ok((found, Some(Warning::new(WarningKind::Ignored, text))));
            }
            match self.directory(at) {
                Ok(ifd) => {
                    at = ifd.next;
                    entries += ifd.entries.len();
                    found.push(ifd);
                }
                Err(reason) if found.is_empty() => return Err(reason),
                Err(reason) => return Ok((found, Some(Warning::new(WarningKind::Ignored, reason)))),
            }
        }
        if found.is_empty() { Err("holds no image directory".to_owned()) } else { Ok((found, None)) }
    }

    /// The directory at byte `at`.
    pub(super) fn directory(&self, at: u64) -> Result<Ifd, String> {
        let (count_size, entry_size, inline) = if self.big { (8, 20, 8) } else { (2, 12, 4) };
        let count = self.uint(&self.source.read(at, count_size, "an image directory")?);
        if count == 0 || count > MAX_ENTRIES {
            return Err(format!(
                "the image directory at byte {at} has {count} entries, 1 to {MAX_ENTRIES} are possible; the file is damaged"
            ));
        }
        let body = self.source.read(at + count_size, count * entry_size + inline, "an image directory")?;
        let (rows, next) = body.split_at((count * entry_size) as usize);
        let start = at + count_size;
        let mut entries = BTreeMap::new();
        for (i, row) in rows.chunks_exact(entry_size as usize).enumerate() {
            let (head, value) = row.split_at(row.len() - inline as usize);
            let (Some(number), Some(kind), Some(count)) = (head.get(..2), head.get(2..4), head.get(4..)) else {
                continue;
            };
            let (number, kind, count) = (self.uint(number) as u16, self.uint(kind) as u16, self.uint(count));
            let Some(bytes) = kind_size(kind).and_then(|size| size.checked_mul(count)) else { continue };
            let inline_at = start + i as u64 * entry_size + head.len() as u64;
            let at = if bytes <= inline { inline_at } else { self.uint(value) };
            entries.entry(number).or_insert(Entry { kind, count, at });
        }
        Ok(Ifd { entries, next: self.uint(next) })
    }

    fn raw(&self, number: u16, entry: &Entry) -> Result<Vec<u8>, String> {
        let bytes = kind_size(entry.kind).and_then(|size| size.checked_mul(entry.count));
        self.source.read(entry.at, bytes.unwrap_or(u64::MAX), &format!("the value of tag {number}"))
    }

    /// Unsigned integers of a tag; `None` if it is absent.
    pub(super) fn uints(&self, ifd: &Ifd, number: u16) -> Result<Option<Vec<u64>>, String> {
        let Some(entry) = ifd.entries.get(&number) else { return Ok(None) };
        let size = match entry.kind {
            1 | 3 | 4 | 13 | 16 | 18 => kind_size(entry.kind).unwrap_or(1) as usize,
            other => return Err(format!("tag {number} has type {other}, an unsigned integer is needed")),
        };
        let raw = self.raw(number, entry)?;
        Ok(Some(raw.chunks_exact(size).map(|b| self.uint(b)).collect()))
    }

    /// First integer of a tag.
    pub(super) fn uint_tag(&self, ifd: &Ifd, number: u16) -> Result<Option<u64>, String> {
        Ok(self.uints(ifd, number)?.and_then(|v| v.first().copied()))
    }

    /// Floating-point numbers of a tag.
    pub(super) fn floats(&self, ifd: &Ifd, number: u16) -> Result<Option<Vec<f64>>, String> {
        let Some(entry) = ifd.entries.get(&number) else { return Ok(None) };
        let raw = self.raw(number, entry)?;
        match entry.kind {
            12 => Ok(Some(raw.chunks_exact(8).map(|b| f64::from_bits(self.uint(b))).collect())),
            11 => Ok(Some(raw.chunks_exact(4).map(|b| f64::from(f32::from_bits(self.uint(b) as u32))).collect())),
            other => Err(format!("tag {number} has type {other}, floating-point numbers are needed")),
        }
    }

    /// First fraction of a tag.
    pub(super) fn rational(&self, ifd: &Ifd, number: u16) -> Result<Option<f64>, String> {
        let Some(entry) = ifd.entries.get(&number).filter(|entry| entry.kind == 5) else { return Ok(None) };
        let raw = self.raw(number, &Entry { count: 1, ..*entry })?;
        let (over, under) = raw.split_at(4);
        Ok(Some(self.uint(over) as f64 / self.uint(under) as f64))
    }

    /// Text of a tag up to its first zero byte, damaged characters replaced.
    pub(super) fn text(&self, ifd: &Ifd, number: u16) -> Result<Option<String>, String> {
        let Some(raw) = self.blob(ifd, number)? else { return Ok(None) };
        let end = raw.iter().position(|&b| b == 0).unwrap_or(raw.len());
        Ok(Some(String::from_utf8_lossy(raw.get(..end).unwrap_or(&[])).into_owned()))
    }

    /// Bytes of a tag as they are.
    pub(super) fn blob(&self, ifd: &Ifd, number: u16) -> Result<Option<Vec<u8>>, String> {
        ifd.entries.get(&number).map(|entry| self.raw(number, entry)).transpose()
    }
}

impl Ifd {
    /// Whether the tag is there.
    pub(super) fn has(&self, number: u16) -> bool {
        self.entries.contains_key(&number)
    }
}
