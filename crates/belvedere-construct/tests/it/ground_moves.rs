//! Handles of moved ground: they are carried out, and what lies on the ground keeps its form.

use belvedere_construct::ground_moves::{Handle, Kept, KeptLine, Move, ground_moves};
use belvedere_core::map::ground_moves::GroundMoves;
use belvedere_core::random::Random;
use belvedere_core::{DVec2, DVec3, SpaceMap};

fn at(map: &GroundMoves, x: f64, y: f64) -> DVec3 {
    map.apply(DVec3::new(x, y, 0.0)).expect("everywhere") - DVec3::new(x, y, 0.0)
}

fn handle(handle: Handle, core: f64, reach: f64) -> Move {
    Move { handle, core, reach }
}

fn raise(x: f64, y: f64, by: f64, core: f64, reach: f64) -> Move {
    handle(Handle::Raise { at: [DVec2::new(x, y)], by }, core, reach)
}

/// A valley that winds along x.
fn valley(amplitude: f64) -> Vec<DVec2> {
    (0..=80).map(|i| f64::from(i) * 100.0).map(|x| DVec2::new(x, amplitude * (x / 900.0).sin())).collect()
}

fn done(moves: &[Move], kept: &Kept) -> (GroundMoves, belvedere_construct::ground_moves::GroundMovesReport) {
    ground_moves(moves, kept).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_place_is_shifted_and_nothing_moves_beyond_reach() {
    let by = DVec2::new(300.0, -120.0);
    let (map, report) = done(&[handle(Handle::Shift { at: [DVec2::ZERO], by }, 400.0, 2500.0)], &Kept::default());
    for p in [DVec2::ZERO, DVec2::new(300.0, 0.0), DVec2::new(-200.0, 200.0)] {
        assert!((at(&map, p.x, p.y).truncate() - by).length() < 6.0, "{p}: {}", at(&map, p.x, p.y));
    }
    for k in 0..64 {
        let p = 2501.0 * DVec2::from_angle(f64::from(k) * 0.1);
        assert_eq!(at(&map, p.x, p.y), DVec3::ZERO, "{p}");
    }
    assert!(report.share == 1.0 && report.moves[0].carried_out > 0.98, "{report:?}");
    assert!(report.least_determinant > 0.3 && report.height_m == 0.0, "{report:?}");
}

#[test]
fn a_place_turns_as_a_whole_and_a_summit_rises() {
    let turn = handle(Handle::Turn { at: [DVec2::ZERO], angle: 0.5 }, 500.0, 3000.0);
    let (map, report) = done(&[turn, raise(9000.0, 0.0, 250.0, 100.0, 1500.0)], &Kept::default());
    for k in 0..12 {
        let p = 400.0 * DVec2::from_angle(f64::from(k));
        let gone = at(&map, p.x, p.y).truncate() + p;
        assert!(gone.distance(DVec2::from_angle(0.5).rotate(p)) < 12.0, "{p} to {gone}");
    }
    assert!((at(&map, 9000.0, 0.0).z - 250.0).abs() < 3.0 && at(&map, 9000.0, 1510.0) == DVec3::ZERO);
    assert!(report.moves.iter().all(|m| m.carried_out > 0.97), "{report:?}");
}

#[test]
fn a_valley_widens_on_both_sides_and_a_stretch_becomes_straight() {
    let widen = handle(Handle::Widen { path: valley(200.0), by: 150.0 }, 400.0, 1800.0);
    let (map, report) = done(&[widen], &Kept::default());
    let x = 4000.0;
    let y = 200.0 * (x / 900.0f64).sin();
    assert!(at(&map, x, y).truncate().length() < 25.0, "the axis moves by {}", at(&map, x, y));
    assert!(at(&map, x, y + 400.0).y > 120.0 && at(&map, x, y - 400.0).y < -120.0);
    assert!(report.share == 1.0 && report.moves[0].carried_out > 0.9, "{report:?}");

    let straighten = handle(Handle::Straighten { path: valley(300.0), share: 0.8 }, 200.0, 2500.0);
    let (map, report) = done(&[straighten], &Kept::default());
    let off = |p: &DVec2| {
        let line = *valley(300.0).last().expect("points");
        let q = map.apply(p.extend(0.0)).expect("everywhere").truncate();
        (line.perp_dot(q) / line.length()).abs()
    };
    let worst = valley(300.0).iter().map(off).fold(0.0, f64::max);
    assert!(worst < 0.3 * 320.0 && report.share == 1.0, "{worst} m off the line, {report:?}");
}

#[test]
fn moves_that_would_fold_are_carried_out_in_part() {
    let by = DVec2::new(2400.0, 0.0);
    let (map, report) = done(&[handle(Handle::Shift { at: [DVec2::ZERO], by }, 500.0, 2500.0)], &Kept::default());
    assert!(report.share < 0.8 && report.share > 0.2, "{report:?}");
    assert!(report.least_determinant > 0.05 && (report.moves[0].carried_out - report.share).abs() < 0.05, "{report:?}");
    let mut random = Random::new(2);
    for _ in 0..2000 {
        let p = DVec3::new(random.range(-2600.0, 2600.0), random.range(-2600.0, 2600.0), 0.0);
        assert!(map.jacobian(p).expect("everywhere").determinant() > 0.05);
    }
}

#[test]
fn lakes_stay_level_rivers_run_downhill_and_routes_keep_their_length() {
    let mut random = Random::new(7);
    for seed in 0..12 {
        let spot = DVec2::new(random.range(-800.0, 800.0), random.range(-800.0, 800.0));
        let ring = |middle: DVec2, radius: f64| -> Vec<DVec2> {
            (0..24).map(|k| middle + radius * DVec2::from_angle(f64::from(k) * 0.2618)).collect()
        };
        // A lake on the flank, a river that runs past below it with a slope of a thousandth, and a winding route across.
        let lake = ring(spot + DVec2::new(700.0, 300.0), 260.0);
        let river = (0..120).map(|i| DVec3::new(-3000.0 + 50.0 * f64::from(i), -500.0, 200.0 - 0.05 * f64::from(i)));
        let route = (0..200).map(|i| {
            let y = -3000.0 + 30.0 * f64::from(i);
            DVec3::new(-400.0 + 150.0 * (y / 200.0).sin(), y, 500.0 + 0.1 * y)
        });
        let line = |points: Vec<DVec3>| KeptLine { name: "one".into(), points };
        let kept = Kept {
            lakes: vec![vec![lake.clone()], vec![ring(DVec2::new(0.0, 9000.0), 200.0)]],
            sea: vec![DVec2::new(-1500.0, -1500.0)],
            rivers: vec![line(river.collect())],
            routes: vec![line(route.collect())],
        };
        let by = random.range(100.0, 300.0);
        let moves = [
            raise(spot.x, spot.y, by, 300.0, 2200.0),
            handle(Handle::Shift { at: [-spot], by: DVec2::new(500.0, 300.0) }, 300.0, 1800.0),
        ];
        let (map, report) = done(&moves, &kept);
        let inside = (0..400).map(|_| {
            let middle = spot + DVec2::new(700.0, 300.0);
            middle + 255.0 * random.unit().sqrt() * DVec2::from_angle(random.range(0.0, 6.3))
        });
        let heights: Vec<f64> = inside.map(|p| at(&map, p.x, p.y).z).collect();
        let range = heights.iter().fold([f64::MAX, f64::MIN], |[a, b], z| [a.min(*z), b.max(*z)]);
        assert!(range[1] - range[0] < 1e-9, "{seed}: the lake tilts by {}", range[1] - range[0]);
        assert!(report.rivers_rise_m < 0.05, "{seed}: {report:?}");
        assert!(
            report.routes.iter().all(|r| (r.moved_length_m / r.length_m - 1.0).abs() <= 0.0301),
            "{seed}: {report:?}"
        );
        assert!(at(&map, -1500.0, -1500.0).z == 0.0 && report.lakes <= 1, "{seed}");
        assert!(report.moves[0].carried_out > 0.5 && report.height_m < 1.2 * by, "{seed}: {by}, {report:?}");
    }
}

#[test]
fn handles_are_checked() {
    let wrong = [
        (handle(Handle::Turn { at: [DVec2::ZERO], angle: 4.0 }, 1.0, 9.0), "angle_deg is 229.18"),
        (raise(0.0, 0.0, f64::NAN, 1.0, 9.0), "by_m is NaN"),
        (raise(0.0, 0.0, 1.0, 9.0, 9.0), "core_m is 9"),
        (handle(Handle::Widen { path: vec![DVec2::ONE; 3], by: 1.0 }, 1.0, 9.0), "the line has 3 points and is 0 long"),
    ];
    for (one, text) in wrong {
        let error = ground_moves(&[raise(0.0, 0.0, 1.0, 1.0, 9.0), one], &Kept::default()).expect_err(text).to_string();
        assert!(error.starts_with(text), "{error}");
    }
}

#[test]
fn moves_far_apart_move_nothing_beyond_their_reach_or_are_refused() {
    let pair = |apart: f64| [raise(0.0, 0.0, 200.0, 300.0, 1500.0), raise(apart, 0.5 * apart, 300.0, 300.0, 1500.0)];
    let apart = 60_000.0;
    let (map, report) = done(&pair(apart), &Kept::default());
    assert!(report.moves.iter().all(|one| one.carried_out > 0.9), "{report:?}");
    for (x, y) in [(0.0, 0.0), (apart, 0.5 * apart)] {
        assert!(at(&map, x, y).z > 180.0);
        for k in 0..64 {
            let rim = 1501.0 * DVec2::from_angle(f64::from(k) * 0.1);
            assert_eq!(at(&map, x + rim.x, y + rim.y), DVec3::ZERO);
        }
    }
    let error = ground_moves(&pair(600_000.0), &Kept::default()).expect_err("too far apart").to_string();
    assert!(error.starts_with("reach_m is 1500; moves that lie so far apart need at least 77"), "{error}");
}
