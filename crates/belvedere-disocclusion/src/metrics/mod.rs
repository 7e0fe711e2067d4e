//! What a deformed ground is judged by.

mod change;

use super::visibility_qp::LinesOfSight;
use super::{Cells, Field, ReferencePoint};
use belvedere_core::DVec2;
use belvedere_core::grid::Grid;
use belvedere_sight::{DisplacedGround, Excess, SightVertex};
use rayon::prelude::*;
use serde::Serialize;

/// Rays that run this far under the ground are still clear: rounding. Scene units.
const TOUCH: f64 = 1e-6;

/// A displacement of the ground, and what it was made for.
#[derive(Clone, Copy)]
pub struct Deformation<'a> {
    /// The ground as it was.
    pub field: &'a Field,
    /// Displacement, scene units.
    pub delta: &'a Grid,
    /// Displacement in the frame before.
    pub previous: Option<&'a Grid>,
    /// For steps at the borders of cells.
    pub cells: Option<&'a Cells>,
    /// Reference points in view.
    pub points: &'a [ReferencePoint],
    /// Points in view that stand for equal parts of the features, such as [`super::reference_points`] every fifth of a cell.
    pub dense: &'a [ReferencePoint],
    /// How points are seen.
    pub sight: &'a dyn LinesOfSight,
    /// Ground nearer than this to a point does not hide it, cells.
    pub guard: f64,
}

/// How well the ground makes way and how much it is changed. Lengths in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TerrainMetrics {
    /// Share of the reference points that are seen, 0..=1; 1 without points in view.
    pub visible: f64,
    /// Share of the dense points that are seen, 0..=1; 1 without points in view.
    pub visible_dense: f64,
    /// Share of the dense points that are seen but for ground nearer to them than the guard, 0..=1.
    pub hidden_in_guard: f64,
    /// How far the ground rises over the line of sight that it hides most; 0 if nothing is hidden.
    pub hidden_worst_m: f64,
    /// Root mean square displacement of the nodes.
    pub rms_m: f64,
    /// Largest displacement, up or down.
    pub max_m: f64,
    /// Largest displacement upwards; 0 if there is none.
    pub raised_max_m: f64,
    /// Mean angle between the normals before and after, degrees.
    pub normal_mean_deg: f64,
    /// The angle that 95 of 100 nodes stay below, degrees.
    pub normal_p95_deg: f64,
    /// Mean difference of displacement between neighbours across borders of cells; `None` without cells or borders.
    pub border_step_m: Option<f64>,
    /// The difference of displacement that 999 of 1000 pairs of neighbours stay below.
    pub step_p999_m: f64,
    /// Change since the frame before, if there was one.
    pub frame: Option<FrameChange>,
}

/// How much the ground moved from one frame to the next.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FrameChange {
    /// Root mean square over the nodes.
    pub rms_m: f64,
    /// Largest step of a node.
    pub max_m: f64,
}

/// Share of points that the displaced ground shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shown {
    /// 0..=1; 1 without points on the ground.
    pub(super) share: f64,
    /// As [`TerrainMetrics::hidden_worst_m`].
    pub(super) worst_m: f64,
}

impl Shown {
    /// * `over`: of each point on the ground, see [`excesses`].
    fn of(over: impl Iterator<Item = f64>) -> Self {
        let (mut points, mut hidden, mut worst_m) = (0usize, 0usize, 0.0f64);
        for over in over {
            points += 1;
            hidden += usize::from(over > 0.0);
            if over.is_finite() {
                worst_m = worst_m.max(over);
            }
        }
        Self { share: 1.0 - hidden as f64 / points.max(1) as f64, worst_m }
    }
}

/// Lines of sight over the displaced ground.
struct Judge<'a> {
    ground: DisplacedGround<'a>,
    guard: f64,
    sight: &'a dyn LinesOfSight,
}

impl<'a> Judge<'a> {
    fn new(field: &'a Field, delta: &'a Grid, guard: f64, sight: &'a dyn LinesOfSight) -> Self {
        Self { ground: DisplacedGround::new(field, delta), guard, sight }
    }

    /// The line of sight of a point `lift` above the ground at grid coordinates; `None` where there is no ground.
    fn line(&self, g: DVec2, lift: f64) -> Option<Vec<SightVertex>> {
        let mut line = Vec::new();
        self.sight.trace(g, self.ground.height_at(g)? + lift, &mut line);
        Some(line)
    }

    fn excess(&self, line: &[SightVertex]) -> Excess {
        self.ground.excess(line, self.guard)
    }
}

/// Largest height of the ground over the line of sight of each point, negative where it is seen; `None` beside the ground.
pub(super) fn excesses(
    field: &Field,
    delta: &Grid,
    guard: f64,
    sight: &dyn LinesOfSight,
    points: &[ReferencePoint],
) -> Vec<Option<f64>> {
    let judge = Judge::new(field, delta, guard, sight);
    points.par_iter().map(|p| judge.line(p.grid, p.lift).map(|line| over(judge.excess(&line).over))).collect()
}

/// Where the drawn ground hides points at grid coordinates with a lift, and by how much it rises over their lines of sight there.
///
/// * `guard`: ground nearer than this to a point does not hide it, cells.
pub(super) fn hiding(
    field: &Field,
    delta: &Grid,
    guard: f64,
    sight: &dyn LinesOfSight,
    points: &[(DVec2, f64)],
) -> Vec<Option<(DVec2, f64)>> {
    let judge = Judge::new(field, delta, guard, sight);
    let of = |&(g, lift): &(DVec2, f64)| {
        let worst = judge.excess(&judge.line(g, lift)?);
        (worst.over > TOUCH && worst.over.is_finite()).then_some((worst.at, worst.over))
    };
    points.par_iter().map(of).collect()
}

/// What rises over a line of sight; any negative number if that is rounding.
fn over(excess: f64) -> f64 {
    if excess > TOUCH { excess } else { -1.0 }
}

/// What hides a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Hides {
    /// Ground that rises so far over its line of sight; infinite if it has none.
    Ground(f64),
    /// Only ground nearer to it than the guard.
    InGuard(f64),
}

/// Each dense point on the ground, by its index, and what hides it.
fn dense(of: &Deformation<'_>) -> Vec<(usize, Option<Hides>)> {
    let judge = Judge::new(of.field, of.delta, of.guard, of.sight);
    let judged = |(i, p): (usize, &ReferencePoint)| {
        let line = judge.line(p.grid, p.lift)?;
        let (over, near) = (judge.excess(&line).over, judge.ground.near_excess(&line, of.guard));
        let hides = match (over > TOUCH, near > TOUCH) {
            (true, _) => Some(Hides::Ground(over)),
            (false, true) => Some(Hides::InGuard(near)),
            (false, false) => None,
        };
        Some((i, hides))
    };
    of.dense.par_iter().enumerate().filter_map(judged).collect()
}

/// Judges points by lines of sight against the drawn surface, two triangles per cell plus the displacement.
pub(super) fn shown(
    field: &Field,
    delta: &Grid,
    guard: f64,
    sight: &dyn LinesOfSight,
    points: &[ReferencePoint],
) -> Shown {
    Shown::of(excesses(field, delta, guard, sight, points).into_iter().flatten())
}

/// Judges a displacement by lines of sight against the drawn surface, and by what it does to the nodes. Shares no sampling
/// with the solvers.
pub fn terrain_metrics(of: &Deformation<'_>) -> TerrainMetrics {
    judged(of).metrics
}

/// A judgement, point by point.
pub(super) struct Judged {
    pub(super) metrics: TerrainMetrics,
    /// Reference points that are hidden, by their index, and how far the ground rises over their lines.
    pub(super) points: Vec<(usize, f64)>,
    /// Dense points that are hidden, by their index.
    pub(super) dense: Vec<(usize, Hides)>,
}

/// As [`terrain_metrics`], and which points are hidden.
pub(super) fn judged(of: &Deformation<'_>) -> Judged {
    let over = excesses(of.field, of.delta, of.guard, of.sight, of.points);
    let hidden = over.iter().enumerate().filter_map(|(i, over)| Some((i, (*over)?)).filter(|(_, over)| *over > 0.0));
    let dense = dense(of);
    let metrics = figures(of, Shown::of(over.iter().copied().flatten()), &dense);
    let dense = dense.into_iter().filter_map(|(i, hides)| Some((i, hides?))).collect();
    Judged { metrics, points: hidden.collect(), dense }
}

fn figures(of: &Deformation<'_>, points: Shown, dense: &[(usize, Option<Hides>)]) -> TerrainMetrics {
    let in_guard = dense.iter().filter(|d| matches!(d.1, Some(Hides::InGuard(_)))).count();
    let hidden_in_guard = in_guard as f64 / of.dense.len().max(1) as f64;
    let dense = Shown::of(dense.iter().map(|d| match d.1 {
        Some(Hides::Ground(over)) => over,
        _ => -1.0,
    }));
    let u = change::at_nodes(of.field, of.delta);
    let steps = change::steps(of.field, of.cells, &u);
    let normals = change::normals(of.field, &u);
    let size = change::size(of.field, &u);
    let frame = of.previous.map(|before| {
        let before = change::at_nodes(of.field, before);
        let moved: Vec<f64> = u.iter().zip(&before).map(|(a, b)| a - b).collect();
        let change = change::size(of.field, &moved);
        FrameChange { rms_m: change.rms, max_m: change.max }
    });
    TerrainMetrics {
        visible: points.share,
        visible_dense: dense.share,
        hidden_in_guard,
        hidden_worst_m: points.worst_m.max(dense.worst_m),
        rms_m: size.rms,
        max_m: size.max,
        raised_max_m: size.raised,
        normal_mean_deg: normals.mean.to_degrees(),
        normal_p95_deg: normals.p95.to_degrees(),
        border_step_m: steps.border,
        step_p999_m: steps.p999,
        frame,
    }
}

#[cfg(test)]
mod tests;
