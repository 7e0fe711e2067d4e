//! The ground as drawn: two triangles per cell, displaced by the bilinear grid of the solver; and what it stays below.

use crate::smooth::Between;
use belvedere_core::DVec2;

/// Cells per side of the smallest block whose bound follows the displacement.
const BLOCK: usize = 8;
/// Cells per side of the blocks that bound the undisplaced ground, smallest first; the last is [`BLOCK`].
const STILL: [usize; 3] = [2, 4, BLOCK];

/// Nodes of the solver over the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lattice {
    pub(super) cols: usize,
    pub(super) rows: usize,
    /// Field cells per cell of the lattice.
    pub(super) step: DVec2,
}

impl Lattice {
    /// Nodes and weights of the bilinear value at grid position `g`.
    pub(super) fn weights(&self, g: DVec2) -> ([u32; 4], [f64; 4]) {
        let Between { col, row, x: a, y: b } = self.between(g);
        let i = row as usize * self.cols + col as usize;
        let (right, below) = (usize::from(self.cols > 1), if self.rows > 1 { self.cols } else { 0 });
        let nodes = [i, i + right, i + below, i + below + right].map(|n| n as u32);
        (nodes, [(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b])
    }

    /// Grid position `g` by cell.
    pub(super) fn between(&self, g: DVec2) -> Between {
        let s = g / self.step;
        let col = (s.x.max(0.0) as usize).min(self.cols.saturating_sub(2));
        let row = (s.y.max(0.0) as usize).min(self.rows.saturating_sub(2));
        Between { col: col as u32, row: row as u32, x: s.x - col as f64, y: s.y - row as f64 }
    }

    pub(super) fn at(&self, u: &[f64], g: DVec2) -> f64 {
        let (nodes, weights) = self.weights(g);
        (0..4).map(|k| weights[k] * u[nodes[k] as usize]).sum()
    }
}

/// Highest values of blocks, of blocks of blocks, ...
#[derive(Debug, Clone)]
struct Level {
    cols: usize,
    rows: usize,
    /// Cells per side of a block.
    size: usize,
    /// One over `size`.
    scale: f64,
    highest: Vec<f64>,
}

impl Level {
    /// Highest value around the box of `a` and `b`, from the finest level whose blocks are as large as the box.
    fn bound(levels: &[Self], a: DVec2, b: DVec2) -> f64 {
        let (lo, hi) = (a.min(b), a.max(b));
        let extent = (hi - lo).max_element();
        let level = levels.iter().find(|l| l.size as f64 >= extent).unwrap_or(&levels[levels.len() - 1]);
        let index = |v: f64, n: usize| ((v * level.scale).max(0.0) as usize).min(n - 1);
        let (x0, x1) = (index(lo.x, level.cols), index(hi.x, level.cols));
        let (y0, y1) = (index(lo.y, level.rows), index(hi.y, level.rows));
        let mut most = f64::NEG_INFINITY;
        for y in y0..=y1 {
            for v in &level.highest[y * level.cols + x0..=y * level.cols + x1] {
                most = most.max(*v);
            }
        }
        most
    }
}

/// Heights that do not move, a displacement that does, and bounds on their sum.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub(super) cols: usize,
    pub(super) rows: usize,
    pub(super) heights: Vec<f64>,
    /// Lowest and highest of them.
    pub(super) range: [f64; 2],
    pub(super) lattice: Lattice,
    pub(super) u: Vec<f64>,
    /// For each cell of the lattice the value at its first node and the factors of x, y and xy, both 0..=1 in the cell.
    pub(super) patches: Vec<[f64; 4]>,
    still: Vec<Level>,
    levels: Vec<Level>,
}

impl Surface {
    pub(super) fn new(heights: &[f64], cols: usize, rows: usize, lattice: Lattice) -> Self {
        let (mut c, mut r) = ((cols - 1).div_ceil(BLOCK).max(1), (rows - 1).div_ceil(BLOCK).max(1));
        let mut levels = Vec::new();
        let mut size = BLOCK;
        loop {
            levels.push(Level {
                cols: c,
                rows: r,
                size,
                scale: 1.0 / size as f64,
                highest: vec![f64::INFINITY; c * r],
            });
            if c == 1 && r == 1 {
                break;
            }
            (c, r, size) = (c.div_ceil(2), r.div_ceil(2), size * 2);
        }
        let mut out = Self {
            cols,
            rows,
            heights: heights.to_vec(),
            range: [0.0; 2],
            lattice,
            u: vec![0.0; lattice.cols * lattice.rows],
            patches: vec![[0.0; 4]; (lattice.cols.max(2) - 1) * (lattice.rows.max(2) - 1)],
            still: Vec::new(),
            levels,
        };
        out.bound_heights();
        out.displace(&out.u.clone());
        out
    }

    /// Other heights on the same grid.
    pub(super) fn set_heights(&mut self, heights: &[f64]) {
        self.heights.copy_from_slice(heights);
        self.bound_heights();
    }

    fn bound_heights(&mut self) {
        let range = |[low, high]: [f64; 2], h: &f64| [low.min(*h), high.max(*h)];
        self.range = self.heights.iter().fold([f64::INFINITY, f64::NEG_INFINITY], range);
        self.still.clear();
        for size in STILL {
            let (cols, rows) = ((self.cols - 1).div_ceil(size).max(1), (self.rows - 1).div_ceil(size).max(1));
            let highest = (0..cols * rows).map(|b| self.highest(b % cols * size, b / cols * size, size)).collect();
            self.still.push(Level { cols, rows, size, scale: 1.0 / size as f64, highest });
        }
    }

    /// Highest vertex of the block at (x, y).
    fn highest(&self, x: usize, y: usize, size: usize) -> f64 {
        let (x1, y1) = ((x + size).min(self.cols - 1), (y + size).min(self.rows - 1));
        let rows = (y..=y1).flat_map(|y| &self.heights[y * self.cols + x..=y * self.cols + x1]);
        rows.fold(f64::NEG_INFINITY, |m, h| m.max(*h))
    }

    /// Takes `u` and renews the bounds.
    pub(super) fn displace(&mut self, u: &[f64]) {
        self.u.copy_from_slice(u);
        let lattice = self.lattice;
        for (row, line) in self.patches.chunks_exact_mut(lattice.cols.max(2) - 1).enumerate() {
            let upper = &u[row * lattice.cols..][..lattice.cols];
            let lower = &u[(row + 1).min(lattice.rows - 1) * lattice.cols..][..lattice.cols];
            for (col, patch) in line.iter_mut().enumerate() {
                let right = (col + 1).min(lattice.cols - 1);
                let [nw, ne, sw, se] = [upper[col], upper[right], lower[col], lower[right]];
                *patch = [nw, ne - nw, sw - nw, se - sw - ne + nw];
            }
        }
        let span = |block: usize, step: f64, n: usize| {
            let from = ((block * BLOCK) as f64 / step) as usize;
            let to = (((block + 1) * BLOCK) as f64 / step).ceil() as usize;
            (from.min(n - 1), to.min(n - 1))
        };
        let still = &self.still[STILL.len() - 1];
        let base = &mut self.levels[0];
        for by in 0..base.rows {
            let (y0, y1) = span(by, lattice.step.y, lattice.rows);
            for bx in 0..base.cols {
                let (x0, x1) = span(bx, lattice.step.x, lattice.cols);
                let mut most = f64::NEG_INFINITY;
                for y in y0..=y1 {
                    for v in &u[y * lattice.cols + x0..=y * lattice.cols + x1] {
                        most = most.max(*v);
                    }
                }
                base.highest[by * base.cols + bx] = still.highest[by * base.cols + bx] + most;
            }
        }
        for k in 1..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(k);
            let (fine, coarse) = (&finer[k - 1], &mut coarser[0]);
            for y in 0..coarse.rows {
                for x in 0..coarse.cols {
                    let mut most = f64::NEG_INFINITY;
                    for fy in 2 * y..(2 * y + 2).min(fine.rows) {
                        for fx in 2 * x..(2 * x + 2).min(fine.cols) {
                            most = most.max(fine.highest[fy * fine.cols + fx]);
                        }
                    }
                    coarse.highest[y * coarse.cols + x] = most;
                }
            }
        }
    }

    /// Nothing between `a` and `b` (grid) is higher.
    pub(super) fn bound(&self, a: DVec2, b: DVec2) -> f64 {
        Level::bound(&self.levels, a, b)
    }

    /// Nothing of the undisplaced ground between `a` and `b` (grid) is higher.
    pub(super) fn still_bound(&self, a: DVec2, b: DVec2) -> f64 {
        Level::bound(&self.still, a, b)
    }

    /// Nothing of the displacement in a box (least and greatest corner, grid) is higher; and the factor of xy there that is farthest
    /// from 0, per square cell of the field.
    pub(super) fn displaced_bound(&self, [low, high]: [DVec2; 2]) -> (f64, f64) {
        let (cols, rows) = (self.lattice.cols.max(2) - 1, self.lattice.rows.max(2) - 1);
        let [low, high] = [low, high].map(|c| c / self.lattice.step);
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n - 1);
        let (mut most, mut twist) = (f64::NEG_INFINITY, 0.0f64);
        for row in index(low.y, rows)..=index(high.y, rows) {
            let y = [low.y, high.y].map(|y| (y - row as f64).clamp(0.0, 1.0));
            for col in index(low.x, cols)..=index(high.x, cols) {
                let x = [low.x, high.x].map(|x| (x - col as f64).clamp(0.0, 1.0));
                let [c, cx, cy, cxy] = self.patches[row * cols + col];
                for (x, y) in [(x[0], y[0]), (x[1], y[0]), (x[0], y[1]), (x[1], y[1])] {
                    most = most.max(c + x * cx + y * (cy + x * cxy));
                }
                twist = twist.max(cxy.abs());
            }
        }
        (most, twist / (self.lattice.step.x * self.lattice.step.y))
    }

    /// Height of the undisplaced triangles at grid position `g` (clamped into the grid).
    #[inline]
    pub(super) fn ground(&self, g: DVec2) -> f64 {
        let (col, row) = (
            (g.x.max(0.0) as usize).min(self.cols.saturating_sub(2)),
            (g.y.max(0.0) as usize).min(self.rows.saturating_sub(2)),
        );
        let (a, b) = ((g.x - col as f64).clamp(0.0, 1.0), (g.y - row as f64).clamp(0.0, 1.0));
        let h = |x: usize, y: usize| self.heights[(row + y) * self.cols + col + x];
        // Split from north-west to south-east.
        if a >= b {
            h(0, 0) + a * (h(1, 0) - h(0, 0)) + b * (h(1, 1) - h(1, 0))
        } else {
            h(0, 0) + b * (h(0, 1) - h(0, 0)) + a * (h(1, 1) - h(0, 1))
        }
    }
}
