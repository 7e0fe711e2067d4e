//! Looks at every crossing of a part of a line of sight, coarsely and fast, for those whose ground may lie over it.

use super::super::line_of_sight::{SightSample, SightWalk};
use super::super::register::{LANES, indices, load, split, store};
use super::super::{Cells, Field};
use super::Pieces;
use pulp::Simd;

/// A ground whose lines of sight are looked at, as it is now.
pub(super) struct Scan<'a, S: Simd> {
    pub(super) simd: S,
    pub(super) field: &'a Field,
    pub(super) cells: &'a Cells,
    pub(super) pieces: &'a [Pieces],
    /// Height over the datum of the line, less the largest clearance, at the point and at the eye.
    pub(super) height: [f64; 2],
}

/// A crossing with ground that was higher than it may be.
#[derive(Clone, Copy, Default)]
pub(super) struct High {
    /// Line of the grid.
    line: f64,
    /// First node of the edge, and the share of its second one.
    node: u32,
    weight: f64,
    /// Height of the untouched ground, and the highest that it may be, over the datum.
    h: f64,
    limit: f64,
}

/// Of the relief: heights are not known better than this.
const DOUBT: f64 = 1e-9;
/// Crossings so near to the middle of an edge might belong to either end.
const MIDDLE: f64 = 1e-6;

impl<S: Simd> Scan<'_, S> {
    /// Appends the crossings with columns (`FAMILY` 0) or rows (1) between two places of the line whose ground is higher than
    /// `height` allows; and some that are not, by less than rounding.
    #[inline(always)]
    pub(super) fn part<const FAMILY: usize>(
        &self,
        walk: &SightWalk<'_>,
        part: (f64, f64),
        high: &mut Vec<High>,
        out: &mut Vec<SightSample>,
    ) {
        let Some(lines) = walk.lines(FAMILY, part) else { return };
        high.clear();
        let simd = self.simd;
        let [cols, rows] = [self.field.cols(), self.field.rows()];
        // Steps between the nodes of a line, and between lines.
        let [along, across] = if FAMILY == 0 { [cols, 1] } else { [1, cols] };
        let end = (if FAMILY == 0 { rows } else { cols } - 2) as f64;
        let doubt = DOUBT * self.field.relief();
        let rise = simd.splat_f64s(self.height[1] - self.height[0]);
        let (bottom, datum) = (simd.splat_f64s(self.height[0] - doubt), simd.splat_f64s(self.field.datum()));
        let [strides, apart] = [along, across].map(|n| simd.splat_f64s(n as f64));
        let [start, per_line] = [lines.start, lines.per_line].map(|x| simd.splat_f64s(x));
        let [from, dir] = lines.along.map(|x| simd.splat_f64s(x));
        let last = simd.splat_f64s(lines.count as f64 - 1.0);
        let mut nth: S::f64s = load::<S>(&std::array::from_fn(|l| l as f64));
        let [first, sign] = [lines.first, lines.sign].map(|x| simd.splat_f64s(x));
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
            let limit = simd.mul_add_e_f64s(tau, rise, bottom);
            nth = simd.add_f64s(nth, simd.splat_f64s(S::F64_LANES as f64));
            if simd.reduce_max_f64s(simd.sub_f64s(h, limit)) <= 0.0 {
                continue;
            }
            let [line, weight, h, limit] = [line, weight, h, limit].map(store::<S>);
            for l in 0..S::F64_LANES.min(lines.count - at) {
                if h[l] > limit[l] {
                    high.push(High { line: line[l], node: node[l], weight: weight[l], h: h[l], limit: limit[l] });
                }
            }
        }
        for h in high.iter().filter(|h| self.still(h, along)) {
            out.extend(walk.crossing(FAMILY, h.line));
        }
    }

    /// Whether it may still be so after what was done to the ground.
    #[inline(always)]
    fn still(&self, high: &High, along: usize) -> bool {
        let over = |node: usize| {
            let pieces = self.pieces.get(self.cells.labels()[node] as usize);
            pieces.is_some_and(|pieces| pieces.highest(high.h) > high.limit)
        };
        let (first, second) = (high.node as usize, high.node as usize + along);
        over(if high.weight > 0.5 { second } else { first })
            || ((high.weight - 0.5).abs() < MIDDLE && (over(first) || over(second)))
    }
}

/// Both in one order, what is on a line of either family once.
#[inline(always)]
pub(super) fn merge([columns, rows]: [&[SightSample]; 2], out: &mut Vec<SightSample>) {
    let start = out.len();
    let (mut i, mut j) = (0, 0);
    loop {
        let next = match (columns.get(i), rows.get(j)) {
            (Some(a), Some(b)) if b.tau < a.tau => (j += 1, b).1,
            (Some(a), _) => (i += 1, a).1,
            (None, Some(b)) => (j += 1, b).1,
            (None, None) => return,
        };
        if !out[start..].last().is_some_and(|s| s.same_node(next)) {
            out.push(*next);
        }
    }
}
