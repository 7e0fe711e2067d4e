//! Judges a file of heights: its own samples, all of them, and the triangles between them.

use super::super::metrics::{Hides, Judge, Verdict, amounts, share_seen, shares, shares_of_whole, sums};
use super::super::points::{judged_points, reference_points_of, required_features};
use super::super::visibility_qp::LinesOfSight;
use super::super::{Field, KINDS, ReferencePoint, SolverMode, TerrainSettings, Wedge};
use super::memory::{self, CHECK_CELLS};
use super::report::{Covered, TerrainReport, UnresolvedReason, UnresolvedRun};
use super::reporting::{AGREES, sampled, too_many};
use super::runs::Runs;
use super::sample_grid::SampleGrid;
use super::{PriceReport, TerrainSolver, drop_at};
use crate::DisocclusionError;
use crate::in_view::NEAREST_GUARDS;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Progress, Scene};
use rayon::prelude::*;

/// Heights as a file holds them.
#[derive(Clone, Copy)]
pub struct WrittenGround<'a> {
    /// Its samples.
    pub grid: SampleGrid<'a>,
    /// Height of a sample (row-major), scene units; `None` without data.
    pub height: &'a (dyn Fn(usize) -> Option<f64> + Sync),
    /// Whether the samples are those that were solved on.
    pub solved_on: bool,
}

/// What a file shows of the features.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenShares {
    /// Share of the reference points in view that are seen, 0..=1.
    pub visible: f64,
    /// Visible share of the features in view, 0..=1.
    pub visible_dense: f64,
    /// Share that only ground nearer than the guard hides, 0..=1.
    pub hidden_in_guard: f64,
    /// Largest height by which the ground rises over a line of sight, scene units; 0 if nothing is hidden.
    pub hidden_worst_m: f64,
    /// Visible share of the whole features, 0..=`in_view`.
    pub visible_whole: f64,
    /// Share of the whole features in view, 0..=1.
    pub in_view: f64,
    /// One of this many points was judged: 1, but more where time was short.
    pub judged_every: usize,
    /// Whether the judge finds nothing hidden, but for rounding.
    all_seen: bool,
    hidden: Vec<UnresolvedRun>,
    covered: Vec<Covered>,
}

impl WrittenShares {
    /// Puts what the file shows into the report of the solution: the guarantee and the shares of the whole features, and all figures
    /// of visibility where the samples of the file are those that were solved on.
    ///
    /// * `before`: shares of the heights before the move; `solved_on`: [`WrittenGround::solved_on`].
    pub fn put(&self, before: &Self, solved_on: bool, report: &mut TerrainReport) {
        report.guaranteed = report.promised && self.all_seen;
        (report.visible_whole_before, report.visible_whole) = (before.visible_whole, self.visible_whole);
        report.in_view = self.in_view;
        if !solved_on {
            return;
        }
        let m = &mut report.metrics;
        (m.visible, m.visible_dense) = (self.visible, self.visible_dense);
        (m.hidden_in_guard, m.hidden_worst_m) = (self.hidden_in_guard, self.hidden_worst_m);
        (report.visible_before, report.visible_dense_before) = (before.visible, before.visible_dense);
        report.judged_every = self.judged_every;
        let is_hidden = |r: &UnresolvedRun| {
            let same = |h: &&UnresolvedRun| (h.layer, h.feature, h.kind) == (r.layer, r.feature, r.kind);
            self.hidden.iter().filter(same).any(|h| h.from_m <= r.to_m && h.to_m >= r.from_m)
        };
        use UnresolvedReason::{NearerThanGuard, NoData, NoLineOfSight, OutsideDem};
        report
            .unresolved
            .retain(|r| matches!(r.reason, OutsideDem | NoData | NearerThanGuard | NoLineOfSight) || is_hidden(r));
        report.hidden.clone_from(&self.hidden);
        report.covered.clone_from(&self.covered);
    }
}

impl TerrainSolver {
    /// Judges a file of heights by lines of sight over the triangles between its samples.
    ///
    /// * `view`: the camera, with the curvature of the earth if it has any; what lies between its left and right border is in view;
    /// * `report`: of the solution that the file holds.
    ///
    /// # Errors
    /// [`DisocclusionError::Field`], [`DisocclusionError::Cancelled`].
    pub fn judge_written(
        &self,
        scene: &Scene,
        view: &View,
        ground: &WrittenGround<'_>,
        report: &TerrainReport,
        progress: &Progress,
    ) -> Result<WrittenShares, DisocclusionError> {
        progress.tick("judging the written heights", 0.0)?;
        let settings = &self.settings;
        let field = ground.field(view)?;
        let features: Vec<_> =
            required_features(scene).iter().map(|f| f.mapped(&|line| ground.grid.image_of(&field, line))).collect();
        let (all, beside) = judged_points(&features, &field, settings, CHECK_CELLS);
        let sight = SightOverFile::new(ground.grid, view);
        let in_view = |points: &[ReferencePoint]| sight.in_view(&field, points, view, settings);
        let seen_from = in_view(&all);
        let points = in_view(&reference_points_of(&features, &field, settings));
        let judge = Judge::still(&field, &sight);
        let few = too_many(progress, &judge, &seen_from, settings.guard);
        let in_view_amounts = amounts(&seen_from);
        let (dense, every) = sampled(seen_from, few);
        let judge = judge.prepared(dense.len());
        let [of_points, of_dense] = [&points, &dense].map(|points| judge.judge(points, settings.guard));
        progress.tick("judging the written heights", 1.0)?;
        let amounts: [[f64; KINDS]; 3] = [amounts(&dense), in_view_amounts, sums(amounts(&all), beside)];
        let [visible_whole, in_view] = shares_of_whole((&dense, &of_dense), amounts);
        let [visible_dense, hidden_in_guard] = shares(&dense, &of_dense);
        let over = of_points.iter().chain(&of_dense).filter_map(|v| v.hides()).map(Hides::over);
        let hidden = of_dense.iter().filter(|v| v.hides().is_some()).count();
        let of_points_hidden = of_points.iter().filter(|v| v.hides().is_some()).count();
        let most = if every == 1 { (1.0 - AGREES) * dense.len() as f64 } else { 0.0 };
        let parts = Parts { ground, field: &field, report, limited: report.limited.is_some() };
        let (hidden_runs, covered) = parts.of(&dense, &of_dense, every);
        Ok(WrittenShares {
            visible: share_seen(&points, &of_points),
            visible_dense,
            hidden_in_guard,
            hidden_worst_m: over.filter(|over| over.is_finite()).fold(0.0, f64::max),
            visible_whole,
            in_view,
            judged_every: every,
            all_seen: visible_dense >= AGREES && hidden as f64 <= most && (every == 1 || of_points_hidden == 0),
            hidden: hidden_runs,
            covered,
        })
    }
}

impl WrittenGround<'_> {
    /// The samples, lowered by the curvature of the earth.
    pub(super) fn field(&self, view: &View) -> Result<Field, DisocclusionError> {
        let grid = &self.grid;
        let cols = grid.nodes[0];
        let height = |i: usize| {
            let height = (self.height)(grid.sample(i))?;
            let Some(earth) = view.earth() else { return Some(height) };
            let at = grid.scene(DVec2::new((i % cols) as f64, (i / cols) as f64))?;
            Some(height - drop_at(earth, at))
        };
        let heights = (0..grid.len()).into_par_iter().with_min_len(4096).map(|i| height(i).unwrap_or(f64::NAN));
        Ok(Field::of_samples(grid.nodes, grid.spacing, heights.collect())?)
    }
}

/// Straight lines of the scene to the eye, over the grid of a file.
pub(super) struct SightOverFile<'a> {
    grid: SampleGrid<'a>,
    eye: DVec3,
    eye_index: Option<DVec2>,
}

impl LinesOfSight for SightOverFile<'_> {
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>) {
        let (Some(from), Some(eye_index)) = (self.grid.scene(grid), self.eye_index) else { return };
        let to = self.eye.truncate();
        let length = from.distance(to).max(f64::MIN_POSITIVE);
        out.push((grid, z));
        self.grid.halve((from, grid), (to, eye_index), 0, &mut |p, index| {
            out.push((index, z + (self.eye.z - z) * from.distance(p) / length));
        });
        out.push((eye_index, self.eye.z));
    }
}

impl<'a> SightOverFile<'a> {
    pub(super) fn new(grid: SampleGrid<'a>, view: &View) -> Self {
        let eye = view.pinhole().eye;
        Self { grid, eye, eye_index: grid.index(eye.truncate()) }
    }

    /// Share of the way from a point to the eye at which a position lies, both in grid coordinates of the file.
    pub(super) fn share_of_way(&self, point: DVec2, at: DVec2) -> f64 {
        let [Some(point), Some(at)] = [point, at].map(|index| self.grid.scene(index)) else { return 0.0 };
        point.distance(at) / point.distance(self.eye.truncate()).max(f64::MIN_POSITIVE)
    }

    /// The points between the left and the right border of the picture that are not too near to the eye.
    pub(super) fn in_view(
        &self,
        field: &Field,
        points: &[ReferencePoint],
        view: &View,
        settings: &TerrainSettings,
    ) -> Vec<ReferencePoint> {
        let Some(eye) = self.eye_index else { return Vec::new() };
        let wedge = Wedge::of_pinhole(view.pinhole());
        let ahead = memory::ahead(field, points, field.scene_from_grid(eye), settings.ahead_m);
        let holds = |p: &ReferencePoint| {
            (p.grid - eye).length() >= NEAREST_GUARDS * settings.guard
                && self.grid.scene(p.grid).is_some_and(|xy| wedge.contains(xy))
        };
        points.par_iter().zip(ahead).filter(|(p, near)| *near && holds(p)).map(|(p, _)| *p).collect()
    }
}

/// Parts of features that a file hides.
struct Parts<'a> {
    ground: &'a WrittenGround<'a>,
    field: &'a Field,
    report: &'a TerrainReport,
    limited: bool,
}

impl Parts<'_> {
    /// Hidden parts with their reasons; with a price of slack, points that stay covered.
    fn of(&self, dense: &[ReferencePoint], verdicts: &[Verdict], every: usize) -> (Vec<UnresolvedRun>, Vec<Covered>) {
        let mut runs = Runs::new(self.field, CHECK_CELLS * every as f64);
        let mut covered = Vec::new();
        let scene = |index: DVec2| self.ground.grid.scene(index).unwrap_or(DVec2::ZERO).to_array();
        for (p, verdict) in dense.iter().zip(verdicts) {
            let Some(hides) = verdict.hides() else { continue };
            if self.report.parameters.slack_price.is_some() && hides.over().is_finite() {
                covered.push(Covered { at: scene(p.grid), lift_m: p.lift, over_m: hides.over() });
            } else {
                runs.put(p, self.reason(p, hides));
            }
        }
        runs.out.iter_mut().for_each(|run| run.at = scene(self.field.grid_from_scene(DVec2::from_array(run.at))));
        (runs.out, covered)
    }

    fn reason(&self, p: &ReferencePoint, hides: Hides) -> UnresolvedReason {
        let over_m = hides.over();
        let gave_up = |price: &PriceReport| price.given_up.iter().any(|given| given.holds(p));
        match hides {
            _ if over_m.is_infinite() => UnresolvedReason::NoLineOfSight,
            _ if self.report.price.as_ref().is_some_and(gave_up) => UnresolvedReason::GivenUp { over_m },
            _ if !self.ground.solved_on => UnresolvedReason::Written { over_m },
            _ if self.limited => UnresolvedReason::Limits { over_m },
            Hides::InGuard(_) => UnresolvedReason::InsideGuard { over_m },
            _ if self.report.parameters.mode == SolverMode::Paper => UnresolvedReason::Smoothed { over_m },
            _ => UnresolvedReason::Between { over_m },
        }
    }
}
