//! Scenes, cameras and picture files for the tests.

pub(crate) use belvedere_core::random::Random;
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    Color, Frame, Heightfield, Hidden, Layer, LayerKind, Light, LineFeature, LineLayer, NodeState, PaletteName,
    Progress, Relief, RenderJob, RenderOptions, Renderer, Scene, TerrainLayer,
};
use std::f64::consts::TAU;

pub(crate) fn terrain(heightfield: Heightfield) -> TerrainLayer {
    TerrainLayer {
        heightfield: heightfield.into(),
        drapes: Vec::new(),
        relief: Relief::Swiss,
        shading: None,
        exaggeration: 1.0,
        palette: PaletteName::Auto.into(),
        contours: None,
        edge: belvedere_scene::Edge::Plain,
    }
}

pub(crate) fn layer(id: &str, kind: LayerKind) -> Layer {
    Layer { id: id.into(), must_see: false, kind }
}

pub(crate) fn scene(layers: Vec<Layer>) -> Scene {
    Scene { layers, ..Scene::default() }
}

/// Rolling hills of `n` x `n` nodes, `spacing` metres apart, centred on the origin.
pub(crate) fn hills(n: usize, spacing: f64, height: f64, seed: u64) -> Heightfield {
    let mut random = Random::new(seed);
    let waves: Vec<(DVec2, f64, f64)> = (0..8)
        .map(|i| {
            let k = 1.7f64.powi(i) * 3.0 / (n as f64 * spacing);
            (DVec2::from_angle(random.range(0.0, TAU)) * k, random.range(0.0, TAU), 0.62f64.powi(i))
        })
        .collect();
    let half = 0.5 * (n - 1) as f64 * spacing;
    let heights = (0..n * n)
        .map(|i| {
            let p = DVec2::new((i % n) as f64 * spacing - half, half - (i / n) as f64 * spacing);
            let z: f64 = waves.iter().map(|(k, phase, a)| a * (k.dot(p) * TAU + phase).sin()).sum();
            (0.3 * height * z) as f32
        })
        .collect();
    Heightfield::new(DVec2::new(-half, half), DVec2::splat(spacing), n, n, heights, vec![NodeState::Measured; n * n])
        .expect("hills are well formed")
}

pub(crate) fn pinhole(eye: DVec3, look_at: DVec3, fov_deg: f64, image: [u32; 2]) -> Pinhole {
    let projection = Projection::Perspective { fov_y: fov_deg.to_radians() };
    Pinhole::look_at(eye, look_at, DVec3::Z, projection, image, 1.0, None).expect("camera is well formed")
}

pub(crate) fn render(scene: &Scene, view: &View, options: &RenderOptions) -> Frame {
    let job = RenderJob { scene, view, light: &Light::default(), options, progress: &Progress::silent() };
    CpuRenderer::default().render(&job).expect("picture is possible")
}

pub(crate) fn options(samples: u32) -> RenderOptions {
    RenderOptions { samples, lod_px: 0.0, ..RenderOptions::default() }
}

pub(crate) fn line(points: Vec<DVec3>, hidden: Hidden) -> LineLayer {
    LineLayer {
        features: vec![LineFeature { style: None, name: String::new(), points }],
        color: Color::rgb(215, 48, 31),
        width_px: 3.0,
        casing: Some(Color::rgb(255, 255, 255)),
        hidden,
        lift_m: 2.0,
        markers: None,
        label_px: None,
        marker_px: belvedere_scene::SMALL_LETTERS_PX,
        beyond: 0.0,
    }
}

/// Writes a picture as PPM into `$BELVEDERE_PICTURES`, if that is set, so that a person can look at it.
pub(crate) fn show(name: &str, frame: &Frame) {
    let Some(dir) = std::env::var_os("BELVEDERE_PICTURES") else { return };
    let mut bytes = format!("P6 {} {} 255\n", frame.width, frame.height).into_bytes();
    bytes.extend(frame.color.iter().flatten());
    std::fs::write(std::path::Path::new(&dir).join(format!("{name}.ppm")), bytes).expect("picture folder is writable");
}
