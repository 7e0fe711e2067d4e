//! The ground and the views that are measured.

use anyhow::Result;
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::map::spline::{ReferencePlane, default_pivot};
use belvedere::core::presets::PresetDocument;
use belvedere::core::{CurvedRays, DVec2, DVec3, Pinhole, Projection, SplineBend, Stage, View};
use belvedere::scene::{Heightfield, Layer, PaletteName, Relief, Scene, TerrainLayer};

/// Name of what bends a view, and the view.
pub type NamedView = (&'static str, View);

/// Ridges on 10 km of ground, `nodes` x `nodes` nodes.
///
/// # Errors
/// Fewer than two nodes.
pub fn ground(nodes: usize) -> Result<Scene> {
    let extent = 10_240.0;
    let (half, spacing, step) = (0.5 * extent, extent / (nodes - 1) as f64, 10.24 / (nodes - 1) as f64);
    let height = |i: usize| {
        let (x, y) = ((i % nodes) as f64 * step, (i / nodes) as f64 * step);
        let ridge = |k: i32| (f64::from(k) * (x + 0.7 * y)).sin() * (f64::from(k) * 1.3 * y).cos() / f64::from(k);
        (180.0 * (1..6).map(ridge).sum::<f64>()) as f32
    };
    let heights = (0..nodes * nodes).map(height).collect();
    Ok(scene_of(Heightfield::measured(DVec2::new(-half, half), DVec2::splat(spacing), nodes, nodes, heights)?))
}

/// A scene of one ground.
pub fn scene_of(heightfield: Heightfield) -> Scene {
    let terrain = TerrainLayer {
        heightfield: heightfield.into(),
        drapes: Vec::new(),
        relief: Relief::Swiss,
        shading: None,
        exaggeration: 1.0,
        palette: PaletteName::Alpine.into(),
        contours: None,
        edge: belvedere::scene::Edge::Plain,
    };
    let layer = Layer { id: "ground".into(), must_see: false, kind: terrain.into() };
    Scene { layers: vec![layer], ..Scene::default() }
}

/// The straight view and the bent ones, all of the ground in the picture.
///
/// # Errors
/// An image without pixels.
pub fn views(image: [u32; 2]) -> Result<[NamedView; 3]> {
    let eye = DVec3::new(0.0, -11_500.0, 6_000.0);
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    let target = DVec3::new(0.0, 0.0, -900.0);
    let camera = Pinhole::look_at(eye, target, DVec3::Z, lens, image, 1.0, None)?;
    let turn = TurnSpec {
        viewpoint: eye + DVec3::Z * 2000.0,
        t0: DVec3::new(0.0, -1500.0, 0.0),
        t1: DVec3::ZERO,
        t2: DVec3::new(0.0, 1500.0, 0.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&camera, Model::Modified, &[turn])?;
    let plane = ReferencePlane::level(0.0);
    let document = PresetDocument::builtin("progressive")?;
    let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane))?;
    let bent = |stage| View::new(camera.clone(), vec![stage]);
    Ok([
        ("straight", View::straight(camera.clone())),
        ("curved rays", bent(Stage::CurvedRays(rays))?),
        ("spline", bent(Stage::SplineBend(bend))?),
    ])
}

/// The straight view with `turns` turns one behind the other over the whole ground, whose viewpoints lead 2 km sideways.
///
/// # Errors
/// An image without pixels, turns too narrow to be told apart.
pub fn chain(image: [u32; 2], turns: usize) -> Result<View> {
    let [(_, straight), ..] = views(image)?;
    let camera = straight.pinhole().clone();
    let step = 9_000.0 / turns as f64;
    let turn = |k: usize| {
        let y = -4_500.0 + (k as f64 + 0.5) * step;
        let side = 2_000.0 * (k + 1) as f64 / turns as f64;
        TurnSpec {
            viewpoint: camera.eye + DVec3::new(side, 0.0, 0.0),
            t0: DVec3::new(0.0, y - 0.4 * step, 0.0),
            t1: DVec3::new(0.0, y, 0.0),
            t2: DVec3::new(0.0, y + 0.4 * step, 0.0),
            pencil: Pencil::Parallel { normal: -DVec3::Y },
            m: Sharpness::Bend,
        }
    };
    let specs: Vec<TurnSpec> = (0..turns).map(turn).collect();
    let rays = CurvedRays::new(&camera, Model::Modified, &specs)?;
    Ok(View::new(camera, vec![Stage::CurvedRays(rays)])?)
}
