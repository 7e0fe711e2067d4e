//! Preparation, once per terrain, and memory between frames.

use super::super::metrics::{amounts, sums};
use super::super::settings::MOST_W;
use super::super::visibility_qp::{Candidate, QpOptions, QpSolver};
use super::super::{
    BlockMaxima, Cells, Field, Hierarchy, KINDS, ReferencePoint, SmoothPass, Smoother, SolverMode, TerrainSettings,
    Unusable, candidate_points, grid_weight, judged_points, reference_points, stated_spacing, temporal_weight,
};
use super::lakes::{self, Water};
use super::limits::LimitedTerrain;
use super::waters::Waters;
use crate::DisocclusionError;
use crate::points::{RequiredFeature, required_features};
use crate::rivers::RiverLine;
use crate::smooth::SmoothError;
use crate::spikes::{Spike, without_spikes};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Heightfield, Scene};
use belvedere_sight::most_prominent;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Memory between frames. The same scene, views and memory give the same result.
///
/// It belongs to one scene; other terrain, features or parameters reset it.
#[derive(Debug, Clone, Default)]
pub struct TerrainMemory {
    prepared: Option<Prepared>,
    last: Option<Last>,
}

/// The frame before.
#[derive(Debug, Clone)]
struct Last {
    eye: DVec3,
    forward: DVec3,
    coarse: Vec<f64>,
}

/// Everything that does not depend on the view.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    settings: TerrainSettings,
    ground: Arc<Heightfield>,
    /// The ground with spikes replaced by the median of their surroundings, on which the solver works.
    pub(super) despiked: Arc<Heightfield>,
    pub(super) spikes: Vec<Spike>,
    /// Nodes of the most prominent summits.
    pub(super) summits: Vec<u32>,
    features: Vec<RequiredFeature>,
    areas_of_water: Vec<Water>,
    river_lines: Vec<RiverLine>,
    pub(super) waters: Arc<Waters>,
    weights: Weights,
    pub(super) level: Arc<Field>,
    pub(super) grid: Hierarchy,
    pub(super) points: Vec<ReferencePoint>,
    pub(super) unusable: Vec<Unusable>,
    /// Candidates of the quadratic program along the features.
    pub(super) dense: Vec<ReferencePoint>,
    /// Points every tenth of a cell, by which the result is judged.
    check: Vec<ReferencePoint>,
    /// Lengths, areas and numbers of what lies beside the ground or in its holes.
    beside: [f64; KINDS],
    /// Limits of the displaced ground.
    pub(super) limited: Option<Arc<LimitedTerrain>>,
    /// Cells and bounds of blocks, in modes with a greedy pass.
    pub(super) cells: Option<Arc<(Cells, BlockMaxima)>>,
    /// The smooth pass, in modes with a greedy pass.
    pub(super) smooth: Option<SmoothPass>,
    /// Quadratic program for frames without a frame before, in modes with such a program, and for rivers.
    pub(super) still: Option<Program>,
    /// Quadratic program that stays near the frame before, in films.
    pub(super) moving: Option<Program>,
}

/// A quadratic program.
#[derive(Debug, Clone)]
pub(super) struct Program {
    pub(super) solver: QpSolver,
    /// Whether it holds other ground than [`Prepared::level`].
    pub(super) foreign: bool,
}

/// Smoothness and temporal weight on the solver's grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Weights {
    /// w.
    pub(super) w: f64,
    /// gamma; 0 for single pictures.
    pub(super) g: f64,
}

impl Weights {
    /// Both for 129 nodes, on the terrain that will be solved on.
    pub(super) fn new(settings: &TerrainSettings, terrain: &Heightfield, frame: Option<[f64; 2]>) -> Self {
        let w = settings.smoothness(stated_spacing(terrain.cols(), terrain.rows(), terrain.spacing()));
        Self { w, g: frame.map_or(0.0, |[dt, time]| temporal_weight(w, dt, time)) }
    }

    fn on(self, grid: &Hierarchy) -> Self {
        let intervals = grid.intervals();
        Self { w: grid_weight(self.w, intervals), g: grid_weight(self.g, intervals) }
    }
}

/// Summits of the terrain by which it is known, at most, their least prominence as a share of the relief, and nodes that they are looked for
/// among.
const SUMMITS: usize = 32;
const SUMMITS_LEAST: f64 = 0.1;
const SUMMITS_AMONG: usize = 100_000;
/// Spacing of the points by which the result is judged, cells.
pub(super) const CHECK_CELLS: f64 = 0.1;
/// The view jumped if the eye moved by more than this share of the terrain's diagonal, or turned by more than this angle.
const JUMP_SHARE: f64 = 0.05;
const JUMP_COS: f64 = 0.939_692_620_785_908_4;

impl TerrainMemory {
    /// A memory that holds preparations alone.
    pub(super) fn holding(prepared: Prepared) -> Self {
        Self { prepared: Some(prepared), last: None }
    }

    /// The preparation in memory if it fits, or a new one.
    pub(super) fn prepared_for(
        &mut self,
        scene: &Scene,
        heightfield: &Arc<Heightfield>,
        settings: &TerrainSettings,
        weights: Weights,
    ) -> Result<Prepared, DisocclusionError> {
        let features = required_features(scene);
        let (areas_of_water, river_lines) = (lakes::waters(scene), RiverLine::of(scene, &settings.rivers)?);
        let fits = |p: &Prepared| {
            p.settings == *settings
                && p.weights == weights
                && p.features == features
                && p.areas_of_water == areas_of_water
                && p.river_lines == river_lines
                && (Arc::ptr_eq(&p.ground, heightfield) || p.ground == *heightfield)
        };
        match self.prepared.take().filter(fits) {
            Some(prepared) => Ok(prepared),
            None => {
                self.last = None;
                Prepared::new(scene, (features, areas_of_water, river_lines), heightfield, settings, weights)
            }
        }
    }

    /// Displacement of the frame before, unless the view has jumped since.
    pub(super) fn last_for(&self, view: &View, prepared: &Prepared) -> Option<Vec<f64>> {
        let field = &prepared.level;
        let size = DVec2::new((field.cols() - 1) as f64, (field.rows() - 1) as f64) * field.spacing();
        let last = self.last.as_ref().filter(|_| prepared.weights.g > 0.0)?;
        let near = last.eye.distance(view.pinhole().eye) <= JUMP_SHARE * size.length();
        let turned = last.forward.dot(view.pinhole().forward) < JUMP_COS;
        (near && !turned).then(|| last.coarse.clone())
    }

    /// Displacement of the frame before on the same grid, whatever happened to the view since.
    pub(super) fn before(&self, prepared: &Prepared) -> Option<&[f64]> {
        self.last.as_ref().map(|last| last.coarse.as_slice()).filter(|u| u.len() == prepared.grid.nodes())
    }

    /// Reference points of the scene, seen or not.
    pub(super) fn points(&self) -> &[ReferencePoint] {
        self.prepared.as_ref().map_or(&[], |prepared| &prepared.points)
    }

    pub(super) fn keep(&mut self, prepared: Prepared, view: &View, coarse: Vec<f64>) {
        self.last = Some(Last { eye: view.pinhole().eye, forward: view.pinhole().forward, coarse });
        self.prepared = Some(prepared);
    }
}

impl Prepared {
    fn new(
        scene: &Scene,
        (features, areas_of_water, river_lines): (Vec<RequiredFeature>, Vec<Water>, Vec<RiverLine>),
        heightfield: &Arc<Heightfield>,
        settings: &TerrainSettings,
        weights: Weights,
    ) -> Result<Self, DisocclusionError> {
        let (despiked, spikes) =
            if settings.spikes { (heightfield.clone(), Vec::new()) } else { without_spikes(heightfield) };
        let level = Field::new(&despiked, |_| 0.0)?;
        let grid = Hierarchy::whole(level.cols(), level.rows(), settings.solver_nodes);
        let (points, unusable) = reference_points(scene, &level, settings, settings.spacing);
        let with_qp = settings.mode != SolverMode::Paper;
        let dense = if with_qp { candidate_points(scene, &level, settings) } else { Vec::new() };
        let (check, beside) = judged_points(&features, &level, settings, CHECK_CELLS);
        let waters = Waters::new(&areas_of_water, &river_lines, heightfield, &level);
        let limited = (with_qp && settings.limits).then(|| Arc::new(LimitedTerrain::new(&despiked, &level, &grid)));
        let cells = (settings.mode != SolverMode::Qp).then(|| {
            let keep = settings.cells.unwrap_or_else(|| Cells::default_count(&level));
            Arc::new((Cells::new(&level, keep), BlockMaxima::new(&level)))
        });
        let smooth = cells.as_ref().map(|parts| smooth_pass(settings, weights.w, &grid, &points, (&level, &parts.0)));
        let made = |weights| {
            program(&level, &grid, weights, options(settings, false), &waters)
                .map(|solver| Program { solver, foreign: false })
        };
        let with_program = with_qp || !waters.rivers.is_empty();
        let still = with_program.then(|| made(Weights { g: 0.0, ..weights })).transpose()?;
        let moving = (with_qp && weights.g > 0.0).then(|| made(weights)).transpose()?;
        Ok(Self {
            settings: settings.clone(),
            ground: heightfield.clone(),
            summits: most_prominent(&despiked, SUMMITS, SUMMITS_LEAST, SUMMITS_AMONG),
            despiked,
            spikes,
            features,
            areas_of_water,
            river_lines,
            waters: Arc::new(waters),
            weights,
            level: Arc::new(level),
            grid,
            points,
            unusable,
            dense,
            check,
            beside,
            limited,
            cells,
            smooth: smooth.transpose()?,
            still,
            moving,
        })
    }

    /// Points every tenth of a grid cell that the picture may show; without `far`, also those too near to the eye to be demanded.
    pub(super) fn dense_in_view(&self, in_view: &super::PointsInView<'_>, far: bool) -> Vec<ReferencePoint> {
        let (inside, near) = in_view.indices(&self.check);
        let near = near.into_iter().filter(|_| !far);
        inside.into_iter().chain(near).map(|i| self.check[i]).collect()
    }

    /// Lengths, areas and numbers of all features, in view or not, on the ground or not.
    pub(super) fn whole(&self) -> [f64; KINDS] {
        sums(amounts(&self.check), self.beside)
    }

    /// The points by which the result is judged as candidates, whose ids follow those of all others.
    pub(super) fn check_in_view(&self, in_view: &super::PointsInView<'_>) -> Vec<Candidate> {
        let first = self.dense.len() + self.points.len();
        let of = |i: usize| Candidate::new((first + i) as u32, self.check[i].grid, self.check[i].lift);
        in_view.indices(&self.check).0.into_iter().map(of).collect()
    }

    /// The point behind the id of a candidate: of the dense points, the reference points, or those by which the result is judged.
    pub(super) fn candidate(&self, id: u32) -> Option<&ReferencePoint> {
        let mut all = self.dense.iter().chain(&self.points).chain(&self.check);
        all.nth(id as usize)
    }

    /// Weights on the solver's grid.
    pub(super) fn weights(&self) -> Weights {
        self.weights.on(&self.grid)
    }
}

/// The smooth pass, with elevation rows at the reference points and at the summits of the cells.
pub(super) fn smooth_pass(
    settings: &TerrainSettings,
    w: f64,
    grid: &Hierarchy,
    points: &[ReferencePoint],
    (field, cells): (&Field, &Cells),
) -> Result<SmoothPass, SmoothError> {
    let summits = cells.summits().iter().map(|&i| field.node(i as usize));
    let rows: Vec<DVec2> = points.iter().map(|p| p.grid).chain(summits).collect();
    SmoothPass::new(grid.clone(), w, settings.rows_weight, &rows)
}

/// Ground is cleared from this distance to a point on, grid cells: ground right before a point hides it too.
const CLEARED_CELLS: f64 = 0.05;

/// Options of the program: with `from_guard` ground is cleared from the guard on, because rows nearer than that contradict others.
pub(super) fn options(settings: &TerrainSettings, from_guard: bool) -> QpOptions {
    let guard = if from_guard { settings.guard } else { settings.guard.min(CLEARED_CELLS) };
    QpOptions { guard, ..QpOptions::of(settings) }
}

/// The quadratic program on a solver's grid, over which lakes stay level and rivers do not run uphill.
pub(super) fn program(
    field: &Field,
    grid: &Hierarchy,
    weights: Weights,
    options: QpOptions,
    waters: &Waters,
) -> Result<QpSolver, DisocclusionError> {
    let Weights { w, g } = weights.on(grid);
    let smoother = Smoother::new(grid.cols(), grid.rows(), w, g)?;
    let mut qp = QpSolver::new(field, grid, smoother, options);
    qp.tie(&waters.lakes.tied(grid));
    qp.know_levels(waters.lakes.levels(grid));
    qp.keep_downhill(&waters.rivers);
    Ok(qp)
}

/// Which points count when only features up to `ahead_m` along their path from the eye do: the plan distance to the feature's
/// point nearest to the eye, and the length along the feature from there.
pub(super) fn ahead(field: &Field, points: &[ReferencePoint], eye: DVec2, ahead_m: Option<f64>) -> Vec<bool> {
    let Some(limit) = ahead_m else { return vec![true; points.len()] };
    let distance = |p: &ReferencePoint| field.scene_from_grid(p.grid).distance(eye);
    let mut nearest: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for p in points {
        let best = nearest.entry((p.layer, p.feature)).or_insert((f64::INFINITY, 0.0));
        if distance(p) < best.0 {
            *best = (distance(p), p.along_m);
        }
    }
    let path = |p: &ReferencePoint| match (p.kind, nearest.get(&(p.layer, p.feature))) {
        (super::super::PointKind::Line, Some((from_eye, along))) => from_eye + (p.along_m - along).abs(),
        _ => distance(p),
    };
    points.iter().map(|p| path(p) <= limit).collect()
}

/// Ranges of the parameters.
pub(super) fn check(settings: &TerrainSettings) -> Result<(), DisocclusionError> {
    let s = settings;
    let ranges = [
        ("cells", s.cells.map_or(1.0, |n| n as f64), [1.0, f64::INFINITY], "at least 1"),
        ("solver_nodes", s.solver_nodes as f64, [2.0, 4097.0], "in 2..=4097"),
        ("spacing", s.spacing, [0.02, 1e4], "in 0.02..=10000 cells"),
        ("candidates", s.candidates, [0.02, 1e4], "in 0.02..=10000 cells"),
        ("guard", s.guard, [0.0, 1e3], "in 0..=1000 cells"),
        ("w", s.w.unwrap_or(1.0), [1e-4, MOST_W], "in 0.0001..=10000"),
        ("eta", s.eta, [0.0, 1e6], "in 0..=1000000"),
        ("mu", s.mu, [0.0, 1e6], "in 0..=1000000"),
        ("mu_dev", s.mu_dev, [0.0, 1e6], "in 0..=1000000"),
        ("rows_weight", s.rows_weight, [0.0, 1e6], "in 0..=1000000"),
        ("lift_m", s.lift_m.unwrap_or(0.0), [0.0, 1e4], "in 0..=10000"),
        ("margin_m", s.margin_m, [0.0, 1e4], "in 0..=10000"),
        ("gamma_time_s", s.gamma_time_s, [0.0, 1e4], "in 0..=10000"),
        ("rise_limit_m", s.rise_limit_m, [0.0, f64::INFINITY], "0 or more"),
        ("show", s.show.unwrap_or(1.0), [0.0, 1.0], "in 0..=1"),
        ("move_at_most_m", s.move_at_most_m.unwrap_or(1.0), [0f64.next_up(), f64::INFINITY], "greater than 0"),
        ("slack_price", s.slack_price.unwrap_or(1.0), [1e-9, 1e9], "in 0.000000001..=1000000000"),
        ("ahead_m", s.ahead_m.unwrap_or(1.0), [0f64.next_up(), f64::INFINITY], "greater than 0"),
    ];
    match ranges.into_iter().find(|(_, value, [low, high], _)| !(low..=high).contains(&value)) {
        Some((key, value, _, range)) => Err(DisocclusionError::Setting { key, value, range }),
        None => Ok(()),
    }
}
