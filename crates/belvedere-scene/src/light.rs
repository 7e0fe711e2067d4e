//! The sun, the sky and the air.

use crate::Color;
use belvedere_core::Pinhole;
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
    /// Share of the sky that clouds cover, about, 0..=1; a sky of one colour and a studio have none.
    pub clouds: f64,
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
            clouds: 0.0,
        }
    }
}

/// How far left of the way up the picture the light of a found view comes from, degrees.
const LEFT_DEG: f64 = 75.0;

impl Light {
    /// Azimuth of light that comes from the upper left of a picture, as in relief shading, in whole steps of 15 degrees, radians clockwise
    /// from north; `None` if the picture has no way up on the map: it looks at the zenith.
    pub fn azimuth_at_upper_left(view: &Pinhole) -> Option<f64> {
        // A level view goes up the picture as it goes forward, one from above has no forward on the map.
        let up = (view.forward - view.down).truncate();
        let heading_deg = (up.length() > 1e-6).then(|| up.x.atan2(up.y).to_degrees())?;
        Some((15.0 * ((heading_deg - LEFT_DEG) / 15.0).round()).rem_euclid(360.0).to_radians())
    }

    /// Unit vector towards the light; x east, y north, z up.
    pub fn direction(&self) -> DVec3 {
        let (sin_az, cos_az) = self.azimuth.sin_cos();
        let (sin_alt, cos_alt) = self.altitude.sin_cos();
        DVec3::new(sin_az * cos_alt, cos_az * cos_alt, sin_alt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::Projection;

    #[test]
    fn light_comes_from_the_upper_left_of_every_picture() {
        for heading_deg in (0..360).step_by(7) {
            for pitch in [0.0f64, 0.4, 1.2, 1.57] {
                let heading = f64::from(heading_deg).to_radians();
                let ahead = DVec3::new(heading.sin() * pitch.cos(), heading.cos() * pitch.cos(), -pitch.sin());
                let up = DVec3::new(heading.sin(), heading.cos(), 1.0);
                let lens = Projection::Perspective { fov_y: 0.8 };
                let view = Pinhole::look_at(DVec3::ZERO, ahead, up, lens, [40, 30], 1.0, None).expect("a view");
                let azimuth = Light::azimuth_at_upper_left(&view).expect("an azimuth");
                let light = Light { azimuth, ..Light::default() }.direction();
                assert!(light.dot(view.right) < -0.2, "{heading_deg}, {pitch}: from the left");
                assert!(light.dot(-view.down) > 0.05, "{heading_deg}, {pitch}: from above");
            }
        }
    }
}
