//! Ground and views of the measurements.
#![allow(dead_code, reason = "each measurement uses a part")]

use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{CurvedRays, DVec2, DVec3, Pinhole, Projection, SplineBend, Stage, View};
use belvedere_scene::{Heightfield, HeightfieldError, Layer, LayerKind, Palette, Relief, Scene, TerrainLayer};

/// Nodes along a side of the ground of the frames: 2.1 million triangles.
pub(crate) const NODES: usize = 1025;
const EXTENT_M: f64 = 10_240.0;

/// The same 10 km of ground with `nodes` x `nodes` nodes.
pub(crate) fn ground(nodes: usize) -> Scene {
    let (half, spacing) = (0.5 * EXTENT_M, EXTENT_M / (nodes - 1) as f64);
    let step = 10.24 / (nodes - 1) as f64;
    let heights = (0..nodes * nodes)
        .map(|i| {
            let (x, y) = ((i % nodes) as f64 * step, (i / nodes) as f64 * step);
            let ridges =
                (1..6).map(|k| (f64::from(k) * (x + 0.7 * y)).sin() * (f64::from(k) * 1.3 * y).cos() / f64::from(k));
            (180.0 * ridges.sum::<f64>()) as f32
        })
        .collect();
    scene(Heightfield::measured(DVec2::new(-half, half), DVec2::splat(spacing), nodes, nodes, heights))
}

/// A scene of one ground.
pub(crate) fn scene(heightfield: Result<Heightfield, HeightfieldError>) -> Scene {
    let heightfield = heightfield.expect("well formed");
    let terrain = TerrainLayer {
        heightfield: heightfield.into(),
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
pub(crate) fn views(image: [u32; 2]) -> Vec<(&'static str, View)> {
    let eye = DVec3::new(0.0, -11_500.0, 6_000.0);
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    let camera =
        Pinhole::look_at(eye, DVec3::new(0.0, 0.0, -900.0), DVec3::Z, lens, image, 1.0, None).expect("well formed");
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

/// Processor time of all threads so far, milliseconds; 0 where the kernel does not tell (it does on Linux).
pub(crate) fn cpu_ms() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return 0.0 };
    let of_task = |t: std::fs::DirEntry| {
        let text = std::fs::read_to_string(t.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    tasks.flatten().filter_map(of_task).sum::<f64>() * 1e-6
}

/// Middle value.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
