//! Pictures over the smoothness weight w and the price of discontinuities eta, mode paper.

use super::area::{Area, TILE};
use super::pictures::figures;
use crate::sheet::{Panel, Pixels, sheet};
use anyhow::Result;
use belvedere::disocclusion::{SolverMode, TerrainReport, TerrainSettings};
use serde::Serialize;

const W: [f64; 5] = [0.1, 0.6, 1.0, 10.0, 100.0];
const ETA: [f64; 5] = [0.0, 0.1, 1.0, 5.0, 10.0];

/// One value of a sweep and the report of its solution.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Trial {
    pub(crate) value: f64,
    pub(crate) report: TerrainReport,
}

/// Sheet and figures over w, 0.1..=100.
pub(crate) fn over_w(area: &Area) -> Result<(Pixels, Vec<Trial>)> {
    sweep(area, "w", &W, |settings, w| settings.w = Some(w))
}

/// Sheet and figures over eta, 0..=10.
pub(crate) fn over_eta(area: &Area) -> Result<(Pixels, Vec<Trial>)> {
    sweep(area, "eta", &ETA, |settings, eta| settings.eta = eta)
}

fn sweep(
    area: &Area,
    name: &str,
    values: &[f64],
    set: impl Fn(&mut TerrainSettings, f64),
) -> Result<(Pixels, Vec<Trial>)> {
    let scene = area.session.scene();
    let note = format!("{} points in view", area.points.len());
    let mut panels = vec![Panel { title: "Perspective".into(), note, frame: area.draw(scene, None, TILE)? }];
    let mut trials = Vec::new();
    for &value in values {
        let mut settings = area.in_mode(SolverMode::Paper);
        set(&mut settings, value);
        let solved = area.solve(&settings, &area.view)?;
        let frame = area.draw(scene, Some(&solved.stage), TILE)?;
        panels.push(Panel { title: format!("{name} = {value}"), note: figures(&solved.report), frame });
        trials.push(Trial { value, report: solved.report });
    }
    Ok((sheet(&panels, 3), trials))
}
