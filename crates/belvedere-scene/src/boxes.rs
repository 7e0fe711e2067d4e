//! Upright boxes: the buildings of block models.

use crate::Color;
use belvedere_core::DVec3;

/// An upright box: a building of a block model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxShape {
    /// Centre of the base, scene coordinates.
    pub base: DVec3,
    /// Full extents along its own x, its own y, and z, scene units.
    pub size: DVec3,
    /// Rotation about z, radians, counter-clockwise.
    pub yaw: f64,
    /// Colour.
    pub color: Color,
}

impl BoxShape {
    /// Numbers of the corners ([`BoxShape::corners`]) of the twelve triangles of a box, two per face.
    pub const TRIANGLES: [[usize; 3]; 12] = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];

    /// Outward unit normal of one of [`BoxShape::TRIANGLES`], by its number.
    pub fn normal_of(&self, triangle: usize) -> DVec3 {
        let corners = self.corners();
        let [a, b, c] = Self::TRIANGLES[triangle % Self::TRIANGLES.len()].map(|k| corners[k]);
        let n = (b - a).cross(c - a);
        let outward = a - (self.base + DVec3::Z * 0.5 * self.size.z);
        if n.dot(outward) < 0.0 { -n } else { n }.normalize_or(DVec3::Z)
    }

    /// The eight corners: bit 0 = +x side, bit 1 = +y side, bit 2 = top.
    pub fn corners(&self) -> [DVec3; 8] {
        let (sin, cos) = self.yaw.sin_cos();
        std::array::from_fn(|i| {
            let side = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
            let (lx, ly) = (side(0) * self.size.x, side(1) * self.size.y);
            let lz = if i >> 2 & 1 == 1 { self.size.z } else { 0.0 };
            self.base + DVec3::new(cos * lx - sin * ly, sin * lx + cos * ly, lz)
        })
    }
}

/// A layer of boxes.
#[derive(Debug, Clone)]
pub struct BoxLayer {
    /// Boxes.
    pub boxes: Vec<BoxShape>,
    /// Whether each box is a rigid body, see [`crate::Bodies`].
    pub rigid: bool,
    /// Opacity, 0..=1, see [`crate::LayerKind::opacity`].
    pub opacity: f32,
}

impl Default for BoxLayer {
    fn default() -> Self {
        Self::new(Vec::new())
    }
}

impl BoxLayer {
    /// Opaque boxes that are displaced point by point.
    pub fn new(boxes: Vec<BoxShape>) -> Self {
        Self { boxes, rigid: false, opacity: 1.0 }
    }
}
