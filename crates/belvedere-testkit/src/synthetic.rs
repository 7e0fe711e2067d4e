//! Small seeded mountains and an independent, slow renderer.

use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Projection, Stage, View};
use belvedere_scene::{
    Color, Frame, FrameStats, Heightfield, Hidden, Layer, LayerKind, LineFeature, LineLayer, NodeState, PaletteName,
    PointFeature, PointLayer, Relief, RenderError, RenderJob, Renderer, Scene, TerrainLayer,
};
use rayon::prelude::*;

/// Ridged ground of `n` x `n` nodes, 50 m apart, with 400 m of relief.
pub fn mountains(n: usize, seed: u64) -> Heightfield {
    let phase = (seed as f64) * 0.37;
    let height = |x: f64, y: f64| {
        let ridges =
            (x / 310.0 + (y / 530.0 + phase).sin()).sin().abs() + (y / 270.0 + phase + (x / 410.0).cos()).sin().abs();
        (1000.0 + 150.0 * ridges + 40.0 * ((x * 0.013 + y * 0.017 + phase).sin() * (x * 0.011 - y * 0.009).cos()))
            as f32
    };
    let heights = (0..n * n).map(|i| height((i % n) as f64 * 50.0, (i / n) as f64 * 50.0)).collect();
    Heightfield::new(
        DVec2::new(0.0, (n - 1) as f64 * 50.0),
        DVec2::splat(50.0),
        n,
        n,
        heights,
        vec![NodeState::Measured; n * n],
    )
    .unwrap()
}

/// A terrain layer with default style.
pub fn terrain_layer(heightfield: Heightfield) -> Layer {
    let kind = LayerKind::Terrain(TerrainLayer {
        heightfield: heightfield.into(),
        drapes: Vec::new(),
        relief: Relief::Swiss,
        shading: None,
        exaggeration: 1.0,
        palette: PaletteName::Auto.into(),
        contours: None,
        edge: belvedere_scene::Edge::Plain,
    });
    Layer { id: "ground".into(), must_see: false, kind }
}

/// A line that must be visible.
pub fn line_layer(id: &str, points: Vec<DVec3>) -> Layer {
    let features = vec![LineFeature { style: None, name: id.into(), points }];
    let kind = LayerKind::Line(LineLayer::new(features, Color::rgb(200, 30, 30)));
    Layer { id: id.into(), must_see: true, kind }
}

/// A point that must be visible.
pub fn point_layer(id: &str, position: DVec3) -> Layer {
    let kind = LayerKind::Point(PointLayer {
        features: vec![PointFeature { style: None, name: id.into(), position }],
        color: Color::rgb(200, 30, 30),
        size_px: 8.0,
        hidden: Hidden::Fade,
        lift_m: 1.0,
        style: belvedere_scene::PointStyle::default(),
        beyond: 0.0,
    });
    Layer { id: id.into(), must_see: true, kind }
}

/// A winding trail across the mountains, draped on the drawn surface.
pub fn trail(hf: &Heightfield) -> Vec<DVec3> {
    let size = (hf.cols() - 1) as f64 * hf.spacing().x;
    let at = |t: f64| DVec2::new(size * (0.1 + 0.8 * t), size * (0.55 + 0.25 * (9.0 * t).sin()));
    (0..=200).map(|i| at(f64::from(i) / 200.0)).map(|xy| xy.extend(hf.surface_at(xy).unwrap())).collect()
}

/// [`mountains`] with a [`trail`] that must be visible.
pub fn scene(n: usize, seed: u64) -> Scene {
    let hf = mountains(n, seed);
    let points = trail(&hf);
    Scene { layers: vec![terrain_layer(hf), line_layer("trail", points)], ..Scene::default() }
}

/// Camera south of the scene, `height` above the plain.
pub fn camera(scene: &Scene, height: f64, image: [u32; 2]) -> Pinhole {
    let size = scene.bounds().max.x;
    let eye = DVec3::new(0.45 * size, -0.35 * size, 1200.0 + height);
    Pinhole::look_at(
        eye,
        DVec3::new(0.5 * size, 0.5 * size, 1150.0),
        DVec3::Z,
        Projection::Perspective { fov_y: 45f64.to_radians() },
        image,
        1.0,
        None,
    )
    .unwrap()
}

/// A view with curved rays: those of the curvature of an earth much smaller than the real one.
pub fn on_a_small_planet(pinhole: Pinhole, radius: f64) -> View {
    let earth = EarthCurvature { eye: pinhole.eye, radius, refraction: 0.0 };
    View::new(pinhole, vec![Stage::EarthCurvature(earth)]).unwrap()
}

/// First depth at which a dense march along the pixel's ray meets the drawn surface.
pub fn march(view: &View, hf: &Heightfield, pixel: DVec2, from: f64, to: f64, steps: usize) -> Option<f64> {
    let ray = view.ray(pixel);
    let gap = |w: f64| {
        let p = ray.at(w).ok()?.point;
        Some(p.z - hf.surface_at(p.truncate())?)
    };
    let mut before = None::<f64>;
    for i in 0..=steps {
        let w = from + (to - from) * i as f64 / steps as f64;
        if gap(w).is_some_and(|g| g < 0.0) {
            let (mut lo, mut hi) = (before?, w);
            for _ in 0..50 {
                let mid = 0.5 * (lo + hi);
                if gap(mid).is_some_and(|g| g < 0.0) { hi = mid } else { lo = mid }
            }
            return Some(hi);
        }
        before = Some(w);
    }
    None
}

/// Draws by marching along the ray of every pixel. This is slow and shares nothing with the code under test.
pub struct Marcher {
    /// Factor on every depth: a planted fault.
    pub fault: f64,
}

impl Marcher {
    /// Colour of all ground.
    pub const GROUND: [u8; 3] = [120, 140, 90];
    /// Colour of the sky.
    pub const SKY: [u8; 3] = [200, 220, 240];
}

impl Renderer for Marcher {
    fn name(&self) -> &'static str {
        "marcher"
    }

    fn render(&self, job: &RenderJob<'_>) -> Result<Frame, RenderError> {
        let [width, height] = job.view.pinhole().image.map(|n| n as usize);
        let hf = job.scene.terrain().unwrap();
        let far = 2.5 * hf.bounds().max.x;
        let pixel = |i: usize| DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        let depths: Vec<Option<f64>> =
            (0..width * height).into_par_iter().map(|i| march(job.view, hf, pixel(i), 1.0, far, 500)).collect();
        job.progress.tick("march", 1.0)?;
        let world = |(i, depth): (usize, &Option<f64>)| {
            let point = depth.and_then(|depth| job.view.ray(pixel(i)).at(depth).ok());
            point.map_or([f64::NAN; 3], |point| point.point.to_array())
        };
        let world: Option<Vec<[f64; 3]>> =
            job.options.aux.world.then(|| depths.iter().enumerate().map(world).collect());
        let color = depths.iter().map(|depth| if depth.is_some() { Self::GROUND } else { Self::SKY }).collect();
        let depth = depths.iter().map(|depth| depth.map_or(f32::INFINITY, |d| (d * self.fault) as f32)).collect();
        let id = depths.iter().map(|depth| u32::from(depth.is_some())).collect();
        Ok(Frame { width, height, color, depth, id, world, stats: FrameStats::default() })
    }
}
