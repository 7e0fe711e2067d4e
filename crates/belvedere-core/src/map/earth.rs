//! Curvature of the earth and refraction as a displacement.

use super::{Miss, SpaceMap, finite};
use crate::Aabb;
use glam::{DMat3, DVec3};

/// The ground falls away from the eye as on a sphere: `z' = z - (1 - k) r^2 / (2 R)`, with `r` the
/// horizontal distance from the eye. Rays stay straight; refraction `k` lifts the far ground.
///
/// Source: surveyors' and viewshed programs' formula; for `r` = 100 km its error against the exact sphere is below 0.1 m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EarthCurvature {
    /// Eye; only x and y matter, scene units.
    pub eye: DVec3,
    /// Radius of the sphere, scene units.
    pub radius: f64,
    /// Refraction coefficient, 0.13 by default: the share of the drop that bent light takes back.
    pub refraction: f64,
}

impl EarthCurvature {
    /// Default refraction coefficient.
    pub const REFRACTION: f64 = 0.13;

    fn factor(&self) -> f64 {
        (1.0 - self.refraction) / (2.0 * self.radius)
    }

    fn drop_at(&self, p: DVec3) -> f64 {
        self.factor() * (p - self.eye).truncate().length_squared()
    }

    /// See [`crate::map::StageMap::edge_bound`]; exact for a parabola.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        0.25 * self.factor() * (p1 - p0).truncate().length_squared()
    }

    /// See [`crate::map::StageMap::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        let corners = bounds.corners();
        let far = corners.iter().map(|&c| self.drop_at(c)).fold(0.0, f64::max);
        let nearest = self.eye.clamp(bounds.min, bounds.max);
        let mut out = *bounds;
        out.min.z -= far;
        out.max.z -= self.drop_at(nearest);
        Some(out)
    }
}

impl SpaceMap for EarthCurvature {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        finite(DVec3::new(p.x, p.y, p.z - self.drop_at(p)))
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        finite(DVec3::new(p_displaced.x, p_displaced.y, p_displaced.z + self.drop_at(p_displaced)))
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let slope = -2.0 * self.factor() * finite(p - self.eye)?.truncate();
        Ok(DMat3::from_cols(DVec3::new(1.0, 0.0, slope.x), DVec3::new(0.0, 1.0, slope.y), DVec3::Z))
    }
}
