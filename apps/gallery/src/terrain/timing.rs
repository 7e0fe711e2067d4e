//! Wall times of the solver's steps on a grid with as many cells and points as the paper had.

use super::area::Area;
use crate::chart::{self, Chart, Curve, SeriesLabelPosition, Style};
use crate::sheet::Pixels;
use anyhow::Result;
use belvedere::core::DVec2;
use belvedere::disocclusion::internals::{
    BlockMaxima, Cells, Field, Hierarchy, Naive, ReferencePoint, SmoothPass, Wedge, in_view, reference_points,
    stated_spacing,
};
use belvedere::disocclusion::{SolverMode, TerrainSettings};
use belvedere::scene::{Heightfield, NodeState};
use serde::Serialize;
use std::time::Instant;

/// Points in view, and milliseconds for lines of sight and parameters, of the six examples of Deng et al. 2013.
pub(crate) const PAPER: [(usize, f64); 6] =
    [(195, 2.0), (202, 3.0), (513, 12.0), (560, 14.0), (660, 14.0), (670, 14.0)];
/// Nodes of the paper's elevation models, on either side.
pub(crate) const PAPER_NODES: usize = 1025;
/// The paper's cells and the milliseconds for them.
pub(crate) const PAPER_CELLS: (usize, f64) = (651, 1570.0);
/// The paper's unknowns, and milliseconds of a solution per frame.
pub(crate) const PAPER_SOLVE: (usize, f64) = (16_641, 30.0);
/// Number of runs; times are their medians.
const RUNS: usize = 5;

/// Times of one area, wall milliseconds.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Timing {
    /// Nodes of the terrain's own grid.
    pub(crate) own_nodes: [usize; 2],
    /// Nodes of the grid on which everything is measured.
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
    /// Greedy pass for the numbers of points of the paper; numbers larger than the features allow are left out.
    pub(crate) greedy: Vec<GreedyTime>,
    /// Exponent of the fitted power law of greedy time over points.
    pub(crate) exponent: Option<f64>,
}

/// Lines of sight and parameters of some points.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct GreedyTime {
    pub(crate) points: usize,
    pub(crate) ms: f64,
    pub(crate) paper_ms: f64,
}

/// The ground of an area on the paper's grid.
struct PaperGrid {
    field: Field,
    cells: Cells,
    blocks: BlockMaxima,
}

impl PaperGrid {
    fn new(area: &Area) -> Result<Self> {
        let own = &area.field;
        let last = DVec2::new((own.cols() - 1) as f64, (own.rows() - 1) as f64);
        let step = last / (PAPER_NODES - 1) as f64;
        let node = |i: usize| DVec2::new((i % PAPER_NODES) as f64, (i / PAPER_NODES) as f64) * step;
        let height = |i: usize| own.surface_at(node(i).min(last));
        let heights: Vec<Option<f64>> = (0..PAPER_NODES * PAPER_NODES).map(height).collect();
        let state = |h: &Option<f64>| if h.is_some() { NodeState::Measured } else { NodeState::Void };
        let ground = Heightfield::new(
            own.north_west(),
            own.spacing() * step,
            PAPER_NODES,
            PAPER_NODES,
            heights.iter().map(|h| h.unwrap_or(0.0) as f32).collect(),
            heights.iter().map(state).collect(),
        )?;
        let field = Field::new(&ground, |_| 0.0)?;
        let (cells, blocks) = (Cells::new(&field, PAPER_CELLS.0), BlockMaxima::new(&field));
        Ok(Self { field, cells, blocks })
    }

    /// Reference points in view, `spacing` cells apart.
    fn points(&self, area: &Area, spacing: f64) -> Vec<ReferencePoint> {
        let (points, _) = reference_points(area.session.scene(), &self.field, &area.settings, spacing);
        let wedge = Wedge::of_pinhole(area.view.pinhole());
        let (inside, _) = in_view(&self.field, &points, &wedge, area.settings.guard);
        inside.into_iter().map(|i| points[i]).collect()
    }

    fn summits(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.cells.summits().iter().map(|&i| self.field.node(i as usize))
    }
}

/// Measures an area.
pub(crate) fn timing(area: &Area) -> Result<Timing> {
    let grid = PaperGrid::new(area)?;
    let (field, settings) = (&grid.field, area.in_mode(SolverMode::Paper));
    let cells_ms = median(|| drop(Cells::new(field, PAPER_CELLS.0)));
    let w = settings.smoothness(stated_spacing(field.cols(), field.rows(), field.spacing()));
    let usual = grid.points(area, settings.spacing);
    let began = Instant::now();
    // The paper's unknowns, whatever solver grid the scene sets.
    let hierarchy = Hierarchy::whole(field.cols(), field.rows(), TerrainSettings::default().solver_nodes);
    let unknowns = hierarchy.nodes();
    let rows: Vec<DVec2> = usual.iter().map(|p| p.grid).chain(grid.summits()).collect();
    let mut pass = SmoothPass::new(hierarchy, w, settings.rows_weight, &rows)?;
    let prepare_ms = since(began);
    let greedy_of =
        |points: &[ReferencePoint]| Naive::new(field, &grid.cells, Some(&grid.blocks), &settings, area.eye(), points);
    let naive = greedy_of(&usual).displacement(field, &grid.cells);
    let solve_ms = median(|| drop(pass.run(&naive, None, None)));
    // Close enough for the largest count.
    let spacing = settings.spacing * usual.len() as f64 / 2000.0;
    let many = grid.points(area, spacing.clamp(0.05, settings.spacing));
    let mut greedy = Vec::new();
    for (count, paper_ms) in PAPER {
        let Some(points) = evenly(&many, count) else { continue };
        area.progress.tick("times", greedy.len() as f64 / PAPER.len() as f64)?;
        greedy.push(GreedyTime { points: count, ms: median(|| drop(greedy_of(&points))), paper_ms });
    }
    let exponent = exponent(&greedy);
    let (nodes, cells) = (field.nodes(), grid.cells.len());
    let own_nodes = area.field.nodes();
    Ok(Timing { own_nodes, nodes, cells, cells_ms, unknowns, prepare_ms, solve_ms, greedy, exponent })
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
