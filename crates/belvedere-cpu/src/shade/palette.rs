//! Hypsometric tints. Ours: muted, rising in lightness with height, so that they also read without colour.

use super::color::{Rgb, linear};
use belvedere_scene::Palette;

const STEPS: usize = 256;

/// Tint by height, and the colours that steepness and height add.
#[derive(Debug)]
pub(crate) struct Tint {
    ramp: Vec<Rgb>,
    bottom_m: f32,
    per_m: f32,
    pub(crate) rock: Rgb,
    /// Tangent of the slope at which rock begins and has taken over.
    pub(crate) rock_slope: [f32; 2],
    pub(crate) snow: Rgb,
    /// Heights at which snow begins and has taken over on gentle slopes, metres.
    pub(crate) snow_m: [f32; 2],
}

type Stops = &'static [(f32, [u8; 3])];

const ALPINE: Stops = &[
    (0.0, [104, 138, 103]),
    (0.15, [122, 152, 107]),
    (0.32, [147, 168, 114]),
    (0.48, [176, 178, 126]),
    (0.62, [190, 176, 133]),
    (0.76, [184, 165, 138]),
    (0.88, [190, 181, 170]),
    (1.0, [224, 222, 220]),
];
const DESERT: Stops = &[
    (0.0, [150, 112, 88]),
    (0.2, [178, 126, 92]),
    (0.4, [199, 150, 108]),
    (0.6, [212, 174, 130]),
    (0.8, [217, 196, 158]),
    (1.0, [206, 204, 178]),
];
const GLACIAL: Stops = &[
    (0.0, [128, 130, 120]),
    (0.22, [150, 147, 136]),
    (0.42, [170, 167, 160]),
    (0.62, [193, 195, 196]),
    (0.82, [218, 224, 230]),
    (1.0, [240, 244, 248]),
];
const PLAIN: Stops = &[(0.0, [205, 205, 202]), (1.0, [205, 205, 202])];

impl Tint {
    /// * `z_range_m`: heights that the ramp spans.
    pub(crate) fn new(palette: Palette, z_range_m: [f64; 2]) -> Self {
        let [bottom, top] = z_range_m.map(|z| z as f32);
        let span = (top - bottom).max(1e-3);
        let palette = match palette {
            // High ground that never comes down to the valleys is rock and ice; the rest is green below.
            Palette::Auto if top > 5000.0 => Palette::Glacial,
            Palette::Auto => Palette::Alpine,
            p => p,
        };
        let none = [1e30, 2e30]; // finite: a step between infinities is NaN
        let (stops, rock, rock_slope, snow_m) = match palette {
            Palette::Desert => (DESERT, [148, 98, 72], [0.7, 1.6], none),
            Palette::Glacial => (GLACIAL, [112, 106, 102], [0.6, 1.15], [bottom + 0.42 * span, bottom + 0.62 * span]),
            Palette::Plain => (PLAIN, [205, 205, 202], [1e6, 2e6], none),
            Palette::Alpine | Palette::Auto => {
                let line = (bottom + 0.80 * span).max(2450.0);
                (ALPINE, [160, 149, 136], [0.62, 1.25], [line, line + 0.14 * span.max(300.0)])
            }
        };
        let ramp = (0..STEPS).map(|i| ramp_at(stops, i as f32 / (STEPS - 1) as f32)).collect();
        let per_m = (STEPS - 1) as f32 / span;
        Self { ramp, bottom_m: bottom, per_m, rock: linear(rock), rock_slope, snow: linear([244, 247, 250]), snow_m }
    }

    /// Tint at a height.
    pub(crate) fn at(&self, height_m: f32) -> Rgb {
        let t = ((height_m - self.bottom_m) * self.per_m).clamp(0.0, (STEPS - 1) as f32);
        let i = (t as usize).min(STEPS - 2);
        self.ramp[i].lerp(self.ramp[i + 1], t - i as f32)
    }
}

fn ramp_at(stops: Stops, t: f32) -> Rgb {
    let i = stops.partition_point(|s| s.0 <= t).clamp(1, stops.len() - 1);
    let ((t0, a), (t1, b)) = (stops[i - 1], stops[i]);
    linear(a).lerp(linear(b), ((t - t0) / (t1 - t0)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shade::color::smoothstep;

    #[test]
    fn every_palette_tells_snow_from_ground_even_where_there_is_none() {
        for palette in [Palette::Auto, Palette::Alpine, Palette::Desert, Palette::Glacial, Palette::Plain] {
            for range in [[0.0, 4000.0], [12.0, 12.0]] {
                let tint = Tint::new(palette, range);
                let snow = smoothstep(tint.snow_m[0], tint.snow_m[1], range[0] as f32);
                assert!(snow == 0.0, "{palette:?}: {snow} of the lowest ground is snow");
            }
        }
    }

    #[test]
    fn every_palette_has_colours_at_every_height() {
        for palette in [Palette::Auto, Palette::Alpine, Palette::Desert, Palette::Glacial, Palette::Plain] {
            for range in [[0.0, 0.0], [-400.0, 9000.0], [300.0, 3100.0], [1e6, 1e6 + 1e-6]] {
                let tint = Tint::new(palette, range);
                for z in [range[0], 0.5 * (range[0] + range[1]), range[1], -1e9, 1e9] {
                    let snow = smoothstep(tint.snow_m[0], tint.snow_m[1], z as f32);
                    assert!((0.0..=1.0).contains(&snow), "{palette:?} {range:?}: {snow}");
                    let c = tint.at(z as f32);
                    assert!(c.min_element() > 0.02 && c.max_element() <= 1.0, "{palette:?} {range:?} at {z}: {c}");
                }
            }
        }
    }

    #[test]
    fn tints_grow_lighter_with_height() {
        for stops in [ALPINE, GLACIAL, DESERT] {
            let light = |t: f32| ramp_at(stops, t).dot(Rgb::new(0.2126, 0.7152, 0.0722));
            assert!(light(1.0) > 1.5 * light(0.0) && light(0.5) > light(0.0));
        }
    }
}
