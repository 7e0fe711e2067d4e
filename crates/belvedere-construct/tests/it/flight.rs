//! Cameras that follow a route: above ground, smooth, behind the walker.

use belvedere_construct::{Flight, FlightError, FlightOptions};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, NodeState};

/// Steep waves, 400 m high and 1.6 km long.
fn waves() -> Heightfield {
    let height = |i: usize| 400.0 * (((i % 201) as f64) * 0.2).sin() * (((i / 201) as f64) * 0.2).cos();
    let heights = (0..201 * 201).map(|i| height(i) as f32).collect();
    Heightfield::new(
        DVec2::new(0.0, 10_000.0),
        DVec2::splat(50.0),
        201,
        201,
        heights,
        vec![NodeState::Measured; 201 * 201],
    )
    .expect("a heightfield")
}

/// A way with hairpins, one of them a full turn back.
fn hairpins() -> Vec<DVec2> {
    let turns =
        [(2000.0, 2000.0), (7000.0, 2500.0), (2500.0, 3000.0), (7000.0, 3500.0), (7000.0, 7000.0), (3000.0, 7000.0)];
    turns.into_iter().map(|(x, y)| DVec2::new(x, y)).collect()
}

const OPTIONS: FlightOptions = FlightOptions { behind_m: 600.0, above_m: 200.0, ahead_m: 900.0 };

#[test]
fn the_eye_stays_above_ground_behind_the_walker_and_moves_smoothly() {
    let hf = waves();
    let flight = Flight::along(&hairpins(), Some(&hf), &OPTIONS).expect("a flight");
    let length = flight.length_m();
    let step = 1.0;
    let mut last: Option<(DVec3, DVec3)> = None;
    let (mut fastest, mut hardest) = (0.0f64, 0.0f64);
    let mut previous = flight.at(0.0).0;
    for i in 1..(length / step) as usize {
        let (eye, target) = flight.at(i as f64 * step);
        let ground = hf.surface_at(eye.truncate()).expect("over the terrain");
        assert!(eye.z - ground >= OPTIONS.above_m - 1.0, "{i}: {} over the ground", eye.z - ground);
        // The walker, smoothed, lies between eye and target in plan, at the stated distances.
        let apart = (target - eye).truncate().length();
        assert!((apart - 1500.0).abs() < 1.0, "{i}: {apart}");
        let velocity = (eye - previous) / step;
        if let Some((v, _)) = last {
            hardest = hardest.max((velocity - v).length() / step);
        }
        fastest = fastest.max(velocity.length());
        (last, previous) = (Some((velocity, eye)), eye);
    }
    // C1: velocities change by little from metre to metre; a corner would show as a jump of the size of the velocity.
    assert!(hardest < 0.02 * fastest, "acceleration {hardest}, speed {fastest}");
    assert!(fastest < 8.0, "{fastest} times as fast as the walker");
}

#[test]
fn without_corners_the_camera_keeps_the_walkers_pace() {
    let straight = [DVec2::new(0.0, 0.0), DVec2::new(0.0, 9000.0)];
    let flight = Flight::along(&straight, None, &OPTIONS).expect("a flight");
    for s in [0.0, 10.0, 4321.0, 8999.0] {
        let (eye, target) = flight.at(s);
        assert!((eye - DVec3::new(0.0, s - 600.0, 200.0)).length() < 1e-6, "{s}: {eye}");
        assert!((target - DVec3::new(0.0, s + 900.0, 0.0)).length() < 1e-6, "{s}: {target}");
    }
}

#[test]
fn ways_without_length_are_refused() {
    let p = DVec2::new(1.0, 2.0);
    for way in [&[][..], &[p], &[p, p], &[p, DVec2::NAN]] {
        assert!(matches!(Flight::along(way, None, &OPTIONS), Err(FlightError::Short { .. })), "{way:?}");
    }
    let options = FlightOptions { above_m: f64::NAN, ..OPTIONS };
    assert!(matches!(Flight::along(&hairpins(), None, &options), Err(FlightError::Option { name: "above_m", .. })));
}
