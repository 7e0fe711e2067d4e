//! Parts of rays as cubics, clipped to a box.

use belvedere_core::DVec3;
use std::ops::{Add, Mul, Sub};

/// A curve over 0..=1 of nearly constant speed, or a number along it: `c0 + t (c1 + t (c2 + t c3))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cubic<V = DVec3>(pub(super) [V; 4]);

/// Tolerance of roots, as a share of the parameter range.
const ROOT: f64 = 1e-9;

impl<V: Copy + Default + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>> Cubic<V> {
    pub(super) fn line(a: V, b: V) -> Self {
        Self([a, b - a, V::default(), V::default()])
    }

    /// From `a` to `b`, with derivatives `da` and `db` there.
    pub(super) fn hermite([a, b]: [V; 2], [da, db]: [V; 2]) -> Self {
        let way = b - a;
        Self([a, da, way * 3.0 - da * 2.0 - db, da + db - way * 2.0])
    }

    pub(super) fn at(&self, t: f64) -> V {
        let [c0, c1, c2, c3] = self.0;
        c0 + (c1 + (c2 + c3 * t) * t) * t
    }

    /// The part between two parameters, over 0..=1 again.
    pub(super) fn part(&self, [t0, t1]: [f64; 2]) -> Self {
        let [_, c1, c2, c3] = self.0;
        let h = t1 - t0;
        let slope = c1 + (c2 * 2.0 + c3 * (3.0 * t0)) * t0;
        Self([self.at(t0), slope * h, (c2 + c3 * (3.0 * t0)) * (h * h), c3 * (h * h * h)])
    }
}

impl Cubic<f64> {
    /// Where a rising number reaches a value between those at the ends.
    pub(super) fn reaches(&self, value: f64) -> f64 {
        let f = |t: f64| self.at(t) - value;
        root(&f, (0.0, f(0.0)), (1.0, f(1.0)))
    }
}

impl Cubic {
    /// Bezier control points, whose hull contains the curve.
    pub(super) fn hull(&self) -> [DVec3; 4] {
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
        if let Some([t0, t1]) = self.inside_one_way(most, [lo, hi]) {
            if t0 < t1 {
                take([t0, t1]);
            }
            return;
        }
        // At most three crossings of each of six faces.
        let (mut ends, mut n) = ([1.0; 20], 1);
        ends[0] = 0.0;
        for a in 0..3 {
            for bound in [0.0, most[a]] {
                if lo[a] < bound && bound < hi[a] {
                    self.crossings(a, bound, |t| {
                        ends[n] = t;
                        n += 1;
                    });
                }
            }
        }
        ends[1..n].sort_unstable_by(f64::total_cmp);
        for pair in ends[..=n].windows(2) {
            let middle = self.at(0.5 * (pair[0] + pair[1]));
            if pair[0] < pair[1] && middle.cmpge(DVec3::ZERO).all() && middle.cmple(most).all() {
                take([pair[0], pair[1]]);
            }
        }
    }

    /// The part inside the box, perhaps empty, where no coordinate that may leave it turns round; `None` where one does.
    ///
    /// * `hull`: bounds of the curve.
    fn inside_one_way(&self, most: DVec3, [lo, hi]: [DVec3; 2]) -> Option<[f64; 2]> {
        let [c0, c1, c2, c3] = self.0;
        let leaves = lo.cmplt(DVec3::ZERO) | hi.cmpgt(most);
        if (leaves & c1.abs().cmple(c2.abs() * 2.0 + c3.abs() * 3.0)).any() {
            return None;
        }
        let end = c0 + (c1 + (c2 + c3));
        let (mut t0, mut t1) = (0.0f64, 1.0f64);
        for axis in 0..3 {
            if !leaves.test(axis) {
                continue;
            }
            // Along the way of the curve, distances of the ends past the faces where it enters and leaves.
            let (way, [first, last]) =
                if c1[axis] > 0.0 { (1.0, [0.0, most[axis]]) } else { (-1.0, [most[axis], 0.0]) };
            let [begin, end] = [c0[axis], end[axis]].map(|c| [way * (c - first), way * (c - last)]);
            if end[0] < 0.0 || begin[1] > 0.0 {
                return Some([1.0, 0.0]);
            }
            if begin[0] < 0.0 {
                t0 = t0.max(self.meets(axis, first));
            }
            if end[1] > 0.0 {
                t1 = t1.min(self.meets(axis, last));
            }
        }
        Some([t0, t1])
    }

    /// Where a coordinate that does not turn round meets a bound between its values at the ends: Newton's method with the slope of a first
    /// estimate.
    fn meets(&self, axis: usize, bound: f64) -> f64 {
        let [c0, c1, c2, c3] = self.0.map(|c| c[axis]);
        let f = |t: f64| c0 - bound + t * (c1 + t * (c2 + t * c3));
        let mut t = ((bound - c0) / (c1 + c2 + c3)).clamp(0.0, 1.0);
        let per_slope = 1.0 / (c1 + t * (2.0 * c2 + 3.0 * t * c3));
        for _ in 0..4 {
            let by = f(t) * per_slope;
            t = (t - by).clamp(0.0, 1.0);
            if by.abs() < ROOT {
                return t;
            }
        }
        root(&f, (0.0, f(0.0)), (1.0, f(1.0)))
    }

    /// Parameters at which a coordinate crosses a bound: at most once between its turning points.
    fn crossings(&self, axis: usize, bound: f64, mut take: impl FnMut(f64)) {
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
                take(root(&f, (pair[0], fa), (pair[1], fb)));
            }
        }
    }
}

/// The root between two parameters with values of different sign: false position (Illinois).
fn root(f: &impl Fn(f64) -> f64, mut a: (f64, f64), mut b: (f64, f64)) -> f64 {
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
mod tests;
