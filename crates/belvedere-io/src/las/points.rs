//! Points one after the other, unpacked where they are packed.

use super::header::Header;
use laz::{LasZipDecompressor, LazVlr};
use std::io::{self, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Points that are unpacked together.
const TOGETHER: usize = 4096;
/// Class of ground.
const GROUND: u8 = 2;
/// Classes of noise, low and high.
const NOISE: [u8; 2] = [7, 18];

/// The points of a file that make heights, as stored.
#[derive(Debug, Default)]
pub(super) struct Points {
    pub(super) all: u64,
    /// Whether they are those of the ground; else the first returns.
    pub(super) is_ground: bool,
    pub(super) places: Vec<[i32; 3]>,
}

impl Points {
    pub(super) fn of(header: &Header, bytes: &[u8]) -> Result<Self, String> {
        let mut out = Self::default();
        if header.is_packed {
            // Damaged points make the library panic: what it decodes there lies outside of its tables.
            let unpacked = catch_unwind(AssertUnwindSafe(|| out.unpack(header, bytes)));
            let panicked =
                |_| Err("its packed points lie outside of what their packing allows; it is damaged".to_owned());
            unpacked.unwrap_or_else(panicked)?;
        } else {
            let data = &bytes[header.start..];
            for point in data.chunks_exact(header.record).take(usize::try_from(header.count).unwrap_or(usize::MAX)) {
                out.add(header, point);
            }
        }
        if out.places.is_empty() {
            return Err(format!(
                "of its {} points none is ground, and none a first return; choose another file",
                out.all
            ));
        }
        Ok(out)
    }

    fn add(&mut self, header: &Header, point: &[u8]) {
        self.all += 1;
        let (returns, flags, class, is_withheld) = match header.format {
            0..=5 => (point[14] & 7, 0, point[15] & 31, point[15] & 0x80 != 0),
            _ => (point[14] & 15, point[15], point[16], false),
        };
        if is_withheld || flags & 4 != 0 || NOISE.contains(&class) {
            return;
        }
        let is_ground = class == GROUND;
        if is_ground && !self.is_ground {
            self.is_ground = true;
            self.places.clear();
        }
        if is_ground || (!self.is_ground && returns <= 1) {
            let word = |at: usize| i32::from_le_bytes([point[at], point[at + 1], point[at + 2], point[at + 3]]);
            self.places.push([word(0), word(4), word(8)]);
        }
    }

    fn unpack(&mut self, header: &Header, bytes: &[u8]) -> Result<(), String> {
        let record = header.record_of(bytes, "laszip encoded", 22204);
        let record = record.ok_or("it is packed and does not say how (record 22204); it is damaged")?;
        let damaged =
            |e: &dyn std::fmt::Display| format!("its packed points cannot be read ({e}); it is cut off, or damaged");
        let vlr = LazVlr::from_buffer(record).map_err(|e| damaged(&e))?;
        check_items(record, header)?;
        let data = &bytes[header.start..];
        if is_layered(record) {
            check_layers(record, header, data)?;
        }
        let mut unpacker = LasZipDecompressor::new(Forward(data), vlr).map_err(|e| damaged(&e))?;
        let mut left = header.count;
        let mut buffer = vec![0; TOGETHER * header.record];
        while left > 0 {
            let now = left.min(TOGETHER as u64);
            let part = &mut buffer[..now as usize * header.record];
            let after = |e: io::Error| {
                format!(
                    "its packed points cannot be read after {} of {} ({e}); it is cut off, or damaged",
                    header.count - left,
                    header.count
                )
            };
            unpacker.decompress_many(part).map_err(after)?;
            part.chunks_exact(header.record).for_each(|point| self.add(header, point));
            left -= now;
        }
        Ok(())
    }
}

/// Items of a point, of the record that says how it is packed: type, size, version.
fn items(record: &[u8]) -> impl Iterator<Item = [u16; 3]> {
    let words = record.get(34..).unwrap_or(&[]).as_chunks::<6>().0.iter();
    words.map(|b| [0, 2, 4].map(|i| u16::from_le_bytes([b[i], b[i + 1]])))
}

fn is_layered(record: &[u8]) -> bool {
    record.first() == Some(&3)
}

/// The items of a point must have their sizes and make up its bytes.
fn check_items(record: &[u8], header: &Header) -> Result<(), String> {
    let count = record.get(32..34).map_or(0, |b| usize::from(u16::from_le_bytes([b[0], b[1]])));
    let found: Vec<[u16; 3]> = items(record).take(count).collect();
    let fits = |[kind, size, _]: &[u16; 3]| match kind {
        0 | 14 => *size > 0,
        6 => *size == 20,
        7 | 12 => *size == 8,
        8 | 11 => *size == 6,
        9 | 13 => *size == 29,
        10 => *size == 30,
        _ => false,
    };
    let first = if header.format < 6 { 6 } else { 10 };
    let sum: usize = found.iter().map(|item| usize::from(item[1])).sum();
    let starts = found.first().is_some_and(|item| item[0] == first);
    if count == found.len() && starts && found.iter().all(fits) && sum == header.record {
        return Ok(());
    }
    Err(format!(
        "its packed points have {} parts of {sum} bytes, a point of format {} has {}; it is damaged",
        found.len(),
        header.format,
        header.record
    ))
}

/// Each part of a point is a layer of its own: the layers of every chunk must lie inside the file, because they are unpacked at once.
fn check_layers(record: &[u8], header: &Header, data: &[u8]) -> Result<(), String> {
    let layers: usize = items(record)
        .map(|[kind, size, _]| match kind {
            10 => 9,
            12 => 2,
            14 => usize::from(size),
            _ => 1,
        })
        .sum();
    let word = |at: usize| data.get(at..)?.first_chunk::<4>().map(|b| u32::from_le_bytes(*b) as usize);
    let (mut at, mut points, mut chunk) = (8usize, 0u64, 0usize);
    while points < header.count {
        chunk += 1;
        let sizes = at + header.record;
        let count = word(sizes).filter(|count| *count > 0);
        let total = (1..=layers).try_fold(0usize, |all, i| all.checked_add(word(sizes + 4 * i)?));
        let end = total.and_then(|total| (sizes + 4 + 4 * layers).checked_add(total)).filter(|end| *end <= data.len());
        let (Some(count), Some(end)) = (count, end) else {
            let all = header.count;
            return Err(format!(
                "its chunk {chunk}, after {points} of {all} points, ends after the file; it is cut off, or damaged"
            ));
        };
        (at, points) = (end, points + count as u64);
    }
    Ok(())
}

/// Bytes that are read from front to back alone, so that the table of chunks, which nothing needs here, is passed over.
struct Forward<'b>(&'b [u8]);

impl Read for Forward<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        self.0.read(out)
    }
}

impl Seek for Forward<'_> {
    fn seek(&mut self, _: SeekFrom) -> io::Result<u64> {
        Err(io::ErrorKind::Unsupported.into())
    }
}
