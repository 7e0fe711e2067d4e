//! Single segments of the rays, to draw the points that drawing by records leaves out.
//!
//! A record draws between its separators and, beyond the common line of its turn, continues only one of its two straight parts. Far to the
//! side, rays also reach points on the other side of a separator (rays that turn by a right angle or more), and points beyond the common
//! line on the other straight part (wedges so wide that points before the turn are past t2 as well; rays that cross t0 again far behind the
//! turn). A box with such points is also drawn by the segments concerned. Each segment is one continuous map on the part of space between
//! two planes; a point that is drawn twice has the same image both times.

use super::form::LinearForm;
use super::location::{greatest, values};
use super::phi::Hinge;
use super::turn::Cell;
use super::{CurvedRays, Turn, segment};
use crate::{Aabb, Displaced, Miss};
use glam::{DMat3, DVec3};

/// A straight part of the chain as an affine map: a point `p` is displaced to `eye + linear (p - viewpoint)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightMap {
    /// Viewpoint of the part, scene coordinates.
    pub viewpoint: DVec3,
    /// Linear part.
    pub linear: DMat3,
}

/// A segment with the turns beside it.
enum Segment<'a> {
    /// Between the turn before and the turn after it.
    Straight(Option<&'a Turn>, Option<&'a Turn>),
    /// The bent piece of a turn.
    Transition(&'a Turn),
}

impl CurvedRays {
    /// Number of segments, see [`Displaced::segment`].
    pub fn segments(&self) -> u32 {
        segment(self.turns.len(), Cell::Before) + 1
    }

    /// The segment of a number; `None` if there is no such segment.
    fn segment(&self, number: u32) -> Option<Segment<'_>> {
        let k = number as usize / 2;
        if number % 2 == 1 {
            return self.turns.get(k).map(Segment::Transition);
        }
        let before = k.checked_sub(1).and_then(|k| self.turns.get(k));
        (k <= self.turns.len()).then(|| Segment::Straight(before, self.turns.get(k)))
    }

    /// The map of a straight part; `None` if the number is that of a transition, or too large.
    pub fn straight_map(&self, number: u32) -> Option<StraightMap> {
        match self.segment(number)? {
            Segment::Straight(Some(turn), _) => Some(StraightMap { viewpoint: turn.viewpoint, linear: turn.after }),
            Segment::Straight(None, _) => Some(StraightMap { viewpoint: self.root.eye, linear: DMat3::IDENTITY }),
            Segment::Transition(_) => None,
        }
    }

    /// Displacement by a segment alone, wherever the point is; a transition is continued by its record ([`CurvedRays::displace_in`]).
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] if there is no such segment, or for numbers that are not finite.
    pub fn displace_along(&self, number: u32, p: DVec3) -> Result<Displaced, Miss> {
        let Some(map) = self.straight_map(number) else { return self.displace_in(number as usize / 2, p) };
        let point = if number == 0 { p } else { self.root.eye + map.linear * (p - map.viewpoint) };
        let displaced = Displaced { point, segment: number, folded: false };
        if point.is_finite() { Ok(displaced) } else { Err(Miss::OutsideDomain) }
    }

    /// The planes between which a segment lies: forms of unit gradient that are not negative on it; `None` where it has no end.
    pub fn segment_planes(&self, number: u32) -> [Option<LinearForm>; 2] {
        let unit = |form: &LinearForm, sign: f64| form.scaled(sign / form.gradient.length());
        match self.segment(number) {
            Some(Segment::Straight(before, next)) => {
                [before.map(|turn| unit(&turn.b, -1.0)), next.map(|turn| unit(&turn.a, -1.0))]
            }
            Some(Segment::Transition(turn)) => [Some(unit(&turn.a, 1.0)), Some(unit(&turn.b, 1.0))],
            None => [None, None],
        }
    }

    /// Whether a box may hold points of a segment that no record draws as such.
    ///
    /// Conservative: `true` may be wrong, for the test takes the box as a whole and ignores the image; `false` is certain.
    pub fn leaves_out(&self, number: u32, bounds: &Aabb) -> bool {
        let k = number as usize / 2;
        let lower = |k: usize| k.checked_sub(1).and_then(|k| self.separator(k));
        match self.segment(number) {
            Some(Segment::Transition(turn)) => {
                let part = [(&turn.a, 1.0), (&turn.b, 1.0)];
                let past = |y: &LinearForm, sign: f64| reaches(y, sign, &part, bounds);
                turn.hinge != Hinge::Broken
                    && part.iter().all(|(form, _)| values(form, bounds)[1] > 0.0)
                    && (lower(k).is_some_and(|y| past(y, -1.0)) || self.separator(k).is_some_and(|y| past(y, 1.0)))
            }
            Some(Segment::Straight(before, next)) => {
                let planes = [before.map(|turn| (&turn.b, -1.0)), next.map(|turn| (&turn.a, -1.0))];
                if planes.iter().flatten().any(|(form, _)| values(form, bounds)[0] > 0.0) {
                    return false;
                }
                // The record of the turn before draws up to the separator, the next one from there on.
                let cut = lower(k);
                let part = |side: f64| planes.into_iter().flatten().chain(cut.map(|y| (y, side))).collect::<Vec<_>>();
                let by_last = before.is_some_and(|turn| {
                    let part = part(-1.0);
                    let before_it = k.checked_sub(1).and_then(lower);
                    reaches(&turn.h, -1.0, &part, bounds) || before_it.is_some_and(|y| reaches(y, -1.0, &part, bounds))
                });
                by_last
                    || next.is_some_and(|turn| {
                        let part = part(1.0);
                        let beyond_it = self.separator(k);
                        reaches(&turn.h, 1.0, &part, bounds)
                            || beyond_it.is_some_and(|y| reaches(y, 1.0, &part, bounds))
                    })
            }
            None => false,
        }
    }
}

/// Whether `sign * form` may be positive in the part of a box in which all `side * cut` are not negative.
fn reaches(form: &LinearForm, sign: f64, part: &[(&LinearForm, f64)], bounds: &Aabb) -> bool {
    let [low, high] = values(form, bounds);
    let most = if sign > 0.0 { high } else { -low };
    most > 0.0 && part.iter().all(|&(cut, side)| greatest(&form.scaled(sign), cut, side, bounds) > 0.0)
}
