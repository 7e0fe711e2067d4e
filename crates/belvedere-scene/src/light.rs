//! The sun.

use glam::DVec3;

/// One distant light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Direction the light comes from, radians clockwise from north.
    pub azimuth: f64,
    /// Height of the light over the horizon, radians.
    pub altitude: f64,
    /// Whether cast shadows are wanted.
    pub shadows: bool,
}

impl Default for Light {
    /// The cartographers' light: from the north-west, 45 degrees high, no cast shadows.
    fn default() -> Self {
        Self { azimuth: 315f64.to_radians(), altitude: 45f64.to_radians(), shadows: false }
    }
}

impl Light {
    /// Unit vector towards the light; x east, y north, z up.
    pub fn direction(&self) -> DVec3 {
        let (sin_az, cos_az) = self.azimuth.sin_cos();
        let (sin_alt, cos_alt) = self.altitude.sin_cos();
        DVec3::new(sin_az * cos_alt, cos_az * cos_alt, sin_alt)
    }
}
