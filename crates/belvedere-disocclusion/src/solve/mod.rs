//! The solver: from settings and memory to a terrain stage and its report.

mod adjust;
mod agreement;
mod certificate;
mod entering;
mod fallback;
mod file_to_write;
mod ground;
mod higher_eye;
mod in_picture;
mod lakes;
mod likeness;
mod limits;
mod live;
mod memory;
mod out_of_time;
mod passes;
mod points_in_view;
mod price;
mod report;
mod reporting;
mod runs;
mod sample_grid;
mod shown;
mod trim;
mod waters;
mod written;

pub use certificate::CertifiedLine;
pub use fallback::Fallback;
pub use file_to_write::{FileToWrite, HeightsUnder};
pub use higher_eye::HigherEye;
pub use lakes::{BANK_M, LakeReport};
pub use likeness::{LikenessFigures, LikenessReport};
pub use limits::LimitsReport;
pub use live::{LiveFrame, LiveTerrain};
pub use memory::TerrainMemory;
pub use price::{PricePoint, PriceReport, PricedStretch};
pub use report::{Covered, FeatureCost, QpReport, Taken, TerrainReport, TerrainTimes, UnresolvedReason, UnresolvedRun};
pub use sample_grid::{PlanMap, SampleGrid};
pub use trim::TrimReport;
pub use written::{WrittenGround, WrittenShares};

use super::visibility_qp::{SolvedRow, Unresolved};
use super::{Detail, Field, Hierarchy, SolverMode, TerrainSettings, check_eye};
use crate::DisocclusionError;
use adjust::RequiredPoints;
use belvedere_core::grid::{Grid, GridError};
use belvedere_core::{DVec2, EarthCurvature, SpaceMap, TerrainDisocclusion, View};
use belvedere_scene::Instant;
use belvedere_scene::{Heightfield, Progress, Scene};
use file_to_write::FileJudge;
use memory::{Prepared, Weights};
use passes::Passes;
use points_in_view::PointsInView;
use std::sync::Arc;

/// Share of the time for solving; the rest is for judging.
const SOLVING: f64 = 0.85;

/// Terrain disocclusion as a constructor: the ground of a scene moves so that its required features are seen.
#[derive(Debug, Clone)]
pub struct TerrainSolver {
    settings: TerrainSettings,
    time_step_s: Option<f64>,
    in_plan: bool,
}

/// A solved stage.
#[derive(Debug, Clone)]
pub struct Solved {
    /// The displacement.
    pub stage: TerrainDisocclusion,
    /// Report of what it achieves.
    pub report: TerrainReport,
}

impl TerrainSolver {
    /// A solver for single pictures.
    ///
    /// # Errors
    /// [`DisocclusionError::Setting`] if a parameter is out of range.
    pub fn new(settings: TerrainSettings) -> Result<Self, DisocclusionError> {
        memory::check(&settings)?;
        Ok(Self { settings, time_step_s: None, in_plan: false })
    }

    /// A solver for the frames of a film, `seconds` apart.
    pub fn with_time_step(self, seconds: f64) -> Self {
        Self { time_step_s: Some(seconds).filter(|s| *s > 0.0 && s.is_finite()), ..self }
    }

    /// A solver whose reports also count points above and below the picture, between its left and its right border: for ground that
    /// is written to files and viewed from the same eye with other cameras.
    pub fn in_plan(self) -> Self {
        Self { in_plan: true, ..self }
    }

    fn frame(&self) -> Option<[f64; 2]> {
        self.time_step_s.filter(|_| self.settings.gamma_time_s > 0.0).map(|dt| [dt, self.settings.gamma_time_s])
    }

    /// The parameters.
    pub fn settings(&self) -> &TerrainSettings {
        &self.settings
    }

    /// Solves for the features that must be seen, in the picture of `base`.
    ///
    /// * `base`: the camera with the stages before (earth) and after (spline, curved rays); a terrain stage in it is left out;
    /// * `memory`: that of the frame before, of the same scene; a new one for the first frame;
    ///
    /// # Errors
    /// [`DisocclusionError::NoTerrain`], [`DisocclusionError::NothingToSee`], [`DisocclusionError::Eye`], [`DisocclusionError::Field`],
    /// [`DisocclusionError::Cancelled`]. What cannot be made visible is no error: the report names it.
    pub fn solve(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut TerrainMemory,
        progress: &Progress,
    ) -> Result<Solved, DisocclusionError> {
        self.solve_for_files(scene, base, memory, &[], progress)
    }

    /// As [`TerrainSolver::solve`], where lines of sight over the samples of these files are kept clear too, as far as that is possible.
    ///
    /// # Errors
    /// As [`TerrainSolver::solve`].
    pub fn solve_for_files(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut TerrainMemory,
        files: &[FileToWrite<'_>],
        progress: &Progress,
    ) -> Result<Solved, DisocclusionError> {
        let progress = &progress.begin();
        let files: Vec<FileJudge<'_>> =
            files.iter().map(|file| FileJudge::new(scene, base, *file, &self.settings)).collect();
        let demand = Demand { points: None, files: &files };
        let frame_result = self.run(scene, base, memory, demand, &progress.part(SOLVING))?;
        progress.tick("figures of the displaced terrain", 0.95)?;
        let began = Instant::now();
        let delta = frame_result.delta()?;
        let SolvedFrame { prepared, field, done, times } = frame_result;
        let field: &Field = &field;
        let previous = memory.before(&prepared).map(|u| on_grid(field, &prepared.grid, u)).transpose()?;
        let context = reporting::Context {
            settings: &self.settings,
            field,
            prepared: &prepared,
            in_view: &PointsInView::new(field, &prepared, base, &self.settings, false),
            base,
            in_plan: self.in_plan,
            delta: &delta,
            is_still: self.frame().is_none(),
            previous: previous.as_ref(),
            progress,
        };
        let mut report = reporting::report(&context, &done, times, began)?;
        if done.paid.gave_up_any() && !progress.should_end() {
            let ground = (field, context.prepared);
            report.higher_eye = higher_eye::higher_eye(&self.settings, ground, context.in_view, progress)?;
        }
        memory.keep(prepared, base, done.coarse);
        Ok(Solved { stage: TerrainDisocclusion::new(delta), report })
    }

    /// As [`TerrainSolver::solve`], without the figures, which take longer than the solution; also returns the ground as seen from the eye.
    fn advance(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut TerrainMemory,
        progress: &Progress,
    ) -> Result<(TerrainDisocclusion, Arc<Field>), DisocclusionError> {
        let frame_result = self.run(scene, base, memory, Demand::default(), progress)?;
        let stage = TerrainDisocclusion::new(frame_result.delta()?);
        memory.keep(frame_result.prepared, base, frame_result.done.coarse);
        Ok((stage, frame_result.field))
    }

    /// The passes of one frame, without figures; the memory lends its preparation.
    fn run(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut TerrainMemory,
        asked: Demand<'_>,
        progress: &Progress,
    ) -> Result<SolvedFrame, DisocclusionError> {
        let heightfield = ground(scene).ok_or(DisocclusionError::NoTerrain)?;
        if scene.must_see().next().is_none() {
            return Err(DisocclusionError::NothingToSee { layers: scene.layers.len() });
        }
        let began = Instant::now();
        let progress = &progress.begin();
        progress.tick("cells and points of the terrain", 0.0)?;
        let weights = Weights::new(&self.settings, heightfield, self.frame());
        let mut prepared = memory.prepared_for(scene, heightfield, &self.settings, weights)?;
        let earth = base.earth().copied();
        let field = match &earth {
            Some(earth) => Arc::new(Field::new(&prepared.despiked, |p| drop_at(earth, p))?),
            None => prepared.level.clone(),
        };
        let eye = base.pinhole().eye;
        if let Err(e) = check_eye(&field, eye) {
            *memory = TerrainMemory::holding(prepared);
            return Err(e.into());
        }
        let mut in_view = PointsInView::new(&field, &prepared, base, &self.settings, self.frame().is_some());
        if let Some(asked) = asked.points {
            (in_view.points, in_view.candidates) = (asked.points.clone(), asked.candidates.clone());
        }
        let mut times = TerrainTimes { prepare_ms: since(began), ..TerrainTimes::default() };
        let last = memory.last_for(base, &prepared);
        let passes = Passes {
            settings: &self.settings,
            field: &field,
            lowered: earth.is_some(),
            weights,
            frame: self.frame(),
            eye,
            last: last.as_deref(),
            files: asked.files,
            progress,
        };
        let done = passes.run(&mut prepared, &in_view, &mut times)?;
        drop(in_view);
        Ok(SolvedFrame { prepared, field, done, times })
    }
}

/// What a solution must show besides what its picture does.
#[derive(Default, Clone, Copy)]
struct Demand<'a> {
    /// Points in place of those that the picture shows.
    points: Option<&'a RequiredPoints>,
    files: &'a [FileJudge<'a>],
}

/// The heights that are solved on.
fn ground(scene: &Scene) -> Option<&Arc<Heightfield>> {
    scene.layers.iter().find_map(|l| l.kind.terrain().map(|t| &t.heightfield))
}

/// The solution of one frame, without the figures of its report.
struct SolvedFrame {
    prepared: Prepared,
    /// The ground as the eye sees it.
    field: Arc<Field>,
    done: Outcome,
    times: TerrainTimes,
}

impl SolvedFrame {
    /// The displacement over the scene.
    fn delta(&self) -> Result<Grid, GridError> {
        let Outcome { coarse, full, fine, .. } = &self.done;
        delta_of(&self.field, &self.prepared.grid, (coarse, full.as_deref(), fine.as_ref()))
    }
}

/// Displacements of the nodes of the solver's grid, of every node, and of a finer grid.
type Displaced<'u> = (&'u [f64], Option<&'u [f64]>, Option<&'u (Hierarchy, Vec<f64>)>);

/// The displacement over the scene: at every node if there is that, else on the finer grid if there is one, else on the solver's.
fn delta_of(field: &Field, grid: &Hierarchy, (coarse, full, fine): Displaced<'_>) -> Result<Grid, GridError> {
    match (full, fine) {
        (Some(full), _) => at_every_node(field, full),
        (None, Some((grid, u))) => on_grid(field, grid, u),
        (None, None) => on_grid(field, grid, coarse),
    }
}

fn on_grid(field: &Field, grid: &Hierarchy, u: &[f64]) -> Result<Grid, GridError> {
    spread(field, [grid.cols(), grid.rows()], grid.step(), u)
}

fn at_every_node(field: &Field, values: &[f64]) -> Result<Grid, GridError> {
    spread(field, [field.cols(), field.rows()], DVec2::ONE, values)
}

/// Values at nodes `step` cells apart over the field as a grid of the scene. The rim is repeated one node farther out, so
/// that rounding leaves no point of the ground beside the grid.
fn spread(field: &Field, [cols, rows]: [usize; 2], step: DVec2, values: &[f64]) -> Result<Grid, GridError> {
    let inner = |i: usize, n: usize| i.saturating_sub(1).min(n - 1);
    let padded = (0..(cols + 2) * (rows + 2)).map(|i| {
        let (col, row) = (inner(i % (cols + 2), cols), inner(i / (cols + 2), rows));
        values[row * cols + col]
    });
    let grid = Grid::new(field.scene_from_grid(-step), step * field.spacing(), cols + 2, rows + 2, padded.collect())?;
    Ok(grid.on_facets(field.places()))
}

fn since(began: Instant) -> f64 {
    began.elapsed().as_secs_f64() * 1e3
}

/// Drop of the ground at scene x, y by the curvature of the earth, scene units.
fn drop_at(earth: &EarthCurvature, p: DVec2) -> f64 {
    earth.apply(p.extend(0.0)).map_or(0.0, |q| -q.z)
}

/// Result of the passes.
#[derive(Default)]
struct Outcome {
    /// Displacement at the nodes of the solver's grid.
    coarse: Vec<f64>,
    /// Displacement at every node of the terrain, where that is more than the solver's grid can hold.
    full: Option<Vec<f64>>,
    /// Displacement at the nodes of a finer grid, where the solver's was too coarse.
    fine: Option<(Hierarchy, Vec<f64>)>,
    /// Fallbacks that were used for contradicting rows.
    fallbacks: Vec<Fallback>,
    /// Report of the limits, if they changed the ground.
    limited: Option<LimitsReport>,
    greedy: Option<super::GreedyCounters>,
    greedy_unresolved: Vec<usize>,
    qp: Option<QpReport>,
    qp_unresolved: Vec<Unresolved>,
    /// Whether the program was stopped before it was done.
    stopped: bool,
    /// The ground that was taken in that case.
    taken: Option<Taken>,
    /// Rows of the quadratic program with a multiplier.
    rows: Vec<SolvedRow>,
    /// What was given up for the stated price.
    paid: price::Paid,
}

/// Whether detail is scaled with the ground under it.
fn scales(settings: &TerrainSettings) -> bool {
    settings.detail() == Detail::Scaled && settings.mode != SolverMode::Qp
}
