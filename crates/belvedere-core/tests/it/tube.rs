//! Straightened tubes along a centreline: laws, independent references, and what happens where the tube meets itself.

use belvedere_core::map::straighten::{SmoothedCentreline, StraightenError, Tube};
use belvedere_core::{Aabb, DVec2, DVec3, Miss, SpaceMap, Stage};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{Continuity, Joint, MapCase, Similarity};

const RADIUS: f64 = 3.5;
const SMOOTHING: f64 = 2.0;

/// A vessel that bends in every direction.
fn vessel() -> Vec<DVec3> {
    let place = |i: i32| {
        let t = f64::from(i) / 40.0;
        DVec3::new(30.0 * (1.3 * t).cos(), 24.0 * (1.1 * t).sin() + 9.0 * t, 12.0 * (1.7 * t).sin() + 4.0 * t)
    };
    (0..=200).map(place).collect()
}

fn shared(s: &Similarity, share: f64) -> Tube {
    let points: Vec<DVec3> = vessel().into_iter().map(|p| s.point(p)).collect();
    let line = SmoothedCentreline::new(&points, s.length(RADIUS), Some(s.length(SMOOTHING)));
    let line = line.unwrap_or_else(|e| panic!("{e}"));
    Tube::new(line.curve, s.length(RADIUS), share, s.point(vessel()[90])).unwrap_or_else(|e| panic!("{e}"))
}

/// A tube whose radius is larger than its sharpest bends allow.
fn parted(s: &Similarity, share: f64) -> Tube {
    let points: Vec<DVec3> = vessel().into_iter().map(|p| s.point(p)).collect();
    let line = SmoothedCentreline::new(&points, s.length(2.0), None).unwrap_or_else(|e| panic!("{e}"));
    Tube::parted(line.curve, s.length(20.0), share, s.point(vessel()[90])).unwrap_or_else(|e| panic!("{e}"))
}

fn region() -> Aabb {
    let around = Aabb::of(vessel());
    Aabb { min: around.min - DVec3::splat(RADIUS), max: around.max + DVec3::splat(RADIUS) }
}

fn case(name: &str, make: fn(&Similarity) -> Tube) -> MapCase<Tube> {
    let map = make(&Similarity::IDENTITY);
    let joint = |g: f64| {
        let at = map.line().at(g);
        Joint { point: at.beside(DVec2::new(2.0, -1.5)), across: at.tangent() }
    };
    let joints = [joint(0.0), joint(map.line().length()), joint(20.0 * map.line().spacing())];
    MapCase::new(name, region(), make)
        .continuity(Continuity::C1)
        .joints(joints)
        .domain(0.05, |map, p| map.coordinates(p).is_some_and(|at| at.a.length() < 0.999_999 * map.half_width()))
        .identity_at_zero_strength(|| shared(&Similarity::IDENTITY, 0.0))
}

fn straightened() -> MapCase<Tube> {
    case("tube", |s| shared(s, 1.0))
}

fn half() -> MapCase<Tube> {
    case("half a tube", |s| shared(s, 0.5))
}

belvedere_testkit::space_map_laws!(straight_laws, super::straightened());
belvedere_testkit::space_map_laws!(half_laws, super::half());

/// A dense polyline along a curve, with a rotation-minimising normal at each point by double reflection (Wang and others 2008).
fn dense(map: &Tube, steps: usize, first: DVec3) -> Vec<(DVec3, DVec3, DVec3)> {
    let at = |i: usize| map.line().at(map.line().length() * i as f64 / steps as f64);
    let mut normal = first;
    let mut out: Vec<(DVec3, DVec3, DVec3)> = Vec::new();
    for i in 0..=steps {
        let (p, tangent) = (at(i).p, at(i).tangent());
        if let Some((before, along, _)) = out.last() {
            let reflect = |v: DVec3, n: DVec3| v - 2.0 * v.dot(n) / n.length_squared() * n;
            let chord = p - *before;
            let (r, t) = (reflect(normal, chord), reflect(*along, chord));
            normal = reflect(r, tangent - t);
        }
        out.push((p, tangent, normal));
    }
    out
}

#[test]
fn frames_are_those_of_double_reflection_and_lengths_are_kept() {
    let map = shared(&Similarity::IDENTITY, 1.0);
    let steps = 20_000;
    let along = |i: usize| map.line().length() * i as f64 / steps as f64;
    let first = map.line().at(0.0);
    let line = dense(&map, steps, first.beside(DVec2::X) - first.p);
    let length: f64 = line.windows(2).map(|w| w[0].0.distance(w[1].0)).sum();
    assert!((length - map.line().length()).abs() < 1e-5, "{length} {}", map.line().length());
    let mut turned = 0.0f64;
    for (i, (_, tangent, normal)) in line.iter().enumerate() {
        let frame = map.line().at(along(i));
        let own = frame.beside(DVec2::X) - frame.p;
        turned = turned.max(own.distance(*normal)).max(own.dot(*tangent).abs());
    }
    assert!(turned < 2e-6, "frames differ by {turned} radians");
}

#[test]
fn a_cross_section_lies_straightened_where_its_arc_length_says() {
    let map = shared(&Similarity::IDENTITY, 1.0);
    let anchor = map.line().at(map.line().nearest(map.anchor()));
    let (start, turned) = (map.line().nearest(map.anchor()), anchor.beside(DVec2::X) - anchor.p);
    let mut random = Random::new(2);
    for _ in 0..2000 {
        let g = random.range(0.0, map.line().length());
        let a = random.range(0.0, 0.99 * RADIUS) * DVec2::from_angle(random.range(0.0, 7.0));
        let across = a.x * turned + a.y * anchor.tangent().cross(turned);
        let expected = anchor.p + (g - start) * anchor.tangent() + across;
        let q = map.apply(map.line().at(g).beside(a)).expect("inside");
        assert!(q.distance(expected) < 1e-9, "{q} {expected}");
    }
}

/// By Higham's iteration from the derivative.
#[test]
fn bodies_turn_as_the_derivative_does() {
    let mut random = Random::new(4);
    for map in [shared(&Similarity::IDENTITY, 1.0), shared(&Similarity::IDENTITY, 0.4)] {
        for _ in 0..300 {
            let p =
                map.line().at(random.range(0.0, map.line().length())).beside(DVec2::new(random.range(-2.0, 2.0), 1.0));
            let mut expected = map.jacobian(p).expect("inside");
            for _ in 0..40 {
                expected = 0.5 * (expected + expected.inverse().transpose());
            }
            let found = Stage::Tube(map.clone()).rotation_of_body(p).expect("inside");
            let off = (found - expected).to_cols_array().into_iter().fold(0.0f64, |most, v| most.max(v.abs()));
            assert!(off < 1e-9, "{off} at {p}");
        }
    }
}

#[test]
fn nothing_moves_at_the_anchor() {
    for map in
        [shared(&Similarity::IDENTITY, 1.0), shared(&Similarity::IDENTITY, 0.3), parted(&Similarity::IDENTITY, 1.0)]
    {
        let at = map.line().at(map.line().nearest(map.anchor()));
        assert!(map.apply(at.p).unwrap().distance(at.p) < 1e-9);
        let beside = at.beside(DVec2::new(1.0, -2.0));
        assert!(map.apply(beside).unwrap().distance(beside) < 1e-9);
        let ahead = at.p + 0.5 * at.tangent();
        assert!(map.apply(ahead).unwrap().distance(ahead) < 0.05);
    }
}

#[test]
fn edge_bound_is_never_below_the_sampled_truth() {
    let mut random = Random::new(5);
    for map in [shared(&Similarity::IDENTITY, 1.0), shared(&Similarity::IDENTITY, 0.5)] {
        let (mut known, mut ratios) = (0, Vec::new());
        for _ in 0..4000 {
            let at = map.line().at(random.range(0.0, map.line().length()));
            let p0 = at.beside(random.range(0.0, RADIUS) * DVec2::from_angle(random.range(0.0, 7.0)));
            let p1 = p0 + random.direction() * 10f64.powf(random.range(-1.5, 1.0));
            let bound = map.edge_bound(p0, p1);
            if bound.is_infinite() {
                continue;
            }
            known += 1;
            let (q0, q1) = (map.apply(p0).unwrap(), map.apply(p1).unwrap());
            let off = |i: i32| {
                let t = f64::from(i) / 48.0;
                map.apply(p0.lerp(p1, t)).expect("a known edge has an image").distance(q0.lerp(q1, t))
            };
            let truth = (1..48).map(off).fold(0.0, f64::max);
            assert!(bound >= truth - 1e-9, "{p0} {p1}: bound {bound}, truth {truth}");
            if truth > 1e-4 {
                ratios.push(bound / truth);
            }
        }
        ratios.sort_by(f64::total_cmp);
        assert!(known > 1000 && ratios[ratios.len() / 2] < 25.0, "{known} {}", ratios[ratios.len() / 2]);
    }
}

#[test]
fn displaced_bounds_hold_every_point_and_missed_boxes_have_none() {
    let mut random = Random::new(6);
    let map = Stage::Tube(shared(&Similarity::IDENTITY, 1.0));
    let (mut known, mut missed) = (0, 0);
    for _ in 0..6000 {
        let a = random.point(&region());
        let bounds = Aabb::of([a, a + random.range(0.1, 4.0) * random.direction()]);
        let inside = |random: &mut Random| map.apply(random.point(&bounds));
        if map.misses(&bounds) {
            missed += 1;
            (0..20).for_each(|_| assert_eq!(inside(&mut random), Err(Miss::OutsideDomain)));
        }
        let Some(out) = map.displaced_bounds(&bounds) else { continue };
        known += 1;
        for _ in 0..20 {
            let q = inside(&mut random).expect("all of the box has an image");
            assert!((q - out.min).min_element() >= -1e-9 && (out.max - q).min_element() >= -1e-9, "{q} {out:?}");
        }
    }
    assert!(known > 100 && missed > 1000, "{known} known, {missed} missed");
}

/// Distance of a point from a dense polyline.
fn off(line: &[DVec3], p: DVec3) -> f64 {
    line.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min)
}

#[test]
fn points_of_a_tube_that_meets_itself_belong_to_the_nearest_part() {
    for share in [1.0, 0.4] {
        let map = parted(&Similarity::IDENTITY, share);
        assert!(1.0 / map.line().largest_curvature() < map.half_width(), "it must bend too sharply for its radius");
        let steps = 4000;
        let line: Vec<DVec3> =
            (0..=steps).map(|i| map.line().at(map.line().length() * f64::from(i) / f64::from(steps)).p).collect();
        let mut random = Random::new(8);
        let (mut inside, mut cut) = (0, 0);
        for _ in 0..4000 {
            let g = random.range(0.0, map.line().length());
            let p = map
                .line()
                .at(g)
                .beside(random.range(0.0, map.half_width()) * DVec2::from_angle(random.range(0.0, 7.0)));
            match map.apply(p) {
                Ok(q) => {
                    inside += 1;
                    assert!(map.invert(q).expect("an image has its point").distance(p) < 1e-6, "{p}");
                    let at = map.coordinates(p).expect("inside");
                    let nearest = off(&line, p).min(map.line().at(at.g).p.distance(p));
                    assert!(
                        at.a.length() <= nearest + 1e-3,
                        "{p}: {} from its foot, {nearest} from the line",
                        at.a.length()
                    );
                    assert!(map.jacobian(p).expect("inside").determinant() > 0.0);
                }
                Err(miss) => {
                    cut += 1;
                    assert_eq!(miss, Miss::OutsideDomain);
                }
            }
        }
        assert!(inside > 1500 && cut > 0, "share {share}: {inside} inside, {cut} cut");
        // What is drawn at a place of the straightened picture is drawn once.
        let mut empty = 0;
        for _ in 0..2000 {
            let g = random.range(0.0, map.line().length());
            let q = map
                .unrolled()
                .at(g)
                .beside(random.range(0.0, map.half_width()) * DVec2::from_angle(random.range(0.0, 7.0)));
            match map.invert(q) {
                Ok(p) => assert!(map.apply(p).expect("a point has its image").distance(q) < 1e-6, "{q}"),
                Err(_) => empty += 1,
            }
        }
        assert!((100..1500).contains(&empty), "{empty} of 2000 places are empty");
    }
}

#[test]
fn near_the_centreline_nothing_is_cut() {
    let map = parted(&Similarity::IDENTITY, 1.0);
    let radius = 0.7 / map.line().largest_curvature();
    let mut random = Random::new(9);
    for _ in 0..2000 {
        let at = map.line().at(random.range(0.0, map.line().length()));
        let p = at.beside(random.range(0.0, radius) * DVec2::from_angle(random.range(0.0, 7.0)));
        assert!(map.apply(p).is_ok(), "{p}");
    }
}

#[test]
fn a_line_that_needs_no_smoothing_keeps_its_length_and_place() {
    let points = vessel();
    let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    let line = SmoothedCentreline::new(&points, 2.0, None).expect("it fits");
    assert!((line.curve.length() / length - 1.0).abs() < 0.01, "{} of {length}", line.curve.length());
    assert!(line.off < 0.1, "{}", line.off);
    let ends = [0.0, line.curve.length()].map(|g| line.curve.at(g).p);
    assert!(ends[0].distance(points[0]) < 0.05 && ends[1].distance(points[200]) < 0.05, "{ends:?}");
}

#[test]
fn refusals_speak_of_tubes() {
    let points = vessel();
    let wide = SmoothedCentreline::new(&points, 60.0, Some(1.0)).unwrap_err();
    assert!(matches!(wide, StraightenError::Radius { .. }), "{wide}");
    assert!(wide.to_string().contains("centreline bends") && wide.to_string().contains("a radius of 60"), "{wide}");
    let short = SmoothedCentreline::new(&points[..1], 1.0, None).unwrap_err();
    assert!(short.to_string().contains("the centreline has 1 points"), "{short}");
    let fine = SmoothedCentreline::new(&points, 0.05, None).expect("it fits").curve;
    let many = Tube::parted(fine, 200.0, 1.0, points[0]).unwrap_err();
    assert!(matches!(many, StraightenError::TooMany { .. }) && many.to_string().contains("smooth more"), "{many}");
    let hole = SmoothedCentreline::new(&[DVec3::ZERO, DVec3::NAN], 1.0, None).unwrap_err();
    assert!(matches!(hole, StraightenError::NotFinite { index: 1, .. }));
}
