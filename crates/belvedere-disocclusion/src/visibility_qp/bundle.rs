//! Lines of sight of neighbours, followed as one as long as no ground comes near.

use super::candidate_line::CandidateLine;
use super::lanes::Lanes;
use super::register::LANES;
use super::rise::Rise;
use super::single_line::SingleLine;
use super::surface::Surface;
use super::walk::{Chord, Clearance, LEAF, Touch};
use belvedere_core::DVec2;
use std::ops::Range;

/// Lines of a bundle at most.
const MOST: usize = LANES;
/// Cells between the points of a bundle at most.
const SPREAD: f64 = 3.0;
/// Short parts of lines are tested one by one unless the bounds of the finest blocks leave this clearance, scene units.
const SOME: f64 = 0.5;
/// Largest change of a height by rounding, scene units.
const ROUNDING: f64 = 1e-6;
/// Length of the pieces along which lines are followed, grid cells.
const FINE: f64 = 2.0;
/// Longer parts are halved if the bounds of blocks leave less clearance than this, scene units: a known clearance saves later walks.
const WISH: f64 = 2.0;

/// Lines of sight that are followed as one.
#[derive(Debug, Clone)]
pub(super) enum Bundle {
    SingleLine(SingleLine),
    Together(Together),
}

/// Consecutive candidates that see one eye along straight lines.
#[derive(Debug, Clone)]
pub(super) struct Together {
    members: Range<usize>,
    /// Height by which the ground may rise towards all lines before a position outside the `near` parts can be missed, scene units;
    /// negative if it is not known.
    room: f64,
    near: Vec<Near>,
}

/// A short part of a fan that ground comes near.
#[derive(Debug, Clone, Copy)]
struct Near {
    part: [f64; 2],
    /// Least and greatest corner, grid.
    corners: [DVec2; 2],
    /// The same height for this part.
    room: f64,
}

/// A line of sight: index of its candidate, line, and the part of it that counts.
type Line = (usize, Chord, [f64; 2]);

impl Bundle {
    /// Bundles of all candidates, in their order; `straight` lines may share one.
    pub(super) fn all(seen: &[CandidateLine], straight: bool) -> Vec<Self> {
        let mut out: Vec<Self> = Vec::new();
        let mut first = 0;
        for i in 1..=seen.len() {
            let near = i < seen.len() && (seen[i].grid - seen[first].grid).abs().max_element() <= SPREAD;
            if !(straight && near && i - first < MOST) {
                out.push(match first..i {
                    members if members.len() > 1 => Self::Together(Together { members, room: -1.0, near: Vec::new() }),
                    _ => Self::SingleLine(SingleLine::new(first, &seen[first])),
                });
                first = i;
            }
        }
        out
    }

    /// Updates the room after a change of the displacement: subtracts bounds of the rise of the ground and of the fall of the lines.
    pub(super) fn moved(&mut self, seen: &[CandidateLine], rise: &Rise) {
        match self {
            Self::SingleLine(one) => one.moved(seen, rise),
            Self::Together(all) => all.moved(seen, rise),
        }
    }

    /// All positions where the required clearance is missed. Parts of lines with room left are skipped.
    pub(super) fn walk(
        &mut self,
        seen: &[CandidateLine],
        surface: &Surface,
        clearance: &Clearance,
    ) -> Vec<(usize, Touch)> {
        match self {
            Self::SingleLine(one) => one.walk(seen, surface, clearance),
            Self::Together(all) => all.walk(seen, surface, clearance),
        }
    }
}

impl Together {
    fn moved(&mut self, seen: &[CandidateLine], rise: &Rise) {
        if self.room <= 0.0 {
            return;
        }
        let members = &seen[self.members.clone()];
        let sank = members.iter().map(|s| -s.displacement(rise.change)).fold(0.0, f64::max);
        for near in self.near.iter_mut().filter(|n| n.room > 0.0) {
            near.room -= sank + rise.within(near.corners);
        }
        let grids = || members.iter().map(|s| s.grid);
        let points = [grids().fold(DVec2::INFINITY, DVec2::min), grids().fold(DVec2::NEG_INFINITY, DVec2::max)];
        let to_eye = members[0].chords.iter();
        self.room -= sank + to_eye.map(|c| rise.along(points, [c.ends[1]; 2])).fold(0.0, f64::max);
    }

    fn walk(&mut self, seen: &[CandidateLine], surface: &Surface, clearance: &Clearance) -> Vec<(usize, Touch)> {
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
            if !lines.is_empty() {
                Fan::new(&lines).walk(surface, clearance, &mut self.room, &mut self.near);
            }
            if !touches.is_empty() {
                self.room = -1.0;
            }
        }
        self.look(&lines, surface, clearance, &mut touches);
        touches
    }

    /// Tests the near parts that have no room left.
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
            for ((k, chord, whole), most) in lines.iter().zip(most) {
                // Registers round differently.
                if most + ROUNDING <= 0.0 {
                    near.room = near.room.min(-most - ROUNDING);
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

/// Tests the ends of the parts of lines: collects those where the clearance is missed, and returns the room left at the others.
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

/// Bounds of the lines of a bundle: a box of points that shrinks into the eye, and the lowest line.
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
            out.z = [out.z[0].min(chord.z[0]), out.z[1].min(chord.z[1])];
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
            let left = self.lowest(a, b) - clearance.margin * clearance.share(b) - surface.bound(low, high);
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
            let line = self.lowest(part[0], part[1]) - clearance.margin * clearance.share(part[1]);
            // Facets may lie over the bilinear displacement.
            let (displaced, twist) = surface.displaced_bound([low, high]);
            let left = line - surface.still_bound(low, high) - displaced - 0.25 * twist;
            if left >= SOME {
                *room = room.min(left);
            } else {
                near.push(Near { part, corners: [low, high], room: -1.0 });
            }
        }
    }
}
