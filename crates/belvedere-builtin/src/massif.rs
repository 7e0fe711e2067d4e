//! A mountain massif: ridged crests rising through rivers that cut into them, then ice, a lake and a trail.

use super::erosion::{Drainage, Land};
use super::lake::{Lake, dam};
use super::noise::{Noise, seeded};
use super::viewpoint::{Viewpoint, best_viewpoint};
use super::{BuiltinError, SuggestedCamera, ground_layer, line_layer};
use crate::route::{RouteCost, RouteError, Window, route_in};
use belvedere_core::DVec2;
use belvedere_scene::{
    AreaFeature, AreaLayer, AreaSurface, Color, Crs, Heightfield, HeightfieldError, Hidden, Layer, LineFeature,
    NodeState, PaletteName, Scene, Unit, drape_polyline,
};

/// Side of the massif, metres.
pub(crate) const SIDE_M: f64 = 15_360.0;
/// Height of the highest summit over the lowest valley before details, metres.
const RELIEF_M: f64 = 2_100.0;
/// Height of the valley mouths above sea level, metres.
const BASE_M: f64 = 640.0;

/// A mountain massif of 15.36 km by 15.36 km and about 2000 m of relief, on `size` x `size` nodes (513: 30 m apart).
///
/// Layers: `ground`, `lake` (water), and `trail` (must be seen), which winds from one valley past the lake over a pass into
/// another. The suggested camera sees less than half of the trail. The same seed gives the same bytes on every platform.
///
/// # Errors
/// [`BuiltinError`]: size outside 65..=2049, or a seed whose valleys do not connect (none known).
///
/// Source: ours, from published parts: ridged multifractal uplift (Musgrave 1994), stream-power erosion (Braun and Willett 2013),
/// priority flood (Barnes, Lehman and Mulla 2014), thermal erosion (Musgrave, Kolb and Mace 1989).
pub fn massif(seed: u64, size: usize) -> Result<(Scene, SuggestedCamera), BuiltinError> {
    if !(65..=2049).contains(&size) {
        return Err(BuiltinError::Size { size });
    }
    let (mut land, water) = erode(seed, size);
    let lake = dam(&mut land, &water);
    let terrain = heightfield(&land)?;
    let route = trail_route(seed, &land, &terrain, &water, lake.as_ref())
        .map_err(|source| BuiltinError::Trail { seed, source })?;
    let points = drape_polyline(&terrain, &route).parts.into_iter().max_by_key(Vec::len).unwrap_or_default();
    let Viewpoint { eye, look_at } = best_viewpoint(&terrain, &[], &points, &[0.02, 0.04, 0.065], 0.28);
    let title = format!("Massif {seed}: a trail over the pass");
    let camera = SuggestedCamera { title: title.clone(), eye, look_at, fov_y: 45f64.to_radians() };
    let mut layers = vec![ground_layer(terrain, PaletteName::Alpine.into())];
    if let Some(lake) = lake {
        layers.push(lake_layer(lake));
    }
    layers.push(line_layer("trail", LineFeature { style: None, name: "Trail over the pass".into(), points }));
    Ok((Scene { title, crs: Crs::Local, unit: Unit::Metre, layers, ..Scene::default() }, camera))
}

fn heightfield(land: &Land) -> Result<Heightfield, HeightfieldError> {
    let heights = land.z.iter().map(|&z| z as f32).collect();
    let states = vec![NodeState::Measured; land.z.len()];
    let corner = DVec2::new(-0.5 * SIDE_M, 0.5 * SIDE_M);
    Heightfield::new(corner, DVec2::splat(land.dx), land.n, land.n, heights, states)
}

fn lake_layer(lake: Lake) -> Layer {
    let to_scene = |p: DVec2| DVec2::new(p.x - 0.5 * SIDE_M, 0.5 * SIDE_M - p.y);
    let rings = lake.rings.into_iter().map(|r| r.into_iter().map(to_scene).collect()).collect();
    Layer {
        id: "lake".into(),
        must_see: false,
        kind: AreaLayer {
            features: vec![AreaFeature { style: None, name: "Lake".into(), rings }],
            fill: Color::rgb(74, 133, 168),
            outline: Some(Color::rgb(42, 88, 120)),
            width_px: 1.0,
            surface: AreaSurface::Water,
            hidden: Hidden::Cut,
            lift_m: 0.5,
            label_px: None,
            beyond: 0.0,
        }
        .into(),
    }
}

/// Route of the trail: from the mouth of the lake's valley along its shore and over a pass to the mouth farthest away.
fn trail_route(
    seed: u64,
    land: &Land,
    terrain: &Heightfield,
    water: &Drainage,
    lake: Option<&Lake>,
) -> Result<Vec<DVec2>, RouteError> {
    let n = land.n;
    let whole = Window { col: 0, row: 0, cols: n, rows: n };
    let mut blocked = vec![false; n * n];
    let mut shore = None;
    if let Some(lake) = lake {
        for &i in &lake.nodes {
            blocked[i] = true;
            land.around(i).for_each(|(j, _)| blocked[j] = true);
        }
        shore = lake
            .nodes
            .iter()
            .flat_map(|&i| land.around(i))
            .flat_map(|(i, _)| land.around(i))
            .map(|(j, _)| j)
            .find(|&j| !blocked[j]);
    }
    let xy = |i: usize| terrain.node_xy(i % n, i / n);
    let mouth_of = |mut i: usize| {
        while water.receiver[i] as usize != i {
            i = water.receiver[i] as usize;
        }
        i
    };
    // ends are a little inside the map
    let inside = |i: usize| {
        let margin = n / 40 + 1;
        let (c, r) = ((i % n).clamp(margin, n - 1 - margin), (i / n).clamp(margin, n - 1 - margin));
        (0..n * n)
            .filter(|&j| (j % n).abs_diff(c) <= margin / 2 && (j / n).abs_diff(r) <= margin / 2 && !blocked[j])
            .min_by(|&a, &b| land.z[a].total_cmp(&land.z[b]))
            .unwrap_or(r * n + c)
    };
    let start = mouth_of(shore.unwrap_or(n * n / 2));
    let far = (0..n * n)
        .filter(|&i| land.outlet[i])
        .max_by(|&a, &b| xy(a).distance_squared(xy(start)).total_cmp(&xy(b).distance_squared(xy(start))));
    let (first, last) = (xy(inside(start)), xy(inside(far.unwrap_or(0))));
    let cost = RouteCost { wander: 5.0, seed, ..RouteCost::default() };
    let Some(shore) = shore.map(xy) else {
        return route_in(terrain, whole, [first, last], &cost, &blocked);
    };
    let mut route = route_in(terrain, whole, [first, shore], &cost, &blocked)?;
    let rest = route_in(terrain, whole, [shore, last], &cost, &blocked)?;
    route.extend(rest.into_iter().skip(1));
    Ok(route)
}

/// Parameters of erosion at every node, at one resolution.
struct Forces {
    /// Uplift per step, metres.
    lift: Vec<f64>,
    /// Erodibility times duration of a step.
    k: Vec<f64>,
    /// Steepest stable slope, rise over run.
    talus: Vec<f64>,
}

/// Share of the full uplift at a point (in sides of the massif, 0..1): long crests with gaps, never 0.
fn uplift_share(seed: u64, p: DVec2) -> f64 {
    let warp = Noise::new(seed ^ 11);
    let bent = p + 0.12 * DVec2::new(warp.fbm(p * 3.0, 3), warp.fbm(p * 3.0 + DVec2::splat(9.7), 3));
    let crest = Noise::new(seed ^ 12).ridged(bent * 1.9, 3);
    let swell = 0.5 + 0.5 * Noise::new(seed ^ 13).fbm(p * 1.6, 2);
    (0.22 + 0.85 * crest * crest + 0.35 * swell * crest).clamp(0.15, 1.3)
}

fn forces(seed: u64, n: usize, lift_m: f64, k: f64) -> Forces {
    let rock = Noise::new(seed ^ 14);
    let at = |i: usize| DVec2::new((i % n) as f64, (i / n) as f64) / (n - 1) as f64;
    let hardness: Vec<f64> = (0..n * n).map(|i| rock.fbm(at(i) * 9.0, 3)).collect();
    Forces {
        lift: (0..n * n).map(|i| lift_m * uplift_share(seed, at(i))).collect(),
        k: hardness.iter().map(|h| k * (1.0 - 0.75 * h).max(0.3)).collect(),
        talus: hardness
            .iter()
            .enumerate()
            .map(|(i, h)| (0.66 + 0.7 * h + 0.65 * rock.fbm(at(i) * 57.0, 3)).clamp(0.3, 1.5))
            .collect(),
    }
}

/// Outlets at the valley mouths: one or two stretches on each side, at seeded positions.
fn outlets(seed: u64, n: usize) -> Vec<bool> {
    let mut random = seeded(seed ^ 15);
    let mut outlet = vec![false; n * n];
    for side in 0..4 {
        let mouths = if side % 2 == 0 { 2 } else { 1 };
        for m in 0..mouths {
            let room = 0.8 / f64::from(mouths);
            let centre = 0.1 + room * (f64::from(m) + random.range(0.2, 0.8));
            let half = random.range(0.012, 0.022);
            let last = (n - 1) as f64;
            let (a, b) = (((centre - half) * last) as usize, ((centre + half) * last).ceil() as usize);
            for t in a..=b.min(n - 1) {
                let i = match side {
                    0 => t,
                    1 => t * n + n - 1,
                    2 => (n - 1) * n + t,
                    _ => t * n,
                };
                outlet[i] = true;
            }
        }
    }
    outlet
}

/// The next finer grid: resampled along gently bent lines, so that nothing keeps the directions of the coarse grid, with new roughness.
fn refine(seed: u64, coarse: &Land, n: usize) -> Land {
    let (bend, rough) = (Noise::new(seed ^ 16 ^ n as u64), Noise::new(seed ^ 17 ^ n as u64));
    let scale = (coarse.n - 1) as f64 / (n - 1) as f64;
    let dx = SIDE_M / (n - 1) as f64;
    let outlet = outlets(seed, n);
    let z = (0..n * n)
        .map(|i| {
            let g = DVec2::new((i % n) as f64, (i / n) as f64) * scale;
            let shift = 1.8 * DVec2::new(bend.fbm(g * 0.21, 2), bend.fbm(g * 0.21 + DVec2::splat(5.3), 2));
            let z = coarse.sample(g.x + shift.x, g.y + shift.y);
            if outlet[i] { BASE_M } else { z + dx * (0.9 * rough.fbm(g * 0.16, 4) + 0.9 * rough.ridged(g * 0.12, 3)) }
        })
        .collect();
    Land { n, dx, z, outlet }
}

/// Stretches heights so that the relief is [`RELIEF_M`].
fn stretch(land: &mut Land) -> f64 {
    let top = land.z.iter().fold(f64::MIN, |a, &b| a.max(b));
    let factor = RELIEF_M / (top - BASE_M).max(1.0);
    for z in &mut land.z {
        *z = BASE_M + (*z - BASE_M) * factor;
    }
    factor
}

/// Eroded land of `n` nodes per side.
pub(crate) fn erode(seed: u64, n: usize) -> (Land, Drainage) {
    let mut sizes = vec![n];
    while sizes[0] > 140 {
        sizes.insert(0, sizes[0].div_ceil(2));
    }
    let first = sizes[0];
    let rough = Noise::new(seed ^ 18);
    let start: Vec<f64> = (0..first * first)
        .map(|i| {
            let p = DVec2::new((i % first) as f64, (i / first) as f64) / (first - 1) as f64;
            BASE_M + 200.0 * uplift_share(seed, p) + 60.0 * rough.fbm(p * 14.0, 4)
        })
        .collect();
    let dx = SIDE_M / (first - 1) as f64;
    let mut land = Land { n: first, dx, z: start, outlet: outlets(seed, first) };
    for (i, z) in land.z.iter_mut().enumerate() {
        if land.outlet[i] {
            *z = BASE_M;
        }
    }
    let mut lift_m = 60.0;
    for (level, &size) in sizes.iter().enumerate() {
        if level > 0 {
            land = refine(seed, &land, size);
        }
        let steps = [70, 24, 10, 3][level.min(3)];
        let mut f = forces(seed, size, lift_m, 0.35);
        if level == 2 {
            f.talus.iter_mut().for_each(|t| *t *= 1.4);
            f.lift.iter_mut().for_each(|t| *t *= 0.5);
        }
        for _ in 0..steps {
            land.incise(&f.lift, &f.k, &f.talus);
            land.slide(&f.talus, 1);
        }
        if level == 0 {
            let factor = stretch(&mut land);
            lift_m *= 2.6 * factor;
            land.slide(&f.talus, 12);
        }
    }
    let f = forces(seed, n, 0.0, 0.0);
    stretch(&mut land);
    let water = land.drainage();
    let carved = land.carve_troughs(
        &water,
        |z| if z > BASE_M + 0.45 * RELIEF_M { 0.4e6 } else { 4.0e6 },
        |area| 10.0 + 22.0 * (area / 1e6).sqrt().min(6.0),
    );
    land.slide(&f.talus, 3);
    for _ in 0..5 {
        land.creep(|i| if carved[i] { 0.6 } else { 0.04 });
    }
    let water = land.drainage();
    (land, water)
}
