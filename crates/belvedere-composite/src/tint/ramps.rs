//! Hypsometric tints. The built-in ramps are ours: muted, lighter the higher for every kind of colour vision, so that they
//! also read without colour.

use super::{GroundCover, GroundNodes};
use crate::color::{Rgb, linear, nearest};
use belvedere_scene::{Palette, PaletteName, Ramp};

/// Steps of the table by height.
const STEPS: usize = 1024;
/// Colour of the ground below a translucent ramp.
pub(super) const GREY: [u8; 3] = [205, 205, 202];

/// Colours of ground by height, and those that steepness and height add.
#[derive(Debug, Clone)]
pub(super) struct RampTint {
    /// Linear colours; the last one is repeated.
    ramp: Box<[[f32; 4]; STEPS + 1]>,
    bottom_m: f32,
    per_m: f32,
    rock: Rgb,
    /// Tangents of the slopes at which rock begins and at which it covers the ground.
    rock_slope: Step,
    snow: Rgb,
    /// Heights at which snow begins and at which it covers gentle slopes, metres.
    snow_m: Step,
    snow_slope: Step,
}

pub(super) type Stops = &'static [(f32, [u8; 3])];

/// A step that no height reaches; finite, since a step between infinities is NaN.
const NEVER: [f32; 2] = [1e30, 2e30];
/// Tangents of the slopes at which snow begins to slide off and has gone.
const SNOW_SLOPE: [f32; 2] = [0.7, 1.3];

pub(super) const ALPINE: Stops = &[
    (0.0, [101, 138, 104]),
    (0.15, [121, 156, 110]),
    (0.32, [148, 174, 118]),
    (0.48, [176, 184, 128]),
    (0.62, [195, 186, 142]),
    (0.76, [205, 190, 158]),
    (0.88, [214, 203, 187]),
    (1.0, [232, 230, 228]),
];
pub(super) const DESERT: Stops = &[
    (0.0, [150, 112, 88]),
    (0.2, [178, 126, 92]),
    (0.4, [199, 150, 108]),
    (0.6, [212, 174, 130]),
    (0.8, [219, 197, 160]),
    (1.0, [226, 221, 197]),
];
pub(super) const GLACIAL: Stops = &[
    (0.0, [128, 130, 120]),
    (0.22, [150, 147, 136]),
    (0.42, [170, 167, 160]),
    (0.62, [193, 195, 196]),
    (0.82, [212, 218, 224]),
    (1.0, [228, 232, 237]),
];
/// Blue to yellow, which every kind of colour vision tells apart, in even steps of lightness.
pub(super) const CLEAR: Stops = &[
    (0.0, [70, 92, 128]),
    (0.2, [97, 119, 142]),
    (0.4, [133, 144, 145]),
    (0.6, [172, 170, 142]),
    (0.8, [212, 199, 142]),
    (1.0, [245, 233, 168]),
];
/// Not white, since slopes in the light are brighter than this and must stay below white.
const SNOW: [u8; 3] = [229, 233, 238];
const PLAIN: Stops = &[(0.0, GREY), (1.0, GREY)];
const NIGHT: Stops = &[(0.0, [38, 48, 72]), (0.5, [66, 80, 112]), (1.0, [118, 134, 168])];
/// Heights over the sea, metres.
const ATLAS: Stops = &[
    (0.0, [104, 148, 112]),
    (200.0, [130, 166, 118]),
    (500.0, [164, 186, 128]),
    (1000.0, [198, 198, 138]),
    (2000.0, [212, 200, 148]),
    (3500.0, [222, 208, 172]),
    (5000.0, [234, 226, 208]),
    (7000.0, [244, 243, 242]),
];

impl RampTint {
    /// The colours of a palette.
    ///
    /// * `z_range_m`: heights that its ramp spans.
    pub(super) fn new(palette: &Palette, z_range_m: [f64; 2]) -> Self {
        let [bottom, top] = z_range_m.map(|z| z as f32);
        let span = (top - bottom).max(1e-3);
        let name = match palette {
            Palette::Ramp(ramp) => return Self::even(from_ramp(ramp, z_range_m), GREY, z_range_m),
            // Ground that is high everywhere is rock and ice; other ground is green in its valleys.
            Palette::Named(PaletteName::Auto) if top > 5000.0 => PaletteName::Glacial,
            Palette::Named(name) | Palette::Placed(name, ..) => *name,
        };
        let built_in = |stops: Stops| (0..STEPS).map(|i| ramp_at(stops, i as f32 / (STEPS - 1) as f32)).collect();
        let even = |stops: Stops| Self::even(built_in(stops), GREY, z_range_m);
        match name {
            PaletteName::Desert => {
                let rock = (linear([148, 98, 72]), Step::new([0.7, 1.6]));
                Self { rock: rock.0, rock_slope: rock.1, ..even(DESERT) }
            }
            PaletteName::Glacial => Self {
                rock: linear([112, 106, 102]),
                rock_slope: Step::new([0.6, 1.15]),
                snow_m: Step::new([bottom + 0.42 * span, bottom + 0.62 * span]),
                ..even(GLACIAL)
            },
            PaletteName::Clear => even(CLEAR),
            PaletteName::Plain => even(PLAIN),
            PaletteName::Night => even(NIGHT),
            PaletteName::Atlas => {
                let height = |i: usize| bottom + span * i as f32 / (STEPS - 1) as f32;
                Self::even((0..STEPS).map(|i| ramp_at(ATLAS, height(i))).collect(), GREY, z_range_m)
            }
            PaletteName::Alpine
            | PaletteName::Auto
            | PaletteName::Swiss
            | PaletteName::Winter
            | PaletteName::Autumn => {
                let line = (bottom + 0.70 * span).max(2450.0);
                Self {
                    rock: linear([156, 149, 137]),
                    rock_slope: Step::new([0.66, 1.3]),
                    snow_m: Step::new([line, line + 0.14 * span.max(300.0)]),
                    ..even(ALPINE)
                }
            }
        }
    }

    /// Colours by height alone, without snow or texture.
    fn even(ramp: Vec<Rgb>, rock: [u8; 3], z_range_m: [f64; 2]) -> Self {
        let [bottom, top] = z_range_m.map(|z| z as f32);
        let span = (top - bottom).max(1e-3);
        Self {
            ramp: Box::new(std::array::from_fn(|i| ramp[i.min(STEPS - 1)].extend(0.0).to_array())),
            bottom_m: bottom,
            per_m: (STEPS - 1) as f32 / span,
            rock: linear(rock),
            rock_slope: Step::new(NEVER),
            snow: linear(SNOW),
            snow_m: Step::new(NEVER),
            snow_slope: Step::new(SNOW_SLOPE),
        }
    }

    /// Colours of nodes, linear: the tint, rock where it is steep, snow where it is high and not steep.
    #[inline(always)]
    pub(super) fn cover<const N: usize>(&self, nodes: &GroundNodes<'_, N>) -> GroundCover<N> {
        // The last index of the table lies just before its end.
        const LAST: f32 = (STEPS - 1) as f32 - 0.001;
        let (mut below, mut share, mut rock, mut snow) = ([0; N], [0.0; N], [0.0; N], [0.0; N]);
        for i in 0..N {
            let [x, y] = nodes.slope.map(|slope| slope[i]);
            let steep = (x * x + y * y).sqrt();
            let t = (nodes.height_m[i] - self.bottom_m) * self.per_m;
            let t = if t > 0.0 { t } else { 0.0 };
            let t = if t < LAST { t } else { LAST };
            // On an entry of the table either neighbour gives the same colour.
            below[i] = nearest(t - 0.5);
            share[i] = t - below[i] as f32;
            rock[i] = 0.85 * self.rock_slope.at(steep);
            snow[i] = self.snow_m.at(nodes.height_m[i]) * (1.0 - self.snow_slope.at(steep));
        }
        let mut tint = [[0.0f32; 4]; N];
        for i in 0..N {
            let k = below[i] as usize & (STEPS - 1);
            let (a, b) = (self.ramp[k], self.ramp[k + 1]);
            tint[i] = std::array::from_fn(|c| a[c] + share[i] * (b[c] - a[c]));
        }
        let (stone, white) = (self.rock.to_array(), self.snow.to_array());
        let mut color = [[0.0; N]; 3];
        for (k, out) in color.iter_mut().enumerate() {
            for i in 0..N {
                let bare = tint[i][k] + rock[i] * (stone[k] - tint[i][k]);
                out[i] = bare + snow[i] * (white[k] - bare);
            }
        }
        GroundCover::of_color(color)
    }
}

/// 0 below a value, 1 above another, smooth between.
#[derive(Debug, Clone, Copy)]
struct Step {
    from: f32,
    per: f32,
}

impl Step {
    const fn new([from, to]: [f32; 2]) -> Self {
        Self { from, per: 1.0 / (to - from) }
    }

    #[inline(always)]
    fn at(self, x: f32) -> f32 {
        let t = (x - self.from) * self.per;
        let t = if t > 0.0 { t } else { 0.0 };
        let t = if t < 1.0 { t } else { 1.0 };
        t * t * (3.0 - 2.0 * t)
    }
}

pub(super) fn ramp_at(stops: Stops, t: f32) -> Rgb {
    let i = stops.partition_point(|s| s.0 <= t).clamp(1, stops.len() - 1);
    let ((t0, a), (t1, b)) = (stops[i - 1], stops[i]);
    linear(a).lerp(linear(b), ((t - t0) / (t1 - t0)).clamp(0.0, 1.0))
}

/// The table of a ramp with colours of its own.
fn from_ramp(ramp: &Ramp, [bottom, top]: [f64; 2]) -> Vec<Rgb> {
    let stops = ramp.resolved([bottom, top]);
    let color = |i: usize| {
        let c = ramp.color_at(&stops, bottom + (top - bottom) * i as f64 / (STEPS - 1) as f64);
        linear(GREY).lerp(linear([c.r, c.g, c.b]), f32::from(c.a) / 255.0)
    };
    (0..STEPS).map(color).collect()
}
