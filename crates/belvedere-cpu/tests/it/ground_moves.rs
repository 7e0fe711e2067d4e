//! Ground that an author moves: two renderers of the same picture.

use crate::exact::difference;
use crate::support::{hills, layer, pinhole, scene, terrain};
use belvedere_core::map::ground_moves::{MoveNet, NetPlace};
use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, DVec3, EarthCurvature, GroundMoves, Stage, View};
use belvedere_scene::LayerKind;

/// A hill raised, one shifted, and ground that turns.
fn moved() -> GroundMoves {
    let place = NetPlace { first: DVec2::splat(-700.0), step: 70.0, size: [21, 21] };
    let bump = |p: DVec2, at: DVec2, reach: f64| (1.0 - p.distance_squared(at) / (reach * reach)).max(0.0).powi(2);
    let by = |p: DVec2| {
        let turned = DVec2::new(250.0, 250.0);
        let turn = (DVec2::from_angle(0.6 * bump(p, turned, 350.0)).rotate(p - turned) - (p - turned)).extend(0.0);
        turn + bump(p, DVec2::new(100.0, 0.0), 420.0) * DVec3::new(0.0, 0.0, 120.0)
            + bump(p, DVec2::new(-250.0, 100.0), 350.0) * DVec3::new(90.0, -60.0, 0.0)
    };
    let one = |i: usize| {
        let [x, y] = [i % 21, i / 21];
        let is_inside = x.min(y) >= 3 && x.max(y) < 18;
        if is_inside { by(place.first + place.step * DVec2::new(x as f64, y as f64)) } else { DVec3::ZERO }
    };
    GroundMoves::new(MoveNet::new(place, (0..441).map(one).collect()).expect("a net")).expect("no fold")
}

#[test]
fn rasteriser_and_tracer_agree_on_moved_ground() {
    let scene = scene(vec![layer("ground", LayerKind::Terrain(terrain(hills(24, 50.0, 90.0, 7))))]);
    for (eye, to) in [([-700.0, -300.0, 330.0], [100.0, 0.0, 0.0]), ([300.0, -500.0, 900.0], [100.0, 50.0, 0.0])] {
        let camera = pinhole(DVec3::from(eye), DVec3::from(to), 60.0, [96, 54]);
        let plane = ReferencePlane::level(0.0);
        let preset = PresetDocument::builtin("progressive").expect("built in");
        let bend = SplineBend::new(&camera, &preset, &plane, default_pivot(&camera, &plane)).expect("it fits");
        let earth = EarthCurvature { eye: camera.eye, radius: 8000.0, refraction: 0.13 };
        let ground = || Stage::GroundMoves(moved());
        for stages in
            [vec![ground()], vec![Stage::EarthCurvature(earth), ground()], vec![ground(), Stage::SplineBend(bend)]]
        {
            let view = View::new(camera.clone(), stages).expect("in order");
            let d = difference(&scene, &view);
            assert!(d.judged > d.pixels / 2 && d.is_small(), "{eye:?} {}: {d:?}", view.stages().len());
        }
    }
}
