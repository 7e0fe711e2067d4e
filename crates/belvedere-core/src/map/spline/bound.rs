//! Bounds of the bend: the error of straight edges, and displaced boxes.

use super::{CurveCoordinates, SplineBend};
use crate::Aabb;
use crate::deformation::Station;
use glam::DVec3;

/// Pieces into which the bent part of a box is cut.
const PIECES: u32 = 8;

/// An end of an edge.
struct End {
    at: CurveCoordinates,
    on: Station,
}

impl SplineBend {
    /// See [`crate::map::StageMap::edge_bound`].
    ///
    /// A quarter of the total variation of the image's derivative; of its changes of length only the part across the chord counts.
    /// Source: ours.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        if !(p0.is_finite() && p1.is_finite()) {
            return f64::INFINITY;
        }
        self.bound_between(&self.end(p0), &self.end(p1))
    }

    /// See [`crate::map::StageMap::edge`].
    pub fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        if !(p0.is_finite() && p1.is_finite()) {
            return None;
        }
        let ends = [p0, p1].map(|p| self.end(p));
        let [a, b] = ends.each_ref().map(|end| self.image(end.at, end.on.frame.point, end.on.frame.tangent));
        (a.is_finite() && b.is_finite()).then(|| (a, b, self.bound_between(&ends[0], &ends[1])))
    }

    fn end(&self, p: DVec3) -> End {
        let at = self.coordinates(p);
        End { at, on: self.curve.station(at.l) }
    }

    fn bound_between<'e>(&self, mut from: &'e End, mut to: &'e End) -> f64 {
        if from.at.l > to.at.l {
            (from, to) = (to, from);
        }
        let (c0, c1) = (from.at, to.at);
        let turning = to.on.turning - from.on.turning;
        let variation = to.on.variation - from.on.variation;
        if turning <= 0.0 && variation <= 0.0 && from.on.frame.kap == 0.0 {
            return 0.0;
        }
        let h = self.scale * (c1.l - c0.l);
        let (dd, da) = ((c1.d - c0.d).abs(), (c1.a - c0.a).abs());
        let d_max = c0.d.abs().max(c1.d.abs());
        if d_max > 0.0 && self.curve.corners().iter().any(|&l| l > c0.l && l < c1.l) {
            return f64::INFINITY;
        }
        let kap = from.on.frame.kap.abs() + variation;
        let bend = kap * d_max / self.scale;
        let across = dd.hypot(da);
        let chord = (h * (1.0 - bend).max(0.0)).hypot(across);
        let sine = if chord > 0.0 && bend < 1.0 { (across / chord + turning).min(1.0) } else { 1.0 };
        0.25 * ((dd + h * (1.0 + bend)) * turning + h * (d_max * variation + kap * dd) / self.scale * sine)
    }

    /// See [`crate::map::StageMap::displaced_bounds`].
    ///
    /// Straight parts are exact, bent parts are covered by discs: along the curve the map stretches by `1 - kap d / K` at most.
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        if bounds.is_empty() || !(bounds.min.is_finite() && bounds.max.is_finite()) {
            return None;
        }
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in bounds.corners() {
            let c = self.coordinates(corner);
            let v = DVec3::new(c.l, c.d, c.a);
            (lo, hi) = (lo.min(v), hi.max(v));
        }
        let mut out = Aabb::EMPTY;
        let length = self.curve.length();
        for l in [lo.x, hi.x].into_iter().filter(|l| !(0.0..=length).contains(l)) {
            self.include_slice(&mut out, l, 0.0, lo, hi);
        }
        let (l0, l1) = (lo.x.clamp(0.0, length), hi.x.clamp(0.0, length));
        if lo.x <= length && hi.x >= 0.0 {
            let half = 0.5 * (l1 - l0) / f64::from(PIECES);
            for i in 0..PIECES {
                self.include_slice(&mut out, l0 + half * f64::from(2 * i + 1), half, lo, hi);
            }
        }
        (out.min.is_finite() && out.max.is_finite()).then_some(out)
    }

    /// Grows `out` by the image of the points within `half` of arc length `l`.
    fn include_slice(&self, out: &mut Aabb, l: f64, half: f64, lo: DVec3, hi: DVec3) {
        let curve = &self.curve;
        let kap = curve.curvature_at(l).abs() + curve.curvature_variation_to(l + half)
            - curve.curvature_variation_to(l - half);
        let (point, tangent) = curve.at(l);
        let corner = curve.corners().iter().any(|&c| (c - l).abs() <= half);
        for d in [lo.y, hi.y] {
            // At a corner the normal may turn by any angle.
            let swing = if corner { 2.0 * d.abs() } else { 0.0 };
            let stretch = if corner { 1.0 } else { 1.0 + kap * d.abs() / self.scale };
            let radius = self.scale * half * stretch + swing;
            let q = point + self.shift + (d / self.scale) * tangent.perp();
            let extent = DVec3::from_array(std::array::from_fn(|i| radius * self.out_u[i].hypot(self.out_v[i])));
            for a in [lo.z, hi.z] {
                let p = self.scene_from_curve(a, q);
                *out = out.including(p - extent).including(p + extent);
            }
        }
    }
}
