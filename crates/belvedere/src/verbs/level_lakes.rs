//! Lakes on grids that are written: level there, too, where those are other grids than the one that was solved on.

use belvedere_core::{DVec2, TerrainDisocclusion, polygon};
use belvedere_disocclusion::TerrainReport;
use belvedere_scene::{LayerKind, Scene};

/// One lake: the box around it, its rings, and by how much it moved.
struct Lake<'a> {
    low: DVec2,
    high: DVec2,
    rings: &'a [Vec<DVec2>],
    moved: f64,
}

/// A displacement that is the same everywhere inside the shore of a lake.
pub(super) struct LevelLakes<'a> {
    stage: &'a TerrainDisocclusion,
    lakes: Vec<Lake<'a>>,
}

impl<'a> LevelLakes<'a> {
    /// * `report`: says which areas of the scene are lakes, and how they moved.
    pub(super) fn new(stage: &'a TerrainDisocclusion, report: &TerrainReport, scene: &'a Scene) -> Self {
        let lake = |of: &belvedere_disocclusion::report::LakeReport| {
            let LayerKind::Area(areas) = &scene.layers.get(of.layer)?.kind else { return None };
            let rings = &areas.features.get(of.feature)?.rings[..];
            let corners = rings.iter().flatten().filter(|p| p.is_finite());
            let [low, high] = corners.fold([DVec2::MAX, DVec2::MIN], |[a, b], p| [a.min(*p), b.max(*p)]);
            Some(Lake { low, high, rings, moved: of.moved_m })
        };
        Self { stage, lakes: report.lakes.iter().filter_map(lake).collect() }
    }

    /// The displacement at scene x, y.
    pub(super) fn at(&self, p: DVec2) -> f64 {
        let lake =
            self.lakes.iter().find(|l| p.cmpge(l.low).all() && p.cmple(l.high).all() && polygon::is_inside(l.rings, p));
        lake.map_or_else(|| self.stage.delta_at(p.extend(0.0)), |lake| lake.moved)
    }
}
