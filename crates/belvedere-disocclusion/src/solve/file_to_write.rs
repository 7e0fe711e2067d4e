//! Files to which a displacement will be written: the program keeps lines of sight over their samples clear as well.

use super::super::metrics::Judge;
use super::super::points::{RequiredFeature, judged_points, required_features};
use super::super::{Field, Hierarchy, ReferencePoint, TerrainSettings};
use super::LakeReport;
use super::memory::CHECK_CELLS;
use super::sample_grid::SampleGrid;
use super::written::{SightOverFile, WrittenGround};
use crate::DisocclusionError;
use belvedere_core::{DVec2, TerrainDisocclusion, View};
use belvedere_scene::{Progress, Scene};
use std::sync::OnceLock;

/// Heights of the samples of a file under a displacement.
pub type HeightsUnder<'a> = &'a (dyn Fn(&TerrainDisocclusion, &[LakeReport]) -> Option<Vec<f64>> + Sync);

/// A file to which the displaced heights will be written.
#[derive(Clone, Copy)]
pub struct FileToWrite<'a> {
    /// Its samples.
    pub grid: SampleGrid<'a>,
    /// Heights of the samples (row-major), scene units, NaN without data, under a displacement with these lakes; `None` ends the search.
    pub heights: HeightsUnder<'a>,
    /// Most that keeping it clear may cost, as a multiple of the root mean square displacement without it; `None` = whatever it costs.
    pub at_most: Option<f64>,
}

/// A point that a file hides.
pub(super) struct HiddenInFile {
    /// Grid coordinates on the solved ground, of the point and of the ground that hides it most.
    pub(super) point: DVec2,
    pub(super) at: DVec2,
    /// Share of the way from the point to the eye at which that ground lies.
    pub(super) tau: f64,
    /// Height by which it rises over the line of sight, scene units.
    pub(super) over: f64,
}

/// The judge of a file that is not written yet.
pub(super) struct FileJudge<'a> {
    file: FileToWrite<'a>,
    view: &'a View,
    settings: &'a TerrainSettings,
    features: Vec<RequiredFeature>,
    /// In view, in grid coordinates of the file.
    points: OnceLock<Vec<ReferencePoint>>,
}

impl<'a> FileJudge<'a> {
    pub(super) fn new(scene: &Scene, view: &'a View, file: FileToWrite<'a>, settings: &'a TerrainSettings) -> Self {
        Self { file, view, settings, features: required_features(scene), points: OnceLock::new() }
    }

    /// See [`FileToWrite::at_most`].
    pub(super) fn at_most(&self) -> Option<f64> {
        self.file.at_most
    }

    /// The points that the file hides under a displacement.
    ///
    /// * `field`, `solver`: the ground that is solved on, and the solver's grid over it; `is_asked`: whether a point (grid coordinates of that ground) must be seen.
    pub(super) fn hidden(
        &self,
        (field, solver): (&Field, &Hierarchy),
        (stage, lakes): (&TerrainDisocclusion, &[LakeReport]),
        is_asked: &(dyn Fn(&ReferencePoint) -> bool + Sync),
        progress: &Progress,
    ) -> Result<Vec<HiddenInFile>, DisocclusionError> {
        progress.tick("what the heights to be written hide", 0.9)?;
        let FileToWrite { grid, heights, .. } = self.file;
        let Some(heights) = heights(stage, lakes) else { return Ok(Vec::new()) };
        let height = |i: usize| heights.get(i).copied().filter(|h| h.is_finite());
        let ground = WrittenGround { grid, height: &height, solved_on: false };
        let own = ground.field(self.view)?;
        let sight = SightOverFile::new(grid, self.view);
        let points = self.points.get_or_init(|| {
            let features: Vec<_> = self.features.iter().map(|f| f.mapped(&|line| grid.image_of(&own, line))).collect();
            let (all, _) = judged_points(&features, &own, self.settings, CHECK_CELLS);
            sight.in_view(&own, &all, self.view, self.settings)
        });
        let places: Vec<(DVec2, f64)> = points.iter().map(|p| (p.grid, p.lift)).collect();
        let found = |(p, (at, over)): (&ReferencePoint, (DVec2, f64))| {
            let [of_point, of_ground] = [p.grid, at].map(|index| grid.scene(index));
            let tau = sight.share_of_way(p.grid, at);
            let [point, at] = [of_point?, of_ground?].map(|p| field.grid_from_scene(p));
            // Such bumps are trimmed, for the solver's grid cannot hold them.
            let is_bump = over <= grid.most_trimmed() && (at - point).abs().cmplt(solver.step()).all();
            let asked = !is_bump && is_asked(&ReferencePoint { grid: point, ..*p });
            asked.then_some(HiddenInFile { point, at, tau, over })
        };
        let hiding = Judge::still(&own, &sight)
            .hiding(&places, self.settings.guard * (field.spacing() / grid.spacing).max_element());
        Ok(points.iter().zip(hiding).filter_map(|(p, hides)| found((p, hides?))).collect())
    }
}
