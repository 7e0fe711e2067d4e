use super::*;
use belvedere_core::{Aabb, Pinhole, Projection};
use belvedere_scene::{BoxLayer, BoxShape, Color, Scene};

/// A wall 30 m high, 40 m before the eye.
fn voxels() -> Voxels {
    let wall = BoxShape {
        base: DVec3::new(0.0, 42.0, 0.0),
        size: DVec3::new(200.0, 4.0, 30.0),
        yaw: 0.0,
        color: Color::rgb(1, 2, 3),
    };
    let scene = Scene::default().with_layer("wall", BoxLayer::new(vec![wall]));
    Voxels::new(&scene, &Aabb { min: DVec3::new(-80.0, -10.0, 0.0), max: DVec3::new(80.0, 120.0, 70.0) })
}

#[test]
fn a_staircase_over_a_wall_becomes_a_few_legs_that_keep_their_clearance() {
    let (voxels, eye) = (voxels(), DVec3::new(0.0, 0.0, 5.0));
    // Up at 45 degrees, level, and down again, in small steps.
    let height = |y: f64| if y < 35.0 { 5.0 + y } else { 40.0 - (y - 50.0).max(0.0) };
    let points: Vec<DVec3> = (10..70).map(|y| DVec3::new(0.0, f64::from(y), height(f64::from(y)))).collect();
    let look = DVec3::new(0.0, 1.0, -1.0).normalize();
    let chain = Chain::simplified(eye, &points, look, &voxels, 0.1, 3).expect("a way over the wall");
    assert!((1..=3).contains(&chain.turns(eye)) && chain.is_free(eye, &voxels), "{chain:?}");
    assert!(chain.length(eye) < 1.05 * 98.0, "{}", chain.length(eye));
    let lower = Chain { points: chain.points.iter().map(|p| *p - 15.0 * DVec3::Z).collect(), ..chain.clone() };
    assert!(!lower.is_free(eye, &voxels), "through the wall");
    assert_eq!(Chain::simplified(eye, &points, look, &voxels, 0.1, 0), None, "no turn is allowed");
    let back = -DVec3::Y;
    assert_eq!(Chain::simplified(eye, &points[..5], back, &voxels, 0.0, 3), None, "too far a turn");
}

#[test]
fn turns_come_in_from_nothing_one_after_the_other() {
    let (voxels, eye) = (voxels(), DVec3::new(0.0, 0.0, 5.0));
    let lens = Projection::Perspective { fov_y: 0.5 };
    let pinhole = Pinhole::look_at(eye, DVec3::new(0.0, 35.0, 40.0), DVec3::Z, lens, [64, 36], 1.0, None).unwrap();
    let base = View::straight(pinhole);
    let points = [[0.0, 35.0, 40.0], [0.0, 60.0, 40.0], [0.0, 80.0, 20.0]].map(DVec3::from_array);
    let shape = TurnShape { behind: 50.0, length: 1.0, m: Sharpness::Bend };
    let chain = Chain { points: points.into(), shape, clearance_per_length: 0.0 };
    assert!(chain.is_free(eye, &voxels) && chain.turns(eye) == 2);
    let turns = |entered: f64| chain.view(&base, entered).unwrap().curved_rays().map_or(0, |r| r.turn_count());
    assert_eq!([0.0, 0.5, 1.0, 1.5, 2.0, 9.0].map(turns), [0, 1, 1, 2, 2, 2]);
    // A hardly entered turn hardly moves anything.
    let p = DVec3::new(2.0, 70.0, 30.0);
    let image = |entered: f64| chain.view(&base, entered).unwrap().project(p).unwrap().pixel;
    assert!(image(1.0).distance(image(1.01)) < 0.1 && image(0.0).distance(image(0.01)) < 0.1);
    assert!(image(1.0).distance(image(2.0)) > 5.0);
}
