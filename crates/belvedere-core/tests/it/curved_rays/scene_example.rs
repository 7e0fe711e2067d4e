//! The second example scene of the scene-file documentation.

use belvedere_core::map::curved_rays::{CurvedRays, Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::{DVec3, Pinhole, Projection};

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
