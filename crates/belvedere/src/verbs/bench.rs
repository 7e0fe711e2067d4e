//! `bench`: what bends, anti-aliasing and level of detail cost on this machine.
//!
//! Cases are drawn in turn, forth and back, so that a busy machine disturbs all of them alike; ratios are medians of ratios of
//! frames of one round. Processor time of all threads counts where the system tells it (Linux), wall time elsewhere.

use super::bench_flight::{FlightCost, fly};
use super::bench_smooth::{SmoothCost, smooth};
use crate::BelvedereError;
use belvedere_core::map::curved_rays::{Model, Pencil, Sharpness, TurnSpec};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{CurvedRays, DVec2, DVec3, Pinhole, Projection, SplineBend, Stage, View};
use belvedere_cpu::{CpuRenderer, GroundImage};
use belvedere_scene::{
    Frame, Heightfield, Layer, LayerKind, Light, Palette, Progress, Relief, RenderJob, RenderOptions, Renderer, Scene,
    TerrainLayer,
};
use serde::Serialize;
use std::time::Instant;

/// Pictures of a flight per round.
const FLIGHT: usize = 8;

/// What to measure.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchRequest {
    /// Times that every case is drawn, one more to warm up.
    pub rounds: usize,
    /// Nodes along a side of the ground.
    pub nodes: usize,
    /// Size of the picture.
    pub image: [u32; 2],
    /// Worker threads; 0 = all cores.
    pub threads: usize,
}

impl Default for BenchRequest {
    fn default() -> Self {
        Self { rounds: 7, nodes: 1025, image: [1280, 720], threads: 0 }
    }
}

/// A frame.
#[derive(Debug, Clone, Serialize)]
pub struct FrameCost {
    /// Bend: `straight`, `curved rays`, `spline`.
    pub view: &'static str,
    /// Coverage samples per pixel.
    pub samples: u32,
    /// Worst error of less detail, pixels; 0 draws every triangle.
    pub lod_px: f64,
    /// Triangles drawn.
    pub triangles: u64,
    /// Median processor time, milliseconds.
    pub cpu_ms: f64,
    /// Median wall time, milliseconds.
    pub wall_ms: f64,
    /// To the straight frame of one sample and every triangle, drawn in the same round.
    pub ratio: f64,
}

/// Projection alone.
#[derive(Debug, Clone, Serialize)]
pub struct ProjectionCost {
    /// Bend.
    pub view: &'static str,
    /// Points projected.
    pub points: usize,
    /// Median of millions of points per second of processor time: what one undisturbed core does.
    pub mpts_per_core_s: f64,
}

/// How processor time grows, `time ~ size^exponent`, least squares in logarithms.
#[derive(Debug, Clone, Serialize)]
pub struct Growth {
    /// What grows.
    pub of: &'static str,
    /// Sizes.
    pub sizes: Vec<f64>,
    /// Median processor times, milliseconds.
    pub cpu_ms: Vec<f64>,
    /// The exponent.
    pub exponent: f64,
}

/// The measurements.
#[derive(Debug, Clone, Serialize)]
pub struct BenchReport {
    /// Program and version.
    pub program: String,
    /// Processor, as the system names it.
    pub processor: String,
    /// Worker threads used.
    pub threads: usize,
    /// What is measured as `cpu_ms`.
    pub clock: &'static str,
    /// Processes that wanted to run over the last minute, before and after; `None` where the system does not tell.
    pub load: [Option<f64>; 2],
    /// Nodes along a side of the ground.
    pub nodes: usize,
    /// Size of the picture.
    pub image: [u32; 2],
    /// Rounds.
    pub rounds: usize,
    /// Frames.
    pub frames: Vec<FrameCost>,
    /// Projection alone.
    pub projection: Vec<ProjectionCost>,
    /// A flight over terrain that makes way.
    pub flight: Vec<FlightCost>,
    /// The smooth pass of terrain that makes way, our way and the paper's.
    pub smooth: Vec<SmoothCost>,
    /// Growth.
    pub growth: Vec<Growth>,
}

/// Measures.
///
/// # Errors
/// [`BelvedereError::Render`], [`BelvedereError::Cancelled`]; [`BelvedereError::Usage`] if the request is out of range.
pub fn bench(request: &BenchRequest, progress: &Progress) -> Result<BenchReport, BelvedereError> {
    let BenchRequest { rounds, nodes, threads, .. } = *request;
    if !(33..=8193).contains(&nodes) || !(1..=1000).contains(&rounds) {
        return Err(BelvedereError::Usage(format!(
            "a ground of {nodes} x {nodes} nodes and {rounds} rounds: give 33..=8193 nodes and 1..=1000 rounds"
        )));
    }
    // One pool for all frames: the processor time of threads that have ended is lost.
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(|| report(request, progress)),
        Err(_) => report(request, progress),
    }
}

fn report(request: &BenchRequest, progress: &Progress) -> Result<BenchReport, BelvedereError> {
    let BenchRequest { rounds, nodes, image, threads } = *request;
    let before = load();
    let scene = ground(nodes)?;
    let views = views(image)?;
    let mut cases = Vec::new();
    for (lod_px, samples) in [(0.0, 1), (0.0, 4), (0.5, 1), (0.5, 4)] {
        cases.extend(views.iter().map(|(name, view)| Case { name, scene: &scene, view, samples, lod_px }));
    }
    let frames = measure(&cases, rounds, progress)?;
    let growth = vec![
        grow_triangles(request, &views[1].1, 0.0, progress)?,
        grow_triangles(request, &views[1].1, 0.5, progress)?,
        grow_pixels(request, &scene, progress)?,
    ];
    Ok(BenchReport {
        program: format!("belvedere {}", crate::VERSION),
        processor: processor(),
        threads: if threads == 0 { super::info::machine().threads } else { threads },
        clock: if cpu_ms().is_some() { "processor time of all threads" } else { "wall time" },
        load: [before, load()],
        nodes,
        image,
        rounds,
        frames,
        projection: project(&views, rounds)?,
        flight: fly(nodes, image, FLIGHT * rounds)?,
        smooth: smooth(nodes, rounds)?,
        growth,
    })
}

struct Case<'a> {
    name: &'static str,
    scene: &'a Scene,
    view: &'a View,
    samples: u32,
    lod_px: f64,
}

fn measure(cases: &[Case<'_>], rounds: usize, progress: &Progress) -> Result<Vec<FrameCost>, BelvedereError> {
    let light = Light::default();
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); cases.len()];
    let mut triangles = vec![0; cases.len()];
    let mut frame = Frame::default();
    for round in 0..=rounds {
        for k in 0..cases.len() {
            let k = if round % 2 == 0 { k } else { cases.len() - 1 - k };
            let Case { scene, view, samples, lod_px, .. } = cases[k];
            let options = RenderOptions { samples, lod_px, ..RenderOptions::default() };
            let (wall, cpu) = (Instant::now(), cpu_ms());
            let job = RenderJob { scene, view, light: &light, options: &options, progress };
            CpuRenderer.render_into(&job, &mut frame)?;
            let wall = wall.elapsed().as_secs_f64() * 1e3;
            let cpu = cpu.zip(cpu_ms()).map_or(wall, |(a, b)| (b - a).max(LEAST_MS));
            triangles[k] = frame.stats.triangles_drawn;
            if round > 0 {
                times[k].iter_mut().zip([cpu, wall]).for_each(|(t, v)| t.push(v));
            }
        }
    }
    let cost = |(k, case): (usize, &Case<'_>)| FrameCost {
        view: case.name,
        samples: case.samples,
        lod_px: case.lod_px,
        triangles: triangles[k],
        cpu_ms: median(times[k][0].clone()),
        wall_ms: median(times[k][1].clone()),
        ratio: median(times[k][0].iter().zip(&times[0][0]).map(|(a, b)| a / b).collect()),
    };
    Ok(cases.iter().enumerate().map(cost).collect())
}

fn grow_triangles(
    request: &BenchRequest,
    view: &View,
    lod_px: f64,
    progress: &Progress,
) -> Result<Growth, BelvedereError> {
    let cells = request.nodes - 1;
    let sizes: Vec<usize> = [cells / 4, cells / 2, cells, 2 * cells].map(|n| n + 1).into_iter().collect();
    let scenes = sizes.iter().map(|&n| ground(n)).collect::<Result<Vec<_>, _>>()?;
    let case = |scene| Case { name: "curved rays", scene, view, samples: 1, lod_px };
    let costs = measure(&scenes.iter().map(case).collect::<Vec<_>>(), request.rounds.min(5), progress)?;
    let of = if lod_px > 0.0 { "triangles of the ground, level of detail" } else { "triangles of the ground" };
    Ok(Growth::new(of, sizes.iter().map(|n| (2 * (n - 1) * (n - 1)) as f64).collect(), &costs))
}

fn grow_pixels(request: &BenchRequest, scene: &Scene, progress: &Progress) -> Result<Growth, BelvedereError> {
    let [w, h] = request.image;
    let sizes = [[w / 2, h / 2], [w, h], [2 * w, 2 * h], [4 * w, 4 * h]];
    let views = sizes.into_iter().map(views).collect::<Result<Vec<_>, _>>()?;
    let case = |v: &'_ [(&'static str, View); 3]| (v[1].0, v[1].1.clone());
    let views: Vec<(&'static str, View)> = views.iter().map(case).collect();
    let case = |(name, view)| Case { name, scene, view, samples: 1, lod_px: 0.5 };
    let cases: Vec<Case<'_>> = views.iter().map(|(name, view)| case((*name, view))).collect();
    let costs = measure(&cases, request.rounds.min(5), progress)?;
    Ok(Growth::new("pixels", sizes.map(|[w, h]| f64::from(w) * f64::from(h)).to_vec(), &costs))
}

impl Growth {
    fn new(of: &'static str, sizes: Vec<f64>, costs: &[FrameCost]) -> Self {
        let cpu_ms: Vec<f64> = costs.iter().map(|c| c.cpu_ms).collect();
        let n = sizes.len() as f64;
        let (x, y): (Vec<f64>, Vec<f64>) = sizes.iter().zip(&cpu_ms).map(|(s, t)| (s.ln(), t.ln())).unzip();
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let (mut both, mut square) = (0.0, 0.0);
        for (x, y) in x.iter().zip(&y) {
            both += (x - mx) * (y - my);
            square += (x - mx) * (x - mx);
        }
        Self { of, sizes, cpu_ms, exponent: both / square }
    }
}

/// About 4.3 million points through the views that have a fast form.
fn project(views: &[(&'static str, View); 3], rounds: usize) -> Result<Vec<ProjectionCost>, BelvedereError> {
    let scene = ground(2073)?;
    let Some(hf) = scene.terrain() else { return Ok(Vec::new()) };
    let (points, mut image) = (hf.heights().len(), GroundImage::default());
    let mut rates: [Vec<f64>; 2] = Default::default();
    for round in 0..=rounds {
        for (rates, (_, view)) in rates.iter_mut().zip(views) {
            let (wall, cpu) = (Instant::now(), cpu_ms());
            let whole = image.project(hf, view, 0);
            let threads = super::info::machine().threads as f64;
            let cpu =
                cpu.zip(cpu_ms()).map_or(wall.elapsed().as_secs_f64() * 1e3 * threads, |(a, b)| (b - a).max(LEAST_MS));
            if round > 0 && whole {
                rates.push(points as f64 / cpu * 1e-3);
            }
        }
    }
    let of = |(rates, (view, _)): (Vec<f64>, &(&'static str, View))| ProjectionCost {
        view,
        points,
        mpts_per_core_s: median(rates),
    };
    Ok(rates.into_iter().zip(views).map(of).collect())
}

/// Ridges on 10 km of ground, `nodes` x `nodes` nodes.
pub(super) fn ground(nodes: usize) -> Result<Scene, BelvedereError> {
    let extent = 10_240.0;
    let (half, spacing, step) = (0.5 * extent, extent / (nodes - 1) as f64, 10.24 / (nodes - 1) as f64);
    let height = |i: usize| {
        let (x, y) = ((i % nodes) as f64 * step, (i / nodes) as f64 * step);
        let ridge = |k: i32| (f64::from(k) * (x + 0.7 * y)).sin() * (f64::from(k) * 1.3 * y).cos() / f64::from(k);
        (180.0 * (1..6).map(ridge).sum::<f64>()) as f32
    };
    let heights = (0..nodes * nodes).map(height).collect();
    let heightfield = Heightfield::measured(DVec2::new(-half, half), DVec2::splat(spacing), nodes, nodes, heights);
    let terrain = TerrainLayer {
        heightfield: heightfield.map_err(broken)?,
        drapes: Vec::new(),
        relief: Relief::Swiss,
        shading: None,
        exaggeration: 1.0,
        palette: Palette::Alpine,
    };
    let layer = Layer { id: "ground".into(), must_see: false, kind: LayerKind::Terrain(terrain) };
    Ok(Scene { layers: vec![layer], ..Scene::default() })
}

/// The straight view and the bent ones, all of the ground in the picture.
fn views(image: [u32; 2]) -> Result<[(&'static str, View); 3], BelvedereError> {
    let eye = DVec3::new(0.0, -11_500.0, 6_000.0);
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    let target = DVec3::new(0.0, 0.0, -900.0);
    let camera = Pinhole::look_at(eye, target, DVec3::Z, lens, image, 1.0, None).map_err(broken)?;
    let turn = TurnSpec {
        viewpoint: eye + DVec3::Z * 2000.0,
        t0: DVec3::new(0.0, -1500.0, 0.0),
        t1: DVec3::ZERO,
        t2: DVec3::new(0.0, 1500.0, 0.0),
        pencil: Pencil::Parallel { normal: -DVec3::Y },
        m: Sharpness::Bend,
    };
    let rays = CurvedRays::new(&camera, Model::Modified, &[turn]).map_err(broken)?;
    let plane = ReferencePlane::level(0.0);
    let document = PresetDocument::builtin("progressive").map_err(broken)?;
    let bend = SplineBend::new(&camera, &document, &plane, default_pivot(&camera, &plane)).map_err(broken)?;
    let bent = |stage| View::new(camera.clone(), vec![stage]).map_err(broken);
    Ok([
        ("straight", View::straight(camera.clone())),
        ("curved rays", bent(Stage::CurvedRays(rays))?),
        ("spline", bent(Stage::SplineBend(bend))?),
    ])
}

pub(super) fn broken(e: impl std::fmt::Display) -> BelvedereError {
    BelvedereError::Usage(format!("the scene of the measurement cannot be made with this size: {e}"))
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Running threads are counted at the system's ticks: shorter times may come out as none at all.
const LEAST_MS: f64 = 1e-3;

/// Processor time of all threads so far, milliseconds; the kernel of Linux counts it in nanoseconds.
fn cpu_ms() -> Option<f64> {
    let of_task = |t: std::fs::DirEntry| {
        let text = std::fs::read_to_string(t.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    Some(std::fs::read_dir("/proc/self/task").ok()?.flatten().filter_map(of_task).sum::<f64>() * 1e-6)
}

fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim()));
    name.unwrap_or(std::env::consts::ARCH).to_owned()
}

impl std::fmt::Display for BenchReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [w, h] = self.image;
        let load = self.load.map(|l| l.map_or_else(|| "unknown".into(), |l| format!("{l:.1}")));
        writeln!(f, "{}, {}, {} threads, load {} to {}", self.program, self.processor, self.threads, load[0], load[1])?;
        let n = self.nodes;
        writeln!(f, "ground of {n} x {n} nodes, {w} x {h} pixels, {} rounds, cpu = {}\n", self.rounds, self.clock)?;
        writeln!(
            f,
            "{:<12} {:>7} {:>6} {:>10} {:>8} {:>8} {:>6}",
            "view", "samples", "lod", "triangles", "cpu ms", "wall ms", "ratio"
        )?;
        for c in &self.frames {
            let FrameCost { view, samples, lod_px, triangles, cpu_ms, wall_ms, ratio } = c;
            writeln!(
                f,
                "{view:<12} {samples:>7} {lod_px:>6.1} {triangles:>10} {cpu_ms:>8.1} {wall_ms:>8.1} {ratio:>6.2}"
            )?;
        }
        writeln!(f)?;
        for p in &self.projection {
            writeln!(
                f,
                "projection, {}: {:.0} million points per second and core ({} points)",
                p.view, p.mpts_per_core_s, p.points
            )?;
        }
        for cost in &self.flight {
            let FlightCost { way, pictures, points, ground_ms: [g50, g95], picture_ms: [p50, p95], lag, hidden } = cost;
            writeln!(
                f,
                "flight, {points:.0} points, {way}: ground after {g50:.1} ms (95 % {g95:.1}), picture after {p50:.1} ms \
                 (95 % {p95:.1}), {lag} pictures late at most, {:.1} % hidden at most ({pictures} pictures)",
                100.0 * hidden
            )?;
        }
        self.smooth.iter().try_for_each(|cost| writeln!(f, "{cost}"))?;
        for g in &self.growth {
            let at: Vec<String> = g.sizes.iter().zip(&g.cpu_ms).map(|(s, t)| format!("{s:.2e}: {t:.1}")).collect();
            writeln!(f, "growth with {}: exponent {:.2} (cpu ms at {})", g.of, g.exponent, at.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_measurement_is_complete() {
        let request = BenchRequest { rounds: 1, nodes: 65, image: [64, 36], threads: 1 };
        let report = bench(&request, &Progress::silent()).unwrap();
        assert_eq!((report.frames.len(), report.projection.len(), report.growth.len()), (12, 2, 3));
        assert!(report.flight.iter().all(|f| f.pictures == FLIGHT && f.points > 1.0 && f.ground_ms[0] > 0.0));
        assert!((report.flight.len(), report.flight[0].lag) == (2, 0) && report.flight[0].hidden < 0.05);
        assert!(report.frames.iter().all(|c| c.cpu_ms > 0.0 && c.triangles > 0));
        assert!(report.frames[0].ratio == 1.0 && report.projection.iter().all(|p| p.mpts_per_core_s > 0.0));
        assert!(report.to_string().contains("growth with pixels: exponent"));
        let absurd = BenchRequest { nodes: 2, ..request };
        assert!(matches!(bench(&absurd, &Progress::silent()), Err(BelvedereError::Usage(_))));
    }

    #[test]
    fn the_exponent_of_a_power_law_is_found() {
        let cost = |n: f64| FrameCost {
            view: "",
            samples: 1,
            lod_px: 0.0,
            triangles: 0,
            cpu_ms: 3.0 * n.powf(0.7),
            wall_ms: 0.0,
            ratio: 1.0,
        };
        let sizes = vec![10.0, 40.0, 160.0];
        let growth = Growth::new("n", sizes.clone(), &sizes.iter().map(|&n| cost(n)).collect::<Vec<_>>());
        assert!((growth.exponent - 0.7).abs() < 1e-12);
    }
}
