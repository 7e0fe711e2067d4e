//! Blocks of ground under a line of sight: those that it clears are passed.

use super::super::line_of_sight::{AT_NODE, SightWalk};
use super::super::register::{LANES, Lane, indices, load, split, store};
use super::blocks::SIDE;
use super::trace::Sight;
use belvedere_core::DVec2;
use pulp::Simd;

/// The part of a line of sight over a block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Over {
    pub(super) block: usize,
    /// Column and row of its north-west corner.
    pub(super) corner: [f64; 2],
    /// First column (row) of the grid that is crossed, and how many.
    pub(super) lines: [(f64, usize); 2],
    pub(super) span: [f64; 2],
}

/// Blocks, and how high each may be.
pub(super) struct Under<'a> {
    /// Blocks along both axes.
    pub(super) size: [usize; 2],
    /// A bound of the highest ground of each, over the datum.
    pub(super) ceilings: &'a [f32],
}

impl Under<'_> {
    /// The parts of a line of sight, from where its point's own ground ends, over blocks that may be higher than it, in order.
    #[inline(always)]
    pub(super) fn near<S: Simd>(&self, simd: S, walk: &SightWalk<'_>, sight: &Sight, out: &mut Vec<Over>) {
        let (t0, t1) = walk.span();
        let line = Line::new(sight, walk.dir(), [t0.max(sight.guard), t1]);
        if line.ends[0] >= t1 {
            return;
        }
        // Slice by slice across the axis along which the line runs faster: there are one or two blocks in each.
        let major = usize::from(line.dir[1].abs() > line.dir[0].abs());
        let sizes = self.size;
        let [first, last] = line.ends.map(|t| line.block(major, t, sizes[major]));
        let count = first.abs_diff(last) + 1;
        let slice = |i: usize| if line.dir[major] > 0.0 { first + i } else { first - i };
        for at in (0..count).step_by(S::F64_LANES) {
            let over = self.over_slices(simd, &line, major, slice(at));
            for i in (at..count.min(at + S::F64_LANES)).filter(|i| over[i - at] > 0.0) {
                let from = if i == 0 { (line.ends[0], None) } else { (line.border(major, slice(i - 1)), Some(major)) };
                let to = if i + 1 == count { (t1, None) } else { (line.border(major, slice(i)), Some(major)) };
                self.slice(&line, major, slice(i), [from, to], out);
            }
        }
    }

    /// How far the ground of slices of blocks, from number `first` on, may stand out of a line of sight; a bound.
    #[inline(always)]
    fn over_slices<S: Simd>(&self, simd: S, line: &Line, major: usize, first: usize) -> Lane {
        let (minor, sizes) = (1 - major, self.size);
        let steps = if major == 0 { [1.0, self.size[0] as f64] } else { [self.size[0] as f64, 1.0] };
        let side = SIDE as f64;
        let (sign, per_slice) = (line.dir[major].signum(), side / line.dir[major]);
        let nth = load::<S>(&std::array::from_fn(|l| l as f64));
        let slice = simd.mul_add_e_f64s(nth, simd.splat_f64s(sign), simd.splat_f64s(first as f64));
        // Where the line comes in and leaves. No closures: they would not be compiled for the registers.
        let behind = if sign > 0.0 { 0.0 } else { 1.0 } - line.start[major] / side;
        let entry = simd.mul_f64s(simd.add_f64s(slice, simd.splat_f64s(behind)), simd.splat_f64s(per_slice));
        let exit = simd.add_f64s(entry, simd.splat_f64s(per_slice.abs()));
        let [begin, end] = [simd.splat_f64s(line.ends[0]), simd.splat_f64s(line.ends[1])];
        let t = simd.min_f64s(simd.max_f64s(entry, begin), end);
        let u = simd.min_f64s(simd.max_f64s(exit, begin), end);
        let (start, dir) = (simd.splat_f64s(line.start[minor] / side), simd.splat_f64s(line.dir[minor] / side));
        let (x, y) = (simd.mul_add_e_f64s(t, dir, start), simd.mul_add_e_f64s(u, dir, start));
        // Two at most: what rounding makes a third, or the wrong one, is touched on a border, whose nodes both blocks hold.
        let last = (sizes[minor] - 1) as f64;
        let (low, _) = split(simd, simd.min_f64s(x, y), last);
        let (high, _) = split(simd, simd.max_f64s(x, y), last);
        let high = simd.min_f64s(high, simd.add_f64s(low, simd.splat_f64s(1.0)));
        let most = simd.splat_f64s((sizes[major] - 1) as f64);
        let slice = simd.max_f64s(simd.min_f64s(slice, most), simd.splat_f64s(0.0));
        let (row, step) = (simd.mul_f64s(slice, simd.splat_f64s(steps[0])), simd.splat_f64s(steps[1]));
        let low = indices(simd, simd.mul_add_e_f64s(low, step, row));
        let high = indices(simd, simd.mul_add_e_f64s(high, step, row));
        let mut ceiling = [0.0; LANES];
        for l in 0..S::F64_LANES {
            let (a, b) = (self.ceilings[low[l] as usize], self.ceilings[high[l] as usize]);
            ceiling[l] = f64::from(if a > b { a } else { b });
        }
        let lowest = if line.rise < 0.0 { u } else { t };
        let limit = simd.mul_add_e_f64s(lowest, simd.splat_f64s(line.rise), simd.splat_f64s(line.foot));
        store::<S>(simd.sub_f64s(load::<S>(&ceiling), limit))
    }

    /// The parts of a line over the blocks of one slice.
    ///
    /// * `ends`: where it comes into the slice and leaves it, and the axis of the border there.
    #[inline(always)]
    fn slice(
        &self,
        line: &Line,
        major: usize,
        slice: usize,
        [from, to]: [(f64, Option<usize>); 2],
        out: &mut Vec<Over>,
    ) {
        let (minor, sizes) = (1 - major, self.size);
        let [mut within, last] = [from.0, to.0].map(|t| line.block(minor, t, sizes[minor]));
        let (mut t, mut entered) = from;
        loop {
            let here = within;
            let (exit, left) = if here == last { to } else { (line.border(minor, here).min(to.0), Some(minor)) };
            let place = if major == 0 { [slice, here] } else { [here, slice] };
            let block = place[1] * self.size[0] + place[0];
            // The lower end of the line over a block is that nearer to the point if it rises.
            let limit = line.foot + if line.rise < 0.0 { exit } else { t } * line.rise;
            if f64::from(self.ceilings[block]) > limit {
                out.push(line.over(block, place, [t, exit], [entered, left]));
            }
            if here == last {
                return;
            }
            within = if line.dir[minor] > 0.0 { here + 1 } else { here - 1 };
            (t, entered) = (exit, left);
        }
    }
}

/// A line of sight, cells.
struct Line {
    start: [f64; 2],
    dir: [f64; 2],
    /// One over that.
    per_cell: [f64; 2],
    /// The part to look at.
    ends: [f64; 2],
    /// See [`Sight::clear`].
    foot: f64,
    rise: f64,
}

impl Line {
    fn new(sight: &Sight, dir: DVec2, ends: [f64; 2]) -> Self {
        let (foot, rise) = sight.clear();
        Self { start: sight.from.to_array(), dir: dir.to_array(), per_cell: dir.recip().to_array(), ends, foot, rise }
    }

    /// Column (axis 0) or row of the block at a place of the line.
    #[inline(always)]
    fn block(&self, axis: usize, t: f64, count: usize) -> usize {
        let at = (self.start[axis] + t * self.dir[axis]) / SIDE as f64;
        let k = at as usize;
        // On a border it is the block ahead that counts; the one behind holds the same nodes there.
        let behind = self.dir[axis] < 0.0 && k as f64 == at && k > 0;
        (k - usize::from(behind)).min(count - 1)
    }

    /// Where the line leaves a column or row of blocks.
    #[inline(always)]
    fn border(&self, axis: usize, k: usize) -> f64 {
        ((k + usize::from(self.dir[axis] > 0.0)) as f64 * SIDE as f64 - self.start[axis]) * self.per_cell[axis]
    }

    /// * `ends`: the axes of the borders through which the line comes and leaves; `None` where it begins or ends.
    #[inline(always)]
    fn over(&self, block: usize, place: [usize; 2], span: [f64; 2], ends: [Option<usize>; 2]) -> Over {
        let columns = lines([self.start[0], self.dir[0]], place[0], span, ends.map(|e| e.map(|e| e == 0)));
        let rows = lines([self.start[1], self.dir[1]], place[1], span, ends.map(|e| e.map(|e| e == 1)));
        Over { block, corner: place.map(|k| (k * SIDE) as f64), lines: [columns, rows], span }
    }
}

/// Columns (or rows) of the grid that a line of sight crosses over a block: the first one, and how many. Those on a border
/// belong to the block behind it, so that neighbouring parts of a line share none and leave out none.
///
/// * `start`, `dir`: the line, cells; `place`: of the block; `span`: the part of the line;
/// * `ends`: whether it comes and leaves through borders of this family; `None` where the line begins or ends.
#[inline(always)]
fn lines([start, dir]: [f64; 2], place: usize, span: [f64; 2], [entered, left]: [Option<bool>; 2]) -> (f64, usize) {
    if dir == 0.0 {
        return (0.0, 0);
    }
    let sign = dir.signum();
    let side = SIDE as f64;
    // Along the line, whichever way it goes.
    let behind = if dir > 0.0 { place as f64 } else { -((place + 1) as f64) } * side;
    let ahead = behind + side;
    let [from, to] = span.map(|t| sign * (start + t * dir));
    let first = match entered {
        Some(true) => behind,
        Some(false) => from.ceil().clamp(behind, ahead),
        None => (from - AT_NODE).ceil().clamp(behind, ahead),
    };
    let end = match left {
        Some(true) => ahead,
        Some(false) => to.ceil().clamp(behind, ahead),
        None => ((to + AT_NODE).floor() + 1.0).clamp(behind, ahead + 1.0),
    };
    (sign * first, (end - first).max(0.0) as usize)
}
