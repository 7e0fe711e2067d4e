//! What bending, anti-aliasing and level of detail cost: processor time per frame, the cases taken in turn, so that a busy
//! machine disturbs all of them alike; and how the time grows with triangles and pixels.
//! Linux only, where the kernel counts each thread's time in nanoseconds.
//!
//! `cargo bench -p belvedere-cpu --bench cost -- [ROUNDS]`
#![allow(missing_docs, clippy::print_stdout)]

mod support;

use belvedere_core::View;
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{Frame, Light, Progress, RenderJob, RenderOptions, Renderer, Scene};
use std::time::Instant;
use support::{NODES, cpu_ms, ground, median, views};

struct Case<'a> {
    name: String,
    scene: &'a Scene,
    view: &'a View,
    samples: u32,
    lod_px: f64,
}

/// Processor and wall times of every case, round by round; the first round warms up.
fn measure(cases: &[Case<'_>], rounds: usize) -> Vec<[Vec<f64>; 2]> {
    let (renderer, light, progress) = (CpuRenderer::default(), Light::default(), Progress::silent());
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); cases.len()];
    let mut frame = Frame::default();
    for round in 0..=rounds {
        for k in 0..cases.len() {
            // Forth and back.
            let k = if round % 2 == 0 { k } else { cases.len() - 1 - k };
            let Case { scene, view, samples, lod_px, .. } = cases[k];
            let options = RenderOptions { samples, lod_px, ..RenderOptions::default() };
            let job = RenderJob { scene, view, light: &light, options: &options, progress: &progress };
            let (wall, cpu) = (Instant::now(), cpu_ms());
            renderer.render_into(&job, &mut frame).expect("drawn");
            let spent = [cpu_ms() - cpu, wall.elapsed().as_secs_f64() * 1e3];
            assert!(frame.id.contains(&1), "nothing drawn");
            if round > 0 {
                times[k].iter_mut().zip(spent).for_each(|(t, s)| t.push(s));
            }
        }
    }
    times
}

fn main() {
    let rounds = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(9usize).max(1);
    let scene = ground(NODES);
    let views = views([1280, 720]);
    let cases: Vec<Case<'_>> = [0.0, 0.5]
        .into_iter()
        .flat_map(|lod_px| [1, 4].map(|samples| (lod_px, samples)))
        .flat_map(|(lod_px, samples)| views.iter().map(move |(name, view)| (lod_px, samples, name, view)))
        .map(|(lod_px, samples, name, view)| {
            let detail = if lod_px > 0.0 { ", lod" } else { "" };
            Case { name: format!("{name}, {samples}x{detail}"), scene: &scene, view, samples, lod_px }
        })
        .collect();
    let times = measure(&cases, rounds);
    println!("{:<24} {:>8} {:>8} {:>8}", "frame", "cpu ms", "wall ms", "ratio");
    for (case, t) in cases.iter().zip(&times) {
        // Of frames drawn in one round, not of medians.
        let ratios: Vec<f64> = t[0].iter().zip(&times[0][0]).map(|(a, b)| a / b).collect();
        println!("{:<24} {:>8.1} {:>8.1} {:>8.2}", case.name, median(&t[0]), median(&t[1]), median(&ratios));
    }
    grow_triangles(rounds.min(5));
    grow_pixels(&scene, rounds.min(5));
}

fn grow_triangles(rounds: usize) {
    let sizes = [257usize, 513, 1025, 2049];
    let scenes: Vec<Scene> = sizes.iter().map(|&n| ground(n)).collect();
    let view = &views([1280, 720])[1].1;
    for lod_px in [0.0, 0.5] {
        let cases: Vec<Case<'_>> =
            scenes.iter().map(|scene| Case { name: String::new(), scene, view, samples: 1, lod_px }).collect();
        let times: Vec<f64> = measure(&cases, rounds).iter().map(|t| median(&t[0])).collect();
        let triangles = sizes.map(|n| (2 * (n - 1) * (n - 1)) as f64);
        report(if lod_px > 0.0 { "triangles, lod" } else { "triangles" }, &triangles, &times);
    }
}

fn grow_pixels(scene: &Scene, rounds: usize) {
    let sizes = [[640u32, 360], [1280, 720], [2560, 1440], [5120, 2880]];
    let views = sizes.map(|image| views(image).swap_remove(1).1);
    let cases: Vec<Case<'_>> =
        views.iter().map(|view| Case { name: String::new(), scene, view, samples: 1, lod_px: 0.5 }).collect();
    let times: Vec<f64> = measure(&cases, rounds).iter().map(|t| median(&t[0])).collect();
    report("pixels, lod", &sizes.map(|[w, h]| f64::from(w) * f64::from(h)), &times);
}

/// Prints the exponent of a power law through the points, least squares in logarithms.
fn report(what: &str, sizes: &[f64], times: &[f64]) {
    let n = sizes.len() as f64;
    let (x, y): (Vec<f64>, Vec<f64>) = sizes.iter().zip(times).map(|(s, t)| (s.ln(), t.ln())).unzip();
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>()
        / x.iter().map(|x| (x - mx) * (x - mx)).sum::<f64>();
    let each: Vec<String> = sizes.iter().zip(times).map(|(s, t)| format!("{s:.2e}: {t:.1} ms")).collect();
    println!("{what}: exponent {slope:.2} ({})", each.join(", "));
}
