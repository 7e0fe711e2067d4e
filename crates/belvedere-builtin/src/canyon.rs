//! A river in a winding canyon.

use super::noise::Noise;
use super::viewpoint::{Viewpoint, best_viewpoint};
use super::{BuiltinError, SuggestedCamera, ground_layer, line_layer};
use belvedere_core::DVec2;
use belvedere_scene::{Crs, Heightfield, LineFeature, NodeState, PaletteName, Scene, Unit, drape_polyline};
use rayon::prelude::*;

/// Nodes per side and their distance, metres.
const NODES: usize = 513;
const SPACING_M: f64 = 25.0;
/// Height of the river at its mouth in the south, metres, and its rise per metre to the north.
const MOUTH_M: f64 = 720.0;
const FALL: f64 = 0.002;
/// Length of a meander, and its amplitude to each side, metres.
const MEANDER_M: f64 = 4_300.0;
const SWING_M: f64 = 900.0;
/// Walls and benches: distance from the river, height over it, metres; linear in between.
const STRATA: [[f64; 2]; 11] = [
    [0.0, 0.0],
    [45.0, 0.0],
    [210.0, 230.0],
    [430.0, 270.0],
    [520.0, 400.0],
    [900.0, 450.0],
    [980.0, 590.0],
    [1_300.0, 660.0],
    [1_440.0, 860.0],
    [1_900.0, 905.0],
    [4_000.0, 960.0],
];
/// Side canyons: direction (east, north) and length, metres.
const SIDES: [([f64; 2], f64); 6] = [
    ([0.83, 0.55], 3_600.0),
    ([-0.77, 0.64], 3_900.0),
    ([0.92, -0.39], 3_200.0),
    ([-0.94, -0.34], 3_500.0),
    ([0.70, 0.71], 3_000.0),
    ([-0.60, 0.80], 3_300.0),
];

/// A canyon of 12.8 km by 12.8 km, 960 m deep, with walls and benches and six side canyons.
///
/// Layers: `ground` and `river` (must be seen), which winds from north to south. The suggested camera sees less than half of it. The
/// same seed gives the same bytes on every platform.
///
/// # Errors
/// [`BuiltinError::Heightfield`], which does not occur in practice.
///
/// Source: ours.
pub fn canyon(seed: u64) -> Result<(Scene, SuggestedCamera), BuiltinError> {
    let land = Land::new(seed);
    let half = 0.5 * SPACING_M * (NODES - 1) as f64;
    let place = |i: usize| DVec2::new((i % NODES) as f64 * SPACING_M - half, half - (i / NODES) as f64 * SPACING_M);
    let heights = (0..NODES * NODES).into_par_iter().map(|i| land.height(place(i)) as f32).collect();
    let states = vec![NodeState::Measured; NODES * NODES];
    let corner = DVec2::new(-half, half);
    let terrain = Heightfield::new(corner, DVec2::splat(SPACING_M), NODES, NODES, heights, states)?;
    let river: Vec<DVec2> = (0..=640)
        .map(|k| half - f64::from(k) * 20.0)
        .map(|y| DVec2::new(land.river(y), y.clamp(-half, half)))
        .collect();
    let points = drape_polyline(&terrain, &river).parts.into_iter().max_by_key(Vec::len).unwrap_or_default();
    let Viewpoint { eye, look_at } = best_viewpoint(&terrain, &[], &points, &[0.02, 0.04, 0.065], 0.28);
    let title = format!("Canyon {seed}: a river between its walls");
    let layers = vec![
        ground_layer(terrain, PaletteName::Desert.into()),
        line_layer("river", LineFeature { style: None, name: "River".into(), points }),
    ];
    let camera = SuggestedCamera { title: title.clone(), eye, look_at, fov_y: 45f64.to_radians() };
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Metre, layers, ..Scene::default() }, camera))
}

/// A wave of period 1 between -1 and 1, of parabolas: sines differ between platforms in the last bit.
fn wave(t: f64) -> f64 {
    let t = t - t.floor();
    if t < 0.5 { 16.0 * t * (0.5 - t) } else { -16.0 * (t - 0.5) * (1.0 - t) }
}

fn profile(distance: f64) -> f64 {
    let last = STRATA[STRATA.len() - 1];
    STRATA.windows(2).find(|w| distance < w[1][0]).map_or(last[1], |w| {
        let share = (distance - w[0][0]) / (w[1][0] - w[0][0]);
        w[0][1] + share.max(0.0) * (w[1][1] - w[0][1])
    })
}

struct Land {
    noise: Noise,
    phase: f64,
    sides: Vec<Side>,
}

/// A side canyon that rises from the river, straight but for noise.
struct Side {
    from: DVec2,
    along: DVec2,
    length: f64,
}

impl Land {
    fn new(seed: u64) -> Self {
        let mut land =
            Self { noise: Noise::new(seed ^ 0x6361_6e79), phase: 0.13 * (seed % 64) as f64, sides: Vec::new() };
        let sides = SIDES.iter().enumerate().map(|(k, (along, length))| {
            let y = 5_200.0 - 1_950.0 * k as f64;
            Side { from: DVec2::new(land.river(y), y), along: DVec2::from_array(*along).normalize(), length: *length }
        });
        land.sides = sides.collect();
        land
    }

    /// x of the river at `y`, metres.
    fn river(&self, y: f64) -> f64 {
        let swing = SWING_M * (1.0 + 0.35 * self.noise.at(DVec2::new(y / 3_100.0, 7.5)));
        swing * wave(y / MEANDER_M + self.phase) + 260.0 * self.noise.at(DVec2::new(y / 2_300.0, 0.5))
    }

    /// Distance of `p` from the river, metres.
    fn river_distance(&self, p: DVec2) -> f64 {
        // Nearest point of the river, by three passes with ever smaller steps.
        let (mut best, mut at) = (f64::INFINITY, p.y);
        for (step, reach) in [(150i32, 14i32), (30, 5), (6, 5)] {
            let middle = at;
            for k in -reach..=reach {
                let y = middle + f64::from(k * step);
                let d = DVec2::new(self.river(y), y).distance_squared(p);
                if d < best {
                    (best, at) = (d, y);
                }
            }
        }
        best.sqrt()
    }

    fn height(&self, p: DVec2) -> f64 {
        let rough = self.noise.fbm(p / 1_500.0, 4);
        // Gullies: walls come forward and step back.
        let gullies = self.noise.ridged(p / 620.0, 3);
        let bend = |d: f64| d * (1.0 + 0.42 * rough) - (d / (d + 250.0)) * 330.0 * (gullies - 0.55);
        let mut over = profile(bend(self.river_distance(p)).max(0.0));
        for side in &self.sides {
            over = over.min(side.height(self, p, &bend));
        }
        let plateau = over / 960.0;
        let cover = plateau * (26.0 * self.noise.fbm(p / 420.0, 3) + 60.0 * self.noise.at(p / 2_900.0));
        MOUTH_M + FALL * (p.y + 6_400.0) + over + cover
    }
}

impl Side {
    /// Height over the river of this canyon's own walls and floor.
    fn height(&self, land: &Land, p: DVec2, bend: &impl Fn(f64) -> f64) -> f64 {
        let d = p - self.from;
        let along = d.dot(self.along);
        let winding = 240.0 * land.noise.at(DVec2::new(along / 1_100.0, self.from.y / 700.0));
        let across = (d.perp_dot(self.along) + winding * (along / 600.0).clamp(0.0, 1.0)).abs();
        let head = (along / self.length).max(0.0);
        let off = across * (1.25 + 0.5 * head) + (along - self.length).max(0.0) * 2.0 + (-along).max(0.0);
        profile(bend(off).max(0.0)) + 820.0 * head * head
    }
}
