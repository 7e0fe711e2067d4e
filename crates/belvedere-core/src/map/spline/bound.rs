//! Bounds of the bend: the error of straight edges, and displaced boxes.

use super::{CurveCoordinates, SplineBend};
use crate::Aabb;
use crate::deformation::Station;
use glam::DVec3;

/// Pieces into which the bent part of a box is cut.
const PIECES: u32 = 8;

/// End of an edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeEnd {
    at: CurveCoordinates,
    on: Station,
}

/// What the bound of an edge depends on; it grows with each.
struct EdgeExtent {
    /// Length along the heading, height and distance across, scene units.
    h: f64,
    dd: f64,
    da: f64,
    /// Largest distance from the reference plane, scene units.
    d_max: f64,
    /// Turning of the tangent along it, total variation of the curvature, and the curvature at its near end.
    turning: f64,
    variation: f64,
    kap: f64,
}

impl SplineBend {
    /// See [`crate::map::StageMap::edge_bound`].
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        if !(p0.is_finite() && p1.is_finite()) {
            return f64::INFINITY;
        }
        self.bound_between(&self.edge_end(p0), &self.edge_end(p1))
    }

    /// See [`crate::map::StageMap::edge`].
    pub fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        if !(p0.is_finite() && p1.is_finite()) {
            return None;
        }
        let ends = [p0, p1].map(|p| self.edge_end(p));
        let [a, b] = ends.each_ref().map(|end| self.image_of(end));
        (a.is_finite() && b.is_finite()).then(|| (a, b, self.bound_between(&ends[0], &ends[1])))
    }

    pub(crate) fn edge_end(&self, p: DVec3) -> EdgeEnd {
        let at = self.coordinates(p);
        EdgeEnd { at, on: self.curve.station(at.l) }
    }

    /// Image of the end of an edge.
    pub(crate) fn image_of(&self, end: &EdgeEnd) -> DVec3 {
        self.image(end.at, end.on.frame.point, end.on.frame.tangent)
    }

    /// Largest factor by which the map lengthens a small difference at either end of an edge (Frobenius norm of the Jacobian).
    pub(crate) fn stretch_between(&self, a: &EdgeEnd, b: &EdgeEnd) -> f64 {
        let along = |end: &EdgeEnd| 1.0 - end.on.frame.kap * end.at.d / self.scale;
        let [a, b] = [a, b].map(|end| (2.0 + along(end) * along(end)).sqrt());
        a.max(b)
    }

    /// [`SplineBend::edge_bound`] of the edge between two ends.
    pub(crate) fn bound_between<'e>(&self, mut from: &'e EdgeEnd, mut to: &'e EdgeEnd) -> f64 {
        if from.at.l > to.at.l {
            (from, to) = (to, from);
        }
        let (c0, c1) = (from.at, to.at);
        let extent = EdgeExtent {
            h: self.scale * (c1.l - c0.l),
            dd: (c1.d - c0.d).abs(),
            da: (c1.a - c0.a).abs(),
            d_max: c0.d.abs().max(c1.d.abs()),
            turning: to.on.turning - from.on.turning,
            variation: to.on.variation - from.on.variation,
            kap: from.on.frame.kap.abs(),
        };
        self.bound(&extent, [c0.l, c1.l])
    }

    /// Bound on [`SplineBend::edge_bound`] of every edge inside a box.
    pub(crate) fn box_bound(&self, bounds: &Aabb) -> f64 {
        if bounds.is_empty() || !(bounds.min.is_finite() && bounds.max.is_finite()) {
            return f64::INFINITY;
        }
        let [lo, hi] = self.coordinate_range(bounds);
        let [near, far] = [lo.x, hi.x].map(|l| self.curve.station(l));
        let variation = far.variation - near.variation;
        let extent = EdgeExtent {
            h: self.scale * (hi.x - lo.x),
            dd: hi.y - lo.y,
            da: hi.z - lo.z,
            d_max: lo.y.abs().max(hi.y.abs()),
            turning: far.turning - near.turning,
            variation,
            // An edge may begin anywhere in the box.
            kap: near.frame.kap.abs() + variation,
        };
        self.bound(&extent, [lo.x, hi.x])
    }

    /// A quarter of the total variation of the image's derivative; of its changes of length only the part across the chord counts.
    /// Source: ours.
    fn bound(&self, extent: &EdgeExtent, [l0, l1]: [f64; 2]) -> f64 {
        let &EdgeExtent { h, dd, da, d_max, turning, variation, kap } = extent;
        if turning <= 0.0 && variation <= 0.0 && kap == 0.0 {
            return 0.0;
        }
        if d_max > 0.0 && self.curve.corners().iter().any(|&l| l > l0 && l < l1) {
            return f64::INFINITY;
        }
        let kap = kap + variation;
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
        let [lo, hi] = self.coordinate_range(bounds);
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

    /// Least and largest coordinates (l, d, a) in a box.
    fn coordinate_range(&self, bounds: &Aabb) -> [DVec3; 2] {
        let all = bounds.corners().map(|corner| {
            let c = self.coordinates(corner);
            DVec3::new(c.l, c.d, c.a)
        });
        all.into_iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
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
