//! The candidates of one frame with their lines of sight, and the rows that follow from them.

use super::combination::Combination;
use super::problem::{Candidate, QpProblem};
use super::row::{Constraint, Row};
use super::surface::Surface;
use super::walk::{Chord, Clearance, Touch};
use belvedere_core::DVec2;
use rayon::prelude::*;
use std::sync::Arc;

/// Distance along a line of sight within which a row of the frame before is found again, grid cells.
const FOLLOW: f64 = 2.5;

/// A candidate with its line of sight.
#[derive(Debug, Clone)]
pub(super) struct CandidateLine {
    /// Index among the candidates.
    pub(super) index: usize,
    pub(super) grid: DVec2,
    pub(super) chords: Arc<[Chord]>,
    /// Displacement of the candidate for which the chords hold.
    reference: f64,
    /// Displacement of the candidate.
    moves: Combination,
}

impl CandidateLine {
    /// Lines of sight of all candidates, which are displaced as the surface is unless lines are straight. A candidate
    /// without a line has no chords.
    pub(super) fn all(problem: &QpProblem, surface: &Surface) -> Vec<Self> {
        let of = |index: usize| {
            let Candidate { grid, .. } = problem.candidates[index];
            let moves = Combination::of_grid(&surface.lattice, grid);
            let mut seen = Self { index, grid, chords: Arc::new([]), reference: 0.0, moves };
            if problem.sight.straight().is_none() {
                seen.reference = seen.displacement(&surface.u);
            }
            seen.trace(problem, surface);
            seen
        };
        (0..problem.candidates.len()).into_par_iter().with_min_len(32).map(of).collect()
    }

    /// Traces again the lines of sight of candidates that moved by more than `moved` since; returns how many.
    pub(super) fn follow_up(all: &mut [Self], problem: &QpProblem, surface: &Surface, moved: f64) -> usize {
        let renew = |seen: &mut Self| {
            let d = seen.displacement(&surface.u);
            let far = (d - seen.reference).abs() > moved;
            if far {
                seen.reference = d;
                seen.trace(problem, surface);
            }
            usize::from(far)
        };
        all.par_iter_mut().with_min_len(32).map(renew).sum()
    }

    fn trace(&mut self, problem: &QpProblem, surface: &Surface) {
        let mut line = Vec::new();
        let lift = problem.candidates[self.index].lift;
        problem.sight.trace(self.grid, surface.ground(self.grid) + lift + self.reference, &mut line);
        self.chords = chords(&line);
    }

    pub(super) fn displacement(&self, u: &[f64]) -> f64 {
        self.moves.at(u)
    }

    /// Plan distance to the eye, cells.
    pub(super) fn distance(&self) -> f64 {
        self.chords.last().map_or(0.0, |c| (c.ends[1] - self.grid).length())
    }

    /// The line of sight when the candidate is displaced by `d`.
    pub(super) fn line(&self, d: f64) -> impl Iterator<Item = Chord> {
        let shift = d - self.reference;
        self.chords
            .iter()
            .map(move |c| Chord { z: [c.z[0] + (1.0 - c.tau[0]) * shift, c.z[1] + (1.0 - c.tau[1]) * shift], ..*c })
    }

    /// `f(x) + B_x u - (1 - tau) B_P u <= z(x) - margin`, z(x) of the line of the undisplaced candidate.
    pub(super) fn row(&self, surface: &Surface, touch: &Touch, clearance: &Clearance) -> Row {
        let rest = 1.0 - touch.tau;
        let bound = touch.z
            - rest * self.moves.of_nodes(&surface.u)
            - touch.ground
            - clearance.margin * clearance.share(touch.tau);
        let constraint = Constraint::Sight { candidate: self.index, at: touch.at, tau: touch.tau };
        let ground = Combination::of_grid(&surface.lattice, touch.at);
        Row::sight((&ground, &self.moves), rest, bound, constraint)
    }

    /// The row of this candidate at `at` if its line passes there, else where the ground comes nearest to its line around `at`.
    pub(super) fn follow(&self, surface: &Surface, at: DVec2, clearance: &Clearance) -> Option<Row> {
        let mut best: Option<Touch> = None;
        for chord in self.line(self.displacement(&surface.u)) {
            let way = chord.ends[1] - chord.ends[0];
            let square = way.length_squared();
            let Some([from, to]) = chord.part(surface, self.grid, clearance.guard) else { continue };
            let t = (at - chord.ends[0]).dot(way) / square;
            if t > from && t < to && chord.is_at(t, at) {
                return Some(self.row(surface, &chord.place(surface, t, clearance), clearance));
            }
            let (t, reach) = ((at - chord.ends[0]).dot(way) / square, FOLLOW / square.sqrt());
            let part = [(t - reach).max(from), (t + reach).min(to)];
            if part[0] < part[1] {
                chord.kinks(surface, part, clearance, &mut |touch| {
                    if best.is_none_or(|b| touch.excess > b.excess) {
                        best = Some(touch);
                    }
                });
            }
        }
        best.map(|touch| self.row(surface, &touch, clearance))
    }
}

/// Chords of a polyline; the share of its length is measured in plan.
fn chords(line: &[(DVec2, f64)]) -> Arc<[Chord]> {
    let length = |p: &[(DVec2, f64)]| (p[1].0 - p[0].0).length();
    let total: f64 = line.windows(2).map(length).sum();
    if !(total > 0.0 && line.iter().all(|(g, z)| g.is_finite() && z.is_finite())) {
        return Arc::new([]);
    }
    let mut way = 0.0;
    line.windows(2)
        .map(|p| {
            let from = way / total;
            way += length(p);
            Chord { ends: [p[0].0, p[1].0], z: [p[0].1, p[1].1], tau: [from, way / total] }
        })
        .collect()
}
