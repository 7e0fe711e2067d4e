//! Where things stand.

use belvedere_core::DVec3;

/// Where a layer's own origin is, and how the layer is turned about the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The layer's own origin, scene coordinates.
    pub translate: DVec3,
    /// Turn about z, radians, counter-clockwise seen from above.
    pub yaw: f64,
}

impl Placement {
    /// A point of the layer, scene coordinates.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.turn(p) + self.translate
    }

    /// A direction of the layer.
    pub fn turn(&self, v: DVec3) -> DVec3 {
        let (sin, cos) = self.yaw.sin_cos();
        DVec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    }
}
