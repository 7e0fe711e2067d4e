//! Affine functions of a point (planes with a scale) and linear maps of the straight parts between turns.

use super::phi::ViewpointValues;
use glam::{DMat3, DVec3};

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

/// Linear map of the part of the chain before a turn.
#[derive(Debug, Clone, Copy)]
pub(super) struct StraightPart {
    pub(super) viewpoint: DVec3,
    pub(super) linear: DMat3,
    pub(super) inverse: DMat3,
}

/// The forms of a turn, scaled: `h = a - b` is -1 at the viewpoint after the turn.
#[derive(Debug, Clone)]
pub(super) struct Forms {
    pub(super) a: LinearForm,
    pub(super) b: LinearForm,
    pub(super) h: LinearForm,
    pub(super) values: ViewpointValues,
    /// sigma of the bend point.
    pub(super) sigma: f64,
    /// Whether the wedge has no width, so that the turn is a kink.
    pub(super) kink: bool,
    /// From the viewpoint before the turn to the one after it.
    pub(super) baseline: DVec3,
}

impl Forms {
    /// Depth of t1 along a ray of the part before the turn.
    pub(super) fn bend_depth(&self, direction: DVec3) -> f64 {
        self.values.k0 / self.h.along(direction)
    }

    /// sigma, the value of a and b where the ray meets t1.
    pub(super) fn sigma_on(&self, direction: DVec3) -> f64 {
        self.values.a0 + self.bend_depth(direction) * self.a.along(direction)
    }

    /// Depth of t0 along a ray of the part before the turn.
    pub(super) fn start(&self, direction: DVec3) -> f64 {
        -self.values.a0 / self.a.along(direction)
    }

    /// Depth of t2, along the direction that the ray has after the turn.
    pub(super) fn end(&self, direction: DVec3) -> f64 {
        let after = direction - self.baseline * (self.h.along(direction) / self.values.k0);
        -self.values.b1 / self.b.along(after)
    }
}
