//! Measures of a displaced ground: visible shares, size and unevenness of the displacement, change between frames.

mod change;
mod judge;

pub(super) use judge::{Hides, Judge, Verdict, amounts, share_seen, shares, shares_of_whole, sums};

use super::visibility_qp::LinesOfSight;
use super::{Cells, Field, ReferencePoint};
use belvedere_core::grid::Grid;
use serde::Serialize;

/// In films the angles of normals and the steps between neighbours are those of every so many rows.
const FILM_ROWS: usize = 16;

/// A displacement of the ground, and the points that it was made for.
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
    /// Points in view that stand for equal parts of the features, such as [`super::reference_points`] every tenth of a cell.
    pub dense: &'a [ReferencePoint],
    /// Lines of sight of the points.
    pub sight: &'a dyn LinesOfSight,
    /// Whether the unevenness is that of every node, or of every sixteenth row, as of films.
    pub every_node: bool,
    /// Points that only ground nearer than this hides are told apart, grid cells.
    pub guard: f64,
}

/// Visibility on a displaced ground, and the size of the displacement. Lengths in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TerrainMetrics {
    /// Share of the reference points that are seen, 0..=1; 1 without points in view.
    pub visible: f64,
    /// Visible share of the features that the dense points stand for, 0..=1; 1 without points in view. Lines count by length, areas by area in plan, point features by number; the least of the three is
    /// given.
    pub visible_dense: f64,
    /// Share of that kind of features that only ground nearer than the guard hides, 0..=1.
    pub hidden_in_guard: f64,
    /// Largest height by which the ground rises over a line of sight; 0 if nothing is hidden.
    pub hidden_worst_m: f64,
    /// Root mean square displacement of the nodes.
    pub rms_m: f64,
    /// Largest displacement, up or down.
    pub max_m: f64,
    /// Largest displacement upwards; 0 if there is none.
    pub raised_max_m: f64,
    /// Depth of the lowest displaced node below the lowest undisplaced one; 0 if it is not lower.
    pub sunk_below_m: f64,
    /// Steepest slope between two neighbouring nodes before the displacement, degrees.
    pub steepest_before_deg: f64,
    /// Steepest slope between two neighbouring nodes after it, degrees.
    pub steepest_deg: f64,
    /// Mean angle between the normals before and after, degrees; in films of every sixteenth row of nodes, as the next three.
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

/// Motion of the ground from one frame to the next.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FrameChange {
    /// Root mean square over the nodes.
    pub rms_m: f64,
    /// Largest step of a node.
    pub max_m: f64,
}

/// Judges a displacement by lines of sight over the ground, and by what it does to the nodes.
/// Shares no sampling with the solvers.
pub fn terrain_metrics(of: &Deformation<'_>) -> TerrainMetrics {
    judged(of).metrics
}

/// A judgement, point by point.
pub(super) struct Judged {
    pub(super) metrics: TerrainMetrics,
    /// Reference points that are hidden, by their index.
    pub(super) points: Vec<(usize, Hides)>,
    /// Dense points that are hidden, by their index.
    pub(super) dense: Vec<(usize, Hides)>,
    /// Verdicts on all dense points.
    pub(super) of_dense: Vec<Verdict>,
}

/// As [`terrain_metrics`], and which points are hidden.
pub(super) fn judged(of: &Deformation<'_>) -> Judged {
    let u = change::at_nodes(of.field, of.delta);
    let judge = Judge::new(of.field, of.delta, of.sight).prepared(of.dense.len());
    let [points, dense] = [of.points, of.dense].map(|points| judge.judge(points, of.guard));
    let hidden = |all: &[Verdict]| -> Vec<(usize, Hides)> {
        all.iter().enumerate().filter_map(|(i, verdict)| Some((i, verdict.hides()?))).collect()
    };
    let metrics = figures(of, &u, &points, &dense);
    Judged { metrics, points: hidden(&points), dense: hidden(&dense), of_dense: dense }
}

fn figures(of: &Deformation<'_>, u: &[f64], points: &[Verdict], dense: &[Verdict]) -> TerrainMetrics {
    let [visible_dense, hidden_in_guard] = shares(of.dense, dense);
    let over = points.iter().chain(dense).filter_map(|v| v.hides()).map(Hides::over);
    let every = if of.every_node { 1 } else { FILM_ROWS };
    let steps = change::steps(of.field, of.cells, u, every);
    let normals = change::normals(of.field, u, every);
    let size = change::size(of.field, u);
    let [steepest_before_deg, steepest_deg] = change::steepest(of.field, u);
    let frame = of.previous.map(|before| {
        let before = change::at_nodes(of.field, before);
        let moved: Vec<f64> = u.iter().zip(&before).map(|(a, b)| a - b).collect();
        let change = change::size(of.field, &moved);
        FrameChange { rms_m: change.rms, max_m: change.max }
    });
    TerrainMetrics {
        visible: share_seen(of.points, points),
        visible_dense,
        hidden_in_guard,
        hidden_worst_m: over.filter(|over| over.is_finite()).fold(0.0, f64::max),
        rms_m: size.rms,
        max_m: size.max,
        raised_max_m: size.raised,
        sunk_below_m: change::sunk_below(of.field, u),
        steepest_before_deg,
        steepest_deg,
        normal_mean_deg: normals.mean.to_degrees(),
        normal_p95_deg: normals.p95.to_degrees(),
        border_step_m: steps.border,
        step_p999_m: steps.p999,
        frame,
    }
}

#[cfg(test)]
mod tests;
