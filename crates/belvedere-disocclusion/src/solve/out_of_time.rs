//! Choice of a ground when time is up: of several the one that shows most.
//!
//! A program that is stopped leaves unfinished ground, which may show less than the undisplaced one. So the same program is solved
//! for samples of its candidates, which takes a fraction of the time. Neither moves more than the finished one would: both are solutions for
//! fewer rows. The limits are applied to each ground, which is judged as the report judges it; what exceeds a stated price or the
//! bounds of the landscape is not taken.

use super::super::metrics::{Judge, share_seen};
use super::super::visibility_qp::{Candidate, QpProblem, QpSolver};
use super::super::{Hierarchy, ReferencePoint};
use super::ground::Ground;
use super::likeness::Likeness;
use super::memory::Prepared;
use super::passes::Passes;
use super::{Outcome, PointsInView, Taken, delta_of, reporting};
use crate::DisocclusionError;
use belvedere_core::DVec2;
use std::collections::BTreeMap;

/// Each solution demands one of this many candidates; the solutions are made in this order.
const SAMPLES: [usize; 3] = [32, 8, 3];
/// Candidates of a sample where bounds hold, about, and the parts of them that are demanded one after the other.
const BOUNDED: usize = 200;
const PARTS: [f64; 4] = [0.1, 0.3, 0.6, 1.0];
/// Fewer candidates than these are not worth a solution of their own.
const FEWEST: usize = 24;
/// Share of the time for all of the work that the first sample has at least.
const FIRST_SAMPLE: f64 = 0.1;
/// Gain of the visible share for which another ground is taken.
const WORTH: f64 = 0.001;

/// What bounds a displacement: the largest that is allowed, and the landscape.
struct Bounds<'a> {
    most_m: Option<f64>,
    likeness: Option<Likeness<'a>>,
}

impl Bounds<'_> {
    fn are_any(&self) -> bool {
        self.most_m.is_some() || self.likeness.is_some()
    }

    fn hold(&self, grid: &Hierarchy, u: &[f64]) -> bool {
        let moved = u.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        self.most_m.is_none_or(|most| moved <= most) && self.likeness.as_ref().is_none_or(|l| l.strain(grid, u) <= 1.0)
    }
}

impl Passes<'_> {
    /// Solutions for samples of the candidates, the coarsest first, as many as time allows. Where what moves is bounded, the samples are of
    /// those that the ground hides least, for they cost least, more each time until a bound is exceeded.
    pub(super) fn samples(
        &self,
        qp: &mut QpSolver,
        problem: &QpProblem<'_>,
        (prepared, in_view): (&Prepared, &PointsInView<'_>),
    ) -> Result<Vec<Ground>, DisocclusionError> {
        let bounds = self.bounds(prepared, in_view);
        let mut out = Vec::new();
        for (k, (every, few)) in self.sampled(problem, bounds.are_any()).into_iter().enumerate() {
            let progress = if k == 0 { self.progress.at_least(FIRST_SAMPLE) } else { self.progress.clone() };
            if progress.should_end() {
                break;
            }
            self.progress.tick("quadratic program for a sample", 0.9)?;
            qp.reset();
            let result = qp.solve_with(&QpProblem { candidates: &few, ..*problem }, &progress)?;
            let done = !result.stopped && bounds.hold(&prepared.grid, &result.u);
            out.push(Ground::solved(Taken::Sample { every }, result, few.len()));
            if !done {
                break;
            }
        }
        // The next frame must not begin with rows of a sample.
        qp.reset();
        Ok(out)
    }

    /// Candidates of the samples, with one of how many they are.
    fn sampled(&self, problem: &QpProblem<'_>, bounded: bool) -> Vec<(usize, Vec<Candidate>)> {
        let all = problem.candidates;
        let of = |every: usize| (every, all.iter().step_by(every).copied().collect::<Vec<Candidate>>());
        if !bounded {
            return SAMPLES.into_iter().filter(|every| all.len() / every >= FEWEST).map(of).collect();
        }
        let (every, mut few) = of(all.len().div_ceil(BOUNDED).max(1));
        let places: Vec<(DVec2, f64)> = few.iter().map(|c| (c.grid, c.lift)).collect();
        let hiding = Judge::still(self.field, problem.sight).hiding(&places, 0.0);
        let over: BTreeMap<u32, f64> =
            few.iter().zip(hiding).map(|(c, hides)| (c.id, hides.map_or(0.0, |h| h.1))).collect();
        few.sort_by(|a, b| over[&a.id].total_cmp(&over[&b.id]));
        let seen = few.iter().filter(|c| over[&c.id] == 0.0).count();
        let part = |share: f64| seen + (share * (few.len() - seen) as f64).ceil() as usize;
        PARTS.into_iter().map(|share| (every, few[..part(share)].to_vec())).collect()
    }

    /// What bounds the displacement.
    fn bounds(&self, prepared: &Prepared, in_view: &PointsInView<'_>) -> Bounds<'_> {
        Bounds { most_m: self.settings.move_at_most_m, likeness: self.likeness(prepared, in_view) }
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
        let bounds = self.bounds(prepared, in_view);
        let before = self.last.map(|u| Ground::plain(Taken::FrameBefore, u.to_vec()));
        let samples = samples.into_iter().filter(|ground| bounds.hold(&prepared.grid, &ground.coarse));
        for mut ground in before.into_iter().chain(samples) {
            let share = self.share_limited(prepared, in_view, &points, &mut ground)?;
            if share > best.0 + WORTH {
                best = (share, Some(ground));
            }
        }
        let (grid, u) = done.fine.as_ref().map_or((&prepared.grid, &done.coarse), |(grid, u)| (grid, u));
        if unfinished > best.0 + WORTH && bounds.hold(grid, u) {
            best = (unfinished, None);
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
}
