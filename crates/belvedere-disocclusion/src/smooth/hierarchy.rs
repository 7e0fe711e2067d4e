//! The solver's grid over the terrain's.

use belvedere_core::DVec2;

/// A coarse grid over a fine one: first corners coincide, values between coarse nodes are bilinear.
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    fine: [usize; 2],
    coarse: [usize; 2],
    step: DVec2,
    across: Vec<(u32, f64)>,
    down: Vec<(u32, f64)>,
}

impl Hierarchy {
    /// Corners coincide, steps need not be whole.
    ///
    /// * `cols`, `rows`: nodes of the fine grid, >= 1.
    /// * `nodes`: coarse nodes along the longer side, >= 2; the fine grid itself if that has fewer.
    pub fn new(cols: usize, rows: usize, nodes: usize) -> Self {
        let longer = cols.max(rows).max(2) - 1;
        let cells = (nodes.max(2) - 1).min(longer);
        let count = |n: usize| (n.max(1) - 1) * cells;
        let coarse = [cols, rows].map(|n| count(n).div_ceil(longer) + 1);
        let step = |n: usize, m: usize| if m > 1 { (n - 1) as f64 / (m - 1) as f64 } else { 1.0 };
        Self::with([cols, rows], coarse, DVec2::new(step(cols, coarse[0]), step(rows, coarse[1])))
    }

    /// A grid whose nodes are fine nodes; only the last column and row may lie beside the fine grid, by less than a step.
    ///
    /// A displacement of its nodes bends fine cells only at their edges, so that it hides nothing more once it is sampled at the fine
    /// nodes.
    ///
    /// * `nodes`: coarse nodes along the longer side, about.
    pub fn whole(cols: usize, rows: usize, nodes: usize) -> Self {
        let longer = cols.max(rows).max(2) - 1;
        let step = (longer as f64 / (nodes.max(2) - 1) as f64).round().max(1.0) as usize;
        let coarse = [cols, rows].map(|n| (n.max(1) - 1).div_ceil(step) + 1);
        Self::with([cols, rows], coarse, DVec2::splat(step as f64))
    }

    fn with([cols, rows]: [usize; 2], coarse: [usize; 2], step: DVec2) -> Self {
        let axis = |n: usize, m: usize, step: f64| (0..n).map(|i| cell(i as f64 / step, m)).collect();
        let across = axis(cols, coarse[0], step.x);
        let down = axis(rows, coarse[1], step.y);
        Self { fine: [cols, rows], coarse, step, across, down }
    }

    /// Steps along the longer side of the fine grid, > 0; not whole where the last nodes lie beside it.
    pub fn intervals(&self) -> f64 {
        let along = |axis: usize| (self.fine[axis].max(2) - 1) as f64 / self.step[axis];
        along(usize::from(self.fine[1] > self.fine[0]))
    }

    /// Coarse columns.
    pub fn cols(&self) -> usize {
        self.coarse[0]
    }

    /// Coarse rows.
    pub fn rows(&self) -> usize {
        self.coarse[1]
    }

    /// Coarse nodes.
    pub fn nodes(&self) -> usize {
        self.coarse[0] * self.coarse[1]
    }

    /// Fine cells per coarse cell along x and y, >= 1.
    pub fn step(&self) -> DVec2 {
        self.step
    }

    /// The coarse grid is the fine grid.
    pub fn is_full(&self) -> bool {
        self.fine == self.coarse
    }

    /// Row of B: the four coarse nodes around `g` (fine grid coordinates, clamped to the grid) and their bilinear
    /// weights, >= 0, sum 1. A node may occur twice on a grid of one row or column.
    pub fn weights(&self, g: DVec2) -> ([u32; 4], [f64; 4]) {
        let (c, a) = cell(g.x / self.step.x, self.coarse[0]);
        let (r, b) = cell(g.y / self.step.y, self.coarse[1]);
        let (c1, r1) = ((c + 1).min(self.coarse[0] as u32 - 1), (r + 1).min(self.coarse[1] as u32 - 1));
        let w = self.coarse[0] as u32;
        let nodes = [r * w + c, r * w + c1, r1 * w + c, r1 * w + c1];
        (nodes, [(1.0 - b) * (1.0 - a), (1.0 - b) * a, b * (1.0 - a), b * a])
    }

    /// Bilinear value of coarse values at fine grid coordinates.
    pub fn at(&self, coarse: &[f64], g: DVec2) -> f64 {
        let (nodes, weights) = self.weights(g);
        nodes.iter().zip(weights).map(|(n, w)| coarse[*n as usize] * w).sum()
    }

    /// Bilinear value of fine values at fine grid coordinates, clamped to the grid.
    pub fn fine_at(&self, fine: &[f64], g: DVec2) -> f64 {
        let [cols, rows] = self.fine;
        let (c, a) = cell(g.x, cols);
        let (r, b) = cell(g.y, rows);
        let at = |c: u32, r: u32| fine[(r as usize).min(rows - 1) * cols + (c as usize).min(cols - 1)];
        (1.0 - b) * ((1.0 - a) * at(c, r) + a * at(c + 1, r)) + b * ((1.0 - a) * at(c, r + 1) + a * at(c + 1, r + 1))
    }

    /// R = diag(1 / B^T 1) B^T: fine values averaged onto the coarse nodes (Deng et al. 2013 sample; averaging does not
    /// alias the borders of cells).
    ///
    /// # Panics
    /// If `fine` has another size than the fine grid.
    pub fn restrict(&self, fine: &[f64]) -> Vec<f64> {
        assert_eq!(fine.len(), self.fine[0] * self.fine[1], "values of the fine grid");
        if self.is_full() {
            return fine.to_vec();
        }
        let rows: Vec<f64> =
            fine.chunks_exact(self.fine[0]).flat_map(|row| average(row, &self.across, self.coarse[0])).collect();
        let width = self.coarse[0];
        let mut out = vec![0.0; self.nodes()];
        let mut total = vec![0.0; self.coarse[1]];
        for (row, &(r, b)) in rows.chunks_exact(width).zip(&self.down) {
            for (target, weight) in [(r as usize, 1.0 - b), (r as usize + 1, b)] {
                if weight > 0.0 {
                    total[target] += weight;
                    for (o, x) in out[target * width..(target + 1) * width].iter_mut().zip(row) {
                        *o += weight * x;
                    }
                }
            }
        }
        for (row, t) in out.chunks_exact_mut(width).zip(total) {
            row.iter_mut().for_each(|o| *o /= t);
        }
        out
    }

    /// B: coarse values spread bilinearly over the fine grid.
    ///
    /// # Panics
    /// If `coarse` has another size than the coarse grid.
    pub fn prolong(&self, coarse: &[f64]) -> Vec<f64> {
        assert_eq!(coarse.len(), self.nodes(), "values of the coarse grid");
        if self.is_full() {
            return coarse.to_vec();
        }
        let width = self.coarse[0];
        let row = |r: usize| &coarse[r.min(self.coarse[1] - 1) * width..][..width];
        let mut between = vec![0.0; width + 1];
        let mut out = Vec::with_capacity(self.fine[0] * self.fine[1]);
        for &(r, b) in &self.down {
            let (upper, lower) = (row(r as usize), row(r as usize + 1));
            for ((o, u), l) in between.iter_mut().zip(upper).zip(lower) {
                *o = (1.0 - b) * u + b * l;
            }
            between[width] = between[width - 1];
            out.extend(self.across.iter().map(|&(c, a)| (1.0 - a) * between[c as usize] + a * between[c as usize + 1]));
        }
        out
    }
}

/// Cell of coordinate `x` among `m` nodes and the position in that cell (0..=1), clamped. The last node is the end of the last cell.
fn cell(x: f64, m: usize) -> (u32, f64) {
    let x = x.clamp(0.0, (m - 1) as f64);
    let i = (x as usize).min(m.max(2) - 2);
    (i as u32, x - i as f64)
}

/// One row averaged onto `m` coarse nodes.
fn average(row: &[f64], places: &[(u32, f64)], m: usize) -> Vec<f64> {
    let (mut sum, mut total) = (vec![0.0; m], vec![0.0; m]);
    for (x, &(c, a)) in row.iter().zip(places) {
        for (target, weight) in [(c as usize, 1.0 - a), (c as usize + 1, a)] {
            if weight > 0.0 {
                sum[target] += weight * x;
                total[target] += weight;
            }
        }
    }
    sum.iter().zip(total).map(|(s, t)| s / t).collect()
}
