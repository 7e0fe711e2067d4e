//! Target tracking of a film: the way of the second viewpoint through all frames, planned before the first is drawn.
//!
//! Ours: the paper tracks live, where the motion to come is unknown. A film knows it. In every frame the share of the target that is
//! seen is found for places of the second viewpoint to the left and right; where no way among those shows the whole target throughout,
//! or it turns round more than once, for places up, down and aslant as well, first few, then more. The way that hides the target in
//! the fewest frames, and of those the one that turns, moves and bends least, is a shortest path over frames and places.

use super::tracking::{Search, WHOLE};
use super::way::Disc;
use super::{Target, TargetSight, TrackingMemory, TrackingOptions};
use crate::ConstructError;
use belvedere_core::View;
use belvedere_scene::Scene;
use rayon::prelude::*;

/// Steps of f on either side of 0, at most.
const MOST: usize = 250;
/// Places per unit of the offset, first and second search up, down and aslant.
const WIDE: [usize; 2] = [4, 8];
/// A frame that does not show the whole target costs more than any motion.
const HIDDEN: f64 = 1e6;
/// Cost of bending to f = 1 for a second, and of doing so upwards or downwards; moving f by 1 costs 1.
const BENT: f64 = 0.3;
const ASIDE: f64 = 0.1;
/// Cost of a second in which the target is seen but has no margin.
const TIGHT: f64 = 0.5;

/// The second viewpoint of a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlannedBend {
    /// Where it is, -1..=1, times `a`.
    pub f: f64,
    /// Direction of f > 0 across the view, degrees from the right of the picture upwards.
    pub direction_deg: f64,
}

/// Share of the target that is seen, and whether it has its margin.
type Seen = (f32, bool);

/// What is known of a frame.
#[derive(Debug, Clone, Default)]
struct Known {
    /// From f = -1 to 1 sideways.
    sideways: Vec<Seen>,
    /// On the square around the disc, rows from below; empty before the wide search.
    wide: Vec<Seen>,
    side: usize,
}

/// Plans the bends of a film in one to three passes over its frames: [`Self::add`] every frame, then ask [`Self::wants_more`].
/// Same frames, same plan.
#[derive(Debug)]
pub struct FilmPlanner {
    options: TrackingOptions,
    time_step_s: f64,
    memory: TrackingMemory,
    frames: Vec<Known>,
    /// The pass, from 0, and the next frame of it.
    pass: usize,
    next: usize,
    bends: Vec<PlannedBend>,
}

impl FilmPlanner {
    /// * `time_step_s`: seconds between frames, > 0.
    ///
    /// # Errors
    /// [`ConstructError::Parameter`].
    pub fn new(options: TrackingOptions, time_step_s: f64) -> Result<Self, ConstructError> {
        options.check()?;
        let memory = TrackingMemory::default();
        Ok(Self { options, time_step_s, memory, frames: Vec::new(), pass: 0, next: 0, bends: Vec::new() })
    }

    /// The next frame of the pass; the arguments are those of [`super::track_target`].
    pub fn add(&mut self, scene: &Scene, base: &View, target: &Target) {
        let sight = TargetSight::new(scene, target);
        let search = Search::new(base, target, &self.options, &sight, &self.memory);
        let grow = self.options.grow_px;
        let seen = |[x, y]: [f64; 2]| -> Seen {
            // The square has corners beyond the rim.
            let f = x.hypot(y).min(1.0);
            let at = if y == 0.0 { (x, 0.0) } else { (f, y.atan2(x).to_degrees()) };
            let share = search.seen(at, 0.0);
            (share as f32, share >= WHOLE && (grow == 0.0 || search.seen(at, grow) >= WHOLE))
        };
        if self.pass == 0 {
            let grid = ((1.0 / self.options.f_step).ceil() as usize).clamp(1, MOST);
            let at = |k: usize| [k as f64 / grid as f64 - 1.0, 0.0];
            let sideways = (0..=2 * grid).into_par_iter().map(|k| seen(at(k))).collect();
            self.frames.push(Known { sideways, ..Known::default() });
        } else if let Some(known) = self.frames.get(self.next) {
            let side = WIDE[self.pass - 1];
            let width = 2 * side + 1;
            let node = |k: usize| -> Seen {
                let [x, y] = [k % width, k / width].map(|i| i as f64 / side as f64 - 1.0);
                // Nodes that no cell of the disc has at its corners.
                if x.hypot(y) > 1.0 + std::f64::consts::SQRT_2 / side as f64 {
                    return (0.0, false);
                }
                match y == 0.0 {
                    true => known.sideways(x),
                    false => known.node([x, y]).unwrap_or_else(|| seen([x, y])),
                }
            };
            let wide = (0..width * width).into_par_iter().map(node).collect();
            let sideways = known.sideways.clone();
            self.frames[self.next] = Known { sideways, wide, side };
        }
        let right = search.right();
        self.memory.keep_side(right);
        self.next += 1;
    }

    /// Plans by what is known. Whether another pass over all frames, with more places to look from, may find a better way.
    pub fn wants_more(&mut self) -> bool {
        let disc = Disc::new(self.options.cap_per_s * self.time_step_s, self.pass == 0);
        let knots = self.frames.len().div_ceil(disc.stride);
        let cost = |knot: usize| {
            let mut sum = vec![0.0; disc.places.len()];
            for known in self.frames.iter().skip(knot * disc.stride).take(disc.stride) {
                for (sum, place) in sum.iter_mut().zip(&disc.places) {
                    *sum += self.cost(known, place.map(|i| f64::from(i) * disc.cell));
                }
            }
            sum
        };
        let (least, way) = disc.cheapest(knots, cost);
        let place = |knot: usize| way.get(knot).map(|&n| disc.places[n].map(|i| f64::from(i) * disc.cell));
        let offsets = (0..self.frames.len()).map(|k| {
            let from = place(k / disc.stride).unwrap_or_default();
            let to = place(k / disc.stride + 1).unwrap_or(from);
            let share = (k % disc.stride) as f64 / disc.stride as f64;
            [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
        });
        self.bends = bends(offsets);
        (self.pass, self.next) = (self.pass + 1, 0);
        let better = least >= HIDDEN || (self.pass == 1 && turnings(&self.bends) > 1);
        better && self.pass <= WIDE.len()
    }

    /// What a place costs in a frame.
    fn cost(&self, known: &Known, [x, y]: [f64; 2]) -> f64 {
        let (share, is_clear) = known.at([x, y]);
        let share = f64::from(share);
        let hidden = if share >= WHOLE { 0.0 } else { HIDDEN * (1.5 - 0.5 * share) };
        let tight = if is_clear { 0.0 } else { TIGHT };
        hidden + self.time_step_s * (tight + BENT * x.hypot(y) + ASIDE * y.abs())
    }

    /// The bend of every frame.
    pub fn finish(self) -> Vec<PlannedBend> {
        self.bends
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

    /// A node of the wide search, if it has one there.
    fn node(&self, place: [f64; 2]) -> Option<Seen> {
        let [x, y] = place.map(|v| (v + 1.0) * self.side as f64);
        let is_node = !self.wide.is_empty() && x.fract() == 0.0 && y.fract() == 0.0;
        is_node.then(|| self.wide[y as usize * (2 * self.side + 1) + x as usize])
    }

    /// What is seen from a place: as much as from all of the places around it that are known.
    fn at(&self, [x, y]: [f64; 2]) -> Seen {
        if y == 0.0 {
            return self.sideways(x);
        }
        if self.wide.is_empty() {
            return (0.0, false);
        }
        let width = 2 * self.side + 1;
        let ends = |v: f64| {
            let at = (v + 1.0) * self.side as f64;
            [(at + 1e-6).floor() as usize, ((at - 1e-6).ceil() as usize).min(width - 1)]
        };
        let (columns, rows) = (ends(x), ends(y));
        let corners = rows.into_iter().flat_map(|r| columns.map(|c| self.wide[r * width + c]));
        corners.reduce(both).unwrap_or_default()
    }
}

fn both(a: Seen, b: Seen) -> Seen {
    (a.0.min(b.0), a.1 && b.1)
}

/// Offsets, shares of `a` to the right and upwards, as f and a direction that does not jump.
fn bends(offsets: impl Iterator<Item = [f64; 2]>) -> Vec<PlannedBend> {
    let mut before = PlannedBend::default();
    let mut out = Vec::new();
    for [x, y] in offsets {
        let length = x.hypot(y);
        if length < 1e-12 {
            before.f = 0.0;
        } else if y == 0.0 && before.direction_deg == 0.0 {
            before.f = x;
        } else {
            let sign = if before.f < 0.0 { -1.0 } else { 1.0 };
            let toward = |sign: f64| (sign * y).atan2(sign * x).to_degrees();
            let turn = |sign: f64| (toward(sign) - before.direction_deg + 540.0).rem_euclid(360.0) - 180.0;
            // Straight through the middle f changes its sign, not its direction.
            let sign = if turn(sign).abs() > 179.0 { -sign } else { sign };
            before = PlannedBend { f: sign * length, direction_deg: toward(sign) };
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
