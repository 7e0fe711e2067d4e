//! What a displacement achieves and what it costs, ready for JSON.

use super::super::qp::{Reason, Unresolved};
use super::super::{
    Cells, Field, FrameChange, GreedyCounters, PointKind, ReferencePoint, SolverMode, TerrainSettings, UnusableReason,
};
use super::memory::Prepared;
use super::shown::{Shown, displaced, shown};
use super::{Done, Seen, since};
use belvedere_core::DVec2;
use serde::Serialize;
use std::time::Instant;

/// Everything about a solved displacement. Lengths in scene units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TerrainReport {
    /// The parameters, with defaults filled in.
    pub parameters: TerrainSettings,
    /// Smoothness weight in force, for a solver's grid of 129 nodes.
    pub w: f64,
    /// Wavelength over 2 pi at which the smoothing halves a displacement.
    pub smoothing_length_m: f64,
    /// Columns and rows of the solver's grid.
    pub solver_grid: [usize; 2],
    /// Reference points in view.
    pub points: usize,
    /// Visible share of them, by a tracer that knows nothing of the solver.
    pub visible: f64,
    /// The same before the ground gave way.
    pub visible_before: f64,
    /// Visible share of the features in view, judged every fifth of a cell.
    pub visible_dense: f64,
    /// The same before.
    pub visible_dense_before: f64,
    /// How far the line of sight of the worst hidden place runs under ground.
    pub hidden_worst_m: f64,
    /// Root mean square displacement over the nodes with data.
    pub rms_m: f64,
    /// Largest displacement, up or down.
    pub max_m: f64,
    /// Most that the ground rises anywhere.
    pub raised_max_m: f64,
    /// Mean angle between the normals before and after, degrees.
    pub normal_mean_deg: f64,
    /// 95 % of the nodes lie below this angle.
    pub normal_p95_deg: f64,
    /// Mean step of the displacement across borders of cells, from node to node; `None` where the mode has no cells.
    pub border_step_m: Option<f64>,
    /// 99.9 % of the steps of the displacement from node to node lie below this.
    pub step_p999_m: f64,
    /// Change against the frame before; `None` for the first frame and after a jump.
    pub frame: Option<FrameChange>,
    /// The greedy pass; `None` in mode qp.
    pub greedy: Option<GreedyCounters>,
    /// The quadratic program; `None` in mode paper.
    pub qp: Option<QpReport>,
    /// Whether every reference point and candidate in view is guaranteed to be seen in this picture.
    pub guaranteed: bool,
    /// What cannot be seen, and why.
    pub unresolved: Vec<UnresolvedRun>,
    /// Times.
    pub times: TerrainTimes,
}

/// Figures of the quadratic program.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct QpReport {
    /// Rounds in which all lines of sight were checked.
    pub rounds: usize,
    /// Rows at the end.
    pub rows: usize,
    /// Rows with a multiplier.
    pub active: usize,
    /// Rows added.
    pub added: usize,
    /// Rows taken over from the frame before.
    pub kept: usize,
    /// Points that had to be seen.
    pub candidates: usize,
    /// Half the squared norm of the displacement against its target.
    pub energy: f64,
}

/// Wall times, milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct TerrainTimes {
    /// Cells, points, tables; next to nothing after the first frame.
    pub prepare_ms: f64,
    /// Greedy pass.
    pub greedy_ms: f64,
    /// Smooth pass.
    pub smooth_ms: f64,
    /// Quadratic program.
    pub qp_ms: f64,
    /// These figures.
    pub report_ms: f64,
}

/// Why a part of a feature is not seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum UnresolvedReason {
    /// Beside the terrain.
    OutsideDem,
    /// Where the terrain holds no data.
    NoData,
    /// Nearer to the eye than three times the guard.
    NearerThanGuard,
    /// It has no line of sight, for it lies outside the domain of a later stage.
    NoLineOfSight,
    /// Rows contradict each other: no displacement down to `depth_m` shows all that is asked.
    Infeasible {
        /// Displacements down to this are ruled out.
        depth_m: f64,
        /// By how much the weighted rows miss at best, > 0.
        gap_m: f64,
        /// Rows of the proof.
        rows: usize,
    },
    /// The quadratic program used up its rounds.
    NotSettled {
        /// Metres that lack.
        lacks_m: f64,
    },
    /// The greedy pass could not show it.
    Greedy,
}

/// A part of a feature that is not seen: points one after the other with the same reason.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct UnresolvedRun {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Kind of points.
    pub kind: PointKind,
    /// Length along the feature at the first point.
    pub from_m: f64,
    /// Length along the feature at the last point.
    pub to_m: f64,
    /// Scene x, y of the first point.
    pub at: [f64; 2],
    /// Points.
    pub points: usize,
    /// Why; of a run of points the first one's figures.
    #[serde(flatten)]
    pub reason: UnresolvedReason,
}

pub(super) struct Context<'a> {
    pub(super) settings: &'a TerrainSettings,
    pub(super) field: &'a Field,
    pub(super) prepared: &'a Prepared,
    pub(super) seen: &'a Seen<'a>,
    pub(super) last: Option<&'a [f64]>,
}

pub(super) fn report(c: &Context<'_>, done: &Done, mut times: TerrainTimes, began: Instant) -> TerrainReport {
    let (field, prepared, seen) = (c.field, c.prepared, c.seen);
    let delta = done.fine(prepared);
    let points: Vec<ReferencePoint> = seen.points.iter().map(|&i| prepared.points[i]).collect();
    let dense = prepared.dense_in_view(seen);
    let judge = |delta: Option<&[f64]>| -> [Shown; 2] {
        let nothing = Shown { share: 1.0, hidden: 0, worst: 0.0 };
        displaced(field, delta).map_or([nothing; 2], |ground| {
            [&points, &dense].map(|p| shown(&ground, field, p, &*seen.sight, c.settings.guard))
        })
    };
    let ([before, dense_before], [after, dense_after]) = (judge(None), judge(Some(&delta)));
    let shape = Shape::of(field, &delta);
    let unresolved = unresolved(c, done);
    let (guards, qp_met) = (c.settings.mode != SolverMode::Paper, done.qp_unresolved.is_empty());
    let spacing = (prepared.grid.step() * field.spacing()).max_element();
    let w = prepared.weights().w;
    times.report_ms = since(began);
    TerrainReport {
        parameters: TerrainSettings {
            w: Some(c.settings.smoothness()),
            detail: Some(c.settings.detail()),
            ..c.settings.clone()
        },
        w: c.settings.smoothness(),
        smoothing_length_m: spacing / w.sqrt(),
        solver_grid: [prepared.grid.cols(), prepared.grid.rows()],
        points: points.len(),
        visible: after.share,
        visible_before: before.share,
        visible_dense: dense_after.share,
        visible_dense_before: dense_before.share,
        hidden_worst_m: after.worst.max(dense_after.worst),
        rms_m: shape.rms,
        max_m: shape.max,
        raised_max_m: shape.raised,
        normal_mean_deg: shape.normal_mean_deg,
        normal_p95_deg: shape.normal_p95_deg,
        border_step_m: prepared.cells.as_ref().map(|parts| border_step(field, &parts.0, &delta)),
        step_p999_m: shape.step_p999,
        frame: c.last.map(|last| change(last, &done.coarse)),
        greedy: done.greedy,
        qp: done.qp,
        guaranteed: guards && qp_met && after.hidden == 0,
        unresolved,
        times,
    }
}

fn change(last: &[f64], now: &[f64]) -> FrameChange {
    let steps = last.iter().zip(now).map(|(a, b)| (a - b).abs());
    let (sum, max) = steps.fold((0.0, 0.0f64), |(s, m), d| (s + d * d, m.max(d)));
    FrameChange { rms_m: (sum / now.len().max(1) as f64).sqrt(), max_m: max }
}

struct Shape {
    rms: f64,
    max: f64,
    raised: f64,
    normal_mean_deg: f64,
    normal_p95_deg: f64,
    step_p999: f64,
}

impl Shape {
    fn of(field: &Field, delta: &[f64]) -> Self {
        let (cols, spacing) = (field.cols(), field.spacing());
        let solid = |i: usize| !field.void()[i];
        let (mut sum, mut count, mut max, mut raised) = (0.0, 0usize, 0.0f64, 0.0f64);
        let (mut angles, mut steps) = (Vec::new(), Vec::new());
        for i in (0..delta.len()).filter(|&i| solid(i)) {
            let d = delta[i];
            (sum, count) = (sum + d * d, count + 1);
            (max, raised) = (max.max(d.abs()), raised.max(d));
            let (col, row) = (i % cols, i / cols);
            let east = (col + 1 < cols && solid(i + 1)).then_some(i + 1);
            let south = (row + 1 < field.rows() && solid(i + cols)).then_some(i + cols);
            steps.extend([east, south].into_iter().flatten().map(|k| (delta[k] - d).abs()));
            if let (Some(e), Some(s)) = (east, south) {
                let slope = |h: &dyn Fn(usize) -> f64| DVec2::new(h(e) - h(i), h(s) - h(i)) / spacing;
                let before = slope(&|k| field.heights()[k]);
                let after = slope(&|k| field.heights()[k] + delta[k]);
                let (n, m) = (before.extend(1.0), after.extend(1.0));
                angles.push(n.cross(m).length().atan2(n.dot(m)).to_degrees());
            }
        }
        let mean = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
        Self {
            rms: (sum / count.max(1) as f64).sqrt(),
            max,
            raised,
            normal_mean_deg: mean,
            normal_p95_deg: quantile(&mut angles, 0.95),
            step_p999: quantile(&mut steps, 0.999),
        }
    }
}

fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let k = ((values.len() - 1) as f64 * q).round() as usize;
    *values.select_nth_unstable_by(k, f64::total_cmp).1
}

/// Mean step of the displacement between neighbouring nodes of different cells.
fn border_step(field: &Field, cells: &Cells, delta: &[f64]) -> f64 {
    let (cols, labels) = (field.cols(), cells.labels());
    let (mut sum, mut count) = (0.0, 0usize);
    for i in (0..delta.len()).filter(|&i| !field.void()[i]) {
        let east = (i % cols + 1 < cols).then_some(i + 1);
        let south = (i + cols < delta.len()).then_some(i + cols);
        for k in [east, south].into_iter().flatten().filter(|&k| !field.void()[k] && labels[k] != labels[i]) {
            (sum, count) = (sum + (delta[k] - delta[i]).abs(), count + 1);
        }
    }
    sum / count.max(1) as f64
}

fn unresolved(c: &Context<'_>, done: &Done) -> Vec<UnresolvedRun> {
    let mut runs = Runs { field: c.field, out: Vec::new() };
    for u in &c.prepared.unusable {
        let reason = match u.reason {
            UnusableReason::OutsideDem => UnresolvedReason::OutsideDem,
            UnusableReason::NoData => UnresolvedReason::NoData,
        };
        runs.add((u.layer, u.feature, u.kind, u.along_m, u.grid), reason);
    }
    for &i in &c.seen.too_near {
        runs.put(&c.prepared.points[i], UnresolvedReason::NearerThanGuard);
    }
    if c.settings.mode == SolverMode::Paper {
        for &i in &done.greedy_unresolved {
            runs.put(&c.prepared.points[i], UnresolvedReason::Greedy);
        }
    }
    let dense = c.prepared.dense.len();
    for Unresolved { id, reason } in &done.qp_unresolved {
        let id = *id as usize;
        let point = if id < dense { c.prepared.dense.get(id) } else { c.prepared.points.get(id - dense) };
        let reason = match reason {
            Reason::TooNear => UnresolvedReason::NearerThanGuard,
            Reason::NoLine => UnresolvedReason::NoLineOfSight,
            Reason::Infeasible(p) => {
                UnresolvedReason::Infeasible { depth_m: p.depth, gap_m: p.gap, rows: p.rows.len() }
            }
            Reason::NotSettled { lacks } => UnresolvedReason::NotSettled { lacks_m: *lacks },
        };
        if let Some(point) = point {
            runs.put(point, reason);
        }
    }
    runs.out
}

struct Runs<'a> {
    field: &'a Field,
    out: Vec<UnresolvedRun>,
}

impl Runs<'_> {
    fn put(&mut self, p: &ReferencePoint, reason: UnresolvedReason) {
        self.add((p.layer, p.feature, p.kind, p.along_m, p.grid), reason);
    }

    fn add(
        &mut self,
        (layer, feature, kind, along, grid): (usize, usize, PointKind, f64, DVec2),
        reason: UnresolvedReason,
    ) {
        let same = |r: &UnresolvedRun| {
            (r.layer, r.feature, r.kind) == (layer, feature, kind)
                && std::mem::discriminant(&r.reason) == std::mem::discriminant(&reason)
        };
        if let Some(run) = self.out.last_mut().filter(|r| same(r)) {
            (run.to_m, run.points) = (along, run.points + 1);
            return;
        }
        let at = self.field.scene_from_grid(grid).to_array();
        self.out.push(UnresolvedRun { layer, feature, kind, from_m: along, to_m: along, at, points: 1, reason });
    }
}
