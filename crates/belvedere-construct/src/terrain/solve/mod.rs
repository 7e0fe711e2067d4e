//! Settings and memory to a stage and its report.

mod bent;
mod memory;
mod passes;
mod report;
mod shown;

pub use memory::TerrainMemory;
pub use report::{QpReport, TerrainReport, TerrainTimes, UnresolvedReason, UnresolvedRun};

use super::qp::{Candidate, LinesOfSight, StraightSight, Unresolved, ViewSight};
use super::{Detail, Field, LeftOut, ReferencePoint, SolverMode, TerrainSettings, Wedge, check_eye, in_view};
use crate::ConstructError;
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, EarthCurvature, SpaceMap, Stage, TerrainDisocclusion, View};
use belvedere_scene::{Progress, Scene};
use memory::{Pace, Prepared};
use passes::Passes;
use std::time::Instant;

/// Terrain disocclusion as a constructor: the ground of a scene makes way for what must be seen.
#[derive(Debug, Clone)]
pub struct TerrainSolver {
    settings: TerrainSettings,
    time_step_s: Option<f64>,
}

/// A solved stage.
#[derive(Debug, Clone)]
pub struct Solved {
    /// The displacement.
    pub stage: TerrainDisocclusion,
    /// What it achieves.
    pub report: TerrainReport,
}

impl TerrainSolver {
    /// A solver for single pictures.
    ///
    /// # Errors
    /// [`ConstructError::Setting`] if a parameter is out of range.
    pub fn new(settings: TerrainSettings) -> Result<Self, ConstructError> {
        memory::check(&settings)?;
        Ok(Self { settings, time_step_s: None })
    }

    /// A solver for the frames of a film, `seconds` apart.
    pub fn with_time_step(self, seconds: f64) -> Self {
        Self { time_step_s: Some(seconds).filter(|s| *s > 0.0 && s.is_finite()), ..self }
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
    /// * `memory`: that of the frame before, of the same scene; new where there is none.
    ///
    /// # Errors
    /// [`ConstructError::NoTerrain`], [`ConstructError::NothingToSee`], [`ConstructError::Eye`], [`ConstructError::Terrain`],
    /// [`ConstructError::Cancelled`]. What cannot be made visible is no error: the report names it.
    pub fn solve(
        &self,
        scene: &Scene,
        base: &View,
        memory: &mut TerrainMemory,
        progress: &Progress,
    ) -> Result<Solved, ConstructError> {
        let heightfield = scene.terrain().ok_or(ConstructError::NoTerrain)?;
        if scene.must_see().next().is_none() {
            return Err(ConstructError::NothingToSee { layers: scene.layers.len() });
        }
        let began = Instant::now();
        progress.tick("cells and points of the terrain", 0.0)?;
        let pace = Pace::new(&self.settings, self.frame());
        let mut prepared = memory.prepared_for(scene, heightfield, &self.settings, pace)?;
        let earth = base.stages().iter().find_map(|s| match s {
            Stage::EarthCurvature(earth) => Some(*earth),
            _ => None,
        });
        let fallen = match &earth {
            Some(earth) => Some(Field::new(heightfield, |p| drop_at(earth, p))?),
            None => None,
        };
        let level = prepared.level.clone();
        let field: &Field = fallen.as_ref().unwrap_or(&level);
        let eye = base.pinhole().eye;
        check_eye(field, eye)?;
        let seen = Seen::new(field, &prepared, base, &self.settings);
        let mut times = TerrainTimes { prepare_ms: since(began), ..TerrainTimes::default() };
        let last = memory.last_for(base, &prepared);
        let lowered = fallen.is_some();
        let passes = Passes {
            settings: &self.settings,
            field,
            lowered,
            pace,
            frame: self.frame(),
            eye,
            last: last.as_deref(),
            progress,
        };
        let done = passes.run(&mut prepared, &seen, &mut times)?;
        progress.tick("figures of the displaced terrain", 0.95)?;
        let began = Instant::now();
        let report = report::report(
            &report::Context {
                settings: &self.settings,
                field,
                prepared: &prepared,
                seen: &seen,
                last: last.as_deref(),
            },
            &done,
            times,
            began,
        );
        let (cols, rows, spacing) = match &done.full {
            Some(_) => (field.cols(), field.rows(), field.spacing()),
            None => (prepared.grid.cols(), prepared.grid.rows(), prepared.grid.step() * field.spacing()),
        };
        let values = done.full.clone().unwrap_or_else(|| done.coarse.clone());
        let grid = Grid::new(field.north_west(), spacing, cols, rows, values)?;
        memory.keep(prepared, base, done.coarse);
        Ok(Solved { stage: TerrainDisocclusion::new(grid), report })
    }
}

fn since(began: Instant) -> f64 {
    began.elapsed().as_secs_f64() * 1e3
}

/// How far the ground lies lower at scene x, y because the earth is round.
fn drop_at(earth: &EarthCurvature, p: DVec2) -> f64 {
    earth.apply(p.extend(0.0)).map_or(0.0, |q| -q.z)
}

/// What of the features the picture is asked to show.
struct Seen<'a> {
    field: &'a Field,
    base: &'a View,
    wedge: Wedge,
    guard: f64,
    ahead_m: Option<f64>,
    /// Indices of reference points.
    points: Vec<usize>,
    /// Reference points in view that are too near to the eye.
    too_near: Vec<usize>,
    /// Dense points and, after them, the reference points.
    candidates: Vec<Candidate>,
    sight: Box<dyn LinesOfSight + 'a>,
    /// Whether later stages bend the lines of sight.
    bent: bool,
}

impl<'a> Seen<'a> {
    fn new(field: &'a Field, prepared: &Prepared, base: &'a View, settings: &TerrainSettings) -> Self {
        let bent = base.stages().iter().any(|s| matches!(s, Stage::SplineBend(_) | Stage::CurvedRays(_)));
        let eye = base.pinhole().eye;
        let wedge = if bent { Wedge::all_around(eye.truncate()) } else { Wedge::of_pinhole(base.pinhole()) };
        let sight: Box<dyn LinesOfSight + 'a> = match bent {
            true => Box::new(ViewSight::new(base, field)),
            false => Box::new(StraightSight { eye: field.grid_from_scene(eye.truncate()), z: eye.z }),
        };
        let (guard, ahead_m) = (settings.guard, settings.ahead_m);
        let (points, too_near, candidates) = (Vec::new(), Vec::new(), Vec::new());
        let mut seen = Self { field, base, wedge, guard, ahead_m, points, too_near, candidates, sight, bent };
        (seen.points, seen.too_near) = seen.indices(&prepared.points);
        let offset = prepared.dense.len();
        let candidate = |id: usize, p: &ReferencePoint| Candidate { id: id as u32, grid: p.grid, lift: p.lift };
        let (dense, _) = seen.indices(&prepared.dense);
        let dense = dense.iter().map(|&i| candidate(i, &prepared.dense[i]));
        let points = seen.points.iter().map(|&i| candidate(offset + i, &prepared.points[i]));
        seen.candidates = dense.chain(points).collect();
        seen
    }

    /// Which of the points are asked for, and which would be if they were not too near.
    fn indices(&self, points: &[ReferencePoint]) -> (Vec<usize>, Vec<usize>) {
        let near = memory::ahead(self.field, points, self.wedge.eye, self.ahead_m);
        let in_frame = |p: &ReferencePoint| {
            !self.bent || bent::shows(self.base, self.field.scene_from_grid(p.grid).extend(p.ground + p.lift))
        };
        let (inside, outside) = in_view(self.field, points, &self.wedge, self.guard);
        let inside = inside.into_iter().filter(|&i| near[i] && in_frame(&points[i])).collect();
        let too_near = |&(i, why): &(usize, LeftOut)| (why == LeftOut::TooNear && near[i]).then_some(i);
        (inside, outside.iter().filter_map(too_near).collect())
    }
}

/// What the passes came to.
struct Done {
    /// Displacement at the nodes of the solver's grid.
    coarse: Vec<f64>,
    /// Displacement at every node of the terrain, where detail was scaled.
    full: Option<Vec<f64>>,
    greedy: Option<super::GreedyCounters>,
    greedy_unresolved: Vec<usize>,
    qp: Option<QpReport>,
    qp_unresolved: Vec<Unresolved>,
}

impl Done {
    /// Displacement at every node of the terrain.
    fn fine(&self, prepared: &Prepared) -> Vec<f64> {
        self.full.clone().unwrap_or_else(|| prepared.grid.prolong(&self.coarse))
    }
}

/// Whether detail is scaled with the ground under it.
fn scales(settings: &TerrainSettings) -> bool {
    settings.detail() == Detail::Scaled && settings.mode != SolverMode::Qp
}
