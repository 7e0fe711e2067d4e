//! The visibility program by row generation: each round adds some rows where the clearance is missed, until no row is missed.

use super::bundle::Bundle;
use super::candidate_line::CandidateLine;
use super::given_row::GivenRow;
use super::levels::Levels;
use super::matrix_free::Effort;
use super::metric::Metric;
use super::problem::{QpError, QpOptions, QpProblem, QpResult, Reason, Unresolved};
use super::rise::Rise;
use super::row::Constraint;
use super::row::Row;
use super::rows_in_play::{Accuracy, IDLE, NewRow, RememberedRow, RowKey, RowsInPlay};
use super::surface::{Lattice, Surface};
use super::uphill::{self, Uphill};
use super::walk::{Clearance, Touch};
use crate::Field;
use crate::rivers::Rivers;
use crate::smooth::{Between, Hierarchy, Smoother};
use belvedere_core::DVec2;
use belvedere_scene::Instant;
use belvedere_scene::Progress;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Rows are met to within this by the dual solver, metres.
const EXACT: f64 = 1e-6;
/// Rounds of ceilings between two checks of the lines of sight, at most.
const CEILING_ROUNDS: usize = 40;
/// Height by which given rows may be missed, scene units.
const GIVEN_ALLOWED: f64 = 0.05;
/// Depth to which the ground may sink, as a multiple of the range of heights of ground and lines; beyond it rows become soft.
const DEPTH: f64 = 4.0;
/// Price of slack where rows contradict each other.
const LAST_PRICE: f64 = 1e3;
/// New rows per round at most.
const MOST_NEW: usize = 2000;
/// While new rows are missed by more than this share of the first miss, rounds without a matrix meet rows only as far as it takes little
/// time, for which rows join depends little on it.
const COARSE: f64 = 0.1;
/// While a position is missed by more than this, metres, such rounds meet rows only to within `ROUGH_SHARE` of the largest new miss.
const FINE: f64 = 0.4;
const ROUGH_SHARE: f64 = 0.05;
const ROUGH: f64 = 3.0;
/// The least such tolerance, metres.
const ALMOST: f64 = 0.05;
/// Rounds in succession without a new row, at most, while rows or ceilings are still missed.
const STALLED: usize = 6;
/// Distance up to which a row stands for a missed position, steps of the solver's grid.
const KNOWN: f64 = 0.5;

/// The program over one terrain. Remembers rows, multipliers and displacement between frames.
#[derive(Debug, Clone)]
pub struct QpSolver {
    metric: Metric,
    surface: Surface,
    uphill: Uphill,
    options: QpOptions,
    kept: Vec<RememberedRow>,
    given: Vec<GivenRow>,
}

/// State of the solution of one frame.
struct Frame<'a> {
    problem: QpProblem<'a>,
    target: Vec<f64>,
    seen: Vec<CandidateLine>,
    bundles: Vec<Bundle>,
    pool: RowsInPlay,
    clearance: Clearance,
    /// Inverse price of slack, 0 = none.
    soft: f64,
    progress: &'a Progress,
}

impl QpSolver {
    /// * `field`: the ground;
    /// * `hierarchy`: the solver's grid over it;
    /// * `smoother`: H on that grid, without elevation rows.
    pub fn new(field: &Field, hierarchy: &Hierarchy, smoother: Smoother, options: QpOptions) -> Self {
        let lattice = Lattice { cols: hierarchy.cols(), rows: hierarchy.rows(), step: hierarchy.step() };
        let surface = Surface::new(field.heights(), field.cols(), field.rows(), lattice);
        Self {
            metric: Metric::new(smoother),
            surface,
            uphill: Uphill::default(),
            options,
            kept: Vec::new(),
            given: Vec::new(),
        }
    }

    /// From now on the nodes of each of these sets have one displacement. No node is in two of them.
    pub fn tie(&mut self, sets: &[Vec<u32>]) {
        self.metric.tie(sets);
    }

    /// From now on rows of sight take nodes on lakes to move with these.
    pub(crate) fn know_levels(&mut self, levels: Levels) {
        self.surface.levels = levels;
    }

    /// The rows that the solution keeps besides those that it finds by itself; rows that it had before keep their multipliers.
    pub(crate) fn keep_clear(&mut self, rows: &[GivenRow]) {
        if !rows.starts_with(&self.given) {
            self.kept.retain(|row| !matches!(row.key, RowKey::Given(_)));
        }
        self.given = rows.to_vec();
    }

    /// See [`Self::keep_clear`].
    pub(crate) fn given(&self) -> &[GivenRow] {
        &self.given
    }

    /// See [`GivenRow::lowering`].
    pub(crate) fn lowering(&self, u: &[f64], places: [DVec2; 2], tau: f64, by: f64) -> GivenRow {
        GivenRow::lowering(&self.surface, u, places, tau, by)
    }

    /// See [`GivenRow::in_order`].
    pub(crate) fn in_order(&self, places: [DVec2; 2], by: f64) -> GivenRow {
        GivenRow::in_order(&self.surface, places, by)
    }

    fn given_row(&self, index: u32) -> Row {
        self.given[index as usize].row(index)
    }

    /// From now on these rivers of the field do not run uphill.
    pub(crate) fn keep_downhill(&mut self, rivers: &Rivers) {
        self.uphill = Uphill::new(rivers, &self.surface.lattice);
        self.kept.retain(|row| !matches!(row.key, RowKey::River(_)));
    }

    /// Other ground on the same grid (in mode `paper+qp` detail may be scaled).
    ///
    /// # Errors
    /// [`QpError::Length`].
    pub fn set_heights(&mut self, heights: &[f64]) -> Result<(), QpError> {
        length("the ground", heights, self.surface.heights.len())?;
        self.surface.set_heights(heights);
        Ok(())
    }

    /// Begins the next frame with the rows of a solver on another grid over the same ground.
    ///
    /// * `u`: its displacement at the nodes of this grid, scene units.
    pub(crate) fn begin_from(&mut self, other: &Self, u: &[f64]) {
        let (from, to) = (other.surface.lattice, self.surface.lattice);
        // Bending counts per node, and so the price of a metre grows with the area of a cell.
        let share = (to.step.x * to.step.y) / (from.step.x * from.step.y);
        let nearest = |node: u32| {
            let at = DVec2::new((node as usize % from.cols) as f64, (node as usize / from.cols) as f64);
            let at = (at * from.step / to.step).round();
            let index = |v: f64, n: usize| (v as usize).min(n - 1);
            (index(at.y, to.rows) * to.cols + index(at.x, to.cols)) as u32
        };
        let row = |row: &RememberedRow| {
            let key = match row.key {
                RowKey::Ceiling(node) => RowKey::Ceiling(nearest(node)),
                key => key,
            };
            RememberedRow { key, multiplier: share * row.multiplier, ..*row }
        };
        self.kept = other.kept.iter().map(row).collect();
        self.surface.displace(u);
        self.given = other.given.iter().map(|row| row.on(&self.surface, u)).collect();
    }

    /// Parameters of the next frames.
    pub fn set_options(&mut self, options: QpOptions) {
        self.options = options;
    }

    /// Candidates low above the ground leave less of the margin: the ground right before them is as high as theirs.
    fn clearance(&self, problem: &QpProblem) -> Clearance {
        let QpOptions { margin, tolerance, near, guard, .. } = self.options;
        let lowest = problem.candidates.iter().map(|c| c.lift).fold(f64::INFINITY, f64::min);
        let near = if margin > 0.0 { near * (lowest / margin).clamp(0.0, 1.0) } else { near };
        Clearance { margin, tolerance, near, guard }
    }

    /// Forgets the frames before.
    pub fn reset(&mut self) {
        self.kept.clear();
        let rest = vec![0.0; self.surface.u.len()];
        self.surface.displace(&rest);
    }

    /// Solves one frame, beginning with the rows of the frame before.
    ///
    /// Lines of sight that are not straight are traced again from the displaced candidates until those stay where they are.
    ///
    /// # Errors
    /// Every [`QpError`].
    pub fn solve(&mut self, problem: &QpProblem) -> Result<QpResult, QpError> {
        self.solve_with(problem, &Progress::silent())
    }

    /// As [`Self::solve`]; reports its progress, and ends with the best result so far when it should.
    ///
    /// # Errors
    /// Every [`QpError`].
    pub fn solve_with(&mut self, problem: &QpProblem, progress: &Progress) -> Result<QpResult, QpError> {
        let begin = Instant::now();
        let nodes = self.surface.u.len();
        for (what, values) in [("the target", problem.target), ("the ceiling", problem.ceilings)] {
            length(what, values.unwrap_or(&self.surface.u), nodes)?;
        }
        self.check_eye(problem)?;
        let mut lines = CandidateLine::all(problem, &self.surface);
        let mut out = self.pass(problem, &lines, progress);
        if problem.sight.straight().is_none() {
            for _ in 0..10 {
                if out.stopped
                    || CandidateLine::follow_up(&mut lines, problem, &self.surface, 0.1 * self.options.tolerance) == 0
                {
                    break;
                }
                let next = self.pass(problem, &lines, progress);
                let (rounds, added) = (out.rounds + next.rounds, out.added + next.added);
                out = QpResult { rounds, added, kept: out.kept, ..next };
            }
        }
        out.milliseconds = begin.elapsed().as_secs_f64() * 1e3;
        Ok(out)
    }

    fn check_eye(&self, problem: &QpProblem) -> Result<(), QpError> {
        let Some((at, eye)) = problem.sight.straight() else { return Ok(()) };
        let last = DVec2::new((self.surface.cols - 1) as f64, (self.surface.rows - 1) as f64);
        if at.cmpge(DVec2::ZERO).all() && at.cmple(last).all() {
            let ground = self.surface.ground(at);
            if eye <= ground {
                return Err(QpError::EyeUnderGround { eye, ground, below: ground - eye });
            }
        }
        Ok(())
    }

    /// Solves with these lines of sight.
    fn pass(&mut self, problem: &QpProblem, lines: &[CandidateLine], progress: &Progress) -> QpResult {
        let o = self.options;
        let mut frame = Frame {
            problem: *problem,
            target: self.target(problem),
            seen: lines.to_vec(),
            bundles: Vec::new(),
            pool: RowsInPlay::default(),
            clearance: self.clearance(problem),
            soft: o.slack_price.map_or(0.0, |price| 1.0 / price),
            progress,
        };
        let mut out = QpResult::default();
        frame.drop_without_line(o.guard, &mut out.unresolved);
        frame.bundles = Bundle::all(&frame.seen, problem.sight.straight().is_some());
        self.take_up(&mut frame);
        out.kept = frame.pool.rows.len();
        let depth = self.depth(&frame);
        let (mut missed, mut effort, mut stalled, mut first) = (Vec::new(), Effort::Within(ROUGH), 0, 0.0f64);
        while out.rounds < o.rounds {
            let settled = self.settle(&mut frame, effort);
            missed = frame.missed(&self.surface, Some(fineness(out.rounds + 1).min(KNOWN) * self.surface.lattice.step));
            out.rounds += 1;
            out.stopped = progress.should_end();
            if out.stopped {
                break;
            }
            let all = missed.iter().map(|(_, touch)| touch.excess).fold(0.0, f64::max);
            first = first.max(all);
            frame.tell(out.rounds, all, first);
            if o.enough > 0.0 && all <= o.enough {
                break;
            }
            if frame.soft == 0.0 && self.surface.u.iter().any(|u| *u < -depth) {
                self.soften(&mut frame);
                continue;
            }
            let new = frame.thinned(&self.surface, &missed, out.rounds);
            let worst = new.iter().map(|row| row.at(&self.surface.u) - row.bound).fold(0.0, f64::max);
            let large = frame.pool.is_large(&self.metric);
            effort = match large {
                true if out.kept == 0 && worst > COARSE * first => Effort::Rough(ROUGH_SHARE * worst),
                true if all > FINE && !new.is_empty() => Effort::Within((ROUGH_SHARE * worst).max(ALMOST)),
                false if worst > FINE => Effort::Within((ROUGH_SHARE * worst).min(ROUGH)),
                _ => Effort::Exact,
            };
            stalled = if new.is_empty() { stalled + 1 } else { 0 };
            if new.is_empty() && (settled || stalled > STALLED) {
                break;
            }
            self.push(&mut frame, new);
        }
        if o.slack_price.is_some() {
            // Positions that are still missed were left hidden at their price.
            missed.clear();
        } else if !missed.is_empty() && !out.stopped {
            // All of them are reported.
            missed = frame.missed(&self.surface, None);
        }
        self.report(&frame, &missed, depth, &mut out);
        self.kept = frame.pool.kept(|i| problem.candidates[i].id);
        out
    }

    /// The target, with tied nodes moving together.
    fn target(&mut self, problem: &QpProblem) -> Vec<f64> {
        let Some(target) = problem.target else { return vec![0.0; self.surface.u.len()] };
        let mut target = target.to_vec();
        self.metric.level(&mut target);
        target
    }

    /// Greatest depth to which the ground may sink, scene units.
    fn depth(&self, frame: &Frame) -> f64 {
        let [low, mut high] = self.surface.range;
        // Lines may end over the eye.
        let eye = frame.problem.sight.straight().map(|(_, z)| z);
        for chord in frame.seen.iter().flat_map(|s| s.chords.iter()) {
            high = high.max(chord.z[0]).max(eye.unwrap_or(chord.z[1]));
        }
        DEPTH * (high - low)
    }

    /// Takes over the rows of the frame before, at their present positions.
    fn take_up(&self, frame: &mut Frame) {
        let by_id: BTreeMap<u32, usize> =
            frame.seen.iter().enumerate().map(|(k, s)| (frame.problem.candidates[s.index].id, k)).collect();
        let mut new = Vec::with_capacity(self.kept.len());
        for kept in &self.kept {
            let row = match kept.key {
                RowKey::Ceiling(node) => Some(self.ceiling_row(frame, node)),
                RowKey::River(stretch) => Some(self.uphill.row(stretch, &self.surface.lattice)),
                RowKey::Given(index) => Some(self.given_row(index)),
                RowKey::Sight { id, at } => {
                    by_id.get(&id).and_then(|&k| frame.seen[k].follow(&self.surface, at, &frame.clearance))
                }
            };
            let begin = (kept.multiplier, kept.idle);
            new.extend(row.map(|row| self.new_row(frame, row, begin)));
        }
        let kept = |row: &RememberedRow| if let RowKey::Given(index) = row.key { Some(index) } else { None };
        let kept: BTreeSet<u32> = self.kept.iter().filter_map(kept).collect();
        let others = (0..self.given.len() as u32).filter(|index| !kept.contains(index));
        new.extend(others.map(|index| self.new_row(frame, self.given_row(index), (0.0, 0))));
        frame.pool.extend(new, &self.metric);
    }

    fn ceiling(&self, frame: &Frame, node: usize) -> f64 {
        frame.problem.ceilings.map_or(self.options.ceiling, |c| c[node])
    }

    fn ceiling_row(&self, frame: &Frame, node: u32) -> Row {
        let at = Between::node(node, self.surface.lattice.cols, self.surface.lattice.rows);
        Row::ceiling(node, at, self.ceiling(frame, node as usize))
    }

    fn new_row(&self, frame: &Frame, row: Row, (multiplier, idle): (f64, u32)) -> NewRow {
        let excess = row.at(&frame.target) - row.bound;
        let soft = if row.is_firm() { 0.0 } else { frame.soft };
        let allowed = match row.constraint {
            Constraint::Ceiling(_) => self.options.ceiling_tolerance,
            Constraint::River(_) => uphill::ALLOWED,
            Constraint::Sight { tau, .. } => frame.clearance.tolerance * frame.clearance.share(tau),
            Constraint::Given(_) => GIVEN_ALLOWED,
        };
        // The walks find what is missed by more than is allowed.
        NewRow { row, excess, soft, allowed: 0.5 * allowed, multiplier, idle }
    }

    /// Adds rows that had no multiplier so far.
    fn push(&self, frame: &mut Frame, rows: impl IntoIterator<Item = Row>) {
        let new = rows.into_iter().map(|row| self.new_row(frame, row, (0.0, IDLE))).collect();
        frame.pool.extend(new, &self.metric);
    }

    /// Starts again with rows that may be missed at a price.
    fn soften(&self, frame: &mut Frame) {
        frame.soft = 1.0 / LAST_PRICE;
        let rows = std::mem::take(&mut frame.pool).rows;
        self.push(frame, rows);
    }

    /// Solves with the rows in play and adds ceilings until no node rises above its own, and likewise rows of rivers; without a
    /// matrix it adds them once, for the next round. Returns whether rows and ceilings are met as they must be in the end.
    fn settle(&mut self, frame: &mut Frame, effort: Effort) -> bool {
        let mut u = vec![0.0; frame.target.len()];
        let mut settled = false;
        let progress = frame.progress;
        for _ in 0..CEILING_ROUNDS {
            let accuracy = Accuracy { exact: EXACT, effort };
            let met = frame.pool.solve(&mut self.metric, accuracy, &|| !progress.should_end());
            frame.pool.displacement(&mut self.metric, &frame.target, &mut u);
            let risen = self.risen(frame, &u);
            let rising = self.uphill.rising(&u);
            if risen.is_empty() && rising.is_empty() {
                settled = met && (effort == Effort::Exact || !frame.pool.is_matrix_free());
                break;
            }
            let known = frame.pool.ceilings();
            let new = risen.into_iter().filter(|node| !known.contains(node));
            let ceilings = new.map(|node| self.ceiling_row(frame, node));
            let known = frame.pool.stretches();
            let rising = rising.into_iter().filter(|stretch| !known.contains(stretch));
            let rivers = rising.map(|stretch| self.uphill.row(stretch, &self.surface.lattice));
            let rows: Vec<Row> = ceilings.chain(rivers).collect();
            self.push(frame, rows);
            if frame.pool.is_matrix_free() || progress.should_end() {
                break;
            }
        }
        frame.moved(&self.surface, &u);
        self.surface.displace(&u);
        settled
    }

    /// Nodes above their ceiling, by more than the tolerance, and by more than their neighbours.
    fn risen(&self, frame: &Frame, u: &[f64]) -> Vec<u32> {
        let (cols, rows) = (self.surface.lattice.cols, self.surface.lattice.rows);
        let over = |j: usize| u[j] - self.ceiling(frame, j);
        let mut out = Vec::new();
        for i in 0..u.len() {
            let v = over(i);
            if v <= self.options.ceiling_tolerance {
                continue;
            }
            let (x, y) = (i % cols, i / cols);
            let mut around = (y.saturating_sub(1)..(y + 2).min(rows))
                .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(cols)).map(move |x| y * cols + x));
            if around.all(|j| over(j) < v || (over(j) == v && j <= i)) {
                out.push(i as u32);
            }
        }
        out
    }

    fn report(&self, frame: &Frame, missed: &[(usize, Touch)], depth: f64, out: &mut QpResult) {
        let id = |i: usize| frame.problem.candidates[i].id;
        out.u = self.surface.u.clone();
        out.rows = frame.pool.rows.len();
        out.added = out.rows - out.kept;
        out.active = frame.pool.active(id);
        out.energy = frame.pool.energy();
        let mut worst = BTreeMap::<u32, f64>::new();
        for (k, touch) in missed {
            let lacks = worst.entry(id(frame.seen[*k].index)).or_default();
            *lacks = lacks.max(touch.excess);
        }
        let forced = frame.soft > 0.0 && self.options.slack_price.is_none();
        if forced {
            for row in &out.active {
                if let (Some(id), true) =
                    (row.candidate, row.slack > frame.clearance.tolerance * frame.clearance.share(row.tau))
                {
                    let lacks = worst.entry(id).or_default();
                    *lacks = lacks.max(row.slack);
                }
            }
        }
        let proof = if forced { frame.pool.certificate(depth, |node| self.ceiling(frame, node), id) } else { None };
        out.unresolved.extend(worst.into_iter().map(|(id, lacks)| {
            let reason = proof.clone().map_or(Reason::NotSettled { lacks }, Reason::Infeasible);
            Unresolved { id, reason }
        }));
    }
}

impl Frame<'_> {
    /// Removes candidates without a line of sight or too near to the eye, and lists them as unresolved.
    fn drop_without_line(&mut self, guard: f64, unresolved: &mut Vec<Unresolved>) {
        let candidates = self.problem.candidates;
        self.seen.retain(|s| {
            let reason = match s {
                s if s.chords.is_empty() => Reason::NoLine,
                s if s.distance() < 3.0 * guard => Reason::TooNear,
                _ => return true,
            };
            unresolved.push(Unresolved { id: candidates[s.index].id, reason });
            false
        });
    }

    /// Updates the room of all bundles for a new displacement.
    fn moved(&mut self, surface: &Surface, after: &[f64]) {
        let change: Vec<f64> = surface.u.iter().zip(after).map(|(b, a)| a - b).collect();
        let rise = Rise::new(&surface.lattice, &change);
        let seen = &self.seen;
        self.bundles.par_iter_mut().with_min_len(32).for_each(|b| b.moved(seen, &rise));
    }

    /// Positions where the required clearance is missed, with the index of their line in `seen`. Lines with room left are not followed.
    ///
    /// * `size`: of the groups of neighbours of which the most missed one counts, grid cells; `None` = all positions.
    fn missed(&mut self, surface: &Surface, size: Option<DVec2>) -> Vec<(usize, Touch)> {
        let (seen, clearance, progress) = (&self.seen, &self.clearance, self.progress);
        let walk = |b: &mut Bundle| {
            if progress.should_end() {
                return Vec::new();
            }
            let found = b.walk(seen, surface, clearance);
            match size {
                Some(size) => worst_of_groups(&found, |(k, touch)| key(touch.at, seen[*k].grid, size)),
                None => found,
            }
        };
        self.bundles.par_iter_mut().with_min_len(8).flat_map_iter(walk).collect()
    }

    /// Rows for the most missed position of each group of neighbours. Groups get smaller from round to round, but stay large enough
    /// that there are not too many rows. A position that is missed no more than a row next to it brings no row: that row is to be met
    /// first.
    fn thinned(&self, surface: &Surface, missed: &[(usize, Touch)], round: usize) -> Vec<Row> {
        let step = surface.lattice.step;
        let candidates = self.problem.candidates;
        let mut known = BTreeMap::<_, f64>::new();
        if self.soft > 0.0 || self.pool.is_matrix_free() {
            for (i, row) in self.pool.rows.iter().enumerate() {
                if let Constraint::Sight { candidate, at, .. } = row.constraint {
                    let lacks = known.entry(key(at, candidates[candidate].grid, KNOWN * step)).or_default();
                    *lacks = lacks.max(self.pool.slack(i) + self.pool.missed(i));
                }
            }
        }
        let spare = if self.soft > 0.0 { self.clearance.tolerance } else { 0.0 };
        let is_new = |(k, touch): &&(usize, Touch)| {
            let known = known.get(&key(touch.at, self.seen[*k].grid, KNOWN * step));
            known.is_none_or(|known| touch.excess > 1.1 * known + spare)
        };
        let new: Vec<&(usize, Touch)> = missed.iter().filter(is_new).collect();
        let mut size = if self.soft > 0.0 { KNOWN } else { fineness(round) } * step;
        loop {
            let mut best: BTreeMap<_, &(usize, Touch)> = BTreeMap::new();
            for touch in &new {
                let slot = best.entry(key(touch.1.at, self.seen[touch.0].grid, size)).or_insert(touch);
                if touch.1.excess > slot.1.excess {
                    *slot = touch;
                }
            }
            if best.len() <= MOST_NEW {
                return best.into_values().map(|(k, t)| self.seen[*k].row(surface, t, &self.clearance)).collect();
            }
            size *= 2.0;
        }
    }

    /// Reports progress: the largest miss falls from round to round.
    fn tell(&self, round: usize, worst: f64, first: f64) {
        let tolerance = self.clearance.tolerance;
        let left = (worst.max(tolerance) / tolerance).ln() / (first.max(2.0 * tolerance) / tolerance).ln();
        let stage = format!("quadratic program, round {round}, {} rows, {worst:.1} m missed", self.pool.rows.len());
        // Whether to stop is tested at the end of each round.
        let _ = self.progress.tick(&stage, 0.5 + 0.4 * (1.0 - left));
    }
}

/// Size of the groups of neighbours of which one position brings a row, steps of the solver's grid.
fn fineness(round: usize) -> f64 {
    0.5f64.powi(round as i32 / 3 - 1).max(1.0 / 32.0)
}

/// Group of a position on a line of sight: its own place, and that of the point that must be seen.
fn key(at: DVec2, grid: DVec2, size: DVec2) -> [(i64, i64); 2] {
    [at / size, grid / size].map(|v| (v.x.floor() as i64, v.y.floor() as i64))
}

/// The most missed position of each group, the first one of equal ones.
fn worst_of_groups(found: &[(usize, Touch)], key: impl Fn(&(usize, Touch)) -> [(i64, i64); 2]) -> Vec<(usize, Touch)> {
    let mut order: Vec<([(i64, i64); 2], usize)> = found.iter().enumerate().map(|(i, touch)| (key(touch), i)).collect();
    order.sort_unstable();
    let worst = |group: &[([(i64, i64); 2], usize)]| {
        let of = |&(_, i): &([(i64, i64); 2], usize)| found[i];
        group.iter().map(of).reduce(|worst, touch| if touch.1.excess > worst.1.excess { touch } else { worst })
    };
    order.chunk_by(|a, b| a.0 == b.0).filter_map(worst).collect()
}

fn length(what: &'static str, values: &[f64], nodes: usize) -> Result<(), QpError> {
    if values.len() == nodes { Ok(()) } else { Err(QpError::Length { what, given: values.len(), nodes }) }
}

#[cfg(test)]
mod tests;
