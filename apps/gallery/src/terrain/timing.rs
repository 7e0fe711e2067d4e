//! What the steps cost, for as many points as the paper had.

use super::area::Area;
use crate::chart::{self, Chart, Curve, SeriesLabelPosition, Style};
use crate::sheet::Pixels;
use anyhow::Result;
use belvedere::core::DVec2;
use belvedere::disocclusion::internals::{
    Cells, Hierarchy, Naive, ReferencePoint, SmoothPass, Wedge, in_view, reference_points, stated_spacing,
};
use belvedere::disocclusion::{SolverMode, TerrainSettings};
use serde::Serialize;
use std::time::Instant;

/// Points in view, and milliseconds for lines of sight and parameters, of the six examples of Deng et al. 2013.
pub(crate) const PAPER: [(usize, f64); 6] =
    [(195, 2.0), (202, 3.0), (513, 12.0), (560, 14.0), (660, 14.0), (670, 14.0)];
/// The paper's cells and the milliseconds for them.
pub(crate) const PAPER_CELLS: (usize, f64) = (651, 1570.0);
/// The paper's unknowns, and milliseconds of a solution per frame.
pub(crate) const PAPER_SOLVE: (usize, f64) = (16_641, 30.0);
/// Times are medians of so many runs.
const RUNS: usize = 5;

/// Times of one area, wall milliseconds.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Timing {
    /// Nodes of the terrain.
    pub(crate) nodes: [usize; 2],
    pub(crate) cells: usize,
    /// Cells and their tables.
    pub(crate) cells_ms: f64,
    /// Unknowns of the smooth pass.
    pub(crate) unknowns: usize,
    /// Preparing the smooth pass: no matrix is built or factorised.
    pub(crate) prepare_ms: f64,
    /// One solution of the smooth pass, elevation rows included.
    pub(crate) solve_ms: f64,
    /// Greedy pass for as many points as the paper had; fewer lines if the features have not as many.
    pub(crate) greedy: Vec<GreedyTime>,
    /// Fitted: greedy time grows like this power of the points.
    pub(crate) exponent: Option<f64>,
}

/// Lines of sight and parameters of some points.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct GreedyTime {
    pub(crate) points: usize,
    pub(crate) ms: f64,
    pub(crate) paper_ms: f64,
}

/// Measures an area.
pub(crate) fn timing(area: &Area) -> Result<Timing> {
    let (field, settings) = (&area.field, area.in_mode(SolverMode::Paper));
    let cells_ms = median(|| drop(Cells::new(field, area.cells.len())));
    let w = settings.smoothness(stated_spacing(field.cols(), field.rows(), field.spacing()));
    let began = Instant::now();
    // The paper's grid, whatever the scene asks for.
    let nodes = TerrainSettings::default().solver_nodes;
    let hierarchy = Hierarchy::new(field.cols(), field.rows(), nodes);
    let unknowns = hierarchy.nodes();
    let rows: Vec<DVec2> = area.points.iter().map(|p| p.grid).chain(summits(area)).collect();
    let mut pass = SmoothPass::new(hierarchy, w, settings.rows_weight, &rows)?;
    let prepare_ms = since(began);
    let naive = area.naive(&settings).displacement(field, &area.cells);
    let solve_ms = median(|| drop(pass.run(&naive, None, None)));
    let many = dense(area);
    let mut greedy = Vec::new();
    for (count, paper_ms) in PAPER {
        let Some(points) = evenly(&many, count) else { continue };
        area.progress.tick("times", greedy.len() as f64 / PAPER.len() as f64)?;
        let run = || drop(Naive::new(field, &area.cells, Some(&area.blocks), &settings, area.eye(), &points));
        greedy.push(GreedyTime { points: count, ms: median(run), paper_ms });
    }
    let exponent = exponent(&greedy);
    let (nodes, cells) = ([field.cols(), field.rows()], area.cells.len());
    Ok(Timing { nodes, cells, cells_ms, unknowns, prepare_ms, solve_ms, greedy, exponent })
}

/// Time against points, the paper's beside ours.
pub(crate) fn plot(timing: &Timing) -> Result<Option<Pixels>> {
    if timing.greedy.is_empty() {
        return Ok(None);
    }
    let of = |ms: fn(&GreedyTime) -> f64| timing.greedy.iter().map(|g| (g.points as f64, ms(g))).collect::<Vec<_>>();
    let curves = vec![
        Curve::new("paper (2.33 GHz, 2012)", of(|g| g.paper_ms), [200, 90, 60], Style::Dots),
        Curve::new("here", of(|g| g.ms), [30, 90, 170], Style::Dots),
    ];
    let chart = Chart {
        title: "Lines of sight and parameters of the greedy pass".into(),
        x: "reference points in view".into(),
        y: "wall time, ms".into(),
        legend: SeriesLabelPosition::UpperLeft,
        curves,
    };
    Ok(Some(chart::draw(&chart, chart::WIDE)?))
}

fn summits(area: &Area) -> impl Iterator<Item = DVec2> + '_ {
    let cols = area.field.cols();
    area.cells.summits().iter().map(move |&i| DVec2::new((i as usize % cols) as f64, (i as usize / cols) as f64))
}

/// Points in view, closer together than any count needs.
fn dense(area: &Area) -> Vec<ReferencePoint> {
    let spacing = area.settings.spacing * area.points.len() as f64 / 2000.0;
    let (points, _) =
        reference_points(area.session.scene(), &area.field, &area.settings, spacing.clamp(0.05, area.settings.spacing));
    let wedge = Wedge::of_pinhole(area.view.pinhole());
    in_view(&area.field, &points, &wedge, area.settings.guard).0.into_iter().map(|i| points[i]).collect()
}

/// `count` of the points, evenly chosen; `None` if there are not as many.
fn evenly(points: &[ReferencePoint], count: usize) -> Option<Vec<ReferencePoint>> {
    (points.len() >= count).then(|| (0..count).map(|i| points[i * points.len() / count]).collect())
}

/// Slope of log time over log points by least squares.
fn exponent(greedy: &[GreedyTime]) -> Option<f64> {
    let logs: Vec<DVec2> = greedy.iter().map(|g| DVec2::new((g.points as f64).ln(), g.ms.max(1e-6).ln())).collect();
    let mean = logs.iter().sum::<DVec2>() / logs.len().max(1) as f64;
    let (xy, xx) = logs.iter().map(|p| *p - mean).fold((0.0, 0.0), |(a, b), d| (a + d.x * d.y, b + d.x * d.x));
    (xx > 0.0).then(|| xy / xx)
}

fn median(mut run: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let began = Instant::now();
            run();
            since(began)
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

fn since(began: Instant) -> f64 {
    began.elapsed().as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_is_that_of_a_power() {
        let time = |points: usize| GreedyTime { points, ms: 0.01 * (points as f64).powf(1.3), paper_ms: 0.0 };
        let fitted = exponent(&PAPER.map(|(n, _)| time(n))).unwrap();
        assert!((fitted - 1.3).abs() < 1e-9, "{fitted}");
        assert_eq!(exponent(&[time(7)]), None);
        assert_eq!(exponent(&[]), None);
    }
}
