//! Looks at every crossing of a line of sight, fast, for those whose ground may lie over it.

use super::super::NO_CELL;
use super::super::line_of_sight::SightWalk;
use super::super::register::{LANES, indices, load, split, store};
use super::blocks::{ALONG, NO_PART, SIDE, Tile};
use super::trace::{Lowered, Sight};
use super::under::Over;
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
    pub(super) ground: &'a Lowered,
    pub(super) sight: &'a Sight,
    pub(super) walk: &'a SightWalk<'a>,
}

/// What is done to a part of a block where the line of sight is over it.
#[derive(Clone, Copy)]
pub(super) struct Done {
    cell: u32,
    /// A bound of it,
    affine: Affine,
    /// and whether it is just that.
    exact: bool,
}

/// At places in doubt: which cell it is does not matter, for ground is only ever lowered.
const IN_DOUBT: Done = Done { cell: NO_CELL, affine: Affine::IDENTITY, exact: false };

/// The crossing that stands out most of those that were kept last.
struct Record {
    cell: u32,
    excess: f64,
    limit: f64,
}

impl<S: Simd> Scan<'_, S> {
    /// Appends the crossings with columns and those with rows, in order, whose ground is higher than it may be.
    ///
    /// Left out is what another one of the same cell, nearer to the point, makes needless: that one stands out more and the
    /// line is lower there, and so it will be after any scaling and displacement of the cell, of which ground nearer to the eye
    /// always gets all that ground farther away gets. Where it is cleared both are.
    #[inline(always)]
    pub(super) fn blocks(&self, over: &[Over], done: &mut Vec<Done>, [columns, rows]: &mut [Vec<High>; 2]) {
        let mut records = [Record::NONE; 2];
        for over in over {
            let tile = self.blocks.tile(over.block);
            let Some(bound) = self.parts(over, tile, done) else { continue };
            let [of_columns, of_rows] = &mut records;
            self.block::<0>(over, tile, (bound, done), of_columns, columns);
            self.block::<1>(over, tile, (bound, done), of_rows, rows);
        }
    }

    /// What is done to the parts of a block, and to those at most that the line of sight does not clear; `None` if there are
    /// none of them.
    #[inline(always)]
    fn parts(&self, over: &Over, tile: &Tile, done: &mut Vec<Done>) -> Option<Affine> {
        let (sight, start, dir) = (self.sight, self.walk.from(), self.walk.dir());
        let [t, u] = over.span;
        let slant =
            |t: f64| tile.highest_at([start.x + t * dir.x - over.corner[0], start.y + t * dir.y - over.corner[1]]);
        let (foot, rise) = sight.clear();
        let (slant, line) = ([slant(t), slant(u)], [foot + t * rise, foot + u * rise]);
        let lowest = if rise < 0.0 { line[1] } else { line[0] };
        let distances = [(1.0 - u - UNSURE) * sight.rho, (1.0 - t + UNSURE) * sight.rho];
        let mut most = None;
        done.clear();
        for part in &self.blocks.all_parts()[self.blocks.numbers(over.block)] {
            let (affine, exact) = self.ground.pieces[part.cell as usize].between(distances);
            done.push(Done { cell: part.cell, affine, exact });
            // Slants and lines of sight are straight: the ends decide.
            let below = affine.of(slant[0]) < line[0] && affine.of(slant[1]) < line[1];
            if !below && affine.of(f64::from(part.highest)) >= lowest {
                most = Some(most.map_or(affine, |most: Affine| most.larger(&affine)));
            }
        }
        most
    }

    /// * `bound`: what is not cleared is nowhere higher than this makes it.
    #[inline(always)]
    fn block<const FAMILY: usize>(
        &self,
        over: &Over,
        tile: &Tile,
        (bound, done): (Affine, &[Done]),
        record: &mut Record,
        out: &mut Vec<High>,
    ) {
        let (simd, sight) = (self.simd, self.sight);
        // Steps between the nodes of a line, and between lines.
        let [along, across] = if FAMILY == 0 { [ALONG, 1] } else { [1, ALONG] };
        let (start, dir) = (self.walk.from(), self.walk.dir());
        let (first, count) = over.lines[FAMILY];
        let splat = |x: f64| simd.splat_f64s(x);
        let (foot, rise) = (splat(sight.height[0]), splat(sight.height[1] - sight.height[0]));
        let (clearance, grows) = (splat(sight.clearance), splat(1.0 / CLEARANCE_GROWS));
        let [strides, apart] = [along, across].map(|n| splat(n as f64));
        let [per_line, from, dir_along] =
            [dir[FAMILY].recip(), start[1 - FAMILY] - over.corner[1 - FAMILY], dir[1 - FAMILY]].map(splat);
        let [start, corner] = [start[FAMILY], over.corner[FAMILY]].map(splat);
        let [first, sign, last] = [first, dir[FAMILY].signum(), count as f64 - 1.0].map(splat);
        let mut nth: S::f64s = load::<S>(&std::array::from_fn(|l| l as f64));
        for at in (0..count).step_by(S::F64_LANES) {
            let line = simd.mul_add_e_f64s(simd.min_f64s(nth, last), sign, first);
            nth = simd.add_f64s(nth, splat(S::F64_LANES as f64));
            let tau = simd.mul_f64s(simd.sub_f64s(line, start), per_line);
            let (whole, weight) = split(simd, simd.mul_add_e_f64s(tau, dir_along, from), (SIDE - 1) as f64);
            let nearest_line = simd.mul_f64s(simd.sub_f64s(line, corner), apart);
            let node = indices(simd, simd.mul_add_e_f64s(whole, strides, nearest_line));
            let (mut a, mut b) = ([0.0; LANES], [0.0; LANES]);
            for l in 0..S::F64_LANES {
                let node = node[l] as usize;
                (a[l], b[l]) = (f64::from(tile.heights[node]), f64::from(tile.heights[node + along]));
            }
            let (a, b) = (load::<S>(&a), load::<S>(&b));
            let h = simd.mul_add_e_f64s(weight, simd.sub_f64s(b, a), a);
            let share = simd.min_f64s(simd.mul_f64s(tau, grows), splat(1.0));
            let limit = simd.sub_f64s(simd.mul_add_e_f64s(tau, rise, foot), simd.mul_f64s(clearance, share));
            let most = simd.sub_f64s(simd.mul_add_e_f64s(splat(bound.scale), h, splat(bound.shift)), limit);
            if simd.reduce_max_f64s(most) < -sight.doubt {
                continue;
            }
            let (line, tau, weight) = (store::<S>(line), store::<S>(tau), store::<S>(weight));
            let (h, limit, most) = (store::<S>(h), store::<S>(limit), store::<S>(most));
            for l in 0..S::F64_LANES.min(count - at) {
                if most[l] < -sight.doubt {
                    continue;
                }
                let of = if tile.mixed {
                    let nodes = [node[l] as usize, node[l] as usize + along];
                    match which(done, &tile.part_of, nodes, weight[l]) {
                        Some(of) => of,
                        None => continue,
                    }
                } else {
                    done[0]
                };
                let excess = of.affine.of(h[l]) - limit[l];
                if excess < -sight.doubt {
                    continue;
                }
                let (cell, line) = (of.cell, line[l] as u32);
                let high = High { tau: tau[l], h: h[l], limit: limit[l], cell, family: FAMILY as u8, line };
                if !(of.exact && sight.comparable(&high)) || record.keeps(&high, excess, 2.0 * sight.doubt) {
                    out.push(high);
                }
            }
        }
    }
}

impl Record {
    const NONE: Self = Self { cell: NO_CELL, excess: f64::NEG_INFINITY, limit: f64::INFINITY };

    /// Whether a crossing is needed beside this one; `doubt`: of differences.
    #[inline(always)]
    fn keeps(&mut self, high: &High, excess: f64, doubt: f64) -> bool {
        if high.cell == self.cell && high.limit >= self.limit && excess + doubt < self.excess {
            return false;
        }
        if high.cell != self.cell || excess > self.excess {
            *self = Self { cell: high.cell, excess, limit: high.limit };
        }
        true
    }
}

/// What is done where an edge is crossed; `None` where it lacks an end: that must not stand for ground.
#[inline(always)]
fn which(done: &[Done], part_of: &[u8; ALONG * ALONG], nodes: [usize; 2], weight: f64) -> Option<Done> {
    if !(UNSURE..=0.5 - UNSURE).contains(&(weight - 0.5).abs()) {
        return Some(IN_DOUBT);
    }
    let [near, far] = if weight > 0.5 { [nodes[1], nodes[0]] } else { nodes };
    let part = done.get(usize::from(part_of[near]))?;
    (part_of[far] != NO_PART).then_some(*part)
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
