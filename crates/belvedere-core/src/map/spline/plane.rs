//! The reference plane and the default pivot on it.

use crate::Pinhole;
use glam::DVec3;

/// Rays flatter than this against the reference plane give no usable pivot: 5 degrees.
const FLATTEST: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The plane that stands for the ground: all `p` with `normal . p = height`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferencePlane {
    normal: DVec3,
    height: f64,
}

impl ReferencePlane {
    /// Plane with the given normal (any length > 0; it is normalised) at `height` scene units along the unit normal from the origin.
    /// `None` if the normal has no direction or a value is not finite.
    pub fn new(normal: DVec3, height: f64) -> Option<Self> {
        let normal = normal.try_normalize()?;
        (normal.is_finite() && height.is_finite()).then_some(Self { normal, height })
    }

    /// Level plane at `height`, scene units.
    pub fn level(height: f64) -> Self {
        Self { normal: DVec3::Z, height: if height.is_finite() { height } else { 0.0 } }
    }

    /// Unit normal, pointing up.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Distance of the plane from the origin along the normal, scene units.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Signed distance of `p` above the plane, scene units.
    pub fn height_of(&self, p: DVec3) -> f64 {
        p.dot(self.normal) - self.height
    }

    /// Foot of the perpendicular from `p`.
    pub fn foot(&self, p: DVec3) -> DVec3 {
        p - self.height_of(p) * self.normal
    }

    /// Unit directions in the plane: to the right of the picture, and ahead.
    pub fn heading_axes(&self, pinhole: &Pinhole) -> [DVec3; 2] {
        let Heading { right, heading, .. } = Heading::of(pinhole, self);
        [right, heading]
    }
}

/// Axes of the aligned space: `right`, `heading` and the plane's normal are orthonormal and right-handed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heading {
    pub(super) right: DVec3,
    pub(super) heading: DVec3,
    /// Viewing angle, radians.
    pub(super) phi: f64,
}

impl Heading {
    /// At nadir the image's own right (which comes from the up hint) keeps the heading.
    pub(super) fn of(pinhole: &Pinhole, plane: &ReferencePlane) -> Self {
        let (c, n) = (pinhole.forward, plane.normal());
        let across = c.cross(n);
        let right = if across.length() < 1e-6 {
            let hint = pinhole.right - pinhole.right.dot(n) * n;
            hint.try_normalize().unwrap_or_else(|| n.any_orthonormal_vector())
        } else {
            across.normalize()
        };
        Self { right, heading: n.cross(right), phi: (-c.dot(n)).atan2(across.length()) }
    }
}

/// Viewing angle of a camera over a plane, radians: 0 level, pi/2 straight down, negative looking up.
///
/// Source: Pasewaldt et al. 2011, section 4.1, where the sine is printed as a cosine of a difference.
pub fn viewing_angle(pinhole: &Pinhole, plane: &ReferencePlane) -> f64 {
    Heading::of(pinhole, plane).phi
}

/// Where the optical axis meets the plane. If it misses the plane or is flatter than 5 degrees: the point of the plane
/// along the heading at distance `H / sin 5 deg` from the eye, `H` the eye's height over the plane.
pub fn default_pivot(pinhole: &Pinhole, plane: &ReferencePlane) -> DVec3 {
    let height = plane.height_of(pinhole.eye);
    let heading = Heading::of(pinhole, plane);
    let distance = height / heading.phi.sin();
    if heading.phi.abs() >= FLATTEST && distance >= 0.0 {
        return plane.foot(pinhole.eye + distance * pinhole.forward);
    }
    plane.foot(pinhole.eye) + height.abs() / FLATTEST.tan() * heading.heading
}
