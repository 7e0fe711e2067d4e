//! The passes of one frame, in the order of the mode.

use super::super::visibility_qp::{Candidate, LinesOfSight, QpOptions, QpProblem, QpResult, QpSolver};
use super::super::{
    BlockMaxima, Cells, Field, Hierarchy, Naive, ReferencePoint, Smoother, SolverMode, TerrainSettings,
};
use super::agreement::Agreement;
use super::fallback::{self, Fallback};
use super::file_to_write::FileJudge;
use super::ground::Ground;
use super::likeness::Likeness;
use super::limits::LimitedTerrain;
use super::memory::{self, Prepared, Program, Weights};
use super::price::Price;
use super::waters::Waters;
use super::{Outcome, PointsInView, QpReport, TerrainTimes, scales, since};
use crate::DisocclusionError;
use belvedere_core::DVec3;
use belvedere_scene::Instant;
use belvedere_scene::Progress;
use std::borrow::Cow;

/// Share of the time for the quadratic program; the rest is for the alternatives if it is not done by then.
const PROGRAM_TIME: f64 = 0.6;

/// Ground that sinks below the limits by more than this share of the relief is not refined.
const FAR_BEYOND: f64 = 0.2;
/// With so many candidates what is given up is chosen by solutions that are met only roughly.
const MANY_ASKED: usize = 2000;

pub(super) struct Passes<'a> {
    pub(super) settings: &'a TerrainSettings,
    /// The ground as seen from the eye: lowered by the curvature of the earth.
    pub(super) field: &'a Field,
    /// Whether that differs from the data, for the earth is curved.
    pub(super) lowered: bool,
    pub(super) weights: Weights,
    /// Seconds between frames and time constant of coherence; `None` for single pictures.
    pub(super) frame: Option<[f64; 2]>,
    pub(super) eye: DVec3,
    /// Displacement of the frame before.
    pub(super) last: Option<&'a [f64]>,
    /// Files that the displacement will be written to.
    pub(super) files: &'a [FileJudge<'a>],
    pub(super) progress: &'a Progress,
}

impl Passes<'_> {
    pub(super) fn run(
        &self,
        prepared: &mut Prepared,
        in_view: &PointsInView<'_>,
        times: &mut TerrainTimes,
    ) -> Result<Outcome, DisocclusionError> {
        let mut done = Outcome { coarse: vec![0.0; prepared.grid.nodes()], ..Outcome::default() };
        let (mut detail, mut samples) = (None, Vec::new());
        if prepared.cells.is_some() {
            detail = self.paper(prepared, in_view, &mut done, times)?;
        }
        if self.settings.mode == SolverMode::Paper {
            self.downhill(prepared, in_view, &mut done)?;
        } else {
            if prepared.cells.is_some() && self.progress.is_limited() {
                samples.push(Ground::single_pass(&done.coarse, detail.clone()));
            }
            let in_time = Passes { progress: &self.progress.part(PROGRAM_TIME), ..*self };
            in_time.guarantee(prepared, in_view, &mut detail, &mut done, times)?;
            if done.stopped {
                samples.extend(self.samples_of(prepared, in_view, detail.as_deref())?);
            }
        }
        if done.stopped {
            self.hold(&mut done.coarse);
            done.fine.iter_mut().for_each(|(_, u)| self.hold(u));
            samples.iter_mut().for_each(|ground| self.hold(&mut ground.coarse));
        }
        if detail.is_some() || !prepared.waters.is_empty() {
            let (grid, u) = done.fine.as_ref().map_or((&prepared.grid, &done.coarse), |(grid, u)| (grid, u));
            done.full = Some(prepared.waters.whole(grid, u, detail.as_deref()));
            done.fine = None;
        }
        self.limit(prepared, &mut done);
        if done.stopped {
            self.take_best(prepared, in_view, &mut done, samples)?;
        }
        Ok(done)
    }

    /// Keeps unfinished ground from rising by more than it may: its ceilings are not all met yet.
    pub(super) fn hold(&self, u: &mut [f64]) {
        let QpOptions { ceiling, ceiling_tolerance, .. } = QpOptions::of(self.settings);
        u.iter_mut().for_each(|u| *u = u.min(ceiling + ceiling_tolerance));
    }

    /// See [`Self::samples`]; empty in films, in modes other than qp, and where detail of the ground changed, which samples ignore.
    fn samples_of(
        &self,
        prepared: &mut Prepared,
        in_view: &PointsInView<'_>,
        detail: Option<&[f64]>,
    ) -> Result<Vec<Ground>, DisocclusionError> {
        let usual = detail.is_none() && self.frame.is_none() && self.settings.mode == SolverMode::Qp;
        let Some(mut program) = prepared.still.take_if(|_| usual) else { return Ok(Vec::new()) };
        let qp = &mut program.solver;
        program.foreign = true;
        qp.set_heights(self.field.heights())?;
        qp.set_options(memory::options(self.settings, false));
        let (candidates, sight) = (&in_view.candidates[..], &*in_view.sight);
        let problem = QpProblem { candidates, sight, target: None, ceilings: None };
        let samples = self.samples(qp, &problem, (prepared, in_view));
        prepared.still = Some(program);
        samples
    }

    /// Applies the limits: fills up ground that is dug too deep or too steep.
    fn limit(&self, prepared: &Prepared, done: &mut Outcome) {
        let Some(limited) = &prepared.limited else { return };
        let coarse = done.full.is_none() && done.fine.is_none();
        if coarse && limited.surely_kept(&prepared.grid, &done.coarse) {
            return;
        }
        let mut u = match (&done.full, &done.fine) {
            (Some(full), _) => full.clone(),
            (None, Some((grid, u))) => grid.prolong(u),
            (None, None) => prepared.grid.prolong(&done.coarse),
        };
        done.limited = limited.keep(&prepared.level, &prepared.waters, &mut u);
        if done.limited.is_some() {
            done.full = Some(u);
        }
    }

    /// Greedy and smooth pass; returns the change of detail at every node, if detail is scaled.
    fn paper(
        &self,
        prepared: &mut Prepared,
        in_view: &PointsInView<'_>,
        done: &mut Outcome,
        times: &mut TerrainTimes,
    ) -> Result<Option<Vec<f64>>, DisocclusionError> {
        let Some(parts) = prepared.cells.clone() else { return Ok(None) };
        let (cells, blocks) = &*parts;
        self.progress.tick("greedy pass", 0.2)?;
        let began = Instant::now();
        let field = self.field;
        // On a curved earth what bounds the ground differs with the eye.
        let own = self.lowered.then(|| BlockMaxima::new(field));
        let blocks = own.as_ref().unwrap_or(blocks);
        let naive = self.naive(prepared, in_view, self.settings, (cells, blocks));
        done.greedy = Some(*naive.counters());
        done.greedy_unresolved = naive.unresolved().iter().map(|&k| in_view.points[k]).collect();
        times.greedy_ms = since(began);
        self.progress.tick("smooth pass", 0.4)?;
        let began = Instant::now();
        let Some(pass) = &mut prepared.smooth else { return Ok(None) };
        let u = pass.run(&naive.displacement(field, cells), self.frame, self.last).u;
        // A still after a jump has no frame before: the pass takes the naive displacement in its place.
        let detail = (scales(self.settings) && !pass.hierarchy().is_full()).then(|| {
            let whole = pass.scaled(&u, field.heights(), &naive.scale(field, cells));
            let smooth = pass.plain(&u);
            let parts = whole.iter().zip(smooth).zip(field.void());
            let mut detail: Vec<f64> = parts.map(|((w, s), void)| if *void { 0.0 } else { w - s }).collect();
            prepared.waters.clear(&mut detail, field);
            detail
        });
        done.coarse = u;
        times.smooth_ms = since(began);
        Ok(detail)
    }

    /// The greedy pass for the points in view.
    fn naive(
        &self,
        prepared: &Prepared,
        in_view: &PointsInView<'_>,
        settings: &TerrainSettings,
        (cells, blocks): (&Cells, &BlockMaxima),
    ) -> Naive {
        // On a curved earth the ground under a point differs with the eye.
        let point = |&i: &usize| {
            let p = prepared.points[i];
            ReferencePoint { ground: self.field.surface_at(p.grid).unwrap_or(p.ground), ..p }
        };
        let points: Vec<ReferencePoint> = in_view.points.iter().map(point).collect();
        Naive::new(self.field, cells, Some(blocks), settings, self.eye, &points)
    }

    /// The displacement next to that of the smooth pass under which no river runs uphill.
    fn downhill(
        &self,
        prepared: &mut Prepared,
        in_view: &PointsInView<'_>,
        done: &mut Outcome,
    ) -> Result<(), DisocclusionError> {
        let Some(program) = prepared.still.as_mut().filter(|_| !prepared.waters.rivers.is_empty()) else {
            return Ok(());
        };
        let free = vec![f64::INFINITY; done.coarse.len()];
        let (sight, target) = (&*in_view.sight, Some(&done.coarse[..]));
        let problem = QpProblem { candidates: &[], sight, target, ceilings: Some(&free) };
        done.coarse = program.solver.solve_with(&problem, self.progress)?.u;
        Ok(())
    }

    /// Displacement that the quadratic program stays close to; `None` = zero.
    fn target(&self, prepared: &Prepared, done: &Outcome) -> Result<Option<Vec<f64>>, DisocclusionError> {
        let Weights { w, g } = prepared.weights();
        Ok(match (self.settings.mode, self.last) {
            (SolverMode::PaperQp, _) => Some(done.coarse.clone()),
            (_, Some(last)) if self.weights.g > 0.0 => {
                let mut u: Vec<f64> = last.iter().map(|u| g * g * u).collect();
                let mut smoother: Smoother = Smoother::new(prepared.grid.cols(), prepared.grid.rows(), w, g)?;
                smoother.solve(&mut u);
                Some(u)
            }
            _ => None,
        })
    }

    /// The quadratic program.
    fn guarantee(
        &self,
        prepared: &mut Prepared,
        in_view: &PointsInView<'_>,
        detail: &mut Option<Vec<f64>>,
        done: &mut Outcome,
        times: &mut TerrainTimes,
    ) -> Result<(), DisocclusionError> {
        self.progress.tick("quadratic program", 0.5)?;
        let began = Instant::now();
        let warm = self.last.is_some() && prepared.moving.is_some();
        // Out of what is prepared while it works, and back whatever comes of it.
        let program = if warm { prepared.moving.take() } else { prepared.still.take() };
        let Some(mut program) = program else { return Ok(()) };
        let solved = self.solved_by(&mut program, warm, (prepared, in_view), detail, done);
        *(if warm { &mut prepared.moving } else { &mut prepared.still }) = Some(program);
        times.qp_ms = since(began);
        solved
    }

    /// The picture that must stay like itself: in stills with limits, unless a price is stated.
    pub(super) fn likeness<'b>(&'b self, prepared: &Prepared, in_view: &PointsInView<'_>) -> Option<Likeness<'b>> {
        let TerrainSettings { mode, limits, show, move_at_most_m, slack_price, .. } = *self.settings;
        let stated = [show, move_at_most_m, slack_price].iter().any(Option::is_some);
        let is_kept = mode == SolverMode::Qp && limits && self.frame.is_none() && !stated;
        is_kept.then(|| Likeness::new(self.field, in_view.base, &prepared.summits))
    }

    fn solved_by(
        &self,
        program: &mut Program,
        warm: bool,
        (prepared, in_view): (&Prepared, &PointsInView<'_>),
        detail: &mut Option<Vec<f64>>,
        done: &mut Outcome,
    ) -> Result<(), DisocclusionError> {
        let target = self.target(prepared, done)?;
        let weights = if warm { self.weights } else { Weights { g: 0.0, ..self.weights } };
        // In films hidden points do not become candidates: one that is demanded in a single frame would make the ground jump.
        let mut check = if self.frame.is_some() { Vec::new() } else { prepared.check_in_view(in_view) };
        let qp = &mut program.solver;
        let ground: Cow<'_, [f64]> = match &detail {
            Some(detail) => self.field.heights().iter().zip(detail).map(|(h, d)| h + d).collect(),
            None => self.field.heights().into(),
        };
        // The solver was made for the undisplaced ground; bounds for other ground take time.
        let foreign = self.lowered || detail.is_some();
        if foreign || program.foreign {
            qp.set_heights(&ground)?;
        }
        let (mut asked, sight) = (in_view.candidates.clone(), &*in_view.sight);
        let mut wider = [&asked[..], &in_view.entering[..]].concat();
        let options = memory::options(self.settings, false);
        qp.set_options(options);
        let likeness = self.likeness(prepared, in_view);
        let in_order = likeness.as_ref().map_or_else(Vec::new, |likeness| likeness.in_order(&prepared.level, qp));
        qp.keep_clear(&in_order);
        let mut price =
            Price::new(self.settings, prepared, likeness, [&asked, &check]).filter(|_| self.frame.is_none());
        if let Some(price) = price.as_mut().filter(|_| asked.len() > MANY_ASKED) {
            qp.set_options(price.compare_roughly(options));
        }
        let mut result = qp.solve_with(&problem_of(&wider, sight, target.as_deref()), self.progress)?;
        let detail_before = price.is_some().then(|| detail.clone());
        let (result, foreign) = loop {
            if let Some(price) = &mut price {
                result = price.settle(
                    qp,
                    &problem_of(&in_view.candidates, sight, target.as_deref()),
                    result,
                    options,
                    self.progress,
                )?;
                (asked, check) = (price.kept(&asked), price.kept(&check));
                wider.clone_from(&asked);
            }
            let settled = price.is_some().then(|| result.clone());
            let gave_up = |p: &ReferencePoint| price.as_ref().is_some_and(|price| price.gave_up(p));
            let mut solution = Solution {
                passes: self,
                gave_up: &gave_up,
                grid: &prepared.grid,
                waters: &prepared.waters,
                weights,
                check: &check,
                options,
                asked: &asked,
                problem: problem_of(&wider, sight, target.as_deref()),
                ground: ground.clone(),
                detail,
                foreign,
                result,
                hidden: 0,
            };
            solution.fall_back(qp, prepared.limited.as_deref(), done)?;
            let (solved, foreign) = (solution.result, solution.foreign);
            let (grid, moved) = done.fine.as_ref().map_or((&prepared.grid, &solved.u), |(grid, u)| (grid, u));
            let exceeded = price.as_mut().is_some_and(|price| price.is_exceeded(grid, moved));
            if !exceeded || self.progress.should_end() {
                break (solved, foreign);
            }
            // What the fallbacks changed is taken back.
            qp.keep_clear(&in_order);
            qp.set_options(options);
            detail.clone_from(detail_before.as_ref().unwrap_or(&None));
            (done.fine, result) = (None, settled.unwrap_or(solved));
            done.fallbacks.clear();
        };
        program.foreign = foreign;
        done.paid = price.map(Price::paid).unwrap_or_default();
        done.qp = Some(QpReport::of(&result, asked.len()));
        done.stopped = result.stopped || (fallback::stuck(&result) > 0 && self.progress.is_late());
        done.qp_unresolved = result.unresolved;
        done.rows = result.active;
        Ok(())
    }
}

fn problem_of<'p>(
    candidates: &'p [Candidate],
    sight: &'p dyn LinesOfSight,
    target: Option<&'p [f64]>,
) -> QpProblem<'p> {
    QpProblem { candidates, sight, target, ceilings: None }
}

/// A solution of the quadratic program, which fallbacks replace.
struct Solution<'a> {
    passes: &'a Passes<'a>,
    /// The solver's grid.
    grid: &'a Hierarchy,
    waters: &'a Waters,
    weights: Weights,
    /// Points by which the result is judged.
    check: &'a [Candidate],
    gave_up: &'a (dyn Fn(&ReferencePoint) -> bool + Sync),
    options: QpOptions,
    /// Points in the picture.
    asked: &'a [Candidate],
    problem: QpProblem<'a>,
    /// The undisplaced ground with its change of detail, at every node.
    ground: Cow<'a, [f64]>,
    detail: &'a mut Option<Vec<f64>>,
    /// Whether the solver holds other ground than that it was made for.
    foreign: bool,
    result: QpResult,
    /// Points that lakes hide.
    hidden: usize,
}

impl Solution<'_> {
    /// Tries the fallbacks in their order, and makes the program agree with the judge.
    fn fall_back(
        &mut self,
        qp: &mut QpSolver,
        limited: Option<&LimitedTerrain>,
        done: &mut Outcome,
    ) -> Result<(), DisocclusionError> {
        self.passes.progress.tick("quadratic program", 0.9)?;
        if fallback::stuck(&self.result) > 0 && self.problem.candidates.len() > self.asked.len() {
            // Points beside the picture must not keep points in it from being shown.
            self.problem.candidates = self.asked;
            self.result = qp.solve_with(&self.problem, self.passes.progress)?;
        }
        // If a lake sinks with all its banks, the limits fill up most of it again: that is not worth another solution.
        let far = FAR_BEYOND * self.passes.field.relief();
        let sinks = |limited: &LimitedTerrain| limited.beyond(self.grid, &self.result.u) > far;
        let in_vain = !self.waters.lakes.is_empty() && limited.is_some_and(sinks);
        if !in_vain {
            self.cut_detail(qp, done)?;
            self.leave_guard(qp, done)?;
            self.agree(qp)?;
        }
        done.coarse.clone_from(&self.result.u);
        if in_vain { Ok(()) } else { self.refine(qp, done) }
    }

    /// Cuts down the detail around rows with slack, if candidates are unresolved and that helps.
    fn cut_detail(&mut self, qp: &mut QpSolver, done: &mut Outcome) -> Result<(), DisocclusionError> {
        if !self.stuck() {
            return Ok(());
        }
        let field = self.passes.field;
        let mut cut = fallback::cut_detail(field, &self.ground, self.grid, &self.result.active);
        self.waters.clear(&mut cut, field);
        let lower: Vec<f64> = self.ground.iter().zip(&cut).map(|(h, c)| h + c).collect();
        qp.set_heights(&lower)?;
        self.foreign = true;
        if !self.improve(qp)? {
            return Ok(qp.set_heights(&self.ground)?);
        }
        self.ground = lower.into();
        let before = self.detail.take().unwrap_or_else(|| vec![0.0; cut.len()]);
        *self.detail = Some(before.iter().zip(cut).map(|(d, c)| d + c).collect());
        done.fallbacks.push(Fallback::Detail);
        Ok(())
    }

    /// Leaves ground nearer to a point than the guard as it is, if candidates are unresolved and that helps.
    fn leave_guard(&mut self, qp: &mut QpSolver, done: &mut Outcome) -> Result<(), DisocclusionError> {
        if self.stuck() {
            let options = memory::options(self.passes.settings, true);
            qp.set_options(options);
            if self.improve(qp)? {
                self.options = options;
                done.fallbacks.push(Fallback::Guard);
            }
        }
        Ok(())
    }

    /// Solves again; whether fewer candidates are unresolved than before. If not, the solution stays.
    fn improve(&mut self, qp: &mut QpSolver) -> Result<bool, DisocclusionError> {
        let next = qp.solve_with(&self.problem, self.passes.progress)?;
        let better = fallback::stuck(&next) < fallback::stuck(&self.result);
        if better {
            self.result = next;
        }
        Ok(better)
    }

    /// Makes the program agree with the judge, once no candidate is unresolved.
    fn agree(&mut self, qp: &mut QpSolver) -> Result<(), DisocclusionError> {
        if fallback::stuck(&self.result) == 0 && (self.passes.frame.is_none() || self.detail.is_some()) {
            let result = std::mem::take(&mut self.result);
            (self.result, self.hidden) = self.agreement(self.grid).reach(qp, &self.problem, result)?;
        }
        Ok(())
    }

    fn agreement<'b>(&'b self, grid: &'b Hierarchy) -> Agreement<'b> {
        Agreement {
            field: self.passes.field,
            grid,
            detail: self.detail.as_deref(),
            waters: self.waters,
            files: self.passes.files,
            gave_up: self.gave_up,
            check: self.check,
            options: self.options,
            progress: self.passes.progress,
        }
    }

    /// Whether candidates are unresolved and there is time for another fallback.
    fn stuck(&self) -> bool {
        fallback::stuck(&self.result) > 0 && !self.passes.progress.should_end()
    }

    /// Solves again on finer and finer grids while candidates are unresolved or lakes hide points, for small lakes are not level on the
    /// program's grid. Each begins with the rows of the one before.
    fn refine(&mut self, solver: &QpSolver, done: &mut Outcome) -> Result<(), DisocclusionError> {
        let Passes { field, progress, .. } = *self.passes;
        let mut before = (Cow::Borrowed(solver), self.grid.clone(), self.result.u.clone());
        for grid in fallback::finer(self.grid, field) {
            if fallback::stuck(&self.result) + self.hidden == 0 || progress.should_end() {
                break;
            }
            progress.tick("quadratic program on a finer grid", 0.7)?;
            let nodes = grid.cols().max(grid.rows());
            let target = self.problem.target.map(|t| fallback::resampled(self.grid, t, &grid));
            let mut finer = memory::program(field, &grid, self.weights, self.options, self.waters)?;
            finer.set_heights(&self.ground)?;
            finer.begin_from(&before.0, &fallback::resampled(&before.1, &before.2, &grid));
            let problem = QpProblem { target: target.as_deref(), ..self.problem };
            let mut next = finer.solve_with(&problem, progress)?;
            let mut left = 0;
            if fallback::stuck(&next) == 0 {
                (next, left) = self.agreement(&grid).reach(&mut finer, &problem, next)?;
            }
            before = (Cow::Owned(finer), grid.clone(), next.u.clone());
            if (fallback::stuck(&next), left) < (fallback::stuck(&self.result), self.hidden) {
                done.fine = Some((grid, next.u.clone()));
                (self.result, self.hidden) = (next, left);
                done.fallbacks.push(Fallback::FinerGrid { nodes });
            }
        }
        Ok(())
    }
}
