//! Search along a line of sight for positions where the ground comes too close.

use super::surface::{Lattice, Surface};
use crate::smooth::Between;
use belvedere_core::DVec2;
use belvedere_sight::{EdgeFamily, GridLine, floor};

/// A straight part of a line of sight, from the point that must be seen towards the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chord {
    /// Ends in grid coordinates.
    pub(super) ends: [DVec2; 2],
    /// Heights of the line there.
    pub(super) z: [f64; 2],
    /// Share of the distance to the eye there: 0 at the point, 1 at the eye.
    pub(super) tau: [f64; 2],
}

/// Clearance required of lines of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clearance {
    /// Asked far from the point, metres.
    pub(super) margin: f64,
    /// Tolerance of that clearance far from the point, metres.
    pub(super) tolerance: f64,
    /// Share of both that counts at the point, 0..=1.
    pub(super) near: f64,
    /// Ground nearer than this to the point does not count, cells.
    pub(super) guard: f64,
}

impl Clearance {
    /// Share of margin and tolerance that counts at `tau`: all of it but for the fifth of the line next to the point.
    pub(super) fn share(&self, tau: f64) -> f64 {
        self.near + (1.0 - self.near) * (5.0 * tau).clamp(0.0, 1.0)
    }
}

/// A position where the ground comes too close to a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touch {
    /// Grid position.
    pub(super) at: DVec2,
    /// Share of the distance to the eye.
    pub(super) tau: f64,
    /// Ground without its displacement.
    pub(super) ground: f64,
    /// Height of the line.
    pub(super) z: f64,
    /// Height by which the required clearance is missed, metres.
    pub(super) excess: f64,
}

/// Result of walking along a part of a line.
pub(super) struct Found {
    /// The position where the clearance is missed most.
    pub(super) worst: Option<Touch>,
    /// Height by which the ground may rise before the clearance is missed at another position, scene units.
    pub(super) room: f64,
}

impl Found {
    fn new() -> Self {
        Self { worst: None, room: f64::INFINITY }
    }
}

/// Longest part that is walked without asking the bounds again, cells.
pub(super) const LEAF: f64 = 8.0;
/// Longest part whose crossings are visited without asking the finest bounds, cells.
const FINE: f64 = 3.0;

/// Distance below which positions are the same, cells.
const SAME: f64 = 1e-6;

impl Chord {
    fn plan(&self) -> GridLine {
        GridLine::between(self.ends[0], self.ends[1])
    }

    fn at(&self, t: f64) -> DVec2 {
        self.plan().at(t)
    }

    fn mix(v: [f64; 2], t: f64) -> f64 {
        v[0] + t * (v[1] - v[0])
    }

    /// Part of the chord over the grid of `surface` and at least `guard` away from `point`.
    pub(super) fn part(&self, surface: &Surface, point: DVec2, guard: f64) -> Option<[f64; 2]> {
        let line = self.plan();
        let [mut from, to] = line.over([surface.cols, surface.rows], 0.0)?;
        let d = line.dir;
        let to_point = self.ends[0] - point;
        let (square, half) = (d.length_squared(), to_point.dot(d));
        if square > 0.0 {
            let root = half * half - square * (to_point.length_squared() - guard * guard);
            if root > 0.0 {
                from = from.max((root.sqrt() - half) / square);
            }
        }
        (from < to).then_some([from, to])
    }

    /// Tests the ends of a part, where no kink need lie: each is a position that misses the required clearance, or the room left there.
    pub(super) fn ends_of(&self, surface: &Surface, part: [f64; 2], clearance: &Clearance) -> [Result<Touch, f64>; 2] {
        part.map(|t| {
            let end = self.place(surface, t, clearance);
            let missing = end.excess - clearance.tolerance * clearance.share(end.tau);
            if missing > 0.0 { Ok(end) } else { Err(-missing) }
        })
    }

    /// Calls `touch` with the worst position of each short piece of a part where the required clearance is missed by more than the
    /// tolerance. `room` becomes no more than the room left elsewhere.
    pub(super) fn walk(
        &self,
        surface: &Surface,
        part: [f64; 2],
        clearance: &Clearance,
        room: &mut f64,
        touch: &mut impl FnMut(Touch),
    ) {
        let mut stack = [[0.0f64; 2]; 64];
        stack[0] = part;
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let [a, b] = stack[depth];
            let (ga, gb) = (self.at(a), self.at(b));
            let lowest = Self::mix(self.z, a).min(Self::mix(self.z, b))
                - clearance.margin * clearance.share(Self::mix(self.tau, a).max(Self::mix(self.tau, b)));
            let left = lowest - surface.bound(ga, gb);
            if left >= 0.0 {
                *room = room.min(left);
                continue;
            }
            if (gb - ga).abs().max_element() <= LEAF || depth + 2 > stack.len() {
                self.look(surface, [a, b], clearance, room, touch);
                continue;
            }
            let middle = 0.5 * (a + b);
            stack[depth] = [middle, b];
            stack[depth + 1] = [a, middle];
            depth += 2;
        }
    }

    /// As [`Self::walk`], for a short part as a whole.
    pub(super) fn look(
        &self,
        surface: &Surface,
        part: [f64; 2],
        clearance: &Clearance,
        room: &mut f64,
        touch: &mut impl FnMut(Touch),
    ) {
        let mut found = Found::new();
        self.by_cells(surface, part, clearance, &mut found);
        *room = room.min(found.room);
        if let Some(worst) = found.worst {
            touch(worst);
        }
    }

    /// Cuts a part at the lines of the solver's grid and takes the worst position of all pieces.
    fn by_cells(&self, surface: &Surface, [a, b]: [f64; 2], clearance: &Clearance, found: &mut Found) {
        let step = surface.lattice.step;
        let (p, d) = (self.ends[0] / step, (self.ends[1] - self.ends[0]) / step);
        let mut from = a;
        while from < b {
            let mut to = b;
            for axis in 0..2 {
                if d[axis] != 0.0 {
                    // The next line strictly ahead; the nudge steps over the one that `from` lies on.
                    let v = p[axis] + from * d[axis];
                    let line = if d[axis] > 0.0 { floor(v + 1e-9) + 1.0 } else { -floor(1e-9 - v) - 1.0 };
                    to = to.min((line - p[axis]) / d[axis]);
                }
            }
            let to = if to > from { to } else { b };
            let gap = Gap::new(self, surface, 0.5 * (from + to), clearance);
            self.in_cell(surface, [from, to], &gap, found);
            if (step.x.fract() != 0.0 || step.y.fract() != 0.0) && to < b {
                gap.judge(self, to, self.at(to), surface.ground(self.at(to)), found);
            }
            from = to;
        }
    }

    /// Within one cell of the solver's grid.
    fn in_cell(&self, surface: &Surface, [a, b]: [f64; 2], gap: &Gap<'_>, found: &mut Found) {
        let (ga, gb) = (self.at(a), self.at(b));
        let over = surface.still_bound(ga, gb) + gap.most(self, [a, b]);
        if over <= 0.0 {
            found.room = found.room.min(-over);
            return;
        }
        // Steps instead of halves: there are three at most.
        let pieces = ((gb - ga).abs().max_element() / FINE).max(1.0).ceil();
        for k in 0..pieces as usize {
            let place = |k: usize| a + (b - a) * (k as f64 / pieces);
            let part = [place(k), if k + 1 < pieces as usize { place(k + 1) } else { b }];
            let over = surface.still_bound(self.at(part[0]), self.at(part[1])) + gap.most(self, part);
            if over <= 0.0 {
                found.room = found.room.min(-over);
            } else {
                self.in_piece(surface, part, gap, found);
            }
        }
    }

    /// Within a short piece: every kink; between two of them the ground is flat.
    fn in_piece(&self, surface: &Surface, part: [f64; 2], gap: &Gap<'_>, found: &mut Found) {
        self.crossings(surface, part, &mut |t, at, ground| gap.judge(self, t, at, ground, found));
    }

    /// Whether a position is that at a parameter, but for rounding.
    pub(super) fn is_at(&self, t: f64, at: DVec2) -> bool {
        self.at(t).distance(at) < SAME
    }

    /// The position at a parameter.
    pub(super) fn place(&self, surface: &Surface, t: f64, clearance: &Clearance) -> Touch {
        self.touch(surface, t, self.at(t), surface.ground(self.at(t)), clearance)
    }

    fn touch(&self, surface: &Surface, t: f64, at: DVec2, ground: f64, clearance: &Clearance) -> Touch {
        let (z, tau) = (Self::mix(self.z, t), Self::mix(self.tau, t));
        let excess = ground + surface.displacement(at) - z + clearance.margin * clearance.share(tau);
        Touch { at, tau, ground, z, excess }
    }

    /// Calls `visit` for the ends of a part and every crossing with the lines of the drawn mesh.
    pub(super) fn kinks(
        &self,
        surface: &Surface,
        part: [f64; 2],
        clearance: &Clearance,
        visit: &mut impl FnMut(Touch),
    ) {
        part.iter().for_each(|&t| visit(self.place(surface, t, clearance)));
        self.crossings(surface, part, &mut |t, at, ground| visit(self.touch(surface, t, at, ground, clearance)));
    }

    /// Calls `visit` with parameter, position and undisplaced ground of every kink of the drawn ground along a part.
    fn crossings(&self, surface: &Surface, part: [f64; 2], visit: &mut impl FnMut(f64, DVec2, f64)) {
        for family in EdgeFamily::ALL {
            let nodes = [surface.cols, surface.rows];
            self.plan().crossings(nodes, family, part, 0.0, |t, at, edge| visit(t, at, edge.of(&surface.heights)));
        }
    }
}

/// Displacement minus line of sight along a chord within one cell of the solver's grid, a quadratic of the parameter.
struct Gap<'a> {
    c: [f64; 3],
    /// Factor of xy of the displacement.
    twist: f64,
    lattice: &'a Lattice,
    clearance: Clearance,
}

impl<'a> Gap<'a> {
    /// For the cell at parameter `inside`.
    fn new(chord: &Chord, surface: &'a Surface, inside: f64, clearance: &Clearance) -> Self {
        let step = surface.lattice.step;
        let Between { col, row, .. } = surface.lattice.between(chord.at(inside));
        let [nw, x, y, xy] = surface.patch(col as usize, row as usize);
        let corner = DVec2::new(f64::from(col), f64::from(row));
        let (p, d) = (chord.ends[0] / step - corner, (chord.ends[1] - chord.ends[0]) / step);
        let z = chord.z;
        let c = [
            nw + x * p.x + y * p.y + xy * p.x * p.y - z[0],
            x * d.x + y * d.y + xy * (p.x * d.y + p.y * d.x) - (z[1] - z[0]),
            xy * d.x * d.y,
        ];
        Self { c, twist: xy, lattice: &surface.lattice, clearance: *clearance }
    }

    fn at(&self, t: f64) -> f64 {
        self.c[0] + t * (self.c[1] + t * self.c[2])
    }

    /// Largest value with the margin over a part.
    fn most(&self, chord: &Chord, [a, b]: [f64; 2]) -> f64 {
        let mut most = self.at(a).max(self.at(b));
        let top = -0.5 * self.c[1] / self.c[2];
        if self.c[2] < 0.0 && top > a && top < b {
            most = most.max(self.at(top));
        }
        let tau = Chord::mix(chord.tau, a).max(Chord::mix(chord.tau, b));
        // Nowhere is a facet higher over the bilinear displacement than in the middle of a diagonal.
        let facet = self.twist.max(0.0) * self.lattice.facet(DVec2::splat(0.5));
        most + facet + self.clearance.margin * self.clearance.share(tau)
    }

    /// Takes a position into account.
    #[inline]
    fn judge(&self, chord: &Chord, t: f64, at: DVec2, ground: f64, found: &mut Found) {
        let tau = Chord::mix(chord.tau, t);
        let share = self.clearance.share(tau);
        let facet = if self.twist == 0.0 { 0.0 } else { self.twist * self.lattice.facet(at) };
        let excess = ground + self.at(t) + facet + self.clearance.margin * share;
        let missing = excess - self.clearance.tolerance * share;
        if missing <= 0.0 {
            found.room = found.room.min(-missing);
        } else if found.worst.is_none_or(|b| excess > b.excess) {
            found.worst = Some(Touch { at, tau, ground, z: Chord::mix(chord.z, t), excess });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinks_have_the_height_of_the_ground_up_to_the_rims_and_corners() {
        let (cols, rows) = (7, 5);
        let heights: Vec<f64> = (0..cols * rows).map(|i| ((i * 7919) % 101) as f64).collect();
        let step = DVec2::new((cols - 1) as f64, (rows - 1) as f64);
        let surface = Surface::new(&heights, cols, rows, Lattice { cols: 2, rows: 2, step });
        let (e, s) = (step.x, step.y);
        // Rims and diagonals both ways, over the corners, and to nodes and middles of edges of each rim.
        let mut ends = vec![[[0.0, s], [e, s]], [[0.0, 0.0], [e, 0.0]], [[0.0, 0.0], [0.0, s]], [[e, 0.0], [e, s]]];
        ends.extend([[[2.0, 0.0], [e, s]], [[0.0, 0.0], [s, s]], [[0.0, s], [e, 0.0]], [[1.0, 2.0], [3.0, s]]]);
        for k in 0..=12 {
            let v = 0.5 * f64::from(k);
            ends.extend([[[2.3, 1.6], [v, s]], [[2.3, 1.6], [v, 0.0]]]);
            ends.extend([[[2.3, 1.6], [0.0, v.min(s)]], [[2.3, 1.6], [e, v.min(s)]]]);
        }
        let mut visited = 0;
        for [a, b] in ends.iter().flat_map(|&[a, b]| [[a, b], [b, a]]) {
            let chord = Chord { ends: [a.into(), b.into()], z: [0.0; 2], tau: [0.0, 1.0] };
            chord.crossings(&surface, [0.0, 1.0], &mut |t, at, ground| {
                visited += 1;
                assert!((at - chord.at(t)).length() < 1e-12, "{a:?} to {b:?} at {t}");
                assert!((ground - surface.ground(at)).abs() < 1e-9, "{a:?} to {b:?}: {ground} at {at}");
            });
        }
        assert!(visited > 400, "{visited}");
    }
}
