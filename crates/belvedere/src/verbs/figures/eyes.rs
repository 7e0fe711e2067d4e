//! The same picture from eyes at other heights over the ground.

use super::area::Area;
use crate::BelvedereError;
use belvedere_core::{DVec3, Pinhole, View};
use belvedere_disocclusion::SolverMode;
use serde::Serialize;

/// A walker, a tower, a drone, and the heights of the paper's kind of view, metres over the ground.
const HEIGHTS: [f64; 8] = [2.0, 30.0, 100.0, 200.0, 400.0, 700.0, 1000.0, 1500.0];

/// What the modes come to from one eye.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct EyeRow {
    pub(super) above_ground_m: f64,
    pub(super) points: usize,
    pub(super) visible_before: f64,
    pub(super) paper: EyeResult,
    pub(super) qp: EyeResult,
}

/// One mode's figures.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct EyeResult {
    pub(super) visible: f64,
    pub(super) visible_dense: f64,
    pub(super) rms_m: f64,
    pub(super) max_m: f64,
    pub(super) unresolved: usize,
}

/// A row per height: the eye above the same place, looking at the same one.
pub(super) fn eyes(area: &Area) -> Result<Vec<EyeRow>, BelvedereError> {
    let camera = area.view.pinhole();
    let foot = camera.eye.truncate();
    let Some(ground) = area.field.surface_at(area.field.grid_from_scene(foot)) else { return Ok(Vec::new()) };
    let mut rows = Vec::new();
    for above in HEIGHTS {
        area.progress.tick("heights of the eye", rows.len() as f64 / HEIGHTS.len() as f64)?;
        // The direction in plan stays, so the same features are asked for.
        let eye = foot.extend(ground + above);
        let ahead = camera.forward.truncate().normalize_or_zero().extend(camera.forward.z);
        let target = eye + ahead.normalize_or(DVec3::X);
        let pinhole = Pinhole::look_at(eye, target, DVec3::Z, camera.projection, camera.image, camera.near, camera.far)
            .map_err(|e| BelvedereError::Usage(e.to_string()))?;
        let view = View::straight(pinhole);
        let result = |mode| -> Result<_, BelvedereError> {
            let r = area.solve(&area.in_mode(mode), &view)?.report;
            let unresolved = r.unresolved.iter().map(|run| run.points).sum();
            let of = EyeResult {
                visible: r.metrics.visible,
                visible_dense: r.metrics.visible_dense,
                rms_m: r.metrics.rms_m,
                max_m: r.metrics.max_m,
                unresolved,
            };
            Ok((of, r.points, r.visible_before))
        };
        let (paper, points, visible_before) = result(SolverMode::Paper)?;
        let (qp, ..) = result(SolverMode::Qp)?;
        rows.push(EyeRow { above_ground_m: above, points, visible_before, paper, qp });
    }
    Ok(rows)
}
