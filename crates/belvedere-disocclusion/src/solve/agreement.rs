//! Agreement of the quadratic program with the judge: hidden points become candidates, and the program is solved again.
//!
//! A point that the program leaves hidden lies between two candidates: it becomes a candidate. Where detail moves too, the displacement
//! of the nodes differs from the program's, on grid cells of hundreds of metres by many metres. Where such ground rises
//! over the line of sight of a known candidate, the program's heights are raised by that much; likewise at a small lake, which is
//! level on the ground but not on the program's grid.

use super::super::metrics::Judge;
use super::super::visibility_qp::{Candidate, QpOptions, QpProblem, QpResult, QpSolver};
use super::super::{Field, Hierarchy};
use super::waters::Waters;
use super::{at_every_node, fallback, on_grid};
use crate::DisocclusionError;
use belvedere_core::DVec2;
use belvedere_scene::Progress;
use std::collections::{BTreeMap, BTreeSet};

/// Judgements at most, without lakes.
const ROUNDS: usize = 8;
/// Judgements at most, on ground with lakes.
const ROUNDS_WITH_LAKES: usize = 2;
/// Height added to a raise, metres, so that neighbouring positions do not rise over the line in the next round.
const ROOM_M: f64 = 0.25;

/// Ground nearer than this to a point is not raised, grid cells: the point would rise with it.
const NEAR: f64 = 1.5;

/// Arguments of the agreement between the program and the judge.
pub(super) struct Agreement<'a> {
    pub(super) field: &'a Field,
    /// The solver's grid.
    pub(super) grid: &'a Hierarchy,
    /// Change of detail at every node.
    pub(super) detail: Option<&'a [f64]>,
    pub(super) waters: &'a Waters,
    /// Points by which the result is judged.
    pub(super) check: &'a [Candidate],
    pub(super) options: QpOptions,
    pub(super) progress: &'a Progress,
}

/// A point that is hidden.
struct Found {
    candidate: Candidate,
    /// Position at which ground hides it most, grid coordinates, and the rise of that ground over the line, metres.
    at: DVec2,
    over: f64,
}

impl Agreement<'_> {
    /// Judges and solves until the judge finds no hidden point that the program counts as seen, or solving again gains nothing.
    /// Returns the best result and, on ground with lakes, the number of points that it hides.
    ///
    /// * `qp`: the solver, set to `ground`, the undisplaced ground with its change of detail; `result`: its solution.
    pub(super) fn reach(
        &self,
        qp: &mut QpSolver,
        ground: &[f64],
        problem: &QpProblem<'_>,
        result: QpResult,
    ) -> Result<(QpResult, usize), DisocclusionError> {
        // A lake that sinks by more than the relief is filled up again by the limits; no more solutions then.
        let in_vain = |u: &[f64]| !self.waters.lakes.is_empty() && u.iter().any(|u| *u < -self.field.relief());
        // With a price of slack the program leaves points covered on purpose.
        if self.options.slack_price.is_some() || in_vain(&result.u) {
            return Ok((result, 0));
        }
        let mut told = ground.to_vec();
        let mut asked = problem.candidates.to_vec();
        let mut known: BTreeSet<u32> = asked.iter().map(|c| c.id).collect();
        // When time is up, the report lists the hidden points.
        if self.progress.should_end() {
            return Ok((QpResult { stopped: true, ..result }, 0));
        }
        let mut found = self.hidden(problem, &result)?;
        let (mut best, mut fewest) = (result, found.len());
        // The program cannot show points that a small lake hides, for such a lake is made level after solving.
        let most = if self.waters.lakes.is_empty() { ROUNDS } else { ROUNDS_WITH_LAKES };
        for _ in 1..most {
            if found.is_empty() || self.progress.should_end() {
                break;
            }
            let before = told.clone();
            for Found { candidate, at, over } in &worst_of_cells(&found) {
                if known.insert(candidate.id) {
                    asked.push(*candidate);
                } else if candidate.grid.distance(*at) > self.options.guard.max(NEAR) {
                    for node in self.around(*at) {
                        told[node] = told[node].max(before[node] + over + ROOM_M);
                    }
                }
            }
            if told != before {
                qp.set_heights(&told)?;
            }
            let next = qp.solve_with(&QpProblem { candidates: &asked, ..*problem }, self.progress)?;
            if next.stopped || in_vain(&next.u) || fallback::stuck(&next) > fallback::stuck(&best) {
                break;
            }
            if self.progress.should_end() {
                best.stopped = true;
                break;
            }
            found = self.hidden(problem, &next)?;
            let (rounds, added, kept) = (best.rounds + next.rounds, best.added + next.added, best.kept);
            if found.len() < fewest {
                (fewest, best) = (found.len(), next);
            }
            best = QpResult { rounds, added, kept, ..best };
        }
        best.stopped |= self.progress.is_late() && fewest > 0;
        Ok((best, if self.waters.lakes.is_empty() { 0 } else { fewest }))
    }

    /// Points that a solution leaves hidden and does not list as unresolved.
    fn hidden(&self, problem: &QpProblem<'_>, result: &QpResult) -> Result<Vec<Found>, DisocclusionError> {
        self.progress.tick("what the displaced ground hides", 0.9)?;
        let delta = match (self.detail, self.waters.is_empty()) {
            (None, true) => on_grid(self.field, self.grid, &result.u)?,
            (detail, _) => at_every_node(self.field, &self.waters.whole(self.grid, &result.u, detail))?,
        };
        let named: BTreeSet<u32> = result.unresolved.iter().map(|u| u.id).collect();
        let judged = self.check.iter().chain(problem.candidates).filter(|c| !named.contains(&c.id));
        let judged: Vec<Candidate> = judged.copied().collect();
        let places: Vec<(DVec2, f64)> = judged.iter().map(|c| (c.grid, c.lift)).collect();
        let hiding = Judge::new(self.field, &delta, problem.sight).hiding(&places);
        let found = judged
            .iter()
            .zip(hiding)
            .filter_map(|(candidate, hides)| hides.map(|(at, over)| Found { candidate: *candidate, at, over }));
        Ok(found.collect())
    }

    /// The four nodes of the grid cell around a position.
    fn around(&self, at: DVec2) -> [usize; 4] {
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n.saturating_sub(2));
        let (cols, rows) = (self.field.cols(), self.field.rows());
        let nw = index(at.y, rows) * cols + index(at.x, cols);
        [nw, nw + 1, nw + cols, nw + cols + 1]
    }
}

/// New candidates from one judgement at most: points near them mostly become visible with them.
const MOST_NEW: usize = 4000;

/// The most hidden point of each grid cell, or of each larger square if there are very many.
fn worst_of_cells(found: &[Found]) -> Vec<&Found> {
    let mut size = 1.0;
    loop {
        let mut worst = BTreeMap::new();
        for f in found {
            let cell = (f.candidate.grid / size).floor();
            let slot = worst.entry((cell.x as i64, cell.y as i64)).or_insert(f);
            if f.over > slot.over {
                *slot = f;
            }
        }
        if worst.len() <= MOST_NEW {
            return worst.into_values().collect();
        }
        size *= 2.0;
    }
}
