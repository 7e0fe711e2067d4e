//! Lines of sight of neighbours, followed as one as long as no ground comes near.

use super::seen::Seen;
use super::surface::{Lattice, Surface};
use super::walk::{Chord, Clearance, LEAF, Touch, fade};
use belvedere_core::DVec2;
use std::ops::Range;

/// Lines of a bundle at most.
const MOST: usize = 8;
/// Cells between the points of a bundle at most.
const SPREAD: f64 = 3.0;
/// Larger blocks are not believed to be out of the way if they leave less room, scene units: room saves walks later on.
const WISH: f64 = 2.0;

/// Consecutive candidates that see one eye along straight lines, or a single one.
#[derive(Debug, Clone)]
pub(super) struct Bundle {
    pub(super) members: Range<usize>,
    /// By how much the ground may rise against all lines before a place can be missed; negative if that is not known.
    pub(super) room: f64,
}

impl Bundle {
    /// Bundles of all candidates, in their order; `straight` lines may share one.
    pub(super) fn all(seen: &[Seen], straight: bool) -> Vec<Self> {
        let mut out: Vec<Self> = Vec::new();
        let mut first = 0;
        for i in 0..seen.len() {
            let near = (seen[i].grid - seen[first].grid).abs().max_element() <= SPREAD;
            if i > first && !(straight && near && i - first < MOST) {
                out.push(Self { members: first..i, room: -1.0 });
                first = i;
            }
        }
        if first < seen.len() {
            out.push(Self { members: first..seen.len(), room: -1.0 });
        }
        out
    }

    /// The displacement changed by `change`: takes what the ground rose and the lines sank at most from the room.
    pub(super) fn moved(&mut self, seen: &[Seen], change: &[f64], rise: &Rise) {
        if self.room <= 0.0 {
            return;
        }
        let members = &seen[self.members.clone()];
        let sank = members.iter().map(|s| -s.displacement(change)).fold(0.0, f64::max);
        let rose = if let [first, _, ..] = members {
            let grids = || members.iter().map(|s| s.grid);
            let points = [grids().fold(first.grid, DVec2::min), grids().fold(first.grid, DVec2::max)];
            first.chords.iter().map(|c| rise.along(points, [c.ends[1]; 2])).fold(0.0, f64::max)
        } else {
            let chords = members.iter().flat_map(|s| s.chords.iter());
            chords.map(|c| rise.along([c.ends[0]; 2], [c.ends[1]; 2])).fold(0.0, f64::max)
        };
        self.room -= sank + rose;
    }

    /// All places where the asked clearance is missed, and the room that is left.
    ///
    /// * `every`: only every so many lines are followed.
    pub(super) fn walk(
        &self,
        seen: &[Seen],
        surface: &Surface,
        clearance: &Clearance,
        every: usize,
    ) -> (Vec<(usize, Touch)>, f64) {
        let (mut touches, mut room) = (Vec::new(), f64::INFINITY);
        let lines: Vec<(usize, Chord, [f64; 2])> = self
            .members
            .clone()
            .step_by(every)
            .flat_map(|k| {
                let s = &seen[k];
                let parts = s.line(s.displacement(&surface.u));
                parts.filter_map(move |c| Some((k, c, c.part(surface, s.grid, clearance.guard)?)))
            })
            .collect();
        for (k, chord, part) in &lines {
            for end in chord.ends_of(surface, *part, clearance) {
                match end {
                    Ok(touch) => touches.push((*k, touch)),
                    Err(left) => room = room.min(left),
                }
            }
        }
        if self.members.len() > 1 {
            let mut left = f64::INFINITY;
            Fan::new(&lines).walk(surface, clearance, &mut left, &mut |[a, b]| {
                for (k, chord, part) in &lines {
                    let part = [part[0].max(a), part[1].min(b)];
                    if part[0] < part[1] {
                        chord.look(surface, part, clearance, &mut room, &mut |t| touches.push((*k, t)));
                    }
                }
            });
            room = room.min(left);
        } else {
            for (k, chord, part) in &lines {
                chord.walk(surface, *part, clearance, &mut room, &mut |t| touches.push((*k, t)));
            }
        }
        (touches, room)
    }
}

/// What encloses the lines of a bundle: a box of points that shrinks into the eye, and the lowest line.
struct Fan {
    points: [DVec2; 2],
    eye: DVec2,
    z: [f64; 2],
    part: [f64; 2],
}

impl Fan {
    fn new(lines: &[(usize, Chord, [f64; 2])]) -> Self {
        let mut out = Self {
            points: [DVec2::INFINITY, DVec2::NEG_INFINITY],
            eye: DVec2::ZERO,
            z: [f64::INFINITY; 2],
            part: [f64::INFINITY, f64::NEG_INFINITY],
        };
        for (_, chord, part) in lines {
            out.points = [out.points[0].min(chord.ends[0]), out.points[1].max(chord.ends[0])];
            out.eye = chord.ends[1];
            out.z = [out.z[0].min(chord.z[0]), chord.z[1]];
            out.part = [out.part[0].min(part[0]), out.part[1].max(part[1])];
        }
        out
    }

    /// The box of a part.
    fn bounds(&self, a: f64, b: f64) -> (DVec2, DVec2) {
        let corner = |k: usize, t: f64| self.points[k].lerp(self.eye, t);
        (corner(0, a).min(corner(0, b)), corner(1, a).max(corner(1, b)))
    }

    /// The lowest line in a part.
    fn lowest(&self, a: f64, b: f64) -> f64 {
        let z = |t: f64| self.z[0] + t * (self.z[1] - self.z[0]);
        z(a).min(z(b))
    }

    /// Calls `near` with the parts that blocks of ground come near; `room` becomes no more than what is left over the others.
    fn walk(&self, surface: &Surface, clearance: &Clearance, room: &mut f64, near: &mut impl FnMut([f64; 2])) {
        let longest = LEAF / (self.eye - self.points[0]).abs().max_element();
        let mut stack = vec![self.part];
        while let Some([a, b]) = stack.pop() {
            if !(a < b) {
                continue;
            }
            let (low, high) = self.bounds(a, b);
            let left = self.lowest(a, b) - clearance.margin * fade(b) - surface.bound(low, high);
            let short = b - a <= longest;
            if left >= WISH || (short && left >= 0.0) {
                *room = room.min(left);
            } else if short {
                near([a, b]);
            } else {
                let middle = 0.5 * (a + b);
                stack.push([middle, b]);
                stack.push([a, middle]);
            }
        }
    }
}

/// Largest rise of the ground by blocks of the solver's grid.
pub(super) struct Rise {
    cols: usize,
    rows: usize,
    /// Cells per block.
    size: DVec2,
    most: Vec<f64>,
}

/// Cells of the solver's grid per side of a block.
const SIDE: usize = 4;

impl Rise {
    pub(super) fn new(lattice: &Lattice, change: &[f64]) -> Self {
        let blocks = |n: usize| (n - 1).div_ceil(SIDE).max(1);
        let (cols, rows) = (blocks(lattice.cols), blocks(lattice.rows));
        let most = |b: usize| {
            let (x, y) = (b % cols * SIDE, b / cols * SIDE);
            let across = x..=(x + SIDE).min(lattice.cols - 1);
            let down = y..=(y + SIDE).min(lattice.rows - 1);
            down.flat_map(|y| &change[y * lattice.cols..][across.clone()]).copied().fold(0.0, f64::max)
        };
        Self { cols, rows, size: lattice.step * SIDE as f64, most: (0..cols * rows).map(most).collect() }
    }

    /// Nothing on straight ways (grid) from one box (least and greatest corner) to another rises more.
    fn along(&self, from: [DVec2; 2], to: [DVec2; 2]) -> f64 {
        let ([a, b], [c, d]) = (from.map(|p| p / self.size), to.map(|p| p / self.size));
        let pieces = (c - a).abs().max_element().clamp(1.0, 1e4).ceil();
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n - 1);
        let mut most = 0.0f64;
        for k in 0..pieces as usize {
            let (s, t) = (k as f64 / pieces, (k + 1) as f64 / pieces);
            let low = a.lerp(c, s).min(a.lerp(c, t)) - 1e-9;
            let high = b.lerp(d, s).max(b.lerp(d, t)) + 1e-9;
            for y in index(low.y, self.rows)..=index(high.y, self.rows) {
                for x in index(low.x, self.cols)..=index(high.x, self.cols) {
                    most = most.max(self.most[y * self.cols + x]);
                }
            }
        }
        most
    }
}
