//! The passes of one frame, in the order of the mode.

use super::super::visibility_qp::{Candidate, QpOptions, QpProblem, QpResult, QpSolver};
use super::super::{BlockMaxima, Field, Hierarchy, Naive, ReferencePoint, Smoother, SolverMode, TerrainSettings};
use super::agreement::Agreement;
use super::fallback::{self, Fallback};
use super::ground::Ground;
use super::memory::{self, Prepared, Weights};
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

/// Arguments of the solution on finer grids.
struct Finer<'a> {
    /// The solver's grid.
    coarse: &'a Hierarchy,
    /// The undisplaced ground with its change of detail, at every node.
    ground: &'a [f64],
    detail: Option<&'a [f64]>,
    weights: Weights,
    waters: &'a Waters,
    options: QpOptions,
    /// Points by which the result is judged.
    check: &'a [Candidate],
}

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
    pub(super) progress: &'a Progress,
}

impl Passes<'_> {
    pub(super) fn run(
        &self,
        prepared: &mut Prepared,
        in_view: &PointsInView<'_>,
        times: &mut TerrainTimes,
    ) -> Result<Outcome, DisocclusionError> {
        let mut done = Outcome {
            coarse: vec![0.0; prepared.grid.nodes()],
            full: None,
            fine: None,
            limited: None,
            fallbacks: Vec::new(),
            greedy: None,
            greedy_unresolved: Vec::new(),
            qp: None,
            qp_unresolved: Vec::new(),
            stopped: false,
            taken: None,
            rows: Vec::new(),
        };
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

    /// See [`Self::samples`]; empty in films, in modes other than qp, and where detail of the ground changed, which samples ignore.
    fn samples_of(
        &self,
        prepared: &mut Prepared,
        in_view: &PointsInView<'_>,
        detail: Option<&[f64]>,
    ) -> Result<Vec<Ground>, DisocclusionError> {
        let usual = detail.is_none() && self.frame.is_none() && self.settings.mode == SolverMode::Qp;
        let Some(program) = prepared.still.as_mut().filter(|_| usual) else { return Ok(Vec::new()) };
        let qp = &mut program.solver;
        program.foreign = true;
        qp.set_heights(self.field.heights())?;
        qp.set_options(memory::options(self.settings, false));
        let (candidates, sight) = (&in_view.candidates[..], &*in_view.sight);
        self.samples(qp, &QpProblem { candidates, sight, target: None, ceilings: None })
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
        // On a curved earth the ground under the points, and what bounds it, differs with the eye.
        let own = self.lowered.then(|| BlockMaxima::new(field));
        let point = |&i: &usize| {
            let p = prepared.points[i];
            ReferencePoint { ground: field.surface_at(p.grid).unwrap_or(p.ground), ..p }
        };
        let points: Vec<ReferencePoint> = in_view.points.iter().map(point).collect();
        let naive = Naive::new(field, cells, Some(own.as_ref().unwrap_or(blocks)), self.settings, self.eye, &points);
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
        let target = self.target(prepared, done)?;
        let warm = self.last.is_some() && prepared.moving.is_some();
        let weights = if warm { self.weights } else { Weights { g: 0.0, ..self.weights } };
        // In films hidden points do not become candidates: one that is demanded in a single frame would make the ground jump.
        let check = if self.frame.is_some() { Vec::new() } else { prepared.check_in_view(in_view) };
        let Some(program) = (if warm { &mut prepared.moving } else { &mut prepared.still }) else { return Ok(()) };
        let qp = &mut program.solver;
        let mut ground: Cow<'_, [f64]> = match &detail {
            Some(detail) => self.field.heights().iter().zip(detail).map(|(h, d)| h + d).collect(),
            None => self.field.heights().into(),
        };
        // The solver was made for the undisplaced ground; bounds for other ground take time.
        let mut foreign = self.lowered || detail.is_some();
        if foreign || program.foreign {
            qp.set_heights(&ground)?;
        }
        let (asked, sight) = (&in_view.candidates[..], &*in_view.sight);
        let wider = [asked, &in_view.entering[..]].concat();
        let mut problem = QpProblem { candidates: &wider, sight, target: target.as_deref(), ceilings: None };
        qp.set_options(memory::options(self.settings, false));
        let mut result = qp.solve_with(&problem, self.progress)?;
        self.progress.tick("quadratic program", 0.9)?;
        if fallback::stuck(&result) > 0 && wider.len() > asked.len() {
            // Points beside the picture must not keep points in it from being shown.
            problem = QpProblem { candidates: asked, ..problem };
            result = qp.solve_with(&problem, self.progress)?;
        }
        // If a lake sinks with all its banks, the limits fill up most of it again: that is not worth another solution.
        let in_vain = prepared.limited.as_ref().is_some_and(|limited| {
            !prepared.waters.lakes.is_empty()
                && limited.beyond(&prepared.grid, &result.u) > FAR_BEYOND * self.field.relief()
        });
        if self.stuck(&result) && !in_vain {
            let mut cut = fallback::cut_detail(self.field, &ground, &prepared.grid, &result.active);
            prepared.waters.clear(&mut cut, self.field);
            let lower: Vec<f64> = ground.iter().zip(&cut).map(|(h, c)| h + c).collect();
            qp.set_heights(&lower)?;
            foreign = true;
            let next = qp.solve_with(&problem, self.progress)?;
            if fallback::stuck(&next) < fallback::stuck(&result) {
                (result, ground) = (next, lower.into());
                let before = detail.take().unwrap_or_else(|| vec![0.0; cut.len()]);
                *detail = Some(before.iter().zip(cut).map(|(d, c)| d + c).collect());
                done.fallbacks.push(Fallback::Detail);
            } else {
                qp.set_heights(&ground)?;
            }
        }
        let mut from_guard = false;
        if self.stuck(&result) && !in_vain {
            qp.set_options(memory::options(self.settings, true));
            let next = qp.solve_with(&problem, self.progress)?;
            from_guard = fallback::stuck(&next) < fallback::stuck(&result);
            if from_guard {
                result = next;
                done.fallbacks.push(Fallback::Guard);
            }
        }
        let mut hidden = 0;
        let options = memory::options(self.settings, from_guard);
        if fallback::stuck(&result) == 0 && !in_vain && (self.frame.is_none() || detail.is_some()) {
            let (field, grid, detail) = (self.field, &prepared.grid, detail.as_deref());
            let (waters, progress) = (&*prepared.waters, self.progress);
            let agreement = Agreement { field, grid, detail, waters, check: &check, options, progress };
            (result, hidden) = agreement.reach(qp, &ground, &problem, result)?;
            foreign = true;
        }
        program.foreign = foreign;
        done.coarse.clone_from(&result.u);
        if self.unfinished(&result, hidden) && !in_vain {
            let (coarse, detail) = (&prepared.grid, detail.as_deref());
            let waters = &*prepared.waters;
            let grids = Finer { coarse, ground: &ground, detail, weights, waters, options, check: &check };
            result = self.on_finer_grids(&grids, qp, &problem, (result, hidden), done)?;
        }
        done.qp = Some(QpReport::of(&result, in_view.candidates.len()));
        done.stopped = result.stopped || (fallback::stuck(&result) > 0 && self.progress.is_late());
        done.qp_unresolved = result.unresolved;
        done.rows = result.active;
        times.qp_ms = since(began);
        Ok(())
    }

    /// Whether candidates are unresolved and there is time for another fallback.
    fn stuck(&self, result: &QpResult) -> bool {
        fallback::stuck(result) > 0 && !self.progress.should_end()
    }

    /// The same, also if lakes hide points: small lakes are not level on the program's grid.
    fn unfinished(&self, result: &QpResult, hidden: usize) -> bool {
        fallback::stuck(result) + hidden > 0 && !self.progress.should_end()
    }

    /// Solves again on finer and finer grids until no candidate is missed; returns the best result. Each begins with the rows of the one
    /// before.
    fn on_finer_grids(
        &self,
        grids: &Finer<'_>,
        solver: &QpSolver,
        problem: &QpProblem<'_>,
        (mut best, mut hidden): (QpResult, usize),
        done: &mut Outcome,
    ) -> Result<QpResult, DisocclusionError> {
        let Finer { coarse, ground, detail, weights, waters, options, check } = *grids;
        let mut before = (Cow::Borrowed(solver), coarse.clone(), best.u.clone());
        for grid in fallback::finer(coarse, self.field) {
            if !self.unfinished(&best, hidden) {
                break;
            }
            self.progress.tick("quadratic program on a finer grid", 0.7)?;
            let nodes = grid.cols().max(grid.rows());
            let target = problem.target.map(|t| fallback::resampled(coarse, t, &grid));
            let mut finer = memory::program(self.field, &grid, weights, options, waters)?;
            finer.set_heights(ground)?;
            finer.begin_from(&before.0, &fallback::resampled(&before.1, &before.2, &grid));
            let problem = QpProblem { target: target.as_deref(), ..*problem };
            let mut next = finer.solve_with(&problem, self.progress)?;
            let mut left = 0;
            if fallback::stuck(&next) == 0 {
                let (field, progress) = (self.field, self.progress);
                (next, left) = Agreement { field, grid: &grid, detail, waters, check, options, progress }
                    .reach(&mut finer, ground, &problem, next)?;
            }
            before = (Cow::Owned(finer), grid.clone(), next.u.clone());
            if (fallback::stuck(&next), left) < (fallback::stuck(&best), hidden) {
                done.fine = Some((grid, next.u.clone()));
                (best, hidden) = (next, left);
                done.fallbacks.push(Fallback::FinerGrid { nodes });
            }
        }
        Ok(best)
    }
}
