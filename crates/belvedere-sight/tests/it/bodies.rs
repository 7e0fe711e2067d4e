//! Meshes, rigid bodies and low bumps as obstacles of lines of sight.

use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Projection, Stage, View};
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Heightfield, Layer, LayerKind, Mesh, MeshColors, MeshLayer, RigidParts, Scene,
    TerrainLayer,
};
use belvedere_sight::{Carried, Obstacles, SightOptions, Solids};

const COLOR: Color = Color::rgb(9, 9, 9);

fn scene(kind: LayerKind) -> Scene {
    Scene { layers: vec![Layer { id: "any".into(), must_see: false, kind }], ..Scene::default() }
}

fn camera(eye: DVec3, target: DVec3) -> Pinhole {
    let lens = Projection::Perspective { fov_y: 0.8 };
    Pinhole::look_at(eye, target, DVec3::Z, lens, [64, 48], 1.0, None).expect("a camera")
}

/// A planet on which the ground falls by less than a metre within 200 m.
fn on_a_planet(pinhole: Pinhole) -> View {
    let earth = EarthCurvature { eye: pinhole.eye, radius: 30_000.0, refraction: 0.0 };
    View::new(pinhole, vec![Stage::EarthCurvature(earth)]).expect("one stage")
}

/// Two upright triangles across x: the first one at x = 10, the second, a part of its own, at x = 20.
fn screens(rigid: RigidParts) -> Scene {
    let at = |x: f64| [[x, -9.0, 0.0], [x, 9.0, 0.0], [x, 0.0, 30.0]].map(DVec3::from_array);
    let mesh =
        Mesh::in_parts(&[at(10.0), at(20.0)].concat(), vec![[0, 1, 2], [3, 4, 5]], MeshColors::Layer, vec![0, 1]);
    scene(LayerKind::Mesh(MeshLayer { rigid, ..MeshLayer::new(mesh.expect("well formed"), COLOR) }))
}

#[test]
fn a_mesh_on_ground_that_is_not_displaced_has_its_own_bounds() {
    let scene = screens(RigidParts::None);
    let obstacles = Obstacles::new(&scene);
    let bounds = obstacles.solid_bounds();
    assert_eq!([bounds.min, bounds.max], [DVec3::new(10.0, -9.0, 0.0), DVec3::new(20.0, 9.0, 30.0)]);
    assert!(obstacles.meshes()[0].1.is_still());
}

#[test]
fn what_is_no_body_stays_with_the_ground_and_bodies_stand_apart() {
    let scene = screens(RigidParts::Only(vec![1]));
    let view = on_a_planet(camera(DVec3::new(-100.0, 0.0, 8.0), DVec3::new(0.0, 0.0, 8.0)));
    let carried = Carried::new(&scene, &view).expect("one body");
    let (beside, bodies) = (
        Obstacles::beside_bodies(&scene, None, &carried, Solids::Opaque),
        Obstacles::of_bodies(&scene, &carried, Solids::Opaque),
    );
    let is_met = |obstacles: &Obstacles<'_>, x: f64| {
        let at = |x: f64| DVec3::new(x, 0.5, 8.0);
        obstacles.min_gap(at(x - 3.0), at(x + 3.0), 5.0, f64::NEG_INFINITY) < 0.0
    };
    assert_eq!([is_met(&beside, 10.0), is_met(&beside, 20.0)], [true, false]);
    assert_eq!([is_met(&bodies, 10.0), is_met(&bodies, 20.0)], [false, true]);
}

/// A tower of 30 m hides what is behind it, and nothing above or beside that, whether it is carried as a body or stands in the scene.
#[test]
fn carried_towers_hide_what_is_behind_them() {
    let tower = BoxShape { base: DVec3::ZERO, size: DVec3::new(10.0, 20.0, 30.0), yaw: 0.3, color: COLOR };
    for rigid in [true, false] {
        let scene = scene(LayerKind::Boxes(BoxLayer { rigid, ..BoxLayer::new(vec![tower]) }));
        let view = on_a_planet(camera(DVec3::new(-100.0, 0.0, 10.0), DVec3::new(0.0, 0.0, 10.0)));
        let obstacles = Obstacles::seen_by(&scene, &view);
        for cap_m in [0.0, 20.0] {
            let options = SightOptions { chord_m: 0.05, cap_m, guard_m: 1.0 };
            let sees = |p: [f64; 3]| {
                let p = DVec3::from_array(p);
                let image = view.project(p).expect("in the picture");
                obstacles.clearance(&view, (p, 0.0), (image.pixel, image.depth), &options) >= 0.0
            };
            let all = [[50.0, 0.0, 10.0], [50.0, 3.0, 20.0], [50.0, 0.0, 60.0], [50.0, 40.0, 10.0], [-30.0, 0.0, 10.0]];
            assert_eq!(all.map(sees), [false, false, true, true, true], "rigid {rigid}, at most {cap_m} m");
        }
    }
}

/// Ground at 0 with a ridge across the line, 3 m high, 20 m before a point that stands 5 m over the ground: within the guard the ridge
/// counts, for the line passes it by less than 5 m; where there is none, the ground near the point does not count.
#[test]
fn near_a_point_only_ground_that_is_closer_than_its_own_counts() {
    let sight = |ridge: f32| {
        let side = 61;
        let heights = (0..side * side).map(|i| if i % side == 46 { ridge } else { 0.0 }).collect();
        let hf =
            Heightfield::measured(DVec2::new(-200.0, 150.0), DVec2::splat(5.0), side, side, heights).expect("ground");
        let ground = scene(LayerKind::Terrain(TerrainLayer::new(hf)));
        let p = DVec3::new(50.0, 1.0, 5.0);
        let view = View::straight(camera(DVec3::new(-150.0, 1.0, 45.0), p));
        let image = view.project(p).expect("in the picture");
        let options = SightOptions { chord_m: 0.05, cap_m: 50.0, guard_m: 60.0 };
        Obstacles::new(&ground).clearance(&view, (p, 5.0), (image.pixel, image.depth), &options)
    };
    // The line falls by a fifth: it is 9 m high at the ridge, and 17 m high at the border of the guard.
    assert!((sight(0.0) - 17.0).abs() < 0.1, "{}", sight(0.0));
    assert!((sight(3.0) - 17.0).abs() < 0.1, "{}: 6 m over the ridge are more than 5", sight(3.0));
    assert!((sight(6.0) - 3.0).abs() < 0.1, "{}: 3 m over the ridge", sight(6.0));
}
