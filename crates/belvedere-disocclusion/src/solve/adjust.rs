//! Viewpoint adjustment for the quadratic program: a small move of the camera reduces the displacement.

use super::super::visibility_qp::Candidate;
use super::super::{
    AdjustedViewpoint, SolverMode, TerrainSettings, ViewpointEnergy, ViewpointOptions, adjust_viewpoint, height_slope,
};
use super::{Demand, PointsInView, TerrainMemory, TerrainSolver};
use crate::DisocclusionError;
use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Stage, View};
use belvedere_scene::{Progress, Scene};

/// Nodes of the solver's grid for the search over the whole box.
const ROUGH_NODES: usize = 33;

/// Points that the picture of the given eye must show; other eyes are judged by the same points, so that none wins by looking away.
#[derive(Debug, Clone)]
pub(super) struct RequiredPoints {
    pub(super) points: Vec<usize>,
    pub(super) candidates: Vec<Candidate>,
}

impl TerrainSolver {
    /// The eye near that of `base` from which the ground must move less to show what `base` shows, see [`adjust_viewpoint`]. The
    /// camera keeps looking at `target`. Energies are those of mode qp along straight lines of sight, whatever the mode and later
    /// stages.
    ///
    /// `None` where the eye of `base` cannot be used.
    ///
    /// # Errors
    /// As [`TerrainSolver::solve`].
    pub fn adjust(
        &self,
        scene: &Scene,
        base: &View,
        target: DVec3,
        options: &ViewpointOptions,
        progress: &Progress,
    ) -> Result<Option<AdjustedViewpoint>, DisocclusionError> {
        // Energies of different eyes are those of the same features.
        let (mode, show) = (SolverMode::Qp, Some(1.0));
        let exact = TerrainSettings { mode, show, move_at_most_m: None, ..self.settings.clone() };
        let rough = TerrainSettings { solver_nodes: ROUGH_NODES, candidates: exact.spacing, ..exact.clone() };
        let mut moves = EyeEnergy {
            scene,
            base,
            target,
            exact: Level::new(exact, scene, base, progress)?,
            rough: Level::new(rough, scene, base, progress)?,
            slope: None,
            cancelled: None,
            progress,
        };
        let ground = |xy: DVec2| scene.terrain().and_then(|t| t.surface_at(xy));
        let found = adjust_viewpoint(base.pinhole().eye, target, &ground, &mut moves, options);
        match moves.cancelled {
            Some(e) => Err(e),
            None => Ok(found),
        }
    }
}

/// Solver on a grid of one resolution.
struct Level {
    solver: TerrainSolver,
    memory: TerrainMemory,
    asked: RequiredPoints,
}

impl Level {
    fn new(
        settings: TerrainSettings,
        scene: &Scene,
        base: &View,
        progress: &Progress,
    ) -> Result<Self, DisocclusionError> {
        let solver = TerrainSolver::new(settings)?;
        let straight = straight(base, base.pinhole().clone())?;
        let frame_result = solver.run(scene, &straight, &mut TerrainMemory::default(), Demand::default(), progress)?;
        let in_view =
            PointsInView::new(&frame_result.field, &frame_result.prepared, &straight, &solver.settings, false);
        let asked = RequiredPoints { points: in_view.points.clone(), candidates: in_view.candidates.clone() };
        drop(in_view);
        Ok(Self { solver, memory: TerrainMemory::holding(frame_result.prepared), asked })
    }

    /// Energy and its slope along the height.
    fn energy(&mut self, scene: &Scene, view: &View, progress: &Progress) -> Result<(f64, f64), DisocclusionError> {
        let demand = Demand { points: Some(&self.asked), files: &[] };
        let frame_result = self.solver.run(scene, view, &mut self.memory, demand, progress)?;
        let rows = frame_result.done.rows.iter().filter(|r| r.candidate.is_some());
        let slope = height_slope(rows.map(|r| (r.multiplier, r.tau)));
        let energy = frame_result.done.qp.map_or(0.0, |qp| qp.energy);
        self.memory = TerrainMemory::holding(frame_result.prepared);
        Ok((energy, slope))
    }
}

/// The view of a pinhole without later stages, the earth falling away from its eye.
fn straight(base: &View, pinhole: Pinhole) -> Result<View, DisocclusionError> {
    let eye = pinhole.eye;
    let earth = base.stages().iter().filter_map(|s| match s {
        Stage::EarthCurvature(earth) => Some(Stage::EarthCurvature(EarthCurvature { eye, ..*earth })),
        _ => None,
    });
    Ok(View::new(pinhole, earth.collect())?)
}

struct EyeEnergy<'a> {
    scene: &'a Scene,
    base: &'a View,
    target: DVec3,
    exact: Level,
    rough: Level,
    slope: Option<f64>,
    cancelled: Option<DisocclusionError>,
    progress: &'a Progress,
}

impl EyeEnergy<'_> {
    fn view(&self, eye: DVec3) -> Option<View> {
        let from = self.base.pinhole();
        let up = -from.down;
        let pinhole = Pinhole::look_at(eye, self.target, up, from.projection, from.image, from.near, from.far).ok()?;
        straight(self.base, pinhole).ok()
    }

    fn ask(&mut self, eye: DVec3, exact: bool) -> Option<(f64, f64)> {
        let view = self.view(eye)?;
        let level = if exact { &mut self.exact } else { &mut self.rough };
        match level.energy(self.scene, &view, &self.progress.unheard()) {
            Ok(found) => Some(found),
            Err(e) => {
                if matches!(e, DisocclusionError::Cancelled(_)) {
                    self.cancelled = Some(e);
                }
                None
            }
        }
    }
}

impl ViewpointEnergy for EyeEnergy<'_> {
    fn coarse(&mut self, eye: DVec3) -> Option<f64> {
        self.ask(eye, false).map(|(energy, _)| energy)
    }

    fn energy(&mut self, eye: DVec3) -> Option<f64> {
        let (energy, slope) = self.ask(eye, true)?;
        self.slope = Some(slope);
        Some(energy)
    }

    fn slope(&mut self) -> Option<f64> {
        self.slope
    }
}
