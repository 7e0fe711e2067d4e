//! Strips along a route: two renderers of the same picture, and the parts that the border of the strip leaves visible.

use crate::exact::difference;
use crate::support::{hills, layer, options, pinhole, render, scene, terrain};
use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere_core::map::straighten::{SmoothedRoute, Strip};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Stage, View};
use belvedere_scene::{LayerKind, Scene};
use belvedere_sight::trace::Tracer;

const HALF_WIDTH: f64 = 110.0;

fn strip(share: f64) -> Strip {
    let road = |i: i32| {
        let t = f64::from(i) / 40.0;
        DVec2::new(170.0 * (5.0 * t).sin(), -560.0 + 1120.0 * t)
    };
    let route = SmoothedRoute::new(&(0..=40).map(road).collect::<Vec<_>>(), HALF_WIDTH, None).expect("it fits");
    Strip::new(route.curve, HALF_WIDTH, share, DVec2::new(0.0, -560.0)).expect("it fits")
}

fn ground() -> Scene {
    scene(vec![layer("ground", LayerKind::Terrain(terrain(hills(24, 50.0, 90.0, 7))))])
}

/// A view along the road from above its start, and one from the side and above.
fn cameras(image: [u32; 2]) -> [Pinhole; 3] {
    let along = strip(1.0).line().at(0.0).tangent().extend(0.0);
    let start = DVec3::new(0.0, -560.0, 0.0);
    [
        pinhole(start - 150.0 * along + DVec3::Z * 190.0, start + 500.0 * along, 55.0, image),
        pinhole(DVec3::new(-500.0, -300.0, 260.0), DVec3::new(200.0, 0.0, 0.0), 60.0, image),
        pinhole(DVec3::new(300.0, 100.0, 900.0), DVec3::new(100.0, 50.0, 0.0), 60.0, image),
    ]
}

pub(crate) fn views(image: [u32; 2]) -> Vec<(&'static str, View)> {
    let mut out = Vec::new();
    for camera in cameras(image) {
        let mut add = |name, stages| out.push((name, View::new(camera.clone(), stages).expect("in order")));
        let earth = EarthCurvature { eye: camera.eye, radius: 8000.0, refraction: 0.13 };
        let plane = ReferencePlane::level(0.0);
        let preset = PresetDocument::builtin("progressive").expect("built in");
        add("strip", vec![Stage::Strip(strip(1.0))]);
        add("half a strip", vec![Stage::Strip(strip(0.5))]);
        add("earth and strip", vec![Stage::EarthCurvature(earth), Stage::Strip(strip(1.0))]);
        if let Ok(bend) = SplineBend::new(&camera, &preset, &plane, default_pivot(&camera, &plane)) {
            add("strip and spline", vec![Stage::Strip(strip(1.0)), Stage::SplineBend(bend)]);
        }
    }
    out
}

#[test]
fn rasteriser_and_tracer_agree_on_strips() {
    let scene = ground();
    for (i, (name, view)) in views([96, 54]).iter().enumerate() {
        let d = difference(&scene, view);
        assert!(d.judged > d.pixels / 2 && d.is_small(), "{i} {name}: {d:?}");
    }
}

#[test]
fn nothing_outside_the_strip_is_drawn_and_all_of_it_inside() {
    let (scene, image) = (ground(), [128, 96]);
    let above = pinhole(DVec3::new(0.0, -10.0, 1500.0), DVec3::ZERO, 50.0, image);
    let map = strip(1.0);
    let view = View::new(above, vec![Stage::Strip(map.clone())]).expect("in order");
    let frame = render(&scene, &view, &options(1));
    let tracer = Tracer::new(&scene, &view);
    let (mut inside, mut beside) = (0, 0);
    for (i, id) in frame.id.iter().enumerate() {
        let pixel = DVec2::new((i % frame.width) as f64 + 0.5, (i / frame.width) as f64 + 0.5);
        let on_ground = view.pinhole().unproject(pixel, 1500.0);
        let off = map.outside(on_ground);
        // Ground that is higher or lower is seen at another place than level ground.
        if off > 20.0 {
            beside += 1;
            assert!(*id == 0 && tracer.first_hit(pixel).is_none(), "{pixel} is drawn, {off} outside");
        } else if off < -30.0 && on_ground.y.abs() < 300.0 {
            inside += 1;
            assert!(*id == 1 && tracer.first_hit(pixel).is_some(), "{pixel} is not drawn, {off} inside");
        }
    }
    assert!(inside > 500 && beside > 1000, "{inside} inside, {beside} beside");
}

#[test]
fn narrow_strips_are_found_from_beside_and_far_away() {
    // Rays that cross a strip are above it only for a small part of their length.
    let route = [DVec2::new(-400.0, 500.0), DVec2::new(0.0, 490.0), DVec2::new(400.0, 500.0)];
    let route = SmoothedRoute::new(&route, 12.0, None).expect("it fits");
    let strip = Strip::new(route.curve, 12.0, 1.0, DVec2::ZERO).expect("it fits");
    let camera = pinhole(DVec3::new(0.0, -560.0, 700.0), DVec3::new(0.0, 490.0, 0.0), 20.0, [64, 48]);
    let view = View::new(camera, vec![Stage::Strip(strip)]).expect("in order");
    let scene = ground();
    let seen = render(&scene, &view, &options(1)).id.iter().filter(|id| **id == 1).count();
    let tracer = Tracer::new(&scene, &view);
    let traced = (0..64 * 48)
        .filter(|i| tracer.first_hit(DVec2::new(f64::from(i % 64) + 0.5, f64::from(i / 64) + 0.5)).is_some());
    let traced = traced.count();
    assert!(seen > 60 && seen.abs_diff(traced) * 10 < seen, "{seen} drawn, {traced} traced");
}
