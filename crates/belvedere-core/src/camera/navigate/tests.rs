use super::*;

fn camera() -> Navigation {
    let (eye, target) = (DVec3::new(100.0, -2000.0, 1500.0), DVec3::new(0.0, 300.0, 200.0));
    let lens = Projection::Perspective { fov_y: 0.8 };
    let pinhole = Pinhole::look_at(eye, target, DVec3::Z, lens, [1280, 720], 1.0, None).expect("camera");
    Navigation { pinhole, target }
}

#[test]
fn all_points_are_held_in_the_middle_and_fill_the_share() {
    let before = camera();
    let points: Vec<DVec3> = (0..300)
        .map(f64::from)
        .map(|i| DVec3::new(700.0 * (i * 0.7).sin() + i, 900.0 * (i * 1.3).cos(), 150.0 * (i * 2.1).sin() + 40.0))
        .collect();
    for share in [0.5, 0.92, 1.0] {
        let after = before.holding(&points, share).expect("a camera").pinhole;
        assert!((after.forward - before.pinhole.forward).length() < 1e-9, "it is not turned");
        let half = DVec2::new(640.0, 360.0);
        let seen: Vec<DVec2> = points.iter().map(|p| (after.project(*p).expect("seen").0 - half) / half).collect();
        let low = seen.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = seen.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        assert!((high.max_element() - share).abs() < 1e-6 && (low + high).abs().max_element() < 1e-6, "{low} {high}");
    }
    assert!(before.holding(&[], 0.9).is_err());
}

#[test]
fn what_is_held_stays_under_the_pointer() {
    let before = camera();
    let (from, to) = (DVec2::new(300.0, 500.0), DVec2::new(900.0, 420.0));
    let held = before.on_level(before.target, from).expect("ground");
    let after = before.dragged(held, from, to).expect("moved");
    let (pixel, _) = after.pinhole.project(held).expect("in front");
    assert!(pixel.distance(to) < 1e-6, "{pixel}");
    assert_eq!(after.pinhole.forward, before.pinhole.forward);
}

#[test]
fn a_zoom_keeps_the_image_of_what_it_is_about() {
    let before = camera();
    let about = DVec3::new(400.0, 800.0, 300.0);
    let (was, depth) = before.pinhole.project(about).expect("in front");
    let after = before.zoomed(about, 2.0).expect("zoomed");
    let (is, nearer) = after.pinhole.project(about).expect("in front");
    assert!(was.distance(is) < 1e-6 && (nearer - 0.5 * depth).abs() < 1e-6, "{was} {is} {nearer} {depth}");
}

#[test]
fn orbits_keep_distance_and_never_pass_the_poles() {
    let before = camera();
    let distance = before.pinhole.eye.distance(before.target);
    for pitch in [-9.0, -1.0, 0.3, 9.0] {
        let after = before.orbited(0.7, pitch).expect("orbit");
        assert!((after.pinhole.eye.distance(after.target) - distance).abs() < 1e-9 * distance);
        assert!(after.pinhole.right.z.abs() < 1e-12, "rolled");
        assert!(after.pinhole.down.z < 0.0, "upside down");
    }
    let round = before.orbited(std::f64::consts::TAU, 0.0).expect("orbit");
    assert!(round.pinhole.eye.distance(before.pinhole.eye) < 1e-6);
}

#[test]
fn all_of_a_box_is_framed() {
    let bounds = Aabb { min: DVec3::new(-300.0, 100.0, 0.0), max: DVec3::new(900.0, 2100.0, 400.0) };
    let after = camera().framing(&bounds).expect("framed");
    assert!(bounds.corners().iter().all(|&c| after.pinhole.project(c).is_ok_and(|(p, _)| after.pinhole.contains(p))));
    assert!(after.pinhole.forward.distance(camera().pinhole.forward) < 1e-12);
    let pixels = bounds.corners().map(|c| after.pinhole.project(c).expect("in front").0);
    let [lo, hi] = pixels.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
    assert!(((hi - lo) / DVec2::new(1280.0, 720.0)).max_element() > 0.6, "it is small in the picture: {lo} {hi}");
}

#[test]
fn the_horizon_is_not_dragged() {
    let level = Navigation { target: DVec3::new(0.0, 3000.0, 1500.0), ..camera() };
    let level = level.placed(level.pinhole.eye, level.target).expect("camera");
    let after = level.dragged(DVec3::ZERO, DVec2::new(640.0, 10.0), DVec2::new(740.0, 10.0)).expect("turned");
    assert_eq!(after.pinhole.eye, level.pinhole.eye);
    assert!(after.pinhole.forward.x < level.pinhole.forward.x);
}
