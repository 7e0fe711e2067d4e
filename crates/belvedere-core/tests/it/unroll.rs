//! The circle around the eye, unrolled: laws, a panorama computed by hand, bounds, and the seam.

use belvedere_core::map::unroll::{Roll, Unroll};
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole, Projection, SpaceMap, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{self, Continuity, MapCase, Similarity};
use std::f64::consts::{PI, TAU};

const EYE: DVec3 = DVec3::new(300.0, -200.0, 900.0);

/// Turns about the vertical alone keep what is upright.
fn upright(s: &Similarity) -> bool {
    (s.rotation * DVec3::Z).distance(DVec3::Z) < 1e-9
}

fn around(s: &Similarity, span: f64, slope: f64, roll: Roll) -> Unroll {
    let heading = if upright(s) { s.rotation * DVec3::new(0.3, 1.0, 0.0) } else { DVec3::new(0.3, 1.0, 0.0) };
    Unroll::new(s.point(EYE), heading.truncate(), span, slope, roll).expect("in range")
}

fn region() -> Aabb {
    Aabb::of([DVec3::new(-4000.0, -4000.0, -500.0), DVec3::new(4000.0, 4000.0, 2500.0)])
}

fn case(name: &str, make: fn(&Similarity) -> Unroll) -> MapCase<Unroll> {
    // Rounding may put points very near the seam on either side of it once the case is moved.
    MapCase::new(name, region(), make).continuity(Continuity::C1).upright().domain(0.3, |map, p| {
        let v = p.truncate() - map.eye().truncate();
        v.length() > 1.0 && v.angle_to(map.heading()).abs() < (0.5 * map.span()).min(PI) - 1e-6
    })
}

fn cylinder() -> MapCase<Unroll> {
    case("cylinder", |s| around(s, TAU, 0.0, Roll::Cylinder))
}

fn sphere() -> MapCase<Unroll> {
    case("sphere", |s| around(s, TAU, -0.1, Roll::Sphere))
}

fn sector() -> MapCase<Unroll> {
    case("sector", |s| around(s, 4.0, 0.2, Roll::Cylinder))
}

/// A circle unrolled has no joints, and no zero strength.
#[test]
fn the_laws_of_maps_hold() {
    for case in [cylinder(), sphere(), sector()] {
        laws::map_round_trips(&case);
        laws::map_jacobian_matches_differences(&case);
        laws::map_keeps_orientation(&case);
        laws::map_moves_with_its_parameters(&case);
        laws::map_never_gives_nan(&case);
    }
}

/// A camera whose picture is as wide as the span.
fn camera(map: &Unroll, image: [u32; 2]) -> Pinhole {
    let [width, height] = image.map(f64::from);
    let lens = Projection::Perspective { fov_y: 2.0 * (0.5 * height * map.span() / width).atan() };
    let ahead = map.eye() + map.heading().extend(0.0);
    Pinhole::look_at(map.eye(), ahead, DVec3::Z, lens, image, 0.1, None).expect("a camera")
}

#[test]
fn columns_are_azimuths_and_rows_are_slopes_or_angles() {
    let (mut random, image) = (Random::new(3), [3600u32, 600]);
    for roll in [Roll::Cylinder, Roll::Sphere] {
        for (span, slope) in [(TAU, 0.0), (TAU, -0.2), (2.0, 0.1)] {
            let map = around(&Similarity::IDENTITY, span, slope, roll);
            let view = View::new(camera(&map, image), vec![Stage::Unroll(map)]).expect("in order");
            let per_radian = f64::from(image[0]) / span;
            let mut judged = 0;
            for _ in 0..3000 {
                let p = random.point(&region());
                // By compass and spirit level.
                let v = p - EYE;
                let azimuth = v.x.atan2(v.y) - 0.3f64.atan2(1.0);
                let azimuth = azimuth - TAU * (azimuth / TAU).round();
                let level = v.truncate().length();
                let row = match roll {
                    Roll::Cylinder => v.z / level,
                    Roll::Sphere => (v.z / level).atan(),
                };
                let expected = DVec2::new(
                    0.5 * f64::from(image[0]) + per_radian * azimuth,
                    0.5 * f64::from(image[1]) - per_radian * (row - slope),
                );
                match view.project(p) {
                    Ok(at) => {
                        assert!(at.pixel.distance(expected) < 1e-6, "{p}: {} {expected}", at.pixel);
                        assert!((at.depth - level).abs() < 1e-9 * level.max(1.0));
                        let back = view.ray(at.pixel).at(at.depth).expect("a point").point;
                        assert!(back.distance(p) < 1e-6, "{back} {p}");
                        judged += 1;
                    }
                    Err(_) => assert!(azimuth.abs() > 0.5 * span - 1e-9, "{p} at {azimuth}"),
                }
            }
            assert!(judged > 800, "{judged}");
        }
    }
}

#[test]
fn edge_bound_is_never_below_the_sampled_truth() {
    let mut random = Random::new(5);
    for map in [
        around(&Similarity::IDENTITY, TAU, -0.1, Roll::Cylinder),
        around(&Similarity::IDENTITY, TAU, 0.2, Roll::Sphere),
    ] {
        let mut ratios = Vec::new();
        for _ in 0..6000 {
            let p0 = random.point(&region());
            let p1 = p0 + random.direction() * 10f64.powf(random.range(0.0, 3.3));
            let bound = map.edge_bound(p0, p1);
            if bound.is_infinite() {
                assert!(map.seam().parts(p0, p1), "{p0} {p1}");
                continue;
            }
            let (q0, q1) = (map.apply(p0).unwrap(), map.apply(p1).unwrap());
            let off = |i: i32| {
                let t = f64::from(i) / 64.0;
                map.apply(p0.lerp(p1, t)).expect("beside the seam").distance(q0.lerp(q1, t))
            };
            let truth = (1..64).map(off).fold(0.0, f64::max);
            assert!(bound >= truth - 1e-7, "{p0} {p1}: bound {bound}, truth {truth}");
            if truth > 1e-2 {
                ratios.push(bound / truth);
            }
        }
        ratios.sort_by(f64::total_cmp);
        assert!(ratios.len() > 1000 && ratios[ratios.len() / 2] < 6.0, "{}", ratios[ratios.len() / 2]);
    }
}

#[test]
fn displaced_bounds_hold_every_point_and_missed_boxes_have_none() {
    let mut random = Random::new(6);
    for (span, roll) in [(TAU, Roll::Cylinder), (TAU, Roll::Sphere), (1.5, Roll::Cylinder)] {
        let map = Stage::Unroll(around(&Similarity::IDENTITY, span, 0.1, roll));
        let (mut known, mut missed) = (0, 0);
        for _ in 0..3000 {
            let a = random.point(&region());
            let bounds = Aabb::of([a, a + random.range(1.0, 800.0) * random.direction()]);
            let is_missed = map.misses(&bounds);
            let out = map.displaced_bounds(&bounds);
            (known, missed) = (known + usize::from(out.is_some()), missed + usize::from(is_missed));
            for _ in 0..30 {
                let Ok(q) = map.apply(random.point(&bounds)) else { continue };
                assert!(!is_missed, "{bounds:?}");
                let Some(out) = out else { continue };
                assert!((q - out.min).min_element() >= -1e-7 && (out.max - q).min_element() >= -1e-7, "{q} {out:?}");
            }
        }
        assert!(known > 2000 && (span == TAU || missed > 1000), "{known} known, {missed} missed");
    }
}

#[test]
fn an_edge_over_the_seam_is_cut_where_its_images_lie_at_both_sides() {
    let (mut random, mut cut) = (Random::new(7), 0);
    let map = around(&Similarity::IDENTITY, TAU, 0.0, Roll::Cylinder);
    for _ in 0..4000 {
        let (p0, p1) = (random.point(&region()), random.point(&region()));
        let seam = map.seam();
        if !seam.parts(p0, p1) {
            continue;
        }
        cut += 1;
        let (share, [left, right]) = seam.crossing(p0, p1).expect("they are on both sides");
        assert!(left.distance(p0.lerp(p1, share)) < 1e-4 && right.distance(left) < 1e-4);
        let azimuth = |p: DVec3| {
            let q = map.apply(p).expect("beside the seam") - map.eye();
            let right = DVec2::new(map.heading().y, -map.heading().x);
            q.truncate().dot(right) / q.truncate().dot(map.heading())
        };
        assert!((azimuth(left) + PI).abs() < 1e-6 && (azimuth(right) - PI).abs() < 1e-6);
        let (other, points) = seam.crossing(p1, p0).expect("the same edge");
        assert!((share + other - 1.0).abs() < 1e-15 && points == [left, right]);
    }
    assert!(cut > 300, "{cut}");
}

#[test]
fn spans_and_headings_out_of_range_are_refused() {
    let made = |heading, span, slope| Unroll::new(EYE, heading, span, slope, Roll::Cylinder);
    assert!(made(DVec2::Y, TAU, 0.0).is_some());
    for (heading, span, slope) in [
        (DVec2::ZERO, 1.0, 0.0),
        (DVec2::Y, 0.0, 0.0),
        (DVec2::Y, 7.0, 0.0),
        (DVec2::Y, 1.0, f64::NAN),
        (DVec2::NAN, 1.0, 0.0),
    ] {
        assert!(made(heading, span, slope).is_none(), "{heading} {span} {slope}");
    }
}
