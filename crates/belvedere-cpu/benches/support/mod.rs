//! Ground and views of the measurements.

use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{CurvedRays, DVec2, DVec3, Pinhole, Projection, SplineBend, Stage, View};
use belvedere_scene::{Heightfield, Layer, LayerKind, NodeState, Palette, Relief, Scene, TerrainLayer};

const NODES: usize = 1025;
const SPACING_M: f64 = 10.0;

/// 2.1 million triangles.
pub(crate) fn ground() -> Scene {
    let half = 0.5 * (NODES - 1) as f64 * SPACING_M;
    let heights = (0..NODES * NODES)
        .map(|i| {
            let (x, y) = ((i % NODES) as f64 * 0.01, (i / NODES) as f64 * 0.01);
            let ridges =
                (1..6).map(|k| (f64::from(k) * (x + 0.7 * y)).sin() * (f64::from(k) * 1.3 * y).cos() / f64::from(k));
            (180.0 * ridges.sum::<f64>()) as f32
        })
        .collect();
    let states = vec![NodeState::Measured; NODES * NODES];
    let heightfield = Heightfield::new(DVec2::new(-half, half), DVec2::splat(SPACING_M), NODES, NODES, heights, states)
        .expect("well formed");
    let terrain = TerrainLayer {
        heightfield,
        drapes: Vec::new(),
        relief: Relief::Swiss,
        shading: None,
        exaggeration: 1.0,
        palette: Palette::Alpine,
    };
    Scene {
        layers: vec![Layer { id: "ground".into(), must_see: false, kind: LayerKind::Terrain(terrain) }],
        ..Scene::default()
    }
}

/// The straight view and the bent ones, all of the ground in the picture.
pub(crate) fn views() -> Vec<(&'static str, View)> {
    let eye = DVec3::new(0.0, -11_500.0, 6_000.0);
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    let camera = Pinhole::look_at(eye, DVec3::new(0.0, 0.0, -900.0), DVec3::Z, lens, [1280, 720], 1.0, None)
        .expect("well formed");
    let turn = TurnSpec {
        viewpoint: eye + DVec3::Z * 2000.0,
        t0: DVec3::new(0.0, -1500.0, 0.0),
        t1: DVec3::ZERO,
        t2: DVec3::new(0.0, 1500.0, 0.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&camera, Model::Modified, &[turn]).expect("a valid turn");
    let plane = ReferencePlane::level(0.0);
    let document = PresetDocument::builtin("progressive").expect("built in");
    let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane)).expect("fits");
    let bent = |stage| View::new(camera.clone(), vec![stage]).expect("one stage");
    vec![
        ("straight", View::straight(camera.clone())),
        ("curved rays", bent(Stage::CurvedRays(rays))),
        ("spline", bent(Stage::SplineBend(bend))),
    ]
}
