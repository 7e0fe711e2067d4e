//! A tiny TIFF writer for tests: any tags, both byte orders, classic and big, strips and tiles.

use std::io::Write;

/// How the file is laid out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Style {
    pub(crate) big_endian: bool,
    pub(crate) big: bool,
    /// Tile width and height; `None` = strips of 5 rows.
    pub(crate) tile: Option<(usize, usize)>,
    pub(crate) planar: bool,
    /// 1, 5, 8, 32773, 32946 or 50000.
    pub(crate) compression: u64,
    /// 1, or 2 = horizontal differences.
    pub(crate) predictor: u64,
}

/// Little-endian classic TIFF in strips, not compressed.
pub(crate) const PLAIN: Style =
    Style { big_endian: false, big: false, tile: None, planar: false, compression: 1, predictor: 1 };

/// A directory entry: number, type (3, 4, 12, 13, 16 or 2) and values (bits of doubles for 12, bytes for 2).
pub(crate) type Entry = (u16, u16, Vec<u64>);

impl Style {
    fn number(&self, v: u64, size: usize) -> Vec<u8> {
        let bytes = v.to_le_bytes();
        let mut bytes = bytes[..size].to_vec();
        if self.big_endian {
            bytes.reverse();
        }
        bytes
    }

    /// Header, one directory with `entries` as they are, then `body`; `next` is the position of the next directory.
    pub(crate) fn file(&self, entries: &[Entry], body: &[u8], next: u64) -> Vec<u8> {
        let (word, count_size, entry_size, start) = if self.big { (8, 8, 20, 16) } else { (4, 2, 12, 8) };
        let mut out = if self.big_endian { b"MM".to_vec() } else { b"II".to_vec() };
        out.extend(self.number(if self.big { 43 } else { 42 }, 2));
        if self.big {
            out.extend(self.number(8, 2));
            out.extend(self.number(0, 2));
        }
        out.extend(self.number(start, word));
        out.extend(self.number(entries.len() as u64, count_size));
        let values_at = self.body_at(entries) - self.outside(entries).iter().map(Vec::len).sum::<usize>();
        let mut at = values_at;
        for (number, kind, values) in entries {
            let bytes = self.value(*kind, values);
            out.extend(self.number(u64::from(*number), 2));
            out.extend(self.number(u64::from(*kind), 2));
            out.extend(self.number(values.len() as u64, word));
            if bytes.len() <= word {
                let mut bytes = bytes;
                bytes.resize(word, 0);
                out.extend(bytes);
            } else {
                out.extend(self.number(at as u64, word));
                at += bytes.len();
            }
        }
        out.extend(self.number(next, word));
        assert_eq!(out.len(), start as usize + count_size + entry_size * entries.len() + word);
        self.outside(entries).into_iter().for_each(|v| out.extend(v));
        out.extend(body);
        out
    }

    fn value(&self, kind: u16, values: &[u64]) -> Vec<u8> {
        let size = match kind {
            2 => 1,
            3 => 2,
            4 | 13 => 4,
            _ => 8,
        };
        values.iter().flat_map(|&v| self.number(v, size)).collect()
    }

    fn outside(&self, entries: &[Entry]) -> Vec<Vec<u8>> {
        let word = if self.big { 8 } else { 4 };
        entries.iter().map(|(_, kind, v)| self.value(*kind, v)).filter(|b| b.len() > word).collect()
    }

    /// Where `body` of [`Self::file`] starts.
    pub(crate) fn body_at(&self, entries: &[Entry]) -> usize {
        let head = if self.big { 16 + 8 + 20 * entries.len() + 8 } else { 8 + 2 + 12 * entries.len() + 4 };
        head + self.outside(entries).iter().map(Vec::len).sum::<usize>()
    }

    /// An image of unsigned integers of `bits` bits (8, 16, 32 or 64), interleaved by pixel, with `extra` entries.
    pub(crate) fn image(&self, size: [usize; 2], bands: usize, bits: u64, pixels: &[u64], extra: &[Entry]) -> Vec<u8> {
        let [width, height] = size;
        let (cw, ch) = self.tile.unwrap_or((width, 5));
        let planes = if self.planar { bands } else { 1 };
        let mut chunks = Vec::new();
        for plane in 0..planes {
            for top in (0..height).step_by(ch) {
                for left in (0..width).step_by(cw) {
                    let rows = if self.tile.is_some() { ch } else { ch.min(height - top) };
                    let of_pixel = |r: usize, c: usize| -> Vec<u64> {
                        let at = (r.min(height - 1) * width + c.min(width - 1)) * bands;
                        if self.planar { vec![pixels[at + plane]] } else { pixels[at..at + bands].to_vec() }
                    };
                    let row = |r: usize| -> Vec<u64> { (0..cw).flat_map(|c| of_pixel(top + r, left + c)).collect() };
                    let per_pixel = bands / planes;
                    let raw = (0..rows).flat_map(|r| self.differences(row(r), per_pixel)).collect::<Vec<u64>>();
                    let bytes: Vec<u8> = raw.iter().flat_map(|&v| self.number(v, bits as usize / 8)).collect();
                    chunks.push(self.compress(&bytes));
                }
            }
        }
        let word = if self.big { 16 } else { 4 };
        let zeros = vec![0; chunks.len()];
        let counts: Vec<u64> = chunks.iter().map(|c| c.len() as u64).collect();
        let mut entries = vec![
            (256, 4, vec![width as u64]),
            (257, 3, vec![height as u64]),
            (258, 3, vec![bits; bands]),
            (259, 3, vec![self.compression]),
            (262, 3, vec![1]),
            (277, 3, vec![bands as u64]),
            (284, 3, vec![if self.planar { 2 } else { 1 }]),
            (317, 3, vec![self.predictor]),
        ];
        if self.tile.is_some() {
            entries.extend([(322, 3, vec![cw as u64]), (323, 4, vec![ch as u64])]);
            entries.extend([(324, word, zeros), (325, word, counts.clone())]);
        } else {
            entries.extend([(273, word, zeros), (278, 3, vec![ch as u64]), (279, word, counts.clone())]);
        }
        entries.extend(extra.iter().cloned());
        entries.sort_by_key(|e| e.0);
        let mut places = Vec::new();
        let mut at = self.body_at(&entries) as u64;
        for count in counts {
            places.push(at);
            at += count;
        }
        entries.iter_mut().filter(|e| e.0 == 273 || e.0 == 324).for_each(|e| e.2 = places.clone());
        self.file(&entries, &chunks.concat(), 0)
    }

    fn differences(&self, row: Vec<u64>, bands: usize) -> Vec<u64> {
        if self.predictor != 2 {
            return row;
        }
        (0..row.len()).map(|i| if i < bands { row[i] } else { row[i].wrapping_sub(row[i - bands]) }).collect()
    }

    fn compress(&self, bytes: &[u8]) -> Vec<u8> {
        match self.compression {
            5 => weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8).encode(bytes).unwrap(),
            8 | 32946 => {
                let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
                encoder.write_all(bytes).unwrap();
                encoder.finish().unwrap()
            }
            32773 => bytes.chunks(100).flat_map(|c| [&[c.len() as u8 - 1], c].concat()).collect(),
            50000 => ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest),
            _ => bytes.to_vec(),
        }
    }
}
