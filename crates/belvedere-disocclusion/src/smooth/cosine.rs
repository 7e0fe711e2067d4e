//! Cosine transforms of a grid.

use rayon::prelude::*;
use rustdct::{DctPlanner, TransformType2And3};
use std::sync::Arc;

/// Two-dimensional DCT-II and DCT-III of a grid of any size. The result does not depend on the number of threads.
#[derive(Clone)]
pub(super) struct CosineTransform {
    across: Arc<dyn TransformType2And3<f64>>,
    down: Arc<dyn TransformType2And3<f64>>,
    turned: Vec<f64>,
}

impl CosineTransform {
    /// * `cols`, `rows`: both >= 1.
    pub(super) fn new(cols: usize, rows: usize) -> Self {
        let mut planner = DctPlanner::new();
        let (across, down) = (planner.plan_dct2(cols), planner.plan_dct2(rows));
        Self { across, down, turned: vec![0.0; cols * rows] }
    }

    /// Multiplies the spectrum of `data` (row-major), in place; `gain(k, l)` for the frequencies k along x and l along y.
    pub(super) fn filter(&mut self, data: &mut [f64], gain: impl Fn(usize, usize) -> f64 + Sync) {
        let (cols, rows) = (self.across.len(), self.down.len());
        each_row(data, &self.across, |_, row, scratch| self.across.process_dct2_with_scratch(row, scratch));
        transpose(data, &mut self.turned, cols);
        // DCT-III undoes DCT-II up to this factor.
        let scale = 4.0 / (cols * rows) as f64;
        each_row(&mut self.turned, &self.down, |k, column, scratch| {
            self.down.process_dct2_with_scratch(column, scratch);
            column.iter_mut().enumerate().for_each(|(l, x)| *x *= scale * gain(k, l));
            self.down.process_dct3_with_scratch(column, scratch);
        });
        transpose(&self.turned, data, rows);
        each_row(data, &self.across, |_, row, scratch| self.across.process_dct3_with_scratch(row, scratch));
    }
}

impl std::fmt::Debug for CosineTransform {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "CosineTransform({} x {})", self.across.len(), self.down.len())
    }
}

fn each_row(
    data: &mut [f64],
    plan: &Arc<dyn TransformType2And3<f64>>,
    work: impl Fn(usize, &mut [f64], &mut [f64]) + Sync,
) {
    data.par_chunks_exact_mut(plan.len())
        .enumerate()
        .with_min_len(16)
        .for_each_init(|| vec![0.0; plan.get_scratch_len()], |scratch, (i, row)| work(i, row, scratch));
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
    let s = (std::f64::consts::FRAC_PI_2 * k as f64 / n as f64).sin();
    -4.0 * s * s
}
