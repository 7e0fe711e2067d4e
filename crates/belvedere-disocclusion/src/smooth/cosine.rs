//! Cosine transforms of a grid.

use rayon::prelude::*;
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Two-dimensional DCT-II and DCT-III of a grid of any size. The result does not depend on the number of threads.
#[derive(Clone)]
pub(super) struct CosineTransform {
    across: Plan,
    down: Plan,
    turned: Vec<f64>,
}

impl CosineTransform {
    /// * `cols`, `rows`: both >= 1.
    pub(super) fn new(cols: usize, rows: usize) -> Self {
        let mut planner = FftPlanner::new();
        let (across, down) = (Plan::new(cols, &mut planner), Plan::new(rows, &mut planner));
        Self { across, down, turned: vec![0.0; cols * rows] }
    }

    /// Multiplies the spectrum of `data` (row-major), in place; `gain(k, l)` for the frequencies k along x and l along y.
    pub(super) fn filter(&mut self, data: &mut [f64], gain: impl Fn(usize, usize) -> f64 + Sync) {
        let (cols, rows) = (self.across.turns.len(), self.down.turns.len());
        self.across.each_pair(data, |_, pair, work| self.across.forward(pair, work));
        transpose(data, &mut self.turned, cols);
        // DCT-III undoes DCT-II up to this factor.
        let scale = 4.0 / (cols * rows) as f64;
        self.down.each_pair(&mut self.turned, |first, pair, work| {
            self.down.forward(pair, work);
            for (k, column) in pair.chunks_exact_mut(rows).enumerate() {
                column.iter_mut().enumerate().for_each(|(l, x)| *x *= scale * gain(first + k, l));
            }
            self.down.backward(pair, work);
        });
        transpose(&self.turned, data, rows);
        self.across.each_pair(data, |_, pair, work| self.across.backward(pair, work));
    }
}

impl std::fmt::Debug for CosineTransform {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "CosineTransform({} x {})", self.across.turns.len(), self.down.turns.len())
    }
}

/// Cosine transforms of one length by complex Fourier transforms of the same length (Makhoul 1980), two rows of numbers in each: one as its
/// real part and one as its imaginary part.
#[derive(Clone)]
struct Plan {
    forward: Arc<dyn Fft<f64>>,
    backward: Arc<dyn Fft<f64>>,
    /// `exp(-i pi k / 2 n)` by frequency k.
    turns: Vec<Complex64>,
}

/// Room for the transform of a pair, kept by each thread.
struct Work {
    pair: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Plan {
    /// * `n`: length of a row, >= 1.
    fn new(n: usize, planner: &mut FftPlanner<f64>) -> Self {
        let turn = |k: usize| Complex64::from_polar(1.0, -FRAC_PI_2 * k as f64 / n as f64);
        Self {
            forward: planner.plan_fft_forward(n),
            backward: planner.plan_fft_inverse(n),
            turns: (0..n).map(turn).collect(),
        }
    }

    /// Calls `run` with the number of the first row of each pair of `data`, and the pair; the last may be a single row.
    fn each_pair(&self, data: &mut [f64], run: impl Fn(usize, &mut [f64], &mut Work) + Sync) {
        let n = self.turns.len();
        let room = self.forward.get_inplace_scratch_len().max(self.backward.get_inplace_scratch_len());
        let work = || Work { pair: vec![Complex64::ZERO; n], scratch: vec![Complex64::ZERO; room] };
        data.par_chunks_mut(2 * n)
            .enumerate()
            .with_min_len(8)
            .for_each_init(work, |work, (i, pair)| run(2 * i, pair, work));
    }

    /// DCT-II: sums of `x[j] cos(pi (j + 1/2) k / n)`.
    fn forward(&self, pair: &mut [f64], Work { pair: z, scratch }: &mut Work) {
        let n = self.turns.len();
        let (a, b) = pair.split_at_mut(n);
        // A single row goes with a row of zeros.
        let second = |j: usize| b.get(j).copied().unwrap_or(0.0);
        for (i, z) in z.iter_mut().enumerate() {
            let j = place(i, n);
            *z = Complex64::new(a[j], second(j));
        }
        self.forward.process_with_scratch(z, scratch);
        for (k, turn) in self.turns.iter().enumerate() {
            let (p, q) = (z[k], z[(n - k) % n].conj());
            let (sum, difference) = (p + q, p - q);
            a[k] = 0.5 * (turn * sum).re;
            if let Some(b) = b.get_mut(k) {
                *b = 0.5 * (turn * difference).im;
            }
        }
    }

    /// DCT-III: `x[0] / 2` plus the sums of `x[k] cos(pi k (j + 1/2) / n)` over k >= 1.
    fn backward(&self, pair: &mut [f64], Work { pair: z, scratch }: &mut Work) {
        let n = self.turns.len();
        let (a, b) = pair.split_at_mut(n);
        for (k, turn) in self.turns.iter().enumerate() {
            let spectrum = |x: &[f64]| Complex64::new(x[k], if k > 0 { -x[n - k] } else { 0.0 });
            let second = if b.is_empty() { Complex64::ZERO } else { spectrum(b) };
            z[k] = 0.5 * turn.conj() * (spectrum(a) + Complex64::I * second);
        }
        self.backward.process_with_scratch(z, scratch);
        for (i, z) in z.iter().enumerate() {
            let j = place(i, n);
            a[j] = z.re;
            if let Some(b) = b.get_mut(j) {
                *b = z.im;
            }
        }
    }
}

/// Number of the sample that stands at place `i`: the even ones in order, then the odd ones backwards.
fn place(i: usize, n: usize) -> usize {
    if 2 * i < n { 2 * i } else { 2 * (n - i) - 1 }
}

/// Rows of `from`, each `width` long, become columns of `to`.
fn transpose(from: &[f64], to: &mut [f64], width: usize) {
    to.par_chunks_exact_mut(from.len() / width).enumerate().with_min_len(16).for_each(|(k, column)| {
        column.iter_mut().zip(from[k..].iter().step_by(width)).for_each(|(to, x)| *to = *x);
    });
}

/// k-th eigenvalue of the Laplacian of n nodes in a line with mirrored ends.
pub(super) fn eigenvalue(k: usize, n: usize) -> f64 {
    // 2 cos(x) - 2 without its cancellation at small x.
    let s = (FRAC_PI_2 * k as f64 / n as f64).sin();
    -4.0 * s * s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_are_the_sums_that_define_them() {
        for n in [1, 2, 3, 4, 7, 12, 19, 27, 65, 257] {
            let plan = Plan::new(n, &mut FftPlanner::new());
            let rows: Vec<f64> = (0..2 * n).map(|i| ((i * 7919 + 13) % 101) as f64 / 101.0 - 0.4).collect();
            let cosine = |k: usize, j: usize| (2.0 * FRAC_PI_2 * k as f64 * (j as f64 + 0.5) / n as f64).cos();
            let second = |x: &[f64], k: usize| (0..n).map(|j| x[j] * cosine(k, j)).sum::<f64>();
            let third = |x: &[f64], j: usize| 0.5 * x[0] + (1..n).map(|k| x[k] * cosine(k, j)).sum::<f64>();
            for count in [1, 2] {
                let (mut forward, mut backward) = (rows[..count * n].to_vec(), rows[..count * n].to_vec());
                plan.each_pair(&mut forward, |_, pair, work| plan.forward(pair, work));
                plan.each_pair(&mut backward, |_, pair, work| plan.backward(pair, work));
                for row in 0..count {
                    let own = row * n..(row + 1) * n;
                    for i in 0..n {
                        let off = [
                            forward[own.start + i] - second(&rows[own.clone()], i),
                            backward[own.start + i] - third(&rows[own.clone()], i),
                        ];
                        assert!(
                            off.iter().all(|d| d.abs() < 1e-12 * n as f64),
                            "{n}: place {i} of row {row} of {count} is {off:?} off"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_filter_that_keeps_every_frequency_changes_nothing() {
        for [cols, rows] in [[1, 1], [5, 8], [13, 7], [16, 33]] {
            let data: Vec<f64> = (0..cols * rows).map(|i| ((i * 31 + 7) % 17) as f64).collect();
            let mut same = data.clone();
            CosineTransform::new(cols, rows).filter(&mut same, |_, _| 1.0);
            assert!(same.iter().zip(&data).all(|(a, b)| (a - b).abs() < 1e-12), "{cols} x {rows}");
        }
    }
}
