//! The records of a chain that displace points of a box, and whether they do so as one continuous map.
//!
//! On a separator, and wherever both its neighbours are straight, two consecutive records displace alike. A box in which each separator
//! lies in such a gap, one behind the other, is displaced continuously by the record that every point belongs to: it can be drawn in one pass.

use super::form::LinearForm;
use super::{CurvedRays, Turn};
use crate::Aabb;
use glam::DVec3;
use std::ops::RangeInclusive;

/// The two corners of a box at the ends of each of its edges, numbers as [`Aabb::corners`] has them.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

impl CurvedRays {
    /// Whether part of the box may belong to a record: lies between its separators, see [`CurvedRays::record_margins`].
    pub fn may_hold(&self, record: usize, bounds: &Aabb) -> bool {
        let past = record.checked_sub(1).and_then(|k| self.separator(k)).is_none_or(|y| values(y, bounds)[1] >= 0.0);
        past && self.separator(record).is_none_or(|y| values(y, bounds)[0] <= 0.0)
    }

    /// Whether the whole box belongs to the records of a range, and these displace it as one continuous map, the sum of their phi.
    ///
    /// Sufficient, not necessary. Costs two dozen evaluations per separator.
    pub fn is_continuous(&self, records: RangeInclusive<usize>, bounds: &Aabb) -> bool {
        let (first, last) = (*records.start(), *records.end());
        let held = first.checked_sub(1).and_then(|k| self.separator(k)).is_none_or(|y| values(y, bounds)[0] > 0.0)
            && self.separator(last).is_none_or(|y| values(y, bounds)[1] < 0.0);
        held && (first..last).all(|k| self.parts(k, k + 1 < last, bounds))
    }

    /// Whether, in the box, turn `k` ends before its separator and the next turn begins beyond it; with `and_next` also whether the next
    /// separator lies beyond it.
    fn parts(&self, k: usize, and_next: bool, bounds: &Aabb) -> bool {
        let (Some(cut), [turn, next]) = (self.separator(k), [&self.turns()[k], &self.turns()[k + 1]]) else {
            return false;
        };
        let before = |form: &LinearForm| greatest(form, cut, -1.0, bounds) <= 0.0;
        // h > 0 would mean: beyond the next common line, where its record continues as after the turn.
        let not_begun = |next: &Turn| before(&next.a) && before(&next.h);
        let beyond = |form: &LinearForm, sign: f64| greatest(&form.scaled(sign), cut, 1.0, bounds) <= 0.0;
        not_begun(next)
            && (!and_next || self.separator(k + 1).is_some_and(before))
            && beyond(&turn.b, 1.0)
            && beyond(&turn.a, -1.0)
    }

    /// The record of a range that a point belongs to, in a box where they are continuous: the first whose separator it is not beyond.
    pub fn record_of(&self, records: RangeInclusive<usize>, p: DVec3) -> usize {
        let (mut low, mut high) = records.into_inner();
        while low < high {
            let middle = low.midpoint(high);
            if self.separator(middle).is_some_and(|y| y.at(p) > 0.0) { low = middle + 1 } else { high = middle }
        }
        low
    }
}

/// Least and greatest value of a form in a box.
pub(super) fn values(form: &LinearForm, bounds: &Aabb) -> [f64; 2] {
    let (middle, half) = (form.at(bounds.center()), 0.5 * form.gradient.abs().dot(bounds.max - bounds.min));
    [middle - half, middle + half]
}

/// Greatest value of a form in the part of the box where `side * cut >= 0`; minus infinity if that part is empty.
pub(super) fn greatest(form: &LinearForm, cut: &LinearForm, side: f64, bounds: &Aabb) -> f64 {
    let corners = bounds.corners();
    let (f, s) = (corners.map(|c| form.at(c)), corners.map(|c| side * cut.at(c)));
    let held = (0..8).filter(|&i| s[i] >= 0.0).map(|i| f[i]);
    let crossed = EDGES.iter().filter(|[i, j]| (s[*i] >= 0.0) != (s[*j] >= 0.0)).map(|&[i, j]| {
        let t = s[i] / (s[i] - s[j]);
        f[i] + t * (f[j] - f[i])
    });
    held.chain(crossed).fold(f64::NEG_INFINITY, f64::max)
}
