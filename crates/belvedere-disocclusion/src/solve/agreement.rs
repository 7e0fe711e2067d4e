//! Agreement of the quadratic program with the judge: hidden points bring rows, and the program is solved again.
//!
//! A point that the program leaves hidden mostly lies between two candidates: it becomes a candidate. Where the ground moves otherwise
//! than the program's grid, at lakes, where detail moves, and at the samples of a file to be written, the ground that hides a point
//! brings a row by itself: there it must sink against the line of sight by as much as it rises over it. That is linear but for which
//! node of a bank moves with its lake, so that a few rounds meet it.

use super::super::metrics::Judge;
use super::super::visibility_qp::{Candidate, GivenRow, QpOptions, QpProblem, QpResult, QpSolver, SolvedRow};
use super::super::{Field, Hierarchy, ReferencePoint};
use super::file_to_write::{FileJudge, HiddenInFile};
use super::waters::Waters;
use super::{at_every_node, fallback, on_grid};
use crate::DisocclusionError;
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, TerrainDisocclusion};
use belvedere_scene::Progress;
use std::collections::{BTreeMap, BTreeSet};

/// Judgements at most.
const ROUNDS: usize = 8;
/// Judgements at most where rows of the judge itself are needed.
const ROUNDS_WITH_ROWS: usize = 24;
/// The same where the program has more than [`FEW_ROWS`], for then each solution takes long.
const ROUNDS_OF_MANY: usize = 3;
const FEW_ROWS: usize = 2000;
/// Share of the judged points for which a finer grid is tried where there are more than [`MANY`] candidates.
const WORTH: f64 = 0.1;
const MANY: usize = 2000;
/// Judgements in succession that find no fewer hidden points, at most.
const IN_VAIN: usize = 4;
/// Most that agreement may cost, as a multiple of the root mean square displacement before, and what is added to it, metres: the rows that
/// take most are given up then.
const MOST_COST: f64 = 1.3;
const SPARE_M: f64 = 0.5;
/// Share of the energy of the rows of the judge that is given up at once.
const DEAREST: f64 = 0.5;
/// Height added to a rise, metres, so that neighbouring positions do not rise over the line in the next round.
const ROOM_M: f64 = 0.25;

/// Arguments of the agreement between the program and the judge.
pub(super) struct Agreement<'a> {
    pub(super) field: &'a Field,
    /// The solver's grid.
    pub(super) grid: &'a Hierarchy,
    /// Change of detail at every node.
    pub(super) detail: Option<&'a [f64]>,
    pub(super) waters: &'a Waters,
    pub(super) files: &'a [FileJudge<'a>],
    /// Whether a point was given up.
    pub(super) gave_up: &'a (dyn Fn(&ReferencePoint) -> bool + Sync),
    /// Points by which the result is judged.
    pub(super) check: &'a [Candidate],
    pub(super) options: QpOptions,
    pub(super) progress: &'a Progress,
}

/// A point that is hidden.
struct Found {
    /// On the solved ground, the point as a candidate.
    candidate: Option<Candidate>,
    hides: HiddenInFile,
}

/// Numbers of hidden points; fewer on the ground count more, for files are judged where it hides none.
#[derive(Default, Clone, Copy, PartialEq, PartialOrd)]
struct Left {
    /// On the ground that is solved on.
    on_ground: usize,
    all: usize,
}

impl Left {
    fn of(found: &[Found]) -> Self {
        Self { all: found.len(), on_ground: found.iter().filter(|f| f.candidate.is_some()).count() }
    }
}

/// What is asked of the program.
struct Asked {
    candidates: Vec<Candidate>,
    known: BTreeSet<u32>,
    given: Vec<GivenRow>,
    /// Whether every hidden point brings a row, or only one that is a candidate or lies on a file.
    by_rows: bool,
    /// Cells of points whose rows were given up.
    too_dear: BTreeSet<(i64, i64)>,
}

impl Asked {
    fn new(problem: &QpProblem<'_>, qp: &QpSolver, by_rows: bool) -> Self {
        let candidates = problem.candidates.to_vec();
        let known = candidates.iter().map(|c| c.id).collect();
        Self { candidates, known, given: qp.given().to_vec(), by_rows, too_dear: BTreeSet::new() }
    }

    /// Asks for hidden points too.
    ///
    /// * `u`: the displacement under which they are hidden.
    fn take_in(&mut self, found: &[Found], qp: &QpSolver, u: &[f64]) {
        for Found { candidate, hides } in worst_of_cells(found) {
            let HiddenInFile { point, at, tau, over } = *hides;
            if self.too_dear.contains(&cell_of(point)) {
                continue;
            }
            let new = candidate.filter(|candidate| self.known.insert(candidate.id));
            self.candidates.extend(new);
            if self.by_rows || new.is_none() {
                self.given.push(qp.lowering(u, [at, point], tau, over + ROOM_M));
            }
        }
    }

    /// Gives up the rows of the judge that take most of the energy of all of them, with the cells of their points; whether there were any.
    fn drop_dearest(&mut self, result: &QpResult) -> bool {
        let energy = |row: &SolvedRow| {
            let index = row.given.filter(|index| !self.given[*index as usize].is_order)?;
            Some((index, row.multiplier * row.bound.abs()))
        };
        let mut dearest: Vec<(u32, f64)> = result.active.iter().filter_map(energy).collect();
        dearest.sort_by(|a, b| b.1.total_cmp(&a.1));
        let all: f64 = dearest.iter().map(|(_, energy)| energy).sum();
        let (mut gone, before) = (0.0, self.too_dear.len());
        for (index, energy) in &dearest {
            self.too_dear.insert(cell_of(self.given[*index as usize].point));
            gone += energy;
            if gone >= DEAREST * all {
                break;
            }
        }
        self.given.retain(|row| row.is_order || !self.too_dear.contains(&cell_of(row.point)));
        self.too_dear.len() > before
    }
}

impl Agreement<'_> {
    /// Judges and solves until the judge finds no hidden point that the program counts as seen, or solving again gains nothing; then
    /// again for the files that must not cost too much.
    /// Returns the best result and, where a finer grid may show more, the number of points that it hides.
    ///
    /// * `qp`: the solver, set to the undisplaced ground with its change of detail; `result`: its solution.
    pub(super) fn reach(
        &self,
        qp: &mut QpSolver,
        problem: &QpProblem<'_>,
        result: QpResult,
    ) -> Result<(QpResult, usize), DisocclusionError> {
        let dear: Vec<&FileJudge<'_>> = self.files.iter().filter(|file| file.at_most().is_some()).collect();
        let firm: Vec<&FileJudge<'_>> = self.files.iter().filter(|file| file.at_most().is_none()).collect();
        let (best, left) = self.reach_over(&firm, qp, problem, result)?;
        // A finer grid takes long where much is asked for.
        let few = problem.candidates.len() > MANY && (left.on_ground as f64) < WORTH * self.check.len() as f64;
        let on_ground = if self.needs_rows() && !few { left.on_ground } else { 0 };
        let Some(at_most) = dear.iter().filter_map(|file| file.at_most()).reduce(f64::min) else {
            return Ok((best, on_ground));
        };
        if left.all > 0 || best.stopped || fallback::stuck(&best) > 0 {
            return Ok((best, on_ground));
        }
        let (all, given) = ([&firm[..], &dear].concat(), qp.given().to_vec());
        let (next, left) = self.reach_over(&all, qp, problem, best.clone())?;
        if left.all == 0 && !next.stopped && rms(&next.u) <= at_most * rms(&best.u) {
            return Ok((next, on_ground));
        }
        qp.keep_clear(&given);
        Ok((best, on_ground))
    }

    /// See [`Self::reach`].
    fn reach_over(
        &self,
        files: &[&FileJudge<'_>],
        qp: &mut QpSolver,
        problem: &QpProblem<'_>,
        result: QpResult,
    ) -> Result<(QpResult, Left), DisocclusionError> {
        // The limits fill such a lake up again.
        let in_vain = |u: &[f64]| !self.waters.lakes.is_empty() && u.iter().any(|u| *u < -self.field.relief());
        // With a price of slack the program leaves points covered on purpose.
        if self.options.slack_price.is_some() {
            return Ok((result, Left::default()));
        }
        // When time is up, the report lists the hidden points.
        if self.progress.should_end() {
            return Ok((QpResult { stopped: true, ..result }, Left::default()));
        }
        let most = match self.needs_rows() || !files.is_empty() {
            true if result.rows <= FEW_ROWS => ROUNDS_WITH_ROWS,
            true => ROUNDS_OF_MANY,
            false => ROUNDS,
        };
        let mut asked = Asked::new(problem, qp, self.needs_rows());
        let mut found = self.hidden(problem, &result, files)?;
        let mut judged = result.u.clone();
        let most_m = MOST_COST * rms(&result.u) + SPARE_M;
        let (mut best, mut fewest, mut since) = (result, Left::of(&found), 0);
        let (mut given_to_best, mut is_new) = (asked.given.clone(), true);
        if in_vain(&best.u) {
            return Ok((best, fewest));
        }
        for _ in 1..most {
            if found.is_empty() || since >= IN_VAIN || self.progress.should_end() {
                break;
            }
            if std::mem::take(&mut is_new) {
                asked.take_in(&found, qp, &judged);
            }
            qp.keep_clear(&asked.given);
            let next = qp.solve_with(&QpProblem { candidates: &asked.candidates, ..*problem }, self.progress)?;
            if next.stopped {
                break;
            }
            if self.progress.should_end() {
                best.stopped = true;
                break;
            }
            if rms(&next.u) > most_m || fallback::stuck(&next) > fallback::stuck(&best) {
                if !asked.drop_dearest(&next) {
                    break;
                }
                continue;
            }
            (found, is_new) = (self.hidden(problem, &next, files)?, true);
            judged.clone_from(&next.u);
            let (rounds, added, kept) = (best.rounds + next.rounds, best.added + next.added, best.kept);
            since += 1;
            if Left::of(&found) < fewest {
                (fewest, best, since) = (Left::of(&found), next, 0);
                given_to_best.clone_from(&asked.given);
            }
            best = QpResult { rounds, added, kept, ..best };
        }
        qp.keep_clear(&given_to_best);
        best.stopped |= self.progress.is_late() && fewest.all > 0;
        Ok((best, fewest))
    }

    /// Whether the solved ground moves otherwise than the program's grid.
    fn needs_rows(&self) -> bool {
        !self.waters.lakes.is_empty() || self.detail.is_some()
    }

    /// Points that a solution leaves hidden and does not list as unresolved: on the ground that is solved on or, if there are none, on
    /// the files.
    fn hidden(
        &self,
        problem: &QpProblem<'_>,
        result: &QpResult,
        files: &[&FileJudge<'_>],
    ) -> Result<Vec<Found>, DisocclusionError> {
        self.progress.tick("what the displaced ground hides", 0.9)?;
        let delta = match (self.detail, self.waters.is_empty()) {
            (None, true) => on_grid(self.field, self.grid, &result.u)?,
            (detail, _) => at_every_node(self.field, &self.waters.whole(self.grid, &result.u, detail))?,
        };
        let named: BTreeSet<u32> = result.unresolved.iter().map(|u| u.id).collect();
        let judged = self.check.iter().chain(problem.candidates).filter(|c| !named.contains(&c.id));
        let judged: Vec<Candidate> = judged.copied().collect();
        let places: Vec<(DVec2, f64)> = judged.iter().map(|c| (c.grid, c.lift)).collect();
        let hiding = Judge::new(self.field, &delta, problem.sight).hiding(&places, 0.0);
        let found: Vec<Found> = judged
            .iter()
            .zip(hiding)
            .filter_map(|(candidate, hides)| {
                let (at, over) = hides?;
                let tau = share_of_way(problem, candidate.grid, at);
                Some(Found {
                    candidate: Some(*candidate),
                    hides: HiddenInFile { point: candidate.grid, at, tau, over },
                })
            })
            .collect();
        if found.is_empty() { self.hidden_in_files(files, problem, &named, delta) } else { Ok(found) }
    }

    fn hidden_in_files(
        &self,
        files: &[&FileJudge<'_>],
        problem: &QpProblem<'_>,
        named: &BTreeSet<u32>,
        delta: Grid,
    ) -> Result<Vec<Found>, DisocclusionError> {
        if files.is_empty() {
            return Ok(Vec::new());
        }
        let moved = |i: usize| delta.sample(self.field.scene_from_grid(self.field.node(i))).unwrap_or(0.0);
        let lakes = self.waters.lakes.report(moved);
        // What the program cannot show on the solved ground it cannot show on a file.
        let cell = |g: DVec2| (g.x.round() as i64, g.y.round() as i64);
        let candidates = self.check.iter().chain(problem.candidates).filter(|c| named.contains(&c.id));
        let around = |c: &Candidate| {
            let (x, y) = cell(c.grid);
            (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| (x + dx, y + dy)))
        };
        let unresolved: BTreeSet<(i64, i64)> = candidates.flat_map(around).collect();
        let is_asked = |p: &ReferencePoint| !unresolved.contains(&cell(p.grid)) && !(self.gave_up)(p);
        let stage = TerrainDisocclusion::new(delta);
        let mut out = Vec::new();
        for file in files {
            let hidden = file.hidden((self.field, self.grid), (&stage, &lakes), &is_asked, self.progress)?;
            out.extend(hidden.into_iter().map(|hides| Found { candidate: None, hides }));
        }
        Ok(out)
    }
}

/// Cell of a point.
fn cell_of(point: DVec2) -> (i64, i64) {
    (point.x.floor() as i64, point.y.floor() as i64)
}

/// Root mean square.
fn rms(u: &[f64]) -> f64 {
    (u.iter().map(|u| u * u).sum::<f64>() / u.len().max(1) as f64).sqrt()
}

/// Share of the way from a point to the eye at which a position of its line of sight lies.
fn share_of_way(problem: &QpProblem<'_>, point: DVec2, at: DVec2) -> f64 {
    let mut line = Vec::new();
    problem.sight.trace(point, 0.0, &mut line);
    let (mut way, mut reached, mut nearest) = (0.0, 0.0, f64::INFINITY);
    for pair in line.windows(2) {
        let [a, b] = [pair[0].0, pair[1].0];
        let length = a.distance(b);
        let t = ((at - a).dot(b - a) / (length * length).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let away = at.distance(a.lerp(b, t));
        if away < nearest {
            (nearest, reached) = (away, way + t * length);
        }
        way += length;
    }
    if way > 0.0 { reached / way } else { 0.0 }
}

/// Rows and candidates from one judgement at most: points near them mostly become visible with them.
const MOST_NEW: usize = 4000;

/// The most hidden point of each grid cell, or of each larger square if there are very many.
fn worst_of_cells(found: &[Found]) -> Vec<&Found> {
    let mut size = 1.0;
    loop {
        let mut worst = BTreeMap::new();
        for f in found {
            let cell = (f.hides.point / size).floor();
            let slot = worst.entry((cell.x as i64, cell.y as i64)).or_insert(f);
            if f.hides.over > slot.hides.over {
                *slot = f;
            }
        }
        if worst.len() <= MOST_NEW {
            return worst.into_values().collect();
        }
        size *= 2.0;
    }
}
