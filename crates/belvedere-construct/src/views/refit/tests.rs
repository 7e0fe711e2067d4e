use super::*;
use crate::rays::Target;
use belvedere_core::Aabb;
use belvedere_scene::{BoxLayer, BoxShape, Color, Layer, Scene, Unit};

/// A row of slabs, a target behind them, and the eye in front of them.
fn scene() -> Scene {
    let slab = |y: f64, size: DVec3, z: f64| {
        let base = DVec3::new(0.0, y, z);
        BoxShape { base, size, yaw: 0.0, color: Color::rgb(200, 200, 200) }
    };
    let wall = BoxLayer::new(vec![slab(0.0, DVec3::new(60.0, 2.0, 40.0), 0.0)]);
    let low = BoxLayer::new(vec![slab(40.0, DVec3::new(50.0, 2.0, 12.0), 28.0)]);
    let layer = |id: &str, boxes: BoxLayer| Layer { id: id.into(), must_see: false, kind: boxes.into() };
    Scene { layers: vec![layer("wall", wall), layer("low", low)], unit: Unit::Angstrom, ..Scene::default() }
}

fn base(image: [u32; 2]) -> View {
    let (eye, look) = (DVec3::new(0.0, -150.0, 22.0), DVec3::new(0.0, 20.0, 20.0));
    let lens = Projection::Perspective { fov_y: 0.45 };
    View::straight(Pinhole::look_at(eye, look, DVec3::Z, lens, image, 1.0, None).unwrap())
}

/// A bend by which everything moves up in the picture, partly out of it.
fn over() -> Sidestep {
    Sidestep { offset: DVec3::new(0.0, 0.0, -16.0), planes: [20.0, 70.0, 120.0] }
}

fn points(scene: &Scene) -> Vec<DVec3> {
    scene.layers.iter().flat_map(|l| l.bounds().corners()).collect()
}

/// Images as shares of the picture.
fn images(view: &View, points: &[DVec3]) -> Vec<DVec2> {
    let size = DVec2::from(view.pinhole().image.map(f64::from));
    points.iter().map(|p| view.project(*p).unwrap().pixel / size).collect()
}

/// Shares of the picture beside images: left, above, right, below.
fn margins(images: &[DVec2]) -> [f64; 4] {
    let all = Aabb::of(images.iter().map(|p| p.extend(0.0)));
    [all.min.x, all.min.y, 1.0 - all.max.x, 1.0 - all.max.y]
}

fn are_even([left, above, right, below]: [f64; 4]) -> bool {
    (left - right).abs() < 0.01 && (above - below).abs() < 0.01
}

#[test]
fn all_that_a_bend_moved_lies_inside_with_an_even_margin_in_every_shape_of_picture() {
    let scene = scene();
    let points = points(&scene);
    let target = Target::layer(&scene, 1).unwrap();
    let sight = TargetSight::new(&scene, &target);
    for image in [[640, 360], [360, 640], [500, 500], [1200, 200]] {
        let base = base(image);
        let before = over().view(&base).unwrap();
        assert!(margins(&images(&before, &points)).iter().any(|m| *m < 0.0), "cut off before: {image:?}");
        let content = Content { points: &points, up: DVec3::Z, may_zoom: true };
        let found = refit(&sight, &base, Some(&over()), &content).unwrap();
        let after = over().seen_by(base.pinhole(), &found.straight).unwrap();
        let bent = images(&after, &points);
        let beside = margins(&bent);
        assert!(beside.iter().all(|m| *m > 0.039), "{image:?} {beside:?}");
        assert!(beside.iter().any(|m| *m < 0.041), "as large as it can be: {image:?} {beside:?}");
        // Where the target would leave the straight picture, its place there counts, too.
        let with_target = [bent, images(&found.straight, &target.points)].concat();
        assert!(are_even(beside) || are_even(margins(&with_target)), "{image:?} {beside:?}");
        assert!(found.record.outside[0] > 0.0 && found.record.outside[1] == 0.0, "{:?}", found.record);
        assert!(sight.share(&after, 0.0) >= sight.share(&before, 0.0));
    }
}

#[test]
fn the_bend_stays_where_it_was_in_space() {
    let scene = scene();
    let (base, points) = (base([640, 360]), points(&scene));
    let target = Target::layer(&scene, 1).unwrap();
    let sight = TargetSight::new(&scene, &target);
    let content = Content { points: &points, up: DVec3::Z, may_zoom: true };
    let found = refit(&sight, &base, Some(&over()), &content).unwrap();
    assert!(found.record.turned_deg > 1.0, "{:?}", found.record);
    let before = over().view(&base).unwrap();
    let after = over().seen_by(base.pinhole(), &found.straight).unwrap();
    for p in &points {
        let [a, b] = [&before, &after].map(|view| view.displace(*p).unwrap().point);
        assert!(a.distance(b) < 1e-9, "{p}: {a} {b}");
    }
    assert!(found.straight.pinhole().right.z.abs() < 1e-12, "level");
}

#[test]
fn a_field_of_view_that_was_asked_for_stays() {
    let scene = scene();
    let (base, points) = (base([640, 360]), points(&scene));
    let target = Target::layer(&scene, 1).unwrap();
    let content = Content { points: &points, up: DVec3::Z, may_zoom: false };
    let found = refit(&TargetSight::new(&scene, &target), &base, Some(&over()), &content).unwrap();
    let [before, after] = found.record.fov_y_deg;
    assert!((before - after).abs() < 1e-12 && found.record.turned_deg > 1.0, "{:?}", found.record);
}
