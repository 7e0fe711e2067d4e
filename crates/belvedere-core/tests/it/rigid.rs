//! Laws of rigid bodies: a body that a view moves as a whole keeps its shape and moves with its foot.

use crate::spline_figures::{bend, camera_at};
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::earth::EarthCurvature;
use belvedere_core::map::spline::{ReferencePlane, SplineBend};
use belvedere_core::presets::{BendFrame, PresetDocument};
use belvedere_core::{Aabb, CurvedRays, DMat3, DVec3, Pinhole, Projection, RigidMotion, SpaceMap, Stage, View};
use belvedere_testkit::Random;
use belvedere_testkit::laws::{Continuity, MapCase, Similarity};

const FIVE: [&str; 5] = ["progressive", "degressive", "hybrid-flat-steep-flat", "hybrid-steep-flat-steep", "map"];
/// Distance from the pivot at which ordinary houses fold.
const NEAR: f64 = 300.0;

fn document(name: &str, frame: BendFrame) -> PresetDocument {
    PresetDocument { frame, ..PresetDocument::builtin(name).unwrap() }
}

fn view(name: &str, frame: BendFrame) -> (View, SplineBend) {
    let document = document(name, frame);
    let camera = camera_at(document.presets[0].phi, NEAR);
    let bend = bend(&document, &camera);
    (View::new(camera, vec![Stage::SplineBend(bend.clone())]).unwrap(), bend)
}

/// Feet on the plane, before, on and beyond the curve.
fn feet() -> Vec<DVec3> {
    let mut random = Random::new(11);
    (0..60).map(|_| DVec3::new(random.range(-200.0, 200.0), random.range(-220.0, 500.0), 0.0)).collect()
}

/// The motion of one body in a world that is moved, turned and scaled.
fn moved_motion(s: &Similarity, name: &str) -> RigidMotion {
    let document = PresetDocument::builtin(name).unwrap();
    let still = camera_at(35.0, NEAR);
    let projection = Projection::Perspective { fov_y: 50f64.to_radians() };
    let (eye, target) = (s.point(still.eye), s.point(DVec3::ZERO));
    let up = s.direction(-still.down);
    let camera = Pinhole::look_at(eye, target, up, projection, [1280, 720], s.length(1.0), None).unwrap();
    let normal = s.direction(DVec3::Z);
    let plane = ReferencePlane::new(normal, target.dot(normal)).unwrap();
    let bend = SplineBend::new(&camera, &document, &plane, target).unwrap();
    let view = View::new(camera, vec![Stage::SplineBend(bend)]).unwrap();
    view.body_motion(s.point(DVec3::new(40.0, 55.0, 3.0))).unwrap()
}

fn motion_case() -> MapCase<RigidMotion> {
    let region = Aabb::of([DVec3::new(-50.0, -50.0, -200.0), DVec3::new(150.0, 150.0, 900.0)]);
    MapCase::new("a body on a hybrid", region, |s| moved_motion(s, "hybrid-flat-steep-flat"))
        .continuity(Continuity::Smooth)
        .identity_at_zero_strength(|| moved_motion(&Similarity::IDENTITY, "identity(35)"))
}

belvedere_testkit::space_map_laws!(body, super::motion_case());

#[test]
fn bodies_keep_their_shape_however_tall_they_are() {
    for name in FIVE {
        for frame in [BendFrame::Camera, BendFrame::Plane] {
            let (view, bend) = view(name, frame);
            let mut folded = 0;
            for foot in feet() {
                let motion = view.body_motion(foot).unwrap();
                let r = motion.rotation();
                assert!((r.transpose() * r - DMat3::IDENTITY).to_cols_array().iter().all(|v| v.abs() < 1e-12));
                assert!((r.determinant() - 1.0).abs() < 1e-12, "{name}: turned inside out");
                let roof = foot + DVec3::new(8.0, -5.0, 250.0);
                folded += usize::from(bend.is_folded(roof));
                let kept = motion.carry(roof).distance(motion.carry(foot));
                assert!((kept - roof.distance(foot)).abs() < 1e-9, "{name}: {kept}");
                assert!(motion.undo(motion.carry(roof)).distance(roof) < 1e-9);
            }
            assert!(folded > 0 || !name.starts_with("hybrid"), "{name}: no tower is beyond the fold limit");
        }
    }
}

#[test]
fn a_body_goes_with_its_foot_and_turns_with_the_ground_there() {
    for name in FIVE {
        let (view, bend) = view(name, BendFrame::Camera);
        for foot in feet() {
            let motion = view.body_motion(foot).unwrap();
            assert!(motion.carry(foot).distance(bend.apply(foot).unwrap()) < 1e-9);
            let ground = bend.jacobian(foot).unwrap();
            let off = (motion.rotation() - ground).to_cols_array().iter().fold(0.0f64, |a, v| a.max(v.abs()));
            assert!(off < 1e-9, "{name} at {foot}: the derivative is off by {off}");
        }
        // The body agrees with the bend to first order: at half the distance from the foot the error is a quarter.
        let foot = DVec3::new(30.0, 20.0, 0.0);
        let motion = view.body_motion(foot).unwrap();
        let off = |r: f64| {
            let p = foot + r * DVec3::new(0.3, 0.8, 0.5);
            motion.carry(p).distance(bend.apply(p).unwrap())
        };
        assert!(off(0.5) < 0.3 * off(1.0) + 1e-9, "{name}: {} {}", off(0.5), off(1.0));
    }
}

#[test]
fn a_straight_curve_carries_bodies_like_everything_else() {
    let (camera, document) = (camera_at(35.0, NEAR), PresetDocument::builtin("identity(35)").unwrap());
    let bend = bend(&document, &camera);
    let view = View::new(camera, vec![Stage::SplineBend(bend)]).unwrap();
    for foot in feet() {
        let motion = view.body_motion(foot + 7.0 * DVec3::Z).unwrap();
        let p = foot + DVec3::new(20.0, 30.0, 120.0);
        assert!(motion.carry(p).distance(p) < 1e-8, "{}", motion.carry(p));
    }
}

#[test]
fn stages_before_the_bend_move_bodies_by_their_foot_alone() {
    let (bent, bend) = view("degressive", BendFrame::Camera);
    let camera = bent.pinhole().clone();
    let earth = EarthCurvature { eye: camera.eye, radius: 4000.0, refraction: 0.13 };
    let view = View::new(camera.clone(), vec![Stage::EarthCurvature(earth)]).unwrap();
    let foot = DVec3::new(60.0, 200.0, 5.0);
    let motion = view.body_motion(foot).unwrap();
    assert_eq!(motion.rotation(), DMat3::IDENTITY);
    assert!(motion.carry(foot).z < foot.z - 1.0, "the ground falls away");
    let both = View::new(camera.clone(), vec![Stage::EarthCurvature(earth), Stage::SplineBend(bend.clone())]).unwrap();
    let sunk = earth.apply(foot).unwrap();
    let motion = both.body_motion(foot).unwrap();
    assert!(motion.carry(foot).distance(bend.apply(sunk).unwrap()) < 1e-9);
    assert_eq!(motion.rotation(), bend.rotation_at(sunk));
    // Without a stage that carries bodies, they are treated like everything else.
    assert!(!View::straight(camera).carries_bodies() && bent.carries_bodies() && !bent.after_bodies().carries_bodies());
}

#[test]
fn walls_are_straight_in_the_picture_where_the_bend_would_fold_them() {
    let (view, bend) = view("hybrid-flat-steep-flat", BendFrame::Camera);
    let (mut judged, mut bowed) = (0, 0);
    let more = (0..200).map(|i| DVec3::new(-40.0 + 0.4 * f64::from(i), -100.0 + f64::from(i), 0.0));
    for foot in feet().into_iter().chain(more) {
        let motion = view.body_motion(foot).unwrap();
        let own = view.of_body(motion);
        let edge: Vec<DVec3> = (0..=20).map(|i| foot + DVec3::new(6.0, 9.0, 4.0 * f64::from(i))).collect();
        let Ok(images) = edge.iter().map(|p| own.project(*p)).collect::<Result<Vec<_>, _>>() else { continue };
        let (a, b) = (images[0].pixel, images[20].pixel);
        let along = (b - a).normalize();
        for image in &images {
            assert!((image.pixel - a).perp_dot(along).abs() < 1e-7, "bowed by {}", (image.pixel - a).perp_dot(along));
            assert!(!image.folded);
        }
        judged += 1;
        bowed += usize::from(bend.is_folded(edge[20]));
        // The stages after the bend see the carried body.
        let carried = view.after_bodies().project(motion.carry(edge[20])).unwrap();
        assert!(carried.pixel.distance(b) < 1e-9);
    }
    assert!(judged > 200 && bowed > 10, "{judged} {bowed}");
}

#[test]
fn curved_rays_after_the_bend_see_carried_bodies_as_they_see_everything() {
    let (bent, bend) = view("degressive", BendFrame::Camera);
    let camera = bent.pinhole().clone();
    let forward = camera.forward.with_z(0.0).normalize();
    let at = |d: f64| camera.eye + forward * d;
    let turn = TurnSpec {
        viewpoint: camera.eye + DVec3::Z * 60.0,
        t0: at(200.0),
        t1: at(260.0),
        t2: at(330.0),
        pencil: Pencil::Parallel { normal: -forward },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&camera, Model::Modified, &[turn]).unwrap();
    let view = View::new(camera, vec![Stage::SplineBend(bend), Stage::CurvedRays(rays.clone())]).unwrap();
    let mut turned = 0;
    for foot in feet() {
        let motion = view.body_motion(foot).unwrap();
        let p = foot + DVec3::new(3.0, -2.0, 30.0);
        let displaced = view.of_body(motion).displace(p).unwrap();
        let expected = rays.displace(motion.carry(p)).unwrap();
        assert!(displaced.point.distance(expected.point) < 1e-9 && displaced.segment == expected.segment);
        turned += usize::from(expected.point.distance(motion.carry(p)) > 1e-6);
        // At its foot the body is where the ground is.
        let ground = view.displace(foot).unwrap().point;
        assert!(view.of_body(motion).displace(foot).unwrap().point.distance(ground) < 1e-8);
    }
    assert!(turned > 10, "{turned}");
}
