//! Orthonormal cosine transforms of a grid.

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::line::{Line, Real};

/// Sequences that are handled together: two cache lines of f64, eight pairs.
const BLOCK: usize = 16;

/// What happens to the samples or spectra of a sequence.
#[derive(Clone, Copy)]
enum Step<'a, T> {
    Forward,
    Inverse,
    /// Forward, the given change of the spectrum (index of the sequence, spectrum), inverse.
    Filter(&'a (dyn Fn(usize, &mut [T]) + Sync)),
}

/// Buffers of one task.
#[derive(Clone)]
struct Slot<T: Real> {
    z: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
    /// The partner of an odd sequence out.
    spare: Vec<T>,
}

/// Orthonormal two-dimensional DCT-II and DCT-III of a grid of any size. Keeps its plans and buffers: no call
/// allocates. Works on all cores; the result does not depend on their number.
///
/// ```
/// use belvedere_construct::terrain::Dct;
/// let mut dct = Dct::<f64>::new(3, 2);
/// let mut data = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
/// dct.forward(&mut data);
/// assert!((data[0] - 21.0 / 6f64.sqrt()).abs() < 1e-14);
/// dct.inverse(&mut data);
/// assert!((data[5] - 6.0).abs() < 1e-14);
/// ```
#[derive(Clone)]
pub struct Dct<T: Real = f64> {
    along_x: Line<T>,
    along_y: Line<T>,
    turned: Vec<T>,
    slots: Vec<Slot<T>>,
}

impl<T: Real> Dct<T> {
    /// Plans for `cols` x `rows` values, both >= 1, row-major.
    ///
    /// # Panics
    /// If a size is 0.
    pub fn new(cols: usize, rows: usize) -> Self {
        assert!(cols > 0 && rows > 0, "a grid of {cols} x {rows} values has no transform");
        let (along_x, along_y) = (Line::new(cols), Line::new(rows));
        let n = cols.max(rows);
        let scratch = along_x.scratch_len().max(along_y.scratch_len());
        let zero = Complex::new(T::zero(), T::zero());
        let slot = Slot { z: vec![zero; BLOCK / 2 * n], scratch: vec![zero; scratch], spare: vec![T::zero(); n] };
        let tasks = if cols * rows < 4096 { 1 } else { 2 * rayon::current_num_threads() };
        let slots = vec![slot; tasks.clamp(1, n.div_ceil(BLOCK))];
        Self { along_x, along_y, turned: vec![T::zero(); cols * rows], slots }
    }

    /// Columns.
    pub fn cols(&self) -> usize {
        self.along_x.len()
    }

    /// Rows.
    pub fn rows(&self) -> usize {
        self.along_y.len()
    }

    /// Samples to spectrum (DCT-II), in place; both row-major.
    ///
    /// # Panics
    /// If `data` has another size than the plan.
    pub fn forward(&mut self, data: &mut [T]) {
        self.check(data);
        turning(&self.along_y, data, &mut self.turned, Step::Forward, &mut self.slots);
        turning(&self.along_x, &self.turned, data, Step::Forward, &mut self.slots);
    }

    /// Spectrum to samples (DCT-III), in place.
    ///
    /// # Panics
    /// If `data` has another size than the plan.
    pub fn inverse(&mut self, data: &mut [T]) {
        self.check(data);
        turning(&self.along_y, data, &mut self.turned, Step::Inverse, &mut self.slots);
        turning(&self.along_x, &self.turned, data, Step::Inverse, &mut self.slots);
    }

    /// Forward, `change(k, spectrum of column frequency k over all row frequencies)`, inverse, in place.
    ///
    /// # Panics
    /// If `data` has another size than the plan.
    pub fn filter(&mut self, data: &mut [T], change: impl Fn(usize, &mut [T]) + Sync) {
        self.check(data);
        rows_forward(&self.along_x, data, &mut self.slots);
        turning(&self.along_y, data, &mut self.turned, Step::Filter(&change), &mut self.slots);
        turning(&self.along_x, &self.turned, data, Step::Inverse, &mut self.slots);
    }

    fn check(&self, data: &[T]) {
        assert_eq!(data.len(), self.turned.len(), "values of a grid of {} x {}", self.cols(), self.rows());
    }
}

impl<T: Real> std::fmt::Debug for Dct<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Dct").field("cols", &self.cols()).field("rows", &self.rows()).finish_non_exhaustive()
    }
}

/// Forward transform of every row, in place.
fn rows_forward<T: Real>(line: &Line<T>, data: &mut [T], slots: &mut [Slot<T>]) {
    let n = line.len();
    let share = share(data.len() / n, slots.len());
    data.par_chunks_mut(share * n).zip(slots).for_each(|(chunk, slot)| {
        for pair in chunk.chunks_mut(2 * n) {
            let (a, b) = pair.split_at_mut(n);
            let z = &mut slot.z[..n];
            let b = if b.is_empty() {
                slot.spare[..n].fill(T::zero());
                &mut slot.spare[..n]
            } else {
                b
            };
            line.load(a, b, z);
            line.forward(z, &mut slot.scratch, a, b);
        }
    });
}

/// One step on every column of `from` (lines.len() rows); the results become the rows of `to`.
fn turning<T: Real>(line: &Line<T>, from: &[T], to: &mut [T], step: Step<'_, T>, slots: &mut [Slot<T>]) {
    let n = line.len();
    let width = from.len() / n;
    let share = share(width, slots.len());
    to.par_chunks_mut(share * n).zip(slots).enumerate().for_each(|(task, (chunk, slot))| {
        for (block, out) in chunk.chunks_mut(BLOCK * n).enumerate() {
            let first = task * share + block * BLOCK;
            match step {
                Step::Inverse => columns_inverse(line, from, width, first, out, slot),
                _ => columns_forward(line, from, width, first, out, slot, step),
            }
        }
    });
}

/// Sequences per task, a multiple of [`BLOCK`]: who shares a transform with whom never depends on the cores.
fn share(sequences: usize, tasks: usize) -> usize {
    sequences.div_ceil(tasks).next_multiple_of(BLOCK)
}

/// Forward or filter of the columns `first..` of `from`, one per row of `out`.
fn columns_forward<T: Real>(
    line: &Line<T>,
    from: &[T],
    width: usize,
    first: usize,
    out: &mut [T],
    slot: &mut Slot<T>,
    step: Step<'_, T>,
) {
    let n = line.len();
    let count = out.len() / n;
    for (j, row) in from.chunks_exact(width).enumerate() {
        let place = line.place(j);
        for (pair, values) in row[first..first + count].chunks(2).enumerate() {
            let b = values.get(1).copied().unwrap_or(T::zero());
            slot.z[pair * n + place] = Complex::new(values[0], b);
        }
    }
    for (pair, rows) in out.chunks_mut(2 * n).enumerate() {
        let z = &mut slot.z[pair * n..(pair + 1) * n];
        let (a, b) = rows.split_at_mut(n);
        let single = b.is_empty();
        let b = if single { &mut slot.spare[..n] } else { b };
        line.forward(z, &mut slot.scratch, a, b);
        if let Step::Filter(change) = step {
            change(first + 2 * pair, a);
            if !single {
                change(first + 2 * pair + 1, b);
            }
            line.inverse(a, b, z, &mut slot.scratch);
            line.unload(z, a, b);
        }
    }
}

/// Inverse of the columns `first..` of `from`, one per row of `out`.
fn columns_inverse<T: Real>(line: &Line<T>, from: &[T], width: usize, first: usize, out: &mut [T], slot: &mut Slot<T>) {
    let n = line.len();
    let count = out.len() / n;
    for (k, row) in from.chunks_exact(width).enumerate() {
        for (c, x) in row[first..first + count].iter().enumerate() {
            out[c * n + k] = *x;
        }
    }
    for rows in out.chunks_mut(2 * n) {
        let z = &mut slot.z[..n];
        let (a, b) = rows.split_at_mut(n);
        let b = if b.is_empty() {
            slot.spare[..n].fill(T::zero());
            &mut slot.spare[..n]
        } else {
            b
        };
        line.inverse(a, b, z, &mut slot.scratch);
        line.unload(z, a, b);
    }
}
