//! Rigid bodies: parts of a layer that bends carry as a whole, so that walls stay straight.

use crate::{LayerKind, Mesh, RigidParts};
use belvedere_core::{DVec2, DVec3};

/// The rigid bodies of a layer. Triangles are counted as in [`Mesh::triangles`], those of boxes twelve to a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Bodies {
    /// Body of every triangle of a mesh, [`LOOSE`] for none; `None` for boxes.
    of_triangle: Option<Vec<u32>>,
    feet: Vec<DVec3>,
}

/// Body number of a triangle that belongs to no body.
const LOOSE: u32 = u32::MAX;

/// Triangles of a box.
const PER_BOX: usize = 12;

impl Bodies {
    /// The bodies of a layer; `None` if it has none.
    pub fn of(kind: &LayerKind) -> Option<Self> {
        match kind {
            LayerKind::Boxes(layer) if layer.rigid && !layer.boxes.is_empty() => {
                Some(Self { of_triangle: None, feet: layer.boxes.iter().map(|b| b.base).collect() })
            }
            kind => kind.mesh().and_then(|layer| Self::of_mesh(&layer.mesh, &layer.rigid)),
        }
    }

    fn of_mesh(mesh: &Mesh, rigid: &RigidParts) -> Option<Self> {
        if *rigid == RigidParts::None {
            return None;
        }
        let parts = (0..mesh.triangles().len()).map(|t| mesh.part(t).unwrap_or(0));
        let most = parts.clone().max()? as usize;
        let mut is_body = vec![*rigid == RigidParts::All; most + 1];
        if let RigidParts::Only(only) = rigid {
            only.iter().for_each(|&part| is_body.get_mut(part as usize).into_iter().for_each(|is| *is = true));
        }
        let (mut numbers, mut plans) = (vec![LOOSE; most + 1], Vec::new());
        let mut of_triangle = Vec::with_capacity(mesh.triangles().len());
        for (t, part) in parts.enumerate() {
            let number = &mut numbers[part as usize];
            if is_body[part as usize] && *number == LOOSE {
                *number = plans.len() as u32;
                plans.push(Plan::default());
            }
            of_triangle.push(*number);
            if let Some(plan) = plans.get_mut(*number as usize) {
                plan.add(mesh.corners(t));
            }
        }
        let feet: Vec<DVec3> = plans.iter().map(Plan::foot).collect();
        (!feet.is_empty()).then_some(Self { of_triangle: Some(of_triangle), feet })
    }

    /// Foot of each body, scene coordinates: the centroid of its plan, at its lowest height; of a box the middle of its base.
    pub fn feet(&self) -> &[DVec3] {
        &self.feet
    }

    /// Number of the body that a triangle belongs to.
    #[inline]
    pub fn of_triangle(&self, triangle: usize) -> Option<usize> {
        match &self.of_triangle {
            Some(of) => of.get(triangle).copied().filter(|body| *body != LOOSE).map(|body| body as usize),
            None => Some(triangle / PER_BOX).filter(|body| *body < self.feet.len()),
        }
    }

    /// Whether every triangle belongs to a body.
    pub fn are_all(&self) -> bool {
        self.of_triangle.as_ref().is_none_or(|of| of.iter().all(|body| *body != LOOSE))
    }
}

/// Area and centroid of a body's plan, summed over its triangles. The roof and the floor of a closed body both count, which leaves the
/// centroid as it is.
struct Plan {
    /// Origin of the sums: the body's first corner.
    origin: Option<DVec2>,
    area: f64,
    moment: DVec2,
    corners: f64,
    sum: DVec2,
    lowest: f64,
}

impl Default for Plan {
    fn default() -> Self {
        let none = DVec2::ZERO;
        Self { origin: None, area: 0.0, moment: none, corners: 0.0, sum: none, lowest: f64::INFINITY }
    }
}

impl Plan {
    fn add(&mut self, corners: [DVec3; 3]) {
        let origin = *self.origin.get_or_insert(corners[0].truncate());
        let [a, b, c] = corners.map(|p| p.truncate() - origin);
        let area = 0.5 * (b - a).perp_dot(c - a).abs();
        self.area += area;
        self.moment += area * (a + b + c) / 3.0;
        self.corners += 3.0;
        self.sum += a + b + c;
        self.lowest = corners.iter().fold(self.lowest, |z, p| z.min(p.z));
    }

    /// The foot; of a body whose plan has no area, such as walls alone, at the mean of its corners.
    fn foot(&self) -> DVec3 {
        let mean = if self.area > 0.0 { self.moment / self.area } else { self.sum / self.corners.max(1.0) };
        (self.origin.unwrap_or_default() + mean).extend(self.lowest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BoxLayer, BoxShape, Color, MeshColors, MeshLayer};

    /// Two prisms with L-shaped floors, 10 m apart, and a loose triangle under both.
    fn prisms() -> MeshLayer {
        let plan = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0], [2.0, 6.0], [0.0, 6.0]];
        let fan = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
        let (mut places, mut triangles, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        for (part, x) in [(1, 0.0), (2, 10.0)] {
            let first = places.len() as u32;
            for z in [3.0, 9.0] {
                places.extend(plan.iter().map(|[px, py]| DVec3::new(5e5 + x + px, 4e6 + py, z)));
            }
            for [a, b, c] in fan {
                triangles.push([a, c, b].map(|v| first + v));
                triangles.push([a, b, c].map(|v| first + 6 + v));
            }
            for i in 0..6 {
                let j = (i + 1) % 6;
                triangles.push([i, j, j + 6].map(|v| first + v));
                triangles.push([i, j + 6, i + 6].map(|v| first + v));
            }
            parts.resize(triangles.len(), part);
        }
        triangles.push([0, 12, 4]);
        parts.push(0);
        let mesh = Mesh::in_parts(&places, triangles, MeshColors::Layer, parts).unwrap();
        MeshLayer { rigid: RigidParts::Only(vec![1, 2, 77]), ..MeshLayer::new(mesh, Color::rgb(1, 2, 3)) }
    }

    #[test]
    fn bodies_stand_on_the_centroid_of_their_plan() {
        let layer = prisms();
        let bodies = Bodies::of(&LayerKind::Mesh(layer.clone())).unwrap();
        // 4 x 2 and 2 x 4: areas 8 and 8 about (2, 1) and (1, 4).
        for (foot, x) in bodies.feet().iter().zip([0.0, 10.0]) {
            assert!(foot.distance(DVec3::new(5e5 + x + 1.5, 4e6 + 2.5, 3.0)) < 1e-5, "{foot}");
        }
        let last = layer.mesh.triangles().len() - 1;
        let of: Vec<Option<usize>> = [0, 19, 20, last, last + 1].map(|t| bodies.of_triangle(t)).to_vec();
        assert_eq!(of, [Some(0), Some(0), Some(1), None, None]);
        assert!(!bodies.are_all());
    }

    #[test]
    fn what_is_not_rigid_has_no_bodies_and_what_has_no_parts_is_one() {
        let with = |rigid| Bodies::of(&LayerKind::Mesh(MeshLayer { rigid, ..prisms() }));
        assert_eq!(with(RigidParts::None), None);
        assert_eq!(with(RigidParts::Only(vec![9])), None);
        assert_eq!(with(RigidParts::All).unwrap().feet().len(), 3);
        let mesh = Mesh::new(&[DVec3::ZERO, DVec3::X, 2.0 * DVec3::Z], vec![[0, 1, 2]], MeshColors::Layer).unwrap();
        let wall = MeshLayer { rigid: RigidParts::All, ..MeshLayer::new(mesh, Color::rgb(1, 2, 3)) };
        let bodies = Bodies::of(&LayerKind::Mesh(wall)).unwrap();
        assert!(bodies.feet()[0].distance(DVec3::X / 3.0) < 1e-7, "a wall stands on the mean of its corners");
        let shape = BoxShape { base: DVec3::ONE, size: DVec3::ONE, yaw: 0.0, color: Color::rgb(1, 2, 3) };
        let boxes = |rigid| Bodies::of(&LayerKind::Boxes(BoxLayer { rigid, ..BoxLayer::new(vec![shape; 2]) }));
        assert_eq!(boxes(false), None);
        let bodies = boxes(true).unwrap();
        assert_eq!([11, 12, 24].map(|t| bodies.of_triangle(t)), [Some(0), Some(1), None]);
        assert!(bodies.are_all() && bodies.feet() == [DVec3::ONE; 2]);
    }
}
