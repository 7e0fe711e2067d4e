//! Changes of relief: laws, bounds, and the effect of each.

use belvedere_core::map::relief::{BaseError, BaseSurface, Relief, ReliefError, ReliefShape};
use belvedere_core::map::spline::ReferencePlane;
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole, Projection, SpaceMap, Stage};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{Continuity, Joint, MapCase, Similarity};
use std::sync::Arc;

const RANGE: [f64; 2] = [1000.0, 3000.0];

fn camera(s: &Similarity) -> Pinhole {
    let [eye, target] = [DVec3::new(0.0, -1000.0, 500.0), DVec3::new(200.0, 400.0, 0.0)].map(|p| s.point(p));
    let screen = Projection::Perspective { fov_y: 0.8 };
    Pinhole::look_at(eye, target, s.direction(DVec3::Z), screen, [1280, 720], 1.0, None).unwrap()
}

/// All but levelling.
fn shaped(s: &Similarity) -> Relief {
    let normal = s.direction(DVec3::Z);
    let plane = ReferencePlane::new(normal, s.point(DVec3::ZERO).dot(normal)).unwrap();
    let shape = ReliefShape {
        exaggeration: [0.7, 2.5],
        oblique: 0.8,
        horizon_radius: s.length(4000.0),
        levelling: 0.0,
        range: RANGE.map(|r| s.length(r)),
    };
    Relief::new(&camera(s), &plane, shape, None).unwrap()
}

fn base() -> BaseSurface {
    let mut random = Random::new(11);
    let heights = (0..20 * 24).map(|_| random.range(-150.0, 350.0)).collect();
    BaseSurface::new(DVec2::new(-900.0, -1200.0), 150.0, 20, heights).unwrap()
}

fn levelled(levelling: f64) -> Relief {
    let shape = ReliefShape { levelling, exaggeration: [1.5, 0.8], oblique: 0.3, ..ReliefShape::none(RANGE) };
    Relief::new(&camera(&Similarity::IDENTITY), &ReferencePlane::level(20.0), shape, Some(Arc::new(base()))).unwrap()
}

fn region() -> Aabb {
    Aabb::of([DVec3::new(-1500.0, -1500.0, -200.0), DVec3::new(2500.0, 3500.0, 900.0)])
}

fn case() -> MapCase<Relief> {
    let relief = shaped(&Similarity::IDENTITY);
    let [_, heading, _] = relief.axes();
    let joint = |at: f64| Joint { point: DVec3::new(0.0, -1000.0, 300.0) + at * heading, across: heading };
    MapCase::new("relief", region(), shaped)
        .continuity(Continuity::C1)
        .joints(RANGE.map(joint))
        .identity_at_zero_strength(|| {
            Relief::new(&camera(&Similarity::IDENTITY), &ReferencePlane::level(0.0), ReliefShape::none(RANGE), None)
                .unwrap()
        })
}

fn levelled_case() -> MapCase<Relief> {
    // The base surface cannot be rotated with the case, so the case is not moved.
    MapCase::new("levelled", region(), |_| levelled(0.9)).continuity(Continuity::C1)
}

belvedere_testkit::space_map_laws!(laws, super::case());
belvedere_testkit::space_map_laws!(
    laws_of_levelling,
    super::levelled_case(),
    [round_trips, keeps_orientation, jacobian_matches_differences, never_gives_nan]
);

#[test]
fn edge_bound_is_never_below_the_sampled_truth() {
    let mut random = Random::new(5);
    for (name, map) in [("shaped", shaped(&Similarity::IDENTITY)), ("levelled", levelled(0.7))] {
        let mut ratios = Vec::new();
        for _ in 0..5000 {
            let p0 =
                DVec3::new(random.range(-1500.0, 2500.0), random.range(-1500.0, 3500.0), random.range(-200.0, 900.0));
            let p1 = p0 + random.direction() * 10f64.powf(random.range(0.0, 3.0));
            let (q0, q1) = (map.apply(p0).unwrap(), map.apply(p1).unwrap());
            let off = |i: i32| {
                let t = f64::from(i) / 64.0;
                map.apply(p0.lerp(p1, t)).unwrap().distance(q0.lerp(q1, t))
            };
            let (truth, bound) = ((1..64).map(off).fold(0.0, f64::max), map.edge_bound(p0, p1));
            assert!(bound >= truth - 1e-9, "{name}: {p0} {p1}: bound {bound}, truth {truth}");
            if truth > 1e-3 {
                ratios.push(bound / truth);
            }
        }
        ratios.sort_by(f64::total_cmp);
        assert!(
            ratios[ratios.len() / 2] < 25.0,
            "{name}: half of the bounds are {} times too large",
            ratios[ratios.len() / 2]
        );
    }
}

#[test]
fn displaced_bounds_hold_every_point() {
    let mut random = Random::new(6);
    for map in [shaped(&Similarity::IDENTITY), levelled(1.0)].map(Stage::Relief) {
        for _ in 0..500 {
            let a =
                DVec3::new(random.range(-2500.0, 2500.0), random.range(-2500.0, 3500.0), random.range(-200.0, 900.0));
            let bounds = Aabb::of([a, a + random.range(1.0, 900.0) * random.direction()]);
            let out = map.displaced_bounds(&bounds).unwrap();
            for _ in 0..50 {
                let t = DVec3::new(random.range(0.0, 1.0), random.range(0.0, 1.0), random.range(0.0, 1.0));
                let q = map.apply(bounds.min + t * (bounds.max - bounds.min)).unwrap();
                assert!((q - out.min).min_element() >= -1e-9 && (out.max - q).min_element() >= -1e-9, "{q} {out:?}");
            }
        }
    }
}

#[test]
fn each_change_does_what_it_is_named_for() {
    let ground = ReferencePlane::level(0.0);
    let ahead = Pinhole::look_at(
        DVec3::new(0.0, -1000.0, 500.0),
        DVec3::ZERO,
        DVec3::Z,
        Projection::Perspective { fov_y: 0.8 },
        [1280, 720],
        1.0,
        None,
    )
    .unwrap();
    let relief = |shape| Relief::new(&ahead, &ground, shape, None).unwrap();
    let near = DVec3::new(300.0, -100.0, 80.0);
    let far = DVec3::new(300.0, 4000.0, 80.0);
    let taller = relief(ReliefShape { exaggeration: [1.0, 2.0], ..ReliefShape::none(RANGE) });
    assert_eq!((taller.apply(near).unwrap(), taller.apply(far).unwrap()), (near, DVec3::new(300.0, 4000.0, 160.0)));
    let oblique = relief(ReliefShape { oblique: 0.5, ..ReliefShape::none(RANGE) });
    assert_eq!(oblique.apply(near).unwrap(), near + DVec3::new(0.0, 40.0, 0.0));
    let curved = relief(ReliefShape { horizon_radius: 9000.0, ..ReliefShape::none(RANGE) });
    assert_eq!((curved.apply(near).unwrap(), curved.apply(far).unwrap()), (near, far - DVec3::new(0.0, 0.0, 5.0)));
}

#[test]
fn levelling_takes_the_large_forms_away_and_keeps_what_stands_on_them() {
    let shape = ReliefShape { levelling: 1.0, ..ReliefShape::none(RANGE) };
    let (base, plane) = (base(), ReferencePlane::level(20.0));
    let map = Relief::new(&camera(&Similarity::IDENTITY), &plane, shape, Some(Arc::new(base.clone()))).unwrap();
    let mut random = Random::new(8);
    for _ in 0..1000 {
        let xy = DVec2::new(random.range(-2000.0, 3000.0), random.range(-2000.0, 3000.0));
        let above = random.range(0.0, 60.0);
        let q = map.apply(xy.extend(base.height(xy) + above)).unwrap();
        assert!((q.z - 20.0 - above).abs() < 1e-9 && q.truncate().distance(xy) < 1e-9, "{q}");
    }
    assert!(base.height(DVec2::splat(1e7)).is_finite() && base.gradient(DVec2::splat(-1e9)) == DVec2::ZERO);
}

#[test]
fn shapes_that_are_none_are_refused() {
    let plane = ReferencePlane::level(0.0);
    let made = |shape: ReliefShape| Relief::new(&camera(&Similarity::IDENTITY), &plane, shape, None).unwrap_err();
    let none = ReliefShape::none(RANGE);
    let refused = made(ReliefShape { exaggeration: [1.0, f64::NAN], ..none.clone() });
    assert!(matches!(refused, ReliefError::Range { key: "exaggeration", .. }));
    assert_eq!(made(ReliefShape { oblique: -1.0, ..none.clone() }).to_string(), "oblique is -1, it must be in 0..=5");
    assert!(matches!(made(ReliefShape { horizon_radius: 0.0, ..none.clone() }), ReliefError::Range { .. }));
    assert_eq!(made(ReliefShape { levelling: 0.5, ..none.clone() }), ReliefError::NoBase);
    assert!(matches!(made(ReliefShape { range: [5.0, 5.0], ..none }), ReliefError::Order { .. }));
    assert!(matches!(BaseSurface::new(DVec2::ZERO, 1.0, 3, vec![0.0; 7]), Err(BaseError::Shape { .. })));
    assert!(matches!(BaseSurface::new(DVec2::ZERO, 0.0, 2, vec![0.0; 4]), Err(BaseError::NotFinite { .. })));
}
