//! Bounds of a strip over edges and boxes.

use super::Strip;
use super::curve::StripPoint;
use crate::Aabb;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// No bound is given where 1 - curvature x distance may fall below this.
const LEAST: f64 = 0.05;

/// Bounds over part of the strip.
#[derive(Debug, Clone, Copy)]
struct Most {
    curvature: f64,
    /// Change of curvature by arc length.
    change: f64,
    /// Distance from the curve.
    a: f64,
    /// Least 1 - curvature x distance.
    stretch: f64,
}

impl Strip {
    /// See [`crate::map::StageMap::edge_bound`]: an eighth of a bound on the second derivative along the edge; infinite unless the edge stays in
    /// the domain for certain.
    ///
    /// With `k` the route's curvature, `c k` that of the new one, `s = 1 - c`, `D = 1 - k a` and an edge that goes `u` along the curve and
    /// `v` across it, the second derivative is `s u / D^2 (k' a u / D + 2 k v)` along the new curve and `-s k u^2 (1 - (1 + c) k a) / D^2`
    /// across it. Source: ours.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        match (self.coordinates(p0), self.coordinates(p1)) {
            (Some(from), Some(to)) => self.bound_between(from, to, (p1 - p0).truncate().length()),
            _ => f64::INFINITY,
        }
    }

    /// Images of both ends and [`Strip::edge_bound`]; `None` if an end has no image.
    pub(crate) fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        let (from, to) = (self.coordinates(p0)?, self.coordinates(p1)?);
        let bound = self.bound_between(from, to, (p1 - p0).truncate().length());
        let [q0, q1] = [(p0, from), (p1, to)].map(|(p, at)| self.image(p, at));
        Some((q0, q1, bound))
    }

    fn bound_between(&self, from: StripPoint, to: StripPoint, length: f64) -> f64 {
        match self.along(from, to, length) {
            Some(most) => 0.125 * self.second_derivative(&most) * length * length,
            None => f64::INFINITY,
        }
    }

    /// Bounds over a straight edge between two points; `None` where it may leave the domain.
    fn along(&self, from: StripPoint, to: StripPoint, length: f64) -> Option<Most> {
        let a = from.a.abs().max(to.a.abs());
        // No point of the edge is farther from the curve than its farther end plus half the edge's length.
        // Feet so near each other along the curve belong to one branch, see docs/algorithms/strip.md.
        let least = 1.0 - self.largest_curvature * (a + 0.5 * length);
        let branch = 2.0 * length * self.largest_curvature <= PI * least;
        if !(least >= LEAST && branch) || (from.g - to.g).abs() * least > length * (1.0 + 1e-9) + 1e-9 {
            return None;
        }
        let (middle, half) = (0.5 * (from.g + to.g), 0.5 * length / least);
        let [curvature, change] = self.route.most(middle - half, middle + half);
        let far = a + 0.125 * curvature * length * length / least;
        let [first, last] = self.route.reach();
        if !(far <= self.half_width && middle - half >= first && middle + half <= last) {
            return None;
        }
        Some(Most { curvature, change, a: far, stretch: 1.0 - curvature * far })
    }

    /// Bound on the second derivative along a straight line of unit speed.
    fn second_derivative(&self, most: &Most) -> f64 {
        let Most { curvature: k, change, a, stretch } = *most;
        let along = change * a / stretch + k;
        let across = k * (1.0 + (2.0 - self.share) * k * a);
        self.share * along.hypot(across) / (stretch * stretch)
    }

    /// See [`crate::map::StageMap::displaced_bounds`]; `None` unless all of the box lies in the domain.
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        if bounds.is_empty() || !bounds.min.is_finite() || !bounds.max.is_finite() {
            return None;
        }
        let center = bounds.center();
        let at = self.coordinates(center)?;
        let half = 0.5 * (bounds.max - bounds.min).truncate();
        let radius = half.length();
        let a = at.a.abs() + radius;
        let least = 1.0 - self.largest_curvature * a;
        if !(a <= self.half_width && least >= LEAST) {
            return None;
        }
        let [from, to] = [at.g - radius / least, at.g + radius / least];
        let [first, last] = self.route.reach();
        if !(from >= first && to <= last) {
            return None;
        }
        let [curvature, change] = self.route.most(from, to);
        let most = Most { curvature, change, a, stretch: 1.0 - curvature * a };
        // The image of the box by the derivative at its centre, and what second derivatives add to it.
        let (image, [x, y]) = self.linear(center.truncate(), at);
        let more = 0.5 * self.second_derivative(&most) * radius * radius;
        let reach = DVec2::new(x.x.abs() * half.x + y.x.abs() * half.y, x.y.abs() * half.x + y.y.abs() * half.y)
            + more * (1.0 + 1e-12)
            + 1e-12 * image.abs().max_element();
        Some(Aabb { min: (image - reach).extend(bounds.min.z), max: (image + reach).extend(bounds.max.z) })
    }

    /// Whether no point of a box has an image; `false` also where that is not known.
    pub fn misses(&self, bounds: &Aabb) -> bool {
        let radius = 0.5 * (bounds.max - bounds.min).truncate().length();
        let center = bounds.center();
        center.is_finite() && !self.route.may_come_within(center.truncate(), self.half_width + radius)
    }
}
