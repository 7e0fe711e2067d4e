//! The shape of the ground as shading sees it: slopes and heights, and their averages over ever larger cells.
//!
//! Only averages are stored: full detail is computed from the heights themselves.

use crate::shade::ground::planes::{CHUNK, Inner, Inside, Planes};
use crate::simd;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, NodeState};
use glam::Vec4;
use rayon::prelude::*;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// Most nodes that the finest stored level may have, unless it is the first one.
const MOST_NODES: usize = 1 << 23;
/// Grounds up to this many nodes store averages from level 1 up.
const SMALL_GROUND: usize = 17 << 20;

/// Levels over which the surroundings of a point are averaged, and their share in its openness.
const SURROUNDINGS: [(usize, f32); 2] = [(3, 0.5), (5, 0.5)];
/// Share of the nearest surroundings, those of the finest stored level.
const NEAR_SHARE: f32 = 0.3;

/// Moves points before their slopes are taken.
pub(crate) type Moved<'a> = dyn Fn(DVec3) -> Option<DVec3> + Send + Sync + 'a;

/// The ground that light falls on: that of the map, or a displaced one.
pub(crate) struct Surface<'a> {
    pub(crate) hf: &'a Heightfield,
    /// Heights row by row; differ from the heightfield's where the ground was moved up or down.
    heights: Heights<'a>,
    /// Displacement in any direction: slopes are taken between displaced neighbours.
    bent: Option<Arc<Moved<'a>>>,
}

enum Heights<'a> {
    Map(&'a [f32]),
    Moved(Arc<Vec<f32>>),
}

impl Deref for Heights<'_> {
    type Target = [f32];

    #[inline(always)]
    fn deref(&self) -> &[f32] {
        match self {
            Self::Map(heights) => heights,
            Self::Moved(heights) => heights,
        }
    }
}

impl<'a> Surface<'a> {
    /// The undisplaced ground.
    pub(crate) fn of_map(hf: &'a Heightfield) -> Self {
        Self { hf, heights: Heights::Map(hf.heights()), bent: None }
    }

    /// Ground moved along z alone.
    /// * `heights`: row by row.
    pub(crate) fn lifted(hf: &'a Heightfield, heights: Arc<Vec<f32>>) -> Self {
        Self { hf, heights: Heights::Moved(heights), bent: None }
    }

    /// Ground displaced in any direction.
    pub(crate) fn bent(hf: &'a Heightfield, bent: Arc<Moved<'a>>) -> Self {
        Self { hf, heights: Heights::Map(hf.heights()), bent: Some(bent) }
    }

    /// Whether nothing was displaced.
    pub(crate) fn is_map(&self) -> bool {
        self.bent.is_none() && matches!(self.heights, Heights::Map(_))
    }

    /// Heights moved along z alone, if they were.
    pub(crate) fn moved(&self) -> Option<&Arc<Vec<f32>>> {
        if let Heights::Moved(heights) = &self.heights { Some(heights) } else { None }
    }

    /// Heights row by row; those of voids are arbitrary.
    pub(crate) fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// dz/dx, dz/dy, height, 1 of the nodes of a row from column `first`; zeros at voids.
    pub(crate) fn row(&self, row: usize, first: usize, out: &mut Planes) {
        let (cols, rows, n) = (self.hf.cols(), self.hf.rows(), out.w.len());
        let inner = row > 0 && row + 1 < rows && self.bent.is_none();
        let columns = first.max(1)..(first + n).min(cols - 1);
        // Border nodes, nodes beside voids and bent ground are computed one by one.
        let solid = inner && !columns.is_empty() && self.is_solid(row, 1, columns.start - 1..columns.end + 1);
        let whole = if solid { columns.clone() } else { first..first };
        for c in (first..first + n).filter(|c| !whole.contains(c)) {
            let near = (inner && columns.contains(&c)).then(|| self.inner_node(c, row)).flatten();
            out.set(c - first, near.unwrap_or_else(|| self.node(c, row)));
        }
        if !whole.is_empty() {
            simd::run(Inside { hf: self.hf, heights: &self.heights, row, columns: whole, first, out });
        }
    }

    /// A node with four neighbours; `None` where one of them or it is void.
    fn inner_node(&self, c: usize, r: usize) -> Option<Vec4> {
        let (cols, states) = (self.hf.cols(), self.hf.states());
        let i = r * cols + c;
        let around = [i - 1, i, i + 1, i - cols, i + cols];
        if around.iter().any(|&n| states[n] == NodeState::Void) {
            return None;
        }
        let per = (0.5 / self.hf.spacing()).as_vec2();
        let [west, here, east, north, south] = around.map(|n| self.heights[n]);
        Some(Vec4::new((east - west) * per.x, (north - south) * per.y, here, 1.0))
    }

    /// One node of [`Surface::row`].
    fn node(&self, c: usize, r: usize) -> Vec4 {
        let i = r * self.hf.cols() + c;
        if self.hf.states()[i] == NodeState::Void {
            return Vec4::ZERO;
        }
        let slope = match &self.bent {
            Some(bent) => bent_slope(self.hf, c, r, bent.as_ref()).unwrap_or_else(|| self.slope(c, r)),
            None => self.slope(c, r),
        };
        Vec4::new(slope.x as f32, slope.y as f32, self.heights[i], 1.0)
    }

    /// Slope by central differences; one-sided beside holes and the border.
    fn slope(&self, c: usize, r: usize) -> DVec2 {
        let hf = self.hf;
        let here = self.heights[r * hf.cols() + c];
        let at = |c: usize, r: usize| {
            let i = r * hf.cols() + c;
            (hf.states()[i] != NodeState::Void).then(|| self.heights[i])
        };
        let along = |before: Option<f32>, after: Option<f32>, step: f64| {
            let span = f64::from(u8::from(before.is_some()) + u8::from(after.is_some())) * step;
            if span == 0.0 { 0.0 } else { f64::from(after.unwrap_or(here) - before.unwrap_or(here)) / span }
        };
        let west = c.checked_sub(1).and_then(|c| at(c, r));
        let east = (c + 1 < hf.cols()).then(|| at(c + 1, r)).flatten();
        let north = r.checked_sub(1).and_then(|r| at(c, r));
        let south = (r + 1 < hf.rows()).then(|| at(c, r + 1)).flatten();
        DVec2::new(along(west, east, hf.spacing().x), along(south, north, hf.spacing().y))
    }

    /// Mean of the `2^k x 2^k` nodes of each node of a row of level `k`, from column `first`; zeros where all are void.
    pub(crate) fn mean_row(&self, k: usize, row: usize, first: usize, out: &mut Planes) {
        if k == 0 {
            return self.row(row, first, out);
        }
        let (cols, rows, side, n) = (self.hf.cols(), self.hf.rows(), 1 << k, out.w.len());
        let (from, to) = ((first * side).saturating_sub(1), ((first + n) * side + 1).min(cols));
        // Border nodes, nodes beside voids and bent ground are computed one by one.
        let inner = row > 0
            && (row + 1) * side < rows
            && side <= CHUNK
            && self.bent.is_none()
            && self.is_solid(row, side, from..to);
        let end = first + n;
        let whole = if inner { first.max(1)..end.min((cols - 1) / side) } else { end..end };
        for ends in [first..whole.start.min(end), whole.end.max(first)..end] {
            if !ends.is_empty() {
                self.mean_of_each(k, row, ends.start, out, ends.start - first..ends.end - first);
            }
        }
        if !whole.is_empty() {
            simd::run(Inner { hf: self.hf, heights: &self.heights, side, row, columns: whole, first, out });
        }
    }

    /// Whether these columns have no void in the rows under a row of averages and in one more row on either side.
    fn is_solid(&self, row: usize, side: usize, columns: Range<usize>) -> bool {
        let (cols, rows) = (self.hf.cols(), self.hf.rows());
        self.hf.states().each().is_none_or(|states| {
            let rows = (row * side).saturating_sub(1)..((row + 1) * side + 1).min(rows);
            !rows.into_iter().any(|r| states[r * cols..][columns.clone()].contains(&NodeState::Void))
        })
    }

    /// [`Surface::mean_row`] of any nodes, from column `first`.
    /// * `places`: range of the results in `out`.
    fn mean_of_each(&self, k: usize, row: usize, first: usize, out: &mut Planes, places: Range<usize>) {
        let (cols, rows, side) = (self.hf.cols(), self.hf.rows(), 1 << k);
        let (from, to) = (first * side, ((first + places.len()) * side).min(cols));
        let mut fine = Planes::new(to.saturating_sub(from));
        let mut sums = vec![Vec4::ZERO; places.len()];
        for r in row * side..((row + 1) * side).min(rows) {
            self.row(r, from, &mut fine);
            for (i, sum) in sums.iter_mut().enumerate() {
                let part = i * side..((i + 1) * side).min(fine.w.len());
                *sum += part.map(|i| fine.get(i)).sum::<Vec4>();
            }
        }
        for (at, sum) in places.zip(sums) {
            out.set(at, if sum.w > 0.0 { sum / sum.w } else { Vec4::ZERO });
        }
    }
}

/// Slope of a displaced surface; `None` where the node itself cannot be displaced.
fn bent_slope(hf: &Heightfield, c: usize, r: usize, bent: &Moved<'_>) -> Option<DVec2> {
    let at = |c: usize, r: usize| hf.node(c, r).and_then(bent);
    let here = at(c, r)?;
    let difference = |before: Option<DVec3>, after: Option<DVec3>| after.unwrap_or(here) - before.unwrap_or(here);
    let east = difference(c.checked_sub(1).and_then(|c| at(c, r)), (c + 1 < hf.cols()).then(|| at(c + 1, r)).flatten());
    let north =
        difference((r + 1 < hf.rows()).then(|| at(c, r + 1)).flatten(), r.checked_sub(1).and_then(|r| at(c, r)));
    let n = east.cross(north);
    let n = if n.z < 0.0 { -n } else { n };
    // Walls steeper than about 87 degrees are shaded as if they had that slope.
    let z = n.z.max(0.05 * n.length());
    Some(if z > 0.0 { DVec2::new(-n.x / z, -n.y / z) } else { DVec2::ZERO })
}

/// Averages over `2^k x 2^k` nodes: dz/dx, dz/dy, height, and the weighted height of the wider surroundings (see
/// [`Openness::at`]).
#[derive(Debug)]
pub(crate) struct Level {
    pub(crate) cols: usize,
    pub(crate) rows: usize,
    nodes: Vec<Vec4>,
}

/// The averages of a ground, from level [`MipPyramid::first`] up.
#[derive(Debug)]
pub(crate) struct MipPyramid {
    pub(crate) first: usize,
    pub(crate) levels: Vec<Level>,
    spacing: f32,
}

/// The finest level of averages that is stored: 16 bytes a node of it, so less than the ground itself where that is huge.
pub(crate) fn first_level(nodes: usize) -> usize {
    if nodes <= SMALL_GROUND { 1 } else { (1..).find(|k| nodes >> (2 * k) <= MOST_NODES).unwrap_or(1) }
}

/// Bytes of the averages of a ground of `nodes` nodes.
pub(crate) fn means_bytes(nodes: u64) -> u64 {
    (nodes >> (2 * first_level(nodes as usize))) * size_of::<Vec4>() as u64 * 4 / 3
}

impl MipPyramid {
    /// Averages of the ground.
    pub(crate) fn new(surface: &Surface<'_>) -> Self {
        let hf = surface.hf;
        let first = first_level(hf.cols() * hf.rows());
        let [cols, rows] = [hf.cols(), hf.rows()].map(|n| n.div_ceil(1 << first));
        let mut nodes = vec![Vec4::ZERO; cols * rows];
        nodes.par_chunks_mut(cols).enumerate().for_each_init(
            || Planes::new(cols),
            |planes, (r, row)| {
                surface.mean_row(first, r, 0, planes);
                row.iter_mut().enumerate().for_each(|(i, node)| *node = planes.get(i));
            },
        );
        let mut levels = vec![Level { cols, rows, nodes }];
        while let Some(last) = levels.last()
            && last.cols.max(last.rows) > 1
        {
            levels.push(last.halved());
        }
        let mut out = Self { first, levels, spacing: hf.spacing().min_element() as f32 };
        out.fill_holes();
        out.set_surroundings();
        out
    }

    /// Number of the coarsest level.
    pub(crate) fn top(&self) -> usize {
        self.first + self.levels.len() - 1
    }

    /// Fills voids with the average around them, so that interpolation beside them uses no height of 0.
    fn fill_holes(&mut self) {
        for k in (0..self.levels.len() - 1).rev() {
            let (fine, coarse) = self.levels.split_at_mut(k + 1);
            let (to, from) = (&mut fine[k], &coarse[0]);
            let cols = to.cols;
            to.nodes.par_iter_mut().enumerate().filter(|(_, n)| n.w == 0.0).for_each(|(i, n)| {
                *n = from.nodes[i / cols / 2 * from.cols + i % cols / 2];
            });
        }
    }

    /// Stores the weighted mean heights of the surroundings, see [`Openness::at`].
    fn set_surroundings(&mut self) {
        let scales = SURROUNDINGS.map(|(level, share)| {
            let k = level.clamp(self.first, self.top());
            (k - self.first, share / (self.spacing * (1u32 << k) as f32))
        });
        let means = scales.map(|(k, _)| self.smooth_heights(k + self.first, self.first));
        for (i, n) in self.levels[0].nodes.iter_mut().enumerate() {
            n.w = scales.iter().zip(&means).map(|((_, per_m), m)| per_m * m[i]).sum();
        }
        for k in 1..self.levels.len() {
            let (fine, rest) = self.levels.split_at_mut(k);
            let (from, to) = (&fine[k - 1], &mut rest[0]);
            let cols = to.cols;
            to.nodes.par_iter_mut().enumerate().for_each(|(i, n)| n.w = from.mean_w(i % cols, i / cols));
        }
    }

    /// Heights of level `k` interpolated to a finer one, both stored, level by level, which smooths them.
    pub(crate) fn smooth_heights(&self, k: usize, finer: usize) -> Vec<f32> {
        let [k, finer] = [k - self.first, finer - self.first];
        let mut values: Vec<f32> = self.levels[k].nodes.iter().map(|n| n.z).collect();
        for level in (finer..k).rev() {
            let (from, to) = (&self.levels[level + 1], &self.levels[level]);
            let mut next = vec![0.0; to.cols * to.rows];
            next.par_chunks_mut(to.cols).enumerate().for_each(|(r, row)| {
                let (r0, r1, v) = tap(0.5 * (r as f32 - 0.5), from.rows);
                for (c, out) in row.iter_mut().enumerate() {
                    let (c0, c1, u) = tap(0.5 * (c as f32 - 0.5), from.cols);
                    let at = |c: usize, r: usize| values[r * from.cols + c];
                    let (n, s) =
                        (at(c0, r0) + u * (at(c1, r0) - at(c0, r0)), at(c0, r1) + u * (at(c1, r1) - at(c0, r1)));
                    *out = n + v * (s - n);
                }
            });
            values = next;
        }
        values
    }

    /// Averages of level `k` (stored) at fractional column and row of the ground.
    #[cfg(test)]
    pub(crate) fn at(&self, k: usize, col: f32, row: f32) -> Vec4 {
        let level = &self.levels[(k - self.first).min(self.levels.len() - 1)];
        // Node i of level k lies at (i + 0.5) 2^k - 0.5 of the ground.
        let step = 1.0 / (1u32 << k.min(self.top())) as f32;
        let (c0, c1, u) = tap((col + 0.5) * step - 0.5, level.cols);
        let (r0, r1, v) = tap((row + 0.5) * step - 0.5, level.rows);
        let (n, s) = (&level.nodes[r0 * level.cols..], &level.nodes[r1 * level.cols..]);
        let (a, b) = (n[c0] + u * (n[c1] - n[c0]), s[c0] + u * (s[c1] - s[c0]));
        a + v * (b - a)
    }

    /// A node of a stored level.
    pub(crate) fn node(&self, k: usize, col: usize, row: usize) -> Vec4 {
        let level = &self.levels[k - self.first];
        level.nodes[row * level.cols + col]
    }

    /// Nodes of a row of a stored level, from column `first`.
    pub(crate) fn row(&self, k: usize, row: usize, first: usize, out: &mut Planes) {
        let level = &self.levels[k - self.first];
        let nodes = &level.nodes[row * level.cols + first..][..out.w.len()];
        let [x, y, z, w] = out.part(0..nodes.len());
        for ((((node, x), y), z), w) in nodes.iter().zip(x).zip(y).zip(z).zip(w) {
            (*x, *y, *z, *w) = (node.x, node.y, node.z, node.w);
        }
    }

    /// Columns and rows of a level that is stored.
    pub(crate) fn size(&self, k: usize) -> [usize; 2] {
        let level = &self.levels[k - self.first];
        [level.cols, level.rows]
    }

    /// Weights of the openness of points, see [`Openness::at`].
    #[inline(always)]
    pub(crate) fn openness(&self) -> Openness {
        let per_m =
            |level: usize, share: f32| share / (self.spacing * (1u32 << level.clamp(self.first, self.top())) as f32);
        Openness {
            near: per_m(self.first, NEAR_SHARE),
            wide: SURROUNDINGS.iter().map(|&(level, share)| per_m(level, share)).sum(),
        }
    }
}

/// Weights of the surroundings of a point, per unit of height.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Openness {
    near: f32,
    wide: f32,
}

impl Openness {
    /// Share of the sky that is visible at a point, from its height over its surroundings at three scales: about 0.8..=1.2, 1 on level
    /// ground. Our approximation of sky visibility.
    /// * `near`, `asked`: height and weighted height of the wider surroundings, of the finest stored level there.
    #[inline(always)]
    pub(crate) fn at(self, height: f32, near: f32, asked: f32) -> f32 {
        let above = self.near * (height - near) + self.wide * height - asked;
        let x = above / 0.16;
        let x = x / (1.0 + x * x).sqrt();
        1.0 + 0.42 * if x < 0.45 { x } else { 0.45 }
    }
}

impl Level {
    fn halved(&self) -> Self {
        let (cols, rows) = (self.cols.div_ceil(2), self.rows.div_ceil(2));
        let mut nodes = vec![Vec4::ZERO; cols * rows];
        nodes.par_chunks_mut(cols).enumerate().for_each(|(r, row)| {
            for (c, n) in row.iter_mut().enumerate() {
                let solid = self.under(c, r).filter(|v| v.w > 0.0);
                let sum: Vec4 = solid.map(|v| v.with_w(1.0)).sum();
                *n = if sum.w > 0.0 { (sum / sum.w).with_w(1.0) } else { Vec4::ZERO };
            }
        });
        Self { cols, rows, nodes }
    }

    /// A row interpolated to given columns.
    pub(crate) fn between_columns(&self, row: usize, taps: &[(usize, usize, f32)], out: &mut Planes) {
        let nodes = &self.nodes[row * self.cols..][..self.cols];
        for (i, &(west, east, u)) in taps.iter().enumerate() {
            out.set(i, nodes[west] + u * (nodes[east] - nodes[west]));
        }
    }

    fn mean_w(&self, col: usize, row: usize) -> f32 {
        let (sum, n) = self.under(col, row).fold((0.0, 0.0), |(sum, n), v| (sum + v.w, n + 1.0));
        sum / n
    }

    /// The nodes that a node of the next level averages.
    fn under(&self, col: usize, row: usize) -> impl Iterator<Item = &Vec4> {
        let inside = move |i: usize, j: usize| 2 * col + i < self.cols && 2 * row + j < self.rows;
        [(0, 0), (1, 0), (0, 1), (1, 1)]
            .into_iter()
            .filter(move |&(i, j)| inside(i, j))
            .map(move |(i, j)| &self.nodes[(2 * row + j) * self.cols + 2 * col + i])
    }
}

#[inline]
pub(crate) fn tap(x: f32, n: usize) -> (usize, usize, f32) {
    let x = x.clamp(0.0, (n - 1) as f32);
    let i = x as usize;
    (i, (i + 1).min(n - 1), x - i as f32)
}

#[cfg(test)]
mod tests;
