//! The ground: two flat triangles per cell, whose nodes are displaced by the bilinear grid of the solver; and what it stays below.

use super::levels::Levels;
use crate::smooth::Between;
use belvedere_core::DVec2;
use belvedere_scene::CellTriangle;
use belvedere_sight::Pyramid;

/// Cells per side of the smallest block whose bound follows the displacement.
const BLOCK: usize = 8;
/// Cells per side of the smallest block that bounds the undisplaced ground.
const FINEST: usize = 2;

/// Facets that lie less over the bilinear displacement do so by rounding.
const AT_EDGE: f64 = 1e-12;

/// Height of a displacement that is flat on the triangles of the field over the bilinear one at `g`, per unit of the latter's factor
/// of xy in the cell of the field.
pub(super) fn facet_in_cell(g: DVec2) -> f64 {
    let inside = g - g.floor();
    inside.min_element() - inside.x * inside.y
}

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

    /// Bilinear value at grid position `g` of values of nodes.
    pub(super) fn value(&self, g: DVec2, u: &[f64]) -> f64 {
        let (nodes, weights) = self.weights(g);
        (0..4).map(|k| weights[k] * u[nodes[k] as usize]).sum()
    }

    /// Height of a displacement that is flat on the triangles of the field over the bilinear one at `g`, per unit of the latter's
    /// factor of xy in a cell of the lattice.
    pub(super) fn facet(&self, g: DVec2) -> f64 {
        facet_in_cell(g) / (self.step.x * self.step.y)
    }

    /// As [`Self::weights`], of a displacement that is flat on the triangles of the field.
    pub(super) fn weights_over(&self, g: DVec2) -> ([u32; 4], [f64; 4]) {
        let (nodes, [nw, ne, sw, se]) = self.weights(g);
        let facet = self.facet(g);
        (nodes, [nw + facet, ne - facet, sw - facet, se + facet])
    }

    /// The same as bilinear values at two points with their factors: what two points opposite each other have in common is bilinear
    /// but for the factor of xy.
    pub(super) fn betweens(&self, g: DVec2) -> [(f64, Between); 2] {
        let (at, facet) = (self.between(g), self.facet(g));
        // On lines of the terrain's grid both are the same.
        if facet < AT_EDGE {
            return [(1.0, at), (0.0, at)];
        }
        let away = facet.sqrt();
        [away, -away].map(|d| (0.5, Between { x: at.x + d, y: at.y + d, ..at }))
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
    /// Lakes, which rows know; bounds and walks take the ground on them to move as the grid does.
    pub(super) levels: Levels,
    /// Highest undisplaced ground of blocks of 2, 4, .. cells, and highest displaced ground of blocks of [`BLOCK`], ..
    still: Pyramid<f64>,
    displaced: Pyramid<f64>,
}

impl Surface {
    pub(super) fn new(heights: &[f64], cols: usize, rows: usize, lattice: Lattice) -> Self {
        let cells = [cols - 1, rows - 1];
        let mut out = Self {
            cols,
            rows,
            heights: heights.to_vec(),
            range: [0.0; 2],
            lattice,
            u: vec![0.0; lattice.cols * lattice.rows],
            patches: vec![[0.0; 4]; (lattice.cols.max(2) - 1) * (lattice.rows.max(2) - 1)],
            levels: Levels::default(),
            still: Pyramid::new(cells, FINEST, |_| 0.0, |_, _, _| 0.0),
            displaced: Pyramid::new(cells, BLOCK, |_| 0.0, |_, _, _| 0.0),
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
        let (cols, rows, heights) = (self.cols, self.rows, &self.heights);
        self.range =
            heights.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min(*h), high.max(*h)]);
        let highest = |[x, y]: [usize; 2]| {
            let (x, y) = (x * FINEST, y * FINEST);
            let (x1, y1) = ((x + FINEST).min(cols - 1), (y + FINEST).min(rows - 1));
            most((y..=y1).flat_map(|y| &heights[y * cols + x..=y * cols + x1]))
        };
        self.still.renew(highest, |children| most(children));
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
        let still = &self.still;
        let level = still.level_of(BLOCK as f64);
        let highest = |block: [usize; 2]| {
            let ((x0, x1), (y0, y1)) =
                (span(block[0], lattice.step.x, lattice.cols), span(block[1], lattice.step.y, lattice.rows));
            let moved = most((y0..=y1).flat_map(|y| &u[y * lattice.cols + x0..=y * lattice.cols + x1]));
            still.block(level, block) + moved
        };
        self.displaced.renew(highest, |children| most(children));
    }

    /// Upper bound of the displaced ground between `a` and `b` (grid coordinates).
    pub(super) fn bound(&self, a: DVec2, b: DVec2) -> f64 {
        bound(&self.displaced, usize::MAX, a, b)
    }

    /// Upper bound of the undisplaced ground between `a` and `b` (grid coordinates).
    pub(super) fn still_bound(&self, a: DVec2, b: DVec2) -> f64 {
        bound(&self.still, self.still.level_of(BLOCK as f64), a, b)
    }

    /// Upper bound of the displacement in a box (least and greatest corner, grid coordinates); and the factor of xy there that is
    /// farthest from 0, per square cell of the field.
    pub(super) fn displaced_bound(&self, [low, high]: [DVec2; 2]) -> (f64, f64) {
        let (cols, rows) = (self.lattice.cols.max(2) - 1, self.lattice.rows.max(2) - 1);
        let [low, high] = [low, high].map(|c| c / self.lattice.step);
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n - 1);
        let (mut most, mut twist) = (f64::NEG_INFINITY, 0.0f64);
        for row in index(low.y, rows)..=index(high.y, rows) {
            let y = [low.y, high.y].map(|y| (y - row as f64).clamp(0.0, 1.0));
            for col in index(low.x, cols)..=index(high.x, cols) {
                let x = [low.x, high.x].map(|x| (x - col as f64).clamp(0.0, 1.0));
                let [c, cx, cy, cxy] = self.patch(col, row);
                for (x, y) in [(x[0], y[0]), (x[1], y[0]), (x[0], y[1]), (x[1], y[1])] {
                    most = most.max(c + x * cx + y * (cy + x * cxy));
                }
                twist = twist.max(cxy.abs());
            }
        }
        (most, twist / (self.lattice.step.x * self.lattice.step.y))
    }

    /// The displacement over a cell of the lattice, see [`Self::patches`].
    pub(super) fn patch(&self, col: usize, row: usize) -> [f64; 4] {
        self.patches[row * (self.lattice.cols.max(2) - 1) + col]
    }

    /// The displacement at grid position `g`.
    pub(super) fn displacement(&self, g: DVec2) -> f64 {
        let (nodes, weights) = self.lattice.weights_over(g);
        (0..4).map(|k| weights[k] * self.u[nodes[k] as usize]).sum()
    }

    /// Height of the undisplaced triangles at grid position `g` (clamped into the grid).
    #[inline]
    pub(super) fn ground(&self, g: DVec2) -> f64 {
        let (col, row) = (
            (g.x.max(0.0) as usize).min(self.cols.saturating_sub(2)),
            (g.y.max(0.0) as usize).min(self.rows.saturating_sub(2)),
        );
        let fractions = (g - DVec2::new(col as f64, row as f64)).clamp(DVec2::ZERO, DVec2::ONE);
        let nw = row * self.cols + col;
        let corners = [nw, nw + 1, nw + self.cols, nw + self.cols + 1].map(|i| self.heights[i]);
        CellTriangle::at(fractions).height(corners, fractions)
    }
}

fn most<'v>(values: impl IntoIterator<Item = &'v f64>) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v))
}

/// Highest value around the box of `a` and `b`, by blocks as large as the box but of level `coarsest` at most.
fn bound(blocks: &Pyramid<f64>, coarsest: usize, a: DVec2, b: DVec2) -> f64 {
    let (low, high) = (a.min(b), a.max(b));
    let level = blocks.level_of((high - low).max_element()).min(coarsest);
    let [first, last] = [low, high].map(|g| blocks.block_at(level, g));
    blocks.fold(level, first, last, f64::NEG_INFINITY, |m, v| m.max(*v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::tests::noise;
    use crate::smooth::{Green, Smoother};

    #[test]
    fn facets_are_flat_between_the_values_at_the_nodes() {
        let (cols, rows, step) = (13, 10, DVec2::splat(3.0));
        let lattice = Lattice { cols: 5, rows: 4, step };
        let mut surface = Surface::new(&vec![0.0; cols * rows], cols, rows, lattice);
        surface.displace(&(0..20).map(|i| -90.0 * noise(i, 5)).collect::<Vec<_>>());
        let green = Green::new(&Smoother::new(5, 4, 0.7, 0.0).unwrap());
        let mut most = 0.0f64;
        for k in 0..400 {
            let g = DVec2::new(12.0 * noise(k, 1), 9.0 * noise(k, 2));
            let corner = g.floor();
            let bilinear = |g: DVec2| {
                let (nodes, weights) = lattice.weights(g);
                (0..4).map(|k| weights[k] * surface.u[nodes[k] as usize]).sum::<f64>()
            };
            let node = |x: f64, y: f64| bilinear(corner + DVec2::new(x, y));
            let corners = [node(0.0, 0.0), node(1.0, 0.0), node(0.0, 1.0), node(1.0, 1.0)];
            let flat = CellTriangle::at(g - corner).height(corners, g - corner);
            let facet = surface.displacement(g);
            assert!((facet - flat).abs() < 1e-9, "{g}: {facet} and {flat}");
            most = most.max((facet - bilinear(g)).abs());
            // The value that the metric uses.
            let (nodes, weights) = lattice.weights_over(g);
            let far = lattice.between(DVec2::new(7.3, 2.2));
            let entry = |j: u32| green.between(Between::node(j, 5, 4), far);
            let expected: f64 = (0..4).map(|j| weights[j] * entry(nodes[j])).sum();
            let found: f64 = lattice.betweens(g).iter().map(|(f, b)| f * green.between(*b, far)).sum();
            assert!((found - expected).abs() < 1e-12 * green.entry(0, 0), "{g}: {found} and {expected}");
        }
        assert!(most > 0.5, "{most}");
    }
}
