//! Points that stand for the features of interest when visibility is judged.

use crate::surface_samples::surface;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{AreaFeature, Heightfield, Layer, LayerKind, LineFeature, Scene};
use serde::Serialize;

/// What the amounts of a feature measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// Length along a line, scene units.
    Length,
    /// Area in plan, scene units squared.
    Area,
    /// Area of a surface in space, scene units squared.
    Surface,
    /// Number of points.
    Count,
}

/// One point of a feature, lifted to where it must be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Scene coordinates, `lift_m` above the drawn ground.
    pub p_world: DVec3,
    /// Height of `p_world` over the ground, scene units.
    pub lift: f64,
    /// Length, area or count that the sample stands for.
    pub amount: f64,
    /// Outward unit normal, if the sample stands for a piece of a surface in space, just in front of which it lies.
    pub surface: Option<DVec3>,
    /// Number of the triangle that it lies before: of a mesh, or of a molecule's surface; twelve to a box.
    pub triangle: Option<u32>,
}

/// A feature of interest, sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledFeature {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Id of the layer.
    pub layer_id: String,
    /// Name of the feature, possibly empty.
    pub name: String,
    /// What amounts count.
    pub amount: Amount,
    /// Points in order along the feature.
    pub samples: Vec<Sample>,
}

/// Samples every feature of the layers that must be seen.
///
/// * Lines: the middles of equal parts of each piece, every `spacing` at most.
/// * Areas: their rims likewise, and a square lattice of 4 x `spacing` inside (even-odd rule); a rim sample stands for
///   a band of half a lattice step.
/// * Points: themselves.
/// * Meshes, molecules and boxes: points spread by area over their surface, one feature per layer.
///
/// Lines, areas and points are set on the drawn surface of the first terrain where there is one, and lifted by the layer's `lift_m`.
pub fn sample_features(scene: &Scene, spacing: f64) -> Vec<SampledFeature> {
    let terrain = scene.terrain();
    scene.must_see().flat_map(|(index, layer)| sample_layer(terrain, index, layer, spacing)).collect()
}

/// Half the spacing of the terrain grid, or a two-thousandth of the scene's extent without terrain.
pub fn default_spacing(scene: &Scene) -> f64 {
    match scene.terrain() {
        Some(hf) => 0.5 * hf.spacing().min_element(),
        None => {
            let bounds = scene.bounds();
            let extent = if bounds.is_empty() { 1.0 } else { (bounds.max - bounds.min).length() };
            (extent / 2000.0).max(1e-3)
        }
    }
}

fn sample_layer(terrain: Option<&Heightfield>, index: usize, layer: &Layer, spacing: f64) -> Vec<SampledFeature> {
    let feature = |i: usize, name: &str, amount: Amount, samples: Vec<Sample>| SampledFeature {
        layer: index,
        feature: i,
        layer_id: layer.id.clone(),
        name: name.to_owned(),
        amount,
        samples: samples.into_iter().filter(|s| s.p_world.is_finite() && s.amount.is_finite()).collect(),
    };
    let set = |p: DVec3, lift: f64| on_ground(terrain, p) + DVec3::Z * lift;
    match &layer.kind {
        LayerKind::Line(l) => {
            let sampled = |f: &LineFeature| {
                along(&f.points, spacing, |p, amount| Sample {
                    p_world: set(p, l.lift_m),
                    lift: l.lift_m,
                    amount,
                    surface: None,
                    triangle: None,
                })
            };
            l.features.iter().enumerate().map(|(i, f)| feature(i, &f.name, Amount::Length, sampled(f))).collect()
        }
        LayerKind::Area(a) => {
            let sampled = |f: &AreaFeature| {
                let on_surface = |xy: DVec2, amount: f64| {
                    let ground = terrain.map_or(Some(0.0), |hf| hf.surface_at(xy))?;
                    Some(Sample {
                        p_world: xy.extend(ground + a.lift_m),
                        lift: a.lift_m,
                        amount,
                        surface: None,
                        triangle: None,
                    })
                };
                area_samples(f, spacing, &on_surface)
            };
            a.features.iter().enumerate().map(|(i, f)| feature(i, &f.name, Amount::Area, sampled(f))).collect()
        }
        LayerKind::Point(p) => {
            let sampled = |at: DVec3| {
                vec![Sample { p_world: set(at, p.lift_m), lift: p.lift_m, amount: 1.0, surface: None, triangle: None }]
            };
            p.features
                .iter()
                .enumerate()
                .map(|(i, f)| feature(i, &f.name, Amount::Count, sampled(f.position)))
                .collect()
        }
        LayerKind::Terrain(_) => Vec::new(),
        kind => surface(kind, spacing).into_iter().map(|s| feature(0, &s.name, Amount::Surface, s.samples)).collect(),
    }
}

fn on_ground(terrain: Option<&Heightfield>, p: DVec3) -> DVec3 {
    match terrain.and_then(|hf| hf.surface_at(p.truncate())) {
        Some(height) => p.truncate().extend(height),
        None => p,
    }
}

fn along(points: &[DVec3], spacing: f64, make: impl Fn(DVec3, f64) -> Sample) -> Vec<Sample> {
    let mut out = Vec::new();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let length = (b - a).length();
        if !(length > 0.0 && length.is_finite()) {
            continue;
        }
        let parts = ((b - a).truncate().length() / spacing).ceil().clamp(1.0, 1e5) as usize;
        let share = 1.0 / parts as f64;
        out.extend((0..parts).map(|i| make(a.lerp(b, (i as f64 + 0.5) * share), length * share)));
    }
    out
}

fn area_samples(f: &AreaFeature, spacing: f64, on_surface: &dyn Fn(DVec2, f64) -> Option<Sample>) -> Vec<Sample> {
    let rim: Vec<DVec2> = f.rings.iter().flatten().copied().filter(|p| p.is_finite()).collect();
    let Some(&first) = rim.first() else { return Vec::new() };
    let (low, high) = rim.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let extent = high - low;
    // At most some thousand lattice points, at least a few across a small pond.
    let step = (4.0 * spacing).min(0.25 * extent.max_element()).max((extent.x * extent.y / 4000.0).sqrt()).max(1e-6);
    let mut out = Vec::new();
    for ring in &f.rings {
        let closed: Vec<DVec3> = ring.iter().chain(ring.first()).map(|p| p.extend(0.0)).collect();
        let band = |p: DVec3, length: f64| Sample {
            p_world: p,
            lift: 0.0,
            amount: 0.5 * step * length,
            surface: None,
            triangle: None,
        };
        out.extend(
            along(&closed, spacing, band).into_iter().filter_map(|s| on_surface(s.p_world.truncate(), s.amount)),
        );
    }
    let (cols, rows) = ((extent.x / step).ceil() as usize, (extent.y / step).ceil() as usize);
    for row in 0..rows {
        for col in 0..cols {
            let p = low + step * DVec2::new(col as f64 + 0.5, row as f64 + 0.5);
            if inside(&f.rings, p) {
                out.extend(on_surface(p, step * step));
            }
        }
    }
    out
}

fn inside(rings: &[Vec<DVec2>], p: DVec2) -> bool {
    let crosses =
        |a: DVec2, b: DVec2| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    let count: usize =
        rings.iter().map(|r| (0..r.len()).filter(|&i| crosses(r[i], r[(i + 1) % r.len()])).count()).sum();
    count % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_side_of_a_rim_is_sampled_alike_whether_the_ring_repeats_its_first_point_or_not() {
        let open = [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]].map(DVec2::from).to_vec();
        let closed = open.iter().chain(open.first()).copied().collect();
        for ring in [open, closed] {
            let feature = AreaFeature { name: String::new(), rings: vec![ring] };
            let flat = |xy: DVec2, amount: f64| {
                Some(Sample { p_world: xy.extend(0.0), lift: 0.0, amount, surface: None, triangle: None })
            };
            let samples = area_samples(&feature, 5.0, &flat);
            let side = |on: &dyn Fn(DVec3) -> bool| {
                let on_side: Vec<f64> = samples.iter().filter(|s| on(s.p_world)).map(|s| s.amount).collect();
                (on_side.len(), on_side.iter().sum::<f64>())
            };
            let sides =
                [side(&|p| p.y == 0.0), side(&|p| p.x == 100.0), side(&|p| p.y == 100.0), side(&|p| p.x == 0.0)];
            // Every 5 along 100, each for a band of half a lattice step of 4 x 5.
            assert!(sides.iter().all(|(n, area)| *n == 20 && (area - 1000.0).abs() < 1e-9), "{sides:?}");
            let inner: f64 = samples.iter().map(|s| s.amount).sum::<f64>() - 4000.0;
            assert!((inner - 1e4).abs() < 1e-6, "{inner}");
        }
    }
}
