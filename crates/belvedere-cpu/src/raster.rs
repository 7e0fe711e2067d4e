//! Watertight rasterisation of triangles into a band of image rows.

use crate::lens::{SUB, ScreenVertex};

/// No surface.
pub(crate) const SKY: u32 = u32::MAX;

/// Sample positions inside a pixel, in 1/256 pixel. The first is the centre; the rest carry colour coverage.
pub(crate) fn sample_offsets(samples: u32) -> Vec<[i32; 2]> {
    let centre = [SUB / 2, SUB / 2];
    // Rotated grids: no two samples share a row or a column. Steps of 1/16 pixel from the centre.
    let pattern: &[[i32; 2]] = match samples {
        4 => &[[-2, -6], [6, -2], [-6, 2], [2, 6]],
        16 => &[
            [1, 1],
            [-1, -3],
            [-3, 2],
            [4, -1],
            [-5, -2],
            [2, 5],
            [5, 3],
            [3, -5],
            [-2, 6],
            [0, -7],
            [-4, -6],
            [-6, 4],
            [-8, 0],
            [7, -4],
            [6, 7],
            [-7, -8],
        ],
        _ => &[],
    };
    let step = SUB / 16;
    std::iter::once(centre).chain(pattern.iter().map(|[x, y]| [centre[0] + step * x, centre[1] + step * y])).collect()
}

/// Nearness and primitive of every sample of the rows `y0..y1`.
pub(crate) struct Band {
    pub(crate) y0: i32,
    pub(crate) y1: i32,
    pub(crate) width: i32,
    pub(crate) offsets: Vec<[i32; 2]>,
    /// Smallest and largest offset along x and y.
    reach: [[i32; 2]; 2],
    /// Larger = nearer, planes by sample.
    pub(crate) q: Vec<f32>,
    pub(crate) prim: Vec<u32>,
    /// Fragments written, for tests of coverage.
    #[cfg(test)]
    pub(crate) hits: Vec<u32>,
}

impl Band {
    pub(crate) fn new(y0: i32, y1: i32, width: i32, offsets: Vec<[i32; 2]>) -> Self {
        let n = offsets.len() * (y1 - y0).max(0) as usize * width.max(0) as usize;
        let reach = [0, 1].map(|axis| {
            let along = offsets.iter().map(|o: &[i32; 2]| o[axis]);
            [along.clone().min().unwrap_or(0), along.max().unwrap_or(0)]
        });
        Self {
            y0,
            y1,
            width,
            offsets,
            reach,
            q: vec![f32::NEG_INFINITY; n],
            prim: vec![SKY; n],
            #[cfg(test)]
            hits: vec![0; n],
        }
    }

    /// Index of a sample.
    #[inline]
    pub(crate) fn index(&self, sample: usize, x: i32, y: i32) -> usize {
        let rows = (self.y1 - self.y0) as usize;
        (sample * rows + (y - self.y0) as usize) * self.width as usize + x as usize
    }

    /// Whether no sample of the band lies in a box of fixed-point positions: most cells far away.
    #[inline]
    pub(crate) fn misses(&self, x: [i32; 2], y: [i32; 2]) -> bool {
        let [[left, right], [top, bottom]] = self.reach;
        let (xa, xb) = ((x[0] - right + SUB - 1) >> 8, (x[1] - left) >> 8);
        let (ya, yb) = ((y[0] - bottom + SUB - 1) >> 8, (y[1] - top) >> 8);
        (xa > xb) | (ya > yb) | (xb < 0) | (xa >= self.width) | (yb < self.y0) | (ya >= self.y1)
    }

    /// Draws a triangle, either orientation. Of two surfaces equally near the one drawn first stays.
    #[inline]
    pub(crate) fn draw(&mut self, tri: [ScreenVertex; 3], prim: u32) {
        let [a, b, c] = tri;
        let x = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
        let y = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
        if self.misses(x, y) {
            return;
        }
        // No overflow: vertices are clipped to the guard planes.
        if x[1] - x[0] < SMALL && y[1] - y[0] < SMALL {
            self.draw_small(tri, x, y, prim);
        } else {
            self.draw_large(tri, x, y, prim);
        }
    }

    /// First and last pixel whose sample lies in a triangle's bounding box.
    #[inline]
    fn pixels(&self, [ox, oy]: [i32; 2], x: [i32; 2], y: [i32; 2]) -> [i32; 4] {
        [
            ((x[0] - ox + SUB - 1) >> 8).max(0),
            ((x[1] - ox) >> 8).min(self.width - 1),
            ((y[0] - oy + SUB - 1) >> 8).max(self.y0),
            ((y[1] - oy) >> 8).min(self.y1 - 1),
        ]
    }

    /// A triangle of a few pixels: 32-bit edge functions, the plane of nearness only once a sample is hit.
    #[inline]
    fn draw_small(&mut self, [a, b, c]: [ScreenVertex; 3], x: [i32; 2], y: [i32; 2], prim: u32) {
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if area == 0 {
            return;
        }
        let v = if area < 0 { [a, c, b] } else { [a, b, c] };
        let edge = |i: usize, xs: i32, ys: i32| {
            let (p, r) = (v[i], v[(i + 1) % 3]);
            let (dx, dy) = (r.x - p.x, r.y - p.y);
            dx * (ys - p.y) - dy * (xs - p.x) - i32::from(!owns_edge(i64::from(dx), i64::from(dy)))
        };
        let mut plane: Option<Plane> = None;
        for s in 0..self.offsets.len() {
            let [ox, oy] = self.offsets[s];
            let [xa, xb, ya, yb] = self.pixels([ox, oy], x, y);
            for py in ya..=yb {
                for px in xa..=xb {
                    let (xs, ys) = (px * SUB + ox, py * SUB + oy);
                    if (edge(0, xs, ys) | edge(1, xs, ys) | edge(2, xs, ys)) < 0 {
                        continue;
                    }
                    let plane = plane.get_or_insert_with(|| Plane::new(v, area.unsigned_abs().into()));
                    let q = plane.at(xs, ys);
                    self.write(self.index(s, px, py), plane.clamp(q), prim);
                }
            }
        }
    }

    fn draw_large(&mut self, [a, b, c]: [ScreenVertex; 3], x: [i32; 2], y: [i32; 2], prim: u32) {
        let Some(t) = Setup::new(a, b, c) else { return };
        for s in 0..self.offsets.len() {
            let [ox, oy] = self.offsets[s];
            let [xa, xb, ya, yb] = self.pixels([ox, oy], x, y);
            if xa > xb {
                continue;
            }
            for y in ya..=yb {
                let ys = y * SUB + oy;
                let (x0, x1) = t.span(ys, ox, xa, xb);
                let first = self.index(s, x0, y);
                let q0 = t.plane.at(x0 * SUB + ox, ys);
                for k in 0..=x1 - x0 {
                    let q = t.plane.clamp(q0 + t.plane.gx * f64::from(k * SUB));
                    self.write(first + k as usize, q, prim);
                }
            }
        }
    }

    #[inline]
    fn write(&mut self, i: usize, q: f32, prim: u32) {
        #[cfg(test)]
        {
            self.hits[i] += 1;
        }
        if q > self.q[i] {
            self.q[i] = q;
            self.prim[i] = prim;
        }
    }
}

/// Bounding boxes below this many fixed-point steps go with 32-bit edge functions.
const SMALL: i32 = 6 * SUB;

/// Top-left rule: a sample exactly on an edge belongs to the triangle below or to the right of it.
#[inline]
fn owns_edge(dx: i64, dy: i64) -> bool {
    dy < 0 || (dy == 0 && dx > 0)
}

/// The plane of nearness, per fixed-point step, and its range on the triangle.
struct Plane {
    origin: [i32; 2],
    q0: f64,
    gx: f64,
    gy: f64,
    q_min: f32,
    q_max: f32,
}

impl Plane {
    /// * `area`: twice the area of the triangle, positive.
    #[inline]
    fn new([a, b, c]: [ScreenVertex; 3], area: i64) -> Self {
        let d = |p: i32, q: i32| f64::from(p) - f64::from(q);
        let (q1, q2) = (f64::from(b.q) - f64::from(a.q), f64::from(c.q) - f64::from(a.q));
        let inv = 1.0 / area as f64;
        Self {
            origin: [a.x, a.y],
            q0: f64::from(a.q),
            gx: (q1 * d(c.y, a.y) - q2 * d(b.y, a.y)) * inv,
            gy: (q2 * d(b.x, a.x) - q1 * d(c.x, a.x)) * inv,
            q_min: a.q.min(b.q).min(c.q),
            q_max: a.q.max(b.q).max(c.q),
        }
    }

    #[inline]
    fn at(&self, xs: i32, ys: i32) -> f64 {
        self.q0 + self.gx * f64::from(xs - self.origin[0]) + self.gy * f64::from(ys - self.origin[1])
    }

    #[inline]
    fn clamp(&self, q: f64) -> f32 {
        (q as f32).clamp(self.q_min, self.q_max)
    }
}

/// Edge functions (inside = all >= 0) and the plane of nearness of a triangle of any size.
struct Setup {
    /// Edge functions at the first vertex, fill rule included.
    e0: [i64; 3],
    /// Their change per pixel along x and per fixed-point step.
    dx: [i64; 3],
    ex: [i64; 3],
    ey: [i64; 3],
    plane: Plane,
}

impl Setup {
    /// `None` for a triangle without area.
    #[inline]
    fn new(a: ScreenVertex, b: ScreenVertex, c: ScreenVertex) -> Option<Self> {
        let d = |p: i32, q: i32| i64::from(p) - i64::from(q);
        let area = d(b.x, a.x) * d(c.y, a.y) - d(c.x, a.x) * d(b.y, a.y);
        if area == 0 {
            return None;
        }
        let (b, c, area) = if area < 0 { (c, b, -area) } else { (b, c, area) };
        let v = [a, b, c];
        let (mut e0, mut ex, mut ey) = ([0i64; 3], [0i64; 3], [0i64; 3]);
        for i in 0..3 {
            let (p, r) = (v[i], v[(i + 1) % 3]);
            let (dx, dy) = (d(r.x, p.x), d(r.y, p.y));
            ex[i] = -dy;
            ey[i] = dx;
            e0[i] = dx * d(a.y, p.y) - dy * d(a.x, p.x) - i64::from(!owns_edge(dx, dy));
        }
        Some(Self { e0, dx: ex.map(|e| e * i64::from(SUB)), ex, ey, plane: Plane::new(v, area) })
    }

    #[inline]
    fn edges_at(&self, xs: i32, ys: i32) -> [i64; 3] {
        let [x0, y0] = self.plane.origin;
        let (x, y) = (i64::from(xs) - i64::from(x0), i64::from(ys) - i64::from(y0));
        std::array::from_fn(|i| self.e0[i] + self.ex[i] * x + self.ey[i] * y)
    }

    /// The pixels of `xa..=xb` whose sample in row `ys` is inside, exactly.
    fn span(&self, ys: i32, ox: i32, xa: i32, xb: i32) -> (i32, i32) {
        let e = self.edges_at(xa * SUB + ox, ys);
        let (mut lo, mut hi) = (0i64, i64::from(xb - xa));
        for (e, d) in e.into_iter().zip(self.dx) {
            // e + k d >= 0
            match (e < 0, d.signum()) {
                (true, 1) => lo = lo.max((-e + d - 1) / d),
                (true, _) => return (1, 0),
                (false, -1) => hi = hi.min(e / -d),
                (false, _) => {}
            }
        }
        if lo > hi { (1, 0) } else { (xa + lo as i32, xa + hi as i32) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(seed: &mut u64) -> i32 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 33) as i32
    }

    /// A sheet of `n` x `n` cells with shaken inner nodes, `pitch` fixed-point steps apart.
    fn sheet(n: usize, pitch: i32, seed: u64) -> Vec<ScreenVertex> {
        let mut seed = seed;
        (0..(n + 1) * (n + 1))
            .map(|i| {
                let (c, r) = (i % (n + 1), i / (n + 1));
                let inner = c > 0 && r > 0 && c < n && r < n;
                let mut shake = || if inner { random(&mut seed) % (pitch / 4 + 1) - pitch / 8 } else { 0 };
                let (x, y) = (c as i32 * pitch + shake() - 300, r as i32 * pitch + shake() - 300);
                ScreenVertex { x, y, q: 1.0 }
            })
            .collect()
    }

    #[test]
    fn every_sample_of_a_sheet_is_covered_exactly_once() {
        // Pitches below a pixel, of whole pixels (nodes on samples) and far above.
        for (n, pitch, samples) in [(90, 61, 1), (40, 256, 1), (40, 128, 4), (30, 700, 16), (7, 4000, 4), (64, 384, 16)]
        {
            let size = (n as i32 * pitch - 300) / SUB;
            let mut band = Band::new(0, size + 3, size + 3, sample_offsets(samples));
            let v = sheet(n, pitch, 7 + n as u64);
            for cell in 0..n * n {
                let nw = cell / n * (n + 1) + cell % n;
                let [a, b, c, d] = [nw, nw + 1, nw + n + 1, nw + n + 2].map(|i| v[i]);
                // Either orientation, any starting corner.
                band.draw([a, b, d], 0);
                band.draw([d, a, c], 1);
            }
            let last = n as i32 * pitch - 300;
            for (s, [ox, oy]) in band.offsets.iter().enumerate() {
                for y in 0..size + 3 {
                    for x in 0..size + 3 {
                        let (xs, ys) = (x * SUB + ox, y * SUB + oy);
                        // The sheet owns its left and top border, not its right and bottom one.
                        let inside = xs < last && ys < last;
                        assert_eq!(band.hits[band.index(s, x, y)], u32::from(inside), "pitch {pitch}: ({x}, {y}) {s}");
                    }
                }
            }
        }
    }

    #[test]
    fn nearness_is_the_plane_through_the_corners() {
        let corner = |x: i32, y: i32| ScreenVertex { x: x * SUB, y: y * SUB, q: 0.5 + 0.001 * (2 * x + 3 * y) as f32 };
        let mut band = Band::new(0, 60, 60, sample_offsets(4));
        band.draw([corner(1, 1), corner(58, 4), corner(7, 55)], 9);
        let mut seen = 0;
        for (s, [ox, oy]) in band.offsets.iter().enumerate() {
            for i in 0..3600 {
                let (x, y) = (i % 60, i / 60);
                let at = band.index(s, x, y);
                if band.prim[at] == 9 {
                    let (px, py) = (x as f32 + *ox as f32 / 256.0, y as f32 + *oy as f32 / 256.0);
                    assert!((band.q[at] - (0.5 + 0.001 * (2.0 * px + 3.0 * py))).abs() < 1e-6);
                    seen += 1;
                }
            }
        }
        assert!(seen > 5 * 1400);
    }
}
