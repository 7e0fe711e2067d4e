//! Nodes of a block of ground on the image, and drawing the cells between them.

use crate::raster::band::Band;
use crate::raster::cells::CellRow;
use crate::raster::cells::{NODES, SIDE};
use crate::screen::{SUB, ScreenVertex};
use crate::simd::{self, Kernel};
use belvedere_scene::CellTriangle;

/// The node numbers (bit 0 east, bit 1 south) of the two triangles of a cell.
pub(crate) const CELL_TRIANGLES: [[usize; 3]; 2] =
    [CellTriangle::NorthEast.corners(), CellTriangle::SouthWest.corners()];

/// Images of the nodes of a block, row by row, coordinate by coordinate.
#[derive(Debug, Default)]
pub(crate) struct Nodes {
    pub(crate) x: Vec<i32>,
    pub(crate) y: Vec<i32>,
    pub(crate) q: Vec<f32>,
    /// Extent of each row of nodes.
    spans: Vec<ScreenExtent>,
    /// Cells along both axes.
    cells: [usize; 2],
    /// Whether some nodes have no image.
    holes: bool,
}

/// Extent of a block at most: fixed-point positions and the largest nearness.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScreenExtent {
    pub(crate) x: [i32; 2],
    pub(crate) y: [i32; 2],
    pub(crate) q: f32,
}

impl ScreenExtent {
    pub(crate) const EMPTY: Self = Self { x: [i32::MAX, i32::MIN], y: [i32::MAX, i32::MIN], q: f32::NEG_INFINITY };

    pub(crate) fn including(self, v: ScreenVertex) -> Self {
        Self {
            x: [self.x[0].min(v.x), self.x[1].max(v.x)],
            y: [self.y[0].min(v.y), self.y[1].max(v.y)],
            q: if v.q > self.q { v.q } else { self.q },
        }
    }

    /// Extent of both together.
    #[inline(always)]
    fn with(self, other: Self) -> Self {
        Self {
            x: [self.x[0].min(other.x[0]), self.x[1].max(other.x[1])],
            y: [self.y[0].min(other.y[0]), self.y[1].max(other.y[1])],
            q: if other.q > self.q { other.q } else { self.q },
        }
    }
}

impl Nodes {
    /// Resizes to the nodes of `cells`; the old values are not kept.
    pub(crate) fn reset(&mut self, cells: [usize; 2]) {
        let n = (cells[0] + 1) * (cells[1] + 1);
        self.x.resize(n, 0);
        self.y.resize(n, 0);
        self.q.resize(n, 0.0);
        (self.cells, self.holes) = (cells, false);
    }

    pub(crate) fn at(&self, c: usize, r: usize) -> ScreenVertex {
        let i = r * (self.cells[0] + 1) + c;
        ScreenVertex { x: self.x[i], y: self.y[i], q: self.q[i] }
    }

    pub(crate) fn set(&mut self, c: usize, r: usize, v: ScreenVertex) {
        let i = r * (self.cells[0] + 1) + c;
        (self.x[i], self.y[i], self.q[i]) = (v.x, v.y, v.q);
        self.holes |= v.is_none();
    }

    /// Moves the odd nodes of a side onto the even ones before them, see [`crate::geometry::lod::Span::seam`].
    pub(crate) fn close_seams(&mut self, seam: [bool; 4]) {
        let [cols, rows] = self.cells;
        if seam == [false; 4] {
            return;
        }
        for r in 0..=rows {
            for c in 0..=cols {
                let [to_c, to_r] = kept_node(seam, self.cells, [c, r]);
                if [to_c, to_r] != [c, r] {
                    self.set(c, r, self.at(to_c, to_r));
                }
            }
        }
    }

    /// Extent of the nodes; to be called once all are set.
    pub(crate) fn cover(&mut self) -> ScreenExtent {
        self.spans.clear();
        if !self.holes {
            return simd::run(Around(self));
        }
        let mut all = ScreenExtent::EMPTY;
        for r in 0..=self.cells[1] {
            let on = (0..=self.cells[0]).map(|c| self.at(c, r)).filter(|v| !v.is_none());
            let row = on.fold(ScreenExtent::EMPTY, ScreenExtent::including);
            self.spans.push(row);
            all = all.with(row);
        }
        all
    }

    /// Draws the cells that touch the band, numbered from `first_prim`.
    pub(crate) fn draw(&self, first_prim: u32, band: &mut Band) {
        simd::run(Draw { nodes: self, first_prim, band });
    }

    /// Nodes of a row, filled up to `NODES` with arbitrary values.
    #[inline(always)]
    fn row<'n, T: Copy>(&self, values: &'n [T], r: usize, spare: &'n mut [T; NODES]) -> &'n [T; NODES] {
        let n = self.cells[0] + 1;
        let row = &values[r * n..(r + 1) * n];
        if let Ok(whole) = row.try_into() {
            return whole;
        }
        spare[..n].copy_from_slice(row);
        spare
    }

    /// A cell some of whose nodes may have no image.
    #[inline(never)]
    fn draw_torn(&self, [c, r]: [usize; 2], prim: u32, band: &mut Band) {
        let v: [ScreenVertex; 4] = std::array::from_fn(|k| self.at(c + (k & 1), r + (k >> 1)));
        for (k, t) in CELL_TRIANGLES.iter().enumerate() {
            let tri = t.map(|i| v[i]);
            if !tri.iter().any(|v| v.is_none()) {
                band.draw(tri, prim | k as u32);
            }
        }
    }
}

/// Computes the extent of nodes without holes.
struct Around<'a>(&'a mut Nodes);

impl Kernel for Around<'_> {
    type Output = ScreenExtent;

    #[inline(always)]
    fn run(self) -> ScreenExtent {
        let Nodes { x, y, q, spans, cells, .. } = self.0;
        let stride = cells[0] + 1;
        let mut all = ScreenExtent::EMPTY;
        for ((x, y), q) in x.chunks(stride).zip(y.chunks(stride)).zip(q.chunks(stride)) {
            let row = ScreenExtent { x: range(x), y: range(y), q: largest(q) };
            spans.push(row);
            all = all.with(row);
        }
        all
    }
}

#[inline(always)]
fn range(values: &[i32]) -> [i32; 2] {
    let mut out = [i32::MAX, i32::MIN];
    for v in values {
        out = [out[0].min(*v), out[1].max(*v)];
    }
    out
}

#[inline(always)]
fn largest(values: &[f32]) -> f32 {
    // Lane by lane, since the compiler may not reorder comparisons.
    const LANES: usize = 16;
    let mut lanes = [f32::NEG_INFINITY; LANES];
    for part in values.chunks(LANES) {
        for (most, v) in lanes.iter_mut().zip(part) {
            *most = if *v > *most { *v } else { *most };
        }
    }
    let mut out = f32::NEG_INFINITY;
    for v in lanes {
        out = if v > out { v } else { out };
    }
    out
}

struct Draw<'d> {
    nodes: &'d Nodes,
    first_prim: u32,
    band: &'d mut Band,
}

impl Kernel for Draw<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { nodes, first_prim, band } = self;
        let [cols, rows] = nodes.cells;
        let (top, bottom, right) = (band.y0 * SUB, band.y1 * SUB, band.width * SUB);
        for r in 0..rows {
            let ScreenExtent { x, y, q } = nodes.spans[r].with(nodes.spans[r + 1]);
            if y[0] >= bottom || y[1] < top || x[0] >= right || x[1] < 0 || band.hides(x, q) {
                continue;
            }
            let prim = first_prim | ((r * SIDE) as u32) << 1;
            if nodes.holes {
                (0..cols).for_each(|c| nodes.draw_torn([c, r], prim | (c as u32) << 1, band));
                continue;
            }
            let [xs, ys] = &mut [[[0; NODES]; 2]; 2];
            let [[xn, xs], [yn, ys]] = [xs, ys].map(|[n, s]| [n, s]);
            let [qn, qs] = &mut [[0.0; NODES]; 2];
            let row = CellRow {
                cells: cols,
                x: [nodes.row(&nodes.x, r, xn), nodes.row(&nodes.x, r + 1, xs)],
                y: [nodes.row(&nodes.y, r, yn), nodes.row(&nodes.y, r + 1, ys)],
                q: [nodes.row(&nodes.q, r, qn), nodes.row(&nodes.q, r + 1, qs)],
            };
            band.draw_cells(&row, prim);
        }
    }
}

/// The node drawn in place of node (c, r) of a block with seams: itself, or the even one before it on a seam.
pub(crate) fn kept_node(seam: [bool; 4], cells: [usize; 2], [c, r]: [usize; 2]) -> [usize; 2] {
    let [north, east, south, west] = seam;
    if (north && r == 0) || (south && r == cells[1]) {
        [c & !1, r]
    } else if (west && c == 0) || (east && c == cells[0]) {
        [c, r & !1]
    } else {
        [c, r]
    }
}

/// Weights of vertices 1 and 2 of triangle `k` of cell (c, r), for its vertices where they are drawn. On a seam they may lie
/// beside the cell, on the plane of the triangle.
pub(crate) fn cell_weights(seam: [bool; 4], cells: [usize; 2], [c, r]: [usize; 2], k: usize) -> [[f32; 2]; 3] {
    CELL_TRIANGLES[k].map(|n| {
        let at = kept_node(seam, cells, [c + (n & 1), r + (n >> 1)]);
        let (u, v) = (at[0] as f32 - c as f32, at[1] as f32 - r as f32);
        if k == 0 { [u - v, v] } else { [v - u, u] }
    })
}

#[cfg(test)]
mod tests;
