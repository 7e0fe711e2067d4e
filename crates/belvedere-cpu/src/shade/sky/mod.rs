//! Sky and haze, dithered (Bayer 1973).

mod clouds;
mod row;

use crate::screen::SUB;
use crate::simd::nearest;
use belvedere_composite::color::{PIXELS, Rgb, linear, smoothstep};
use belvedere_composite::tint::GroundTint;
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole};
use belvedere_scene::{Color, Haze, Light, Scene, Sky as Choice, TerrainLayer, Unit};
use clouds::Clouds;

/// Thresholds of ordered dithering, 8 x 8 (Bayer 1973), each 0..64 once.
const BAYER: [[u8; 8]; 8] = [
    [0, 32, 8, 40, 2, 34, 10, 42],
    [48, 16, 56, 24, 50, 18, 58, 26],
    [12, 44, 4, 36, 14, 46, 6, 38],
    [60, 28, 52, 20, 62, 30, 54, 22],
    [3, 35, 11, 43, 1, 33, 9, 41],
    [51, 19, 59, 27, 49, 17, 57, 25],
    [15, 47, 7, 39, 13, 45, 5, 37],
    [63, 31, 55, 23, 61, 29, 53, 21],
];

/// Offsets that dithering adds to square roots of linear light, row by row.
const THRESHOLDS: [f32; 64] = {
    let mut out = [0.0; 64];
    let mut i = 0;
    while i < 64 {
        out[i] = ((BAYER[i / 8][i % 8] as f32 + 0.5) / 64.0 - 0.5) / 255.0;
        i += 1;
    }
    out
};

/// Bound on the absolute value of these offsets.
const HALF_A_STEP: f32 = 0.5 / 255.0;

/// Samples that are coloured together.
pub(crate) const LANES: usize = 32;

/// Number of ends of the rows of [`LANES`] pixels that are stored together.
const POINTS: usize = PIXELS / LANES + 1;

/// Largest deviation of a row of samples from a line between its ends for interpolation along it, in square roots of colours: less than
/// half a step of an 8-bit picture.
const EVEN: f32 = 0.4 / 255.0;

/// Largest share of haze in a colour.
const THICKEST: f32 = 0.40;

/// Downward components of the direction of view between which haze fades out: a map seen from above has none.
const FROM_ABOVE: [f32; 2] = [0.77, 0.985];

/// Visible depth of small models, scene units: none has haze up to the first, all have theirs from the second on.
const SMALL: [f32; 2] = [100.0, 500.0];

/// The same in a studio, and its backdrop: above, in the middle, below.
const THICKEST_IN_STUDIO: f32 = 0.32;
const STUDIO: [[u8; 3]; 3] = [[252, 252, 251], [243, 245, 246], [222, 228, 234]];

/// A clear day, at the zenith, in the middle, at the horizon and below it.
const DAY: [[u8; 3]; 4] = [[62, 118, 196], [134, 180, 222], [212, 227, 239], [204, 219, 232]];

/// Skies after sunset and at night, and their haze; the sun stands lower than this by night.
const DUSK: [[u8; 3]; 4] = [[86, 104, 150], [150, 146, 172], [243, 208, 170], [206, 184, 170]];
const DUSK_HAZE: [u8; 3] = [214, 194, 184];
const NIGHT: [[u8; 3]; 4] = [[14, 20, 40], [24, 34, 62], [62, 76, 108], [38, 47, 70]];
const NIGHT_HAZE: [u8; 3] = [58, 72, 104];
const NIGHT_DEG: f64 = 6.0;

/// Steps of the table of sky colours per unit of the sine of the elevation.
const SHADES: f32 = 512.0;
/// Last position in it.
const LAST: f32 = 2.0 * SHADES - 0.01;

/// Colours of the air.
#[derive(Debug)]
pub(crate) struct Sky {
    /// Square roots of linear colours, by the rise of rays from -1 to 1, and the differences to the next entry; the fourth value
    /// is the summed change of these differences up to the entry.
    steps: Box<[[[f32; 4]; 2]; 2 * SHADES as usize]>,
    haze: Rgb,
    clouds: Option<Clouds>,
    /// Eastward, northward and upward parts of the ray of a pixel, see [`Sky::part`].
    east: [f32; 3],
    north: [f32; 3],
    up: [f32; 3],
    center: [f32; 2],
    per_px: f32,
    /// Depth at which haze begins, and its increase per scene unit.
    haze_from: f32,
    haze_per: f32,
    /// Largest share of haze in a colour: 0 in parallel projection, which has no eye point, and 0 straight down.
    thickest: f32,
    /// Haze by distance instead: optical depth per scene unit; 0 = not.
    per_depth: f32,
    /// 1 with dithering, 0 for one plain colour.
    dither: f32,
    stretch: Stretch,
}

/// How the sky of a picture spans its colours: from the skyline to the top of the picture, however far down the view looks.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    /// Elevation of the farthest ground.
    skyline: f32,
    gain: f32,
}

/// Elevation whose colour the top of a picture has at least, and least part of the picture's height over which the sky changes.
const AT_TOP: f32 = 0.42;
const LEAST_PART: f64 = 0.16;

impl Stretch {
    /// * `ground`: bounds of all ground.
    fn new(ground: &Aabb, pinhole: &Pinhole) -> Self {
        let row = |y: f64| pinhole.forward.z + pinhole.down.z * (y - pinhole.center_px().y) / pinhole.scale_px();
        let level = pinhole.forward.truncate().length();
        if ground.is_empty() || pinhole.is_orthographic() || level < 0.05 {
            return Self { skyline: 0.0, gain: 1.0 };
        }
        let top = row(0.0);
        // Bent rays lift ground over the skyline of straight ones.
        let depth = |p: DVec3| (p - pinhole.eye).dot(pinhole.forward);
        let far = ground.corners().into_iter().map(depth).fold(1e-3, f64::max);
        let skyline = ((ground.max.z - pinhole.eye.z) / far).min(0.0);
        let skyline = skyline.min(row(LEAST_PART * f64::from(pinhole.image[1])));
        Self { skyline: skyline as f32, gain: (AT_TOP / (top - skyline).max(1e-3) as f32).max(1.0) }
    }

    /// The elevation whose colour is shown at another.
    fn of(self, rise: f32) -> f32 {
        ((rise - self.skyline) * self.gain).min(1.0)
    }
}

impl Sky {
    /// * `bounds`: bounds of the scene.
    pub(crate) fn new(bounds: &Aabb, pinhole: &Pinhole) -> Self {
        let depths = if bounds.is_empty() {
            [0.0, 1.0]
        } else {
            let depth = |p: DVec3| (p - pinhole.eye).dot(pinhole.forward);
            let near = depth(pinhole.eye.clamp(bounds.min, bounds.max)).max(0.0);
            let far = bounds.corners().into_iter().map(depth).fold(near, f64::max);
            [near as f32, far as f32]
        };
        let (center, scale) = (pinhole.center_px(), pinhole.scale_px());
        let per_px = if pinhole.is_orthographic() { 0.0 } else { 1.0 / scale };
        // Nearest and farthest depth of the scene, whose nearer part has full contrast.
        let [near, far]: [f32; 2] = depths;
        let span = (far - near).max(1e-6);
        let parts = |of: fn(DVec3) -> f64| [pinhole.forward, pinhole.right, pinhole.down].map(|axis| of(axis) as f32);
        let from_above = smoothstep(FROM_ABOVE[0], FROM_ABOVE[1], -pinhole.forward.z as f32);
        Self {
            steps: steps(towards),
            haze: linear([184, 206, 230]),
            clouds: None,
            east: parts(|axis| axis.x),
            north: parts(|axis| axis.y),
            up: parts(|axis| axis.z),
            center: [center.x as f32, center.y as f32],
            per_px: per_px as f32,
            haze_from: near + 0.22 * span,
            haze_per: 1.0 / ((1.15 - 0.22) * span),
            thickest: if pinhole.is_orthographic() {
                0.0
            } else {
                THICKEST * (1.0 - from_above) * smoothstep(SMALL[0], SMALL[1], span)
            },
            per_depth: 0.0,
            dither: 1.0,
            stretch: Stretch { skyline: 0.0, gain: 1.0 },
        }
    }

    /// Sky and haze over a scene; a light studio behind molecules and other scenes without landscape.
    pub(crate) fn of(scene: &Scene, light: &Light, pinhole: &Pinhole) -> Self {
        let sky = Self::outside(scene, light, pinhole);
        match light.haze {
            Haze::Auto => sky,
            Haze::None => Self { thickest: 0.0, ..sky },
            // Koschmieder 1924: the contrast of a black thing falls to 2 % at the visibility.
            Haze::Visibility(length) if !pinhole.is_orthographic() => {
                let per_depth = 3.912 / length * dense_part(scene, pinhole);
                Self { thickest: 1.0, per_depth: per_depth as f32, ..sky }
            }
            Haze::Visibility(_) => Self { thickest: 0.0, ..sky },
        }
    }

    fn outside(scene: &Scene, light: &Light, pinhole: &Pinhole) -> Self {
        let mut sky = Self::new(&scene.bounds(), pinhole);
        let ground = scene.layers.iter().filter_map(|layer| layer.kind.terrain());
        let ground = ground.fold(Aabb::EMPTY, |all, terrain| all.union(terrain.heightfield.bounds()));
        sky.stretch = Stretch::new(&ground, pinhole);
        let beyond = scene.layers.iter().find_map(|layer| layer.kind.terrain()).map(color_of);
        let over = |air, stretch: Stretch| {
            let colors = beyond.map_or_else(|| tones(air), |ground| with_land(tones(air), ground));
            steps(|rise| of_air(&colors, stretch.of(rise)))
        };
        let clouds = |air: &[[u8; 3]; 4]| Clouds::new(light.clouds, tones(air)[2]);
        let is_landscape = scene.unit == Unit::Metre || scene.terrain().is_some();
        let shown = match light.sky {
            Choice::Auto if is_landscape => match light.altitude.to_degrees() {
                altitude if altitude < -NIGHT_DEG => Choice::Night,
                altitude if altitude < NIGHT_DEG => Choice::Dusk,
                _ => Choice::Day,
            },
            shown => shown,
        };
        // A studio dims what is far by its own measure.
        let thickest = if pinhole.is_orthographic() { 0.0 } else { THICKEST_IN_STUDIO };
        let air = if is_landscape { sky } else { Self { haze: linear(STUDIO[1]), thickest, ..sky } };
        match shown {
            // The gradient of a studio is fixed to the picture, for every direction of the camera.
            Choice::Auto => Self { steps: steps(studio), up: [0.0, 0.0, -1.0], ..air },
            Choice::Day => Self { steps: over(&DAY, air.stretch), clouds: clouds(&DAY), ..air },
            Choice::Dusk => {
                Self { steps: over(&DUSK, air.stretch), clouds: clouds(&DUSK), haze: linear(DUSK_HAZE), ..air }
            }
            Choice::Night => {
                Self { steps: over(&NIGHT, air.stretch), clouds: clouds(&NIGHT), haze: linear(NIGHT_HAZE), ..air }
            }
            Choice::Plain(_) | Choice::Transparent => {
                let color = if let Choice::Plain(color) = shown { color } else { Color::rgb(255, 255, 255) };
                let plain = linear([color.r, color.g, color.b]);
                Self { steps: steps(|_| plain), dither: 0.0, ..air }
            }
        }
    }

    /// Sine of the elevation of the straight ray of a pixel.
    #[inline(always)]
    pub(crate) fn sine(&self, [x, y]: [f32; 2]) -> f32 {
        let (x, y) = ((x - self.center[0]) * self.per_px, (y - self.center[1]) * self.per_px);
        (self.up[0] + self.up[1] * x + self.up[2] * y) / (1.0 + x * x + y * y).sqrt()
    }

    /// Rise of the straight ray of a pixel for each unit forward: linear on the picture, so that colours lie in level bands.
    #[inline(always)]
    fn rise(&self, pixel: [f32; 2]) -> f32 {
        self.part(&self.up, pixel)
    }

    /// A part of the straight ray of a pixel for each unit forward.
    #[inline(always)]
    fn part(&self, along: &[f32; 3], [x, y]: [f32; 2]) -> f32 {
        let (x, y) = ((x - self.center[0]) * self.per_px, (y - self.center[1]) * self.per_px);
        along[0] + along[1] * x + along[2] * y
    }

    /// Square root of the colour of a pixel with its clouds, of that without them.
    #[inline]
    fn clouded(&self, root: Rgb, pixel: [f32; 2]) -> Rgb {
        let Some(clouds) = &self.clouds else { return root };
        let ahead = [self.part(&self.east, pixel), self.part(&self.north, pixel)];
        clouds.over(root, ahead, self.stretch.of(self.rise(pixel)))
    }

    /// Sky in the direction of a pixel, dithered by one step of an 8-bit picture against banding.
    #[inline]
    pub(crate) fn at(&self, pixel: [f32; 2]) -> Rgb {
        let [x, y] = pixel.map(|v| v.max(0.0) as usize % 8);
        // Square roots of linear light are nearly even in 8-bit steps.
        let root = self.clouded(self.root(self.rise(pixel)), pixel) + Rgb::splat(self.dither * THRESHOLDS[8 * y + x]);
        root * root
    }

    /// Square roots of [`Sky::at`] for many points, fixed-point steps.
    #[inline(always)]
    pub(crate) fn paint(&self, x: &[i32], y: &[i32], [red, green, blue]: [&mut [f32]; 3]) {
        debug_assert!(x.len() == y.len() && x.len() == red.len());
        let chunks = red.chunks_mut(LANES).zip(green.chunks_mut(LANES)).zip(blue.chunks_mut(LANES));
        let mut end = None;
        for ((x, y), ((red, green), blue)) in x.chunks(LANES).zip(y.chunks(LANES)).zip(chunks) {
            let out = [red, green, blue];
            let line = match (x.first_chunk(), y.first_chunk()) {
                (Some(x), Some(y)) if is_row(x, y) => self.line(x[0], y[0], &mut end),
                _ => None,
            };
            match line {
                Some(line) => line.paint(&self.thresholds(x[0], y[0]), out),
                None => self.paint_each(x, y, out),
            }
        }
    }

    /// Line of colours along a row of [`LANES`] pixels; `None` if they are not nearly linear.
    /// * `end`: end point of the last row, if known.
    #[inline(always)]
    pub(crate) fn line(&self, x: i32, y: i32, end: &mut Option<(i32, SkyPoint)>) -> Option<Line> {
        // No closures: they would be compiled separately, for the oldest processors.
        let next = x + LANES as i32 * SUB;
        let from = match *end {
            Some((at, point)) if at == x => point,
            _ => self.root_at(self.table_position([x, y])),
        };
        let to = self.root_at(self.table_position([next, y]));
        *end = Some((next, to));
        if self.clouds.is_some() { None } else { from.line_to(&to) }
    }

    /// Table entries at points of a row, [`LANES`] pixels apart.
    #[inline(always)]
    pub(crate) fn points(&self, x: i32, y: i32) -> [SkyPoint; POINTS] {
        let mut at = [0.0; POINTS.next_power_of_two()];
        for (i, at) in at.iter_mut().enumerate() {
            *at = self.table_position([x + i as i32 * LANES as i32 * SUB, y]);
        }
        let mut out = [SkyPoint { at: 0.0, root: [0.0; 4] }; POINTS];
        for (out, at) in out.iter_mut().zip(at) {
            *out = self.root_at(at);
        }
        out
    }

    /// Table entry at a position.
    #[inline(always)]
    fn root_at(&self, at: f32) -> SkyPoint {
        // Positions are not negative, so the cast rounds down.
        let below = at as i32;
        let ([low, change], share) = (&self.steps[below as usize & (2 * SHADES as usize - 1)], at - below as f32);
        let mut root = [0.0; 4];
        for k in 0..4 {
            root[k] = low[k] + share * change[k];
        }
        SkyPoint { at, root }
    }

    /// Position of a sample in the table.
    #[inline(always)]
    fn table_position(&self, [x, y]: [i32; 2]) -> f32 {
        let at = (self.rise([x as f32 * (1.0 / SUB as f32), y as f32 * (1.0 / SUB as f32)]) + 1.0) * SHADES;
        let at = if at > 0.0 { at } else { 0.0 };
        if at < LAST { at } else { LAST }
    }

    #[inline(always)]
    pub(crate) fn paint_each(&self, x: &[i32], y: &[i32], out: [&mut [f32]; 3]) {
        let (mut px, mut py) = ([0; LANES], [0; LANES]);
        px[..x.len()].copy_from_slice(x);
        py[..y.len()].copy_from_slice(y);
        let (mut below, mut share, mut threshold) = ([0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let at = self.table_position([px[i], py[i]]);
            // On an entry of the table either neighbour gives the same colour.
            below[i] = nearest(at - 0.5);
            share[i] = at - below[i] as f32;
        }
        for i in 0..LANES {
            threshold[i] = self.dither * THRESHOLDS[((py[i] >> 5) & 56 | (px[i] >> 8) & 7) as usize];
        }
        let mut root = [[0.0f32; 4]; LANES];
        for i in 0..LANES {
            let [low, change] = &self.steps[below[i] as usize & (2 * SHADES as usize - 1)];
            for k in 0..4 {
                root[i][k] = low[k] + share[i] * change[k];
            }
        }
        if self.clouds.is_some() {
            for i in 0..x.len() {
                let at = [x[i], y[i]].map(|v| v as f32 * (1.0 / SUB as f32));
                let [r, g, b, _] = root[i];
                root[i] = self.clouded(Rgb::new(r, g, b), at).extend(0.0).to_array();
            }
        }
        for (k, out) in out.into_iter().enumerate() {
            let mut plane = [0.0; LANES];
            for i in 0..LANES {
                plane[i] = root[i][k] + threshold[i];
            }
            out.copy_from_slice(&plane[..out.len()]);
        }
    }

    /// Sky at an elevation, given its sine, as water mirrors it: a plain one is paper behind the picture, and a clear day is mirrored.
    pub(crate) fn towards(&self, sine: f32) -> Rgb {
        if self.dither == 0.0 {
            return towards(sine);
        }
        let root = self.root(self.stretch.skyline + sine / self.stretch.gain);
        root * root
    }

    #[inline]
    fn root(&self, sine: f32) -> Rgb {
        let at = ((sine + 1.0) * SHADES).clamp(0.0, LAST);
        let [low, change] = self.steps[at as usize].map(|[r, g, b, _]| Rgb::new(r, g, b));
        low + at.fract() * change
    }

    /// Share of haze in a colour at `depth`: none in the nearer part of the scene, then slowly more.
    #[inline(always)]
    pub(crate) fn haze_at(&self, depth: f32) -> f32 {
        if self.per_depth > 0.0 {
            let t = if depth > 0.0 { 0.25 * self.per_depth * depth } else { 0.0 };
            // exp(-4 t) within 0.05 %, without a branch.
            let quarter = 1.0 / (1.0 + t * (1.0 + t * (0.48 + t * 0.235)));
            let half = quarter * quarter;
            return 1.0 - half * half;
        }
        let t = (depth - self.haze_from) * self.haze_per;
        let t = if t > 0.0 { t } else { 0.0 };
        let t = if t < 1.0 { t } else { 1.0 };
        self.thickest * t * t * (3.0 - 2.0 * t)
    }

    /// Linear colour of the haze.
    pub(crate) fn haze(&self) -> Rgb {
        self.haze
    }

    /// `color` seen through the air at `depth`.
    pub(crate) fn through_air(&self, color: Rgb, depth: f32) -> Rgb {
        color.lerp(self.haze, self.haze_at(depth))
    }
}

/// Height over which air thins to the share 1 / e of its dust and vapour, metres.
const DENSE_M: f64 = 1500.0;

/// Part of the way from the eye to the ground that its air counts as that near the ground, 0..=1: a stated visibility is that of air near
/// the ground, which thins exponentially with height, so that ground seen from far above is not hazy.
fn dense_part(scene: &Scene, pinhole: &Pinhole) -> f64 {
    let Some(ground) = scene.terrain() else { return 1.0 };
    let [low, high] = ground.z_range();
    let thinned = (pinhole.eye.z - 0.5 * (low + high)) / DENSE_M;
    if thinned > 1e-3 { -(-thinned).exp_m1() / thinned } else { 1.0 }
}

/// A point in the table of colours, and square roots of the colour there.
#[derive(Clone, Copy)]
pub(crate) struct SkyPoint {
    at: f32,
    root: [f32; 4],
}

impl SkyPoint {
    /// The line of colours to a point [`LANES`] pixels further; `None` if they are not nearly linear.
    #[inline(always)]
    pub(crate) fn line_to(&self, to: &Self) -> Option<Line> {
        let mut change = [0.0; 4];
        for (k, change) in change.iter_mut().enumerate() {
            *change = (to.root[k] - self.root[k]) * (1.0 / LANES as f32);
        }
        // Bound on the distance from the chord of a line with this summed change of slope.
        let off = 0.25 * ((to.at - self.at).abs() + 1.0) * (to.root[3] - self.root[3]).abs();
        (off <= EVEN).then_some(Line { from: self.root, change })
    }
}

/// Square roots of colours along a row of pixels.
pub(crate) struct Line {
    from: [f32; 4],
    change: [f32; 4],
}

impl Line {
    /// Range of the values that [`Line::paint`] writes.
    #[inline(always)]
    pub(crate) fn ends(&self) -> [[f32; 2]; 3] {
        let mut out = [[0.0; 2]; 3];
        for (k, out) in out.iter_mut().enumerate() {
            let (from, to) = (self.from[k], self.from[k] + (LANES - 1) as f32 * self.change[k]);
            *out =
                if from < to { [from - HALF_A_STEP, to + HALF_A_STEP] } else { [to - HALF_A_STEP, from + HALF_A_STEP] };
        }
        out
    }

    /// * `threshold`: see [`thresholds`].
    #[inline(always)]
    pub(crate) fn paint(&self, threshold: &[f32; LANES], out: [&mut [f32]; 3]) {
        for (k, out) in out.into_iter().enumerate() {
            let Some(out) = out.first_chunk_mut::<LANES>() else { return };
            for i in 0..LANES {
                out[i] = (self.from[k] + i as f32 * self.change[k]) + threshold[i];
            }
        }
    }
}

impl Sky {
    /// Offsets that dithering adds to a row of pixels.
    /// * `x`, `y`: first sample, fixed-point steps.
    #[inline(always)]
    pub(crate) fn thresholds(&self, x: i32, y: i32) -> [f32; LANES] {
        let row = &THRESHOLDS[((y >> 5) & 56) as usize..][..8];
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = self.dither * row[((x >> 8) as usize + i) & 7];
        }
        out
    }
}

/// Whether samples are those of neighbouring pixels of a row.
#[inline(always)]
fn is_row(x: &[i32; LANES], y: &[i32; LANES]) -> bool {
    let mut off = 0;
    for i in 0..LANES {
        off |= (x[i] - x[0] - i as i32 * SUB) | (y[i] - y[0]);
    }
    off == 0
}

fn steps(towards: impl Fn(f32) -> Rgb) -> Box<[[[f32; 4]; 2]; 2 * SHADES as usize]> {
    let at = |i: usize| roots(towards(i as f32 / SHADES - 1.0));
    let (mut next, mut before, mut turned) = (at(0), Rgb::ZERO, 0.0);
    Box::new(std::array::from_fn(|i| {
        let here = std::mem::replace(&mut next, at(i + 1));
        let change = next - here;
        let turn = if i == 0 { 0.0 } else { (change - before).abs().max_element() };
        before = change;
        turned += turn;
        [here.extend(turned - turn), change.extend(turn)].map(|v| v.to_array())
    }))
}

fn roots(c: Rgb) -> Rgb {
    Rgb::from_array(c.to_array().map(f32::sqrt))
}

/// The clear sky at an elevation, given its sine, linear.
fn towards(sine: f32) -> Rgb {
    of_air(&tones(&DAY), sine)
}

fn tones(air: &[[u8; 3]; 4]) -> [Rgb; 4] {
    air.map(linear)
}

/// Air over ground: what lies below the horizon beside the data is a plain in a tone of the ground, of this lightness and this share of its
/// colour, without any form.
fn with_land([zenith, middle, horizon, below]: [Rgb; 4], ground: Rgb) -> [Rgb; 4] {
    const LIGHTNESS: f32 = 0.62;
    const OF_GROUND: f32 = 0.6;
    let scale = LIGHTNESS * luminance(below) / luminance(ground).max(1e-3);
    [zenith, middle, horizon, below.lerp(ground * scale, OF_GROUND)]
}

fn luminance(c: Rgb) -> f32 {
    c.dot(Rgb::new(0.2126, 0.7152, 0.0722))
}

/// Colour of the level ground of a layer that is as high as its lower quarter, linear.
fn color_of(terrain: &TerrainLayer) -> Rgb {
    let [low, high] = terrain.heightfield.z_range();
    let tint = GroundTint::new(&terrain.palette, [low, high]);
    Rgb::from_array(tint.color(0.75 * low + 0.25 * high, DVec2::ZERO))
}

/// Depth below the horizon, in units of [`of_air`], at which the plain beside the data has half left the colour of the horizon.
const PLAIN: f32 = 0.4;

/// The sky of air with these colours at the zenith, in the middle, at the horizon and below it.
fn of_air(&[zenith, middle, horizon, below]: &[Rgb; 4], sine: f32) -> Rgb {
    if sine < 0.0 {
        return below.lerp(horizon, PLAIN / (PLAIN - sine));
    }
    let low = 1.0 - (-sine / 0.10).exp();
    let high = smoothstep(0.0, 0.7, sine);
    horizon.lerp(middle, low).lerp(zenith, high)
}

/// The backdrop of a studio by the sine of the angle over the middle of the picture, linear.
fn studio(sine: f32) -> Rgb {
    let [above, middle, below] = STUDIO.map(linear);
    if sine > 0.0 {
        middle.lerp(above, smoothstep(0.0, 0.35, sine))
    } else {
        middle.lerp(below, smoothstep(0.0, 0.35, -sine))
    }
}

#[cfg(test)]
mod tests;
