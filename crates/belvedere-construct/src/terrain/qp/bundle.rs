//! Lines of sight of neighbours, followed as one as long as no ground comes near.

use super::super::register::LANES;
use super::lanes::Lanes;
use super::seen::Seen;
use super::surface::{Lattice, Surface};
use super::walk::{Chord, Clearance, LEAF, Touch, fade};
use belvedere_core::DVec2;
use std::ops::Range;

/// Lines of a bundle at most.
const MOST: usize = LANES;
/// Cells between the points of a bundle at most.
const SPREAD: f64 = 3.0;
/// Short parts are looked at unless blocks leave this room, scene units, for the same reason.
const SOME: f64 = 0.5;
/// What rounding may change in a height, scene units.
const ROUNDING: f64 = 1e-6;
/// Cells of the pieces that lines are followed along.
const FINE: f64 = 2.0;
/// Larger blocks are not believed to be out of the way if they leave less room, scene units: room saves walks later on.
const WISH: f64 = 2.0;

/// Consecutive candidates that see one eye along straight lines, or a single one.
#[derive(Debug, Clone)]
pub(super) struct Bundle {
    pub(super) members: Range<usize>,
    /// By how much the ground may rise against all lines before a place can be missed that is not on a `near` part; negative
    /// if that is not known.
    room: f64,
    near: Vec<Near>,
}

/// A short part of a fan that ground comes near.
#[derive(Debug, Clone, Copy)]
struct Near {
    part: [f64; 2],
    /// Least and greatest corner, grid.
    corners: [DVec2; 2],
    /// As of the bundle, for this part.
    room: f64,
}

/// A line of sight: index of its candidate, line, and the part of it that counts.
type Line = (usize, Chord, [f64; 2]);

impl Bundle {
    fn new(members: Range<usize>) -> Self {
        Self { members, room: -1.0, near: Vec::new() }
    }

    /// Bundles of all candidates, in their order; `straight` lines may share one.
    pub(super) fn all(seen: &[Seen], straight: bool) -> Vec<Self> {
        let mut out: Vec<Self> = Vec::new();
        let mut first = 0;
        for i in 0..seen.len() {
            let near = (seen[i].grid - seen[first].grid).abs().max_element() <= SPREAD;
            if i > first && !(straight && near && i - first < MOST) {
                out.push(Self::new(first..i));
                first = i;
            }
        }
        if first < seen.len() {
            out.push(Self::new(first..seen.len()));
        }
        out
    }

    /// The displacement changed: takes what the ground rose and the lines sank at most from the room.
    pub(super) fn moved(&mut self, seen: &[Seen], rise: &Rise) {
        if self.room <= 0.0 {
            return;
        }
        let members = &seen[self.members.clone()];
        let sank = members.iter().map(|s| -s.displacement(rise.change)).fold(0.0, f64::max);
        for near in self.near.iter_mut().filter(|n| n.room > 0.0) {
            near.room -= sank + rise.within(near.corners);
        }
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

    /// All places where the asked clearance is missed. Where there is room left nothing is looked at.
    pub(super) fn walk(&mut self, seen: &[Seen], surface: &Surface, clearance: &Clearance) -> Vec<(usize, Touch)> {
        let (known, mut touches) = (self.room > 0.0, Vec::new());
        if known && self.near.iter().all(|n| n.room > 0.0) {
            return touches;
        }
        let lines: Vec<Line> = self
            .members
            .clone()
            .flat_map(|k| {
                let s = &seen[k];
                let parts = s.line(s.displacement(&surface.u));
                parts.filter_map(move |c| Some((k, c, c.part(surface, s.grid, clearance.guard)?)))
            })
            .collect();
        if !known {
            self.room = ends(&lines, surface, clearance, &mut touches);
            self.near.clear();
            if self.members.len() > 1 && !lines.is_empty() {
                Fan::new(&lines).walk(surface, clearance, &mut self.room, &mut self.near);
            } else {
                for (k, chord, part) in &lines {
                    chord.walk(surface, *part, clearance, &mut self.room, &mut |t| touches.push((*k, t)));
                }
            }
            if !touches.is_empty() {
                self.room = -1.0;
            }
        }
        self.look(&lines, surface, clearance, &mut touches);
        touches
    }

    /// Looks at the near parts without room.
    fn look(&mut self, lines: &[Line], surface: &Surface, clearance: &Clearance, touches: &mut Vec<(usize, Touch)>) {
        let tight = |n: &&mut Near| n.room <= 0.0;
        let parts: Vec<[f64; 2]> = self.near.iter_mut().filter(tight).map(|n| n.part).collect();
        if parts.is_empty() {
            return;
        }
        let mut most = Vec::with_capacity(parts.len());
        Lanes::new(lines, clearance).most(surface, &parts, &mut most);
        for (near, most) in self.near.iter_mut().filter(tight).zip(most) {
            let before = touches.len();
            near.room = f64::INFINITY;
            // Between two kinks the displaced ground may bulge; and registers round differently.
            let bulge = 0.25 * surface.displaced_bound(near.corners).1 + ROUNDING;
            for ((k, chord, whole), most) in lines.iter().zip(most) {
                if most + bulge <= 0.0 {
                    near.room = near.room.min(-most - bulge);
                    continue;
                }
                let part = [whole[0].max(near.part[0]), whole[1].min(near.part[1])];
                if part[0] < part[1] {
                    chord.look(surface, part, clearance, &mut near.room, &mut |t| touches.push((*k, t)));
                }
            }
            if touches.len() > before {
                near.room = -1.0;
            }
        }
    }
}

/// The ends of the parts of lines: places that are missed, and the room that is left at the others.
fn ends(lines: &[Line], surface: &Surface, clearance: &Clearance, touches: &mut Vec<(usize, Touch)>) -> f64 {
    let mut room = f64::INFINITY;
    for (k, chord, part) in lines {
        for end in chord.ends_of(surface, *part, clearance) {
            match end {
                Ok(touch) => touches.push((*k, touch)),
                Err(left) => room = room.min(left),
            }
        }
    }
    room
}

/// What encloses the lines of a bundle: a box of points that shrinks into the eye, and the lowest line.
struct Fan {
    points: [DVec2; 2],
    eye: DVec2,
    z: [f64; 2],
    part: [f64; 2],
}

impl Fan {
    fn new(lines: &[Line]) -> Self {
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

    /// Appends the short parts that ground comes near; `room` becomes no more than what is left over the others.
    fn walk(&self, surface: &Surface, clearance: &Clearance, room: &mut f64, near: &mut Vec<Near>) {
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
                self.pieces(surface, clearance, [a, b], room, near);
            } else {
                let middle = 0.5 * (a + b);
                stack.push([middle, b]);
                stack.push([a, middle]);
            }
        }
    }

    /// The same within a part of some cells, by the finest blocks.
    fn pieces(&self, surface: &Surface, clearance: &Clearance, [a, b]: [f64; 2], room: &mut f64, near: &mut Vec<Near>) {
        let length = (b - a) * (self.eye - self.points[0]).abs().max_element();
        let pieces = (length / FINE).max(1.0).ceil();
        let place = |k: f64| if k < pieces { a + (b - a) * (k / pieces) } else { b };
        for k in 0..pieces as usize {
            let part = [place(k as f64), place(k as f64 + 1.0)];
            let (low, high) = self.bounds(part[0], part[1]);
            let line = self.lowest(part[0], part[1]) - clearance.margin * fade(part[1]);
            let left = line - surface.still_bound(low, high) - surface.displaced_bound([low, high]).0;
            if left >= SOME {
                *room = room.min(left);
            } else {
                near.push(Near { part, corners: [low, high], room: -1.0 });
            }
        }
    }
}

/// Largest rise of the ground by blocks of the solver's grid.
pub(super) struct Rise<'a> {
    lattice: &'a Lattice,
    /// By how much each node of the solver's grid rose.
    pub(super) change: &'a [f64],
    cols: usize,
    rows: usize,
    /// Cells per block.
    size: DVec2,
    most: Vec<f64>,
}

/// Cells of the solver's grid per side of a block.
const SIDE: usize = 4;

impl<'a> Rise<'a> {
    pub(super) fn new(lattice: &'a Lattice, change: &'a [f64]) -> Self {
        let blocks = |n: usize| (n - 1).div_ceil(SIDE).max(1);
        let (cols, rows) = (blocks(lattice.cols), blocks(lattice.rows));
        let most = |b: usize| {
            let (x, y) = (b % cols * SIDE, b / cols * SIDE);
            let across = x..=(x + SIDE).min(lattice.cols - 1);
            let down = y..=(y + SIDE).min(lattice.rows - 1);
            down.flat_map(|y| &change[y * lattice.cols..][across.clone()]).copied().fold(0.0, f64::max)
        };
        let most = (0..cols * rows).map(most).collect();
        Self { lattice, change, cols, rows, size: lattice.step * SIDE as f64, most }
    }

    /// Nothing in a box (least and greatest corner, grid) rises more.
    fn within(&self, corners: [DVec2; 2]) -> f64 {
        let Lattice { cols, rows, step } = *self.lattice;
        let [low, high] = corners.map(|c| c / step);
        let first = |v: f64, n: usize| ((v - 1e-9).max(0.0) as usize).min(n - 1);
        let last = |v: f64, n: usize| ((v + 1e-9).max(0.0) as usize + 1).min(n - 1);
        let mut most = 0.0f64;
        for y in first(low.y, rows)..=last(high.y, rows) {
            for v in &self.change[y * cols..][first(low.x, cols)..=last(high.x, cols)] {
                most = most.max(*v);
            }
        }
        most
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
