//! Upper bounds of the rise of the ground from one displacement to the next.

use super::surface::Lattice;
use belvedere_core::DVec2;

/// Largest rise of the ground by blocks of the solver's grid.
pub(super) struct Rise<'a> {
    lattice: &'a Lattice,
    /// Rise of each node of the solver's grid, scene units.
    pub(super) change: &'a [f64],
    cols: usize,
    rows: usize,
    /// Cells per block.
    size: DVec2,
    most: Vec<f64>,
    /// Largest rise of any node, scene units.
    pub(super) greatest: f64,
}

/// Cells of the solver's grid per side of a block.
const SIDE: usize = 4;

impl<'a> Rise<'a> {
    pub(super) fn new(lattice: &'a Lattice, change: &'a [f64]) -> Self {
        let blocks = |n: usize| (n - 1).div_ceil(SIDE).max(1);
        let (cols, rows) = (blocks(lattice.cols), blocks(lattice.rows));
        let most = |b: usize| {
            let (x, y) = (b % cols * SIDE, b / cols * SIDE);
            let across = x..=(x + SIDE).min(lattice.cols - 1);
            let down = y..=(y + SIDE).min(lattice.rows - 1);
            down.flat_map(|y| &change[y * lattice.cols..][across.clone()]).copied().fold(0.0, f64::max)
        };
        let most: Vec<f64> = (0..cols * rows).map(most).collect();
        let greatest = most.iter().copied().fold(0.0, f64::max);
        Self { lattice, change, cols, rows, size: lattice.step * SIDE as f64, most, greatest }
    }

    /// Upper bound of the rise in a box (least and greatest corner, grid coordinates).
    pub(super) fn within(&self, corners: [DVec2; 2]) -> f64 {
        let Lattice { cols, rows, step } = *self.lattice;
        let [low, high] = corners.map(|c| c / step);
        let first = |v: f64, n: usize| ((v - 1e-9).max(0.0) as usize).min(n - 1);
        let last = |v: f64, n: usize| ((v + 1e-9).max(0.0) as usize + 1).min(n - 1);
        let mut most = 0.0f64;
        for y in first(low.y, rows)..=last(high.y, rows) {
            for v in &self.change[y * cols..][first(low.x, cols)..=last(high.x, cols)] {
                most = most.max(*v);
            }
        }
        most
    }

    /// Upper bound of the rise on straight lines from one box to another (least and greatest corners, grid coordinates).
    pub(super) fn along(&self, from: [DVec2; 2], to: [DVec2; 2]) -> f64 {
        let ([a, b], [c, d]) = (from.map(|p| p / self.size), to.map(|p| p / self.size));
        let pieces = (c - a).abs().max_element().clamp(1.0, 1e4).ceil();
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n - 1);
        let mut most = 0.0f64;
        for k in 0..pieces as usize {
            let (s, t) = (k as f64 / pieces, (k + 1) as f64 / pieces);
            let low = a.lerp(c, s).min(a.lerp(c, t)) - 1e-9;
            let high = b.lerp(d, s).max(b.lerp(d, t)) + 1e-9;
            for y in index(low.y, self.rows)..=index(high.y, self.rows) {
                for x in index(low.x, self.cols)..=index(high.x, self.cols) {
                    most = most.max(self.most[y * self.cols + x]);
                }
            }
        }
        most
    }
}
