//! Relief light on terrain.

use crate::simd::nearest;
use belvedere_composite::color::{Rgb, linear};
use belvedere_scene::{Light, Relief};
use glam::Vec3A;
use std::sync::LazyLock;

/// Steps of the table of tones, and the brightness of its last entry.
const TONE_STEPS: usize = 1024;
type Tones = [f32; TONE_STEPS + 1];
const BRIGHTEST: f32 = 4.0;

/// Highest altitude of the main light of the Swiss blend, radians: low light models gentle slopes better.
const SWISS_ALTITUDE: f64 = 0.68;

/// Relative exaggeration of level ground in a Swiss relief, and the tangent of the slope at which half of it remains.
const GENTLE: f32 = 0.8;
const GENTLE_SLOPE: f32 = 0.25;

/// Factor on the openness of a point in a Swiss relief, relative to the light of the sky.
const FORM: f32 = 2.5;

/// Openness that the deepest gullies keep, so that no shade is black.
const LEAST_OPEN: f32 = 0.42;

/// Share of direct light left in a cast shadow of a Swiss relief, whose light is a drawing technique rather than a sun.
const SWISS_SHADOW: f32 = 0.4;

/// Colours of the light of a Swiss relief, linear: a warm sun and a cool sky (Imhof; the figures are ours).
const SWISS_SUN: [f32; 3] = [1.28, 1.13, 0.86];
const SWISS_SKY: [f32; 3] = [0.44, 0.56, 0.88];

/// Amounts of direct light and of light of the sky on level ground.
const SWISS_AMOUNTS: [f32; 2] = [0.92, 0.34];
const AMOUNTS: [f32; 2] = [0.80, 0.62];

/// Share of the side lights of a Swiss relief on steep ground.
const SIDES: f32 = 0.3;

/// Film of a Swiss relief: exposure, contrast around a middle tone, and the square root of light above which it is compressed, so that snow
/// keeps its forms.
const EXPOSURE: f32 = 1.1;
const CONTRAST: f32 = 0.48;
const MIDDLE: f32 = 0.56;
/// How far below the middle tone contrast grows: the darkest tones keep their light.
const TOE: f32 = 0.17;
const SHOULDER: f32 = 0.70;

/// The same for ground without relief, on which only boxes and meshes throw shadows.
const FLAT_SHADOW: f32 = 0.62;

/// Light model of a layer.
#[derive(Debug, Clone)]
pub(crate) struct ReliefLight {
    relief: Relief,
    /// Direction to the sun, scaled so that level ground gets 1.
    sun: [f32; 3],
    /// Directions of the side lights, scaled likewise, and the aspects at which their weights vanish.
    sides: [([f32; 3], [f32; 2]); 4],
    /// Share of direct light left in a cast shadow.
    pub(crate) in_shadow: f32,
    /// Colours of direct light and of the light of the sky, see [`ReliefLight::parts`].
    pub(crate) warm: Rgb,
    pub(crate) cool: Rgb,
}

impl ReliefLight {
    pub(crate) fn new(relief: Relief, light: &Light) -> Self {
        let towards = |azimuth: f64, altitude: f64| {
            let d = Light { azimuth, altitude, shadows: false, ..Light::default() }.direction();
            (d / d.z).to_array().map(|v| v as f32)
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
            Relief::Swiss => (Rgb::from_array(SWISS_SUN), Rgb::from_array(SWISS_SKY)),
            Relief::Sun => (linear([255, 247, 232]) * 1.12, linear([126, 142, 176])),
        };
        let in_shadow = match relief {
            Relief::Swiss => SWISS_SHADOW,
            Relief::Sun => 0.0,
            Relief::None => FLAT_SHADOW,
        };
        Self { relief, sun: towards(light.azimuth, altitude), sides, in_shadow, warm, cool }
    }

    /// Square root of a lit colour as pictures show it.
    #[inline(always)]
    pub(crate) fn film(&self, root: f32) -> f32 {
        if self.relief != Relief::Swiss {
            return root;
        }
        let r = EXPOSURE * root;
        let tone = r - MIDDLE;
        let r = r * (1.0 + CONTRAST * if tone > -TOE { tone } else { -TOE });
        let over = (r - SHOULDER) * (1.0 / (1.0 - SHOULDER));
        let bent = SHOULDER + (1.0 - SHOULDER) * over / (1.0 + over);
        if over > 0.0 { bent } else { r }
    }

    /// Factor by which light from everywhere colours a surface with unit normal `n`.
    /// * `open`: visible share of the sky, 1 = level ground;
    /// * `lit`: visible share of the sun's disc.
    pub(crate) fn at(&self, n: Vec3A, open: f32, lit: f32) -> Rgb {
        let [direct, sky] = self.parts(n, open, lit);
        self.warm * direct + self.cool * sky
    }

    /// Amounts of direct light and of light of the sky on a surface with unit normal `n`.
    /// * `lit`: visible share of the sun's disc.
    ///
    /// Swiss: the main light blended with four side lights, each weighted by the squared sine of the angle between its
    /// azimuth and the slope's aspect, so that slopes along the main light are modelled too (after Mark 1992, USGS
    /// multidirectional shading; the blend and the tones are ours).
    pub(crate) fn parts(&self, n: Vec3A, open: f32, lit: f32) -> [f32; 2] {
        self.parts_of(&n.to_array().map(|v| [v]), &[open], &[lit]).map(|[v]| v)
    }

    /// [`ReliefLight::parts`] of many surfaces.
    #[inline(always)]
    pub(crate) fn parts_of<const N: usize>(&self, n: &[[f32; N]; 3], open: &[f32; N], lit: &[f32; N]) -> [[f32; N]; 2] {
        if self.relief == Relief::None {
            return [[1.0; N], [0.0; N]];
        }
        let (tones, swiss) = (&*TONES, self.relief == Relief::Swiss);
        let (mut bright, mut direct, mut sky) = ([0.0; N], [0.0; N], [0.0; N]);
        let [x, y, z] = n;
        if swiss {
            for i in 0..N {
                bright[i] = self.blend(modelled([x[i], y[i], z[i]]));
            }
        } else {
            for i in 0..N {
                bright[i] = positive(dot([x[i], y[i], z[i]], self.sun));
            }
        }
        for v in &mut bright {
            *v = tone(*v, tones);
        }
        // Ridges stand out from their surroundings, valleys lie back.
        let amounts = if swiss { SWISS_AMOUNTS } else { AMOUNTS };
        let (form, constant, per_open) = if swiss { (FORM, 0.6, 0.4) } else { (1.0, 0.7, 0.3) };
        for i in 0..N {
            let open = 1.0 + form * (open[i] - 1.0);
            let left = self.in_shadow + (1.0 - self.in_shadow) * lit[i];
            let open = if open > LEAST_OPEN { open } else { LEAST_OPEN };
            direct[i] = amounts[0] * bright[i] * (constant + per_open * open) * left;
            sky[i] = amounts[1] * (0.5 + 0.5 * z[i]) * open;
        }
        [direct, sky]
    }

    #[inline(always)]
    fn blend(&self, n: [f32; 3]) -> f32 {
        let main = positive(dot(n, self.sun));
        let steep = n[0] * n[0] + n[1] * n[1];
        let (mut sum, mut weights) = (0.0, 0.0);
        for (d, [sx, sy]) in &self.sides {
            let cross = n[0] * sy - n[1] * sx;
            let w = cross * cross;
            sum += w * positive(dot(n, *d));
            weights += w;
        }
        // Level ground has no aspect, so the side lights fade in with the slope.
        let share = SIDES * if steep < 1.0 / 12.0 { steep * 12.0 } else { 1.0 };
        main + share * (sum / (if weights > 1e-9 { weights } else { 1e-9 }) - main)
    }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn positive(v: f32) -> f32 {
    if v > 0.0 { v } else { 0.0 }
}

/// The normal used for shading: gentle slopes up to twice as steep, so that plains show relief; steep ones unchanged.
#[inline(always)]
fn modelled([x, y, z]: [f32; 3]) -> [f32; 3] {
    let zz = if z * z > 1e-6 { z * z } else { 1e-6 };
    let slope = (x * x + y * y) / zz;
    let more = 1.0 + GENTLE / (1.0 + slope * (1.0 / (GENTLE_SLOPE * GENTLE_SLOPE)));
    let [x, y] = [x * more, y * more];
    let length2 = x * x + y * y + z * z;
    let scale = 1.0 / (if length2 > 1e-12 { length2 } else { 1e-12 }).sqrt();
    [x * scale, y * scale, z * scale]
}

static TONES: LazyLock<Tones> =
    LazyLock::new(|| std::array::from_fn(|i| tone_of(i as f32 * BRIGHTEST / TONE_STEPS as f32)));

/// Tone curve: 1 on level ground, softly limited above, lifted below so that shadows keep their relief. From a table, since powers
/// cost as much as the rest of the shading.
#[inline(always)]
fn tone(bright: f32, tones: &Tones) -> f32 {
    // The last index of the table lies just before its end.
    const LAST: f32 = TONE_STEPS as f32 - 0.01;
    let x = bright * (TONE_STEPS as f32 / BRIGHTEST);
    let x = if x < LAST { x } else { LAST };
    // On an entry of the table either neighbour gives the same tone.
    let i = nearest(x - 0.5);
    let (a, b) = (tones[i as usize & (TONE_STEPS - 1)], tones[(i as usize & (TONE_STEPS - 1)) + 1]);
    a + (x - i as f32) * (b - a)
}

fn tone_of(bright: f32) -> f32 {
    if bright > 1.0 { 1.0 + 0.55 * (1.0 - (-(bright - 1.0) / 0.55).exp()) } else { bright.powf(1.25) }
}

#[cfg(test)]
mod tests;
