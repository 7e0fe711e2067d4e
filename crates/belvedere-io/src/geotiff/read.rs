//! Chunks to samples: a window of one image, decoded on all cores.

use super::codec::Scratch;
use super::ifd::Container;
use super::layout::Layout;
use super::shared::Shared;
use crate::Fault;
use crate::raster::{Limits, SampleType, Samples};
use belvedere_scene::Progress;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A sample in memory.
trait Cell: Copy + Default + Send + Sync {
    const SIZE: usize;
    fn from_ne(bytes: &[u8]) -> Self;
    fn from_f64(v: f64) -> Self;
}

macro_rules! cell {
    ($($t:ty),*) => {$(
        impl Cell for $t {
            const SIZE: usize = size_of::<$t>();
            fn from_ne(bytes: &[u8]) -> Self {
                bytes.try_into().map_or(0 as $t, <$t>::from_ne_bytes)
            }
            fn from_f64(v: f64) -> Self {
                v as $t
            }
        }
    )*};
}
cell!(i8, u8, i16, u16, i32, u32, i64, u64, f32, f64);

/// Bytes of decoded chunks of one row that wait to be copied.
const PART_BYTES: u64 = 16 << 20;

/// Where the samples of a chunk are.
enum Decoded {
    /// Nowhere: the file leaves it out.
    LeftOut,
    /// In the scratch.
    Own,
    /// Taken out of the scratch.
    Kept(Vec<u8>),
    /// With other chunks of the same place in the file.
    Shared(Arc<[u8]>),
}

impl Decoded {
    /// Frees the scratch.
    fn kept(self, scratch: &mut Scratch) -> Self {
        match self {
            Self::Own => Self::Kept(std::mem::take(&mut scratch.out)),
            other => other,
        }
    }

    /// The samples; `None` for a chunk that the file leaves out.
    fn bytes<'a>(&'a self, scratch: &'a Scratch) -> Option<&'a [u8]> {
        match self {
            Self::LeftOut => None,
            Self::Own => Some(&scratch.out),
            Self::Kept(bytes) => Some(bytes),
            Self::Shared(bytes) => Some(bytes),
        }
    }
}

/// What to read of one image.
pub(super) struct Window<'a> {
    pub(super) container: &'a Container,
    pub(super) layout: &'a Layout,
    pub(super) cols: Range<usize>,
    pub(super) rows: Range<usize>,
    /// Value of chunks that the file leaves out.
    pub(super) fill: f64,
    pub(super) limits: Limits,
    pub(super) progress: &'a Progress,
}

impl Window<'_> {
    /// The samples, interleaved by pixel. Fails with a sentence, also if `progress` is cancelled.
    pub(super) fn read(&self) -> Result<Samples, Fault> {
        Ok(match self.layout.stored.sample_type() {
            SampleType::I8 => Samples::I8(self.typed()?),
            SampleType::U8 => Samples::U8(self.typed()?),
            SampleType::I16 => Samples::I16(self.typed()?),
            SampleType::U16 => Samples::U16(self.typed()?),
            SampleType::I32 => Samples::I32(self.typed()?),
            SampleType::U32 => Samples::U32(self.typed()?),
            SampleType::I64 => Samples::I64(self.typed()?),
            SampleType::U64 => Samples::U64(self.typed()?),
            SampleType::F32 => Samples::F32(self.typed()?),
            SampleType::F64 => Samples::F64(self.typed()?),
        })
    }

    fn typed<T: Cell>(&self) -> Result<Vec<T>, Fault> {
        let layout = self.layout;
        let samples = self.allowed_samples()?;
        let mut out: Vec<T> = Vec::new();
        out.try_reserve_exact(samples).map_err(|_| format!("needs {samples} samples, there is not enough memory"))?;
        out.resize(samples, T::default());
        let row_samples = self.cols.len() * layout.bands;
        let mut bands = Vec::new();
        let mut rest = &mut out[..];
        for chunk_row in self.rows.start / layout.chunk_height..self.rows.end.div_ceil(layout.chunk_height) {
            let rows = self.rows_of(chunk_row);
            let (band, after) = rest.split_at_mut((rows.len() * row_samples).min(rest.len()));
            bands.push((chunk_row, band));
            rest = after;
        }
        let (total, done) = (bands.len(), AtomicUsize::new(0));
        let shared = Shared::of(layout, &self.cols, &self.rows);
        bands.into_par_iter().try_for_each_init(Scratch::default, |scratch, (chunk_row, band)| {
            self.chunk_row(scratch, &shared, chunk_row, band)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            self.progress.tick("reading raster", done as f64 / total as f64).map_err(|e| e.to_string())
        })?;
        Ok(out)
    }

    /// Checks the memory for samples and working buffers; returns the number of samples.
    fn allowed_samples(&self) -> Result<usize, Fault> {
        let layout = self.layout;
        let out = layout.decoded_bytes(self.cols.len(), self.rows.len())?;
        let chunk = layout.chunk_bytes(layout.chunk_height)?;
        let threads = rayon::current_num_threads() as u64;
        // Every thread may work on a row of chunks, and on a part of it.
        let in_rows = threads.saturating_mul(self.part()? as u64);
        let at_once = (layout.chunks[0] as u64).saturating_mul(layout.chunks[1] as u64).min(in_rows);
        let expansion = if layout.stored.bits() < 8 { 8 / layout.stored.bits() } else { 1 };
        let buffers =
            chunk.saturating_mul(at_once).saturating_mul(1 + expansion).saturating_add(Shared::MOST_BYTES.min(out));
        self.limits.check(out.saturating_add(buffers))?;
        let size = layout.stored.sample_type().size() as u64;
        usize::try_from(out / size).map_err(|_| "is too large for this machine".into())
    }

    /// Chunks of a row that are decoded before they are copied: few, so that wide images do not need twice their memory.
    fn part(&self) -> Result<usize, String> {
        let chunk = self.layout.chunk_bytes(self.layout.chunk_height)?.max(1);
        let most = (PART_BYTES / chunk).clamp(1, 4 * rayon::current_num_threads() as u64);
        Ok((most as usize).min(self.layout.chunks[0].saturating_mul(self.layout.bands)).max(1))
    }

    /// Rows of the image that chunk row `chunk_row` gives to the window.
    fn rows_of(&self, chunk_row: usize) -> Range<usize> {
        let start = chunk_row * self.layout.chunk_height;
        start.max(self.rows.start)..(start + self.layout.chunk_height).min(self.rows.end)
    }

    /// Decodes all chunks of a chunk row into `band`, which holds their rows of the window.
    fn chunk_row<T: Cell>(
        &self,
        scratch: &mut Scratch,
        shared: &Shared,
        chunk_row: usize,
        band: &mut [T],
    ) -> Result<(), String> {
        let layout = self.layout;
        let planes = if layout.planar { layout.bands } else { 1 };
        let cols = self.cols.start / layout.chunk_width..self.cols.end.div_ceil(layout.chunk_width);
        if cols.len() * planes == 1 {
            let decoded = self.chunk(scratch, shared, 0, chunk_row, cols.start)?;
            self.copy(band, 0, chunk_row, cols.start, decoded.bytes(scratch));
            return Ok(());
        }
        let chunks: Vec<[usize; 2]> = (0..planes).flat_map(|p| cols.clone().map(move |c| [p, c])).collect();
        for part in chunks.chunks(self.part()?) {
            let decoded: Vec<Decoded> = part
                .par_iter()
                .map_init(Scratch::default, |scratch, &[plane, col]| {
                    let decoded = self.chunk(scratch, shared, plane, chunk_row, col)?;
                    Ok(decoded.kept(scratch))
                })
                .collect::<Result<_, String>>()?;
            for (&[plane, col], decoded) in part.iter().zip(&decoded) {
                self.copy(band, plane, chunk_row, col, decoded.bytes(scratch));
            }
        }
        Ok(())
    }

    /// Decodes one chunk into `scratch.out`, unless it is shared and decoded already.
    fn chunk(
        &self,
        scratch: &mut Scratch,
        shared: &Shared,
        plane: usize,
        row: usize,
        col: usize,
    ) -> Result<Decoded, String> {
        let layout = self.layout;
        if self.progress.is_cancelled() {
            return Err("cancelled".to_owned());
        }
        let Some((at, count)) = layout.chunk(plane, row, col) else { return Ok(Decoded::LeftOut) };
        let name = || format!("{} in row {}, column {}", layout.kind(), row + 1, col + 1);
        let rows = layout.rows_in(row);
        let key = (at, count, rows);
        if let Some(known) = shared.get(key) {
            return Ok(Decoded::Shared(known));
        }
        let count = match layout.compression {
            super::layout::Compression::None => count.min(layout.chunk_bytes(rows)?),
            _ => count,
        };
        self.container.source.read_into(at, count, layout.kind(), &mut scratch.raw)?;
        let result = scratch.decode(layout, self.container.big_endian, rows);
        result.map_err(|reason| format!("{} {reason}", name()))?;
        shared.keep(key, &scratch.out);
        Ok(Decoded::Own)
    }

    /// Copies what the window needs of a chunk, or the fill value.
    fn copy<T: Cell>(&self, band: &mut [T], plane: usize, chunk_row: usize, chunk_col: usize, bytes: Option<&[u8]>) {
        let layout = self.layout;
        let rows = self.rows_of(chunk_row);
        let left = chunk_col * layout.chunk_width;
        let cols = left.max(self.cols.start)..(left + layout.chunk_width).min(self.cols.end);
        let per_pixel = layout.chunk_bands();
        let row_samples = self.cols.len() * layout.bands;
        let first_row = rows.start - chunk_row * layout.chunk_height;
        let stride = layout.chunk_width * per_pixel * T::SIZE;
        for (i, line) in band.chunks_exact_mut(row_samples).enumerate() {
            let to = (cols.start - self.cols.start) * layout.bands..(cols.end - self.cols.start) * layout.bands;
            let Some(line) = line.get_mut(to) else { continue };
            let from = (first_row + i) * stride + (cols.start - left) * per_pixel * T::SIZE;
            let source = bytes.and_then(|b| b.get(from..from + cols.len() * per_pixel * T::SIZE));
            match (source, layout.planar) {
                (None, false) => line.fill(T::from_f64(self.fill)),
                (None, true) => line.iter_mut().skip(plane).step_by(layout.bands).for_each(|s| {
                    *s = T::from_f64(self.fill);
                }),
                (Some(source), false) => {
                    line.iter_mut().zip(source.chunks_exact(T::SIZE)).for_each(|(s, b)| *s = T::from_ne(b));
                }
                (Some(source), true) => {
                    let cells = line.iter_mut().skip(plane).step_by(layout.bands);
                    cells.zip(source.chunks_exact(T::SIZE)).for_each(|(s, b)| *s = T::from_ne(b));
                }
            }
        }
    }
}
