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
mod tests {
    use super::*;
    use crate::raster::band::{SKY, sample_offsets};

    /// Images of nodes (c, r) every `pitch` fixed-point steps, inner ones shaken by up to a quarter of that.
    fn image([c, r]: [usize; 2], pitch: i32) -> ScreenVertex {
        let mix = |k: u64| {
            let x = (c as u64 * 7919 + r as u64 * 104_729 + k).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            ((x >> 40) as i32 % (pitch / 4 + 1)) - pitch / 8
        };
        let inner = c > 0 && r > 0 && c < 64 && r < 32;
        let shake = |k: u64| if inner { mix(k) } else { 0 };
        let q = 1.0 + 0.001 * mix(3) as f32 / pitch as f32;
        ScreenVertex { x: c as i32 * pitch + shake(1) - 300, y: r as i32 * pitch + shake(2) - 300, q }
    }

    /// A block of full detail beside one of half the detail: 64 x 32 cells together.
    fn sheet(pitch: i32, fine_first: bool) -> [Nodes; 2] {
        let block = |from: usize, step: usize, seam: [bool; 4]| {
            let cells = [32 / step, 32 / step];
            let mut nodes = Nodes::default();
            nodes.reset(cells);
            for r in 0..=cells[1] {
                for c in 0..=cells[0] {
                    nodes.set(c, r, image([from + step * c, step * r], pitch));
                }
            }
            nodes.close_seams(seam);
            nodes.cover();
            nodes
        };
        let fine = block(if fine_first { 0 } else { 32 }, 1, [false, fine_first, false, !fine_first]);
        [fine, block(if fine_first { 32 } else { 0 }, 2, [false; 4])]
    }

    const PITCHES: [i32; 8] = [37, 64, 128, 200, 256, 700, 1600, 3000];

    #[test]
    fn sheets_of_different_detail_cover_every_sample_once() {
        for (pitch, fine_first, samples) in
            PITCHES.into_iter().flat_map(|p| [(p, true, 1), (p, false, 1), (p, true, 4), (p, false, 16)])
        {
            let size = [(64 * pitch - 300) / SUB + 2, (32 * pitch - 300) / SUB + 2];
            let mut band = Band::new(0, size[1], size[0], sample_offsets(samples));
            for (i, nodes) in sheet(pitch, fine_first).iter().enumerate() {
                nodes.draw((i as u32) << 11, &mut band);
            }
            for (s, [ox, oy]) in band.offsets.iter().enumerate() {
                for (x, y) in (0..size[0]).flat_map(|x| (0..size[1]).map(move |y| (x, y))) {
                    let inside = x * SUB + ox < 64 * pitch - 300 && y * SUB + oy < 32 * pitch - 300;
                    let hits = band.hits[band.index(s, x, y)];
                    assert_eq!(hits, u32::from(inside), "pitch {pitch}, {fine_first}: ({x}, {y}) sample {s}");
                }
            }
        }
    }

    #[test]
    fn bands_of_any_height_and_blocks_in_any_order_give_the_same_samples() {
        for (pitch, samples) in PITCHES.into_iter().flat_map(|p| [(p, 1), (p, 4)]) {
            let (width, height) = ((64 * pitch - 300) / SUB + 2, (32 * pitch - 300) / SUB + 2);
            // Two sheets through each other.
            let sheets = [sheet(pitch, true), sheet(pitch, false)];
            let draw = |y0: i32, y1: i32, reverse: bool| {
                let mut band = Band::new(y0, y1, width, sample_offsets(samples));
                let all: Vec<(usize, &Nodes)> = sheets.iter().flatten().enumerate().collect();
                let order: Vec<_> = if reverse { all.into_iter().rev().collect() } else { all };
                order.into_iter().for_each(|(i, nodes)| nodes.draw((i as u32) << 11, &mut band));
                band
            };
            let whole = draw(0, height, false);
            for rows in [1, 5, 16] {
                for y0 in (0..height).step_by(rows as usize) {
                    let band = draw(y0, (y0 + rows).min(height), true);
                    for s in 0..band.offsets.len() {
                        for (x, y) in (0..width).flat_map(|x| (band.y0..band.y1).map(move |y| (x, y))) {
                            let (a, b) = (whole.index(s, x, y), band.index(s, x, y));
                            assert_eq!((whole.q[a].to_bits(), whole.prim[a]), (band.q[b].to_bits(), band.prim[b]));
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn rows_behind_what_was_drawn_are_left_out_and_no_other() {
        // A level block, and one behind it from which some rows and single nodes stand out.
        let block = |q: &dyn Fn(usize, usize) -> f32| {
            let mut nodes = Nodes::default();
            nodes.reset([32, 32]);
            for (c, r) in (0..33).flat_map(|c| (0..33).map(move |r| (c, r))) {
                nodes.set(c, r, ScreenVertex { x: c as i32 * 300 - 400, y: r as i32 * 300 - 400, q: q(c, r) });
            }
            let cover = nodes.cover();
            (nodes, cover)
        };
        let rough = |c: usize, r: usize| if (7 * c + 11 * r) % 97 == 5 { 1.3 } else { 0.75 + 0.01 * r as f32 };
        let blocks = [block(&|_, _| 1.0), block(&rough)];
        let draw = |order: [usize; 2]| {
            let mut band = Band::new(0, 16, 32, sample_offsets(4));
            for i in order {
                blocks[i].0.draw((i as u32) << 11, &mut band);
                band.drew(blocks[i].1.x);
            }
            band
        };
        let (hiding, whole) = (draw([0, 1]), draw([1, 0]));
        assert!(hiding.q == whole.q && hiding.prim == whole.prim, "the same samples");
        let drawn = |band: &Band| band.hits.iter().sum::<u32>();
        assert!(drawn(&hiding) < drawn(&whole), "some rows were left out");
        assert!(hiding.prim.iter().any(|p| *p != SKY && p >> 11 == 1), "some stand out");
    }

    #[test]
    fn all_versions_draw_the_same_bits() {
        for (pitch, samples) in PITCHES.into_iter().flat_map(|p| [(p, 1), (p, 4)]) {
            let (width, height) = ((64 * pitch - 300) / SUB + 2, (32 * pitch - 300) / SUB + 2);
            let draw = |plain: bool| {
                let mut band = Band::new(0, height, width, sample_offsets(samples));
                for (i, nodes) in sheet(pitch, true).iter().enumerate() {
                    let draw = Draw { nodes, first_prim: (i as u32) << 11, band: &mut band };
                    if plain { draw.run() } else { simd::run(draw) }
                }
                (band.q.iter().map(|q| q.to_bits()).collect::<Vec<_>>(), band.prim)
            };
            assert!(draw(true) == draw(false), "pitch {pitch}");
        }
    }
}
