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
        Self {
            y0,
            y1,
            width,
            offsets,
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

    /// Draws a triangle, either orientation. Of two surfaces equally near the one drawn first stays.
    #[inline]
    pub(crate) fn draw(&mut self, [a, b, c]: [ScreenVertex; 3], prim: u32) {
        let (min_y, max_y) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
        if max_y < self.y0 * SUB || min_y >= self.y1 * SUB {
            return;
        }
        let (min_x, max_x) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        if max_x < 0 || min_x >= self.width * SUB {
            return;
        }
        let mut setup: Option<Setup> = None;
        for s in 0..self.offsets.len() {
            let [ox, oy] = self.offsets[s];
            // First and last pixel whose sample lies in the triangle's bounding box.
            let xa = ((min_x - ox + SUB - 1) >> 8).max(0);
            let xb = ((max_x - ox) >> 8).min(self.width - 1);
            let ya = ((min_y - oy + SUB - 1) >> 8).max(self.y0);
            let yb = ((max_y - oy) >> 8).min(self.y1 - 1);
            if xa > xb || ya > yb {
                continue;
            }
            if setup.is_none() {
                match Setup::new(a, b, c) {
                    Some(new) => setup = Some(new),
                    None => return,
                }
            }
            let Some(t) = &setup else { return };
            for y in ya..=yb {
                let ys = y * SUB + oy;
                let (x0, x1) = if xb - xa < 4 { (xa, xb) } else { t.span(ys, ox, xa, xb) };
                if x0 > x1 {
                    continue;
                }
                let first = self.index(s, x0, y);
                self.row(t, first, x0, x1, x0 * SUB + ox, ys, xb - xa < 4, prim);
            }
        }
    }

    #[inline]
    #[allow(clippy::too_many_arguments)]
    fn row(&mut self, t: &Setup, first: usize, x0: i32, x1: i32, xs: i32, ys: i32, test: bool, prim: u32) {
        let mut e = t.edges_at(xs, ys);
        let q0 = t.q_at(xs, ys);
        for k in 0..=(x1 - x0) as usize {
            if !test || (e[0] | e[1] | e[2]) >= 0 {
                let q = ((q0 + t.q_dx * k as f64) as f32).clamp(t.q_min, t.q_max);
                let i = first + k;
                #[cfg(test)]
                {
                    self.hits[i] += 1;
                }
                if q > self.q[i] {
                    self.q[i] = q;
                    self.prim[i] = prim;
                }
            }
            for (v, d) in e.iter_mut().zip(t.dx) {
                *v += d;
            }
        }
    }
}

/// Edge functions (inside = all >= 0) and the plane of nearness.
struct Setup {
    origin: [i32; 2],
    /// Edge functions at the origin, fill rule included.
    e0: [i64; 3],
    /// Their change per pixel along x and per fixed-point step.
    dx: [i64; 3],
    ex: [i64; 3],
    ey: [i64; 3],
    q0: f64,
    /// Change of nearness per pixel along x, per fixed-point step along x and y.
    q_dx: f64,
    gx: f64,
    gy: f64,
    q_min: f32,
    q_max: f32,
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
            // Top-left rule: a sample exactly on an edge belongs to the triangle below or to the right of it.
            let owns = dy < 0 || (dy == 0 && dx > 0);
            e0[i] = dx * d(a.y, p.y) - dy * d(a.x, p.x) - i64::from(!owns);
        }
        let (q1, q2) = (f64::from(b.q) - f64::from(a.q), f64::from(c.q) - f64::from(a.q));
        let inv = 1.0 / area as f64;
        let gx = (q1 * d(c.y, a.y) as f64 - q2 * d(b.y, a.y) as f64) * inv;
        let gy = (q2 * d(b.x, a.x) as f64 - q1 * d(c.x, a.x) as f64) * inv;
        Some(Self {
            origin: [a.x, a.y],
            e0,
            dx: ex.map(|e| e * i64::from(SUB)),
            ex,
            ey,
            q0: f64::from(a.q),
            q_dx: gx * f64::from(SUB),
            gx,
            gy,
            q_min: a.q.min(b.q).min(c.q),
            q_max: a.q.max(b.q).max(c.q),
        })
    }

    #[inline]
    fn edges_at(&self, xs: i32, ys: i32) -> [i64; 3] {
        let (x, y) = (i64::from(xs) - i64::from(self.origin[0]), i64::from(ys) - i64::from(self.origin[1]));
        std::array::from_fn(|i| self.e0[i] + self.ex[i] * x + self.ey[i] * y)
    }

    #[inline]
    fn q_at(&self, xs: i32, ys: i32) -> f64 {
        self.q0 + self.gx * f64::from(xs - self.origin[0]) + self.gy * f64::from(ys - self.origin[1])
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
