//! Cells of about a pixel, judged many at a time.

use crate::lens::SUB;
use crate::raster::owns_edge;

/// Entries judged together.
const N: usize = 32;

/// Pairs of a cell and a sample in its bounding box. Corners (bit 0 east, bit 1 south) are taken relative to the sample;
/// in a box of two pixels their products are whole numbers below 2^24, so single precision decides exactly.
#[derive(Debug)]
pub(crate) struct Cells {
    pub(crate) len: usize,
    x: [[f32; N]; 4],
    y: [[f32; N]; 4],
    q: [[f32; N]; 4],
    /// Index of the sample in its band.
    pub(crate) at: [u32; N],
    pub(crate) prim: [u32; N],
    /// Triangles that the sample lies in, after [`Cells::judge`].
    pub(crate) code: [u32; N],
    /// Nearness of the sample in the two triangles.
    pub(crate) upper: [f32; N],
    pub(crate) lower: [f32; N],
}

impl Default for Cells {
    fn default() -> Self {
        let corners = [[0.0; N]; 4];
        Self {
            len: 0,
            x: corners,
            y: corners,
            q: corners,
            at: [0; N],
            prim: [0; N],
            code: [0; N],
            upper: [0.0; N],
            lower: [0.0; N],
        }
    }
}

impl Cells {
    /// North-west, north-east, south-east.
    pub(crate) const UPPER: u32 = 1;
    /// North-west, south-west, south-east.
    pub(crate) const LOWER: u32 = 2;
    /// On the line through two corners: the rule for edges decides.
    const EDGE: u32 = 4;

    /// Adds a sample and its cell; `true` once full.
    #[inline]
    pub(crate) fn push(&mut self, s: [i32; 2], x: [i32; 4], y: [i32; 4], q: [f32; 4], at: usize, prim: u32) -> bool {
        let i = self.len & (N - 1);
        for k in 0..4 {
            self.x[k][i] = (x[k] - s[0]) as f32;
            self.y[k][i] = (y[k] - s[1]) as f32;
            self.q[k][i] = q[k];
        }
        self.at[i] = at as u32;
        self.prim[i] = prim;
        self.len = i + 1;
        self.len == N
    }

    /// Finds the triangles that each sample lies in, and its nearness there.
    pub(crate) fn judge(&mut self) {
        self.judge_all();
        for i in 0..self.len {
            if self.code[i] & Self::EDGE != 0 {
                let corner = |k: usize| [self.x[k][i] as i32, self.y[k][i] as i32];
                let [nw, ne, sw, se] = [0, 1, 2, 3].map(corner);
                self.code[i] =
                    u32::from(holds_origin([nw, ne, se])) | (u32::from(holds_origin([nw, sw, se])) * Self::LOWER);
            }
        }
    }

    #[inline(never)]
    fn judge_all(&mut self) {
        let Self { x, y, q, code, upper, lower, .. } = self;
        for i in 0..N {
            let cross = |p: usize, r: usize| x[p][i] * y[r][i] - y[p][i] * x[r][i];
            let (north, east, diagonal) = (cross(0, 1), cross(1, 3), cross(3, 0));
            let (west, south) = (cross(0, 2), cross(2, 3));
            let all =
                |a: f32, b: f32, c: f32| ((a > 0.0) & (b > 0.0) & (c > 0.0)) | ((a < 0.0) & (b < 0.0) & (c < 0.0));
            let edge = (north == 0.0) | (east == 0.0) | (diagonal == 0.0) | (west == 0.0) | (south == 0.0);
            code[i] = (u32::from(all(north, east, diagonal)) * Self::UPPER)
                | (u32::from(all(west, south, diagonal)) * Self::LOWER)
                | (u32::from(edge) * Self::EDGE);
            // Each corner weighs with the edge function of the edge opposite.
            upper[i] = mean([east, diagonal, north], [q[0][i], q[1][i], q[3][i]]);
            lower[i] = mean([south, diagonal, west], [q[0][i], q[2][i], q[3][i]]);
        }
    }
}

/// Weighted mean, not beyond its values.
#[inline]
fn mean(w: [f32; 3], q: [f32; 3]) -> f32 {
    let least = |a: f32, b: f32| if a < b { a } else { b };
    let most = |a: f32, b: f32| if a > b { a } else { b };
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

const _: () = assert!(2 * SUB as i64 * 2 * SUB as i64 * 4 < 1 << 24, "products fit the mantissa of f32");
