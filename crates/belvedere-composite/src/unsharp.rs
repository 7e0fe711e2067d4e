//! Depth unsharp masking: how far the surroundings of a pixel lie behind it, from depths on a grid.
//!
//! Source: Luft, Colditz and Deussen 2006.

use rayon::prelude::*;

/// Standard deviation of the average of depths, as a share of the picture's diagonal.
const SIGMA: f32 = 0.01;
/// Cells of the grid from which on it becomes wider than two pixels.
const MOST_CELLS: usize = 1 << 21;

/// Depths of four neighbouring pixels in the middle of each cell of a grid over the picture: all pixels of a picture of up to 33 million, some
/// of larger ones.
#[derive(Debug)]
pub struct DepthGrid {
    width: usize,
    height: usize,
    /// Side of a cell, pixels: even.
    side: usize,
    cells: Vec<[f32; 4]>,
}

impl DepthGrid {
    /// A grid over a picture of this size, pixels, all of it sky.
    pub fn new([width, height]: [usize; 2]) -> Self {
        let fourfold = (width * height) as f64 / (4 * MOST_CELLS) as f64;
        let side = 2 * (fourfold.sqrt().floor() as usize).max(1);
        let cells = vec![[f32::INFINITY; 4]; width.div_ceil(side) * height.div_ceil(side)];
        Self { width, height, side, cells }
    }

    /// Bytes of the grid of a picture of so many pixels, with its averages, at most.
    pub fn bytes(pixels: u64) -> u64 {
        (pixels / 4 + 1).min(8 * MOST_CELLS as u64) * 40
    }

    fn size(&self) -> [usize; 2] {
        [self.width, self.height].map(|n| n.div_ceil(self.side))
    }

    /// The two columns or rows of a cell that are read.
    fn read(&self, cell: usize, end: usize) -> [usize; 2] {
        let first = (cell * self.side + self.side / 2 - 1).min(end - 1);
        [first, (first + 1).min(end - 1)]
    }

    /// Rows of the picture that are read, rising.
    pub fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = (0..self.size()[1]).flat_map(|cell| self.read(cell, self.height));
        let mut last = None;
        rows.filter(move |row| last.replace(*row) != Some(*row))
    }

    /// Reads a row.
    /// * `depth`: of all its pixels.
    pub fn fill(&mut self, row: usize, depth: &[f32]) {
        let [across, down] = self.size();
        let near = row / self.side;
        for cell in [near.checked_sub(1), Some(near)].into_iter().flatten().filter(|cell| *cell < down) {
            for (k, _) in self.read(cell, self.height).into_iter().enumerate().filter(|(_, of)| *of == row) {
                for column in 0..across {
                    let [left, right] = self.read(column, self.width);
                    let corners = &mut self.cells[cell * across + column];
                    (corners[2 * k], corners[2 * k + 1]) = (depth[left], depth[right]);
                }
            }
        }
    }

    fn of_picture(depth: &[f32], width: usize) -> Self {
        let mut grid = Self::new([width, depth.len() / width]);
        let rows: Vec<usize> = grid.rows().collect();
        rows.into_iter().for_each(|row| grid.fill(row, &depth[row * width..][..width]));
        grid
    }

    /// Least and largest depth without the sky; `None` if all is sky.
    fn range(&self) -> Option<[f32; 2]> {
        let finite = self.cells.iter().flatten().filter(|d| d.is_finite());
        let [lo, hi] = finite.fold([f32::INFINITY, f32::NEG_INFINITY], |[lo, hi], d| [lo.min(*d), hi.max(*d)]);
        (lo <= hi).then_some([lo, hi])
    }
}

/// Mean depths of the surroundings.
///
/// The logarithm of the depth is used, so that a doubling counts the same everywhere; in parallel projection the depth itself.
#[derive(Debug)]
pub struct Surroundings {
    grid: [usize; 2],
    side: usize,
    ortho: bool,
    /// Least depth and range of depths on that scale.
    from: f32,
    size: f32,
    /// As shares of the range; empty if all is sky.
    mean: Vec<f32>,
}

impl Surroundings {
    /// * `ortho`: whether the projection is parallel.
    pub fn new(grid: &DepthGrid, ortho: bool) -> Self {
        let [across, down] = grid.size();
        let sky = Self { grid: [across, down], side: grid.side, ortho, from: 0.0, size: 1.0, mean: Vec::new() };
        let Some([lo, hi]) = grid.range() else { return sky };
        let scale = |d: f32| if ortho { d } else { d.max(f32::MIN_POSITIVE).ln() };
        let this = Self { from: scale(lo), size: (scale(hi) - scale(lo)).max(1e-6), ..sky };
        let shares: Vec<f32> =
            grid.cells.par_iter().map(|cell| 0.25 * cell.map(|d| this.share(d)).iter().sum::<f32>()).collect();
        let [width, height] = [grid.width, grid.height];
        let sigma = SIGMA * ((width * width + height * height) as f32).sqrt() / grid.side as f32;
        let weights = gaussian(sigma);
        let mean = blurred(&blurred(&shares, across, &weights), down, &weights);
        Self { mean, ..this }
    }

    /// Of a whole picture.
    /// * `depth`: of all pixels.
    pub fn of_picture(depth: &[f32], width: usize, ortho: bool) -> Self {
        Self::new(&DepthGrid::of_picture(depth, width), ortho)
    }

    fn share(&self, d: f32) -> f32 {
        let scale = |d: f32| if self.ortho { d } else { d.max(f32::MIN_POSITIVE).ln() };
        // The sky counts as far as the farthest surface, so that there are no halos against it.
        if d.is_finite() { (scale(d) - self.from) / self.size } else { 1.0 }
    }

    /// Mean depth of the surroundings minus the depth of a pixel, as a share of the range of depths; 0 in the sky.
    pub fn behind(&self, [x, y]: [usize; 2], depth: f32) -> f32 {
        if !depth.is_finite() || self.mean.is_empty() {
            return 0.0;
        }
        let [across, down] = self.grid;
        // Position of the pixel's centre in the grid.
        let place = |p: usize, n: usize| {
            let g = ((p as f32 + 0.5) / self.side as f32 - 0.5).clamp(0.0, (n - 1) as f32);
            let i = (g as usize).min(n.saturating_sub(2));
            (i, (i + 1).min(n - 1), g - i as f32)
        };
        let ((x0, x1, u), (y0, y1, v)) = (place(x, across), place(y, down));
        let line = |y: usize| self.mean[y * across + x0] * (1.0 - u) + self.mean[y * across + x1] * u;
        line(y0) * (1.0 - v) + line(y1) * v - self.share(depth)
    }
}

/// One half of a Gaussian; the sum over both halves is 1.
fn gaussian(sigma: f32) -> Vec<f32> {
    let reach = (3.0 * sigma).ceil().max(1.0) as usize;
    let weights: Vec<f32> = (0..=reach).map(|i| (-0.5 * (i as f32 / sigma.max(1e-3)).powi(2)).exp()).collect();
    let sum = 2.0 * weights.iter().sum::<f32>() - weights[0];
    weights.into_iter().map(|w| w / sum).collect()
}

/// Weighted sums along rows of `width`, with the rim repeated; the result is transposed.
fn blurred(of: &[f32], width: usize, weights: &[f32]) -> Vec<f32> {
    let (height, reach) = (of.len() / width, weights.len() - 1);
    let mut lines = vec![0.0; of.len()];
    lines.par_chunks_mut(width).zip(of.par_chunks(width)).for_each(|(out, row)| {
        let at = |i: isize| row[i.clamp(0, width as isize - 1) as usize];
        for (x, out) in out.iter_mut().enumerate() {
            let x = x as isize;
            let sides = (1..=reach as isize).map(|k| weights[k as usize] * (at(x - k) + at(x + k)));
            *out = weights[0] * at(x) + sides.sum::<f32>();
        }
    });
    let mut turned = vec![0.0; of.len()];
    turned.par_chunks_mut(height).enumerate().for_each(|(x, out)| {
        for (y, out) in out.iter_mut().enumerate() {
            *out = lines[y * width + x];
        }
    });
    turned
}

#[cfg(test)]
mod tests;
