//! Placements of layers.

use belvedere_core::DVec3;

/// Position of a layer's own origin, and its rotation about the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The layer's own origin, scene coordinates.
    pub translate: DVec3,
    /// Turn about z, radians, counter-clockwise seen from above.
    pub yaw: f64,
}

impl Placement {
    /// Scene coordinates of a point given in coordinates of the layer.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.turn(p) + self.translate
    }

    /// Scene direction of a direction of the layer.
    pub fn turn(&self, v: DVec3) -> DVec3 {
        let (sin, cos) = self.yaw.sin_cos();
        DVec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    }
}
