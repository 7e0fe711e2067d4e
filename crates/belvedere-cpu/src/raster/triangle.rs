//! Watertight rasterisation of triangles into a band of image rows.

use crate::raster::band::{Band, SLACK};
use crate::screen::{SUB, ScreenVertex};

impl Band {
    /// Draws a triangle, either orientation.
    #[inline(always)]
    pub(crate) fn draw(&mut self, tri: [ScreenVertex; 3], prim: u32) {
        let [a, b, c] = tri;
        let x = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
        let y = [a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)];
        if self.misses(x, y) {
            return;
        }
        if x[1] - x[0] < SMALL && y[1] - y[0] < SMALL {
            self.draw_small(tri, x, y, prim);
        } else {
            self.draw_large(tri, x, y, prim);
        }
    }

    /// First and last pixel whose sample lies in a triangle's bounding box.
    #[inline(always)]
    pub(super) fn pixels(&self, [ox, oy]: [i32; 2], x: [i32; 2], y: [i32; 2]) -> [i32; 4] {
        [
            ((x[0] - ox + SUB - 1) >> 8).max(0),
            ((x[1] - ox) >> 8).min(self.width - 1),
            ((y[0] - oy + SUB - 1) >> 8).max(self.y0),
            ((y[1] - oy) >> 8).min(self.y1 - 1),
        ]
    }

    /// Draws a triangle of a few pixels by 32-bit edge functions, a row of samples at once.
    #[inline(always)]
    fn draw_small(&mut self, [a, b, c]: [ScreenVertex; 3], x: [i32; 2], y: [i32; 2], prim: u32) {
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if area == 0 {
            return;
        }
        let v = if area < 0 { [a, c, b] } else { [a, b, c] };
        let plane = Plane::new(v, area.unsigned_abs().into());
        let (mut dx, mut dy, mut own) = ([0; 3], [0; 3], [0; 3]);
        for i in 0..3 {
            let (p, r) = (v[i], v[(i + 1) % 3]);
            (dx[i], dy[i]) = (r.x - p.x, r.y - p.y);
            own[i] = i32::from(!owns_edge(i64::from(dx[i]), i64::from(dy[i])));
        }
        let slope = plane.gx as f32 * SUB as f32;
        for s in 0..self.offsets.len() {
            let [ox, oy] = self.offsets[s];
            let [xa, xb, ya, yb] = self.pixels([ox, oy], x, y);
            if xa > xb {
                continue;
            }
            for py in ya..=yb {
                let (xs, ys) = (xa * SUB + ox, py * SUB + oy);
                let mut e = [0; 3];
                for i in 0..3 {
                    e[i] = dx[i] * (ys - v[i].y) - dy[i] * (xs - v[i].x) - own[i];
                }
                let first = self.index(s, xa, py);
                let lane = Lane { q: plane.at(xs, ys) as f32, slope, range: [plane.q_min, plane.q_max], prim };
                #[cfg(test)]
                self.count(first, &e, &dy);
                let (q, prim) = (&mut self.q[first..first + LANES], &mut self.prim[first..first + LANES]);
                lane.inside(q, prim, e, dy);
            }
        }
    }

    #[cfg(test)]
    fn count(&mut self, first: usize, e: &[i32; 3], dy: &[i32; 3]) {
        for k in 0..LANES {
            let inside = (0..3).all(|i| e[i] - dy[i] * SUB * k as i32 >= 0);
            self.hits[first + k] += u32::from(inside);
        }
    }

    #[inline(never)]
    fn draw_large(&mut self, [a, b, c]: [ScreenVertex; 3], x: [i32; 2], y: [i32; 2], prim: u32) {
        let Some(t) = Setup::new(a, b, c) else { return };
        let slope = t.plane.gx as f32 * SUB as f32;
        for s in 0..self.offsets.len() {
            let [ox, oy] = self.offsets[s];
            let [xa, xb, ya, yb] = self.pixels([ox, oy], x, y);
            if xa > xb {
                continue;
            }
            for y in ya..=yb {
                let ys = y * SUB + oy;
                let (x0, x1) = t.span(ys, ox, xa, xb);
                if x0 > x1 {
                    continue;
                }
                let first = self.index(s, x0, y);
                let samples = first..first + (x1 - x0 + 1) as usize;
                let q = t.plane.at(x0 * SUB + ox, ys) as f32;
                let lane = Lane { q, slope, range: [t.plane.q_min, t.plane.q_max], prim };
                #[cfg(test)]
                self.hits[samples.clone()].iter_mut().for_each(|n| *n += 1);
                lane.span(&mut self.q[samples.clone()], &mut self.prim[samples]);
            }
        }
    }
}

/// Samples of a row that are tested together.
const LANES: usize = SLACK;
/// Bounding boxes below this many fixed-point steps fit the lanes and 32-bit edge functions.
const SMALL: i32 = 7 * SUB;

/// Nearness along a row of samples.
#[derive(Clone, Copy)]
struct Lane {
    q: f32,
    slope: f32,
    range: [f32; 2],
    prim: u32,
}

impl Lane {
    #[inline(always)]
    fn at(self, k: usize) -> f32 {
        let q = self.q + self.slope * k as f32;
        let q = if q < self.range[0] { self.range[0] } else { q };
        if q > self.range[1] { self.range[1] } else { q }
    }

    /// Eight samples, those where all edge functions (`e` at the first, falling by `dy` per step) are not negative.
    #[inline(always)]
    fn inside(self, q: &mut [f32], prim: &mut [u32], e: [i32; 3], dy: [i32; 3]) {
        let (q, prim) = (&mut q[..LANES], &mut prim[..LANES]);
        for k in 0..LANES {
            let step = SUB * k as i32;
            let outside = (e[0] - dy[0] * step) | (e[1] - dy[1] * step) | (e[2] - dy[2] * step);
            let new = self.at(k);
            let wins = (outside >= 0) & ((new > q[k]) | ((new == q[k]) & (self.prim < prim[k])));
            q[k] = if wins { new } else { q[k] };
            prim[k] = if wins { self.prim } else { prim[k] };
        }
    }

    /// Every sample of the slices.
    #[inline(always)]
    fn span(self, q: &mut [f32], prim: &mut [u32]) {
        for (k, (q, prim)) in q.iter_mut().zip(prim).enumerate() {
            let new = self.at(k);
            let wins = (new > *q) | ((new == *q) & (self.prim < *prim));
            *q = if wins { new } else { *q };
            *prim = if wins { self.prim } else { *prim };
        }
    }
}

/// Top-left rule: a sample exactly on an edge belongs to the triangle below or to the right of it.
#[inline(always)]
pub(crate) fn owns_edge(dx: i64, dy: i64) -> bool {
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
    #[inline(always)]
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

    #[inline(always)]
    fn at(&self, xs: i32, ys: i32) -> f64 {
        self.q0 + self.gx * f64::from(xs - self.origin[0]) + self.gy * f64::from(ys - self.origin[1])
    }
}

/// Edge functions (inside = all >= 0) and the plane of nearness of a triangle of any size.
pub(super) struct Setup {
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
    #[inline(always)]
    pub(super) fn new(a: ScreenVertex, b: ScreenVertex, c: ScreenVertex) -> Option<Self> {
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

    /// Nearness at a position on the image, clamped to the range of the corners.
    #[inline(always)]
    pub(super) fn nearness(&self, xs: i32, ys: i32) -> f64 {
        self.plane.at(xs, ys).clamp(f64::from(self.plane.q_min), f64::from(self.plane.q_max))
    }

    #[inline(always)]
    fn edges_at(&self, xs: i32, ys: i32) -> [i64; 3] {
        let [x0, y0] = self.plane.origin;
        let (x, y) = (i64::from(xs) - i64::from(x0), i64::from(ys) - i64::from(y0));
        std::array::from_fn(|i| self.e0[i] + self.ex[i] * x + self.ey[i] * y)
    }

    /// The pixels of `xa..=xb` whose sample in row `ys` is inside, exactly.
    pub(super) fn span(&self, ys: i32, ox: i32, xa: i32, xb: i32) -> (i32, i32) {
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
mod tests;
