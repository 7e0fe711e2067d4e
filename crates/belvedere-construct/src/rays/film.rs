//! Target tracking of a film: the way of the second viewpoint through all frames, planned before the first is drawn.
//!
//! Ours: the paper tracks live, where the motion to come is unknown. A film knows it. In every frame the share of the target that is
//! seen is found on a grid of f along four directions across the view; the way that hides the target in the fewest frames, and of
//! those the one that moves and bends least, is a shortest path over frame, direction and f (Bellman 1957). Directions change at f = 0.

use super::tracking::{Search, WHOLE};
use super::{Target, TargetSight, TrackingMemory, TrackingOptions};
use crate::ConstructError;
use belvedere_core::View;
use belvedere_scene::Scene;
use rayon::prelude::*;

/// Directions of f > 0 across the view, degrees from the right of the picture upwards; the first is that of the paper.
pub(super) const DIRECTIONS_DEG: [f64; 4] = [0.0, 90.0, 45.0, 135.0];
/// States of f on either side of 0, at most: they bound the memory of a plan.
const MOST: usize = 250;
/// A frame that does not show the whole target costs more than any motion.
const HIDDEN: f64 = 1e6;
/// Cost of bending to f = 1 for a second, and of doing so in another direction than sideways; moving f by 1 costs 1.
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

/// Plans the bends of a film. Same frames, same plan.
#[derive(Debug)]
pub struct FilmPlanner {
    options: TrackingOptions,
    time_step_s: f64,
    directions: &'static [f64],
    /// Grid intervals from f = 0 to 1, states per interval, and states that f may move per frame.
    grid: usize,
    fine: usize,
    reach: usize,
    memory: TrackingMemory,
    /// Least cost of arriving at a state, direction by direction.
    cost: Vec<f64>,
    /// Where the cheapest way to each state comes from, frame by frame.
    parents: Vec<Vec<u16>>,
}

impl FilmPlanner {
    /// * `time_step_s`: seconds between frames, > 0; `sideways`: whether the viewpoint only goes left and right.
    ///
    /// # Errors
    /// [`ConstructError::Parameter`].
    pub fn new(options: TrackingOptions, time_step_s: f64, sideways: bool) -> Result<Self, ConstructError> {
        options.check()?;
        let grid = ((1.0 / options.f_step).ceil() as usize).clamp(1, MOST);
        let most = options.cap_per_s * time_step_s;
        // As fine as lets whole states make use of the speed.
        let used = |fine: &usize| {
            let states = most * (grid * fine) as f64 * (1.0 + 1e-9);
            states.floor() / states
        };
        let mut fine = 1;
        for next in 2..=MOST / grid {
            if used(&fine) < 0.95 && used(&next) > used(&fine) + 1e-6 {
                fine = next;
            }
        }
        let states = grid * fine;
        let reach = ((most * states as f64 * (1.0 + 1e-9)).floor() as usize).min(2 * states);
        let directions = &DIRECTIONS_DEG[..if sideways { 1 } else { DIRECTIONS_DEG.len() }];
        let (memory, cost, parents) = (TrackingMemory::default(), Vec::new(), Vec::new());
        Ok(Self { options, time_step_s, directions, grid, fine, reach, memory, cost, parents })
    }

    /// States of f.
    fn width(&self) -> usize {
        2 * self.grid * self.fine + 1
    }

    /// The next frame; the arguments are those of [`super::track_target`].
    pub fn add(&mut self, scene: &Scene, base: &View, target: &Target) {
        let state = self.costs_of(scene, base, target);
        let (width, zero) = (self.width(), self.grid * self.fine);
        let mut parents: Vec<u16> = (0..state.len() as u16).collect();
        let mut cost = state.clone();
        if !self.cost.is_empty() {
            let step = 1.0 / zero as f64;
            for (s, own) in state.iter().enumerate() {
                let (row, i) = (s / width * width, s % width);
                let from = (i.saturating_sub(self.reach)..=(i + self.reach).min(width - 1)).map(|j| {
                    let way = step * i.abs_diff(j) as f64;
                    // Of two ways of the same length the slower one.
                    (self.cost[row + j] + way * (1.0 + 0.2 * i.abs_diff(j) as f64 / self.reach.max(1) as f64), row + j)
                });
                let best = from.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((self.cost[s], s));
                (cost[s], parents[s]) = (best.0 + own, best.1 as u16);
            }
        }
        // Straight rays have no direction.
        let zeros = (0..self.directions.len()).map(|d| d * width + zero);
        if let Some(best) = zeros.clone().min_by(|a, b| cost[*a].total_cmp(&cost[*b])) {
            for z in zeros {
                (cost[z], parents[z]) = (cost[best], parents[best]);
            }
        }
        self.cost = cost;
        self.parents.push(parents);
    }

    /// What each state costs in a frame.
    fn costs_of(&mut self, scene: &Scene, base: &View, target: &Target) -> Vec<f64> {
        let sight = TargetSight::new(scene, target);
        let search = Search::new(base, target, &self.options, &sight, &self.memory);
        let points = 2 * self.grid + 1;
        let at = |k: usize| (k as f64 - self.grid as f64) / self.grid as f64;
        let seen = |k: usize| {
            let (direction, f) = (self.directions[k / points], at(k % points));
            let share = search.seen((f, direction), 0.0);
            let is_clear = share >= WHOLE && search.seen((f, direction), self.options.grow_px) >= WHOLE;
            (share, is_clear)
        };
        let shares: Vec<(f64, bool)> = (0..points * self.directions.len()).into_par_iter().map(seen).collect();
        let right = search.right();
        let cost = |s: usize| {
            let (d, i) = (s / self.width(), s % self.width());
            let near = [i / self.fine, i.div_ceil(self.fine)].map(|k| shares[d * points + k]);
            let share = near[0].0.min(near[1].0);
            let f = i as f64 / (self.grid * self.fine) as f64 - 1.0;
            let aside = if d == 0 { 0.0 } else { ASIDE };
            let hidden = if share >= WHOLE { 0.0 } else { HIDDEN * (1.5 - 0.5 * share) };
            let tight = if near[0].1 && near[1].1 { 0.0 } else { TIGHT };
            hidden + self.time_step_s * (tight + (BENT + aside) * f.abs())
        };
        let costs = (0..self.width() * self.directions.len()).map(cost).collect();
        self.memory.keep_side(right);
        costs
    }

    /// Whether the way hides some of the target in some frame.
    pub fn hides(&self) -> bool {
        self.cost.iter().copied().fold(f64::INFINITY, f64::min) >= HIDDEN
    }

    /// The bend of every frame.
    pub fn finish(self) -> Vec<PlannedBend> {
        let (width, zero) = (self.width(), self.grid * self.fine);
        let Some(mut s) = (0..self.cost.len()).min_by(|a, b| self.cost[*a].total_cmp(&self.cost[*b])) else {
            return Vec::new();
        };
        let mut out = Vec::with_capacity(self.parents.len());
        for parents in self.parents.iter().rev() {
            let f = (s % width) as f64 / zero as f64 - 1.0;
            out.push(PlannedBend { f, direction_deg: self.directions[s / width] });
            s = usize::from(parents[s]);
        }
        out.reverse();
        out
    }
}
