//! Score of the look of a terrain picture: rules of panorama painters that can be measured on its pixels.
//!
//! Sources of the rules: Imhof 1965, Patterson 2000 and 2005, Jenny, Jenny and Hurni 2010, and readings of painted panoramas; the bounds are
//! ours. Colours are compared in CIELAB under D65.

use belvedere_composite::color::{Rgb, linear};
use belvedere_core::View;
use belvedere_scene::{Frame, Scene};
use schemars::JsonSchema;
use serde::Serialize;

/// Most pixels that are looked at.
const MOST: usize = 120_000;
/// Chroma from which on a colour has a hue.
const CHROMATIC: f32 = 6.0;
/// Columns across a picture in which the skyline is looked up.
const SKYLINE: usize = 64;

/// A rule, and how a picture keeps it.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct LookRule {
    /// What is measured, with its unit.
    pub rule: &'static str,
    /// Its value in the picture.
    pub value: f64,
    /// Least and largest value of a good picture; `None` = no limit.
    pub bounds: [Option<f64>; 2],
    /// Whether the value lies within.
    pub holds: bool,
    /// What mends it.
    pub mend: &'static str,
}

/// How a terrain picture keeps the rules.
#[derive(Debug, Clone, PartialEq, JsonSchema, Serialize)]
pub struct LookScore {
    /// Rules that hold.
    pub held: usize,
    /// Rules that were measured: those of skies, hues and subjects need some.
    pub measured: usize,
    /// The rules.
    pub rules: Vec<LookRule>,
}

impl LookScore {
    /// The score of a picture; `None` where it shows no terrain.
    pub fn of(frame: &Frame, scene: &Scene, view: &View) -> Option<Self> {
        let is_ground = |id: u32| {
            let layer = (id as usize).checked_sub(1).and_then(|i| scene.layers.get(i));
            layer.is_some_and(|layer| layer.kind.terrain().is_some() || layer.kind.areas().is_some())
        };
        let seen = Seen::new(frame, &is_ground)?;
        let mut rules = seen.of_ground();
        rules.extend(seen.of_sky(frame));
        rules.extend(commonest(frame));
        rules.extend(subject(scene, view, frame.width));
        let held = rules.iter().filter(|rule| rule.holds).count();
        Some(Self { held, measured: rules.len(), rules })
    }
}

fn rule(rule: &'static str, value: f64, bounds: [Option<f64>; 2], mend: &'static str) -> LookRule {
    let value = (value * 1000.0).round() / 1000.0;
    let holds = bounds[0].is_none_or(|low| value >= low) && bounds[1].is_none_or(|high| value <= high);
    LookRule { rule, value, bounds, holds, mend }
}

/// Pixels of ground on a grid over a picture.
struct Seen {
    /// Luma in 0..=255, CIELAB, saturation, whether it is burnt out, and the change to the right.
    ground: Vec<Pixel>,
    /// Mean change from pixel to pixel of the middle and the lower third of the rows.
    energy: [f64; 2],
    /// First row of ground of columns.
    skyline: Vec<Option<usize>>,
    size: [usize; 2],
}

struct Pixel {
    luma: f32,
    lab: Rgb,
    saturation: f32,
    burnt: bool,
}

impl Seen {
    fn new(frame: &Frame, is_ground: &dyn Fn(u32) -> bool) -> Option<Self> {
        let (width, height) = (frame.width, frame.height);
        (frame.color.len() == width * height && frame.id.len() == width * height).then_some(())?;
        let step = ((width * height) as f64 / MOST as f64).sqrt().ceil().max(1.0) as usize;
        let mut ground = Vec::new();
        let mut sums = [(0.0, 0usize); 2];
        for y in (0..height).step_by(step) {
            for x in (0..width.saturating_sub(1)).step_by(step) {
                let i = y * width + x;
                if !is_ground(frame.id[i]) {
                    continue;
                }
                ground.push(Pixel::of(frame.color[i]));
                if is_ground(frame.id[i + 1]) && 3 * y >= height {
                    let sum = &mut sums[usize::from(3 * y >= 2 * height)];
                    *sum = (sum.0 + f64::from((luma(frame.color[i]) - luma(frame.color[i + 1])).abs()), sum.1 + 1);
                }
            }
        }
        // A few pixels say nothing, and pictures that are drawn while they are written are not held.
        (ground.len() >= 500).then_some(())?;
        let first = |k: usize| {
            let x = ((2 * k + 1) * width) / (2 * SKYLINE);
            (0..height).find(|y| is_ground(frame.id[y * width + x]))
        };
        let energy = sums.map(|(sum, n)| sum / n.max(1) as f64);
        Some(Self { ground, energy, skyline: (0..SKYLINE).map(first).collect(), size: [width, height] })
    }

    fn of_ground(&self) -> Vec<LookRule> {
        let n = self.ground.len() as f64;
        let part = |of: &dyn Fn(&Pixel) -> f32, share: f64| {
            let mut values: Vec<f32> = self.ground.iter().map(of).collect();
            values.sort_by(f32::total_cmp);
            f64::from(values[((values.len() - 1) as f64 * share) as usize])
        };
        let mean = |of: &dyn Fn(&Pixel) -> f64| self.ground.iter().map(of).sum::<f64>() / n;
        let luma = |p: &Pixel| p.luma;
        let middle = mean(&|p| f64::from(p.luma));
        let deviation = mean(&|p| (f64::from(p.luma) - middle).powi(2)).sqrt();
        let mut rules = vec![
            rule(
                "range of luma of the ground, of 255",
                part(&luma, 0.995) - part(&luma, 0.005),
                [Some(150.0), None],
                "light, haze",
            ),
            rule("deviation of luma of the ground, of 255", deviation, [Some(35.0), None], "light, shadows, haze"),
            rule("L* of the darkest hundredth", part(&|p| p.lab.x, 0.01), [Some(15.0), None], "light"),
            rule(
                "share burnt out, over 250 of 255",
                mean(&|p| f64::from(u8::from(p.burnt))),
                [None, Some(0.01)],
                "light, palette",
            ),
        ];
        let colored: Vec<f64> = self.ground.iter().filter(|p| !p.is_snow()).map(|p| f64::from(p.saturation)).collect();
        // Land under snow has few colours.
        if 5 * colored.len() > 3 * self.ground.len() {
            let saturation = colored.iter().sum::<f64>() / colored.len() as f64;
            rules.push(rule("saturation, without snow", saturation, [Some(0.25), Some(0.40)], "palette"));
        }
        if let Some(spread) = self.hues() {
            rules.push(rule("spread of hues, degrees", spread, [Some(40.0), None], "palette, drape"));
        }
        let [middle, lower] = self.energy;
        if middle > 0.0 && lower > 0.0 {
            let ratio = lower / middle;
            let mend = "a farther eye; finer elevation data";
            rules.push(rule(
                "change from pixel to pixel, lower over middle third",
                ratio,
                [Some(0.9), Some(1.2)],
                mend,
            ));
        }
        rules
    }

    /// Degrees between the 3rd and the 97th hundredth of the hues around their mean; `None` where hardly anything has one.
    fn hues(&self) -> Option<f64> {
        let of: Vec<(f32, f32)> =
            self.ground.iter().map(|p| (p.lab.y, p.lab.z)).filter(|(a, b)| a.hypot(*b) > CHROMATIC).collect();
        (4 * of.len() > self.ground.len()).then_some(())?;
        let [a, b] = of.iter().fold([0.0, 0.0], |[x, y], (a, b)| [x + a / a.hypot(*b), y + b / a.hypot(*b)]);
        // Turned so that the mean hue is 0.
        let mut angles: Vec<f32> = of.iter().map(|(x, y)| (y * a - x * b).atan2(x * a + y * b).to_degrees()).collect();
        angles.sort_by(f32::total_cmp);
        let at = |share: f64| f64::from(angles[((angles.len() - 1) as f64 * share) as usize]);
        Some(at(0.97) - at(0.03))
    }

    fn of_sky(&self, frame: &Frame) -> Vec<LookRule> {
        let [width, height] = self.size;
        let rows: Vec<(f64, f64)> = self
            .skyline
            .iter()
            .enumerate()
            .filter_map(|(k, y)| y.map(|y| (k as f64 * width as f64 / SKYLINE as f64, y as f64)))
            .collect();
        let mut heights: Vec<f64> = rows.iter().map(|(_, y)| *y).collect();
        heights.sort_by(f64::total_cmp);
        let Some(sky) = heights.get(heights.len() / 2).map(|y| y / height as f64) else { return Vec::new() };
        let mut rules = vec![rule("sky, share of the height", sky, [Some(0.12), Some(0.25)], "eye and look_at")];
        if sky < 0.02 {
            return rules;
        }
        rules.push(rule("tilt of the skyline, degrees", tilt(&rows).abs(), [None, Some(2.0)], "edge, eye and look_at"));
        let column = width / 2;
        let first = frame.id.iter().skip(column).step_by(width).position(|id| *id != 0).unwrap_or(height);
        if first >= 8 {
            let lightness = |y: usize| f64::from(lab(frame.color[y * width + column]).x);
            let palest = (0..first).map(lightness).fold(0.0, f64::max);
            rules.push(rule(
                "L* of the palest sky over that of its top",
                palest - lightness(0),
                [Some(12.0), None],
                "sky",
            ));
        }
        rules
    }
}

/// Share of the picture that its commonest colour fills.
fn commonest(frame: &Frame) -> Option<LookRule> {
    // An odd step meets every place of the pattern of dithering.
    let mut colors: Vec<[u8; 3]> = frame.color.iter().copied().step_by((frame.color.len() / MOST) | 1).collect();
    colors.sort_unstable();
    let most = colors.chunk_by(|a, b| a == b).map(<[_]>::len).max()?;
    let share = most as f64 / colors.len() as f64;
    Some(rule("share of the commonest colour", share, [None, Some(0.05)], "sky, edge, palette"))
}

/// Slope of the line through points, degrees.
fn tilt(points: &[(f64, f64)]) -> f64 {
    let n = points.len().max(1) as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let (across, along) = (mean(&|p| (p.0 - x) * (p.1 - y)), mean(&|p| (p.0 - x).powi(2)));
    (across / along.max(1e-9)).atan().to_degrees()
}

/// Width of the first layer that must be seen, as a share of the picture's.
fn subject(scene: &Scene, view: &View, width: usize) -> Option<LookRule> {
    let (_, layer) = scene.must_see().next()?;
    let points = layer.kind.lines()?.features.iter().flat_map(|feature| &feature.points);
    let ends = points.filter_map(|p| view.project(*p).ok()).map(|p| p.pixel.x);
    let [from, to] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    let share = (to.min(width as f64) - from.max(0.0)) / width as f64;
    share
        .is_finite()
        .then(|| rule("subject, share of the width", share, [Some(0.6), Some(0.8)], "eye and look_at, fov"))
}

impl Pixel {
    /// Whether it is as grey and light as snow, in the light or in the shade.
    fn is_snow(&self) -> bool {
        self.saturation < 0.15 && self.luma > 120.0
    }

    fn of(color: [u8; 3]) -> Self {
        let [least, most] = [color.iter().min(), color.iter().max()].map(|v| f32::from(v.copied().unwrap_or(0)));
        Self {
            luma: luma(color),
            lab: lab(color),
            saturation: if most > 0.0 { (most - least) / most } else { 0.0 },
            burnt: least > 250.0,
        }
    }
}

fn luma([r, g, b]: [u8; 3]) -> f32 {
    0.299 * f32::from(r) + 0.587 * f32::from(g) + 0.114 * f32::from(b)
}

/// CIELAB under D65.
fn lab(color: [u8; 3]) -> Rgb {
    let c = linear(color);
    let xyz = [
        c.dot(Rgb::new(0.4124, 0.3576, 0.1805)) / 0.9505,
        c.dot(Rgb::new(0.2126, 0.7152, 0.0722)),
        c.dot(Rgb::new(0.0193, 0.1192, 0.9505)) / 1.089,
    ];
    let [x, y, z] = xyz.map(|t| if t > 0.008_856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
    Rgb::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(color: impl Fn(usize, usize) -> [u8; 3], ground_from: impl Fn(usize) -> usize) -> Frame {
        let (width, height) = (128, 96);
        let at = |i: usize| (i % width, i / width);
        Frame {
            width,
            height,
            color: (0..width * height).map(|i| color(at(i).0, at(i).1)).collect(),
            depth: vec![1.0; width * height],
            id: (0..width * height).map(|i| u32::from(at(i).1 >= ground_from(at(i).0))).collect(),
            world: None,
            stats: Default::default(),
        }
    }

    fn value(rules: &[LookRule], name: &str) -> (f64, bool) {
        let rule = rules.iter().find(|rule| rule.rule.starts_with(name)).expect("the rule");
        (rule.value, rule.holds)
    }

    #[test]
    fn figures_are_those_of_pictures_that_were_made_for_them() {
        // A sky of a fifth, aslant by 5 degrees; ground in stripes of two greys.
        let slope = 5f64.to_radians().tan();
        let made = frame(
            |x, y| {
                if y < 10 {
                    [60, 100, 180]
                } else if y < 13 {
                    [200, 220, 240]
                } else {
                    [[30; 3], [230; 3]][x / 4 % 2]
                }
            },
            |x| (19.0 + slope * (x as f64 - 64.0)) as usize,
        );
        let seen = Seen::new(&made, &|id| id == 1).expect("ground");
        let (ground, sky) = (seen.of_ground(), seen.of_sky(&made));
        let (range, deviation) = (value(&ground, "range"), value(&ground, "deviation"));
        assert!((range.0 - 200.0).abs() < 1.0 && range.1, "{range:?}");
        assert!((deviation.0 - 100.0).abs() < 3.0, "{deviation:?}");
        assert!(value(&ground, "share burnt").0 == 0.0);
        let is_there = |rules: &[LookRule], name: &str| rules.iter().any(|rule| rule.rule.starts_with(name));
        assert!(!is_there(&ground, "saturation"), "half of it is as light and grey as snow");
        assert!(!is_there(&ground, "spread"), "greys have no hue");
        let (share, tilt) = (value(&sky, "sky"), value(&sky, "tilt"));
        assert!((share.0 - 0.2).abs() < 0.02 && share.1, "{share:?}");
        assert!((tilt.0 - 5.0).abs() < 0.5 && !tilt.1, "{tilt:?}");
        assert!(value(&sky, "L* of the palest").1);
    }

    #[test]
    fn a_flat_grey_picture_keeps_few_rules() {
        let flat = frame(|_, _| [128; 3], |_| 0);
        let rules = Seen::new(&flat, &|id| id == 1).expect("ground").of_ground();
        assert!(!value(&rules, "range").1 && !value(&rules, "deviation").1);
        let green = frame(|_, _| [80, 100, 65], |_| 0);
        let rules = Seen::new(&green, &|id| id == 1).expect("ground").of_ground();
        assert_eq!(value(&rules, "saturation"), (0.35, true));
    }
}
