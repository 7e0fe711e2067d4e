//! Flying over generated grounds of 4k x 4k and 16k x 16k nodes: processor time per frame and memory.
//! Each ground is measured in a process of its own, so that its memory is its own.
//!
//! `cargo bench -p belvedere-cpu --bench large -- [NODES..]`, 4097 and 16385 if left out.
#![allow(missing_docs, clippy::print_stdout)]

mod support;

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{Frame, Heightfield, Light, Progress, RenderJob, RenderOptions, Renderer};
use rayon::prelude::*;
use support::{cpu_ms, median, scene};

const SPACING_M: f64 = 10.0;
const FRAMES: usize = 24;
const ALONE: &str = "--alone";

/// Ridges of all sizes from 40 km down to 60 m, heights of about -900..900 m.
fn height(x: f64, y: f64) -> f32 {
    let ridge = |k: i32| {
        let (scale, turn) = (2e-4 * 1.9f64.powi(k), DVec2::from_angle(1.3 * f64::from(k)));
        let at = turn.rotate(DVec2::new(x, y)) * scale;
        500.0 * 0.52f64.powi(k) * (at.x + (1.7 * at.y).sin()).sin() * (0.8 * at.y).cos()
    };
    (0..10).map(ridge).sum::<f64>() as f32
}

/// Figures of `/proc/self/status`, MiB.
fn status_mib(key: &str) -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|l| l.strip_prefix(key)?.strip_prefix(':'));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<f64>().ok()).unwrap_or(0.0) / 1024.0
}

fn fly(nodes: usize) {
    let half = 0.5 * (nodes - 1) as f64 * SPACING_M;
    let mut heights = vec![0.0f32; nodes * nodes];
    heights.par_chunks_mut(nodes).enumerate().for_each(|(r, row)| {
        let y = half - r as f64 * SPACING_M;
        row.iter_mut().enumerate().for_each(|(c, h)| *h = height(c as f64 * SPACING_M - half, y));
    });
    let corner = DVec2::new(-half, half);
    let scene = scene(Heightfield::measured(corner, DVec2::splat(SPACING_M), nodes, nodes, heights));
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let mut frame = Frame::default();
    let (mut times, mut drawn) = (Vec::new(), 0);
    for i in 0..=FRAMES {
        // The same flight over both grounds: a circle around the middle, looking along it.
        let way = DVec2::from_angle(std::f64::consts::TAU * i as f64 / FRAMES as f64);
        let eye = (way * 9_000.0).extend(2_600.0);
        let target = eye + (way.perp() * 20_000.0).extend(-4_500.0);
        let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
        let camera = Pinhole::look_at(eye, target, DVec3::Z, lens, [1280, 720], 1.0, None).expect("well formed");
        let view = View::straight(camera);
        let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
        let before = cpu_ms();
        CpuRenderer.render_into(&job, &mut frame).expect("drawn");
        // The first frame derives what is kept.
        if i > 0 {
            times.push(cpu_ms() - before);
            drawn += frame.stats.triangles_drawn;
        }
    }
    println!(
        "{nodes} x {nodes}: {:.1} ms cpu per frame (worst {:.1}), {} triangles drawn, resident {:.0} MiB, most {:.0} MiB",
        median(&times),
        times.iter().fold(0.0f64, |a, &b| a.max(b)),
        drawn / FRAMES as u64,
        status_mib("VmRSS"),
        status_mib("VmHWM")
    );
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let sizes: Vec<usize> = args.iter().filter_map(|a| a.parse().ok()).collect();
    if args.iter().any(|a| a == ALONE) {
        sizes.into_iter().for_each(fly);
        return;
    }
    let sizes = if sizes.is_empty() { vec![4097, 16_385] } else { sizes };
    for nodes in sizes {
        let me = std::env::current_exe().expect("a path");
        let status = std::process::Command::new(me).args([ALONE, &nodes.to_string()]).status();
        assert!(status.is_ok_and(|s| s.success()), "{nodes} x {nodes} failed");
    }
}
