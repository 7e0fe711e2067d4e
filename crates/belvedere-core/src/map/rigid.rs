//! Rigid motions, by which bends carry bodies that must keep their shape.

use super::spline::SplineBend;
use super::{Miss, SpaceMap, finite};
use glam::{DMat3, DVec3};

/// A rotation and a translation: `X' = to + rotation (X - from)`.
///
/// ```
/// use belvedere_core::RigidMotion;
/// use belvedere_core::{DMat3, DVec3};
/// let motion = RigidMotion::new(DVec3::X, DVec3::Z, DMat3::from_rotation_z(0.5));
/// let p = DVec3::new(3.0, -2.0, 7.0);
/// assert!(motion.undo(motion.carry(p)).distance(p) < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    from: DVec3,
    to: DVec3,
    rotation: DMat3,
}

impl RigidMotion {
    /// The motion that carries `from` to `to` (scene coordinates) and turns everything about it by `rotation`, an orthogonal matrix.
    pub fn new(from: DVec3, to: DVec3, rotation: DMat3) -> Self {
        Self { from, to, rotation }
    }

    /// Image of a point, scene coordinates.
    #[inline]
    pub fn carry(&self, p: DVec3) -> DVec3 {
        self.to + self.rotation * (p - self.from)
    }

    /// The point that is carried to `p_carried`.
    #[inline]
    pub fn undo(&self, p_carried: DVec3) -> DVec3 {
        self.from + self.rotation.transpose() * (p_carried - self.to)
    }

    /// The rotation.
    pub fn rotation(&self) -> DMat3 {
        self.rotation
    }

    /// Whether nothing moves.
    pub fn is_identity(&self) -> bool {
        self.from == self.to && self.rotation == DMat3::IDENTITY
    }
}

impl SpaceMap for RigidMotion {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        finite(self.carry(p))
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        finite(self.undo(p_displaced))
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        finite(p).map(|_| self.rotation)
    }
}

impl SplineBend {
    /// The rotation that the bend gives a rigid body whose foot is `foot`: right stays right, the heading becomes the tangent of the curve at
    /// the foot, the normal of the reference plane that of the curve. On the plane, and wherever nothing folds, it is the rotation nearest to
    /// the derivative of the bend.
    ///
    /// Together with the image of the foot this is the bend by the straight curve that touches the deformation curve there. Source: ours.
    pub fn rotation_at(&self, foot: DVec3) -> DMat3 {
        let tangent = self.curve().at(self.coordinates(foot).l).1;
        let [out_u, out_v] = self.curve_axes();
        let world = |u: f64, v: f64| u * out_u + v * out_v;
        let [right, heading, normal] = self.axes();
        let image = DMat3::from_cols(right, world(tangent.x, tangent.y), world(-tangent.y, tangent.x));
        image * DMat3::from_cols(right, heading, normal).transpose()
    }
}
