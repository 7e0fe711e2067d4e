//! Unrolled strips along a route: laws, an independent reference, bounds, and routes that are refused.

use belvedere_core::map::straighten::{BEND_SHARE, SmoothedRoute, StraightenError, Strip};
use belvedere_core::{Aabb, DVec2, DVec3, Miss, Pinhole, Projection, SpaceMap, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{Continuity, Joint, MapCase, Similarity};

const HALF_WIDTH: f64 = 300.0;
const SMOOTHING: f64 = 260.0;

/// A road with bends to both sides.
fn road() -> Vec<DVec2> {
    let place = |i: i32| {
        let t = f64::from(i) / 60.0;
        DVec2::new(7000.0 * t + 300.0 * (9.0 * t).sin(), 900.0 * (7.0 * t).sin() + 250.0 * (17.0 * t).cos())
    };
    (0..=60).map(place).collect()
}

fn moved(s: &Similarity, p: DVec2) -> DVec2 {
    s.point(p.extend(0.0)).truncate()
}

fn shared(s: &Similarity, share: f64) -> Strip {
    let points: Vec<DVec2> = road().into_iter().map(|p| moved(s, p)).collect();
    let (width, smoothing) = (s.length(HALF_WIDTH), s.length(SMOOTHING));
    let route = SmoothedRoute::new(&points, width, Some(smoothing)).unwrap_or_else(|e| panic!("{e}"));
    Strip::new(route.curve, width, share, moved(s, DVec2::new(2500.0, 0.0))).unwrap_or_else(|e| panic!("{e}"))
}

fn strip(s: &Similarity) -> Strip {
    shared(s, 1.0)
}

fn region() -> Aabb {
    Aabb::of([DVec3::new(-500.0, -1300.0, -100.0), DVec3::new(7600.0, 1300.0, 900.0)])
}

fn case(name: &str, make: fn(&Similarity) -> Strip) -> MapCase<Strip> {
    let map = make(&Similarity::IDENTITY);
    // Where the curve becomes straight its curvature begins to change at once.
    let joint = |g: f64| {
        let at = map.line().at(g);
        Joint { point: (at.p + 150.0 * at.tangent().perp()).extend(50.0), across: at.tangent().extend(0.0) }
    };
    let joints = [joint(0.0), joint(map.line().length()), joint(20.0 * map.line().spacing())];
    // Rounding may put points very near the border on either side of it once the case is moved.
    MapCase::new(name, region(), make)
        .continuity(Continuity::C1)
        .joints(joints)
        .upright()
        .domain(0.15, |map, p| map.coordinates(p).is_some_and(|at| at.a.abs() < 0.999_999 * map.half_width()))
        .identity_at_zero_strength(|| shared(&Similarity::IDENTITY, 0.0))
}

fn straightened() -> MapCase<Strip> {
    case("strip", strip)
}

fn half() -> MapCase<Strip> {
    case("half a strip", |s| shared(s, 0.5))
}

belvedere_testkit::space_map_laws!(straight_laws, super::straightened());
belvedere_testkit::space_map_laws!(half_laws, super::half());

/// Foot of a point on a dense polyline: arc length, distance to the left, position and direction.
fn dense_foot(line: &[DVec2], p: DVec2) -> (f64, f64, DVec2, DVec2) {
    let (mut along, mut best) = (0.0, (0.0, f64::INFINITY, DVec2::ZERO, DVec2::X));
    for pair in line.windows(2) {
        let (from, way) = (pair[0], pair[1] - pair[0]);
        let t = ((p - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        let (foot, direction) = (from + t * way, way.normalize());
        if foot.distance(p) < best.1 {
            best = (along + t * way.length(), foot.distance(p), foot, direction);
        }
        along += way.length();
    }
    (best.0, best.3.perp_dot(p - best.2), best.2, best.3)
}

#[test]
fn a_dense_polyline_unrolled_agrees() {
    let map = strip(&Similarity::IDENTITY);
    let curve = map.line();
    let per = 400;
    let steps = (curve.curvature().len() - 1) * per;
    let line: Vec<DVec2> = (0..=steps).map(|i| curve.at(curve.length() * i as f64 / steps as f64).p).collect();
    let anchor = dense_foot(&line, DVec2::new(2500.0, 0.0));
    let mut random = Random::new(3);
    let mut inside = 0;
    for _ in 0..300 {
        let p = random.point(&region());
        let (g, a, foot, _) = dense_foot(&line, p.truncate());
        if !(g > 1.0 && g < curve.length() - 1.0) {
            continue;
        }
        match map.apply(p) {
            Ok(q) => {
                // The curve straightened to the line through the anchor in the direction of its tangent.
                let expected = anchor.2 + (g - anchor.0) * anchor.3 + a * anchor.3.perp();
                assert!(q.truncate().distance(expected) < 0.02 && q.z == p.z, "{p}: {q}, expected {expected}");
                inside += 1;
            }
            Err(miss) => assert!(miss == Miss::OutsideDomain && foot.distance(p.truncate()) > HALF_WIDTH - 1e-3),
        }
    }
    assert!(inside > 60, "{inside} points only");
}

#[test]
fn positions_tangents_and_curvatures_belong_together() {
    let map = shared(&Similarity::IDENTITY, 0.4);
    for curve in [map.line(), map.unrolled()] {
        let mut random = Random::new(4);
        for _ in 0..2000 {
            let (g, h) = (random.range(-300.0, curve.length() + 300.0), 1e-3);
            let [before, at, after] = [g - h, g, g + h].map(|g| curve.at(g));
            assert!(((after.p - before.p) / (2.0 * h) - at.tangent()).length() < 1e-8);
            let bend = (after.tangent() - before.tangent()).dot(at.tangent().perp()) / (2.0 * h);
            assert!((bend - at.curvature).abs() < 1e-8 && (at.tangent().length() - 1.0).abs() < 1e-14);
        }
        // Arc length, by fine chords.
        let n = 400_000;
        let at = |i: i32| curve.at(curve.length() * f64::from(i) / f64::from(n)).p;
        let length: f64 = (0..n).map(|i| at(i).distance(at(i + 1))).sum();
        assert!((length - curve.length()).abs() < 1e-6, "{length} {}", curve.length());
    }
}

#[test]
fn nothing_moves_at_the_anchor() {
    for share in [0.3, 1.0] {
        let map = shared(&Similarity::IDENTITY, share);
        let at = map.line().at(map.line().nearest(map.anchor()));
        for (t, n) in [(0.0, 0.0), (1.0, 3.0), (-2.0, 1.0)] {
            let p = (at.p + t * at.tangent() + n * at.tangent().perp()).extend(7.0);
            assert!(map.apply(p).unwrap().distance(p) < 0.01, "{p} {}", map.apply(p).unwrap());
        }
        let p = at.p.extend(3.0);
        assert!(map.apply(p).unwrap().distance(p) < 1e-9);
    }
}

/// A random point of the strip.
fn places(map: &Strip, random: &mut Random) -> DVec3 {
    let at = map.line().at(random.range(-400.0, map.line().length() + 400.0));
    (at.p + random.range(-1.0, 1.0) * map.half_width() * at.tangent().perp()).extend(random.range(0.0, 500.0))
}

#[test]
fn edge_bound_is_never_below_the_sampled_truth() {
    let mut random = Random::new(5);
    for map in [strip(&Similarity::IDENTITY), shared(&Similarity::IDENTITY, 0.5)] {
        let (mut ratios, mut unknown) = (Vec::new(), 0);
        for _ in 0..6000 {
            let p0 = places(&map, &mut random);
            let p1 = p0 + random.direction() * 10f64.powf(random.range(0.0, 2.5));
            let bound = map.edge_bound(p0, p1);
            if bound.is_infinite() {
                unknown += 1;
                continue;
            }
            let (q0, q1) = (map.apply(p0).unwrap(), map.apply(p1).unwrap());
            let off = |i: i32| {
                let t = f64::from(i) / 64.0;
                map.apply(p0.lerp(p1, t)).expect("a known edge has an image").distance(q0.lerp(q1, t))
            };
            let truth = (1..64).map(off).fold(0.0, f64::max);
            assert!(bound >= truth - 1e-9, "{p0} {p1}: bound {bound}, truth {truth}");
            if truth > 1e-3 {
                ratios.push(bound / truth);
            }
        }
        ratios.sort_by(f64::total_cmp);
        let middle = ratios[ratios.len() / 2];
        assert!(middle < 25.0, "half of the bounds are {middle} times too large");
        assert!(unknown < 3000 && ratios.len() > 1000, "{unknown} unknown, {} compared", ratios.len());
    }
}

#[test]
fn displaced_bounds_hold_every_point_and_missed_boxes_have_none() {
    let mut random = Random::new(6);
    let map = Stage::Strip(strip(&Similarity::IDENTITY));
    let (mut known, mut missed) = (0, 0);
    for _ in 0..3000 {
        let a = random.point(&region());
        let bounds = Aabb::of([a, a + random.range(1.0, 300.0) * random.direction()]);
        let inside = |random: &mut Random| map.apply(random.point(&bounds));
        if map.misses(&bounds) {
            missed += 1;
            (0..40).for_each(|_| assert_eq!(inside(&mut random), Err(Miss::OutsideDomain)));
        }
        let Some(out) = map.displaced_bounds(&bounds) else { continue };
        known += 1;
        for _ in 0..40 {
            let q = inside(&mut random).expect("all of the box has an image");
            assert!((q - out.min).min_element() >= -1e-9 && (out.max - q).min_element() >= -1e-9, "{q} {out:?}");
        }
        assert!((out.max - out.min).length() < 20.0 * (bounds.max - bounds.min).length() + 1.0);
    }
    assert!(known > 200 && missed > 1000, "{known} known, {missed} missed");
}

#[test]
fn outside_is_a_bound_of_the_way_to_the_strip() {
    let mut random = Random::new(7);
    for map in [strip(&Similarity::IDENTITY), shared(&Similarity::IDENTITY, 0.5)] {
        for _ in 0..2000 {
            let q = random.point(&region());
            let off = map.outside(q);
            let other = q + random.range(0.0, 1.0) * off.max(0.0) * random.direction();
            assert!(off <= 0.0 || map.invert(other).is_err(), "{q} {off} {other}");
            assert!(off <= 0.0 || map.invert(q).is_err());
            assert!(off > -20.0 || map.invert(q).is_ok(), "{q} {off}");
        }
    }
}

#[test]
fn eased_strips_unroll_by_and_by() {
    let camera = Pinhole::look_at(
        DVec3::new(-900.0, 0.0, 700.0),
        DVec3::new(2500.0, 0.0, 0.0),
        DVec3::Z,
        Projection::Perspective { fov_y: 0.8 },
        [640, 360],
        1.0,
        None,
    )
    .unwrap();
    let view = View::new(camera, vec![Stage::Strip(strip(&Similarity::IDENTITY))]).unwrap();
    let p = strip(&Similarity::IDENTITY).line().at(6000.0).p.extend(0.0);
    let moved = |share: f64| view.eased(share).unwrap().displace(p).unwrap().point.distance(p);
    let ways = [0.001, 0.25, 0.5, 0.75, 1.0].map(moved);
    assert!(ways[0] < 5.0 && ways.windows(2).all(|w| w[0] < w[1]), "{ways:?}");
}

/// A half circle of this radius and straight legs of this length.
fn hairpin(radius: f64, leg: f64) -> Vec<DVec2> {
    let arc = (0..=60).map(|i| {
        let angle = f64::from(i) / 60.0 * std::f64::consts::PI - std::f64::consts::FRAC_PI_2;
        DVec2::new(leg, 0.0) + radius * DVec2::from_angle(angle)
    });
    std::iter::once(DVec2::new(0.0, -radius)).chain(arc).chain([DVec2::new(0.0, radius)]).collect()
}

#[test]
fn strips_that_overlap_are_refused_and_smoothing_cures_them() {
    // Between the legs there is less than two half widths, though every bend is wide enough.
    let turns: Vec<DVec2> = [
        [0.0, 0.0],
        [8000.0, 0.0],
        [10_000.0, 1000.0],
        [11_000.0, 3000.0],
        [10_000.0, 5000.0],
        [8000.0, 6000.0],
        [6000.0, 5000.0],
        [5200.0, 3000.0],
        [5200.0, 1000.0],
        [5200.0, 700.0],
    ]
    .map(DVec2::from_array)
    .to_vec();
    let refused = SmoothedRoute::new(&turns, 400.0, Some(240.0)).unwrap_err();
    let StraightenError::Overlap { at, distance, widest, .. } = refused else { panic!("{refused:?}") };
    assert!(at.distance(DVec3::new(5200.0, 350.0, 0.0)) < 100.0 && (distance - 700.0).abs() < 30.0, "{at} {distance}");
    let narrow = SmoothedRoute::new(&turns, 0.99 * widest, Some(240.0)).unwrap();
    // The straight extension would cross the road: it ends before.
    assert!(narrow.curve.reach()[1] < narrow.curve.length() + 100.0);
    assert!(narrow.curve.reach()[0] < -1e6);
    let smoother = SmoothedRoute::new(&turns, 400.0, None).unwrap();
    assert!(smoother.smoothing > 240.0 && smoother.off > 100.0, "{}", smoother.smoothing);
    let map = Strip::new(smoother.curve, 400.0, 1.0, turns[0]).unwrap();
    for i in 0..200 {
        let at = map.line().at(f64::from(i) / 199.0 * map.line().length());
        for a in [-399.0, 399.0] {
            let p = (at.p + a * at.tangent().perp()).extend(0.0);
            let back = map.invert(map.apply(p).unwrap()).unwrap();
            assert!(back.distance(p) < 1e-6);
        }
    }
}

#[test]
fn widths_keep_their_share_of_the_radius() {
    let pin = hairpin(1000.0, 3000.0);
    let refused = SmoothedRoute::new(&pin, 900.0, Some(60.0)).unwrap_err();
    let StraightenError::Radius { radius, widest, .. } = refused else { panic!("{refused:?}") };
    assert!((radius - 1000.0).abs() < 30.0 && (widest - BEND_SHARE * radius).abs() < 1e-9, "{refused}");
    assert!(SmoothedRoute::new(&pin, 0.99 * widest, Some(60.0)).is_ok());
    let route = SmoothedRoute::new(&pin, 700.0, None).unwrap();
    assert!(route.curve.largest_curvature() <= BEND_SHARE / 700.0 && route.off < 60.0, "{}", route.off);
    let wide = Strip::new(route.curve, 5000.0, 1.0, pin[0]).unwrap_err();
    assert!(matches!(wide, StraightenError::Radius { .. }), "{wide}");
}

#[test]
fn smoothed_routes_stay_near_and_keep_their_ends() {
    let route = SmoothedRoute::new(&road(), HALF_WIDTH, None).unwrap();
    assert!(route.off < 150.0, "{}", route.off);
    let [first, last] = [0.0, route.curve.length()].map(|g| route.curve.at(g).p);
    assert!(first.distance(road()[0]) < 5.0 && last.distance(road()[60]) < 5.0);
    let straight = SmoothedRoute::new(&[DVec2::ZERO, DVec2::new(1000.0, 0.0)], 400.0, None).unwrap();
    assert!(straight.off < 1e-9 && straight.curve.largest_curvature() < 1e-12);
}

#[test]
fn routes_that_make_no_strip_are_refused() {
    let refused = |points: &[DVec2], width: f64, smoothing| SmoothedRoute::new(points, width, smoothing).unwrap_err();
    let line = [DVec2::ZERO, DVec2::new(1000.0, 0.0)];
    assert!(matches!(refused(&[], 10.0, None), StraightenError::TooShort { points: 0, .. }));
    assert!(matches!(refused(&line[..1], 10.0, None), StraightenError::TooShort { points: 1, .. }));
    assert!(matches!(refused(&[line[1]; 5], 10.0, None), StraightenError::TooShort { points: 5, .. }));
    let hole = [line[0], DVec2::new(f64::NAN, 0.0), line[1]];
    assert!(matches!(refused(&hole, 10.0, None), StraightenError::NotFinite { index: 1, .. }));
    assert!(matches!(refused(&[DVec2::ZERO, DVec2::splat(1e300)], 10.0, None), StraightenError::NotFinite { .. }));
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(&line, width, None), StraightenError::Range { key: "half_width", .. }));
        assert!(matches!(refused(&line, 10.0, Some(width)), StraightenError::Range { key: "smoothing", .. }));
    }
    let circle: Vec<DVec2> = (0..=90).map(|i| 1000.0 * DVec2::from_angle(f64::from(i) * 4f64.to_radians())).collect();
    assert!(matches!(refused(&circle, 100.0, None), StraightenError::Winds { .. }));
    assert!(matches!(refused(&line, 1e-3, None), StraightenError::TooFine { .. }));
    // The route leads there and back, with doubled points: only the straight line between the ends is left.
    let back = [line[0], line[0], line[1], line[1], DVec2::new(500.0, 1.0), DVec2::new(500.0, 1.0)];
    let folded = SmoothedRoute::new(&back, 50.0, None).unwrap();
    assert!(folded.off > 100.0, "{} {} {}", folded.off, folded.smoothing, folded.curve.length());
    let route = SmoothedRoute::new(&road(), HALF_WIDTH, None).unwrap();
    for share in [-0.1, 1.1, f64::NAN] {
        let made = Strip::new(route.curve.clone(), HALF_WIDTH, share, DVec2::ZERO);
        assert!(matches!(made, Err(StraightenError::Range { key: "share", .. })));
    }
    let made = Strip::new(route.curve, HALF_WIDTH, 1.0, DVec2::NAN);
    assert!(matches!(made, Err(StraightenError::Range { key: "anchor", .. })));
}

#[test]
fn hairpins_are_smoothed_or_refused_but_never_folded() {
    let mut random = Random::new(9);
    let mut made = 0;
    for _ in 0..120 {
        let mut at = DVec2::ZERO;
        let points: Vec<DVec2> = (0..24)
            .map(|i| {
                at += DVec2::new(
                    random.range(-150.0, 400.0),
                    if i % 2 == 0 { 500.0 } else { -450.0 } * random.range(0.2, 1.0),
                );
                at
            })
            .collect();
        let width = 10f64.powf(random.range(1.5, 2.8));
        let Ok(route) = SmoothedRoute::new(&points, width, None) else { continue };
        let map = Strip::new(route.curve, width, random.range(0.3, 1.0), points[5]);
        let Ok(map) = map else { continue };
        made += 1;
        for _ in 0..50 {
            let p = (points[3] + DVec2::new(random.range(-500.0, 5000.0), random.range(-900.0, 900.0))).extend(1.0);
            let Ok(q) = map.apply(p) else { continue };
            let back = map.invert(q).unwrap_or_else(|miss| panic!("{p} {q} {miss:?}"));
            assert!(back.distance(p) < 1e-6 && map.jacobian(p).unwrap().determinant() > 0.0, "{p} {q} {back}");
        }
    }
    assert!(made > 80, "{made}");
}

/// Wherever the ground stands, also around the origin, and however short the route is.
#[test]
fn points_of_a_strip_reach_both_ends_of_the_ground() {
    for middle in [DVec2::ZERO, DVec2::new(4e5, -3e6)] {
        let route = [[25.0, -300.0], [26.0, -250.0], [25.0, -200.0]].map(|p| middle + DVec2::from_array(p));
        let route = SmoothedRoute::new(&route, 12.0, None).expect("it fits");
        let strip = Strip::new(route.curve, 12.0, 1.0, middle).expect("it fits");
        let side = DVec2::splat(575.0);
        let bounds = Aabb { min: (middle - side).extend(0.0), max: (middle + side).extend(10.0) };
        let points = strip.points_within(&bounds);
        let along = |p: &DVec3| p.y - middle.y;
        let ends = points.iter().map(along).fold([0.0f64; 2], |[south, north], y| [south.min(y), north.max(y)]);
        assert!(ends[0] < -550.0 && ends[1] > 550.0, "{ends:?} around {middle}");
        assert!(points.iter().all(|p| p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()));
    }
}
