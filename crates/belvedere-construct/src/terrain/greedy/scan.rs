//! Looks at crossings of a line of sight, fast, for those whose ground may lie over it.

use super::super::NO_CELL;
use super::super::line_of_sight::{AT_NODE, SightLine};
use super::super::register::{LANES, NTH, indices, load, split, store};
use super::trace::{Lowered, Sight};
use super::{Affine, Blocks, CLEARANCE_GROWS};
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
    pub(super) blocks: &'a Blocks,
    /// Cell of each node.
    pub(super) labels: &'a [u32],
    pub(super) ground: &'a Lowered,
    pub(super) sight: &'a Sight,
    pub(super) line: &'a SightLine<'a>,
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
    ///
    /// * `stretches`: parts of the line to look at, in order.
    #[inline(always)]
    pub(super) fn family<const FAMILY: usize>(&self, stretches: &[[f64; 2]], out: &mut Vec<High>) {
        let (start, dir) = (self.line.from()[FAMILY], self.line.dir()[FAMILY]);
        if dir == 0.0 {
            return;
        }
        // Along the line, whichever way it goes.
        let (sign, last) = (dir.signum(), self.blocks.nodes()[FAMILY] as f64 - 1.0);
        let (mut next, end) = if sign > 0.0 { (0.0, last) } else { (-last, 0.0) };
        let mut record = Record::NONE;
        for [from, to] in stretches {
            let first = (sign * (start + from * dir) - AT_NODE).ceil().max(next);
            let past = (sign * (start + to * dir) + AT_NODE).floor().min(end) + 1.0;
            let mut at = first;
            while at < past {
                self.register::<FAMILY>(sign, [at, past - 1.0], &mut record, out);
                at += S::F64_LANES as f64;
            }
            next = next.max(past);
        }
    }

    /// * `first`, `last`: the lines of the grid, times `sign`; as many as fit are looked at.
    #[inline(always)]
    fn register<const FAMILY: usize>(
        &self,
        sign: f64,
        [first, last]: [f64; 2],
        record: &mut Record,
        out: &mut Vec<High>,
    ) {
        let (simd, sight, other) = (self.simd, self.sight, 1 - FAMILY);
        let (heights, cells) = (self.blocks.heights(), self.ground.cells());
        let nodes = self.blocks.nodes();
        let [along, across] = if FAMILY == 0 { [nodes[0], 1] } else { [1, nodes[0]] };
        let (start, dir) = (self.line.from(), self.line.dir());
        let splat = |x: f64| simd.splat_f64s(x);
        let nth = load::<S>(&NTH);
        let line = simd.mul_f64s(simd.min_f64s(simd.add_f64s(nth, splat(first)), splat(last)), splat(sign));
        let tau = simd.mul_f64s(simd.sub_f64s(line, splat(start[FAMILY])), splat(dir[FAMILY].recip()));
        let place = simd.mul_add_e_f64s(tau, splat(dir[other]), splat(start[other]));
        let (whole, weight) = split(simd, place, nodes[other] as f64 - 2.0);
        let node = simd.mul_add_e_f64s(whole, splat(along as f64), simd.mul_f64s(line, splat(across as f64)));
        let half = splat(0.5);
        let farther = simd.greater_than_f64s(weight, half);
        let near = simd.add_f64s(node, simd.select_f64s(farther, splat(along as f64), splat(0.0)));
        let (node, near) = (indices(simd, node), indices(simd, near));
        let (mut a, mut b, mut scale, mut shift) = ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut cell = [0; LANES];
        for l in 0..S::F64_LANES {
            let node = node[l] as usize;
            (a[l], b[l]) = (f64::from(heights[node]), f64::from(heights[node + along]));
            cell[l] = self.labels[near[l] as usize];
            [scale[l], shift[l]] = cells[(cell[l] as usize).min(cells.len() - 1)];
        }
        let (a, b) = (load::<S>(&a), load::<S>(&b));
        let h = simd.mul_add_e_f64s(weight, simd.sub_f64s(b, a), a);
        let share = simd.min_f64s(simd.mul_f64s(tau, splat(1.0 / CLEARANCE_GROWS)), splat(1.0));
        let rise = splat(sight.height[1] - sight.height[0]);
        let line_of_sight = simd.mul_add_e_f64s(tau, rise, splat(sight.height[0]));
        let limit = simd.sub_f64s(line_of_sight, simd.mul_f64s(splat(sight.clearance), share));
        // Which cell it is does not matter at places in doubt: ground is only ever lowered.
        let aside = simd.abs_f64s(simd.sub_f64s(weight, half));
        let sure = simd.and_m64s(
            simd.greater_than_or_equal_f64s(aside, splat(UNSURE)),
            simd.less_than_or_equal_f64s(aside, splat(0.5 - UNSURE)),
        );
        let lowered = simd.mul_add_e_f64s(load::<S>(&scale), h, load::<S>(&shift));
        let excess = simd.sub_f64s(simd.select_f64s(sure, lowered, h), limit);
        if simd.reduce_max_f64s(excess) < -sight.doubt {
            return;
        }
        let (excess, limit, h, tau) = (store::<S>(excess), store::<S>(limit), store::<S>(h), store::<S>(tau));
        let (aside, line) = (store::<S>(aside), store::<S>(line));
        let count = ((last - first) as usize + 1).min(S::F64_LANES);
        for l in 0..count {
            if excess[l] < -sight.doubt {
                continue;
            }
            let high = High {
                tau: tau[l],
                h: h[l],
                limit: limit[l],
                cell: cell[l],
                family: FAMILY as u8,
                line: line[l] as u32,
            };
            if !(UNSURE..=0.5 - UNSURE).contains(&aside[l]) {
                out.push(High { cell: NO_CELL, ..high });
                continue;
            }
            if record.covers(cell[l], limit[l], excess[l] + 2.0 * sight.doubt) {
                continue;
            }
            let far = if node[l] == near[l] { node[l] as usize + along } else { node[l] as usize };
            if cell[l] == NO_CELL || self.labels[far] == NO_CELL {
                continue;
            }
            let distances = [(1.0 - tau[l] - UNSURE) * sight.rho, (1.0 - tau[l] + UNSURE) * sight.rho];
            let (affine, exact): (Affine, bool) = self.ground.pieces[cell[l] as usize].between(distances);
            let excess = affine.of(h[l]) - limit[l];
            if excess < -sight.doubt {
                continue;
            }
            if !(exact && sight.comparable(&high)) || record.keeps(&high, excess, 2.0 * sight.doubt) {
                out.push(high);
            }
        }
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
