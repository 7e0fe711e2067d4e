//! The curved ray of a pixel.

use super::View;
use crate::Miss;
use glam::{DVec2, DVec3};

/// The set of world points that a pixel may see, ordered by depth: a curve once stages bend space.
#[derive(Debug, Clone, Copy)]
pub struct RayPath<'a> {
    view: &'a View,
    pixel: DVec2,
}

/// A point of a [`RayPath`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayPoint {
    /// World point, scene coordinates.
    pub point: DVec3,
    /// Depth at which the pixel sees it, scene units.
    pub depth: f64,
    /// Segment of the ray, see [`crate::Displaced::segment`].
    pub segment: u32,
}

impl<'a> RayPath<'a> {
    pub(super) fn new(view: &'a View, pixel: DVec2) -> Self {
        Self { view, pixel }
    }

    /// Pixel whose ray this is.
    pub fn pixel(&self) -> DVec2 {
        self.pixel
    }

    /// World point seen at `depth` (> 0, scene units).
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] where the chain of stages has no inverse, e.g. past a spline's fold limit.
    pub fn at(&self, depth: f64) -> Result<RayPoint, Miss> {
        if !(depth > 0.0) {
            return Err(Miss::BehindEye);
        }
        let p_displaced = self.view.pinhole().unproject(self.pixel, depth);
        let (point, segment) = self.view.undisplace(p_displaced)?;
        Ok(RayPoint { point, depth, segment })
    }
}
