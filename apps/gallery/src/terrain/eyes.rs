//! The same picture from eyes at other heights over the ground.

use super::area::Area;
use anyhow::Result;
use belvedere::core::{DVec3, Pinhole, View};
use belvedere::disocclusion::SolverMode;
use serde::Serialize;

/// Heights of a walker, a tower, a drone, and of the paper's kind of view, metres over the ground.
const HEIGHTS: [f64; 8] = [2.0, 30.0, 100.0, 200.0, 400.0, 700.0, 1000.0, 1500.0];

/// Results of both modes from one eye.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct EyeRow {
    pub(crate) above_ground_m: f64,
    pub(crate) points: usize,
    pub(crate) visible_before: f64,
    pub(crate) paper: EyeResult,
    pub(crate) qp: EyeResult,
}

/// Results of one mode.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct EyeResult {
    pub(crate) visible: f64,
    pub(crate) visible_dense: f64,
    pub(crate) rms_m: f64,
    pub(crate) max_m: f64,
    pub(crate) unresolved: usize,
}

/// A row per height: the eye above the same point, looking in the same direction.
pub(crate) fn eyes(area: &Area) -> Result<Vec<EyeRow>> {
    let camera = area.view.pinhole();
    let foot = camera.eye.truncate();
    let Some(ground) = area.field.surface_at(area.field.grid_from_scene(foot)) else { return Ok(Vec::new()) };
    let mut rows = Vec::new();
    for above in HEIGHTS {
        area.progress.tick("heights of the eye", rows.len() as f64 / HEIGHTS.len() as f64)?;
        // The direction in plan stays, so the same features are in view.
        let eye = foot.extend(ground + above);
        let ahead = camera.forward.truncate().normalize_or_zero().extend(camera.forward.z);
        let target = eye + ahead.normalize_or(DVec3::X);
        let pinhole =
            Pinhole::look_at(eye, target, DVec3::Z, camera.projection, camera.image, camera.near, camera.far)?;
        let view = View::straight(pinhole);
        let result = |mode| -> Result<_> {
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
