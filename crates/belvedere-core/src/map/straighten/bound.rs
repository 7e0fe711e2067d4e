//! Bounds of a straightened strip or tube over edges and boxes.

use super::Straightened;
use super::curve::Foot;
use super::dimension::{Across, Dimension, Vector};
use crate::Aabb;
use glam::DVec3;
use std::f64::consts::PI;

/// No bound is given where 1 - curvature x distance may fall below this.
const LEAST: f64 = 0.05;
/// A nearly straight way is at most this much longer than its chord.
const WAY: f64 = 1.05;
/// Steps along the line at which points of the domain are listed.
const ALONG: usize = 400;
/// Share of the half width at which points near the border are listed.
const INSIDE: f64 = 0.999;

/// Bounds over a part.
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

impl<D: Dimension> Straightened<D> {
    /// See [`crate::map::StageMap::edge_bound`]: an eighth of a bound on the second derivative along the edge; infinite unless the edge stays in
    /// the domain for certain.
    ///
    /// With `k` the curvature of the line, `c k` that of the new one, `s = 1 - c`, `D = 1 - k a` and an edge that goes `u` along the curve and
    /// `v` across it, the second derivative is `s u / D^2 (k' a u / D + 2 k v)` along the new curve and `-s k u^2 (1 - (1 + c) k a) / D^2`
    /// across it; in space `k`, `a` and `v` are vectors across the curve. Source: ours.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        match (self.coordinates(p0), self.coordinates(p1)) {
            (Some(from), Some(to)) => self.bound_between(from, to, D::of(p1 - p0).length()),
            _ => f64::INFINITY,
        }
    }

    /// Images of both ends and [`Straightened::edge_bound`]; `None` if an end has no image.
    pub(crate) fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        let (from, to) = (self.coordinates(p0)?, self.coordinates(p1)?);
        let bound = self.bound_between(from, to, D::of(p1 - p0).length());
        let [q0, q1] = [(p0, from), (p1, to)].map(|(p, at)| self.image(p, at));
        Some((q0, q1, bound))
    }

    fn bound_between(&self, from: Foot<D>, to: Foot<D>, length: f64) -> f64 {
        match self.along(from, to, length) {
            Some(most) => 0.125 * self.second_derivative(&most) * length * length,
            None => f64::INFINITY,
        }
    }

    /// Bounds over a straight edge between two points; `None` where it may leave the domain.
    fn along(&self, from: Foot<D>, to: Foot<D>, length: f64) -> Option<Most> {
        if !self.single {
            return None;
        }
        let a = from.a.length().max(to.a.length());
        // No point of the edge is farther from the curve than its farther end plus half the edge's length.
        // Feet so near each other along the curve belong to one branch, see docs/algorithms/strip.md.
        let least = 1.0 - self.largest_curvature * (a + 0.5 * length);
        let branch = 2.0 * length * self.largest_curvature <= PI * least;
        if !(least >= LEAST && branch) || (from.g - to.g).abs() * least > length * (1.0 + 1e-9) + 1e-9 {
            return None;
        }
        let (middle, half) = (0.5 * (from.g + to.g), 0.5 * length / least);
        let [curvature, change] = self.line.most(middle - half, middle + half);
        let far = a + 0.125 * curvature * length * length / least;
        let [first, last] = self.line.reach();
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
        if !self.single || bounds.is_empty() || !bounds.min.is_finite() || !bounds.max.is_finite() {
            return None;
        }
        let center = bounds.center();
        let at = self.coordinates(center)?;
        let half = D::of(0.5 * (bounds.max - bounds.min));
        let radius = half.length();
        let a = at.a.length() + radius;
        let least = 1.0 - self.largest_curvature * a;
        if !(a <= self.half_width && least >= LEAST) {
            return None;
        }
        let [from, to] = [at.g - radius / least, at.g + radius / least];
        let [first, last] = self.line.reach();
        if !(from >= first && to <= last) {
            return None;
        }
        let [curvature, change] = self.line.most(from, to);
        let most = Most { curvature, change, a, stretch: 1.0 - curvature * a };
        // The image of the box by the derivative at its centre, and what second derivatives add to it.
        let (image, columns) = self.linear(D::of(center), at);
        let more = 0.5 * self.second_derivative(&most) * radius * radius * (1.0 + 1e-12) + 1e-12 * image.most();
        let (mut min, mut max) = (D::Vector::default(), D::Vector::default());
        for (i, axis) in D::Vector::AXES.iter().enumerate() {
            let reach =
                columns.iter().zip(half.components()).map(|(c, h)| c.components()[i].abs() * h).sum::<f64>() + more;
            (min, max) = (min + *axis * (image.components()[i] - reach), max + *axis * (image.components()[i] + reach));
        }
        Some(Aabb { min: D::with(min, bounds.min), max: D::with(max, bounds.max) })
    }

    /// Whether no point of a box has an image; `false` also where that is not known.
    pub fn misses(&self, bounds: &Aabb) -> bool {
        let radius = D::of(0.5 * (bounds.max - bounds.min)).length();
        let center = bounds.center();
        center.is_finite() && !self.line.may_come_within(D::of(center), self.half_width + radius)
    }

    /// See [`crate::map::StageMap::may_hold`].
    pub fn may_hold(&self, [start, middle, end]: [DVec3; 3]) -> bool {
        let way = [start, end].map(|p| D::of(p).distance(D::of(middle)));
        let way = way[0].max(way[1]);
        self.outside(middle) <= WAY * way
    }

    /// See [`crate::map::StageMap::points_within`].
    pub fn points_within(&self, bounds: &Aabb) -> Vec<DVec3> {
        let size = D::of(bounds.max - bounds.min).length();
        let (length, [first, last]) = (self.line.length(), self.line.reach());
        let (from, to) = (first.max(-size), last.min(length + size));
        let shares = [-INSIDE, -0.5, 0.0, 0.5, INSIDE];
        let places = (0..=ALONG).flat_map(|i| {
            let at = self.line.at(from + (to - from) * i as f64 / ALONG as f64);
            shares.into_iter().flat_map(move |a| {
                D::spread(a * self.half_width).into_iter().map(move |a| at.p + D::vector(at.turn, 0.0, a))
            })
        });
        let (min, max) = (D::of(bounds.min), D::of(bounds.max));
        let is_inside = |p: &D::Vector| {
            let limits = min.components().iter().zip(max.components());
            p.components().iter().zip(limits).all(|(c, (lo, hi))| lo <= c && c <= hi)
        };
        places.filter(is_inside).flat_map(|p| [bounds.min, bounds.max].map(|q| D::with(p, q))).collect()
    }
}
