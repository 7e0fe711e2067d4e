//! Rigid layers of a picture: which they are, and their carried positions.

use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Bodies, Frame, Scene};

/// The layers of a scene that a view carries, or parts of them, as rigid bodies.
#[derive(Debug, Clone, Default)]
pub struct RigidLayers(Vec<bool>);

impl RigidLayers {
    /// Those of a scene in a view.
    pub fn of(scene: &Scene, view: &View) -> Self {
        if !view.carries_bodies() {
            return Self::default();
        }
        Self(scene.layers.iter().map(|layer| Bodies::of(&layer.kind).is_some()).collect())
    }

    /// Whether the scene has rigid layers.
    pub fn any(&self) -> bool {
        self.0.contains(&true)
    }

    /// Ids of the rigid layers.
    pub fn ids(&self, scene: &Scene) -> Vec<String> {
        scene.layers.iter().zip(&self.0).filter(|(_, rigid)| **rigid).map(|(layer, _)| layer.id.clone()).collect()
    }

    /// Whether a pixel with this id shows a rigid layer.
    pub fn shown(&self, id: u32) -> bool {
        id.checked_sub(1).and_then(|layer| self.0.get(layer as usize)) == Some(&true)
    }

    /// Displaced position of the point `p_world` that a pixel shows, by the pixel's number: for a rigid layer from the picture itself; `None`
    /// if it has no image.
    pub fn displaced(&self, view: &View, frame: &Frame, i: usize, p_world: DVec3) -> Option<DVec3> {
        let pixel = DVec2::new((i % frame.width) as f64 + 0.5, (i / frame.width) as f64 + 0.5);
        self.displaced_at(view, (frame.id[i], pixel, frame.depth[i]), p_world)
    }

    /// [`RigidLayers::displaced`] of a pixel with its id and depth.
    pub fn displaced_at(&self, view: &View, (id, pixel, depth): (u32, DVec2, f32), p_world: DVec3) -> Option<DVec3> {
        if !p_world.is_finite() {
            return None;
        }
        if self.shown(id) {
            return Some(view.pinhole().unproject(pixel, f64::from(depth))).filter(|p| p.is_finite());
        }
        view.displace(p_world).ok().map(|d| d.point)
    }
}

/// Why `what`, which assumes that the stages displace every point by itself, cannot work for a scene with rigid layers; `None` if it has
/// none.
pub fn refusal(what: &str, scene: &Scene, view: &View) -> Option<String> {
    let stage = view.stages().iter().find(|stage| !stage.is_of_world() && !stage.bends_rays())?.name();
    let ids = RigidLayers::of(scene, view).ids(scene);
    let id = ids.first()?;
    Some(format!(
        "{what} does not know rigid bodies behind {stage}, and layer \"{id}\" is rigid; set rigid = false there, or remove the {stage} stage"
    ))
}
