//! One chunk: decompression, predictor, byte order, unpacking.

use super::layout::{Compression, Layout, Stored};
use crate::half::half_to_f32;
use flate2::{Decompress, FlushDecompress};
use weezl::{BitOrder, LzwStatus, decode};
use zune_jpeg::zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};

/// Decoders and buffers that are kept from chunk to chunk by one thread.
#[derive(Default)]
pub(super) struct Scratch {
    /// Stored bytes of the current chunk.
    pub(super) raw: Vec<u8>,
    /// Decoded samples of the current chunk in the byte order of this machine.
    pub(super) out: Vec<u8>,
    spare: Vec<u8>,
    lzw: Option<decode::Decoder>,
    inflate: Option<Decompress>,
    zstd: Option<ruzstd::decoding::FrameDecoder>,
}

impl Scratch {
    /// Decodes [`Self::raw`], which holds `rows` rows, into [`Self::out`].
    pub(super) fn decode(&mut self, layout: &Layout, big_endian: bool, rows: usize) -> Result<(), String> {
        let size = usize::try_from(layout.chunk_bytes(rows)?).map_err(|_| "is too large".to_owned())?;
        self.decompress(layout, rows, size)?;
        if layout.compression == Compression::Jpeg {
            return Ok(());
        }
        let row_bytes = (size / rows.max(1)).max(1);
        let sample = (layout.stored.bits() / 8) as usize;
        let bands = layout.chunk_bands();
        let predictor = if layout.compression.takes_predictor() { layout.predictor } else { 1 };
        if predictor == 3 {
            for row in self.out.chunks_exact_mut(row_bytes) {
                undo_float_predictor(row, bands, sample, &mut self.spare);
            }
        } else if sample > 1 && big_endian != cfg!(target_endian = "big") {
            swap_bytes(&mut self.out, sample);
        }
        if predictor == 2 {
            self.out.chunks_exact_mut(row_bytes).for_each(|row| undo_difference(row, bands, sample));
        }
        match layout.stored {
            Stored::Plain(_) => {}
            Stored::Packed(bits) => self.unpack(usize::from(bits), row_bytes, layout.chunk_width),
            Stored::Half => {
                self.spare.clear();
                let halves = self.out.chunks_exact(2);
                let widened = halves.flat_map(|b| half_to_f32(u16::from_ne_bytes([b[0], b[1]])).to_ne_bytes());
                self.spare.extend(widened);
                std::mem::swap(&mut self.spare, &mut self.out);
            }
        }
        Ok(())
    }

    fn decompress(&mut self, layout: &Layout, rows: usize, size: usize) -> Result<(), String> {
        if layout.compression == Compression::None {
            std::mem::swap(&mut self.raw, &mut self.out);
            if self.out.len() < size {
                return Err(format!("has {} bytes, {size} are needed", self.out.len()));
            }
            self.out.truncate(size);
            return Ok(());
        }
        if self.out.len() != size {
            self.out.clear();
            self.out.try_reserve_exact(size).map_err(|_| format!("needs {size} bytes, there is not enough memory"))?;
            self.out.resize(size, 0);
        }
        let got = match layout.compression {
            Compression::None => size,
            Compression::Lzw => self.lzw()?,
            Compression::Deflate => self.inflate()?,
            Compression::PackBits => unpack_bits(&self.raw, &mut self.out),
            Compression::Zstd => self.zstd()?,
            Compression::Jpeg => return self.jpeg(layout, rows),
        };
        if got < size {
            return Err(format!("decodes to {got} bytes instead of {size}; the file is damaged"));
        }
        Ok(())
    }

    fn lzw(&mut self) -> Result<usize, String> {
        if let [0, second, ..] = self.raw[..]
            && second & 1 == 1
        {
            return Err("is compressed by the LZW variant of before 1993, which is not supported".to_owned());
        }
        // Like libtiff it stops when the chunk is full: some writers leave out the end code.
        let new =
            || decode::Configuration::with_tiff_size_switch(BitOrder::Msb, 8).with_yield_on_full_buffer(true).build();
        let lzw = self.lzw.get_or_insert_with(new);
        lzw.reset();
        let (mut raw, mut at) = (&self.raw[..], 0);
        while at < self.out.len() {
            let step = lzw.decode_bytes(raw, &mut self.out[at..]);
            (raw, at) = (&raw[step.consumed_in..], at + step.consumed_out);
            match step.status {
                Ok(LzwStatus::Ok) => {}
                Ok(LzwStatus::Done | LzwStatus::NoProgress) => break,
                Err(e) => return Err(format!("is not valid LZW ({e}); the file is damaged")),
            }
        }
        Ok(at)
    }

    fn inflate(&mut self) -> Result<usize, String> {
        let inflate = self.inflate.get_or_insert_with(|| Decompress::new(true));
        inflate.reset(true);
        match inflate.decompress(&self.raw, &mut self.out, FlushDecompress::Finish) {
            Ok(_) => Ok(inflate.total_out() as usize),
            Err(e) => Err(format!("is not valid deflate data ({e}); the file is damaged")),
        }
    }

    fn zstd(&mut self) -> Result<usize, String> {
        let zstd = self.zstd.get_or_insert_with(ruzstd::decoding::FrameDecoder::new);
        let result = zstd.decode_all(&self.raw, &mut self.out);
        result.map_err(|e| format!("is not valid ZSTD data ({e}); the file is damaged"))
    }

    fn jpeg(&mut self, layout: &Layout, rows: usize) -> Result<(), String> {
        let bad = |e: String| format!("is not valid JPEG ({e}); the file is damaged");
        if !self.raw.starts_with(&[0xff, 0xd8]) {
            return Err(bad("it does not start with its marker".to_owned()));
        }
        if let Some(tables) = layout.jpeg_tables.len().checked_sub(2).and_then(|n| layout.jpeg_tables.get(..n)) {
            self.spare.clear();
            self.spare.extend_from_slice(tables);
            self.spare.extend_from_slice(self.raw.get(2..).unwrap_or(&[]));
            std::mem::swap(&mut self.spare, &mut self.raw);
        }
        let options = DecoderOptions::default()
            .set_strict_mode(true)
            .set_max_width(layout.chunk_width)
            .set_max_height(layout.chunk_height);
        let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(&self.raw[..]), options);
        decoder.decode_headers().map_err(|e| bad(format!("{e:?}")))?;
        let stored = decoder.input_colorspace().ok_or_else(|| bad("no colours".to_owned()))?;
        let wanted = if layout.photometric == 6 { ColorSpace::RGB } else { stored };
        decoder.set_options(options.jpeg_set_out_colorspace(wanted));
        let (w, h) = decoder.info().map_or((0, 0), |i| (usize::from(i.width), usize::from(i.height)));
        let bands = layout.chunk_bands();
        if w != layout.chunk_width || h < rows || wanted.num_components() != bands {
            return Err(format!(
                "is a JPEG of {w} x {h} pixels and {} bands, {} x {rows} and {bands} are needed",
                wanted.num_components(),
                layout.chunk_width
            ));
        }
        let pixels = decoder.decode().map_err(|e| bad(format!("{e:?}")))?;
        let part = pixels.get(..self.out.len()).ok_or_else(|| bad("it is too short".to_owned()))?;
        self.out.copy_from_slice(part);
        Ok(())
    }

    fn unpack(&mut self, bits: usize, row_bytes: usize, width: usize) {
        let mask = (1u16 << bits) as u8 - 1;
        self.spare.clear();
        for row in self.out.chunks_exact(row_bytes) {
            let samples = row.iter().flat_map(|&b| (0..8 / bits).map(move |i| b >> (8 - bits * (i + 1)) & mask));
            self.spare.extend(samples.take(width));
        }
        std::mem::swap(&mut self.spare, &mut self.out);
    }
}

/// PackBits (TIFF 6.0, section 9). Returns the number of bytes written.
pub(crate) fn unpack_bits(mut raw: &[u8], out: &mut [u8]) -> usize {
    let mut at = 0;
    while at < out.len() {
        let Some((&head, rest)) = raw.split_first() else { break };
        raw = rest;
        let room = out.len() - at;
        match head {
            0..=127 => {
                let n = usize::from(head) + 1;
                let Some((literal, rest)) = raw.split_at_checked(n) else { break };
                let n = n.min(room);
                out[at..at + n].copy_from_slice(&literal[..n]);
                at += n;
                raw = rest;
            }
            128 => {}
            129..=255 => {
                let Some((&value, rest)) = raw.split_first() else { break };
                let n = (257 - usize::from(head)).min(room);
                out[at..at + n].fill(value);
                at += n;
                raw = rest;
            }
        }
    }
    at
}

fn swap_bytes(bytes: &mut [u8], sample: usize) {
    match sample {
        2 => bytes.as_chunks_mut::<2>().0.iter_mut().for_each(|b| b.reverse()),
        4 => bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|b| b.reverse()),
        8 => bytes.as_chunks_mut::<8>().0.iter_mut().for_each(|b| b.reverse()),
        _ => {}
    }
}

/// Horizontal differencing (TIFF 6.0, section 14), samples in the byte order of this machine.
fn undo_difference(row: &mut [u8], bands: usize, sample: usize) {
    macro_rules! sum {
        ($t:ty, $n:literal) => {{
            let (cells, _) = row.as_chunks_mut::<$n>();
            if bands == 1 {
                let mut sum: $t = 0;
                for cell in cells {
                    sum = sum.wrapping_add(<$t>::from_ne_bytes(*cell));
                    *cell = sum.to_ne_bytes();
                }
            } else {
                for i in bands..cells.len() {
                    let sum = <$t>::from_ne_bytes(cells[i]).wrapping_add(<$t>::from_ne_bytes(cells[i - bands]));
                    cells[i] = sum.to_ne_bytes();
                }
            }
        }};
    }
    match sample {
        1 => sum!(u8, 1),
        2 => sum!(u16, 2),
        4 => sum!(u32, 4),
        _ => sum!(u64, 8),
    }
}

/// Floating-point predictor (Adobe TIFF technical note 3): byte planes, most significant first, differenced.
fn undo_float_predictor(row: &mut [u8], bands: usize, sample: usize, spare: &mut Vec<u8>) {
    for i in bands..row.len() {
        row[i] = row[i].wrapping_add(row[i - bands]);
    }
    spare.clear();
    spare.extend_from_slice(row);
    let plane = row.len() / sample;
    if plane == 0 {
        return;
    }
    for (p, bytes) in spare.chunks_exact(plane).take(sample).enumerate() {
        let byte_index = if cfg!(target_endian = "big") { p } else { sample - 1 - p };
        for (cell, &byte) in row.chunks_exact_mut(sample).zip(bytes) {
            cell[byte_index] = byte;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packbits_of_the_specification() {
        let packed = [0xFE, 0xAA, 0x02, 0x80, 0x00, 0x2A, 0xFD, 0xAA, 0x03, 0x80, 0x00, 0x2A, 0x22, 0xF7, 0xAA];
        let mut out = [0; 24];
        assert_eq!(unpack_bits(&packed, &mut out), 24);
        let mut wanted = vec![0xAA, 0xAA, 0xAA, 0x80, 0x00, 0x2A, 0xAA, 0xAA, 0xAA, 0xAA, 0x80, 0x00, 0x2A, 0x22];
        wanted.extend([0xAA; 10]);
        assert_eq!(out[..], wanted[..]);
        assert_eq!(unpack_bits(&packed[..8], &mut [0; 24]), 10, "a truncated literal ends it");
    }
}
