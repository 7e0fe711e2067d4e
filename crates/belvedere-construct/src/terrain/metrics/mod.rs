//! What a deformed ground is judged by.

mod change;
mod ray;

use super::{Cells, Field, ReferencePoint, TerrainSettings, Wedge};
use crate::samples::{Amount, sample_features};
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::Scene;
use ray::Drawn;
use rayon::prelude::*;
use serde::Serialize;

/// Spacing of the dense samples along features, cells.
const DENSE: f64 = 0.2;
/// Rays that run this far under the ground are still clear: rounding. Scene units.
const TOUCH: f64 = 1e-6;

/// A displacement of the ground, and what it was made for.
#[derive(Clone, Copy)]
pub struct Deformation<'a> {
    /// The features that must be seen.
    pub scene: &'a Scene,
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
    /// Eye, scene coordinates.
    pub eye: DVec3,
    /// What is in view.
    pub wedge: &'a Wedge,
    /// Of these only `guard` and `lift_m` matter.
    pub settings: &'a TerrainSettings,
}

/// How well the ground makes way and how much it is changed. Lengths in scene units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TerrainMetrics {
    /// Share of the reference points that are seen, 0..=1; `None` without points in view.
    pub visible: Option<f64>,
    /// Share of the length of lines in view that is seen, by rays every fifth of a cell; of area, or points, if there are no
    /// lines; `None` if nothing is in view.
    pub visible_dense: Option<f64>,
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

/// Judges a displacement by straight rays against the drawn surface, two triangles per cell plus the displacement, and by
/// what it does to the nodes. Shares no sampling with the solvers.
///
/// Points nearer to the eye than three guards and parts of features without ground are not judged.
pub fn terrain_metrics(of: &Deformation<'_>) -> TerrainMetrics {
    let drawn = Drawn::new(of.field, of.delta, of.eye, of.settings.guard);
    let points: Vec<Judged> = of
        .points
        .par_iter()
        .filter_map(|p| drawn.excess(p.grid, p.lift).map(|over| Judged { over, amount: 1.0 }))
        .collect();
    let dense = dense(of, &drawn);
    let worst = points.iter().chain(&dense).map(|j| j.over).filter(|&over| over > TOUCH).fold(0.0, f64::max);
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
        visible: share(&points),
        visible_dense: share(&dense),
        hidden_worst_m: worst,
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

/// What a ray found.
#[derive(Debug, Clone, Copy)]
struct Judged {
    /// Largest height of the ground over the ray.
    over: f64,
    /// What the sample stands for.
    amount: f64,
}

fn share(judged: &[Judged]) -> Option<f64> {
    let sum = |seen: bool| judged.iter().filter(|j| !seen || j.over <= TOUCH).map(|j| j.amount).sum::<f64>();
    let all = sum(false);
    (all > 0.0).then(|| (sum(true) + 0.0) / all)
}

fn dense(of: &Deformation<'_>, drawn: &Drawn<'_>) -> Vec<Judged> {
    let features = sample_features(of.scene, DENSE * of.field.spacing().min_element());
    let near = 3.0 * of.settings.guard;
    let eye = of.field.grid_from_scene(of.eye.truncate());
    let counted = |xy: DVec2| of.wedge.contains(xy) && (of.field.grid_from_scene(xy) - eye).length() >= near;
    for unit in [Amount::Length, Amount::Area, Amount::Count] {
        let samples: Vec<_> = features.iter().filter(|f| f.amount == unit).flat_map(|f| &f.samples).collect();
        let judge = |s: &&crate::samples::Sample| {
            let xy = s.p_world.truncate();
            let over = drawn.excess(of.field.grid_from_scene(xy), of.settings.lift_m.unwrap_or(s.lift));
            over.filter(|_| counted(xy)).map(|over| Judged { over, amount: s.amount })
        };
        let judged: Vec<Judged> = samples.par_iter().filter_map(judge).collect();
        if !judged.is_empty() {
            return judged;
        }
    }
    Vec::new()
}

#[cfg(test)]
mod tests;
