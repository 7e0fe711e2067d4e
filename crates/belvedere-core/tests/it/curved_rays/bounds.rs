//! What renderers rely on: edge errors and boxes are never too small, and not much too large.

use super::cameras::{self, Spec};
use belvedere_core::map::curved_rays::Model;
use belvedere_core::{Aabb, DVec2, DVec3, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::Similarity;

const MODELS: [Model; 5] = [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular];

fn specs() -> [Spec; 4] {
    [cameras::street_corner(), cameras::sideways(), cameras::zigzag(), cameras::long_bend()]
}

/// Largest distance in pixels between the bent image of an edge, drawn with one record, and its straight image, or between their depths.
fn true_error(view: &View, record: usize, p0: DVec3, p1: DVec3) -> Option<f64> {
    let displaced = |p| view.displace_in(record, p).ok().map(|d| d.point);
    let (d0, d1) = (displaced(p0)?, displaced(p1)?);
    let mut worst = 0.0f64;
    for i in 1..64 {
        let t = f64::from(i) / 64.0;
        let (chord, z) = view.pinhole().project(d0.lerp(d1, t)).ok()?;
        let (bent, depth) = view.pinhole().project(displaced(p0.lerp(p1, t))?).ok()?;
        worst = worst.max((chord - bent).length()).max((z - depth).abs() * view.pinhole().scale_px() / depth);
    }
    Some(worst)
}

/// A random edge around a point within the picture.
fn edge(view: &View, random: &mut Random, length: f64) -> (DVec3, DVec3) {
    let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
    let depth = random.range(10.0, 600.0);
    let p = view.ray(pixel).at(depth).unwrap().point;
    (p, p + random.range(0.01, 1.0) * length * random.direction())
}

#[test]
fn edge_error_is_never_below_the_truth_and_not_far_above() {
    for model in MODELS {
        for spec in specs() {
            let view = spec.view(model, &Similarity::IDENTITY);
            let mut random = Random::new(0xed6e);
            let mut ratios = Vec::new();
            for i in 0..3000 {
                let (p0, p1) = edge(&view, &mut random, 60.0);
                let record = i % view.records();
                let bound = view.edge_error_in(record, p0, p1).px;
                let Some(truth) = true_error(&view, record, p0, p1).filter(|_| bound.is_finite()) else { continue };
                assert!(
                    truth <= bound * (1.0 + 1e-9) + 1e-8,
                    "{model:?}: edge {p0} {p1} of record {record} is {truth} px off, bound {bound}"
                );
                if truth > 0.01 {
                    ratios.push(bound / truth);
                }
            }
            assert!(ratios.len() > 50, "{model:?}: only {} bent edges", ratios.len());
            ratios.sort_by(f64::total_cmp);
            let median = ratios[ratios.len() / 2];
            assert!(median < 3.5, "{model:?}: median of bound / truth is {median}");
        }
    }
}

#[test]
fn edges_with_known_ends_have_the_same_bound() {
    for model in MODELS {
        for spec in specs() {
            let view = spec.view(model, &Similarity::IDENTITY);
            let mut random = Random::new(0xed9e);
            let (mut compared, mut bounded) = (0, 0);
            for k in 0..400 {
                let record = k % view.records();
                let edges = view.edges(record).unwrap();
                let (p0, p1) = edge(&view, &mut random, 40.0);
                let (Some(a), Some(b)) = (edges.point(p0), edges.point(p1)) else { continue };
                let (found, want) = (edges.error_px(&a, &b), view.edge_error_in(record, p0, p1).px);
                let same = found == want || (found - want).abs() <= 1e-9 * want.abs().max(1e-3);
                assert!(same, "{model:?} record {record}, edge {p0} {p1}: {found} px, not {want}");
                compared += u32::from(want > 0.0 && want.is_finite());
                let within = edges.box_error_px(&Aabb::of([p0, p1]));
                assert!(
                    found <= within * (1.0 + 1e-9) + 1e-9,
                    "{model:?} record {record}, box {p0} {p1}: {found} px, not {within}"
                );
                bounded += u32::from(found > 0.0 && within.is_finite());
            }
            assert!(compared > 0, "{model:?}: {compared}");
            // The original model is only nearly convex.
            assert!(bounded > 0 || model == Model::Original || view.records() > 1, "{model:?}");
        }
    }
}

#[test]
fn edges_across_turns_are_bounded_by_the_sum() {
    let view = cameras::long_bend().view(Model::Modified, &Similarity::IDENTITY);
    let mut random = Random::new(0xacc);
    let mut checked = 0;
    for _ in 0..4000 {
        let (p0, p1) = edge(&view, &mut random, 150.0);
        let bound = view.edge_error(p0, p1).px;
        let (Ok(d0), Ok(d1)) = (view.displace(p0), view.displace(p1)) else { continue };
        if !bound.is_finite() || d0.segment.abs_diff(d1.segment) < 2 {
            continue;
        }
        for i in 1..64 {
            let t = f64::from(i) / 64.0;
            let (Ok(chord), Ok(bent)) =
                (view.pinhole().project(d0.point.lerp(d1.point, t)), view.project(p0.lerp(p1, t)))
            else {
                continue;
            };
            let error = (chord.0 - bent.pixel).length();
            assert!(
                error <= bound + 1e-8,
                "edge {p0} {p1}, segments {} {}: {error} px, bound {bound}",
                d0.segment,
                d1.segment
            );
        }
        checked += 1;
    }
    assert!(checked > 100, "{checked}");
}

#[test]
fn scene_bound_of_an_edge_holds_too() {
    for model in MODELS {
        let rays = cameras::zigzag().rays(model, &Similarity::IDENTITY);
        let view = cameras::zigzag().view(model, &Similarity::IDENTITY);
        let mut random = Random::new(0x5ce);
        for _ in 0..1000 {
            let (p0, p1) = edge(&view, &mut random, 20.0);
            let bound = rays.edge_bound(p0, p1);
            if !bound.is_finite() {
                continue;
            }
            let (Ok(d0), Ok(d1), Ok(middle)) = (rays.displace(p0), rays.displace(p1), rays.displace(0.5 * (p0 + p1)))
            else {
                continue;
            };
            let off = (middle.point - 0.5 * (d0.point + d1.point)).length();
            assert!(off <= bound + 1e-9, "{model:?}: {p0} {p1} {off} > {bound}");
        }
    }
}

#[test]
fn boxes_contain_the_image_and_are_tight() {
    for model in MODELS {
        for spec in specs() {
            let view = spec.view(model, &Similarity::IDENTITY);
            let rays = view.curved_rays().unwrap();
            let mut random = Random::new(0xb0);
            let (mut boxes, mut areas) = (0, Vec::new());
            for _ in 0..600 {
                let (p, q) = edge(&view, &mut random, 40.0);
                let bounds = Aabb::of([p, q]);
                let Some(image) = view.image_box(&bounds) else { continue };
                let Some(displaced) = rays.displaced_bounds(&bounds) else { panic!("an image without bounds") };
                boxes += 1;
                let mut seen = belvedere_core::ImageBox::EMPTY;
                for i in 0..125 {
                    let t = DVec3::new(f64::from(i % 5), f64::from(i / 5 % 5), f64::from(i / 25)) / 4.0;
                    let x = bounds.min + t * (bounds.max - bounds.min);
                    for at in view.project_all(x) {
                        seen = seen.including(at.pixel, at.depth);
                    }
                    if let Ok(d) = view.displace(x) {
                        assert!(d.point.cmpge(displaced.min - 1e-9).all() && d.point.cmple(displaced.max + 1e-9).all());
                    }
                }
                let (low, high) = (seen.min - image.min, image.max - seen.max);
                assert!(low.min_element() > -1e-8 && high.min_element() > -1e-8, "{model:?}: {seen:?} {image:?}");
                assert!(image.depth_min <= seen.depth_min + 1e-9 && image.depth_max >= seen.depth_max - 1e-9);
                let area = |b: &belvedere_core::ImageBox| (b.max - b.min).x * (b.max - b.min).y;
                areas.push(area(&image) / area(&seen));
            }
            areas.sort_by(f64::total_cmp);
            let median = areas[areas.len() / 2];
            assert!(boxes > 50 && median < 1.6, "{model:?}: {boxes} boxes, median area {median} of the tight one");
        }
    }
}

/// Beyond the common line points may have an image by the part before the turn, by the one after it, or both: boxes hold all of them.
#[test]
fn boxes_and_edges_around_the_common_line_are_bounded_too() {
    let view = cameras::street_corner().view(Model::Modified, &Similarity::IDENTITY);
    let rays = view.curved_rays().unwrap();
    let around = Aabb { min: DVec3::new(-81.0, 99.0, -1.0), max: DVec3::new(-69.0, 101.0, 1.0) };
    let bounds = rays.displaced_bounds(&around).unwrap();
    let mut random = Random::new(12);
    for _ in 0..2000 {
        let p = random.point(&around);
        for segment in (0..rays.segments()).filter(|&k| rays.segment_planes(k).iter().flatten().all(|f| f.at(p) >= 0.0))
        {
            let image = rays.displace_along(segment, p).unwrap().point;
            assert!(
                image.cmpge(bounds.min - 1e-9).all() && image.cmple(bounds.max + 1e-9).all(),
                "{p}: {image} {bounds:?}"
            );
        }
    }
    let (a, b) = (DVec3::new(-80.0, 60.0, 0.0), DVec3::new(-90.0, 130.0, 0.0));
    let (truth, bound) = (true_error(&view, 0, a, b).unwrap(), view.edge_error_in(0, a, b).px);
    assert!(truth > 1.0 && truth <= bound && bound < 3.0 * truth, "{truth} {bound}");
}

#[test]
fn boxes_without_points_or_without_end_have_no_bounds() {
    for spec in specs() {
        let rays = spec.rays(Model::Modified, &Similarity::IDENTITY);
        assert_eq!(rays.displaced_bounds(&Aabb::EMPTY), None);
        let (low, high) = (DVec3::new(-5.0, 100.0, -5.0), DVec3::new(5.0, 120.0, 5.0));
        assert_eq!(rays.displaced_bounds(&Aabb { min: high, max: low }), None, "turned inside out");
        assert_eq!(rays.displaced_bounds(&Aabb { min: low, max: DVec3::INFINITY }), None);
        assert_eq!(rays.displaced_bounds(&Aabb { min: DVec3::NEG_INFINITY, max: high }), None);
        assert_eq!(rays.displaced_bounds(&Aabb { min: low, max: DVec3::new(5.0, f64::NAN, 5.0) }), None);
    }
}
