//! Looks at every crossing of a line of sight, fast, for those whose ground may lie over it.

use super::super::line_of_sight::SightWalk;
use super::super::register::{LANES, Lane, indices, load, split, store};
use super::super::{Cells, Field, NO_CELL};
use super::trace::Sight;
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
    pub(super) field: &'a Field,
    pub(super) cells: &'a Cells,
    pub(super) pieces: &'a [Pieces],
    pub(super) sight: &'a Sight,
}

/// Crossings abreast, as the numbers of a register.
struct Abreast {
    line: Lane,
    tau: Lane,
    h: Lane,
    limit: Lane,
    weight: Lane,
    node: [u32; LANES],
}

/// The crossing that stands out most of those that were kept last.
struct Record {
    cell: u32,
    excess: f64,
    limit: f64,
}

impl<S: Simd> Scan<'_, S> {
    /// Appends the crossings with columns (`FAMILY` 0) or rows (1) between two places of the line, in order, whose ground is
    /// higher than it may be.
    ///
    /// Left out is what another one of the same cell, nearer to the point, makes needless: that one stands out more and the
    /// line is lower there, and so it will be after any scaling and displacement of the cell. Where it is cleared both are.
    #[inline(always)]
    pub(super) fn part<const FAMILY: usize>(&self, walk: &SightWalk<'_>, part: (f64, f64), out: &mut Vec<High>) {
        let Some(lines) = walk.lines(FAMILY, part) else { return };
        let (simd, sight) = (self.simd, self.sight);
        let [cols, rows] = [self.field.cols(), self.field.rows()];
        // Steps between the nodes of a line, and between lines.
        let [along, across] = if FAMILY == 0 { [cols, 1] } else { [1, cols] };
        let end = (if FAMILY == 0 { rows } else { cols } - 2) as f64;
        let splat = |x: f64| simd.splat_f64s(x);
        let (foot, rise) = (splat(sight.height[0]), splat(sight.height[1] - sight.height[0]));
        let (clearance, grows) = (splat(sight.clearance), splat(1.0 / CLEARANCE_GROWS));
        let (datum, doubt) = (splat(self.field.datum()), sight.doubt);
        let [strides, apart] = [along, across].map(|n| splat(n as f64));
        let [start, per_line] = [lines.start, lines.per_line].map(splat);
        let [from, dir] = lines.along.map(splat);
        let [first, sign, last] = [lines.first, lines.sign, lines.count as f64 - 1.0].map(splat);
        let mut nth: S::f64s = load::<S>(&std::array::from_fn(|l| l as f64));
        let mut record = Record { cell: NO_CELL, excess: f64::NEG_INFINITY, limit: f64::INFINITY };
        for at in (0..lines.count).step_by(S::F64_LANES) {
            let line = simd.mul_add_e_f64s(simd.min_f64s(nth, last), sign, first);
            let tau = simd.mul_f64s(simd.sub_f64s(line, start), per_line);
            let (whole, weight) = split(simd, simd.mul_add_e_f64s(tau, dir, from), end);
            let node = indices(simd, simd.mul_add_e_f64s(whole, strides, simd.mul_f64s(line, apart)));
            let (mut a, mut b) = ([0.0; LANES], [0.0; LANES]);
            for l in 0..S::F64_LANES {
                let node = node[l] as usize;
                (a[l], b[l]) = (self.field.heights()[node], self.field.heights()[node + along]);
            }
            let (a, b) = (load::<S>(&a), load::<S>(&b));
            let h = simd.sub_f64s(simd.mul_add_e_f64s(weight, simd.sub_f64s(b, a), a), datum);
            let share = simd.min_f64s(simd.mul_f64s(tau, grows), splat(1.0));
            let limit = simd.sub_f64s(simd.mul_add_e_f64s(tau, rise, foot), simd.mul_f64s(clearance, share));
            nth = simd.add_f64s(nth, splat(S::F64_LANES as f64));
            if simd.reduce_max_f64s(simd.sub_f64s(h, limit)) < -doubt {
                continue;
            }
            let [line, tau, h, limit, weight] = [line, tau, h, limit, weight].map(store::<S>);
            let abreast = Abreast { line, tau, h, limit, weight, node };
            for l in 0..S::F64_LANES.min(lines.count - at) {
                out.extend(self.high::<FAMILY>(&abreast, l, along, &mut record));
            }
        }
    }

    #[inline(always)]
    fn high<const FAMILY: usize>(
        &self,
        abreast: &Abreast,
        l: usize,
        along: usize,
        record: &mut Record,
    ) -> Option<High> {
        let (h, limit, tau, weight) = (abreast.h[l], abreast.limit[l], abreast.tau[l], abreast.weight[l]);
        let doubt = self.sight.doubt;
        if h < limit - doubt {
            return None;
        }
        let mut high = High { tau, h, limit, cell: NO_CELL, family: FAMILY as u8, line: abreast.line[l] as u32 };
        let off = (weight - 0.5).abs();
        if !(UNSURE..=0.5 - UNSURE).contains(&off) {
            return Some(high);
        }
        let node = abreast.node[l] as usize;
        let [near, far] = if weight > 0.5 { [node + along, node] } else { [node, node + along] };
        high.cell = self.cells.labels()[near];
        // No ground there; it must not stand for what is.
        if self.cells.labels()[far] == NO_CELL {
            return None;
        }
        let pieces = self.pieces.get(high.cell as usize)?;
        let excess = pieces.highest(h) - limit;
        if excess < -doubt {
            return None;
        }
        // Where rings differ nothing is left out.
        if pieces.alike() && self.sight.comparable(&high) {
            if high.cell == record.cell && limit >= record.limit && excess + 2.0 * doubt < record.excess {
                return None;
            }
            if high.cell != record.cell || excess > record.excess {
                *record = Record { cell: high.cell, excess, limit };
            }
        }
        Some(high)
    }
}

/// Appends both in one order.
#[inline(always)]
pub(super) fn merge([columns, rows]: [&[High]; 2], out: &mut Vec<High>) {
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
