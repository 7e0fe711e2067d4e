//! Lines of sight over displaced ground where no other stage bends rays: triangle by triangle, by the judge of terrain disocclusion.
//! Chords of a bent ray may step over a narrow ridge.

use crate::sample::Sample;
use belvedere_core::grid::Grid;
use belvedere_core::{DVec2, SpaceMap, Stage, View};
use belvedere_scene::Scene;
use belvedere_sight::{DisplacedGround, Field};

/// Depth under the ground down to which a line of sight still counts as clear, scene units: rounding.
const TOUCH: f64 = 1e-6;

/// The ground of a scene as a view displaces it, and the eye.
pub(super) struct DisplacedSight {
    layer: usize,
    field: Field,
    delta: Grid,
    eye: DVec2,
    z: f64,
}

impl DisplacedSight {
    /// `None` where the view does not displace the ground, or bends its rays besides.
    pub(super) fn new(scene: &Scene, view: &View) -> Option<Self> {
        if view.pinhole().is_orthographic() {
            return None;
        }
        let (mut earth, mut delta) = (None, None);
        for stage in view.stages() {
            match stage {
                Stage::EarthCurvature(e) if delta.is_none() => earth = Some(*e),
                Stage::TerrainDisocclusion(t) if delta.is_none() => delta = Some(t.grid().clone()),
                _ => return None,
            }
        }
        let delta = delta?;
        let mut grounds =
            scene.layers.iter().enumerate().filter_map(|(i, l)| l.kind.terrain().map(|t| (i, &t.heightfield)));
        let (layer, hf) = grounds.next()?;
        if grounds.next().is_some() {
            return None;
        }
        let drop = |p: DVec2| earth.and_then(|e| e.apply(p.extend(0.0)).ok()).map_or(0.0, |q| -q.z);
        let field = Field::new(hf, drop).ok()?;
        let eye = view.pinhole().eye;
        Some(Self { layer, eye: field.grid_from_scene(eye.truncate()), z: eye.z, field, delta })
    }

    /// The terrain's layer.
    pub(super) fn layer(&self) -> usize {
        self.layer
    }

    /// The displaced ground.
    pub(super) fn ground(&self) -> DisplacedGround<'_> {
        DisplacedGround::new(&self.field, &self.delta).prepared()
    }

    /// Height by which the ground rises over the line of sight of a sample; 0 where it does not, `None` beside the ground.
    pub(super) fn over(&self, ground: &DisplacedGround<'_>, sample: &Sample) -> Option<f64> {
        let at = self.field.grid_from_scene(sample.p_world.truncate());
        let z = ground.height_at(at)? + sample.lift;
        let rise = ground.excess(&[(at, z), (self.eye, self.z)], 0.0).over;
        Some(if rise > TOUCH { rise } else { 0.0 })
    }
}
