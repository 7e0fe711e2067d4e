//! Perspective beside occlusion-free, and the steps between them: cells, naive ground, final ground.

use super::area::{Area, TILE};
use crate::sheet::{Panel, Pixels, sheet};
use anyhow::Result;
use belvedere::core::TerrainDisocclusion;
use belvedere::disocclusion::{Solved, SolverMode, TerrainReport};
use belvedere::scene::Scene;

/// Size of the two pictures side by side, pixels.
const PAIR: [u32; 2] = [960, 540];

/// Solutions of the area's own parameters that several figures share.
pub(crate) struct Solutions {
    pub(crate) paper: Solved,
    pub(crate) paper_qp: Solved,
    pub(crate) qp: Solved,
}

impl Solutions {
    pub(crate) fn of(area: &Area) -> Result<Self> {
        let solve = |mode| area.solve(&area.in_mode(mode), &area.view);
        Ok(Self { paper: solve(SolverMode::Paper)?, paper_qp: solve(SolverMode::PaperQp)?, qp: solve(SolverMode::Qp)? })
    }
}

/// Perspective on the left, occlusion-free on the right.
pub(crate) fn pair(area: &Area, solutions: &Solutions) -> Result<Pixels> {
    let (scene, solved) = (area.session.scene(), &solutions.qp);
    let r = &solved.report;
    let before = Panel {
        title: "Perspective".into(),
        note: format!("{} of the features in view can be seen", percent(r.visible_dense_before)),
        frame: area.draw(scene, None, PAIR)?,
    };
    let after = Panel {
        title: "The ground makes way".into(),
        note: format!(
            "{} can be seen; of all the ground no node moved more than {:.0} m",
            percent(r.metrics.visible_dense),
            r.metrics.max_m
        ),
        frame: area.draw(scene, Some(&solved.stage), PAIR)?,
    };
    Ok(sheet(&[before, after], 2))
}

/// Perspective, cells, naive ground, and what the three modes end with.
pub(crate) fn steps(area: &Area, solutions: &Solutions) -> Result<Pixels> {
    let scene = area.session.scene();
    let settings = area.in_mode(SolverMode::Paper);
    let naive = area.naive(&settings);
    let counters = naive.counters();
    let draw = |scene: &Scene, stage: Option<&TerrainDisocclusion>| area.draw(scene, stage, TILE);
    let ending = |title: &str, solved: &Solved| -> Result<Panel> {
        Ok(Panel { title: title.into(), note: figures(&solved.report), frame: draw(scene, Some(&solved.stage))? })
    };
    let panels = [
        Panel {
            title: "Perspective".into(),
            note: format!(
                "{} of {} points can be seen",
                percent(solutions.qp.report.visible_before),
                area.points.len()
            ),
            frame: draw(scene, None)?,
        },
        Panel {
            title: format!("{} cells", area.cells.len()),
            note: "one per summit that stands out".into(),
            frame: draw(&super::cells::painted(area), None)?,
        },
        Panel {
            title: "Naive ground".into(),
            note: format!("{} transforms of {} cells", counters.hits, counters.cells_changed),
            frame: draw(scene, Some(&area.naive_stage(&naive)?))?,
        },
        ending("Mode paper: smoothed", &solutions.paper)?,
        ending("Mode paper+qp: smoothed, then made sure of", &solutions.paper_qp)?,
        ending("Mode qp: least bending that shows everything", &solutions.qp)?,
    ];
    Ok(sheet(&panels, 3))
}

/// The figures of a solution that fit under a picture.
pub(crate) fn figures(r: &TerrainReport) -> String {
    format!(
        "visible {}, moved {:.0} m rms, 99.9 % of steps below {:.0} m",
        percent(r.metrics.visible),
        r.metrics.rms_m,
        r.metrics.step_p999_m
    )
}

pub(crate) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
