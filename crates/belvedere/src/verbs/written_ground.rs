//! What a written elevation model shows: judged on its own samples, in its own coordinate system.

use super::level_lakes::LevelLakes;
use super::written_rivers::run_downhill;
use crate::BelvedereError;
use crate::request::WrittenGrid;
use belvedere_core::{DVec2, TerrainDisocclusion, View};
use belvedere_disocclusion::report::{LakeReport, RiverReport};
use belvedere_disocclusion::{
    FileToWrite, Solved, TerrainMemory, TerrainReport, TerrainSolver, WrittenGround, WrittenShares,
};
use belvedere_io::IoError;
use belvedere_io::raster::Raster;
use belvedere_io::terrain::{OriginalTerrain, moved_terrain};
use belvedere_scene::{Crs, Heightfield, Progress, Scene};

type Map<'a> = Box<dyn Fn(DVec2) -> Option<DVec2> + Sync + 'a>;

/// Bytes of a sample while it is judged: its height twice, whether it has one, and the rasters that hold it.
const SAMPLE_BYTES: u64 = 25;

/// The grid of the written heights.
pub(super) struct FileGrid<'a> {
    index_from_scene: Map<'a>,
    scene_from_index: Map<'a>,
    /// Whether its samples are those that were solved on.
    pub(super) solved_on: bool,
}

/// What written heights show.
pub(super) struct JudgedFile {
    /// Before the move, and after it.
    pub(super) before: WrittenShares,
    pub(super) after: WrittenShares,
    /// After it, where a program cuts cells from north-east to south-west. A bilinear surface lies between the two.
    pub(super) other_diagonal: WrittenShares,
}

/// The heights that will be written, for any displacement.
pub(super) struct HeightsToWrite<'a> {
    pub(super) original: &'a OriginalTerrain,
    pub(super) scene: &'a Scene,
    pub(super) grid: WrittenGrid,
    pub(super) fill_voids: bool,
    /// Layers of rivers.
    pub(super) rivers: &'a [String],
}

/// Heights and the displacement in them, as they are written.
pub(super) struct ToWrite {
    pub(super) rasters: [Raster; 2],
    /// Reports of rivers, where the samples are not those that were solved on.
    pub(super) rivers: Vec<RiverReport>,
}

impl<'a> HeightsToWrite<'a> {
    /// The grid of the scene, if that is what is written.
    fn terrain(&self) -> Option<&'a Heightfield> {
        self.scene.terrain().filter(|_| self.grid == WrittenGrid::Scene)
    }

    /// Whether the samples are others than those that are solved on.
    fn is_resampled(&self) -> bool {
        self.grid == WrittenGrid::Input && self.scene.terrain().is_some_and(|terrain| !self.original.is_grid_of(terrain))
    }

    /// The grid of what is written.
    ///
    /// # Errors
    /// As [`FileGrid::of_file`].
    pub(super) fn grid(&self) -> Result<FileGrid<'a>, BelvedereError> {
        match self.terrain() {
            Some(terrain) => Ok(FileGrid::of_terrain(terrain)),
            None => FileGrid::of_file(self.original, self.scene.crs, !self.is_resampled()),
        }
    }

    /// The heights under a displacement, and the displacement.
    ///
    /// # Errors
    /// [`IoError`] if the file's coordinate system cannot be joined with that of the scene; [`DisocclusionError`] of rivers.
    pub(super) fn under(&self, stage: &TerrainDisocclusion, lakes: &[LakeReport]) -> Result<ToWrite, BelvedereError> {
        let lakes = LevelLakes::new(stage, lakes, self.scene);
        let delta = |p: DVec2| lakes.at(p);
        if let Some(terrain) = self.terrain() {
            return Ok(ToWrite { rasters: moved_terrain(terrain, self.scene.crs, delta), rivers: Vec::new() });
        }
        let surface = |p: DVec2| self.scene.terrain().filter(|_| self.fill_voids)?.surface_at(p);
        let mut rasters = self.original.moved_and_filled(self.scene.crs, delta, surface)?;
        let rivers = match self.is_resampled() {
            true => run_downhill(&mut rasters, self.original, (self.scene, self.rivers), &lakes)?,
            false => Vec::new(),
        };
        Ok(ToWrite { rasters, rivers })
    }

    /// The solution that keeps lines of sight over the samples of the file clear too.
    ///
    /// # Errors
    /// As [`TerrainSolver::solve`]; [`BelvedereError::Memory`].
    pub(super) fn solved(
        &self,
        solver: &TerrainSolver,
        view: &View,
        progress: &Progress,
    ) -> Result<Solved, BelvedereError> {
        let mut memory = TerrainMemory::default();
        if !self.is_resampled() {
            return Ok(solver.solve(self.scene, view, &mut memory, progress)?);
        }
        let nodes = self.original.size();
        ask(nodes)?;
        let grid = self.grid()?;
        let heights = |stage: &TerrainDisocclusion, lakes: &[LakeReport]| {
            let [heights, _] = self.under(stage, lakes).ok()?.rasters;
            Some((0..nodes[0] * nodes[1]).map(|i| sample(&heights, i).unwrap_or(f64::NAN)).collect())
        };
        let file = FileToWrite {
            nodes,
            spacing: grid.spacing(nodes),
            index_from_scene: &grid.index_from_scene,
            scene_from_index: &grid.scene_from_index,
            heights: &heights,
        };
        Ok(solver.solve_for_files(self.scene, view, &mut memory, &[file], progress)?)
    }
}

/// Asks for the memory that judging takes.
fn ask([cols, rows]: [usize; 2]) -> Result<(), BelvedereError> {
    belvedere_io::budget::ask("judging the written heights", cols as u64 * rows as u64 * SAMPLE_BYTES)
        .map_err(BelvedereError::Memory)
}

/// A sample of a raster by its index.
fn sample(raster: &Raster, i: usize) -> Option<f64> {
    raster.sample_f64(0, i % raster.info.width, i / raster.info.width)
}

impl<'a> FileGrid<'a> {
    /// The grid that was solved on.
    fn of_terrain(terrain: &'a Heightfield) -> Self {
        let (first, step) = (terrain.north_west(), terrain.spacing() * DVec2::new(1.0, -1.0));
        Self {
            index_from_scene: Box::new(|p| Some(terrain.grid_from_scene(p))),
            scene_from_index: Box::new(move |index| Some(first + index * step)),
            solved_on: true,
        }
    }

    /// The grid of a file.
    ///
    /// # Errors
    /// [`IoError`] if the file's coordinate system cannot be joined with that of the scene.
    fn of_file(file: &'a OriginalTerrain, scene: Crs, solved_on: bool) -> Result<Self, BelvedereError> {
        let (Some(to), Some(from)) = (file.index_from_scene(scene), file.scene_from_index(scene)) else {
            let reason =
                format!("its coordinate system {} cannot be joined with that of the scene", file.system_name());
            return Err(IoError::format(file.path(), reason).into());
        };
        Ok(Self { index_from_scene: Box::new(to), scene_from_index: Box::new(from), solved_on })
    }

    /// Judges the heights before and after the move, and after it with the other diagonals.
    ///
    /// * `rasters`: heights, and the displacement contained in them.
    ///
    /// # Errors
    /// [`BelvedereError::Memory`]; those of [`TerrainSolver::judge_written`].
    pub(super) fn judged(
        &self,
        solver: &TerrainSolver,
        (scene, view): (&Scene, &View),
        [heights, displacement]: &[Raster; 2],
        report: &TerrainReport,
        progress: &Progress,
    ) -> Result<JudgedFile, BelvedereError> {
        let nodes = [heights.info.width, heights.info.height];
        ask(nodes)?;
        let after = |i: usize| sample(heights, i);
        let before = |i: usize| Some(after(i)? - sample(displacement, i)?);
        let judged = |height: &(dyn Fn(usize) -> Option<f64> + Sync),
                      [index_from_scene, scene_from_index]: [&Map<'_>; 2]| {
            let (spacing, solved_on) = (self.spacing(nodes), self.solved_on);
            let ground = WrittenGround { nodes, spacing, height, index_from_scene, scene_from_index, solved_on };
            solver.judge_written(scene, view, &ground, report, progress)
        };
        let maps = [&self.index_from_scene, &self.scene_from_index];
        // From east to west the same cells have the other diagonal.
        let last = (nodes[0] - 1) as f64;
        let turned = |index: DVec2| DVec2::new(last - index.x, index.y);
        let to: Map<'_> = Box::new(|p| (self.index_from_scene)(p).map(turned));
        let from: Map<'_> = Box::new(|index| (self.scene_from_index)(turned(index)));
        let mirrored = |i: usize| after(i / nodes[0] * nodes[0] + nodes[0] - 1 - i % nodes[0]);
        Ok(JudgedFile {
            before: judged(&before, maps)?,
            after: judged(&after, maps)?,
            other_diagonal: judged(&mirrored, [&to, &from])?,
        })
    }

    /// Distance between columns and between rows in the middle of the grid, scene units.
    fn spacing(&self, nodes: [usize; 2]) -> DVec2 {
        let middle = 0.5 * DVec2::new((nodes[0] - 1) as f64, (nodes[1] - 1) as f64);
        let length = |step: DVec2| {
            let [a, b] = [-0.5, 0.5].map(|side| (self.scene_from_index)(middle + side * step));
            a.zip(b).map(|(a, b)| a.distance(b)).filter(|d| *d > 0.0).unwrap_or(1.0)
        };
        DVec2::new(length(DVec2::X), length(DVec2::Y))
    }
}
