//! Parts of rays as cubics, clipped to a box.

use belvedere_core::DVec3;

/// A curve over 0..=1 of nearly constant speed: `c0 + t (c1 + t (c2 + t c3))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cubic(pub(super) [DVec3; 4]);

/// Tolerance of roots, as a share of the parameter range.
const ROOT: f64 = 1e-9;

impl Cubic {
    pub(super) fn line(a: DVec3, b: DVec3) -> Self {
        Self([a, b - a, DVec3::ZERO, DVec3::ZERO])
    }

    /// From `a` to `b`, with derivatives `da` and `db` there.
    pub(super) fn hermite([a, b]: [DVec3; 2], [da, db]: [DVec3; 2]) -> Self {
        let way = b - a;
        Self([a, da, 3.0 * way - 2.0 * da - db, da + db - 2.0 * way])
    }

    pub(super) fn at(&self, t: f64) -> DVec3 {
        let [c0, c1, c2, c3] = self.0;
        c0 + t * (c1 + t * (c2 + t * c3))
    }

    /// The part between two parameters, over 0..=1 again.
    pub(super) fn part(&self, [t0, t1]: [f64; 2]) -> Self {
        let [_, c1, c2, c3] = self.0;
        let h = t1 - t0;
        let slope = c1 + t0 * (2.0 * c2 + 3.0 * t0 * c3);
        Self([self.at(t0), h * slope, h * h * (c2 + 3.0 * t0 * c3), h * h * h * c3])
    }

    /// Bezier control points, whose hull contains the curve.
    fn hull(&self) -> [DVec3; 4] {
        let [c0, c1, c2, c3] = self.0;
        [c0, c0 + c1 / 3.0, c0 + (2.0 * c1 + c2) / 3.0, c0 + c1 + c2 + c3]
    }

    /// Calls `take` with the parameters of every part inside the box from 0 to `most`, in order.
    pub(super) fn inside(&self, most: DVec3, mut take: impl FnMut([f64; 2])) {
        let hull = self.hull();
        let (lo, hi) = hull.iter().fold((hull[0], hull[0]), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        if lo.cmpge(DVec3::ZERO).all() && hi.cmple(most).all() {
            return take([0.0, 1.0]);
        }
        if !(hi.cmpge(DVec3::ZERO).all() && lo.cmple(most).all()) {
            return;
        }
        let mut ends = vec![0.0, 1.0];
        for a in 0..3 {
            for bound in [0.0, most[a]] {
                if lo[a] < bound && bound < hi[a] {
                    self.crossings(a, bound, &mut ends);
                }
            }
        }
        ends.sort_by(f64::total_cmp);
        for pair in ends.windows(2) {
            let middle = self.at(0.5 * (pair[0] + pair[1]));
            if pair[0] < pair[1] && middle.cmpge(DVec3::ZERO).all() && middle.cmple(most).all() {
                take([pair[0], pair[1]]);
            }
        }
    }

    /// Parameters at which a coordinate crosses a bound: at most once between its turning points.
    fn crossings(&self, axis: usize, bound: f64, out: &mut Vec<f64>) {
        let [c0, c1, c2, c3] = self.0.map(|c| c[axis]);
        let f = |t: f64| c0 - bound + t * (c1 + t * (c2 + t * c3));
        let mut stops = [0.0, 1.0, 1.0, 1.0];
        let mut n = 1;
        // Roots of c1 + 2 c2 t + 3 c3 t^2, without cancellation.
        let square = c2 * c2 - 3.0 * c1 * c3;
        if square > 0.0 {
            let q = -(c2 + square.sqrt().copysign(c2));
            for t in [q / (3.0 * c3), c1 / q] {
                if t > 0.0 && t < 1.0 {
                    stops[n] = t;
                    n += 1;
                }
            }
        }
        stops[n] = 1.0;
        stops[..=n].sort_by(f64::total_cmp);
        for pair in stops[..=n].windows(2) {
            let (fa, fb) = (f(pair[0]), f(pair[1]));
            if (fa > 0.0) != (fb > 0.0) {
                out.push(root(&f, (pair[0], fa), (pair[1], fb)));
            }
        }
    }
}

/// The root between two parameters with values of different sign: false position (Illinois).
fn root(f: &dyn Fn(f64) -> f64, mut a: (f64, f64), mut b: (f64, f64)) -> f64 {
    for _ in 0..60 {
        let t = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        if !(t > a.0 && t < b.0) || b.0 - a.0 < ROOT {
            break;
        }
        let v = f(t);
        if v == 0.0 {
            return t;
        }
        if (v > 0.0) == (b.1 > 0.0) {
            if t - a.0 < ROOT {
                return t;
            }
            (b, a.1) = ((t, v), 0.5 * a.1);
        } else {
            if b.0 - t < ROOT {
                return t;
            }
            (a, b.1) = ((t, v), 0.5 * b.1);
        }
    }
    if a.1.abs() < b.1.abs() { a.0 } else { b.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_inside_a_box_end_at_its_faces() {
        // Through a corner region of the box: in, out, in, out.
        let curve = Cubic([
            DVec3::new(-1.0, 1.0, 5.0),
            DVec3::new(12.0, 0.0, 0.0),
            DVec3::new(0.0, -12.0, 0.0),
            DVec3::new(0.0, 12.0, 0.0),
        ]);
        let most = DVec3::splat(10.0);
        let mut parts = Vec::new();
        curve.inside(most, |part| parts.push(part));
        assert_eq!(parts.len(), 2, "{parts:?}");
        let inside = |p: DVec3| p.cmpge(DVec3::ZERO).all() && p.cmple(most).all();
        let mut wrong = 0;
        for i in 0..10_000 {
            let t = (f64::from(i) + 0.5) / 1e4;
            wrong += u32::from(inside(curve.at(t)) != parts.iter().any(|p| p[0] <= t && t <= p[1]));
        }
        assert_eq!(wrong, 0);
        let part = curve.part(parts[1]);
        assert!(part.at(0.25).distance(curve.at(parts[1][0] + 0.25 * (parts[1][1] - parts[1][0]))) < 1e-12);
        curve.inside(DVec3::new(10.0, 10.0, 4.0), |part| panic!("outside: {part:?}"));
    }

    #[test]
    fn hermite_curves_have_the_ends_asked_for() {
        let ends = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 9.0)];
        let slopes = [DVec3::new(0.3, 7.0, 1.0), DVec3::new(2.0, 2.0, -5.0)];
        let curve = Cubic::hermite(ends, slopes);
        let slope = |t: f64| (curve.at(t + 1e-6) - curve.at(t - 1e-6)) / 2e-6;
        for k in 0..2 {
            assert!(curve.at(k as f64).distance(ends[k]) < 1e-12 && slope(k as f64).distance(slopes[k]) < 1e-6);
        }
    }
}
