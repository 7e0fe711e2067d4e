use super::*;

fn camera(eye: [f64; 3], target: [f64; 3]) -> Navigation {
    let lens = Projection::Perspective { fov_y: 0.8 };
    let target = DVec3::from_array(target);
    let pinhole = Pinhole::look_at(DVec3::from_array(eye), target, DVec3::Z, lens, [1280, 720], 1.0, None);
    Navigation { pinhole: pinhole.expect("camera"), target }
}

/// Level ground with a wall of 900 m across its middle.
fn walled() -> Scene {
    let heights = (0..101 * 101).map(|i| if (48..=52).contains(&(i / 101)) { 900.0 } else { 0.0 }).collect();
    let ground = Heightfield::measured(DVec2::new(0.0, 10_000.0), DVec2::splat(100.0), 101, 101, heights);
    Scene::default().with_terrain("ground", ground.expect("ground"))
}

#[test]
fn a_flight_over_a_wall_stays_above_it_and_ends_where_it_should() {
    let scene = walled();
    let (from, to) = (
        camera([5000.0, 1000.0, 200.0], [5000.0, 2500.0, 0.0]),
        camera([5000.0, 9000.0, 150.0], [4800.0, 7500.0, 0.0]),
    );
    let flight = Flight::new(from.clone(), to.clone(), &scene);
    assert_eq!((flight.at(0.0), flight.at(1.0)), (from, to));
    let ground = scene.terrain().expect("ground");
    let mut last: Option<DVec3> = None;
    for k in 0..=400 {
        let now = flight.at(f64::from(k) / 400.0);
        let eye = now.pinhole.eye;
        let over = eye.z - ground.surface_at(eye.truncate()).expect("on the ground");
        assert!(over > 2.0, "{over} m over the ground at {k}");
        assert!(now.pinhole.right.z.abs() < 1e-9, "rolled");
        assert!(last.is_none_or(|last| last.distance(eye) < 250.0), "a jump at {k}");
        last = Some(eye);
    }
}

#[test]
fn a_thing_behind_a_wall_is_looked_at_from_higher_up() {
    let scene = walled();
    let before = camera([5000.0, 1000.0, 200.0], [5000.0, 2500.0, 100.0]);
    let hut = DVec3::new(5000.0, 5500.0, 0.0);
    let after = shown_whole(&before, &Aabb::of([hut]), &scene).expect("a camera");
    assert!(is_clear(&after, hut, &scene));
    assert!(after.target.distance(hut) < 1e-9);
    let heading = |camera: &Navigation| camera.pinhole.forward.truncate().normalize();
    assert!(heading(&after).distance(heading(&before)) < 1e-9, "from the present direction");
    let (at, _) = after.pinhole.project(hut).expect("in front");
    assert!(at.distance(DVec2::new(640.0, 360.0)) < 1e-6, "in the middle: {at}");
}

#[test]
fn a_long_thing_is_shown_whole() {
    let bounds = Aabb::of([DVec3::new(1000.0, 1000.0, 0.0), DVec3::new(9000.0, 4000.0, 100.0)]);
    let after =
        shown_whole(&camera([5000.0, 1000.0, 900.0], [5000.0, 2500.0, 0.0]), &bounds, &walled()).expect("a camera");
    assert!(bounds.corners().iter().all(|&c| after.pinhole.project(c).is_ok_and(|(p, _)| after.pinhole.contains(p))));
}
