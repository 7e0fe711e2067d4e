use super::*;
use belvedere_core::Aabb;
use belvedere_scene::{BoxLayer, BoxShape, Color, Scene};

/// A wall with the eye before it.
fn voxels() -> Voxels {
    let wall = BoxShape {
        base: DVec3::new(0.0, 20.0, 0.0),
        size: DVec3::new(60.0, 6.0, 40.0),
        yaw: 0.0,
        color: Color::rgb(1, 2, 3),
    };
    let scene = Scene::default().with_layer("wall", BoxLayer::new(vec![wall]));
    let region = Aabb { min: DVec3::new(-60.0, -20.0, 0.0), max: DVec3::new(60.0, 80.0, 60.0) };
    Voxels::new(&scene, &region)
}

fn price(per_length: f64) -> Price {
    Price { clearance_per_length: per_length, per_radian: 5.0, tight: 1.0, longest: 200.0 }
}

#[test]
fn ways_keep_clear_of_walls_and_are_no_longer_than_need_be() {
    let (voxels, eye) = (voxels(), DVec3::new(0.0, -10.0, 10.0));
    let seen: Vec<usize> = (0..voxels.len()).filter(|c| voxels.center(*c).y < 10.0).collect();
    for per_length in [0.0, 0.05, 0.12] {
        let ways = Ways::new(&voxels, eye, &seen, &price(per_length), &Progress::silent()).unwrap();
        let behind = DVec3::new(0.0, 45.0, 20.0);
        let end = ways.reached().filter(|c| voxels.at(behind) == Some(*c));
        let end = end.min_by(|a, b| ways.cost(*a).total_cmp(&ways.cost(*b))).expect("a way");
        let points = ways.points(end);
        assert_eq!(points.last().copied(), voxels.at(behind).map(|c| voxels.center(c)));
        let mut length = points[0].distance(eye);
        for pair in points.windows(2) {
            length += pair[0].distance(pair[1]);
            let cell = voxels.at(pair[1]).unwrap();
            assert!(!voxels.is_solid(cell) && voxels.clearance(cell) >= per_length * length - 1e-3);
            assert!(pair[0].distance(pair[1]) < 1.8 * voxels.cell());
        }
        // Over the edges of the wall, 40 m high, it is 76 m.
        assert!(length > 76.0 && length < 76.0 * (1.15 + 2.0 * per_length), "{length}");
        assert!((ways.length[end] - length as f32).abs() < 1e-2);
    }
    // Through no wall, and not where the room is too small for the length.
    let ways = Ways::new(&voxels, eye, &seen, &price(0.6), &Progress::silent()).unwrap();
    assert!(ways.reached().all(|s| voxels.center(s).y < 60.0));
    assert!(!ways.reached().any(|s| voxels.is_solid(s)));
}

#[test]
fn cancelling_ends_the_search() {
    let (voxels, progress) = (voxels(), Progress::silent());
    progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let seen: Vec<usize> = (0..voxels.len()).filter(|c| voxels.center(*c).y < 10.0).collect();
    assert!(Ways::new(&voxels, DVec3::ZERO, &seen, &price(0.0), &progress).is_err());
}
