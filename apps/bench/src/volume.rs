//! A block of voxels, straight and bent rays through it.

use crate::clock::{Stopwatch, median};
use anyhow::{Result, ensure};
use belvedere::core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere::core::{CurvedRays, DMat3, DVec2, DVec3, Pinhole, Projection, Stage, View};
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{
    Color, Frame, Layer, LayerKind, Light, Progress, RenderJob, RenderOptions, Renderer, Scene, TransferFunction,
    TransferPoint, Unit, Volume, VolumeLayer, VolumeModel, VoxelValues,
};
use schemars::JsonSchema;
use serde::Serialize;

/// Voxels along x, y, z, as many as the engine of the paper has.
pub const DIMS: [usize; 3] = [256, 256, 110];
/// Distance of the eye from the middle of the volume on the ground, and its height over it, voxels.
const DISTANCE: f64 = 330.0;
const HEIGHT: f64 = 0.45;
/// How far aside the second viewpoint is, and the depths of the planes of the turn, voxels: all of the volume lies in the transition.
const ASIDE: f64 = 120.0;
const PLANES: [f64; 3] = [180.0, 370.0, 560.0];
/// Spacing along both axes of the pixels whose rays are measured, and the number of steps in depth along each ray.
const EVERY: u32 = 8;
const DEPTHS: usize = 400;

/// What is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeRequest {
    /// Frames, over a quarter turn around the volume.
    pub frames: usize,
    /// Size of the picture.
    pub image: [u32; 2],
    /// Distance of samples, voxel edges.
    pub step: f64,
    /// Whether gradients shade.
    pub shaded: bool,
}

/// Frames of a volume.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct VolumeCost {
    /// Bend.
    pub view: &'static str,
    /// Median processor time of a frame, milliseconds.
    pub cpu_ms: f64,
    /// Median wall time of a frame, milliseconds.
    pub wall_ms: f64,
    /// Samples taken, millions, of the last frame.
    pub samples_m: f64,
    /// Share of the pixels whose rays meet the volume, on the average over frames.
    pub covered: f64,
    /// Mean length of their rays inside it, voxel edges.
    pub length: f64,
    /// Processor time for a covered pixel and a voxel edge of its ray, nanoseconds; median.
    pub ns_per_length: f64,
    /// Median of the ratios of that time to the straight frame's of the same round.
    pub ratio: f64,
}

/// A bored block with dense rings and noise, 256 x 256 x 110 voxels of 8 bits.
pub fn block() -> Vec<u8> {
    let [nx, ny, nz] = DIMS;
    let share = |i: usize, n: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    let mut state = 7u64;
    let mut noise = move || {
        // xorshift64*: cheap, the same everywhere.
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as f64 / f64::from(1u32 << 24) - 0.5
    };
    let value = |i: usize| {
        let [x, y, z] = [share(i % nx, nx), share(i / nx % ny, ny), share(i / nx / ny, nz)];
        let mut v = if x.abs().max(y.abs()).max(z.abs()) < 0.8 { 120.0 } else { 0.0 };
        for (cx, cy, r) in [(-0.4, -0.3, 0.25), (0.4, -0.3, 0.25), (0.0, 0.45, 0.2)] {
            let off = DVec2::new(x - cx, y - cy).length();
            if off < r {
                v = 12.0;
            }
            if (off - r).abs() < 0.04 && z.abs() < 0.7 {
                v = 215.0;
            }
        }
        v + 6.0 * (noise() + noise() + noise() + noise()) * 1.7
    };
    (0..nx * ny * nz).map(value).map(|v| v.clamp(0.0, 255.0) as u8).collect()
}

/// A scene of the voxels, x fastest, with a transfer function that lets air be clear, metal thin and what is denser opaque.
///
/// # Errors
/// Another number of voxels than [`DIMS`].
pub fn scene(values: Vec<u8>, request: &VolumeRequest) -> Result<Scene> {
    let volume = Volume::new(DIMS, DMat3::IDENTITY, DVec3::ZERO, VoxelValues::U8(values))?;
    let opacities = [(0.0, 0.0), (60.0, 0.0), (100.0, 0.04), (150.0, 0.05), (200.0, 0.4), (215.0, 0.51), (255.0, 0.8)];
    let color = |v: f64| match v {
        v if v < 100.0 => Color::rgb((1.53 * v) as u8, (1.53 * v) as u8, (1.785 * v) as u8),
        v if v < 180.0 => Color::rgb(166, 166, 160),
        v if v < 240.0 => Color::rgb(255, 153, 51),
        _ => Color::rgb(255, 255, 255),
    };
    let points = opacities.map(|(value, opacity)| TransferPoint { value, color: color(value), opacity });
    let transfer = TransferFunction::new("bench", points.to_vec(), 1.0)?;
    let model = if request.shaded { VolumeModel::Shaded } else { VolumeModel::Plain };
    let kind = LayerKind::Volume(VolumeLayer { step: request.step, model, ..VolumeLayer::new(volume, transfer) });
    let layers = vec![Layer { id: "volume".into(), must_see: false, kind }];
    Ok(Scene { unit: Unit::Voxel, layers, ..Scene::default() })
}

/// The straight and the bent view at a share of the quarter turn.
fn views(image: [u32; 2], share: f64) -> Result<[View; 2]> {
    let middle = 0.5 * DVec3::from_array(DIMS.map(|n| n as f64));
    let (sin, cos) = (0.3 + std::f64::consts::FRAC_PI_2 * share).sin_cos();
    let eye = middle + DISTANCE * DVec3::new(sin, -cos, HEIGHT);
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    let camera = Pinhole::look_at(eye, middle, DVec3::Z, lens, image, 1.0, None)?;
    let [t0, t1, t2] = PLANES.map(|d| eye + d * camera.forward);
    let pencil = Pencil::Parallel { normal: -camera.forward };
    let turn = TurnSpec { viewpoint: eye + ASIDE * camera.right, t0, t1, t2, pencil, m: Sharpness::Bend };
    let rays = CurvedRays::new(&camera, Model::Modified, &[turn])?;
    Ok([View::straight(camera.clone()), View::new(camera, vec![Stage::CurvedRays(rays)])?])
}

/// Share of the pixels whose rays meet the volume, and the mean length of these rays in it.
fn covered(view: &View) -> (f64, f64) {
    let [width, height] = view.pinhole().image;
    let most = DVec3::from_array(DIMS.map(|n| (n - 1) as f64));
    let (mut all, mut met, mut sum) = (0, 0, 0.0);
    for y in (EVERY / 2..height).step_by(EVERY as usize) {
        for x in (EVERY / 2..width).step_by(EVERY as usize) {
            let ray = view.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
            let at = |i: usize| ray.at(100.0 + 600.0 * i as f64 / DEPTHS as f64).map_or(DVec3::NAN, |p| p.point);
            let points: Vec<DVec3> = (0..=DEPTHS).map(at).collect();
            let within = |p: DVec3| p.cmpge(DVec3::ZERO).all() && p.cmple(most).all();
            let inside = points.windows(2).filter(|w| within(0.5 * (w[0] + w[1])));
            let length: f64 = inside.map(|w| w[0].distance(w[1])).sum();
            all += 1;
            met += u32::from(length > 0.0);
            sum += length;
        }
    }
    (f64::from(met) / f64::from(all), sum / f64::from(met.max(1)))
}

/// Draws every frame straight and bent, in turn, after one that warms up.
///
/// # Errors
/// No frames; a renderer that fails.
pub fn measure(scene: &Scene, request: &VolumeRequest) -> Result<(Vec<VolumeCost>, Frame)> {
    ensure!((1..=1000).contains(&request.frames), "{} frames: give 1..=1000", request.frames);
    let (renderer, light, progress) = (CpuRenderer::default(), Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let mut frame = Frame::default();
    let mut found: [[Vec<f64>; 5]; 2] = Default::default();
    let mut samples = [0; 2];
    for round in 0..=request.frames {
        let views = views(request.image, round as f64 / request.frames as f64)?;
        for k in 0..2 {
            let k = (k + round) % 2;
            let watch = Stopwatch::start();
            let job = RenderJob { scene, view: &views[k], light: &light, options: &options, progress: &progress };
            renderer.render_into(&job, &mut frame)?;
            let wall = watch.wall_ms();
            let cpu = watch.cpu_ms().unwrap_or(wall);
            samples[k] = frame.stats.samples;
            if round > 0 {
                let (share, length) = covered(&views[k]);
                let pixels = share * f64::from(request.image[0]) * f64::from(request.image[1]);
                let each = [cpu, wall, share, length, 1e6 * cpu / (pixels * length)];
                found[k].iter_mut().zip(each).for_each(|(list, v)| list.push(v));
            }
        }
    }
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let ratios = found[1][4].iter().zip(&found[0][4]).map(|(a, b)| a / b).collect();
    let ratio = [1.0, median(ratios)];
    let cost = |k: usize| VolumeCost {
        view: ["straight", "curved rays"][k],
        cpu_ms: median(found[k][0].clone()),
        wall_ms: median(found[k][1].clone()),
        samples_m: samples[k] as f64 * 1e-6,
        covered: mean(&found[k][2]),
        length: mean(&found[k][3]),
        ns_per_length: median(found[k][4].clone()),
        ratio: ratio[k],
    };
    Ok(((0..2).map(cost).collect(), frame))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_measurement_is_complete() {
        let request = VolumeRequest { frames: 1, image: [64, 36], step: 2.0, shaded: false };
        let (costs, _) = measure(&scene(block(), &request).unwrap(), &request).unwrap();
        let [straight, curved] = &costs[..] else { panic!("{costs:?}") };
        assert!(straight.cpu_ms > 0.0 && curved.samples_m > 0.0 && straight.ratio == 1.0);
        assert!((0.1..0.5).contains(&straight.covered) && (100.0..300.0).contains(&curved.length), "{costs:?}");
    }
}
