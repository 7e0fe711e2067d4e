//! Every condition of a valid camera has its own message, and its remedy corrects it; unusual but valid cameras work.

use super::cameras::{self, pinhole};
use belvedere_core::map::curved_rays::{CurvedRays, CurvedRaysError as E, Model, Pencil, Remedy, Sharpness, TurnSpec};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::Similarity;
use belvedere_testkit::rays::RandomRays;

fn root() -> Pinhole {
    pinhole(&Similarity::IDENTITY, DVec3::ZERO, DVec3::Y)
}

fn new(turns: &[TurnSpec]) -> Result<CurvedRays, E> {
    CurvedRays::new(&root(), Model::Modified, turns)
}

fn corner() -> TurnSpec {
    cameras::street_corner().turns[0]
}

fn side() -> TurnSpec {
    cameras::sideways().turns[0]
}

fn error(turns: &[TurnSpec]) -> E {
    let error = new(turns).expect_err("the camera is not valid");
    let text = error.to_string();
    assert!(!text.contains("NaN") && text.len() < 400, "{text}");
    error
}

/// The last turn, changed as the remedy says.
fn healed(turn: &TurnSpec, remedy: &Remedy) -> TurnSpec {
    let mut turn = *turn;
    match *remedy {
        Remedy::MovePoint { name: "t0", to } => turn.t0 = to,
        Remedy::MovePoint { name: "t2", to } => turn.t2 = to,
        Remedy::MovePoint { name: "viewpoint", to } => turn.viewpoint = to,
        Remedy::MovePoint { name: "line.point", to } => {
            let Pencil::Line { dir, .. } = turn.pencil else { panic!("no line") };
            turn.pencil = Pencil::Line { point: to, dir };
        }
        Remedy::MovePlanes { by } => {
            turn.t0 += by;
            turn.t1 += by;
            turn.t2 += by;
        }
        Remedy::Normal { normal } => turn.pencil = Pencil::Parallel { normal },
        Remedy::SwapPlanes => (turn.t0, turn.t2) = (turn.t2, turn.t0),
        ref other => panic!("{other:?}"),
    }
    turn
}

#[test]
fn orthographic_root() {
    let root = Pinhole { projection: Projection::Orthographic { height: 10.0 }, ..root() };
    let error = CurvedRays::new(&root, Model::Modified, &[corner()]).unwrap_err();
    assert_eq!(error, E::Orthographic);
    assert!(error.to_string().contains("perspective"));
}

#[test]
fn numbers_that_are_none() {
    let e = error(&[side(), TurnSpec { t1: DVec3::new(0.0, f64::INFINITY, 0.0), ..side() }]);
    assert!(matches!(e, E::NotFinite { turn: 2, name: "t1", .. }) || matches!(e, E::NotFinite { turn: 2, .. }), "{e}");
    let nan = new(&[TurnSpec { viewpoint: DVec3::NAN, ..side() }]).unwrap_err();
    assert!(matches!(nan, E::NotFinite { turn: 1, name: "viewpoint", .. }), "{nan}");
}

#[test]
fn numbers_beyond_all_scenes() {
    let e = error(&[TurnSpec { viewpoint: -1e16 * DVec3::Z, ..side() }]);
    assert_eq!(e, E::TooLarge { turn: 1, name: "viewpoint", value: -1e16, limit: 1e15 });
}

#[test]
fn directions_of_length_zero() {
    let e = error(&[TurnSpec { pencil: Pencil::Parallel { normal: DVec3::ZERO }, ..side() }]);
    assert_eq!(e, E::ZeroDirection { turn: 1, name: "normal" });
    let e = error(&[TurnSpec { pencil: Pencil::Line { point: DVec3::X, dir: DVec3::ZERO }, ..side() }]);
    assert_eq!(e, E::ZeroDirection { turn: 1, name: "line.dir" });
}

#[test]
fn sharpness_out_of_range() {
    for m in [0.19, 20.1, -1.0, f64::INFINITY] {
        assert_eq!(error(&[TurnSpec { m: Sharpness::Value(m), ..side() }]), E::Sharpness { turn: 1, m });
    }
    assert!(matches!(new(&[TurnSpec { m: Sharpness::Value(f64::NAN), ..side() }]), Err(E::Sharpness { .. })));
    for m in [0.2, 20.0] {
        assert_eq!(new(&[TurnSpec { m: Sharpness::Value(m), ..side() }]).unwrap().turns()[0].m, Some(m));
    }
}

#[test]
fn point_on_the_line() {
    let Pencil::Line { point, .. } = corner().pencil else { panic!() };
    let e = error(&[TurnSpec { t2: point + 5.0 * DVec3::Z, ..corner() }]);
    assert!(matches!(e, E::PointOnLine { turn: 1, name: "t2", .. }), "{e}");
}

#[test]
fn bend_point_on_a_plane() {
    let e = error(&[TurnSpec { t0: side().t1, ..side() }]);
    assert!(matches!(e, E::BendOnPlane { turn: 1, name: "t0", .. }), "{e}");
    let e = error(&[TurnSpec { t2: side().t1, ..side() }]);
    assert!(matches!(e, E::BendOnPlane { turn: 1, name: "t2", .. }), "{e}");
}

#[test]
fn one_plane_twice() {
    let e = error(&[TurnSpec { t2: side().t0, ..side() }]);
    assert!(matches!(e, E::SamePlanes { turn: 1, .. }), "{e}");
}

#[test]
fn viewpoints_on_the_bend_plane() {
    let e = error(&[TurnSpec { viewpoint: side().t1, ..side() }]);
    assert!(matches!(e, E::ViewpointOnBend { turn: 1, viewpoint: 1, .. }), "{e}");
    let planes = TurnSpec {
        t1: DVec3::ZERO,
        t0: -DVec3::Y,
        t2: DVec3::Y,
        pencil: Pencil::Parallel { normal: DVec3::Y },
        ..side()
    };
    let e = error(&[planes]);
    assert!(matches!(e, E::ViewpointOnBend { turn: 1, viewpoint: 0, .. }), "{e}");
}

#[test]
fn planes_in_the_wrong_order() {
    let turn = TurnSpec { t0: side().t2, t2: side().t0, ..side() };
    let e = error(&[turn]);
    let E::PlaneOrder { remedy, t0, t1, t2, .. } = &e else { panic!("{e}") };
    assert!(t0 > t1 && t1 > t2, "{e}");
    assert_eq!(*remedy, Remedy::SwapPlanes);
    new(&[healed(&turn, remedy)]).unwrap();
    let behind = TurnSpec { t0: -90.0 * DVec3::Y, t1: -75.0 * DVec3::Y, t2: -60.0 * DVec3::Y, ..side() };
    let e = error(&[behind]);
    let E::PlaneOrder { remedy: remedy @ Remedy::MovePlanes { .. }, .. } = &e else { panic!("{e}") };
    new(&[healed(&behind, remedy)]).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
}

#[test]
fn viewpoint_before_the_turn_past_its_planes() {
    let normal = Pencil::Parallel { normal: DVec3::Y };
    let at = |y: f64| y * DVec3::Y;
    let past_t1 =
        TurnSpec { t0: at(-5.0), t1: at(-3.0), t2: at(40.0), pencil: normal, viewpoint: at(-50.0), m: Sharpness::Bend };
    let e = error(&[past_t1]);
    let E::PreviousPastBend { turn: 1, viewpoint: 0, past, remedy } = &e else { panic!("{e}") };
    assert!((past - 3.0).abs() < 1e-12, "{e}");
    new(&[healed(&past_t1, remedy)]).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));

    let past_t0 = TurnSpec { t0: at(-5.0), t1: at(30.0), ..past_t1 };
    let e = error(&[past_t0]);
    let E::PreviousPastStart { turn: 1, viewpoint: 0, past, remedy } = &e else { panic!("{e}") };
    assert!((past - 5.0).abs() < 1e-12, "{e}");
    new(&[healed(&past_t0, remedy)]).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
}

#[test]
fn viewpoint_past_the_bend() {
    let turn = TurnSpec { viewpoint: DVec3::new(30.0, 90.0, 0.0), ..side() };
    let e = error(&[turn]);
    let E::ViewpointPastBend { turn: 1, past, remedy } = &e else { panic!("{e}") };
    assert!(*past > 5.0 && *past < 30.0, "{e}");
    if *remedy != Remedy::Rebuild {
        new(&[healed(&turn, remedy)]).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
    }
}

#[test]
fn bend_plane_beside_the_picture() {
    let turn = TurnSpec {
        pencil: Pencil::Parallel { normal: DVec3::new(1.0, 0.3, 0.0) },
        t0: 10.0 * DVec3::Y,
        t1: 20.0 * DVec3::Y,
        t2: 30.0 * DVec3::Y,
        ..side()
    };
    let turn = TurnSpec { viewpoint: DVec3::new(-5.0, -5.0, 0.0), ..turn };
    let e = error(&[turn]);
    let E::BendNotMet { turn: 1, viewpoint: 0, slope, remedy, .. } = &e else { panic!("{e}") };
    assert!(*slope <= 0.0, "{e}");
    new(&[healed(&turn, remedy)]).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
}

#[test]
fn line_in_the_picture() {
    let turn = {
        let arm = |angle: f64| DVec3::new(-30.0, 100.0, 0.0) + 40.0 * DVec3::new(angle.cos(), angle.sin(), 0.0);
        TurnSpec {
            t0: arm(-0.3),
            t1: arm(0.0),
            t2: arm(0.3),
            pencil: Pencil::Line { point: DVec3::new(-30.0, 100.0, 0.0), dir: DVec3::Z },
            ..corner()
        }
    };
    let e = error(&[turn]);
    let E::LineInPicture { turn: 1, pixel, beyond, remedy } = &e else { panic!("{e}") };
    assert!(pixel.x == 0.0 && *beyond > 5.0, "{e}");
    new(&[healed(&turn, remedy)]).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
    // The remedy is the smallest move: 99 % of it is not enough.
    let Remedy::MovePoint { to, .. } = remedy else { panic!("{e}") };
    let Pencil::Line { point, dir } = turn.pencil else { panic!() };
    let half = TurnSpec { pencil: Pencil::Line { point: point.lerp(*to, 0.99), dir }, ..turn };
    assert!(matches!(error(&[half]), E::LineInPicture { .. }));
}

#[test]
fn end_that_is_never_reached() {
    // The viewpoint after the turn is almost on t1, and t2 is at a wide angle to it.
    let turn =
        TurnSpec { t2: corner().t1 + DVec3::new(-66.0, 55.0, 0.0), viewpoint: DVec3::new(40.0, 80.0, 0.0), ..corner() };
    let e = error(&[turn]);
    let E::EndNotReached { turn: 1, sigma, limit, remedy, .. } = &e else { panic!("{e}") };
    assert!(sigma >= limit, "{e}");
    new(&[healed(&turn, remedy)]).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
}

/// Bezier arcs of rays that barely reach t2 cross: points would be seen twice, once mirrored.
#[test]
fn rays_of_the_original_model_that_cross() {
    let mut crossed = 0;
    for seed in 0..4000 {
        let mut random = Random::new(seed);
        let Some(made) = RandomRays::new(&mut random, Model::Modified, 1, [64, 48]) else { continue };
        let original = |turn: TurnSpec| CurvedRays::new(&made.pinhole, Model::Original, &[turn]);
        let Err(e) = original(made.turns[0]) else { continue };
        let E::RaysCross { turn: 1, remedy, .. } = &e else { continue };
        assert!(
            e.to_string().len() < 400 && CurvedRays::if_valid(&made.pinhole, Model::Original, &made.turns).is_none()
        );
        crossed += 1;
        if *remedy != Remedy::OtherModel {
            original(healed(&made.turns[0], remedy)).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
        }
    }
    assert!(crossed > 5, "{crossed} cameras");
}

#[test]
fn turns_that_overlap() {
    let mut turns = cameras::long_bend().turns;
    for turn in &mut turns {
        turn.t0 = turn.t1.lerp(turn.t0, 2.2);
        turn.t2 = turn.t1.lerp(turn.t2, 2.2);
    }
    let e = error(&turns);
    let E::TurnsOverlap { turn, start, end, remedy: Remedy::Shrink { factor }, .. } = &e else { panic!("{e}") };
    assert!(start < end && *factor < 1.0 && *turn > 1, "{e}");
    let shrink = |f: f64| {
        let mut turns = turns.clone();
        turns.truncate(*turn);
        for t in &mut turns[turn - 2..] {
            t.t0 = t.t1.lerp(t.t0, f);
            t.t2 = t.t1.lerp(t.t2, f);
        }
        new(&turns)
    };
    shrink(*factor).unwrap_or_else(|again| panic!("{e}\nbut then: {again}"));
    assert!(matches!(shrink(factor + 0.001), Err(E::TurnsOverlap { .. })));
}

#[test]
fn near_past_the_start() {
    let root = Pinhole { near: 65.0, ..root() };
    let e = CurvedRays::new(&root, Model::Modified, &[side()]).unwrap_err();
    let E::NearPastStart { near, start, remedy: Remedy::Near { near: limit }, .. } = &e else { panic!("{e}") };
    assert!(*near == 65.0 && start < near && limit < near, "{e}");
    let nearest = Pinhole { near: *limit, ..root.clone() };
    CurvedRays::new(&nearest, Model::Modified, &[side()]).unwrap();
    let above = Pinhole { near: limit * 1.0001, ..root };
    CurvedRays::new(&above, Model::Modified, &[side()]).unwrap_err();
}

/// Configurations in which the construction with the points A, R, S is degenerate.
#[test]
fn unusual_but_valid() {
    let baseline_in = |direction: DVec3| TurnSpec { viewpoint: 20.0 * direction, ..corner() };
    let line = |point: DVec3, dir: DVec3| TurnSpec { pencil: Pencil::Line { point, dir }, ..corner() };
    let cases = [
        ("viewpoint ahead of t0", TurnSpec { viewpoint: DVec3::new(10.0, 65.0, 0.0), ..side() }),
        (
            "baseline parallel to the planes",
            TurnSpec { viewpoint: 20.0 * DVec3::X, pencil: Pencil::Parallel { normal: DVec3::Y }, ..side() },
        ),
        ("line parallel to the baseline", baseline_in(DVec3::Z)),
        ("baseline parallel to t1", baseline_in(DVec3::X)),
        ("skew line", line(DVec3::new(-90.0, 100.0, 0.0), DVec3::new(0.1, 0.25, 1.0))),
        ("line meets the baseline", {
            let through = DVec3::new(-80.0, 0.0, 0.0);
            TurnSpec {
                viewpoint: -10.0 * DVec3::X,
                t0: DVec3::new(0.0, 40.0, 0.0),
                t1: DVec3::new(0.0, 60.0, 0.0),
                t2: DVec3::new(0.0, 75.0, 0.0),
                pencil: Pencil::Line { point: through, dir: DVec3::Z },
                m: Sharpness::Bend,
            }
        }),
    ];
    for (name, turn) in cases {
        for model in [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular] {
            let rays = CurvedRays::new(&root(), model, &[turn]).unwrap_or_else(|e| panic!("{name}: {e}"));
            let view = View::new(root(), vec![Stage::CurvedRays(rays)]).unwrap();
            for pixel in [DVec2::ZERO, DVec2::new(640.0, 360.0), DVec2::new(1279.5, 0.5), DVec2::new(3.0, 719.0)] {
                for depth in [5.0, 45.0, 62.0, 90.0, 400.0] {
                    let x = view.ray(pixel).at(depth).unwrap_or_else(|m| panic!("{name} {model:?}: {m:?}")).point;
                    let image = view.project(x).unwrap();
                    assert!((image.pixel - pixel).length() < 1e-9, "{name} {model:?}: {pixel} {}", image.pixel);
                }
            }
        }
    }
}

/// Arbitrary numbers give either an error of one readable sentence or a camera without NaN.
#[test]
fn hostile_specifications_never_panic() {
    let mut random = Random::new(0x405);
    let values = [0.0, 1.0, -1.0, 50.0, 75.0, 100.0, 1e-300, 1e-9, 1e9, 1e160, 1e300, f64::MAX];
    let mut accepted = 0;
    for _ in 0..20_000 {
        let mut point = || {
            DVec3::from_array([0; 3].map(|_: i32| {
                if random.unit() < 0.2 { values[random.below(values.len())] } else { random.range(-120.0, 120.0) }
            }))
        };
        let (viewpoint, t0, t1, t2, u, v) = (point(), point(), point(), point(), point(), point());
        let pencil =
            if random.unit() < 0.5 { Pencil::Line { point: u, dir: v } } else { Pencil::Parallel { normal: u } };
        let m = [Sharpness::Bend, Sharpness::Left, Sharpness::Mid, Sharpness::Value(2.0)][random.below(4)];
        let turn = TurnSpec { viewpoint, t0, t1, t2, pencil, m };
        let model = [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular][random.below(5)];
        match CurvedRays::new(&root(), model, &[turn]) {
            Err(e) => assert!(!e.to_string().contains("NaN"), "{turn:?}: {e}"),
            Ok(rays) => {
                accepted += 1;
                let view = View::new(root(), vec![Stage::CurvedRays(rays)]).unwrap();
                for pixel in [DVec2::ZERO, DVec2::new(640.0, 360.0), DVec2::new(1e7, -3.0)] {
                    for depth in [1.0, 30.0, 80.0, 1e4, 1e200] {
                        let Ok(at) = view.ray(pixel).at(depth) else { continue };
                        assert!(at.point.is_finite(), "{turn:?} {pixel} {depth}");
                        if let Ok(image) = view.project(at.point) {
                            assert!(image.pixel.is_finite() && image.depth > 0.0, "{turn:?}: {image:?}");
                        }
                    }
                    assert!(view.ray(pixel).path_length(100.0).map_or(true, f64::is_finite), "{turn:?}");
                }
            }
        }
    }
    assert!(accepted > 50, "only {accepted} valid cameras");
}

#[test]
fn a_viewpoint_past_a_bend_plane_through_a_line_is_moved_back_square_to_it() {
    // The bend plane of the corner is y = 100.
    for x in [70.0, -20.0] {
        let turn = TurnSpec { viewpoint: DVec3::new(x, 110.0, 5.0), ..corner() };
        let e = error(&[turn]);
        let E::ViewpointPastBend { past, remedy: Remedy::MovePoint { name: "viewpoint", to }, .. } = e else {
            panic!("{e}")
        };
        assert!((past - 10.0).abs() < 1e-9, "{past}");
        assert!((to.x - x).abs() < 1e-9 && (to.z - 5.0).abs() < 1e-9 && to.y <= 100.0, "{to}");
        let remedy = Remedy::MovePoint { name: "viewpoint", to };
        new(&[healed(&turn, &remedy)]).unwrap_or_else(|again| panic!("{}\nbut then: {again}", error(&[turn])));
    }
}

#[test]
fn how_near_a_bend_point_may_come_to_a_plane_grows_with_the_farther_viewpoint() {
    let limit = |viewpoint: DVec3| {
        let e = error(&[TurnSpec { viewpoint, t0: side().t1, ..side() }]);
        let E::BendOnPlane { limit, .. } = e else { panic!("{e}") };
        limit
    };
    // The eye is 75 away from the bend point.
    let at = |distance: f64| side().t1 + distance * DVec3::new(0.6, -0.8, 0.0);
    let near = limit(at(20.0));
    assert!(near > 0.0 && near < 1e-6 * 75.0, "{near}");
    assert!((limit(at(60.0)) - near).abs() < 1e-12 * near);
    assert!((limit(at(750.0)) / near - 10.0).abs() < 1e-9);
}
