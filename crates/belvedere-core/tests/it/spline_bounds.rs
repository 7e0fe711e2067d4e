//! Bounds of the spline bend against sampled values.

use crate::spline_figures::{bend, camera_at};
use belvedere_core::map::earth::EarthCurvature;
use belvedere_core::map::spline::SplineBend;
use belvedere_core::presets::PresetDocument;
use belvedere_core::{Aabb, DVec3, SpaceMap, Stage, View};
use belvedere_testkit::Random;

/// Largest distance of the sampled image of an edge from the chord of its ends.
fn sampled_error(map: &dyn SpaceMap, p0: DVec3, p1: DVec3) -> f64 {
    let (q0, q1) = (map.apply(p0).unwrap(), map.apply(p1).unwrap());
    let chord = q1 - q0;
    (1..64)
        .map(|i| {
            let q = map.apply(p0.lerp(p1, f64::from(i) / 64.0)).unwrap();
            let t = ((q - q0).dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
            (q - q0 - t * chord).length()
        })
        .fold(0.0, f64::max)
}

fn all_bends() -> Vec<(String, SplineBend)> {
    let names = ["progressive", "degressive", "hybrid-flat-steep-flat", "hybrid-steep-flat-steep", "map", "demo"];
    names.map(|n| (n.to_owned(), bend(&PresetDocument::builtin(n).unwrap(), &camera_at(36.0, 1000.0)))).to_vec()
}

#[test]
fn edge_bound_is_never_below_the_sampled_truth() {
    let mut random = Random::new(31);
    let mut ratios = Vec::new();
    for (name, map) in all_bends() {
        let [low, high] = map.fold_heights();
        for i in 0..20_000 / 5 {
            // Half of the edges stay below 0.4 of the fold height, the rest reach beyond it.
            let reach = if i % 2 == 0 { 0.4 } else { 1.5 };
            let start = DVec3::new(
                random.range(-500.0, 500.0),
                random.range(-900.0, 1500.0),
                random.range(reach * low.max(-2e3), reach * high.min(2e3)),
            );
            let edge = random.direction() * 10f64.powf(random.range(-1.0, 2.7));
            let mut end = start + edge;
            if i % 2 == 0 {
                end.z = end.z.clamp(0.4 * low, 0.4 * high);
            }
            let (truth, bound) = (sampled_error(&map, start, end), map.edge_bound(start, end));
            assert!(bound >= truth - 1e-10, "{name}: edge {start} {end}: bound {bound}, truth {truth}");
            assert_eq!(bound, map.edge_bound(end, start), "{name}: bound depends on the direction");
            if truth > 1e-6 && i % 2 == 0 && edge.length() < 20.0 {
                ratios.push(bound / truth);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let (least, median) = (ratios[0], ratios[ratios.len() / 2]);
    // An arc has exactly twice its sagitta; at the kinks where the curve ends the bound is sharp.
    assert!(least >= 1.0 && median < 4.0, "bound / truth: least {least}, median {median}");
}

#[test]
fn edges_with_known_ends_have_the_same_bound() {
    let camera = camera_at(36.0, 1000.0);
    let earth = EarthCurvature { eye: camera.eye, radius: 6e4, refraction: 0.13 };
    let mut random = Random::new(33);
    for (name, map) in all_bends() {
        let bend = Stage::SplineBend(map);
        for stages in [vec![bend.clone()], vec![Stage::EarthCurvature(earth), bend]] {
            let curved = stages.len() == 2;
            let view = View::new(camera.clone(), stages).unwrap();
            let edges = view.edges(0).unwrap();
            let (mut compared, mut bounded) = (0, 0);
            for _ in 0..2000 {
                let ground = [random.range(-500.0, 500.0), random.range(-700.0, 1500.0)];
                let start = DVec3::new(ground[0], ground[1], random.range(-20.0, 120.0));
                let end = start + random.direction() * 10f64.powf(random.range(-1.0, 2.0));
                let (Some(a), Some(b)) = (edges.point(start), edges.point(end)) else { continue };
                let (found, want) = (edges.error_px(&a, &b), view.edge_error(start, end).px);
                let same = found == want || (found - want).abs() <= 1e-9 * want.abs().max(1e-3);
                assert!(same, "{name}, earth {curved}, edge {start} {end}: {found} px, not {want}");
                compared += u32::from(want > 0.0 && want.is_finite());
                let within = edges.box_error_px(&Aabb::of([start, end]));
                let holds = found <= within * (1.0 + 1e-9) + 1e-9;
                assert!(holds, "{name}, box {start} {end}: {found} px, not {within}");
                bounded += u32::from(found > 0.0 && within.is_finite());
            }
            assert!(compared > 500 && (curved || bounded > 100), "{name}: {compared} compared, {bounded} bounded");
            assert!(view.edges(1).is_none());
        }
    }
}

#[test]
fn edge_bound_vanishes_on_the_extensions_and_across() {
    for (name, map) in all_bends() {
        let far = DVec3::new(0.0, 9e3, 50.0);
        assert_eq!(map.edge_bound(far, far + DVec3::new(300.0, 400.0, 20.0)), 0.0, "{name}");
        let p = DVec3::new(-200.0, 40.0, 60.0);
        assert_eq!(map.edge_bound(p, p + 700.0 * DVec3::X), 0.0, "{name}: across the heading lines stay straight");
        assert_eq!(map.edge_bound(p, DVec3::NAN), f64::INFINITY);
    }
}

#[test]
fn displaced_boxes_contain_the_images_of_their_points() {
    let mut random = Random::new(32);
    for (name, map) in all_bends() {
        let mut tight = 0;
        for i in 0..400 {
            let center = DVec3::new(random.range(-2e3, 2e3), random.range(-2e3, 4e3), random.range(-400.0, 400.0));
            let half = DVec3::new(random.unit(), random.unit(), random.unit()) * 10f64.powf(random.range(0.0, 3.5));
            let bounds = Aabb { min: center - half, max: center + half };
            let out = map.displaced_bounds(&bounds).unwrap();
            let mut seen = Aabb::EMPTY;
            for k in 0..200 {
                let p = if k < 8 { bounds.corners()[k] } else { random.point(&bounds) };
                let q = map.apply(p).unwrap();
                seen = seen.including(q);
                let inside = q.cmpge(out.min - 1e-9).all() && q.cmple(out.max + 1e-9).all();
                assert!(inside, "{name} box {i} {bounds:?}: {p} -> {q} leaves {out:?}");
            }
            tight += usize::from((out.max - out.min).length() < 2.0 * (seen.max - seen.min).length());
        }
        assert!(tight > 300, "{name}: only {tight} of 400 boxes are less than twice too large");
        assert!(map.displaced_bounds(&Aabb::EMPTY).is_none());
        assert!(map.displaced_bounds(&Aabb { min: DVec3::ZERO, max: DVec3::INFINITY }).is_none());
    }
}

#[test]
fn an_edge_across_a_corner_of_the_curve_has_a_bound_only_on_the_curve_itself() {
    // Straight, a corner of 45 degrees in the middle, straight.
    let text = r#"{"version": 1, "units": "absolute", "presets": [{"phi": 36, "s": 100, "e": 1100,
        "control": [[0,0],[0.2,0],[0.4,0],[0.5,0],[0.5,0],[0.5,0],[0.6,0.1],[0.8,0.3],[1,0.5]]}]}"#;
    let document: PresetDocument = serde_json::from_str(text).unwrap();
    let map = bend(&document, &camera_at(36.0, 1000.0));
    assert_eq!(map.curve().corners().len(), 1);
    let (corner, l0, l1) =
        (map.curve().corners()[0], map.coordinates(DVec3::ZERO).l, map.coordinates(1000.0 * DVec3::Y).l);
    let at = |l: f64, d: f64| DVec3::new(0.0, 1000.0 * (corner + l - l0) / (l1 - l0), d);
    let (before, after) = (at(-0.05, 0.0), at(0.05, 0.0));
    let (truth, bound) = (sampled_error(&map, before, after), map.edge_bound(before, after));
    assert!(truth > 1.0 && bound >= truth && bound < 10.0 * truth, "bound {bound}, truth {truth}");
    for d in [-1.0, 1.0] {
        assert_eq!(map.edge_bound(at(-0.05, d), at(0.05, d)), f64::INFINITY);
        assert!(map.edge_bound(at(-0.05, d), at(-0.01, d)) < 1e-9, "before the corner");
        assert!(map.edge_bound(at(0.01, d), at(0.05, d)) < 1e-9, "after it");
    }
}
