//! Subdivision while drawing against the method of Cui et al. 2010, which splits all triangles beforehand: same scene, view and tolerance.
//! Processor time; one line of JSON per scene.
//!
//! `cargo bench -p belvedere-bench --bench subdivision -- [NAME..] [--frames 7]`
#![allow(missing_docs, clippy::print_stdout)]

use anyhow::{Context, Result};
use belvedere::core::DVec3;
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{Light, Mesh, MeshColors, Progress, RenderJob, RenderOptions, Renderer, Scene};
use belvedere_bench::clock::{Stopwatch, median};
use belvedere_bench::sizes::{counts, sized, sized_views};

const IMAGE: [u32; 2] = [1280, 720];
const TOLERANCE_PX: f64 = 0.5;
/// Tolerance at which meshes that are split already are not split again, pixels.
const AS_IT_IS_PX: f64 = 1e9;

fn main() -> Result<()> {
    let (mut names, mut frames) = (Vec::new(), 7);
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--frames" => frames = args.next().context("--frames needs a number")?.parse()?,
            "--bench" => {}
            _ => names.push(arg),
        }
    }
    if names.is_empty() {
        names = ["large_blocks", "blocks"].map(str::to_owned).into();
    }
    names.iter().try_for_each(|name| measure(name, frames))
}

fn measure(name: &str, frames: usize) -> Result<()> {
    let scene = sized(name)?;
    let [.., (_, view)] = sized_views(IMAGE)?;
    let clock = Stopwatch::start();
    let (for_view, shortest) = split(&scene, &|a, b| (TOLERANCE_PX..AS_IT_IS_PX).contains(&view.edge_error(a, b).px))?;
    let split_ms = clock.cpu_ms().unwrap_or_else(|| clock.wall_ms());
    // For any view: splits all edges longer than 1.5 times the shortest half that this view needs.
    let (for_any, _) = split(&scene, &|a, b| a.distance(b) > 1.5 * shortest)?;
    let cases = [(&scene, TOLERANCE_PX), (&for_view, AS_IT_IS_PX), (&for_any, AS_IT_IS_PX)];
    let (light, progress) = (Light::default(), Progress::silent());
    let renderers = cases.map(|_| CpuRenderer::default());
    let mut times = cases.map(|_| Vec::new());
    let mut drawn = [0; 3];
    for round in 0..=frames {
        for (k, (scene, tolerance_px)) in cases.into_iter().enumerate() {
            let options = RenderOptions { samples: 1, lod_px: 0.0, tolerance_px, ..RenderOptions::default() };
            let job = RenderJob { scene, view: &view, light: &light, options: &options, progress: &progress };
            let clock = Stopwatch::start();
            let frame = renderers[k].render(&job)?;
            let ms = clock.cpu_ms().unwrap_or_else(|| clock.wall_ms());
            drawn[k] = frame.stats.triangles_drawn;
            if round > 0 {
                times[k].push(ms);
            }
        }
    }
    let [triangles, for_view_triangles, for_any_triangles] = cases.map(|(scene, _)| counts(scene)[1]);
    let [adaptive, beforehand, for_any] = times.map(median);
    println!(
        "{}",
        serde_json::json!({
            "scene": name, "triangles": triangles, "drawn": drawn, "adaptive_ms": adaptive,
            "split_for_the_view": { "triangles": for_view_triangles, "ms": beforehand, "splitting_ms": split_ms },
            "split_for_any_view": { "triangles": for_any_triangles, "ms": for_any, "edge_m": 1.5 * shortest },
        })
    );
    Ok(())
}

/// The scene with the edges of its meshes halved while they are too long, and the length of the shortest half, scene units.
fn split(scene: &Scene, is_long: &dyn Fn(DVec3, DVec3) -> bool) -> Result<(Scene, f64)> {
    let mut out = scene.clone();
    let mut shortest = f64::INFINITY;
    for layer in &mut out.layers {
        let Some(layer) = layer.kind.mesh_mut() else { continue };
        let mut pending: Vec<[DVec3; 3]> =
            layer.mesh.triangles().iter().map(|t| t.map(|v| layer.mesh.vertex(v))).collect();
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        while let Some([a, b, c]) = pending.pop() {
            let edges = [[a, b, c], [b, c, a], [c, a, b]];
            let longest = edges.into_iter().filter(|[p, q, _]| is_long(*p, *q));
            let longest = longest.max_by(|e, f| e[0].distance(e[1]).total_cmp(&f[0].distance(f[1])));
            if let Some([p, q, r]) = longest {
                let middle = 0.5 * (p + q);
                shortest = shortest.min(p.distance(middle));
                pending.extend([[p, middle, r], [middle, q, r]]);
            } else {
                let first = positions.len() as u32;
                positions.extend([a, b, c]);
                triangles.push([first, first + 1, first + 2]);
            }
        }
        layer.mesh = Mesh::new(&positions, triangles, MeshColors::Layer)?;
    }
    Ok((out, shortest))
}
