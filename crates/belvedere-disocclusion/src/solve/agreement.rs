//! The quadratic program agrees with the judge.
//!
//! The program looks after candidates, over ground of triangles plus a displacement that is bilinear between the nodes of its own
//! grid, or flat on the terrain's triangles, as files hold it. What it leaves hidden all the same lies between two candidates; or the
//! ground hides it that is not its own: at first it looks at that of files. So both grounds are judged, and hidden places become
//! candidates over the ground that hides them. Where detail moves too, both are drawn as one displacement that is bilinear between the
//! nodes of the terrain, on cells of hundreds of metres other ground by many metres. Where such ground rises over the line of sight of a
//! candidate, the program is told that it stands so much higher there; so, too, where a lake is level that is not to the program's grid.

use super::super::metrics::Judge;
use super::super::visibility_qp::{Candidate, QpOptions, QpProblem, QpResult, QpSolver};
use super::super::{Field, Hierarchy};
use super::waters::Waters;
use super::{at_every_node, fallback, on_grid};
use crate::DisocclusionError;
use belvedere_core::DVec2;
use belvedere_scene::Progress;
use std::collections::{BTreeMap, BTreeSet};

/// Judgements at most.
const ROUNDS: usize = 8;
/// And over ground with lakes.
const ROUNDS_WITH_LAKES: usize = 2;
/// In the ids of candidates over ground with the bilinear displacement.
pub(super) const BILINEAR: u32 = 1 << 31;
/// Room left over what was found, metres: the places that hide nothing yet are not to come up in the next round.
const ROOM_M: f64 = 0.25;

/// Ground nearer than this to a point is not told to stand higher, cells: the point would stand on it.
const NEAR: f64 = 1.5;

/// What the program is to agree on with the judge.
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
    /// Where ground hides it most, and by how much, metres.
    at: DVec2,
    over: f64,
}

impl Agreement<'_> {
    /// Solves until nothing is hidden that the program holds for seen, or nothing more is gained. Answers the best result and, of ground
    /// with lakes, how many points it hides.
    ///
    /// * `qp`: knows `ground`, the undisplaced one with its change of detail; `result`: its solution.
    pub(super) fn reach(
        &self,
        qp: &mut QpSolver,
        ground: &[f64],
        problem: &QpProblem<'_>,
        result: QpResult,
    ) -> Result<(QpResult, usize), DisocclusionError> {
        // At a price the program leaves places covered.
        if self.options.slack_price.is_some() {
            return Ok((result, 0));
        }
        // A lake that sinks by more than the relief is filled up again by the limits; no more solutions then.
        let in_vain = |u: &[f64]| !self.waters.lakes.is_empty() && u.iter().any(|u| *u < -self.field.relief());
        if in_vain(&result.u) {
            return Ok((result, 0));
        }
        let mut told = ground.to_vec();
        let mut asked = problem.candidates.to_vec();
        let mut known: BTreeSet<u32> = asked.iter().map(|c| c.id).collect();
        // Where time is up the report says what is hidden.
        if self.progress.should_end() {
            return Ok((QpResult { stopped: true, ..result }, 0));
        }
        let mut found = self.hidden(problem, &result)?;
        let (mut best, mut fewest) = (result, found.len());
        // What a small lake hides that is levelled after solving, the program cannot mend.
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
            let (rounds, added) = (best.rounds + next.rounds, best.added + next.added);
            if found.len() < fewest {
                fewest = found.len();
                best = QpResult { rounds, added, kept: best.kept, ..next };
            } else {
                (best.rounds, best.added) = (rounds, added);
            }
        }
        best.stopped |= self.progress.is_late() && fewest > 0;
        Ok((best, if self.waters.lakes.is_empty() { 0 } else { fewest }))
    }

    /// Points that a solution leaves hidden though it does not name them.
    fn hidden(&self, problem: &QpProblem<'_>, result: &QpResult) -> Result<Vec<Found>, DisocclusionError> {
        self.progress.tick("what the displaced ground hides", 0.9)?;
        let delta = match (self.detail, self.waters.is_empty()) {
            (None, true) => on_grid(self.field, self.grid, &result.u)?,
            (detail, _) => at_every_node(self.field, &self.waters.whole(self.grid, &result.u, detail))?,
        };
        let named: BTreeSet<u32> = result.unresolved.iter().map(|u| u.id & !BILINEAR).collect();
        let judged = self.check.iter().chain(problem.candidates).filter(|c| !named.contains(&c.id));
        let judged: Vec<Candidate> = judged.copied().collect();
        let places: Vec<(DVec2, f64)> = judged.iter().map(|c| (c.grid, c.lift)).collect();
        let hiding = Judge::of_both(self.field, &delta, problem.sight).hiding(&places);
        let mut found = Vec::new();
        for (candidate, [facets, bilinear]) in judged.iter().zip(hiding) {
            found.extend(facets.map(|(at, over)| Found { candidate: *candidate, at, over }));
            let candidate = Candidate { id: candidate.id | BILINEAR, faceted: false, ..*candidate };
            found.extend(bilinear.map(|(at, over)| Found { candidate, at, over }));
        }
        Ok(found)
    }

    /// Nodes of the cell around a place.
    fn around(&self, at: DVec2) -> [usize; 4] {
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n.saturating_sub(2));
        let (cols, rows) = (self.field.cols(), self.field.rows());
        let nw = index(at.y, rows) * cols + index(at.x, cols);
        [nw, nw + 1, nw + cols, nw + cols + 1]
    }
}

/// New candidates from one judgement at most, about: what is near them is mostly seen with them.
const MOST_NEW: usize = 4000;

/// Of the hidden points of one cell, or of some cells where there are very many, the one that is hidden most.
fn worst_of_cells(found: &[Found]) -> Vec<&Found> {
    let mut size = 1.0;
    loop {
        let mut worst = BTreeMap::new();
        for f in found {
            let cell = (f.candidate.grid / size).floor();
            let slot = worst.entry((cell.x as i64, cell.y as i64, f.candidate.faceted)).or_insert(f);
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
