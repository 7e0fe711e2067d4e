//! Files to which a displacement will be written: the program keeps lines of sight over their samples clear as well.

use super::super::metrics::Judge;
use super::super::points::{RequiredFeature, judged_points, required_features};
use super::super::{Field, ReferencePoint, TerrainSettings};
use super::memory::CHECK_CELLS;
use super::written::{PlanMap, SightOverFile, WrittenGround};
use super::LakeReport;
use crate::DisocclusionError;
use belvedere_core::{DVec2, TerrainDisocclusion, View};
use belvedere_scene::{Progress, Scene};
use std::sync::OnceLock;

/// A file to which the displaced heights will be written, on its own grid and in its own coordinate system.
#[derive(Clone, Copy)]
pub struct FileToWrite<'a> {
    /// Columns and rows, at least 2 each.
    pub nodes: [usize; 2],
    /// Distance between columns and between rows, about, scene units, > 0.
    pub spacing: DVec2,
    /// From scene x, y to column and row of the samples, the first at 0.
    pub index_from_scene: PlanMap<'a>,
    /// From column and row to scene x, y.
    pub scene_from_index: PlanMap<'a>,
    /// Heights of the samples (row-major), scene units, NaN without data, under a displacement with these lakes; `None` ends the search.
    pub heights: &'a (dyn Fn(&TerrainDisocclusion, &[LakeReport]) -> Option<Vec<f64>> + Sync),
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

    /// The points that the file hides under a displacement.
    ///
    /// * `field`: the ground that is solved on; `is_asked`: whether a point (grid coordinates of that ground) must be seen.
    pub(super) fn hidden(
        &self,
        field: &Field,
        (stage, lakes): (&TerrainDisocclusion, &[LakeReport]),
        is_asked: &(dyn Fn(&ReferencePoint) -> bool + Sync),
        progress: &Progress,
    ) -> Result<Vec<HiddenInFile>, DisocclusionError> {
        progress.tick("what the heights to be written hide", 0.9)?;
        let FileToWrite { nodes, spacing, index_from_scene, scene_from_index, heights } = self.file;
        let Some(heights) = heights(stage, lakes) else { return Ok(Vec::new()) };
        let height = |i: usize| heights.get(i).copied().filter(|h| h.is_finite());
        let ground = WrittenGround { nodes, spacing, height: &height, index_from_scene, scene_from_index, solved_on: false };
        let own = ground.field(self.view)?;
        let sight = SightOverFile::new(&ground, self.view);
        let points = self.points.get_or_init(|| {
            let features: Vec<_> = self.features.iter().map(|f| f.mapped(&|line| ground.image_of(&own, line))).collect();
            sight.in_view(&own, &judged_points(&features, &own, self.settings, CHECK_CELLS), self.view, self.settings)
        });
        let places: Vec<(DVec2, f64)> = points.iter().map(|p| (p.grid, p.lift)).collect();
        let eye = self.view.pinhole().eye.truncate();
        let found = |(p, (at, over)): (&ReferencePoint, (DVec2, f64))| {
            let [of_point, of_ground] = [p.grid, at].map(scene_from_index);
            let (of_point, of_ground) = (of_point?, of_ground?);
            let tau = of_point.distance(of_ground) / of_point.distance(eye).max(f64::MIN_POSITIVE);
            let [point, at] = [of_point, of_ground].map(|p| field.grid_from_scene(p));
            is_asked(&ReferencePoint { grid: point, ..*p }).then_some(HiddenInFile { point, at, tau, over })
        };
        // What lies nearer is cut down at the samples.
        let guard = self.settings.guard * (field.spacing() / spacing).max_element();
        let hiding = Judge::still(&own, &sight).hiding(&places, guard);
        Ok(points.iter().zip(hiding).filter_map(|(p, hides)| found((p, hides?))).collect())
    }
}
