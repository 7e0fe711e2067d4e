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
mod tests;
