//! Rigid bodies, carried by the stages of a view.

use belvedere_core::{RigidMotion, View};
use belvedere_scene::{Bodies, BoxShape, LayerKind, Mesh, MeshColors, MeshError, Scene};

/// The rigid bodies of a scene, each with its motion by the stages of a view up to the spline bend ([`View::body_motion`]).
///
/// Carried bodies stand in the space that [`Carried::after`] photographs. Rays of that view meet them there; a hit is taken
/// back to the scene by the motion of its body.
#[derive(Debug, Clone)]
pub struct Carried {
    after: View,
    layers: Vec<Option<CarriedLayer>>,
}

/// The bodies of a layer.
#[derive(Debug, Clone)]
pub struct CarriedLayer {
    bodies: Bodies,
    /// Motion of each body; `None` where its foot has no image.
    motions: Vec<Option<RigidMotion>>,
}

impl Carried {
    /// The bodies of a scene: one pass over the triangles of their layers. `None` if there are no bodies, or if the view does not carry
    /// bodies as a whole.
    pub fn new(scene: &Scene, view: &View) -> Option<Self> {
        if !view.carries_bodies() {
            return None;
        }
        let layers: Vec<_> = scene.layers.iter().map(|layer| CarriedLayer::new(&layer.kind, view)).collect();
        layers.iter().any(Option::is_some).then(|| Self { after: view.after_bodies(), layers })
    }

    /// The view of the carried bodies: curved rays and the pinhole.
    pub fn after(&self) -> &View {
        &self.after
    }

    /// The bodies of a layer, by its index; `None` if it has none.
    pub fn layer(&self, index: usize) -> Option<&CarriedLayer> {
        self.layers.get(index)?.as_ref()
    }

    /// The carried triangles of a layer, by its index; `None` if it has none. [`Mesh::part`] is the number of a triangle in the layer.
    pub fn mesh(&self, scene: &Scene, index: usize) -> Option<Mesh> {
        let layer = self.layer(index)?;
        let carried = match &scene.layers.get(index)?.kind {
            LayerKind::Boxes(boxes) => layer.boxes(&boxes.boxes),
            kind => {
                let body = |t: usize| layer.body(t).map(|(body, _)| body);
                kind.triangles()?.mesh.carried(&body, &|b, p| layer.motions[b].map_or(p, |motion| motion.carry(p)))
            }
        };
        carried.ok().filter(|mesh| !mesh.triangles().is_empty())
    }
}

impl CarriedLayer {
    fn new(kind: &LayerKind, view: &View) -> Option<Self> {
        let bodies = Bodies::of(kind)?;
        let motion = |foot| view.body_motion(foot).ok().filter(|m| m.carry(foot).as_vec3().is_finite());
        let motions = bodies.feet().iter().map(|foot| motion(*foot)).collect();
        Some(Self { bodies, motions })
    }

    /// The carried boxes as triangles.
    fn boxes(&self, boxes: &[BoxShape]) -> Result<Mesh, MeshError> {
        let (mut places, mut triangles, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (shape, motion)) in boxes.iter().zip(&self.motions).enumerate() {
            let Some(motion) = motion else { continue };
            let first = places.len() as u32;
            places.extend(shape.corners().map(|p| motion.carry(p)));
            triangles.extend(BoxShape::TRIANGLES.map(|t| t.map(|corner| first + corner as u32)));
            numbers.extend((0..BoxShape::TRIANGLES.len()).map(|t| (BoxShape::TRIANGLES.len() * k + t) as u32));
        }
        Mesh::in_parts(&places, triangles, MeshColors::Layer, numbers)
    }

    /// Whether a triangle belongs to a body.
    #[inline]
    pub fn holds(&self, triangle: usize) -> bool {
        self.bodies.of_triangle(triangle).is_some()
    }

    /// Whether every triangle belongs to a body.
    pub fn holds_all(&self) -> bool {
        self.bodies.are_all()
    }

    /// Number of the body that a triangle belongs to, and its motion; `None` if it belongs to none or the body has no image.
    #[inline]
    pub fn body(&self, triangle: usize) -> Option<(usize, &RigidMotion)> {
        let body = self.bodies.of_triangle(triangle)?;
        Some((body, self.motions[body].as_ref()?))
    }

    /// Motion of a body; `None` if it has no image.
    #[inline]
    pub fn motion(&self, body: usize) -> Option<&RigidMotion> {
        self.motions.get(body)?.as_ref()
    }
}
