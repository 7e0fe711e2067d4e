//! Measures of scenes with rigid bodies: lines of sight and depth buffers agree, for what stands behind bodies and for bodies themselves.

use belvedere_construct::{MeasureOptions, measure};
use belvedere_core::map::spline::{ReferencePlane, SplineBend, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, Stage, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Heightfield, Layer, LayerKind, LineFeature, LineLayer, Progress, Scene, TerrainLayer,
};

/// A hybrid bend seen from so near that space folds 31 m over the ground.
fn view() -> View {
    let lens = Projection::Perspective { fov_y: 0.87 };
    let camera =
        Pinhole::look_at(DVec3::new(-40.0, -250.0, 180.0), DVec3::ZERO, DVec3::Z, lens, [640, 480], 1.0, None).unwrap();
    let plane = ReferencePlane::level(0.0);
    let document = PresetDocument::builtin("hybrid-flat-steep-flat").unwrap();
    let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane)).unwrap();
    View::new(camera, vec![Stage::SplineBend(bend)]).unwrap()
}

fn towers() -> Vec<BoxShape> {
    (0..40)
        .map(|i| {
            let (c, r) = (f64::from(i % 8) - 3.5, f64::from(i / 8) - 2.0);
            let base = DVec3::new(36.0 * c, 60.0 * r, 0.0);
            let size = DVec3::new(14.0, 11.0, if i % 2 == 0 { 60.0 } else { 18.0 });
            BoxShape { base, size, yaw: 0.2 * f64::from(i % 5), color: Color::rgb(200, 190, 180) }
        })
        .collect()
}

/// Flat ground with towers on it and a street behind every row.
fn scene(rigid: bool, towers_must_be_seen: bool) -> Scene {
    let flat =
        Heightfield::measured(DVec2::new(-300.0, 400.0), DVec2::splat(10.0), 61, 71, vec![0.0; 61 * 71]).unwrap();
    let street = |r: i32| LineFeature {
        style: None,
        name: format!("street {r}"),
        points: vec![
            DVec3::new(-150.0, 60.0 * f64::from(r) + 22.0, 0.0),
            DVec3::new(150.0, 60.0 * f64::from(r) + 22.0, 0.0),
        ],
    };
    let lines = LineLayer::new((-2..3).map(street).collect(), Color::rgb(200, 40, 40));
    let layer = |id: &str, must_see, kind| Layer { id: id.into(), must_see, kind };
    let layers = vec![
        layer("ground", false, LayerKind::Terrain(TerrainLayer::new(flat))),
        layer("towers", towers_must_be_seen, LayerKind::Boxes(BoxLayer { rigid, ..BoxLayer::new(towers()) })),
        layer("streets", !towers_must_be_seen, LayerKind::Line(lines)),
    ];
    Scene { layers, ..Scene::default() }
}

fn shares(rigid: bool, towers_must_be_seen: bool) -> [f64; 3] {
    let renderer = CpuRenderer::default();
    let scene = scene(rigid, towers_must_be_seen);
    let found = measure(&scene, &view(), Some(&renderer), &MeasureOptions::default(), &Progress::silent()).unwrap();
    let all = if towers_must_be_seen { found.surfaces } else { found.lines }.expect("measured");
    [all.bent.sight.share.unwrap(), all.bent.buffer.unwrap().share.unwrap(), all.bent.folded_share]
}

#[test]
fn both_methods_agree_on_streets_behind_rigid_towers() {
    let [sight, buffer, _] = shares(true, false);
    assert!((sight - buffer).abs() < 0.02, "{sight} {buffer}");
    assert!((0.2..0.95).contains(&sight), "{sight}: towers hide some of it");
    let [bent, _, _] = shares(false, false);
    assert!((bent - sight).abs() > 0.002, "rigid towers hide something else: {sight} {bent}");
}

#[test]
fn both_methods_agree_on_rigid_towers_themselves() {
    let [sight, buffer, folded] = shares(true, true);
    assert!((sight - buffer).abs() < 0.03, "{sight} {buffer}");
    assert!((0.15..0.6).contains(&sight) && folded == 0.0, "{sight} {folded}");
    let [_, _, folded] = shares(false, true);
    assert!(folded > 0.01, "the bend itself folds them: {folded}");
}
