//! The second example scene of the scene-file documentation.

use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, Stage, View};
use belvedere_testkit::Random;

pub(super) fn root() -> Pinhole {
    Pinhole::look_at(
        DVec3::new(377_000.0, 4_700_500.0, 3200.0),
        DVec3::new(390_500.0, 4_712_000.0, 2000.0),
        DVec3::Z,
        Projection::Perspective { fov_y: 45f64.to_radians() },
        [1280, 720],
        1.0,
        None,
    )
    .unwrap()
}

pub(super) fn turn() -> TurnSpec {
    TurnSpec {
        viewpoint: DVec3::new(379_590.0, 4_697_460.0, 3200.0),
        t0: DVec3::new(381_940.0, 4_704_710.0, 2760.0),
        t1: DVec3::new(383_080.0, 4_705_680.0, 2660.0),
        t2: DVec3::new(384_220.0, 4_706_650.0, 2560.0),
        pencil: Pencil::Line { point: DVec3::new(377_890.0, 4_711_770.0, 2660.0), dir: DVec3::Z },
        m: Sharpness::Bend,
    }
}

#[test]
fn is_valid_with_the_documented_sharpness() {
    let rays = CurvedRays::new(&root(), Model::Modified, &[turn()]).unwrap();
    let m = rays.turns()[0].m.unwrap();
    assert!((m - 1.0457).abs() < 5e-5, "m = {m}");
    assert_eq!(rays.spec(), [turn()]);
}

#[test]
fn other_sharpnesses_are_near_it() {
    for m in [Sharpness::Left, Sharpness::Mid] {
        let rays = CurvedRays::new(&root(), Model::Modified, &[TurnSpec { m, ..turn() }]).unwrap();
        let value = rays.turns()[0].m.unwrap();
        assert!((0.7..1.5).contains(&value), "{m:?} = {value}");
    }
}

fn view(origin: DVec3, model: Model) -> View {
    let root = Pinhole { eye: root().eye - origin, ..root() };
    let t = turn();
    let Pencil::Line { point, dir } = t.pencil else { panic!("a line") };
    let [viewpoint, t0, t1, t2] = [t.viewpoint, t.t0, t.t1, t.t2].map(|p| p - origin);
    let turn = TurnSpec { viewpoint, t0, t1, t2, pencil: Pencil::Line { point: point - origin, dir }, m: t.m };
    let rays = CurvedRays::new(&root, model, &[turn]).unwrap();
    View::new(root, vec![Stage::CurvedRays(rays)]).unwrap()
}

/// Coordinates of millions of metres cost no more than their own rounding: same pixels as with the eye at the origin.
#[test]
fn projected_coordinates_lose_nothing() {
    let mut random = Random::new(1);
    for model in [Model::Modified, Model::Original, Model::C0, Model::C2, Model::Circular] {
        let (far_off, local) = (view(DVec3::ZERO, model), view(root().eye, model));
        for _ in 0..2000 {
            let pixel = DVec2::new(random.range(0.0, 1280.0), random.range(0.0, 720.0));
            let depth = random.range(200.0, 40_000.0);
            let seen = far_off.ray(pixel).at(depth).unwrap();
            let again = far_off.project(seen.point).unwrap();
            let shifted = local.project(seen.point - root().eye).unwrap();
            let same_point = (local.ray(pixel).at(depth).unwrap().point + root().eye - seen.point).length();
            let limit_px = 5e-9 * far_off.pinhole().scale_px() / depth;
            assert!((again.pixel - pixel).length() < limit_px, "{model:?} {pixel} {depth}: {}", again.pixel);
            assert!((shifted.pixel - pixel).length() < limit_px, "{model:?} {pixel} {depth}: {}", shifted.pixel);
            assert!(same_point < 1e-8, "{model:?} {pixel} {depth}: {same_point} m");
            assert_eq!(again.segment, seen.segment);
        }
    }
}
