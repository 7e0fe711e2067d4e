//! Builds the report of an outcome.

use super::super::metrics::{Hides, Judge, Judged, amounts, judged, share_seen, shares_of_whole};
use super::super::visibility_qp::{Reason, SolvedRow, Unresolved};
use super::super::{
    Deformation, Field, ReferencePoint, SolverMode, TerrainSettings, Unusable, UnusableReason, stated_spacing,
};
use super::likeness::Likeness;
use super::memory::{CHECK_CELLS, Prepared};
use super::report::{Covered, FeatureCost, TerrainReport, TerrainTimes, UnresolvedReason, UnresolvedRun};
use super::runs::Runs;
use super::shown::Shown;
use super::{Outcome, PointsInView, since};
use crate::DisocclusionError;
use crate::rivers::RIVER_TOLERANCE_M;
use belvedere_core::View;
use belvedere_core::grid::Grid;
use belvedere_scene::{Instant, Progress};
use std::collections::{BTreeMap, BTreeSet};

/// Visible share from which on a guarantee counts as kept: the rest is left to rounding.
pub(super) const AGREES: f64 = 0.9999;
/// Dense points that are judged at most, about, in frames of films and where time was up.
const MOST_SAMPLED: usize = 1000;

pub(super) struct Context<'a> {
    pub(super) settings: &'a TerrainSettings,
    pub(super) field: &'a Field,
    pub(super) prepared: &'a Prepared,
    pub(super) in_view: &'a PointsInView<'a>,
    /// The picture, without the solution.
    pub(super) base: &'a View,
    /// See [`super::TerrainSolver::in_plan`].
    pub(super) in_plan: bool,
    /// The solution.
    pub(super) delta: &'a Grid,
    /// Whether the picture is a still, of which every dense point is judged and every node looked at, or one of a film.
    pub(super) is_still: bool,
    /// Displacement of the frame before.
    pub(super) previous: Option<&'a Grid>,
    /// When time is short, not every dense point is judged.
    pub(super) progress: &'a Progress,
}

/// Dense points to judge, all or about [`MOST_SAMPLED`], and the number of points that each of them stands for.
pub(super) fn sampled(all: Vec<ReferencePoint>, few: bool) -> (Vec<ReferencePoint>, usize) {
    if !few || all.len() <= MOST_SAMPLED {
        return (all, 1);
    }
    // Only points that stand for a length, an area or a feature.
    let counted: Vec<ReferencePoint> = all.iter().filter(|p| p.amount > 0.0).copied().collect();
    let every = counted.len().div_ceil(MOST_SAMPLED).max(1);
    (counted.into_iter().step_by(every).collect(), all.len().div_ceil(MOST_SAMPLED))
}

/// Whether judging all dense points would take more than half of the time left, extrapolated from a sample.
pub(super) fn too_many(progress: &Progress, judge: &Judge<'_>, all: &[ReferencePoint], guard: f64) -> bool {
    let Some(left) = progress.left() else { return false };
    let every = all.len().div_ceil(MOST_SAMPLED / 4).max(1);
    let few: Vec<ReferencePoint> = all.iter().step_by(every).copied().collect();
    let began = Instant::now();
    judge.judge(&few, guard);
    // Before and after.
    began.elapsed().mul_f64(2.0 * every as f64) > left.mul_f64(0.5)
}

/// The points of a report, and what is known of them.
struct Verdicts {
    shown: Shown,
    /// Indices of the reference points in the picture.
    asked: Vec<usize>,
    dense: Vec<ReferencePoint>,
    /// See [`TerrainReport::judged_every`].
    every: usize,
    judged: Judged,
    /// Visible shares and that in view, in the order of the report.
    shares: [f64; 5],
}

impl Verdicts {
    fn of(c: &Context<'_>, stopped: bool) -> Result<Self, DisocclusionError> {
        let (field, prepared, in_view, guard) = (c.field, c.prepared, c.in_view, c.settings.guard);
        let shown = Shown::after(c.base, c.delta, c.in_plan)?;
        let required = |asked: &[usize]| asked.iter().map(|&i| prepared.points[i]).collect::<Vec<_>>();
        let mut asked = in_view.points.clone();
        asked.retain(|&i| shown.holds(field, &prepared.points[i]));
        let all = prepared.dense_in_view(in_view, c.in_plan);
        let undisplaced = Judge::still(field, &*in_view.sight);
        let few = !c.is_still || stopped || too_many(c.progress, &undisplaced, &all, guard);
        let in_view_amounts = amounts(&all);
        let (may_show, every) = sampled(all, few);
        let dense = shown.of(field, &may_show);
        let judged = judged(&Deformation {
            field,
            delta: c.delta,
            previous: c.previous,
            cells: prepared.cells.as_ref().map(|parts| &parts.0),
            points: &required(&asked),
            dense: &dense,
            sight: &*in_view.sight,
            every_node: c.is_still,
            guard,
        });
        let undisplaced = undisplaced.prepared(dense.len());
        let shown_before = Shown::before(c.base, c.in_plan)?;
        let whole = [amounts(&may_show), in_view_amounts, prepared.whole()];
        let before = |points: &[ReferencePoint]| {
            let points = shown_before.of(field, points);
            let verdicts = undisplaced.judge(&points, guard);
            (share_seen(&points, &verdicts), shares_of_whole((&points, &verdicts), whole))
        };
        let (visible_dense_before, [visible_whole_before, _]) = before(&may_show);
        let [visible_whole, in_view] = shares_of_whole((&dense, &judged.of_dense), whole);
        let visible_before = before(&required(&c.in_view.points)).0;
        let shares = [visible_before, visible_dense_before, in_view, visible_whole, visible_whole_before];
        Ok(Self { shown, asked, dense, every, judged, shares })
    }

    /// Whether the judge agrees that all is seen that was promised; where only some points were judged, each of them.
    fn agree(&self) -> bool {
        let Judged { metrics, points, dense, .. } = &self.judged;
        metrics.visible_dense >= AGREES
            && dense.len() as f64 <= (1.0 - AGREES) * self.dense.len() as f64
            && (self.every == 1 || points.is_empty() && dense.is_empty())
    }
}

pub(super) fn report(
    c: &Context<'_>,
    done: &Outcome,
    times: TerrainTimes,
    began: Instant,
) -> Result<TerrainReport, DisocclusionError> {
    let (field, prepared, waters) = (c.field, c.prepared, &c.prepared.waters);
    let verdicts = Verdicts::of(c, done.stopped)?;
    let [visible_before, visible_dense_before, in_view, visible_whole, visible_whole_before] = verdicts.shares;
    let named = unresolved(c, done, &verdicts);
    let hidden = hidden(c, done, &verdicts);
    let stated_m = stated_spacing(field.cols(), field.rows(), field.spacing());
    let w = c.settings.smoothness(stated_m);
    let moved = |i: usize| c.delta.sample(field.scene_from_grid(field.node(i))).unwrap_or(0.0);
    let rivers = match &waters.rivers {
        rivers if rivers.is_empty() => Vec::new(),
        rivers => rivers.report(&(0..field.heights().len()).map(moved).collect::<Vec<_>>()),
    };
    let promised = c.settings.mode != SolverMode::Paper
        && !c.in_view.candidates.is_empty()
        && named.program_met
        && !done.stopped
        && rivers.iter().all(|river| river.excess_m <= RIVER_TOLERANCE_M);
    Ok(TerrainReport {
        parameters: TerrainSettings { w: Some(w), detail: Some(c.settings.detail()), ..c.settings.clone() },
        w,
        smoothing_length_m: c.settings.smoothing_length(stated_m),
        solver_grid: [prepared.grid.cols(), prepared.grid.rows()],
        points: verdicts.asked.len(),
        asked: c.in_view.candidates.len(),
        metrics: verdicts.judged.metrics,
        likeness: c.is_still.then(|| Likeness::new(field, c.base, &prepared.summits).of(&moved)),
        judged_every: verdicts.every,
        visible_before,
        visible_dense_before,
        in_view,
        visible_whole,
        visible_whole_before,
        greedy: done.greedy,
        qp: done.qp,
        costliest: costliest(prepared, &done.rows),
        fallbacks: done.fallbacks.clone(),
        limited: done.limited,
        spikes: prepared.spikes.clone(),
        price: done.paid.report.clone(),
        higher_eye: None,
        lakes: waters.lakes.report(moved),
        rivers,
        guaranteed: promised && verdicts.agree() && (done.limited.is_none() || hidden.is_empty()),
        promised,
        out_of_time: done.stopped,
        taken: done.taken,
        unresolved: named.runs,
        hidden,
        covered: covered(c, &verdicts),
        times: TerrainTimes { report_ms: since(began), ..times },
    })
}

fn covered(c: &Context<'_>, verdicts: &Verdicts) -> Vec<Covered> {
    if c.settings.slack_price.is_none() {
        return Vec::new();
    }
    let place = |&(i, hides): &(usize, Hides)| {
        let (p, over_m) = (&verdicts.dense[i], hides.over());
        let at = c.field.scene_from_grid(p.grid).to_array();
        over_m.is_finite().then_some(Covered { at, lift_m: p.lift, over_m })
    };
    verdicts.judged.dense.iter().filter_map(place).collect()
}

/// The energy is half the sum of multipliers times what their rows ask for.
fn costliest(prepared: &Prepared, rows: &[SolvedRow]) -> Vec<FeatureCost> {
    let mut of = BTreeMap::<(usize, usize), f64>::new();
    let mut all = 0.0;
    for row in rows {
        let asked = row.multiplier * (-row.bound).max(0.0);
        if let Some(point) = row.candidate.and_then(|id| prepared.candidate(id)) {
            *of.entry((point.layer, point.feature)).or_default() += asked;
            all += asked;
        }
    }
    let mut out: Vec<FeatureCost> =
        of.into_iter().map(|((layer, feature), asked)| FeatureCost { layer, feature, share: asked / all }).collect();
    out.retain(|cost| cost.share > 0.0);
    out.sort_by(|a, b| b.share.total_cmp(&a.share));
    out.truncate(3);
    out
}

/// Dense points that are hidden although no listed point stands for them.
fn hidden(c: &Context<'_>, done: &Outcome, verdicts: &Verdicts) -> Vec<UnresolvedRun> {
    let mut runs = Runs::new(c.field, CHECK_CELLS * verdicts.every as f64);
    for (i, hides) in &verdicts.judged.dense {
        let reason = match *hides {
            _ if done.paid.gave_up(&verdicts.dense[*i]) => UnresolvedReason::GivenUp { over_m: hides.over() },
            // At a price `covered` names it.
            _ if c.settings.slack_price.is_some() => continue,
            Hides::Ground(over_m) | Hides::InGuard(over_m) if done.limited.is_some() && over_m.is_finite() => {
                UnresolvedReason::Limits { over_m }
            }
            Hides::InGuard(over_m) => UnresolvedReason::InsideGuard { over_m },
            Hides::Ground(over_m) if over_m.is_infinite() => UnresolvedReason::NoLineOfSight,
            Hides::Ground(over_m) if c.settings.mode == SolverMode::Paper => UnresolvedReason::Smoothed { over_m },
            Hides::Ground(over_m) => UnresolvedReason::Between { over_m },
        };
        runs.put(&verdicts.dense[*i], reason);
    }
    runs.out
}

/// Parts that cannot be seen, and whether none of them was left by the quadratic program.
struct Named {
    runs: Vec<UnresolvedRun>,
    program_met: bool,
}

fn unresolved(c: &Context<'_>, done: &Outcome, known: &Verdicts) -> Named {
    let mut runs = Runs::new(c.field, c.settings.spacing);
    let in_view = |u: &&Unusable| c.in_view.wedge.contains(c.field.scene_from_grid(u.grid));
    for u in c.prepared.unusable.iter().filter(in_view) {
        let reason = match u.reason {
            UnusableReason::OutsideDem => UnresolvedReason::OutsideDem,
            UnusableReason::NoData => UnresolvedReason::NoData,
        };
        runs.add((u.layer, u.feature, u.kind, u.along_m, u.grid), reason);
    }
    let mut said = Vec::new();
    let of = |i: &usize| c.prepared.points[*i];
    said.extend(c.in_view.too_near.iter().map(|i| (of(i), UnresolvedReason::NearerThanGuard)));
    if c.settings.mode == SolverMode::Paper {
        said.extend(done.greedy_unresolved.iter().map(|i| (of(i), UnresolvedReason::Greedy)));
    }
    let by_program = said.len();
    let dense = c.prepared.dense.len();
    let mut named: BTreeSet<usize> = done.greedy_unresolved.iter().copied().collect();
    for Unresolved { id, reason } in &done.qp_unresolved {
        let reason = match reason {
            Reason::TooNear => UnresolvedReason::NearerThanGuard,
            Reason::NoLine => UnresolvedReason::NoLineOfSight,
            Reason::Infeasible(p) => {
                UnresolvedReason::Infeasible { depth_m: p.depth, gap_m: p.gap, rows: p.rows.len() }
            }
            Reason::NotSettled { lacks } => UnresolvedReason::NotSettled { lacks_m: *lacks },
        };
        said.extend(c.prepared.candidate(*id).map(|point| (*point, reason)));
        named.extend((*id as usize).checked_sub(dense));
    }
    // A solver may give up what is seen all the same, or lies beside the picture.
    let points: Vec<ReferencePoint> = said.iter().map(|(point, _)| *point).collect();
    let verdicts =
        Judge::new(c.field, c.delta, &*c.in_view.sight).prepared(points.len()).judge(&points, c.settings.guard);
    let mut program_met = true;
    for (k, ((point, reason), verdict)) in said.into_iter().zip(verdicts).enumerate() {
        if verdict.hides().is_some() && known.shown.holds(c.field, &point) {
            runs.put(&point, reason);
            program_met &= k < by_program;
        }
    }
    for &(k, hides) in &known.judged.points {
        let (i, over_m) = (known.asked[k], hides.over());
        if c.settings.slack_price.is_none() && !named.contains(&i) {
            let reason = match c.settings.mode {
                _ if done.paid.gave_up(&c.prepared.points[i]) => UnresolvedReason::GivenUp { over_m },
                _ if over_m.is_infinite() => UnresolvedReason::NoLineOfSight,
                SolverMode::Paper => UnresolvedReason::Smoothed { over_m },
                _ if done.limited.is_some() => UnresolvedReason::Limits { over_m },
                SolverMode::PaperQp | SolverMode::Qp => UnresolvedReason::Judged { over_m },
            };
            runs.put(&c.prepared.points[i], reason);
        }
    }
    Named { runs: runs.out, program_met }
}
