//! PMTiles, version 3: tiles in one file behind directories of their places.
//!
//! Source: Protomaps, PMTiles Version 3 Specification.

use super::folder::encoding_in;
use super::key::{Key, MOST_ZOOM};
use super::store::{Listed, Store, Tile, unpacked};
use crate::geotiff::Source;
use crate::{Fault, IoError, Limits};
use std::path::Path;

/// Bytes of the header.
const HEADER: usize = 127;
/// Deepest directories; the specification asks for no more than three.
const MOST_DEPTH: usize = 4;
/// Most bytes of a directory, unpacked.
const MOST_DIRECTORY: u64 = 64 << 20;

/// What the header says.
struct Header {
    root: [u64; 2],
    metadata: [u64; 2],
    leaves: [u64; 2],
    data: [u64; 2],
    /// Compressions of directories, and of tiles.
    packed: [u8; 2],
    kind: u8,
}

impl Header {
    fn of(bytes: &[u8]) -> Result<Self, String> {
        let Some(head) = bytes.first_chunk::<HEADER>().filter(|head| head.starts_with(b"PMTiles")) else {
            return Err("does not begin with the header of PMTiles; it is damaged or cut off, get it again".into());
        };
        if head[7] != 3 {
            return Err(format!("is PMTiles of version {}, version 3 is read; pmtiles convert makes it", head[7]));
        }
        let number = |at: usize| head[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        let part = |at: usize| [number(at), number(at + 8)];
        let [root, metadata, leaves, data] = [part(8), part(24), part(40), part(56)];
        Ok(Self { root, metadata, leaves, data, packed: [head[97], head[98]], kind: head[99] })
    }

    fn check_kind(&self) -> Result<(), String> {
        match self.kind {
            1 | 6 => Err(super::picture::VECTORS.into()),
            3 => Err(super::picture::PHOTOS.into()),
            5 => Err("holds tiles as AVIF, which are not read; PNG and lossless WebP are".into()),
            _ => Ok(()),
        }
    }
}

/// Whether bytes of a compression are packed by gzip.
fn is_gzip(compression: u8, what: &str) -> Result<bool, String> {
    let name = match compression {
        0 | 1 => return Ok(false),
        2 => return Ok(true),
        3 => "Brotli",
        4 => "Zstandard",
        _ => "an unknown method",
    };
    Err(format!("has {what} packed by {name}, gzip is read; pack it again with gzip"))
}

/// Lists the tiles of a file.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for what is damaged, cut off or packed by other methods.
pub(super) fn list(path: &Path, limits: &Limits) -> Result<Listed, IoError> {
    let source = Source::open(path).map_err(|e| IoError::os(path, e))?;
    let bad = |e: Fault| IoError::format(path, e);
    let read = || -> Result<_, Fault> {
        let mut head = Vec::new();
        source.read_into(0, source.len().min(HEADER as u64), "the header", &mut head)?;
        let header = Header::of(&head)?;
        header.check_kind()?;
        let [of_directories, of_tiles] = header.packed;
        let is_packed = is_gzip(of_directories, "directories")?;
        let tiles_packed = is_gzip(of_tiles, "tiles")?;
        let end = header.data[0].saturating_add(header.data[1]);
        if end > source.len() {
            let reason =
                format!("is {} bytes long, its header says {end}; the file is cut off, get it again", source.len());
            return Err(reason.into());
        }
        let left = header.leaves[1];
        let (source, header) = (&source, &header);
        let mut directories = Directories { source, header, is_packed, limits, left, tiles: Vec::new(), odd: 0 };
        directories.walk(header.root, MOST_DEPTH)?;
        let encoding = directories.part(header.metadata, "the metadata").ok().and_then(|json| encoding_in(&json));
        let Directories { tiles, odd, .. } = directories;
        Ok((tiles, odd, encoding, header.data[0], tiles_packed))
    };
    let (tiles, odd, encoding, start, is_packed) = read().map_err(bad)?;
    let file = source.input(path)?;
    Ok(Listed { tiles, store: Store::File { source, start, is_packed }, encoding, odd, file: Some(file) })
}

/// A walk through the directories.
struct Directories<'a> {
    source: &'a Source,
    header: &'a Header,
    is_packed: bool,
    limits: &'a Limits,
    /// Bytes of leaves that may still be read: none is read twice.
    left: u64,
    tiles: Vec<Tile>,
    /// Tiles that are deeper than is read.
    odd: usize,
}

/// An entry of a directory.
#[derive(Clone, Copy, Default)]
struct Entry {
    id: u64,
    run: u64,
    length: u64,
    offset: u64,
}

impl Directories<'_> {
    /// The bytes of a part of the file, unpacked.
    fn part(&self, [at, count]: [u64; 2], what: &str) -> Result<Vec<u8>, Fault> {
        self.limits.ask(what, count)?;
        let mut bytes = Vec::new();
        self.source.read_into(at, count, what, &mut bytes)?;
        let most = MOST_DIRECTORY;
        Ok(if self.is_packed { unpacked(&bytes, most).map_err(|e| format!("{what} {e}"))? } else { bytes })
    }

    fn walk(&mut self, part: [u64; 2], depth: usize) -> Result<(), Fault> {
        let depth = depth.checked_sub(1).ok_or("is damaged: its directories lie too deep; get it again")?;
        let bytes = self.part(part, "a directory")?;
        let entries = entries(&bytes).ok_or("is damaged or cut off: a directory ends too early; get it again")?;
        for entry in entries {
            if entry.run > 0 {
                self.take(entry)?;
                continue;
            }
            let [start, all] = self.header.leaves;
            let is_inside = entry.offset.checked_add(entry.length).is_some_and(|end| end <= all);
            let left = self.left.checked_sub(entry.length).filter(|_| is_inside && entry.length > 0);
            self.left = left.ok_or("is damaged: a directory lies outside of its part; get it again")?;
            self.walk([start + entry.offset, entry.length], depth)?;
        }
        Ok(())
    }

    /// Takes the tiles of an entry, which are all the same.
    fn take(&mut self, entry: Entry) -> Result<(), Fault> {
        let is_inside = entry.offset.checked_add(entry.length).is_some_and(|end| end <= self.header.data[1]);
        let length = u32::try_from(entry.length).ok().filter(|_| is_inside);
        let length = length.ok_or("is damaged: a tile lies outside of its part; get it again")?;
        let count = (self.tiles.len() as u64).saturating_add(entry.run);
        self.limits.ask("the list of tiles", count.saturating_mul(2 * size_of::<Tile>() as u64))?;
        for id in entry.id..entry.id.saturating_add(entry.run) {
            match key_of(id) {
                Some(key) => self.tiles.push(Tile { key, at: entry.offset, length }),
                None => {
                    self.odd = self.odd.saturating_add((entry.id + entry.run - id) as usize);
                    break;
                }
            }
        }
        Ok(())
    }
}

/// The entries of a directory; `None` if it ends too early.
fn entries(bytes: &[u8]) -> Option<Vec<Entry>> {
    let mut rest = bytes;
    let count = varint(&mut rest)?;
    // Each entry has four numbers.
    let count = usize::try_from(count).ok().filter(|count| *count <= rest.len() / 4)?;
    let mut out = vec![Entry::default(); count];
    let mut id = 0u64;
    for entry in &mut out {
        id = id.checked_add(varint(&mut rest)?)?;
        entry.id = id;
    }
    for entry in &mut out {
        entry.run = varint(&mut rest)?;
    }
    for entry in &mut out {
        entry.length = varint(&mut rest)?;
    }
    let mut next = None;
    for entry in &mut out {
        entry.offset = match varint(&mut rest)? {
            0 => next?,
            offset => offset - 1,
        };
        next = entry.offset.checked_add(entry.length);
    }
    Some(out)
}

/// A number of 7 bits per byte, the lowest first.
fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut number = 0u64;
    for k in 0..10 {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        number |= u64::from(byte & 0x7f).checked_shl(7 * k).unwrap_or(0);
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
    None
}

/// The tile of a number: zoom after zoom, and in each along the curve of Hilbert; `None` below the deepest zoom.
fn key_of(id: u64) -> Option<Key> {
    let (mut rest, mut zoom) = (id, 0u8);
    while rest >= 1 << (2 * zoom) {
        rest -= 1 << (2 * zoom);
        zoom += 1;
        if zoom > MOST_ZOOM {
            return None;
        }
    }
    let (mut x, mut y) = (0u64, 0u64);
    for k in 0..zoom {
        let side = 1u64 << k;
        let right = rest >> 1 & 1;
        let down = (rest ^ right) & 1;
        if down == 0 {
            if right == 1 {
                (x, y) = (side - 1 - x, side - 1 - y);
            }
            (x, y) = (y, x);
        }
        (x, y) = (x + side * right, y + side * down);
        rest >>= 2;
    }
    Key::new(zoom, x, y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_tiles_follow_the_curve_of_hilbert() {
        // The table of the specification.
        for (id, zoom, place) in [
            (0, 0, [0, 0]),
            (1, 1, [0, 0]),
            (2, 1, [0, 1]),
            (3, 1, [1, 1]),
            (4, 1, [1, 0]),
            (5, 2, [0, 0]),
            (19_078_479, 12, [3423, 1763]),
        ] {
            assert_eq!(key_of(id).map(|key| (key.zoom(), key.place())), Some((zoom, place)), "{id}");
        }
        assert_eq!(key_of(u64::MAX), None);
    }
}
