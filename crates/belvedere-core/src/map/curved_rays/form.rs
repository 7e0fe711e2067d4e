//! Affine functions of a point: planes with a scale.

use glam::DVec3;

/// `at_origin + gradient . (p - origin)`: zero on a plane, measured in units of the caller's choice.
///
/// Kept relative to a nearby origin, so that scene coordinates of millions of metres cost no digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearForm {
    /// Point near which the form is used, scene coordinates.
    pub origin: DVec3,
    /// Value at the origin.
    pub at_origin: f64,
    /// Change per scene unit.
    pub gradient: DVec3,
}

impl LinearForm {
    /// Value at a point.
    pub fn at(&self, p: DVec3) -> f64 {
        self.at_origin + self.gradient.dot(p - self.origin)
    }

    /// Change along a difference of points.
    pub fn along(&self, v: DVec3) -> f64 {
        self.gradient.dot(v)
    }

    /// The form times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { at_origin: factor * self.at_origin, gradient: factor * self.gradient, ..self }
    }

    /// Point of the zero plane nearest to the origin and its unit normal towards positive values, scene coordinates.
    pub fn plane(&self) -> (DVec3, DVec3) {
        let length = self.gradient.length();
        let normal = self.gradient / length;
        (self.origin - normal * (self.at_origin / length), normal)
    }
}
