//! Target tracking of a film: the path of the second viewpoint through all frames, planned before the first is drawn.
//!
//! Ours: the paper tracks live, where future motion is unknown. In a film it is known. In every frame the visible share of the target
//! is found for positions of the second viewpoint to the left and right. If no path over these shows the whole target throughout, or
//! f turns round more than once, rays that begin to bend nearer or farther away are tried, and positions up, down and aslant are added, first
//! few, then more. The path that hides the target in the
//! fewest frames, and of those the one that turns, moves and bends least, is a shortest path over frames and positions.

use super::tracking::{Search, WHOLE};
use super::way::{Disc, PER_RING, on_ring};
use super::{PlannedBend, Target, TargetSight, TrackingMemory, TrackingOptions};
use crate::ConstructError;
use belvedere_core::View;
use belvedere_scene::Scene;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Steps of f on either side of 0, at most.
const POSITIONS: usize = 250;
/// Rings of positions in the first and the second search up, down and aslant.
const WIDE: [usize; 2] = [4, 8];
/// A frame that does not show the whole target costs more than any motion.
const HIDDEN: f64 = 1e6;
/// Cost of a second in which nothing of the target is seen, in addition to `HIDDEN`.
const LESS: f64 = 40.0;
/// Cost of bending to f = 1 for a second, and of doing so upwards or downwards; moving f by 1 costs 1.
const BENT: f64 = 0.3;
const ASIDE: f64 = 0.1;
/// Cost of a second in which the target is seen but has no margin.
const TIGHT: f64 = 0.5;

/// Share of the target that is seen, and whether it has its margin.
type Seen = (f32, bool);

/// Visible share of the target in one frame, by position of the second viewpoint.
#[derive(Debug, Clone, Default)]
struct Known {
    /// At values of f from -1 to 1, sideways.
    sideways: Vec<Seen>,
    /// At the positions of `side` rings, from the first ring to the rim; empty before the wide search.
    wide: Vec<Seen>,
    side: usize,
}

/// Where rays begin to bend, shares of the target's distance, in the order in which they are tried.
const STARTS: [f64; 4] = [PlannedBend::START, 0.3, 0.7, 0.12];

/// What is known of a film whose rays begin to bend at one share of the target's distance.
#[derive(Debug, Clone)]
struct Attempt {
    start: f64,
    frames: Vec<Known>,
    /// Cost of the cheapest path, and its bends.
    least: f64,
    bends: Vec<PlannedBend>,
}

/// What a pass over the frames finds out.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pass {
    /// Positions to the left and right, for one of [`STARTS`].
    Sideways,
    /// Positions all around, with so many of [`WIDE`]'s rings, for the best of them.
    Around(usize),
}

/// Plans the bends of a film in one to six passes over its frames: [`Self::add`] every frame, then ask [`Self::wants_more`].
/// Same frames, same plan.
#[derive(Debug)]
pub struct FilmPlanner {
    options: TrackingOptions,
    time_step_s: f64,
    memory: TrackingMemory,
    /// The last is the one that is worked on.
    attempts: Vec<Attempt>,
    pass: Pass,
    /// The next frame of the pass.
    next: usize,
}

impl FilmPlanner {
    /// * `time_step_s`: seconds between frames, > 0.
    ///
    /// # Errors
    /// [`ConstructError::Parameter`].
    pub fn new(options: TrackingOptions, time_step_s: f64) -> Result<Self, ConstructError> {
        options.check()?;
        let (memory, attempts) = (TrackingMemory::default(), vec![Attempt::new(STARTS[0])]);
        Ok(Self { options, time_step_s, memory, attempts, pass: Pass::Sideways, next: 0 })
    }

    /// The next frame of the pass; the arguments are those of [`super::track_target`].
    pub fn add(&mut self, scene: &Scene, base: &View, target: &Target) {
        let sight = TargetSight::remembering(scene, target, &self.memory.trees);
        let mut search = Search::new(base, target, &self.options, &sight, &self.memory);
        let grow = self.options.grow_px;
        let Some(attempt) = self.attempts.last_mut() else { return };
        search.begin_at(attempt.start);
        let seen = |[x, y]: [f64; 2]| -> Seen {
            let at = if y == 0.0 { (x, 0.0) } else { (x.hypot(y), y.atan2(x).to_degrees()) };
            let share = search.seen(at, 0.0);
            (share as f32, share >= WHOLE && (grow == 0.0 || search.seen(at, grow) >= WHOLE))
        };
        match (self.pass, attempt.frames.get(self.next)) {
            (Pass::Around(round), Some(known)) => {
                let side = WIDE[round];
                let nodes: Vec<[f64; 2]> = (1..=side).flat_map(|ring| on_ring(ring, side)).collect();
                let node = |&at: &[f64; 2]| known.exactly(at).unwrap_or_else(|| seen(at));
                let wide = nodes.par_iter().map(node).collect();
                let sideways = known.sideways.clone();
                attempt.frames[self.next] = Known { sideways, wide, side };
            }
            (Pass::Sideways, _) => {
                let grid = ((1.0 / self.options.f_step).ceil() as usize).clamp(1, POSITIONS);
                let at = |k: usize| [k as f64 / grid as f64 - 1.0, 0.0];
                let sideways = (0..=2 * grid).into_par_iter().map(|k| seen(at(k))).collect();
                attempt.frames.push(Known { sideways, ..Known::default() });
            }
            (Pass::Around(_), None) => {}
        }
        let right = search.right();
        self.memory.keep_side(right);
        self.next += 1;
    }

    /// Plans the bends from the passes so far. Returns whether another pass over all frames, with more positions, may find a better path.
    pub fn wants_more(&mut self) -> bool {
        self.plan();
        // The next pass begins at the first frame, whose right may be the left of the last.
        self.memory = self.memory.begun_again();
        self.next = 0;
        let Some(now) = self.attempts.last() else { return false };
        let hides = now.least >= HIDDEN;
        let hunts = turnings(&now.bends) > 1;
        let starts = if self.options.z0.is_some() { 1 } else { STARTS.len() };
        match self.pass {
            Pass::Sideways if !(hides || hunts) => return false,
            Pass::Sideways if hides && self.attempts.len() < starts => {
                self.attempts.push(Attempt::new(STARTS[self.attempts.len()]));
                return true;
            }
            Pass::Sideways => self.pass = Pass::Around(0),
            Pass::Around(round) if hides && round + 1 < WIDE.len() => self.pass = Pass::Around(round + 1),
            Pass::Around(_) => return false,
        }
        // Another start is taken where it hides the target in fewer frames.
        let fewer = |a: usize, b: usize| self.attempts[b].least + 0.5 * HIDDEN < self.attempts[a].least;
        let better = |a: usize, b: usize| if fewer(a, b) { b } else { a };
        if let Some(best) = (0..self.attempts.len()).reduce(better) {
            self.attempts.swap(0, best);
            self.attempts.truncate(1);
        }
        true
    }

    /// Finds the cheapest path through what is known.
    fn plan(&mut self) {
        let disc = Disc::new(self.options.cap_per_s * self.time_step_s, self.pass == Pass::Sideways);
        let Some(attempt) = self.attempts.last() else { return };
        let frames = &attempt.frames;
        let knots = frames.len().div_ceil(disc.stride);
        let cost = |knot: usize| {
            let mut sum = vec![0.0; disc.places.len()];
            for known in frames.iter().skip(knot * disc.stride).take(disc.stride) {
                for (sum, place) in sum.iter_mut().zip(&disc.places) {
                    *sum += self.cost(known, *place);
                }
            }
            sum
        };
        let (least, way) = disc.cheapest(knots, cost);
        let place = |knot: usize| way.get(knot).map(|&n| disc.places[n]);
        let offsets = (0..frames.len()).map(|k| {
            let from = place(k / disc.stride).unwrap_or_default();
            let to = place(k / disc.stride + 1).unwrap_or(from);
            between(from, to, (k % disc.stride) as f64 / disc.stride as f64)
        });
        let bends = bends(offsets, attempt.start);
        if let Some(attempt) = self.attempts.last_mut() {
            (attempt.least, attempt.bends) = (least, bends);
        }
    }

    /// Cost of a position in a frame.
    fn cost(&self, known: &Known, [x, y]: [f64; 2]) -> f64 {
        let (share, is_clear) = known.at([x, y]);
        let share = f64::from(share);
        let is_whole = share >= WHOLE;
        let hidden = if is_whole { 0.0 } else { HIDDEN };
        let tight = if is_clear { 0.0 } else { TIGHT };
        let less = if is_whole { 0.0 } else { LESS * (1.0 - share) };
        hidden + self.time_step_s * (less + tight + BENT * x.hypot(y) + ASIDE * y.abs())
    }

    /// The bend of every frame.
    pub fn finish(mut self) -> Vec<PlannedBend> {
        self.attempts.pop().map_or_else(Vec::new, |attempt| attempt.bends)
    }
}

impl Attempt {
    fn new(start: f64) -> Self {
        Self { start, frames: Vec::new(), least: f64::INFINITY, bends: Vec::new() }
    }
}

impl Known {
    fn sideways(&self, x: f64) -> Seen {
        let at = (x + 1.0) * (self.sideways.len() - 1) as f64 / 2.0;
        // Rounding must not take a neighbour in.
        [(at - 1e-6).ceil(), (at + 1e-6).floor()]
            .into_iter()
            .map(|k| self.sideways[k as usize])
            .reduce(both)
            .unwrap_or_default()
    }

    /// Visible shares at the known positions around a position (at most two on two rings each), and whether the position itself is known.
    fn around(&self, [x, y]: [f64; 2]) -> (impl Iterator<Item = Seen>, bool) {
        let [ring, turn] = [x.hypot(y) * self.side as f64, y.atan2(x) / TAU + 1.0];
        let ends = |at: f64| [(at + 1e-6).floor() as usize, (at - 1e-6).ceil() as usize];
        let rings = ends(ring);
        let mut is_exact = rings[0] == rings[1];
        let corners = rings.map(|ring| {
            let angles = ends(turn * (PER_RING * ring) as f64);
            is_exact &= angles[0] == angles[1];
            angles.map(|k| match ring {
                0 => self.sideways(0.0),
                _ => self.wide[PER_RING * (ring * (ring - 1) / 2) + k % (PER_RING * ring)],
            })
        });
        (corners.into_iter().flatten(), is_exact)
    }

    /// Visible share at a position that is itself known; `None` elsewhere.
    fn exactly(&self, place: [f64; 2]) -> Option<Seen> {
        if place[1] == 0.0 {
            return Some(self.sideways(place[0]));
        }
        let (mut around, is_exact) = (!self.wide.is_empty()).then(|| self.around(place))?;
        around.next().filter(|_| is_exact)
    }

    /// Visible share at a position: the least of those at the known positions around it.
    fn at(&self, place: [f64; 2]) -> Seen {
        match place[1] == 0.0 {
            true => self.sideways(place[0]),
            false if self.wide.is_empty() => (0.0, false),
            false => self.around(place).0.reduce(both).unwrap_or_default(),
        }
    }
}

fn both(a: Seen, b: Seen) -> Seen {
    (a.0.min(b.0), a.1 && b.1)
}

/// A position between two others: its distance from the middle changes evenly.
fn between(from: [f64; 2], to: [f64; 2], share: f64) -> [f64; 2] {
    let [x, y] = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
    let across = from[0] * to[0] + from[1] * to[1] <= 0.0;
    let (a, b, now) = (from[0].hypot(from[1]), to[0].hypot(to[1]), x.hypot(y));
    if across || now < 1e-12 {
        return [x, y];
    }
    let scale = (a + share * (b - a)) / now;
    [x, y].map(|v| if scale == 1.0 { v } else { v * scale })
}

/// Offsets, shares of `a` to the right and upwards, as f and a direction that does not jump.
fn bends(offsets: impl Iterator<Item = [f64; 2]>, start: f64) -> Vec<PlannedBend> {
    let mut before = PlannedBend { start, ..PlannedBend::default() };
    let mut out = Vec::new();
    for [x, y] in offsets {
        let length = x.hypot(y);
        if length < 1e-12 {
            before.f = 0.0;
        } else if y == 0.0 && before.direction_deg == 0.0 {
            before.f = x;
        } else {
            let sign = if before.f < 0.0 { -1.0 } else { 1.0 };
            // Adding 0 takes the sign of a zero away.
            let toward = |sign: f64| (sign * y).atan2(sign * x).to_degrees() + 0.0;
            let turn = |sign: f64| (toward(sign) - before.direction_deg + 540.0).rem_euclid(360.0) - 180.0;
            // Straight through the middle f changes its sign, not its direction; from the middle as soon as it goes on to the other side.
            let most = if before.f == 0.0 { 90.0 + 1e-9 } else { 179.0 };
            let sign = if turn(sign).abs() > most { -sign } else { sign };
            before = PlannedBend { f: sign * length, direction_deg: toward(sign), start };
        }
        out.push(before);
    }
    out
}

/// How often f turns round.
fn turnings(bends: &[PlannedBend]) -> usize {
    let steps = bends.windows(2).map(|pair| pair[1].f - pair[0].f).filter(|step| step.abs() > 1e-9);
    let signs: Vec<bool> = steps.map(|step| step > 0.0).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}
