//! Points that stand for the features of interest when visibility is judged.

use crate::sample::{Amount, Sample, SampledFeature};
use crate::surface_samples::surface;
use belvedere_core::{DVec2, DVec3, polygon};
use belvedere_scene::{AreaFeature, Heightfield, Layer, LayerKind, LineFeature, Scene};

/// Samples every feature of the layers that must be seen.
///
/// * Lines: the middles of equal parts of each piece, every `spacing` at most; their amounts are lengths in plan where there is terrain.
/// * Areas: a square lattice of 4 x `spacing` inside (even-odd rule); where none of it lies inside their rims every `spacing`, of which a
///   sample stands for a band of half a lattice step.
/// * Points: themselves.
/// * Meshes, molecules and boxes: points spread by area over their surface, one feature per layer.
///
/// Lines, areas and points are set on the drawn surface of the first terrain where there is one, and lifted by the layer's `lift_m`.
pub fn sample_features(scene: &Scene, spacing: f64) -> Vec<SampledFeature> {
    let terrain = scene.terrain();
    scene.must_see().flat_map(|(index, layer)| sample_layer(terrain, index, layer, [spacing; 2], None)).collect()
}

/// Lattice points inside one area, at most about, where a view is searched for.
const MOST_INSIDE: f64 = 4000.0;
/// Range of the number of points in the boxes of all areas together where shares are judged, and range for one area. They are
/// scattered evenly (Roberts's sequence, by powers of the plastic number): shadows begin along straight lines, which a square lattice
/// would meet with whole rows. With a third as many points shares are half a per cent off where shadows of bumps are as fine as the
/// grid.
const JUDGED_ALL: [f64; 2] = [16_000.0, 60_000.0];
const MOST_JUDGED: f64 = 16_000.0;
const FEWEST_JUDGED: f64 = 100.0;
const PLASTIC: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3);
/// Factors by which samples are denser where shares are judged than where views are searched for: along lines and rims, and inside
/// areas in either direction.
const DENSER: [f64; 2] = [4.0, 8.0];

/// Where shares are judged, about this many samples lie on all lines together at least, unless they would be more than `FINEST` times
/// as dense as usual.
const LEAST_ON_LINES: f64 = 3000.0;
const FINEST: f64 = 200.0;

/// The samples that shares are judged by: as [`sample_features`], but every eighth of a grid cell along lines, and inside areas some
/// thousands. The position at which a feature begins to be hidden then changes shares by less than half a per cent.
pub fn judged_samples(scene: &Scene) -> Vec<SampledFeature> {
    let terrain = scene.terrain();
    let usual = default_spacing(scene).max(1e-6);
    // Shares of short lines are to be as fine as those of long ones.
    let length = |f: &LineFeature| f.points.windows(2).map(|w| w[0].truncate().distance(w[1].truncate())).sum::<f64>();
    let of_layer = |layer: &Layer| {
        layer.kind.lines().map_or(0.0, |l| l.features.iter().map(length).filter(|length| length.is_finite()).sum())
    };
    let lines: f64 = scene.must_see().map(|(_, layer)| of_layer(layer)).sum();
    let on_lines = (usual / DENSER[0]).min((lines / LEAST_ON_LINES).max(usual / FINEST));
    let areas_of = |layer: &Layer| layer.kind.areas().map_or(0, |a| a.features.len());
    let areas = scene.must_see().map(|(_, layer)| areas_of(layer)).sum::<usize>().max(1) as f64;
    let judged = JUDGED_ALL.map(|all| (all / areas).clamp(FEWEST_JUDGED, MOST_JUDGED));
    let sampled = |(index, layer): (usize, &Layer)| {
        let spacing = match layer.kind {
            LayerKind::Line(_) => [on_lines; 2],
            LayerKind::Area(_) | LayerKind::Point(_) => DENSER.map(|denser| usual / denser),
            _ => [usual; 2],
        };
        sample_layer(terrain, index, layer, spacing, Some(judged))
    };
    scene.must_see().flat_map(sampled).collect()
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

/// * `spacing`: along lines, and a quarter of that inside areas; `scattered`: see [`area_samples`].
fn sample_layer(
    terrain: Option<&Heightfield>,
    index: usize,
    layer: &Layer,
    [spacing, inside]: [f64; 2],
    scattered: Option<[f64; 2]>,
) -> Vec<SampledFeature> {
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
                along(&f.points, (spacing, terrain.is_some()), |p, amount| Sample {
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
                area_samples(f, (spacing, 4.0 * inside, scattered), &on_surface)
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

/// * `in_plan`: whether lengths are those of the plan.
fn along(points: &[DVec3], (spacing, in_plan): (f64, bool), make: impl Fn(DVec3, f64) -> Sample) -> Vec<Sample> {
    let mut out = Vec::new();
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let length = if in_plan { (b - a).truncate().length() } else { (b - a).length() };
        if !(length > 0.0 && length.is_finite()) {
            continue;
        }
        let parts = ((b - a).truncate().length() / spacing).ceil().clamp(1.0, 1e5) as usize;
        let share = 1.0 / parts as f64;
        out.extend((0..parts).map(|i| make(a.lerp(b, (i as f64 + 0.5) * share), length * share)));
    }
    out
}

/// * `spacing`: along rims; `step`: of the lattice inside; `scattered`: range of the number of points scattered in its box in place
///   of the lattice.
fn area_samples(
    f: &AreaFeature,
    (spacing, step, scattered): (f64, f64, Option<[f64; 2]>),
    on_surface: &dyn Fn(DVec2, f64) -> Option<Sample>,
) -> Vec<Sample> {
    let rim: Vec<DVec2> = f.rings.iter().flatten().copied().filter(|p| p.is_finite()).collect();
    let Some(&first) = rim.first() else { return Vec::new() };
    let (low, high) = rim.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let extent = high - low;
    // At most some thousand lattice points, at least a few across a small pond.
    let step = step.min(0.25 * extent.max_element()).max((extent.x * extent.y / MOST_INSIDE).sqrt()).max(1e-6);
    let (mut rims, mut out) = (Vec::new(), Vec::new());
    for ring in &f.rings {
        let closed: Vec<DVec3> = ring.iter().chain(ring.first()).map(|p| p.extend(0.0)).collect();
        let band = |p: DVec3, length: f64| Sample {
            p_world: p,
            lift: 0.0,
            amount: 0.5 * step * length,
            surface: None,
            triangle: None,
        };
        rims.extend(
            along(&closed, (spacing, true), band)
                .into_iter()
                .filter_map(|s| on_surface(s.p_world.truncate(), s.amount)),
        );
    }
    if let Some([least, most]) = scattered {
        let count = (extent.element_product() / (step * step)).clamp(least, most).floor();
        let each = extent.element_product() / count;
        let places = (0..count as usize).map(|i| low + extent * (0.5 + i as f64 * PLASTIC).fract());
        out.extend(places.filter(|p| polygon::is_inside(&f.rings, *p)).filter_map(|p| on_surface(p, each)));
        return if out.is_empty() { rims } else { out };
    }
    let (cols, rows) = ((extent.x / step).ceil() as usize, (extent.y / step).ceil() as usize);
    for row in 0..rows {
        for col in 0..cols {
            let p = low + step * DVec2::new(col as f64 + 0.5, row as f64 + 0.5);
            if polygon::is_inside(&f.rings, p) {
                out.extend(on_surface(p, step * step));
            }
        }
    }
    // The band along a rim is a part of the area that the lattice counts already.
    if out.is_empty() { rims } else { out }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(rings: Vec<Vec<DVec2>>) -> Vec<Sample> {
        let flat = |xy: DVec2, amount: f64| {
            Some(Sample { p_world: xy.extend(0.0), lift: 0.0, amount, surface: None, triangle: None })
        };
        area_samples(&AreaFeature { style: None, name: String::new(), rings }, (5.0, 20.0, None), &flat)
    }

    #[test]
    fn amounts_inside_an_area_add_up_to_the_area() {
        let square = [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]].map(DVec2::from).to_vec();
        let hole = square.iter().map(|p| 0.4 * *p + 20.0).collect();
        let sum = |rings| samples(rings).iter().map(|s| s.amount).sum::<f64>();
        assert!((sum(vec![square.clone()]) - 1e4).abs() < 1e-6);
        assert!((sum(vec![square, hole]) - 8400.0).abs() < 1e-6);
    }

    #[test]
    fn every_side_of_a_rim_is_sampled_alike_whether_the_ring_repeats_its_first_point_or_not() {
        // So thin that no point of the lattice lies inside.
        let open = [[0.0, 0.0], [100.0, 0.0], [100.0, 1.0], [0.0, 1.0]].map(DVec2::from).to_vec();
        let closed: Vec<DVec2> = open.iter().chain(open.first()).copied().collect();
        let [a, b] = [open, closed].map(|ring| samples(vec![ring]));
        assert_eq!(a, b);
        let bottom: Vec<f64> = a.iter().filter(|s| s.p_world.y == 0.0).map(|s| s.amount).collect();
        // Every 5 along 100, each for a band of half a lattice step of 4 x 5.
        assert!(bottom.len() == 20 && bottom.iter().all(|amount| (amount - 50.0).abs() < 1e-9), "{bottom:?}");
    }
}
