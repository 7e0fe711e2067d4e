//! What a written elevation model shows: judged on its own samples, in its own coordinate system.

use super::level_lakes::LevelLakes;
use super::written_rivers::run_downhill;
use crate::BelvedereError;
use crate::request::{Robust, WrittenGrid};
use belvedere_core::{DVec2, TerrainDisocclusion, View};
use belvedere_disocclusion::report::{CertifiedLine, LakeReport, RiverReport, TrimReport};
use belvedere_disocclusion::{
    FileToWrite, SampleGrid, Solved, SolverMode, TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver,
    WrittenGround, WrittenShares,
};
use belvedere_io::IoError;
use belvedere_io::raster::{Raster, Samples};
use belvedere_io::terrain::{OriginalTerrain, moved_terrain};
use belvedere_scene::{Crs, Heightfield, Progress, Scene};

type Map<'a> = Box<dyn Fn(DVec2) -> Option<DVec2> + Sync + 'a>;

/// Most that showing all to programs that cut cells otherwise may cost unless that is asked for, as a multiple of the displacement
/// without it.
const ROBUST_AT_MOST: f64 = 1.3;
/// Heights within this of the sea's are sea, metres.
const SEA_M: f64 = 0.01;
/// Bytes of a sample while it is judged: its height twice, whether it has one, and the rasters that hold it.
const SAMPLE_BYTES: u64 = 25;

/// The grid of the written heights.
pub(super) struct FileGrid<'a> {
    nodes: [usize; 2],
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
    pub(super) robust: Robust,
    /// Height of the sea, metres, which stays where it is.
    pub(super) sea_m: Option<f64>,
}

/// Heights and the displacement in them, as they are written.
pub(super) struct ToWrite {
    pub(super) rasters: [Raster; 2],
    /// Reports of rivers, where the samples are not those that were solved on.
    pub(super) rivers: Vec<RiverReport>,
}

impl<'a> HeightsToWrite<'a> {
    /// Those that were written on a grid.
    pub(super) fn as_written(original: &'a OriginalTerrain, scene: &'a Scene, grid: WrittenGrid) -> Self {
        Self { original, scene, grid, fill_voids: false, rivers: &[], robust: Robust::Never, sea_m: None }
    }

    /// The grid of the scene, if that is what is written.
    fn terrain(&self) -> Option<&'a Heightfield> {
        self.scene.terrain().filter(|_| self.grid == WrittenGrid::Scene)
    }

    /// Whether the samples are others than those that are solved on.
    fn is_resampled(&self) -> bool {
        self.grid == WrittenGrid::Input
            && self.scene.terrain().is_some_and(|terrain| !self.original.is_grid_of(terrain))
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
        let by = |p: DVec2, height: f64| over_sea(self.sea_m, height, delta(p));
        let surface = |p: DVec2| self.scene.terrain().filter(|_| self.fill_voids)?.surface_at(p);
        let mut rasters = self.original.moved_and_filled(self.scene.crs, by, surface)?;
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
        let grid = self.grid()?;
        let count = grid.nodes[0] * grid.nodes[1];
        let heights = |stage: &TerrainDisocclusion, lakes: &[LakeReport]| {
            let [heights, _] = self.under(stage, lakes).ok()?.rasters;
            Some((0..count).map(|i| sample(&heights, i).unwrap_or(f64::NAN)).collect())
        };
        let file = |grid, at_most| FileToWrite { grid, heights: &heights, at_most };
        let (own, other) = (grid.samples(), grid.samples().cut_otherwise());
        let mut files = Vec::new();
        files.extend((!grid.solved_on).then(|| file(own, None)));
        files.extend(match self.robust {
            Robust::Auto => Some(file(other, Some(ROBUST_AT_MOST))),
            Robust::Always => Some(file(other, None)),
            Robust::Never => None,
        });
        if !files.is_empty() {
            ask(grid.nodes)?;
        }
        Ok(solver.solve_for_files(self.scene, view, &mut memory, &files, progress)?)
    }

    /// The heights under a solution, trimmed where small bumps hide something, and how they were trimmed.
    ///
    /// # Errors
    /// As [`Self::under`] and [`TerrainSolver::trimmed`].
    pub(super) fn trimmed(
        &self,
        solver: &TerrainSolver,
        view: &View,
        solved: &mut Solved,
        progress: &Progress,
    ) -> Result<(ToWrite, Option<TrimReport>), BelvedereError> {
        let mut out = self.under(&solved.stage, &solved.report.lakes)?;
        let grid = self.grid()?;
        let TerrainSettings { mode, slack_price, move_at_most_m, .. } = *solver.settings();
        // Rivers on the solved ground would run into what is trimmed; elsewhere they are settled afterwards.
        let has_rivers = grid.solved_on && !self.rivers.is_empty();
        // Where time is up nothing is promised.
        let is_late = solved.report.out_of_time;
        if mode == SolverMode::Paper || slack_price.is_some() || has_rivers || is_late {
            return Ok((out, None));
        }
        let mut grids = vec![grid.samples()];
        grids.extend((self.robust != Robust::Never).then(|| grid.samples().cut_otherwise()));
        let stage = solved.stage.clone();
        let lakes = LevelLakes::new(&stage, &solved.report.lakes, self.scene);
        let place = |i: usize| DVec2::new((i % grid.nodes[0]) as f64, (i / grid.nodes[0]) as f64);
        let is_water = |i: usize| (grid.scene_from_index)(place(i)).is_some_and(|p| lakes.lake_at(p).is_some());
        let most = grids[0].most_trimmed();
        let is_deep =
            |i: usize| move_at_most_m.zip(sample(&out.rasters[1], i)).is_some_and(|(at_most, d)| most - d > at_most);
        // No sample is trimmed to below the sea.
        let is_low = |i: usize| self.sea_m.zip(sample(&out.rasters[0], i)).is_some_and(|(sea, h)| h <= sea + most);
        let is_fixed = |i: usize| is_deep(i) || is_water(i) || is_low(i);
        let height = |i: usize| sample(&out.rasters[0], i);
        let lowered = solver.trimmed((self.scene, view), &grids, &height, &is_fixed, &solved.report, progress)?;
        if lowered.is_empty() {
            return Ok((out, None));
        }
        let report = TrimReport { samples: lowered.len(), most_m: lowered.values().copied().fold(0.0, f64::max) };
        for raster in &mut out.rasters {
            if let Samples::F32(values) = &mut raster.samples {
                lowered.iter().for_each(|(i, by)| values[*i] -= *by as f32);
            }
        }
        if grid.solved_on {
            solved.lower(self.scene, &lowered)?;
        } else {
            let rivers = (self.scene, self.rivers);
            out.rivers = run_downhill(&mut out.rasters, self.original, rivers, &lakes)?;
        }
        Ok((out, Some(report)))
    }
}

/// The displacement of a sample under which the sea stays and land does not sink below it.
fn over_sea(sea_m: Option<f64>, height: f64, by: f64) -> f64 {
    match sea_m {
        Some(sea) if (height - sea).abs() <= SEA_M => 0.0,
        Some(sea) if height > sea => by.max(sea - height),
        _ => by,
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
            nodes: [terrain.cols(), terrain.rows()],
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
        Ok(Self { nodes: file.size(), index_from_scene: Box::new(to), scene_from_index: Box::new(from), solved_on })
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
        ask(self.nodes)?;
        let after = |i: usize| sample(heights, i);
        let before = |i: usize| Some(after(i)? - sample(displacement, i)?);
        let judged = |height: &(dyn Fn(usize) -> Option<f64> + Sync), grid: SampleGrid<'_>| {
            let ground = WrittenGround { grid, height, solved_on: self.solved_on };
            solver.judge_written(scene, view, &ground, report, progress)
        };
        let grid = self.samples();
        Ok(JudgedFile {
            before: judged(&before, grid)?,
            after: judged(&after, grid)?,
            other_diagonal: judged(&after, grid.cut_otherwise())?,
        })
    }

    /// Columns and rows.
    pub(super) fn nodes(&self) -> [usize; 2] {
        self.nodes
    }

    /// Lines of sight over written heights, see [`TerrainSolver::lines_over_file`].
    ///
    /// # Errors
    /// As [`TerrainSolver::lines_over_file`].
    pub(super) fn lines(
        &self,
        seen_by: (&Scene, &View),
        solver: &TerrainSolver,
        heights: &Raster,
        most: usize,
    ) -> Result<Vec<CertifiedLine>, BelvedereError> {
        let height = |i: usize| sample(heights, i);
        let ground = WrittenGround { grid: self.samples(), height: &height, solved_on: self.solved_on };
        Ok(solver.lines_over_file(seen_by, &ground, most)?)
    }

    /// Its samples, with the cells cut as the program draws them.
    fn samples(&self) -> SampleGrid<'_> {
        SampleGrid {
            nodes: self.nodes,
            spacing: self.spacing(),
            index_from_scene: &self.index_from_scene,
            scene_from_index: &self.scene_from_index,
            other_diagonal: false,
        }
    }

    /// Distance between columns and between rows in the middle of the grid, scene units.
    fn spacing(&self) -> DVec2 {
        let middle = 0.5 * DVec2::new((self.nodes[0] - 1) as f64, (self.nodes[1] - 1) as f64);
        let length = |step: DVec2| {
            let [a, b] = [-0.5, 0.5].map(|side| (self.scene_from_index)(middle + side * step));
            a.zip(b).map(|(a, b)| a.distance(b)).filter(|d| *d > 0.0).unwrap_or(1.0)
        };
        DVec2::new(length(DVec2::X), length(DVec2::Y))
    }
}
