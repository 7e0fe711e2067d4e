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

/// How much steeper a Swiss relief draws level ground, and the tangent of the slope at which half of that is left.
const GENTLE: f32 = 1.2;
const GENTLE_SLOPE: f32 = 0.25;

/// How much more a Swiss relief makes of the openness of a place than the sky does.
const FORM: f32 = 2.0;

/// What a cast shadow leaves of the direct light of a Swiss relief, whose light is a drawing rather than a sun.
const SWISS_SHADOW: f32 = 0.45;

/// The same for ground without relief, on which only boxes and meshes throw shadows.
const FLAT_SHADOW: f32 = 0.62;

/// Light model of a layer.
#[derive(Debug, Clone)]
pub(crate) struct ReliefLight {
    relief: Relief,
    /// Direction to the sun, stretched so that level ground gets 1.
    sun: Vec3A,
    /// Side lights of the blend, stretched likewise, and the direction their weight vanishes in.
    sides: [(Vec3A, [f32; 2]); 4],
    /// What is left of direct light in a cast shadow.
    pub(crate) in_shadow: f32,
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
        let in_shadow = match relief {
            Relief::Swiss => SWISS_SHADOW,
            Relief::Sun => 0.0,
            Relief::None => FLAT_SHADOW,
        };
        Self { relief, sun: towards(light.azimuth, altitude), sides, in_shadow, warm, cool }
    }

    /// Factor by which light from everywhere colours a surface with unit normal `n`.
    /// * `open`: share of the sky that the surroundings leave, 1 = level ground;
    /// * `lit`: share of the sun that no shadow takes.
    pub(crate) fn at(&self, n: Vec3A, open: f32, lit: f32) -> Rgb {
        let [direct, sky] = self.parts(n, open, lit);
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
            Relief::Swiss => {
                let direct = 0.80 * tone(self.blend(modelled(n)));
                // Ridges stand out from their surroundings, valleys lie back.
                let open = 1.0 + FORM * (open - 1.0);
                let shadow = self.in_shadow + (1.0 - self.in_shadow) * lit;
                return [direct * (0.6 + 0.4 * open) * shadow, 0.62 * (0.5 + 0.5 * n.z) * open];
            }
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

/// The normal as the drawing models it: gentle slopes up to twice as steep, so that plains have a relief; walls as they are.
fn modelled(n: Vec3A) -> Vec3A {
    let slope = (n.x * n.x + n.y * n.y) / (n.z * n.z).max(1e-6);
    let more = 1.0 + GENTLE / (1.0 + slope / (GENTLE_SLOPE * GENTLE_SLOPE));
    Vec3A::new(n.x * more, n.y * more, n.z).normalize_or(Vec3A::Z)
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
    if bright > 1.0 { 1.0 + 0.55 * (1.0 - (-(bright - 1.0) / 0.55).exp()) } else { bright.powf(1.25) }
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
    fn gentle_slopes_are_modelled_and_walls_are_left_alone() {
        let light = ReliefLight::new(Relief::Swiss, &Light::default());
        let towards = |slope: f32| Vec3A::new(-slope, slope, 1.0).normalize();
        let away = |slope: f32| Vec3A::new(slope, -slope, 1.0).normalize();
        // Three degrees towards the light and away from it: a step of a tenth and more.
        let [bright, dark] = [towards(0.037), away(0.037)].map(|n| light.parts(n, 1.0, 1.0)[0]);
        assert!(bright / dark > 1.1, "{bright} {dark}");
        let mut before = f32::INFINITY;
        for i in 0..200 {
            let slope = 0.02 * i as f32;
            let n = modelled(away(slope));
            assert!((n.length() - 1.0).abs() < 1e-5 && n.z < before, "steeper ground stays steeper: {slope}");
            before = n.z;
        }
        let wall = away(4.0);
        assert!(modelled(wall).dot(wall) > 0.9999);
        assert_eq!(modelled(Vec3A::Z), Vec3A::Z);
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
