//! The ground as a tree of blocks: range of heights, and error of drawing each in less detail.

use crate::raster::cells::SIDE;
use crate::simd::{self, Kernel};
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::{Heightfield, NodeState};
use belvedere_sight::Pyramid;
use rayon::prelude::*;

/// A block at one level: its cells are 2^level grid cells wide.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Span {
    /// Lowest and highest node; empty (min > max) where all are voids.
    pub(crate) z: [f32; 2],
    /// Largest distance in height between the ground and the block drawn at this level, every skipped node counted; infinite
    /// where the block cannot be drawn so (holes, sides that are no multiple of the step).
    pub(crate) error: f32,
    /// Addition to the error along the north, east, south and west side when every second node is left out there, to meet a
    /// neighbour of the next level.
    pub(crate) seam: [f32; 4],
}

/// Blocks of all levels; level k halves the detail k times, the last has one block.
///
/// The two triangles of a cell keep their diagonal at every level, so the ground and a coarse version of it differ most at
/// a node. A block's error is no less than those of the blocks under it.
#[derive(Debug)]
pub(crate) struct Tree {
    spans: Pyramid<Span>,
    pub(crate) sparse: DecimatedHeights,
}

/// Spacing, in nodes, of the samples of [`DecimatedHeights`].
const EVERY: usize = 8;

/// Heights of every [`EVERY`]th node along both axes, stored densely: coarse blocks read consecutive heights instead of one cache
/// line per height.
#[derive(Debug)]
pub(crate) struct DecimatedHeights {
    cols: usize,
    heights: Vec<f32>,
}

impl DecimatedHeights {
    fn new(hf: &Heightfield) -> Self {
        let cols = (hf.cols() - 1) / EVERY + 1;
        let rows = hf.heights().par_chunks(hf.cols()).step_by(EVERY);
        let heights = rows.flat_map_iter(|row| row.iter().step_by(EVERY).copied()).collect();
        Self { cols, heights }
    }

    /// Heights of a row of the ground from column `first` on, at least those of every `step`-th node; also the stride between these
    /// in the returned slice.
    #[inline(always)]
    pub(crate) fn row<'h>(&'h self, hf: &'h Heightfield, [first, row]: [usize; 2], step: usize) -> (&'h [f32], usize) {
        if (first | row | step).is_multiple_of(EVERY) {
            (&self.heights[row / EVERY * self.cols + first / EVERY..], step / EVERY)
        } else {
            (&hf.heights()[row * hf.cols() + first..], step)
        }
    }

    /// Bytes for a ground of `nodes` nodes.
    pub(crate) fn bytes(nodes: u64) -> u64 {
        nodes / (EVERY * EVERY) as u64 * size_of::<f32>() as u64
    }
}

impl Tree {
    pub(crate) fn new(hf: &Heightfield) -> Self {
        let cells = [hf.cols() - 1, hf.rows() - 1];
        let parent = |level, block, children: &[Span]| coarser(hf, level, block, children);
        Self { spans: Pyramid::new(cells, SIDE, |block| leaf(hf, block), parent), sparse: DecimatedHeights::new(hf) }
    }

    pub(crate) fn levels(&self) -> usize {
        self.spans.levels()
    }

    /// Blocks along both axes.
    pub(crate) fn size(&self, level: usize) -> [usize; 2] {
        self.spans.size(level)
    }

    pub(crate) fn span(&self, level: usize, block: [usize; 2]) -> &Span {
        self.spans.block(level, block)
    }

    /// Bounding box of the ground of a block; `None` where all of its nodes are voids.
    pub(crate) fn bounds(&self, hf: &Heightfield, level: usize, block: [usize; 2]) -> Option<Aabb> {
        let [z0, z1] = self.span(level, block).z;
        let (from, to) = nodes(hf, level, block);
        let (nw, se) = (hf.node_xy(from[0], from[1]), hf.node_xy(to[0], to[1]));
        let min = DVec3::new(nw.x, se.y, f64::from(z0));
        (z0 <= z1).then(|| Aabb { min, max: DVec3::new(se.x, nw.y, f64::from(z1)) })
    }
}

/// First and last node of a block.
pub(crate) fn nodes(hf: &Heightfield, level: usize, [x, y]: [usize; 2]) -> ([usize; 2], [usize; 2]) {
    let reach = SIDE << level;
    let from = [x * reach, y * reach];
    (from, [(from[0] + reach).min(hf.cols() - 1), (from[1] + reach).min(hf.rows() - 1)])
}

fn leaf(hf: &Heightfield, block: [usize; 2]) -> Span {
    let (from, to) = nodes(hf, 0, block);
    let mut z = [f32::INFINITY, f32::NEG_INFINITY];
    let mut holes = false;
    for r in from[1]..=to[1] {
        let row = r * hf.cols();
        let (first, last) = (row + from[0], row + to[0]);
        let void = |i: usize| hf.states().each().is_some_and(|s| s[i] == NodeState::Void);
        for i in first..=last {
            let h = hf.heights()[i];
            if void(i) {
                holes = true;
            } else {
                z = [if h < z[0] { h } else { z[0] }, if h > z[1] { h } else { z[1] }];
            }
        }
    }
    Span { z, error: 0.0, seam: if holes { [f32::INFINITY; 4] } else { seams(hf, 1, from, to) } }
}

fn coarser(hf: &Heightfield, level: usize, block: [usize; 2], children: &[Span]) -> Span {
    let mut out = Span { z: [f32::INFINITY, f32::NEG_INFINITY], error: 0.0, seam: [f32::INFINITY; 4] };
    for child in children {
        out.z = [out.z[0].min(child.z[0]), out.z[1].max(child.z[1])];
        out.error = out.error.max(child.error);
        // Infinite seams mark holes, or a side of odd length.
        if child.z[0] > child.z[1] || (level == 1 && child.seam == [f32::INFINITY; 4]) {
            out.error = f32::INFINITY;
        }
    }
    let (from, to) = nodes(hf, level, block);
    let step = 1 << level;
    if (to[0] - from[0]) % step != 0 || (to[1] - from[1]) % step != 0 {
        out.error = f32::INFINITY;
    }
    if out.error.is_finite() {
        let error = simd::run(Distance { hf, step, from, to });
        out.error = if error > out.error { error } else { out.error };
        out.seam = seams(hf, step, from, to);
    }
    out
}

/// Largest distance in height of the nodes of a block from the triangles drawn with every `step`-th node.
struct Distance<'a> {
    hf: &'a Heightfield,
    step: usize,
    from: [usize; 2],
    to: [usize; 2],
}

impl Kernel for Distance<'_> {
    type Output = f32;

    #[inline(always)]
    fn run(self) -> f32 {
        match self.step {
            2 => self.largest::<2>(),
            4 => self.largest::<4>(),
            8 => self.largest::<8>(),
            _ => self.largest::<16>(),
        }
    }
}

impl Distance<'_> {
    /// * `N`: nodes compared together; the step is a multiple.
    #[inline(always)]
    fn largest<const N: usize>(&self) -> f32 {
        let Self { hf, step, from, to } = *self;
        let (cols, h) = (hf.cols(), hf.heights());
        let mut worst = [0.0f32; N];
        for r in from[1]..=to[1] {
            // The last row of nodes belongs to the cells north of it.
            let first = if r < to[1] { r - (r - from[1]) % step } else { r - step };
            let (north, south, row) = (&h[first * cols..], &h[(first + step) * cols..], &h[r * cols..]);
            for c in (from[0]..to[0]).step_by(step) {
                let corners = [north[c], north[c + step], south[c], south[c + step]];
                let cell = CellLine::new(corners, r - first, step);
                for i in (0..step).step_by(N) {
                    cell.add::<N>(i, &row[c + i..], &mut worst);
                }
            }
            let c = to[0];
            let end = (row[c] - (north[c] + (r - first) as f32 / step as f32 * (south[c] - north[c]))).abs();
            worst[0] = if end > worst[0] { end } else { worst[0] };
        }
        worst.into_iter().fold(0.0, |a, b| if b > a { b } else { a })
    }
}

/// Heights of the two triangles of a coarse cell along one row of skipped nodes: one line up to the diagonal, another from there on.
struct CellLine {
    /// Height at the west end of the line west of the diagonal, and of that east of it, extended to the west end.
    start: [f32; 2],
    /// Change per node.
    slope: [f32; 2],
    diagonal: f32,
}

impl CellLine {
    /// * `corners`: north-west, north-east, south-west, south-east;
    /// * `j`: rows from the north.
    #[inline(always)]
    fn new([nw, ne, sw, se]: [f32; 4], j: usize, step: usize) -> Self {
        let (v, per) = (j as f32 / step as f32, 1.0 / step as f32);
        let slope = [(se - sw) * per, (ne - nw) * per];
        Self { start: [nw + v * (sw - nw), nw + v * (se - ne)], slope, diagonal: j as f32 }
    }

    /// Updates the largest distances with those of `N` nodes from number `i` on.
    #[inline(always)]
    fn add<const N: usize>(&self, i: usize, nodes: &[f32], worst: &mut [f32; N]) {
        let Some(nodes) = nodes.first_chunk::<N>() else { return };
        for k in 0..N {
            let at = i as f32 + k as f32;
            let [lower, upper] = [self.start[0] + at * self.slope[0], self.start[1] + at * self.slope[1]];
            let off = (nodes[k] - if at <= self.diagonal { lower } else { upper }).abs();
            worst[k] = if off > worst[k] { off } else { worst[k] };
        }
    }
}

/// See [`Span::seam`]: where the cells of a side are drawn in pairs with the odd node moved onto the even one before it,
/// the surface changes most at the node left out and where the pair's new diagonal crosses the old edge.
fn seams(hf: &Heightfield, step: usize, from: [usize; 2], to: [usize; 2]) -> [f32; 4] {
    let h = |c: usize, r: usize| hf.heights()[r * hf.cols() + c];
    let (wide, high) = (to[0] - from[0], to[1] - from[1]);
    let pair = |edge: [f32; 3], inner: [f32; 3], forward: bool| {
        let [a, m, b] = edge;
        let kink = if forward { a + inner[2] - m - inner[1] } else { a + inner[1] - inner[0] - m };
        (0.5 * (a + b) - m).abs().max(0.5 * kink.abs())
    };
    let along = |n: usize, at: &dyn Fn(usize, bool) -> f32, forward: bool| {
        if !n.is_multiple_of(2 * step) {
            return f32::INFINITY;
        }
        let three = |i: usize, inner: bool| [at(i, inner), at(i + step, inner), at(i + 2 * step, inner)];
        (0..n).step_by(2 * step).map(|i| pair(three(i, false), three(i, true), forward)).fold(0.0, f32::max)
    };
    let inward = |inner: bool| if inner { step } else { 0 };
    [
        along(wide, &|i, inner| h(from[0] + i, from[1] + inward(inner)), true),
        along(high, &|i, inner| h(to[0] - inward(inner), from[1] + i), false),
        along(wide, &|i, inner| h(from[0] + i, to[1] - inward(inner)), false),
        along(high, &|i, inner| h(from[0] + inward(inner), from[1] + i), true),
    ]
}

#[cfg(test)]
mod tests;
