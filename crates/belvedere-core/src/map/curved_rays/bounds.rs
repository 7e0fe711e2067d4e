//! Bounds for renderers: the error of straight edges and the displaced hull of a box.
//!
//! phi, continued beyond the common line as `max(0, a - b)`, is convex: homogeneous of degree 1, convex in the wedge with the slopes of its
//! neighbours at t0 and t2, and the largest of two linear functions everywhere else. So the exact image of an edge is the straight edge
//! between the displaced ends minus `delta d_j`, with `delta = lerp(phi) - phi >= 0`.

use super::phi::{Hinge, Phi};
use super::turn::Cell;
use super::{CurvedRays, Hit, Turn};
use crate::{Aabb, Miss};
use glam::DVec3;

/// Safety factor for the original model, whose phi is only nearly convex (m varies from ray to ray): its bounds are
/// estimates from the ends, the middle and this factor, tested on many cameras, not proven.
const BEZIER_ROOM: f64 = 1.25;

/// End of an edge with its forms, cell and phi.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeEnd {
    p: DVec3,
    a: f64,
    b: f64,
    cell: Cell,
    phi: Phi,
}

impl Turn {
    /// End of an edge at `p`; `None` if a value is not finite.
    pub(crate) fn edge_end(&self, p: DVec3) -> Option<EdgeEnd> {
        let cell = self.cell(p).ok()?;
        Some(EdgeEnd { p, a: self.a.at(p), b: self.b.at(p), cell, phi: self.phi(p, cell).ok()? })
    }

    /// Displaced end relative to the eye, see [`Turn::displaced`].
    pub(crate) fn displaced_end(&self, end: &EdgeEnd) -> DVec3 {
        self.displaced_by(end.p, end.cell, end.phi.phi)
    }

    /// Largest `lerp(phi) - phi` along an edge; `None` if it is not known.
    ///
    /// With end slopes `D0 = (phi1 - phi0) - phi'(X0) (X1 - X0)` and `D1` alike, both >= 0 for a convex function:
    /// `delta <= D0 D1 / (D0 + D1)`, the height of the triangle that the end tangents leave.
    pub(crate) fn edge_delta(&self, end0: &EdgeEnd, end1: &EdgeEnd) -> Option<f64> {
        if end0.cell == end1.cell && end0.cell != Cell::Wedge {
            return Some(0.0);
        }
        let (phi0, phi1) = (&end0.phi, &end1.phi);
        let (da, db) = (end1.a - end0.a, end1.b - end0.b);
        let rise = phi1.phi - phi0.phi;
        let d0 = rise - phi0.phi_a * da - phi0.phi_b * db;
        let d1 = phi1.phi_a * da + phi1.phi_b * db - rise;
        let delta = if matches!(self.hinge, Hinge::Bezier { .. }) {
            let middle = end0.p.midpoint(end1.p);
            let sag = 0.5 * (phi0.phi + phi1.phi) - self.phi(middle, self.cell(middle).ok()?).ok()?.phi;
            BEZIER_ROOM * sag.abs().max(0.5 * d0.abs().max(d1.abs()))
        } else {
            let (d0, d1) = (d0.max(0.0), d1.max(0.0));
            if d0 + d1 > 0.0 { d0 * d1 / (d0 + d1) } else { 0.0 }
        };
        delta.is_finite().then_some(delta)
    }

    /// Bound on [`Turn::edge_delta`] of every edge inside a box; `None` where unknown.
    ///
    /// With the gap g of the convex phi over its tangent at the centre: `D0 <= g(X1) + g(2 X0 - X1)`, for g is convex, not negative, and
    /// adding a linear function changes no D. Both points lie in the box of three times the size, where g is largest at a corner; so
    /// `delta <= (D0 + D1) / 4` is at most that.
    pub(crate) fn box_delta(&self, bounds: &Aabb) -> Option<f64> {
        let corners = bounds.corners();
        let first = self.cell(corners[0]).ok()?;
        if first != Cell::Wedge && corners[1..].iter().all(|p| self.cell(*p) == Ok(first)) {
            return Some(0.0);
        }
        let middle = bounds.center();
        let corners = corners.map(|p| middle + 3.0 * (p - middle));
        let values = corners.map(|p| (self.a.at(p), self.b.at(p)));
        if matches!(self.hinge, Hinge::Bezier { .. }) {
            return None;
        }
        let center = self.edge_end(middle)?;
        let gap = |(p, (a, b)): (&DVec3, &(f64, f64))| {
            let tangent = center.phi.phi + center.phi.phi_a * (a - center.a) + center.phi.phi_b * (b - center.b);
            Some(self.phi(*p, self.cell(*p).ok()?).ok()?.phi - tangent)
        };
        let gaps: Option<Vec<f64>> = corners.iter().zip(&values).map(gap).collect();
        gaps.map(|gaps| gaps.into_iter().fold(0.0, f64::max)).filter(|gap| gap.is_finite())
    }

    /// Points whose hull contains the displaced box: its displaced corners, and those moved back along `d_j`.
    fn hull(&self, corners: &[DVec3; 8], center: DVec3) -> Result<[DVec3; 16], Miss> {
        let values = corners.map(|p| (self.a.at(p), self.b.at(p)));
        // phi lies above its tangent at the centre, so lerp(phi) - phi is at most the largest gap there is at a corner.
        let middle = self.phi(center, self.cell(center)?)?;
        let (a, b) = (self.a.at(center), self.b.at(center));
        let (mut above, mut below) = (0.0f64, 0.0f64);
        let mut hull = [DVec3::ZERO; 16];
        for (i, &p) in corners.iter().enumerate() {
            let cell = self.cell(p)?;
            let tangent = middle.phi + middle.phi_a * (values[i].0 - a) + middle.phi_b * (values[i].1 - b);
            let gap = self.phi(p, cell)?.phi - tangent;
            (above, below) = (above.max(gap), below.max(-gap));
            hull[i] = self.displaced(p, cell)?;
        }
        let (back, on) = if matches!(self.hinge, Hinge::Bezier { .. }) {
            (BEZIER_ROOM * (above + below), BEZIER_ROOM * (2.0 * below + 0.1 * above))
        } else {
            (above, 0.0)
        };
        for i in 0..8 {
            hull[8 + i] = hull[i] - back * self.shift;
            hull[i] += on * self.shift;
        }
        Ok(hull)
    }
}

impl CurvedRays {
    /// See [`crate::map::StageMap::edge_bound`]. Infinite if an end has no image, or if no sum of phi holds along the edge.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        let mut bound = 0.0;
        let known = self.edge_shifts(p0, p1, |shift| bound += shift.length());
        if known { bound } else { f64::INFINITY }
    }

    /// Calls `visit(delta_j d_j)` for each turn that bends the edge `p0 p1`: the displaced edge is the straight one minus
    /// a share in 0..=1 of each. `false` if no bound is known.
    pub(crate) fn edge_shifts(&self, p0: DVec3, p1: DVec3, mut visit: impl FnMut(DVec3)) -> bool {
        if self.turns().is_empty() {
            return true;
        }
        let (Ok(hit0), Ok(hit1)) = (self.locate(p0), self.locate(p1)) else { return false };
        if hit0.cell != Cell::Wedge && hit0.segment() == hit1.segment() {
            return true;
        }
        // Beyond a common line a record may continue in another cell than the one that shows the point.
        let drawn = |p: DVec3, hit: &Hit| self.turns()[hit.turn].cell(p) == Ok(hit.cell);
        if !(drawn(p0, &hit0) && drawn(p1, &hit1)) {
            return false;
        }
        if let Some(record) = shared_record(&hit0, &hit1) {
            return self.record_edge_shift(record, p0, p1).map(&mut visit).is_some();
        }
        if !(self.is_sum(p0, &hit0) && self.is_sum(p1, &hit1)) {
            return false;
        }
        let first = hit0.turn.min(hit1.turn);
        let last = hit0.turn.max(hit1.turn);
        (first..=last).all(|record| self.record_edge_shift(record, p0, p1).map(&mut visit).is_some())
    }

    /// `delta d` of the edge drawn with one record; `None` if it is not known.
    pub(crate) fn record_edge_shift(&self, record: usize, p0: DVec3, p1: DVec3) -> Option<DVec3> {
        let Some(turn) = self.turns().get(record) else { return self.turns().is_empty().then_some(DVec3::ZERO) };
        Some(turn.edge_delta(&turn.edge_end(p0)?, &turn.edge_end(p1)?)? * turn.shift)
    }

    /// Whether the point's displacement is the sum of all turns' phi: past each earlier turn, before each later one.
    fn is_sum(&self, p: DVec3, hit: &Hit) -> bool {
        self.turns().iter().enumerate().all(|(index, turn)| match turn.cell(p) {
            Ok(Cell::After) => index <= hit.turn,
            Ok(Cell::Before) => index >= hit.turn,
            Ok(Cell::Wedge) => index == hit.turn,
            Err(_) => false,
        })
    }

    /// See [`crate::map::StageMap::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        if self.turns().is_empty() {
            return Some(*bounds);
        }
        let mut out = Aabb::EMPTY;
        self.displaced_hull(bounds, |v| out = out.including(self.root().eye + v))?;
        let grow = DVec3::splat(1e-12 * (out.max - out.min).length());
        Some(Aabb { min: out.min - grow, max: out.max + grow })
    }

    /// Visits points, relative to the eye, whose hull contains every image of the box; `None` if part of it may have none.
    pub(crate) fn displaced_hull(&self, bounds: &Aabb, mut visit: impl FnMut(DVec3)) -> Option<()> {
        let (corners, center) = (bounds.corners(), bounds.center());
        if bounds.is_empty() || !(bounds.min.is_finite() && bounds.max.is_finite()) {
            return None;
        }
        let mut any = false;
        for (record, turn) in self.turns().iter().enumerate() {
            if !self.may_displace(record, &corners) {
                continue;
            }
            turn.hull(&corners, center).ok()?.into_iter().for_each(&mut visit);
            any = true;
        }
        for segment in (0..self.segments()).step_by(2).filter(|&segment| self.leaves_out(segment, bounds)) {
            if let Some(map) = self.straight_map(segment) {
                corners.iter().for_each(|&p| visit(map.linear * (p - map.viewpoint)));
            }
        }
        any.then_some(())
    }

    /// Points, relative to the eye, whose hull contains the displaced image of the box by one record ([`CurvedRays::displace_in`]);
    /// `None` if part of it may have none.
    pub fn displaced_hull_in(&self, record: usize, bounds: &Aabb) -> Option<[DVec3; 16]> {
        self.turns().get(record)?.hull(&bounds.corners(), bounds.center()).ok()
    }

    /// Whether the record may displace a point of the box: a point of its transition or of the straight part after it; the
    /// first record also a point before its turn.
    fn may_displace(&self, record: usize, corners: &[DVec3; 8]) -> bool {
        let turn = &self.turns()[record];
        if record > 0 && corners.iter().all(|&p| turn.cell(p) == Ok(Cell::Before)) {
            return false;
        }
        let past = |turn: &Turn| corners.iter().all(|&p| matches!(turn.cell(p), Ok(Cell::After)));
        match self.turns().get(record + 1) {
            // The whole box is past this turn and past t0 of the next one.
            Some(next) => !(past(turn) && corners.iter().all(|&p| next.a.at(p) > 0.0)),
            None => true,
        }
    }
}

/// The record that displaces both points, if there is one: a straight part belongs to the records on both its sides.
fn shared_record(hit0: &Hit, hit1: &Hit) -> Option<usize> {
    let (first, last) = if hit0.turn <= hit1.turn { (hit0, hit1) } else { (hit1, hit0) };
    if first.turn == last.turn {
        return Some(first.turn);
    }
    if first.turn + 1 != last.turn {
        return None;
    }
    match (first.cell, last.cell) {
        (Cell::After, _) => Some(last.turn),
        (_, Cell::Before) => Some(first.turn),
        _ => None,
    }
}
