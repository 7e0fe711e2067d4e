//! A mountain area of the figures: a scene, its camera, and the solver's data that are prepared once.

use anyhow::{Context, Result};
use belvedere::core::grid::Grid;
use belvedere::core::{DVec3, Pinhole, Stage, TerrainDisocclusion, View};
use belvedere::cpu::CpuRenderer;
use belvedere::disocclusion::internals::{
    BlockMaxima, Cells, Field, Naive, ReferencePoint, Wedge, in_view, reference_points,
};
use belvedere::disocclusion::{Solved, SolverMode, TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere::scene::{Frame, Progress, RenderJob, RenderOptions, Renderer, Scene};
use belvedere::{OpenOptions, Session};
use std::path::{Path, PathBuf};

/// Size of a picture of a sheet, pixels.
pub(crate) const TILE: [u32; 2] = [640, 360];

/// An area with everything that is computed before solving.
pub(crate) struct Area {
    /// Start of the names of its files.
    pub(crate) name: String,
    pub(crate) session: Session,
    /// The camera, without any bend.
    pub(crate) view: View,
    /// Parameters of the scene's stage, else the usual ones.
    pub(crate) settings: TerrainSettings,
    pub(crate) field: Field,
    pub(crate) cells: Cells,
    pub(crate) blocks: BlockMaxima,
    /// Reference points in view.
    pub(crate) points: Vec<ReferencePoint>,
    pub(crate) progress: Progress,
}

impl Area {
    /// Opens a scene; of its stages only the parameters of terrain disocclusion count.
    pub(crate) fn open(path: &Path, text: Option<&str>, options: &OpenOptions) -> Result<Self> {
        let options = OpenOptions { unsolved: true, ..options.clone() };
        let session = match text {
            Some(text) => Session::from_text(path, text, &options)?,
            None => Session::open(path, &options)?,
        };
        // Unresolved settings: the resolved document holds defaults of its own mode, and other modes have others.
        let settings = session.terrain_settings()?;
        let terrain = session.scene().terrain().context("the scene has no terrain; add a layer of kind \"terrain\"")?;
        let field = Field::new(terrain, |_| 0.0)?;
        let cells = Cells::new(&field, settings.cells.unwrap_or_else(|| Cells::default_count(&field)));
        let view = View::straight(session.view().pinhole().clone());
        let name = path.file_stem().map_or_else(|| "area".into(), |s| s.to_string_lossy().into_owned());
        let blocks = BlockMaxima::new(&field);
        let points = in_frame(session.scene(), &field, &settings, view.pinhole());
        let progress = options.progress.clone();
        Ok(Self { name, session, view, settings, field, cells, blocks, points, progress })
    }

    /// The settings of the area in another mode.
    pub(crate) fn in_mode(&self, mode: SolverMode) -> TerrainSettings {
        TerrainSettings { mode, ..self.settings.clone() }
    }

    /// Solves for a still from the camera, or from another eye with the same direction of view.
    pub(crate) fn solve(&self, settings: &TerrainSettings, view: &View) -> Result<Solved> {
        let solver = TerrainSolver::new(settings.clone())?;
        Ok(solver.solve(self.session.scene(), view, &mut TerrainMemory::default(), &self.progress)?)
    }

    /// The greedy pass alone, on the points in view.
    pub(crate) fn naive(&self, settings: &TerrainSettings) -> Naive {
        Naive::new(&self.field, &self.cells, Some(&self.blocks), settings, self.eye(), &self.points)
    }

    /// The ground as the greedy pass leaves it.
    pub(crate) fn naive_stage(&self, naive: &Naive) -> Result<TerrainDisocclusion> {
        let f = &self.field;
        let values = naive.displacement(f, &self.cells);
        let grid = Grid::new(f.north_west(), f.spacing(), f.cols(), f.rows(), values)?;
        Ok(TerrainDisocclusion::new(grid))
    }

    pub(crate) fn eye(&self) -> DVec3 {
        self.view.pinhole().eye
    }

    /// Draws the scene, or another version of it, with the ground displaced.
    pub(crate) fn draw(&self, scene: &Scene, stage: Option<&TerrainDisocclusion>, size: [u32; 2]) -> Result<Frame> {
        let pinhole = Pinhole { image: size, ..self.view.pinhole().clone() };
        let stages = stage.map(|s| Stage::TerrainDisocclusion(s.clone())).into_iter().collect();
        let view = View::new(pinhole, stages)?;
        let options = RenderOptions::default();
        let (light, progress) = (self.session.light(), &self.progress);
        Ok(CpuRenderer::default().render(&RenderJob { scene, view: &view, light, options: &options, progress })?)
    }
}

/// Path of a picture of an area.
pub(crate) fn picture(folder: &Path, name: &str, what: &str) -> PathBuf {
    folder.join(format!("{name}_{what}.png"))
}

/// Reference points of a picture.
fn in_frame(scene: &Scene, field: &Field, settings: &TerrainSettings, camera: &Pinhole) -> Vec<ReferencePoint> {
    let (points, _) = reference_points(scene, field, settings, settings.spacing);
    let (inside, _) = in_view(field, &points, &Wedge::of_pinhole(camera), settings.guard);
    inside.into_iter().map(|i| points[i]).collect()
}
