//! Rasterises rows of small cells of the ground, all cells of a row at once.

use crate::raster::band::Band;
use crate::raster::triangle::owns_edge;
use crate::screen::{SUB, ScreenVertex};

/// Drawn cells along a side of a block of ground, at every level.
pub(crate) const SIDE: usize = 32;
/// Nodes along a side of a block at most.
pub(crate) const NODES: usize = SIDE + 1;

/// Cells with bounding boxes below this, about eight pixels, are drawn together. Differences of their corners have products whose
/// differences stay below 2^24, so single precision decides exactly.
const TINY: i32 = 8 * SUB;
const _: () = assert!(SIDE == u32::BITS as usize, "a bit per cell of a row");
const _: () = assert!(TINY as i64 * TINY as i64 * 2 < 1 << 24, "differences of products fit the mantissa of f32");

/// The sample lies in the half of the cell with the north-east node.
const UPPER: u32 = 1;
/// The sample lies in the half with the south-west node.
const LOWER: u32 = 2;
/// The sample lies on the border of a half: the top-left rule decides.
const EDGE: u32 = 4;

type Whole = [i32; SIDE];
type Lanes = [f32; SIDE];

/// Nodes north and south of a row of cells; values past the last cell are arbitrary.
pub(crate) struct CellRow<'n> {
    pub(crate) cells: usize,
    pub(crate) x: [&'n [i32; NODES]; 2],
    pub(crate) y: [&'n [i32; NODES]; 2],
    pub(crate) q: [&'n [f32; NODES]; 2],
}

impl CellRow<'_> {
    /// Node `k` of a cell (bit 0 east, bit 1 south).
    #[inline(always)]
    fn node(&self, c: usize, k: usize) -> ScreenVertex {
        let (row, c) = (k >> 1, c + (k & 1));
        ScreenVertex { x: self.x[row][c], y: self.y[row][c], q: self.q[row][c] }
    }
}

/// Bounding boxes of the cells of a row.
struct Boxes {
    x: [Whole; 2],
    y: [Whole; 2],
}

/// Corners of the cells of a row, computed once for all samples.
struct Corners {
    /// Offsets from the first corner of the box: north-west, north-east, south-west, south-east.
    x: [Lanes; 4],
    y: [Lanes; 4],
}

/// Result of testing one sample per cell.
struct Judged {
    code: [u32; SIDE],
    /// Index of the sample in its band.
    at: [u32; SIDE],
    /// Nearness at the sample, of the lower half if only that half holds it.
    q: Lanes,
}

/// One sample per cell: of one kind, at a pixel offset from the first one in each cell's box.
#[derive(Clone, Copy)]
struct SampleGrid {
    kind: usize,
    offset: [i32; 2],
    from_first: [i32; 2],
}

impl SampleGrid {
    /// Pixel of the sample along an axis, in a box that begins at `from`.
    #[inline(always)]
    fn pixel(self, axis: usize, from: i32) -> i32 {
        ((from - self.offset[axis] + SUB - 1) >> 8) + self.from_first[axis]
    }
}

impl Boxes {
    #[inline(always)]
    fn of(row: &CellRow<'_>) -> Self {
        Self { x: Self::ranges(row.x), y: Self::ranges(row.y) }
    }

    #[inline(always)]
    fn ranges([n, s]: [&[i32; NODES]; 2]) -> [Whole; 2] {
        let (mut lo, mut hi) = ([0; SIDE], [0; SIDE]);
        for c in 0..SIDE {
            lo[c] = least(least(n[c], n[c + 1]), least(s[c], s[c + 1]));
            hi[c] = most(most(n[c], n[c + 1]), most(s[c], s[c + 1]));
        }
        [lo, hi]
    }
}

impl Corners {
    #[inline(always)]
    fn of(row: &CellRow<'_>, boxes: &Boxes) -> Self {
        let mut out = Self { x: [[0.0; SIDE]; 4], y: [[0.0; SIDE]; 4] };
        for k in 0..4 {
            for c in 0..SIDE {
                out.x[k][c] = (row.x[k >> 1][c + (k & 1)] - boxes.x[0][c]) as f32;
                out.y[k][c] = (row.y[k >> 1][c + (k & 1)] - boxes.y[0][c]) as f32;
            }
        }
        out
    }
}

#[inline(always)]
fn least<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

#[inline(always)]
fn most<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

impl Band {
    /// Draws a row of cells: the halves of cell `c` are numbered `prim + 2 c` and the next.
    #[inline(always)]
    pub(crate) fn draw_cells(&mut self, row: &CellRow<'_>, prim: u32) {
        let boxes = Boxes::of(row);
        let [x, y] = [&boxes.x, &boxes.y];
        // No overflow: vertices are clipped to the guard planes.
        let (mut tiny, mut large) = ([0i32; SIDE], [0i32; SIDE]);
        let (mut wide, mut high, mut any) = (0, 0, [0, 0]);
        for c in 0..SIDE {
            let seen = !self.misses([x[0][c], x[1][c]], [y[0][c], y[1][c]]) & (c < row.cells);
            let (w, h) = (x[1][c] - x[0][c], y[1][c] - y[0][c]);
            let small = (w < TINY) & (h < TINY);
            tiny[c] = if seen & small { -1 } else { 0 };
            large[c] = if seen & !small { -1 } else { 0 };
            any = [any[0] | tiny[c], any[1] | large[c]];
            wide = most(wide, w & tiny[c]);
            high = most(high, h & tiny[c]);
        }
        if any[1] != 0 {
            self.draw_large_cells(row, &large, prim);
        }
        if any[0] == 0 {
            return;
        }
        let corners = Corners::of(row, &boxes);
        for kind in 0..self.offsets.len() {
            let offset = self.offsets[kind];
            for i in 0..=(high >> 8) {
                for j in 0..=(wide >> 8) {
                    self.draw_tiny(
                        row,
                        (&boxes, &corners),
                        &tiny,
                        SampleGrid { kind, offset, from_first: [j, i] },
                        prim,
                    );
                }
            }
        }
    }

    #[inline(always)]
    fn draw_large_cells(&mut self, row: &CellRow<'_>, large: &Whole, prim: u32) {
        for c in (0..row.cells).filter(|c| large[*c] != 0) {
            let [nw, ne, sw, se] = [0, 1, 2, 3].map(|k| row.node(c, k));
            let prim = prim | (c as u32) << 1;
            self.draw([nw, ne, se], prim);
            self.draw([nw, sw, se], prim | 1);
        }
    }

    /// Tests one sample per cell and draws those that a cell holds.
    #[inline(always)]
    fn draw_tiny(
        &mut self,
        row: &CellRow<'_>,
        (boxes, corners): (&Boxes, &Corners),
        tiny: &Whole,
        grid: SampleGrid,
        prim: u32,
    ) {
        let judged = self.judge(row, (boxes, corners), tiny, grid);
        // Collects the samples held as bits without branches, which no processor could predict.
        let mut seen = 0u32;
        for c in 0..SIDE {
            seen |= if judged.code[c] != 0 { 1 << c } else { 0 };
        }
        while seen != 0 {
            let c = seen.trailing_zeros() as usize;
            seen &= seen - 1;
            let (code, at, prim) = (judged.code[c], judged.at[c] as usize, prim | (c as u32) << 1);
            if code == UPPER || code == LOWER {
                self.write(at, judged.q[c], prim | (code >> 1));
            } else {
                self.write_carefully(row, boxes, grid, c, (at, code, prim));
            }
        }
    }

    /// Finds the halves that hold each sample, and the nearness there.
    #[inline(always)]
    fn judge(&self, row: &CellRow<'_>, (boxes, corners): (&Boxes, &Corners), tiny: &Whole, grid: SampleGrid) -> Judged {
        let mut out = Judged { code: [0; SIDE], at: [0; SIDE], q: [0.0; SIDE] };
        let first = self.index(grid.kind, 0, self.y0) as i32;
        let (stride, [y0, y1], width) = (self.stride as i32, [self.y0, self.y1], self.width);
        let (Corners { x: [xa, xb, xc, xd], y: [ya, yb, yc, yd] }, [qn, qs]) = (corners, row.q);
        for c in 0..SIDE {
            let from = [boxes.x[0][c], boxes.y[0][c]];
            let (px, py) = (grid.pixel(0, from[0]), grid.pixel(1, from[1]));
            let (sx, sy) = (px * SUB + grid.offset[0], py * SUB + grid.offset[1]);
            let inside = (sx <= boxes.x[1][c]) & (sy <= boxes.y[1][c]);
            let on_band = (px >= 0) & (px < width) & (py >= y0) & (py < y1) & (tiny[c] != 0);
            let (tx, ty) = ((sx - from[0]) as f32, (sy - from[1]) as f32);
            // No closures here: they would be compiled separately, for the oldest processors.
            let edges = edges(
                [xa[c] - tx, xb[c] - tx, xc[c] - tx, xd[c] - tx],
                [ya[c] - ty, yb[c] - ty, yc[c] - ty, yd[c] - ty],
            );
            let [north, east, diagonal, west, south] = edges;
            let lo = [least(least(north, east), diagonal), least(least(west, south), diagonal)];
            let hi = [most(most(north, east), diagonal), most(most(west, south), diagonal)];
            let (upper, lower) = ((lo[0] > 0.0) | (hi[0] < 0.0), (lo[1] > 0.0) | (hi[1] < 0.0));
            let edge = (lo[0] == 0.0) | (hi[0] == 0.0) | (lo[1] == 0.0) | (hi[1] == 0.0);
            let code = (u32::from(upper) * UPPER) | (u32::from(lower) * LOWER) | (u32::from(edge) * EDGE);
            out.code[c] = if inside & on_band { code } else { 0 };
            out.at[c] = (first + (py - y0) * stride + px) as u32;
            let between = if upper { qn[c + 1] } else { qs[c] };
            let (first, second) = (if upper { east } else { south }, if upper { north } else { west });
            out.q[c] = mean([first, diagonal, second], [qn[c], between, qs[c + 1]]);
        }
        out
    }

    /// Writes samples on the border of a half, by the top-left rule, and those in both halves of a folded cell.
    #[cold]
    #[inline(never)]
    fn write_carefully(
        &mut self,
        row: &CellRow<'_>,
        boxes: &Boxes,
        grid: SampleGrid,
        c: usize,
        (at, code, prim): (usize, u32, u32),
    ) {
        let from = [boxes.x[0][c], boxes.y[0][c]];
        let s = [0, 1].map(|axis| grid.pixel(axis, from[axis]) * SUB + grid.offset[axis]);
        let nodes = [0, 1, 2, 3].map(|k| row.node(c, k));
        let [nw, ne, sw, se] = nodes.map(|v| [v.x - s[0], v.y - s[1]]);
        let held = [[nw, ne, se], [nw, sw, se]].map(holds_origin);
        let [upper, lower] = if code & EDGE != 0 { held } else { [true; 2] };
        let [x, y] = [0, 1].map(|axis| [nw, ne, sw, se].map(|p| p[axis] as f32));
        let ([north, east, diagonal, west, south], q) = (edges(x, y), nodes.map(|v| v.q));
        if upper {
            self.write(at, mean([east, diagonal, north], [q[0], q[1], q[3]]), prim);
        }
        if lower {
            self.write(at, mean([south, diagonal, west], [q[0], q[2], q[3]]), prim | 1);
        }
    }
}

/// Edge functions of a cell's north, east, diagonal, west and south side at the origin.
#[inline(always)]
fn edges(x: [f32; 4], y: [f32; 4]) -> [f32; 5] {
    let cross = |p: usize, r: usize| x[p] * y[r] - y[p] * x[r];
    [cross(0, 1), cross(1, 3), cross(3, 0), cross(0, 2), cross(2, 3)]
}

/// Weighted mean, clamped to the range of its values. The weight of a corner is the edge function of the opposite edge.
#[inline(always)]
fn mean(w: [f32; 3], q: [f32; 3]) -> f32 {
    let m = (w[0] * q[0] + w[1] * q[1] + w[2] * q[2]) / (w[0] + w[1] + w[2]);
    most(least(m, most(most(q[0], q[1]), q[2])), least(least(q[0], q[1]), q[2]))
}

/// Whether the triangle holds the sample at the origin, by the top-left rule.
fn holds_origin([a, b, c]: [[i32; 2]; 3]) -> bool {
    let cross = |p: [i32; 2], r: [i32; 2]| p[0] * r[1] - p[1] * r[0];
    let area = cross(a, b) + cross(b, c) + cross(c, a);
    let v = if area < 0 { [a, c, b] } else { [a, b, c] };
    area != 0
        && (0..3).all(|i| {
            let (p, r) = (v[i], v[(i + 1) % 3]);
            let owns = owns_edge(i64::from(r[0] - p[0]), i64::from(r[1] - p[1]));
            cross(p, r) >= i32::from(!owns)
        })
}
