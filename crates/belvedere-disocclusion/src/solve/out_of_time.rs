//! Choice of a ground when time is up: of several the one that shows most.
//!
//! A program that is stopped leaves unfinished ground, which may show less than the undisplaced one. So the same program is solved
//! for samples of its candidates, which takes a fraction of the time. If the best ground still shows too little, the greedy and
//! smooth pass is made, which takes about as long as one round. The limits are applied to each ground, which is judged as the report
//! judges it.

use super::super::metrics::{Judge, share_seen};
use super::super::visibility_qp::{Candidate, QpProblem, QpSolver};
use super::super::{BlockMaxima, Cells, Hierarchy, ReferencePoint, SolverMode, TerrainSettings};
use super::ground::Ground;
use super::memory::{Prepared, smooth_pass};
use super::passes::Passes;
use super::{Outcome, PointsInView, Taken, delta_of, reporting};
use crate::DisocclusionError;

/// Each solution demands one of this many candidates; the solutions are made in this order.
const SAMPLES: [usize; 3] = [32, 8, 3];
/// Fewer candidates than these are not worth a solution of their own.
const FEWEST: usize = 24;
/// Share of the time for all of the work that the first sample has at least.
const FIRST_SAMPLE: f64 = 0.1;
/// Gain of the visible share for which another ground is taken.
const WORTH: f64 = 0.001;
/// Visible share from which on the greedy and smooth pass is not tried.
const ENOUGH: f64 = 0.9;

impl Passes<'_> {
    /// Solutions for samples of the candidates, the coarsest first, as many as time allows.
    pub(super) fn samples(&self, qp: &mut QpSolver, problem: &QpProblem<'_>) -> Result<Vec<Ground>, DisocclusionError> {
        let mut out = Vec::new();
        let worth = SAMPLES.into_iter().filter(|every| problem.candidates.len() / every >= FEWEST);
        for (k, every) in worth.enumerate() {
            let progress = if k == 0 { self.progress.at_least(FIRST_SAMPLE) } else { self.progress.clone() };
            if progress.should_end() {
                break;
            }
            self.progress.tick("quadratic program for a sample", 0.9)?;
            qp.reset();
            let few: Vec<Candidate> = problem.candidates.iter().step_by(every).copied().collect();
            let result = qp.solve_with(&QpProblem { candidates: &few, ..*problem }, &progress)?;
            let done = !result.stopped;
            out.push(Ground::solved(Taken::Sample { every }, result, few.len()));
            if !done {
                break;
            }
        }
        // The next frame must not begin with rows of a sample.
        qp.reset();
        Ok(out)
    }

    /// Replaces the unfinished ground by the one that shows most, if that shows more.
    pub(super) fn take_best(
        &self,
        prepared: &Prepared,
        in_view: &PointsInView<'_>,
        done: &mut Outcome,
        samples: Vec<Ground>,
    ) -> Result<(), DisocclusionError> {
        let (points, _) = reporting::sampled(prepared.dense_in_view(in_view, true), true);
        let unfinished = self.share_of(
            prepared,
            in_view,
            &points,
            (done.coarse.as_slice(), done.full.as_deref()),
            done.fine.as_ref(),
        )?;
        // No ground: the unfinished one.
        let unmoved = Ground::plain(Taken::Unmoved, vec![0.0; done.coarse.len()]);
        let mut best = (self.share_unmoved(in_view, &points)?, Some(unmoved));
        let before = self.last.map(|u| Ground::plain(Taken::FrameBefore, u.to_vec()));
        for mut ground in before.into_iter().chain(samples) {
            let share = self.share_limited(prepared, in_view, &points, &mut ground)?;
            if share > best.0 + WORTH {
                best = (share, Some(ground));
            }
        }
        if unfinished > best.0 + WORTH {
            best = (unfinished, None);
        }
        if best.0 < ENOUGH
            && self.frame.is_none()
            && let Some(mut u) = self.single_pass(prepared, in_view)?
        {
            self.hold(&mut u);
            let mut ground = Ground::plain(Taken::SinglePass, u);
            let share = self.share_limited(prepared, in_view, &points, &mut ground)?;
            if share > best.0 + WORTH {
                best = (share, Some(ground));
            }
        }
        done.taken = Some(best.1.as_ref().map_or(Taken::Unfinished, |ground| ground.taken));
        best.1.into_iter().for_each(|ground| ground.put(done));
        Ok(())
    }

    /// Applies the limits to a ground and returns its visible share.
    pub(super) fn share_limited(
        &self,
        prepared: &Prepared,
        in_view: &PointsInView<'_>,
        points: &[ReferencePoint],
        ground: &mut Ground,
    ) -> Result<f64, DisocclusionError> {
        let (grid, waters) = (&prepared.grid, &*prepared.waters);
        let mut full = (ground.detail.is_some() || !waters.is_empty())
            .then(|| waters.whole(grid, &ground.coarse, ground.detail.as_deref()));
        if let Some(limited) = &prepared.limited
            && (full.is_some() || !limited.surely_kept(grid, &ground.coarse))
        {
            let mut u = full.take().unwrap_or_else(|| grid.prolong(&ground.coarse));
            ground.limited = limited.keep(&prepared.level, waters, &mut u);
            full = Some(u);
        }
        ground.full = full;
        self.share_of(prepared, in_view, points, (&ground.coarse, ground.full.as_deref()), None)
    }

    pub(super) fn share_of(
        &self,
        prepared: &Prepared,
        in_view: &PointsInView<'_>,
        points: &[ReferencePoint],
        (coarse, full): (&[f64], Option<&[f64]>),
        fine: Option<&(Hierarchy, Vec<f64>)>,
    ) -> Result<f64, DisocclusionError> {
        let delta = delta_of(self.field, &prepared.grid, (coarse, full, fine))?;
        let judge = Judge::new(self.field, &delta, &*in_view.sight);
        Ok(share_seen(points, &judge.judge(points, self.settings.guard)))
    }

    fn share_unmoved(&self, in_view: &PointsInView<'_>, points: &[ReferencePoint]) -> Result<f64, DisocclusionError> {
        let judge = Judge::still(self.field, &*in_view.sight);
        Ok(share_seen(points, &judge.judge(points, self.settings.guard)))
    }

    /// The greedy and the smooth pass as published, detail kept as it is; `None` where they were made already.
    fn single_pass(
        &self,
        prepared: &Prepared,
        in_view: &PointsInView<'_>,
    ) -> Result<Option<Vec<f64>>, DisocclusionError> {
        if self.settings.mode != SolverMode::Qp {
            return Ok(None);
        }
        self.progress.tick("greedy and smooth pass", 0.9)?;
        let field = self.field;
        let settings = TerrainSettings { mode: SolverMode::Paper, ..self.settings.clone() };
        let cells = Cells::new(field, settings.cells.unwrap_or_else(|| Cells::default_count(field)));
        let blocks = BlockMaxima::new(field);
        let naive = self.naive(prepared, in_view, &settings, (&cells, &blocks));
        let w = settings.smoothness_on(&prepared.despiked);
        let mut pass = smooth_pass(&settings, w, &prepared.grid, &prepared.points, (field, &cells))?;
        Ok(Some(pass.run(&naive.displacement(field, &cells), None, None).u))
    }
}
