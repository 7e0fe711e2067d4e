//! Lakes on written grids: kept level also where the grid is not the solver's.

use belvedere_core::{DVec2, TerrainDisocclusion, polygon};
use belvedere_disocclusion::report::{BANK_M, LakeReport};
use belvedere_scene::{Heightfield, Scene};

/// One lake: its bounding box, its rings, the height up to which its area counts as water, and its displacement.
struct Lake<'a> {
    low: DVec2,
    high: DVec2,
    rings: &'a [Vec<DVec2>],
    water_m: f64,
    moved: f64,
}

/// A displacement that is constant over the water of a lake; its banks move as solved.
pub(super) struct LevelLakes<'a> {
    stage: &'a TerrainDisocclusion,
    terrain: Option<&'a Heightfield>,
    lakes: Vec<Lake<'a>>,
}

impl<'a> LevelLakes<'a> {
    /// * `lakes`: the areas of the scene that are lakes, and their displacements.
    pub(super) fn new(stage: &'a TerrainDisocclusion, lakes: &[LakeReport], scene: &'a Scene) -> Self {
        let lake = |of: &LakeReport| {
            let areas = scene.layers.get(of.layer)?.kind.areas()?;
            let rings = &areas.features.get(of.feature)?.rings[..];
            let corners = rings.iter().flatten().filter(|p| p.is_finite());
            let [low, high] = corners.fold([DVec2::MAX, DVec2::MIN], |[a, b], p| [a.min(*p), b.max(*p)]);
            Some(Lake { low, high, rings, water_m: of.height_m + BANK_M, moved: of.moved_m })
        };
        Self { stage, terrain: scene.terrain(), lakes: lakes.iter().filter_map(lake).collect() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lakes.is_empty()
    }

    /// Index of the lake whose water is at scene x, y.
    pub(super) fn lake_at(&self, p: DVec2) -> Option<usize> {
        let is_water = |l: &Lake<'_>| self.terrain.and_then(|t| t.surface_at(p)).is_none_or(|z| z <= l.water_m);
        let holds = |l: &Lake<'_>| p.cmpge(l.low).all() && p.cmple(l.high).all() && polygon::is_inside(l.rings, p);
        self.lakes.iter().position(|l| holds(l) && is_water(l))
    }

    /// The displacement at scene x, y.
    pub(super) fn at(&self, p: DVec2) -> f64 {
        self.lake_at(p).map_or_else(|| self.stage.delta_at(p.extend(0.0)), |lake| self.lakes[lake].moved)
    }
}
