//! Generalised relief: slopes of ground without its small forms, and heights of the surroundings of places.
//!
//! Painters of relief shade large forms and small ones together (Patterson's resolution bumping); where forest and rock lie depends on
//! whether a place is a gully or a ridge.

use crate::shade::ground::surface::{MipPyramid, tap};
use crate::shade::ground::tiles::Line;
use belvedere_core::DVec2;
use glam::Vec4;
use rayon::prelude::*;

/// Size of the smaller of two generalised forms, metres, and how many times coarser the other one is, in powers of two.
const FORM_M: f64 = 120.0;
const COARSER: usize = 2;
/// Shares of both.
const SHARES: [f32; 2] = [0.66, 0.34];
/// Levels of averages that the whole ground has over the smaller form.
const LEVELS_OVER: usize = 5;

/// Generalised slopes and surroundings on a grid of averages.
#[derive(Debug)]
pub(crate) struct Broad {
    level: usize,
    cols: usize,
    rows: usize,
    /// dz/dx, dz/dy, height of the surroundings; fourth unused.
    nodes: Vec<Vec4>,
    /// How much steeper the ground is shaded than it is: gentle ground shows its forms, too.
    pub(crate) steeper: f32,
}

/// Usual slope of generalised ground that is shaded as steep as it is, and the most that gentler ground is shaded steeper.
const USUAL_SLOPE: f32 = 0.30;
const STEEPEST: f32 = 1.8;

/// Bytes of [`Broad`] of a ground of `nodes` nodes, at most, with what its making takes.
pub(crate) fn bytes(nodes: u64) -> u64 {
    2 * nodes / 4 * size_of::<Vec4>() as u64
}

impl Broad {
    /// * `means`: averages of the ground; `spacing`: of its nodes, metres.
    pub(crate) fn new(means: &MipPyramid, spacing: DVec2) -> Self {
        let cell = spacing.min_element();
        let wanted = (FORM_M / cell).log2().round().max(1.0) as usize;
        let form = wanted.min(means.top().saturating_sub(LEVELS_OVER)).clamp(means.first, means.top());
        let level = (form - 1).max(means.first);
        let [cols, rows] = means.size(level);
        let heights = |k: usize| means.smooth_heights(k.clamp(level, means.top()), level);
        let [small, around, large] = [heights(form), heights(form + 1), heights(form + COARSER)];
        let per = (0.5 / (spacing * f64::from(1u32 << level))).as_vec2();
        let mut nodes = vec![Vec4::ZERO; cols * rows];
        nodes.par_chunks_mut(cols).enumerate().for_each(|(r, row)| {
            for (c, node) in row.iter_mut().enumerate() {
                let slope = |z: &[f32]| {
                    let at = |c: usize, r: usize| z[r.min(rows - 1) * cols + c.min(cols - 1)];
                    let east = at(c + 1, r) - at(c.saturating_sub(1), r);
                    let north = at(c, r.saturating_sub(1)) - at(c, r + 1);
                    [east * per.x, north * per.y]
                };
                let [a, b] = [slope(&small), slope(&large)];
                let [x, y] = [0, 1].map(|i| SHARES[0] * a[i] + SHARES[1] * b[i]);
                *node = Vec4::new(x, y, around[r * cols + c], 0.0);
            }
        });
        let slopes = nodes.iter().map(|node| node.truncate().truncate().length()).filter(|slope| *slope > 0.0);
        let (sum, count) = slopes.fold((0.0f64, 0u64), |(sum, count), slope| (sum + f64::from(slope), count + 1));
        let usual = (sum / count.max(1) as f64) as f32;
        let steeper = (USUAL_SLOPE / usual.max(1e-3)).sqrt().clamp(1.0, STEEPEST);
        Self { level, cols, rows, nodes, steeper }
    }

    /// Values at nodes of a line of a level, from the first on: dz/dx, dz/dy and height of the surroundings.
    /// * `per_node`: spacing of these nodes in nodes of the ground; `row`: number of the row.
    pub(crate) fn row(&self, per_node: f32, row: f32, columns: Line, [x, y, z]: [&mut [f32]; 3]) {
        let to_own = 1.0 / (1u32 << self.level) as f32;
        // Node i of a level lies at (i + 0.5) times its spacing less 0.5.
        let place = |i: f32| (i + 0.5) * per_node * to_own - 0.5;
        let (north, south, v) = tap(place(row), self.rows);
        let (north, south) =
            (&self.nodes[north * self.cols..][..self.cols], &self.nodes[south * self.cols..][..self.cols]);
        for (i, c) in columns.iter().enumerate() {
            let (west, east, u) = tap(place(c as f32), self.cols);
            let (a, b) = (north[west] + u * (north[east] - north[west]), south[west] + u * (south[east] - south[west]));
            let node = a + v * (b - a);
            (x[i], y[i], z[i]) = (node.x, node.y, node.z);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::ground::surface::Surface;
    use crate::shade::ground::tiles::Tiles;
    use belvedere_scene::Heightfield;

    #[test]
    fn slopes_of_large_forms_stay_and_small_ones_go() {
        // A plane that rises to the east, with waves of four nodes.
        let (cols, rows, spacing) = (400, 300, 30.0);
        let height = |i: usize| {
            let (x, y) = (30.0 * (i % cols) as f32, (i / cols) as f32);
            500.0 + 0.3 * x + 12.0 * (x * std::f32::consts::TAU / 120.0).sin() * (0.5 * y).cos()
        };
        let heights = (0..cols * rows).map(height).collect();
        let hf = Heightfield::measured(DVec2::ZERO, DVec2::splat(spacing), cols, rows, heights).expect("ground");
        let means = MipPyramid::new(&Surface::of_map(&hf));
        let broad = Broad::new(&means, hf.spacing());
        let [columns, _] = Tiles::new([cols, rows], means.top(), 2).repeated(2, [5, 4]).map(|nodes| nodes.all());
        let mut planes = [0; 3].map(|_| vec![0.0; columns.count]);
        let [x, y, z] = &mut planes;
        broad.row(1.0, 150.0, columns, [x, y, z]);
        for (i, c) in columns.iter().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|k| planes[k][i]);
            assert!((x - 0.3).abs() < 0.04 && y.abs() < 0.04, "column {c}: {x} {y}");
            assert!((z - (500.0 + 9.0 * c as f32)).abs() < 12.0, "column {c}: {z}");
        }
    }
}
