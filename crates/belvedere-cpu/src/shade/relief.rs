//! Relief light on terrain.

use super::color::{Rgb, linear};
use belvedere_scene::{Light, Relief};
use glam::Vec3A;
use std::sync::LazyLock;

/// Steps of the table of tones, and the brightness at its end.
const STEPS: usize = 1024;
const BRIGHTEST: f32 = 4.0;

/// Highest main light of the Swiss blend, radians: lower light models gentle slopes better.
const SWISS_ALTITUDE: f64 = 0.68;

/// What a cast shadow leaves of the direct light of a Swiss relief, whose light is a drawing rather than a sun.
const SWISS_SHADOW: f32 = 0.45;

/// Light model of a layer.
#[derive(Debug, Clone)]
pub(crate) struct ReliefLight {
    relief: Relief,
    /// Direction to the sun, stretched so that level ground gets 1.
    sun: Vec3A,
    /// Side lights of the blend, stretched likewise, and the direction their weight vanishes in.
    sides: [(Vec3A, [f32; 2]); 4],
    /// What is left of direct light in a cast shadow.
    in_shadow: f32,
    /// Colours of direct light and of that from the sky, see [`ReliefLight::parts`].
    pub(crate) warm: Rgb,
    pub(crate) cool: Rgb,
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
        let (warm, cool) = match relief {
            Relief::None => (Rgb::ONE, Rgb::ZERO),
            _ => (linear([255, 247, 232]) * 1.12, linear([126, 142, 176])),
        };
        let in_shadow = if relief == Relief::Swiss { SWISS_SHADOW } else { 0.0 };
        Self { relief, sun: towards(light.azimuth, altitude), sides, in_shadow, warm, cool }
    }

    /// Factor by which light from everywhere colours a surface with unit normal `n` that no shadow falls on.
    /// `open` is the share of the sky that the surroundings leave, 1 = level ground.
    pub(crate) fn at(&self, n: Vec3A, open: f32) -> Rgb {
        let [direct, sky] = self.parts(n, open, 1.0);
        self.warm * direct + self.cool * sky
    }

    /// Amounts of direct light and of light from the sky on a surface with unit normal `n`.
    /// * `lit`: share of the sun that no shadow takes.
    ///
    /// Swiss: the main light blended with four side lights, each weighted by the squared sine of the angle between its
    /// azimuth and the slope's aspect, so that slopes along the main light are modelled too (after Mark 1992, USGS
    /// multidirectional shading; the blend and the tones are ours).
    pub(crate) fn parts(&self, n: Vec3A, open: f32, lit: f32) -> [f32; 2] {
        let bright = match self.relief {
            Relief::None => return [1.0, 0.0],
            Relief::Sun => n.dot(self.sun).max(0.0),
            Relief::Swiss => self.blend(n),
        };
        let direct = 0.80 * tone(bright) * (0.7 + 0.3 * open) * (self.in_shadow + (1.0 - self.in_shadow) * lit);
        [direct, 0.62 * (0.5 + 0.5 * n.z) * open]
    }

    fn blend(&self, n: Vec3A) -> f32 {
        let main = n.dot(self.sun).max(0.0);
        let steep = n.x * n.x + n.y * n.y;
        if steep < 1e-9 {
            return main;
        }
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

/// 1 on level ground; softly limited above, lifted below so that shadows keep their drawing. From a table: powers cost
/// as much as the rest of the light.
fn tone(bright: f32) -> f32 {
    static TONES: LazyLock<[f32; STEPS + 1]> =
        LazyLock::new(|| std::array::from_fn(|i| tone_of(i as f32 * BRIGHTEST / STEPS as f32)));
    let x = bright.clamp(0.0, BRIGHTEST) * (STEPS as f32 / BRIGHTEST);
    let i = (x as usize).min(STEPS - 1);
    let (a, b) = (TONES[i], TONES[i + 1]);
    a + (x - i as f32) * (b - a)
}

fn tone_of(bright: f32) -> f32 {
    if bright > 1.0 { 1.0 + 0.55 * (1.0 - (-(bright - 1.0) / 0.55).exp()) } else { bright.powf(1.15) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tones_from_the_table_are_the_formula() {
        for i in 0..=10_000 {
            let x = i as f32 / 3e3;
            assert!((tone(x) - tone_of(x)).abs() < 1e-4, "{x}");
        }
        assert!((tone(99.0) - 1.55).abs() < 0.01);
    }

    #[test]
    fn shadows_take_the_sun_and_leave_the_sky() {
        let n = Vec3A::new(0.1, -0.2, 0.9).normalize();
        for relief in [Relief::Sun, Relief::Swiss] {
            let light = ReliefLight::new(relief, &Light::default());
            let ([lit, sky], [dark, same]) = (light.parts(n, 1.0, 1.0), light.parts(n, 1.0, 0.0));
            assert!(
                dark < 0.5 * lit && sky == same && (relief == Relief::Swiss) == (dark > 0.0),
                "{relief:?} {lit} {dark}"
            );
        }
    }
}
