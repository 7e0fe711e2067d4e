//! What a written elevation model shows: judged on its own samples, in its own coordinate system.

use crate::BelvedereError;
use belvedere_core::{DVec2, View};
use belvedere_disocclusion::{TerrainReport, TerrainSolver, WrittenGround, WrittenShares};
use belvedere_io::IoError;
use belvedere_io::raster::Raster;
use belvedere_io::terrain::OriginalTerrain;
use belvedere_scene::{Crs, Heightfield, Progress, Scene};

type Map<'a> = Box<dyn Fn(DVec2) -> Option<DVec2> + Sync + 'a>;

/// Bytes of a sample while it is judged: its height, and whether it has one.
const SAMPLE_BYTES: u64 = 9;

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

impl<'a> FileGrid<'a> {
    /// The grid that was solved on.
    pub(super) fn of_terrain(terrain: &'a Heightfield) -> Self {
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
    pub(super) fn of_file(file: &'a OriginalTerrain, scene: Crs, solved_on: bool) -> Result<Self, BelvedereError> {
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
        let samples = nodes[0] as u64 * nodes[1] as u64;
        belvedere_io::budget::ask("judging the written heights", samples * SAMPLE_BYTES)
            .map_err(BelvedereError::Memory)?;
        let value = |raster: &Raster, i: usize| raster.sample_f64(0, i % nodes[0], i / nodes[0]);
        let after = |i: usize| value(heights, i);
        let before = |i: usize| Some(after(i)? - value(displacement, i)?);
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
