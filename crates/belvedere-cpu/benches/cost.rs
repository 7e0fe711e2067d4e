//! What bending and anti-aliasing cost: processor time per frame, the cases taken in turn, so that a busy machine
//! disturbs all of them alike. Linux only, where the kernel counts each thread's time in nanoseconds.
//!
//! `cargo bench -p belvedere-cpu --bench cost -- [ROUNDS]`
#![allow(missing_docs, clippy::print_stdout)]

mod support;

use belvedere_core::View;
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{Light, Progress, RenderJob, RenderOptions, Renderer};
use std::time::Instant;

/// Processor time of all threads so far, milliseconds; 0 where the kernel does not tell.
fn cpu_ms() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return 0.0 };
    let of_task = |t: std::fs::DirEntry| {
        let text = std::fs::read_to_string(t.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    tasks.flatten().filter_map(of_task).sum::<f64>() * 1e-6
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let rounds = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(9usize).max(1);
    let scene = support::ground();
    let (light, progress) = (Light::default(), Progress::silent());
    let views = support::views();
    let cases: Vec<(&str, &View, u32)> =
        [1, 4].into_iter().flat_map(|samples| views.iter().map(move |(name, view)| (*name, view, samples))).collect();
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); cases.len()];
    // The first round warms up.
    for round in 0..=rounds {
        for k in 0..cases.len() {
            // Forth and back.
            let k = if round % 2 == 0 { k } else { cases.len() - 1 - k };
            let (_, view, samples) = cases[k];
            let options = RenderOptions { samples, ..RenderOptions::default() };
            let job = RenderJob { scene: &scene, view, light: &light, options: &options, progress: &progress };
            let (wall, cpu) = (Instant::now(), cpu_ms());
            let frame = CpuRenderer.render(&job).expect("drawn");
            let spent = [cpu_ms() - cpu, wall.elapsed().as_secs_f64() * 1e3];
            assert!(frame.id.contains(&1), "nothing drawn");
            if round > 0 {
                times[k].iter_mut().zip(spent).for_each(|(t, s)| t.push(s));
            }
        }
    }
    let first = times[0][0].clone();
    println!("{:<24} {:>8} {:>8} {:>8}", "frame", "cpu ms", "wall ms", "ratio");
    for ((name, _, samples), t) in cases.iter().zip(&mut times) {
        // Of frames drawn in one round, not of medians.
        let mut ratios: Vec<f64> = t[0].iter().zip(&first).map(|(a, b)| a / b).collect();
        let (cpu, wall) = (median(&mut t[0]), median(&mut t[1]));
        println!("{:<24} {cpu:>8.1} {wall:>8.1} {:>8.2}", format!("{name}, {samples}x"), median(&mut ratios));
    }
}
