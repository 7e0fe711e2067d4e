//! Relief light on terrain.

use super::color::{Rgb, linear};
use belvedere_scene::{Light, Relief};
use glam::Vec3A;
use std::sync::LazyLock;

/// Steps of the table of [`in_shade`].
const STEPS: usize = 512;

/// Highest main light of the Swiss blend, radians: lower light models gentle slopes better.
const SWISS_ALTITUDE: f64 = 0.68;

/// Light model of a terrain layer.
#[derive(Debug)]
pub(crate) struct ReliefLight {
    relief: Relief,
    /// Direction to the sun, stretched so that level ground gets 1.
    sun: Vec3A,
    /// Side lights of the blend, stretched likewise, and the direction their weight vanishes in.
    sides: [(Vec3A, [f32; 2]); 4],
    warm: Rgb,
    cool: Rgb,
}

impl ReliefLight {
    pub(crate) fn new(relief: Relief, light: &Light) -> Self {
        let towards = |azimuth: f64, altitude: f64| {
            let d = Light { azimuth, altitude, shadows: false }.direction();
            let d = Vec3A::new(d.x as f32, d.y as f32, d.z as f32);
            d / d.z
        };
        let mut altitude = light.altitude.clamp(0.05, 1.5);
        if relief == Relief::Swiss {
            altitude = altitude.min(SWISS_ALTITUDE);
        }
        let sides = [-90f64, -45.0, 0.0, 45.0].map(|turn| {
            let azimuth = light.azimuth + turn.to_radians();
            (towards(azimuth, altitude.min(0.6)), [azimuth.sin() as f32, azimuth.cos() as f32])
        });
        Self {
            relief,
            sun: towards(light.azimuth, altitude),
            sides,
            warm: linear([255, 247, 232]) * 1.12,
            cool: linear([126, 142, 176]),
        }
    }

    /// Factor by which light from everywhere colours a surface with unit normal `n`.
    /// `open` is the share of the sky that the surroundings leave, 1 = level ground.
    ///
    /// Swiss: the main light blended with four side lights, each weighted by the squared sine of the angle between its
    /// azimuth and the slope's aspect, so that slopes along the main light are modelled too (after Mark 1992, USGS
    /// multidirectional shading; the blend and the tones are ours).
    pub(crate) fn at(&self, n: Vec3A, open: f32) -> Rgb {
        let bright = match self.relief {
            Relief::None => return Rgb::ONE,
            Relief::Sun => n.dot(self.sun).max(0.0),
            Relief::Swiss => {
                let main = n.dot(self.sun).max(0.0);
                let steep = n.x * n.x + n.y * n.y;
                if steep < 1e-9 {
                    main
                } else {
                    let (mut sum, mut weights) = (0.0, 0.0);
                    for (d, [sx, sy]) in &self.sides {
                        let cross = n.x * sy - n.y * sx;
                        let w = cross * cross;
                        sum += w * n.dot(*d).max(0.0);
                        weights += w;
                    }
                    // Level ground has no aspect: fade the side lights in with the slope.
                    let share = 0.42 * (steep * 12.0).min(1.0);
                    main + share * (sum / weights.max(1e-9) - main)
                }
            }
        };
        // 1 on level ground; softly limited above, lifted below so that shadows keep their drawing.
        let tone = if bright > 1.0 { 1.0 + 0.55 * (1.0 - (-(bright - 1.0) / 0.55).exp()) } else { in_shade(bright) };
        let direct = self.warm * (0.80 * tone);
        let ambient = self.cool * (0.62 * (0.5 + 0.5 * n.z) * open);
        direct * (0.7 + 0.3 * open) + ambient
    }
}

/// `bright^1.15` for 0..=1, from a table: a power costs as much as the rest of the light.
fn in_shade(bright: f32) -> f32 {
    static POWERS: LazyLock<[f32; STEPS + 1]> =
        LazyLock::new(|| std::array::from_fn(|i| (i as f32 / STEPS as f32).powf(1.15)));
    let x = bright.clamp(0.0, 1.0) * STEPS as f32;
    let i = (x as usize).min(STEPS - 1);
    let (a, b) = (POWERS[i], POWERS[i + 1]);
    a + (x - i as f32) * (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shade_from_the_table_is_the_power() {
        for i in 0..=10_000 {
            let x = i as f32 / 1e4;
            assert!((in_shade(x) - x.powf(1.15)).abs() < 1e-4, "{x}");
        }
    }
}
