//! Flying over generated grounds of 4k x 4k and 16k x 16k nodes: processor time per frame and memory.
//! Two flights: a steady one, whose frames show a little more ground than the one before, and jumps, each of which shows
//! ground that was not in the picture before. Each ground is drawn by a process of its own, so that its memory can be measured
//! alone; the processes draw in turn, so that a busy machine disturbs all of them alike.
//!
//! `cargo bench -p belvedere-bench --bench large -- [NODES..]`, 4097 and 16385 if left out.
#![allow(missing_docs, clippy::print_stdout)]

use belvedere::core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere::cpu::CpuRenderer;
use belvedere::scene::{Frame, Heightfield, Light, Progress, RenderJob, RenderOptions, Renderer, Scene};
use belvedere_bench::clock::{Stopwatch, median, quantile, status_mib};
use belvedere_bench::scene::scene_of;
use rayon::prelude::*;
use std::io::{BufRead, BufReader, Lines, Write};
use std::process::{Child, ChildStdout, Command, Stdio};

const SPACING_M: f64 = 10.0;
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

/// A flight along the circle.
#[derive(Clone, Copy)]
struct Flight {
    name: &'static str,
    frames: usize,
    /// Angle along the circle between two frames, degrees.
    step_deg: f64,
}

/// The jumps come first: they end where the steady flight begins.
const FLIGHTS: [Flight; 2] = [
    Flight { name: "jumps of 2.4 km", frames: 24, step_deg: 15.0 },
    Flight { name: "steady, 40 m a frame", frames: 240, step_deg: 0.2546 },
];

/// The same flight over every ground: a circle around the middle, looking along it.
fn view(angle_deg: f64) -> View {
    let way = DVec2::from_angle(angle_deg.to_radians());
    let eye = (way * 9_000.0).extend(2_600.0);
    let target = eye + (way.perp() * 20_000.0).extend(-4_500.0);
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    View::straight(Pinhole::look_at(eye, target, DVec3::Z, lens, [1280, 720], 1.0, None).expect("well formed"))
}

fn ground(nodes: usize) -> Scene {
    let half = 0.5 * (nodes - 1) as f64 * SPACING_M;
    let mut heights = vec![0.0f32; nodes * nodes];
    heights.par_chunks_mut(nodes).enumerate().for_each(|(r, row)| {
        let y = half - r as f64 * SPACING_M;
        row.iter_mut().enumerate().for_each(|(c, h)| *h = height(c as f64 * SPACING_M - half, y));
    });
    let ground = Heightfield::measured(DVec2::new(-half, half), DVec2::splat(SPACING_M), nodes, nodes, heights);
    scene_of(ground.expect("well formed"))
}

/// Reads angles in degrees from standard input, one a line, and draws the view at each. Prints processor time in milliseconds,
/// triangles drawn, and resident memory in MiB, current and peak.
fn answer(nodes: usize) {
    let scene = ground(nodes);
    let (renderer, light, progress) = (CpuRenderer::default(), Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let mut frame = Frame::default();
    for line in std::io::stdin().lines() {
        let view = view(line.ok().and_then(|l| l.parse().ok()).expect("an angle"));
        let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
        let watch = Stopwatch::start();
        renderer.render_into(&job, &mut frame).expect("drawn");
        let ms = watch.cpu_ms().unwrap_or_else(|| watch.wall_ms());
        println!("{ms} {} {} {}", frame.stats.triangles_drawn, status_mib("VmRSS"), status_mib("VmHWM"));
    }
}

/// A ground in a process of its own.
struct Ground {
    nodes: usize,
    process: Child,
    answers: Lines<BufReader<ChildStdout>>,
}

impl Ground {
    fn new(nodes: usize) -> Self {
        let me = std::env::current_exe().expect("a path");
        let mut command = Command::new(me);
        command.args([ALONE, &nodes.to_string()]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = command.spawn().expect("started");
        let answers = BufReader::new(process.stdout.take().expect("a pipe")).lines();
        Self { nodes, process, answers }
    }

    /// Draws the view at an angle, degrees; returns the four numbers of [`answer`].
    fn draw(&mut self, angle_deg: f64) -> [f64; 4] {
        let ask = self.process.stdin.as_mut().expect("a pipe");
        writeln!(ask, "{angle_deg}").expect("it listens");
        let line = self.answers.next().and_then(Result::ok).expect("it answers");
        let mut numbers = line.split(' ').map(|v| v.parse().expect("a number"));
        std::array::from_fn(|_| numbers.next().expect("four numbers"))
    }
}

fn report(flight: Flight, grounds: &mut [Ground]) {
    let mut figures: Vec<Vec<[f64; 4]>> = vec![Vec::new(); grounds.len()];
    for i in 1..=flight.frames {
        for (ground, figures) in grounds.iter_mut().zip(&mut figures) {
            figures.push(ground.draw(flight.step_deg * i as f64));
        }
    }
    println!("{}, {} frames:", flight.name, flight.frames);
    let column = |k: usize, f: usize| figures[k].iter().map(|v| v[f]).collect::<Vec<f64>>();
    for (k, ground) in grounds.iter().enumerate() {
        let (ms, last) = (column(k, 0), figures[k][flight.frames - 1]);
        // Ratios of frames drawn one after the other, not of medians.
        let ratios: Vec<f64> = ms.iter().zip(column(0, 0)).map(|(a, b)| a / b).collect();
        println!(
            "  {0} x {0}: {1:.1} ms cpu per frame (95 %: {2:.1}, worst {3:.1}), {4:.2} of the first ground, \
             {5:.0} triangles drawn, resident {6:.0} MiB, most {7:.0} MiB",
            ground.nodes,
            median(ms.clone()),
            quantile(ms.clone(), 0.95),
            quantile(ms, 1.0),
            median(ratios),
            median(column(k, 1)),
            last[2],
            last[3]
        );
    }
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let sizes: Vec<usize> = args.iter().filter_map(|a| a.parse().ok()).collect();
    if args.iter().any(|a| a == ALONE) {
        sizes.into_iter().for_each(answer);
        return;
    }
    let sizes = if sizes.is_empty() { vec![4097, 16_385] } else { sizes };
    let mut grounds: Vec<Ground> = sizes.into_iter().map(Ground::new).collect();
    // The first frame fills the caches.
    for ground in &mut grounds {
        let [ms, ..] = ground.draw(0.0);
        println!("{0} x {0}: first frame {ms:.0} ms", ground.nodes);
    }
    FLIGHTS.iter().for_each(|flight| report(*flight, &mut grounds));
    for Ground { mut process, .. } in grounds {
        drop(process.stdin.take());
        assert!(process.wait().is_ok_and(|s| s.success()), "a ground failed");
    }
}
