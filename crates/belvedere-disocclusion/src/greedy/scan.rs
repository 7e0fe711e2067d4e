//! Looks at crossings of a line of sight, fast, for those whose ground may lie over it.

use super::super::NO_CELL;
use super::super::register::{load_from, store};
use super::gather::Crossings;
use super::trace::{Lowered, Sight};
use super::{CLEARANCE_GROWS, Pieces};
use pulp::Simd;

/// A crossing whose ground may lie over the line of sight.
///
/// Heights are over the datum, and known to within [`Sight::doubt`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct High {
    pub(super) tau: f64,
    /// Height of the untouched ground, and the highest that it may be.
    pub(super) h: f64,
    pub(super) limit: f64,
    /// Cell of the nearer node; [`NO_CELL`] where rounding decides which one that is, or whether there is ground.
    pub(super) cell: u32,
    /// Column of the grid that is crossed (family 0), or row (1).
    pub(super) family: u8,
    pub(super) line: u32,
}

/// Weights so near to a node or to the middle of an edge might belong to either side.
pub(super) const UNSURE: f64 = 1e-6;

/// A line of sight over a ground as it is now.
pub(super) struct Scan<'a, S: Simd> {
    pub(super) simd: S,
    pub(super) ground: &'a Lowered,
    pub(super) sight: &'a Sight,
}

/// The crossing that stands out most of those that were kept last.
#[derive(Clone, Copy)]
struct Record {
    cell: u32,
    excess: f64,
    limit: f64,
}

impl<S: Simd> Scan<'_, S> {
    /// Appends the crossings with columns (family 0) or rows (1), in order, whose ground is higher than it may be.
    ///
    /// Left out is what another one of the same cell, nearer to the point, makes needless: that one stands out more and the
    /// line is lower there, and so it will be after any scaling and displacement of the cell, of which ground nearer to the eye
    /// always gets all that ground farther away gets. Where it is cleared both are.
    #[inline(always)]
    pub(super) fn family<const FAMILY: usize>(&self, crossings: &Crossings, out: &mut Vec<High>) {
        let mut record = Record::NONE;
        for first in (0..crossings.len()).step_by(S::F64_LANES) {
            self.register::<FAMILY>(crossings, first, &mut record, out);
        }
    }

    /// Judges as many crossings as a register holds.
    #[inline(always)]
    fn register<const FAMILY: usize>(&self, of: &Crossings, first: usize, record: &mut Record, out: &mut Vec<High>) {
        let (simd, sight) = (self.simd, self.sight);
        let splat = |x: f64| simd.splat_f64s(x);
        let lane = |numbers: &[f64]| load_from::<S>(&numbers[first..]);
        let [a, b] = [lane(&of.heights[0]), lane(&of.heights[1])];
        let (tau, weight) = (lane(&of.tau), lane(&of.weight));
        let h = simd.mul_add_e_f64s(weight, simd.sub_f64s(b, a), a);
        let share = simd.min_f64s(simd.mul_f64s(tau, splat(1.0 / CLEARANCE_GROWS)), splat(1.0));
        let rise = splat(sight.height[1] - sight.height[0]);
        let line_of_sight = simd.mul_add_e_f64s(tau, rise, splat(sight.height[0]));
        let limit = simd.sub_f64s(line_of_sight, simd.mul_f64s(splat(sight.clearance), share));
        // Which cell it is does not matter at places in doubt: ground is only ever lowered.
        let aside = simd.abs_f64s(simd.sub_f64s(weight, splat(0.5)));
        let sure = simd.and_m64s(
            simd.greater_than_or_equal_f64s(aside, splat(UNSURE)),
            simd.less_than_or_equal_f64s(aside, splat(0.5 - UNSURE)),
        );
        let lowered = simd.mul_add_e_f64s(lane(&of.scale), h, lane(&of.shift));
        let excess = simd.sub_f64s(simd.select_f64s(sure, lowered, h), limit);
        if simd.reduce_max_f64s(excess) < -sight.doubt {
            return;
        }
        let (excess, limit, h) = (store::<S>(excess), store::<S>(limit), store::<S>(h));
        for l in 0..(of.len() - first).min(S::F64_LANES) {
            if excess[l] < -sight.doubt {
                continue;
            }
            let i = first + l;
            let [cell, far] = [of.cells[0][i], of.cells[1][i]];
            let high =
                High { tau: of.tau[i], h: h[l], limit: limit[l], cell, family: FAMILY as u8, line: of.line[i] as u32 };
            if !(UNSURE..=0.5 - UNSURE).contains(&(of.weight[i] - 0.5).abs()) {
                out.push(High { cell: NO_CELL, ..high });
                continue;
            }
            if record.covers(cell, limit[l], excess[l] + 2.0 * sight.doubt) {
                continue;
            }
            // Where an end is void there is no ground.
            let (Some(pieces), Some(_)) = (self.pieces(cell), self.pieces(far)) else { continue };
            let distances = [(1.0 - high.tau - UNSURE) * sight.rho, (1.0 - high.tau + UNSURE) * sight.rho];
            let (affine, exact) = pieces.between(distances);
            let excess = affine.of(high.h) - high.limit;
            if excess < -sight.doubt {
                continue;
            }
            if !(exact && sight.comparable(&high)) || record.keeps(&high, excess, 2.0 * sight.doubt) {
                out.push(high);
            }
        }
    }

    /// What is done to a cell; `None` for none.
    #[inline(always)]
    fn pieces(&self, cell: u32) -> Option<&Pieces> {
        self.ground.pieces.get(cell as usize)
    }
}

impl Record {
    const NONE: Self = Self { cell: NO_CELL, excess: f64::NEG_INFINITY, limit: f64::INFINITY };

    /// Whether a crossing that stands out no more than `most` is needless beside this one.
    #[inline(always)]
    fn covers(&self, cell: u32, limit: f64, most: f64) -> bool {
        cell == self.cell && limit >= self.limit && most < self.excess
    }

    /// Whether a crossing is needed beside this one; `doubt`: of differences.
    #[inline(always)]
    fn keeps(&mut self, high: &High, excess: f64, doubt: f64) -> bool {
        if self.covers(high.cell, high.limit, excess + doubt) {
            return false;
        }
        if high.cell != self.cell || excess > self.excess {
            *self = Self { cell: high.cell, excess, limit: high.limit };
        }
        true
    }
}

/// Appends both in one order.
#[inline(always)]
pub(super) fn merge([columns, rows]: &[Vec<High>; 2], out: &mut Vec<High>) {
    let (mut i, mut j) = (0, 0);
    loop {
        let next = match (columns.get(i), rows.get(j)) {
            (Some(a), Some(b)) if b.tau < a.tau => (j += 1, b).1,
            (Some(a), _) => (i += 1, a).1,
            (None, Some(b)) => (j += 1, b).1,
            (None, None) => return,
        };
        out.push(*next);
    }
}
