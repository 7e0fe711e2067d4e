//! The whole circle around an eye: two renderers of the same picture, and a seam that nothing shows.

use crate::exact::difference;
use crate::support::{hills, layer, options, render, scene, terrain};
use belvedere_core::map::spline::{ReferencePlane, SplineBend};
use belvedere_core::map::unroll::{Roll, Unroll};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Projection, Stage, View};
use belvedere_scene::{BoxLayer, BoxShape, Color, LayerKind, Scene};
use std::f64::consts::TAU;

const EYE: DVec3 = DVec3::new(13.0, -7.0, 150.0);

fn surroundings() -> Scene {
    let tower = |i: i32| {
        let at = EYE.truncate() + 260.0 * DVec2::from_angle(TAU * f64::from(i) / 16.0);
        BoxShape {
            base: at.extend(20.0),
            size: DVec3::new(40.0, 30.0, 120.0),
            yaw: 0.3,
            color: Color::rgb(190, 180, 170),
        }
    };
    let boxes = BoxLayer::new((0..16).map(tower).collect());
    scene(vec![
        layer("ground", LayerKind::Terrain(terrain(hills(24, 50.0, 90.0, 7)))),
        layer("towers", LayerKind::Boxes(boxes)),
    ])
}

fn view(heading: f64, span: f64, roll: Roll, image: [u32; 2], more: impl Fn(&Pinhole) -> Vec<Stage>) -> View {
    let map = Unroll::new(EYE, DVec2::from_angle(heading), span, -0.1, roll).expect("in range");
    let [width, height] = image.map(f64::from);
    let lens = Projection::Perspective { fov_y: 2.0 * (0.5 * height * span / width).atan() };
    let ahead = EYE + map.heading().extend(0.0);
    let camera = Pinhole::look_at(EYE, ahead, DVec3::Z, lens, image, 1.0, None).expect("a camera");
    let mut stages = more(&camera);
    stages.push(Stage::Unroll(map));
    stages.sort_by_key(Stage::rank);
    View::new(camera, stages).expect("in order")
}

#[test]
fn rasteriser_and_tracer_agree_all_around() {
    let scene = surroundings();
    let earth = |camera: &Pinhole| {
        vec![Stage::EarthCurvature(EarthCurvature { eye: camera.eye, radius: 8000.0, refraction: 0.13 })]
    };
    let bend = |camera: &Pinhole| {
        let (plane, preset) = (ReferencePlane::level(0.0), PresetDocument::builtin("progressive").expect("built in"));
        let pivot = camera.eye.with_z(0.0) + 400.0 * camera.forward;
        SplineBend::new(camera, &preset, &plane, pivot).map_or(Vec::new(), |bend| vec![Stage::SplineBend(bend)])
    };
    for roll in [Roll::Cylinder, Roll::Sphere] {
        for (name, view) in [
            ("circle", view(0.4, TAU, roll, [240, 60], |_| Vec::new())),
            ("half a circle", view(2.0, 3.0, roll, [160, 60], |_| Vec::new())),
            ("circle on the curved earth", view(-1.0, TAU, roll, [240, 60], earth)),
            ("circle and spline", view(0.4, 2.0, roll, [160, 60], bend)),
        ] {
            let d = difference(&scene, &view);
            assert!(d.judged > d.pixels / 2 && d.is_small(), "{roll:?}, {name}: {d:?}");
        }
    }
}

/// The same picture cut open elsewhere, and turned back by whole columns, is the same.
#[test]
fn nothing_shows_where_the_circle_is_cut_open() {
    let (scene, width) = (surroundings(), 480);
    let turned = |columns: usize| {
        let heading = 0.7 - TAU * columns as f64 / width as f64;
        render(&scene, &view(heading, TAU, Roll::Cylinder, [width as u32, 96], |_| Vec::new()), &options(4))
    };
    let first = turned(0);
    for columns in [60, 240, 333] {
        let other = turned(columns);
        let mut differing = 0;
        for y in 0..first.height {
            for x in 0..width {
                let (a, b) = (y * width + (x + columns) % width, y * width + x);
                let apart = (0..3).any(|c| first.color[a][c].abs_diff(other.color[b][c]) > 24);
                differing += usize::from(apart || first.id[a] != other.id[b]);
                // Sky nowhere but over the skyline: no gap in the ground at either side.
                assert!(other.id[b] != 0 || y < 70, "a hole in column {x}, row {y}");
            }
        }
        assert!(differing * 250 < first.id.len(), "turned by {columns}: {differing} of {} differ", first.id.len());
    }
}
