//! The sun, the sky and the air.

use crate::Color;
use glam::DVec3;

/// What stands behind everything.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sky {
    /// By the height of the sun: a clear day, dusk below 6 degrees, night below -6; behind scenes without landscape a light studio.
    #[default]
    Auto,
    /// A clear day.
    Day,
    /// After sunset.
    Dusk,
    /// Night.
    Night,
    /// One colour.
    Plain(Color),
    /// What is laid behind the picture; renderers draw white.
    Transparent,
}

/// How the air dims what is far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Haze {
    /// In the farther part of what the view holds, none straight from above and in small models.
    #[default]
    Auto,
    /// Not at all.
    None,
    /// By distance: a black thing is seen in 2 % contrast at this many scene units (the meteorological visibility).
    Visibility(f64),
}

/// One distant light, and the air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Direction the light comes from, radians clockwise from north.
    pub azimuth: f64,
    /// Height of the light over the horizon, radians.
    pub altitude: f64,
    /// Whether cast shadows are wanted.
    pub shadows: bool,
    /// What stands behind everything.
    pub sky: Sky,
    /// Haze.
    pub haze: Haze,
}

impl Default for Light {
    /// The cartographers' light: from the north-west, 45 degrees high, no cast shadows.
    fn default() -> Self {
        Self {
            azimuth: 315f64.to_radians(),
            altitude: 45f64.to_radians(),
            shadows: false,
            sky: Sky::Auto,
            haze: Haze::Auto,
        }
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
