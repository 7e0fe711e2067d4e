//! Ground under a line of sight in blocks: parts of the line that clear them are passed.

use super::super::register::{LANES, Lane, NTH, indices, load, split, store};
use super::blocks::SIDE;
use super::trace::Sight;
use belvedere_core::DVec2;
use belvedere_sight::SightLine;
use pulp::Simd;

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
    pub(super) fn near<S: Simd>(&self, simd: S, plan: &SightLine<'_>, sight: &Sight, out: &mut Vec<[f64; 2]>) {
        let [t0, t1] = plan.span();
        let line = Line::new(sight, plan.dir(), [t0.max(sight.guard), t1]);
        if line.ends[0] >= t1 {
            return;
        }
        // Slice by slice across the axis along which the line runs faster: there are one or two blocks in each.
        let major = usize::from(line.dir[1].abs() > line.dir[0].abs());
        let last = self.size[major] - 1;
        let sign = line.dir[major].signum();
        let [first, end] = line.ends.map(|t| sign * line.block(major, t, last));
        let mut at = first;
        while at <= end {
            let (over, ends) = self.slices(simd, &line, major, sign * at);
            if simd.reduce_max_f64s(load::<S>(&over)) > 0.0 {
                let count = ((end - at) as usize + 1).min(S::F64_LANES);
                for l in (0..count).filter(|&l| over[l] > 0.0) {
                    let [from, to] = ends.map(|e| e[l]);
                    match out.last_mut() {
                        Some(last) if last[1] >= from => last[1] = to,
                        _ => out.push([from, to]),
                    }
                }
            }
            at += S::F64_LANES as f64;
        }
    }

    /// How far the ground of slices of blocks, from number `first` on, may stand out of a line of sight, a bound; and where
    /// the line comes into them and leaves.
    #[inline(always)]
    fn slices<S: Simd>(&self, simd: S, line: &Line, major: usize, first: f64) -> (Lane, [Lane; 2]) {
        let (minor, sizes) = (1 - major, self.size);
        let steps = if major == 0 { [1.0, self.size[0] as f64] } else { [self.size[0] as f64, 1.0] };
        let side = SIDE as f64;
        let (sign, per_slice) = (line.dir[major].signum(), side / line.dir[major]);
        let nth = load::<S>(&NTH);
        let slice = simd.mul_add_e_f64s(nth, simd.splat_f64s(sign), simd.splat_f64s(first));
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
        let over = store::<S>(simd.sub_f64s(load::<S>(&ceiling), limit));
        // Where it goes up or down through the highest ground of a slice, the part above needs no look.
        let through = simd.mul_f64s(
            simd.sub_f64s(load::<S>(&ceiling), simd.splat_f64s(line.foot)),
            simd.splat_f64s(line.rise.recip()),
        );
        let [t, u] = if line.rise > 0.0 {
            [t, simd.min_f64s(u, through)]
        } else if line.rise < 0.0 {
            [simd.max_f64s(t, through), u]
        } else {
            [t, u]
        };
        (over, [store::<S>(t), store::<S>(u)])
    }
}

/// A line of sight, cells.
struct Line {
    start: [f64; 2],
    dir: [f64; 2],
    /// The part to look at.
    ends: [f64; 2],
    /// See [`Sight::clear`].
    foot: f64,
    rise: f64,
}

impl Line {
    fn new(sight: &Sight, dir: DVec2, ends: [f64; 2]) -> Self {
        let (foot, rise) = sight.clear();
        Self { start: sight.from.to_array(), dir: dir.to_array(), ends, foot, rise }
    }

    /// Column (axis 0) or row of the block at a place of the line; on a border any of both, for both hold the nodes there.
    #[inline(always)]
    fn block(&self, axis: usize, t: f64, last: usize) -> f64 {
        ((self.start[axis] + t * self.dir[axis]) / SIDE as f64).floor().clamp(0.0, last as f64)
    }
}
