//! Terrain that makes way: cells, and the greedy pass, on 1025 x 1025 nodes.
//!
//! `cargo bench -p belvedere-construct --bench terrain` measures wall time; with `-- cpu [ROUNDS]` the processor time of all
//! threads, medians (Linux only, where the kernel counts it), which is what to believe on a busy machine.
#![allow(missing_docs, clippy::print_stdout)]

use belvedere_construct::terrain::{
    Cells, Field, Naive, PointKind, Pyramid, ReferencePoint, TerrainSettings, Wedge, in_view,
};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Heightfield, NodeState};
use criterion::Criterion;
use std::hint::black_box;

const NODES: usize = 1025;
const SPACING_M: f64 = 30.0;

/// Fractal mountains of 2 km: midpoint displacement (diamond and square), roughness 1.1.
fn fractal(seed: u64) -> Field {
    let n = NODES;
    let mut z = vec![0.0f64; n * n];
    let noise = |i: usize| {
        let mut x = (i as u64 ^ (seed << 32)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        x = (x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((x ^ (x >> 32)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let (mut step, mut height) = (n - 1, 1000.0);
    while step > 1 {
        let half = step / 2;
        for row in (half..n).step_by(step) {
            for col in (half..n).step_by(step) {
                let corners = [
                    (row - half, col - half),
                    (row - half, col + half),
                    (row + half, col - half),
                    (row + half, col + half),
                ];
                let mean = corners.iter().map(|&(r, c)| z[r * n + c]).sum::<f64>() / 4.0;
                z[row * n + col] = mean + height * noise(row * n + col);
            }
        }
        for row in (0..n).step_by(half) {
            for col in ((row + half) % step..n).step_by(step) {
                let (mut sum, mut count) = (0.0, 0.0);
                for (r, c) in [(-1isize, 0isize), (1, 0), (0, -1), (0, 1)] {
                    let at = (row.checked_add_signed(r * half as isize), col.checked_add_signed(c * half as isize));
                    if let (Some(r), Some(c)) = at
                        && r < n
                        && c < n
                    {
                        sum += z[r * n + c];
                        count += 1.0;
                    }
                }
                z[row * n + col] = sum / count + height * noise(row * n + col);
            }
        }
        step = half;
        height *= 0.5f64.powf(1.1);
    }
    let [low, high] = z.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
    let heights = z.iter().map(|v| (500.0 + 2000.0 * (v - low) / (high - low)) as f32).collect();
    let states = vec![NodeState::Measured; n * n];
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(SPACING_M), n, n, heights, states).expect("well formed");
    Field::new(&hf, |_| 0.0).expect("has data")
}

/// The lowest of ways from west to east, found row by row: a valley route.
fn valley(field: &Field) -> Vec<DVec2> {
    let (n, h) = (field.cols(), field.heights());
    let cost = |i: usize| (h[i] - field.datum()) * (h[i] - field.datum());
    let mut best: Vec<f64> = (0..n).map(|row| cost(row * n)).collect();
    let mut from = vec![0usize; n * n];
    for col in 1..n {
        let before = best.clone();
        for row in 0..n {
            let near = row.saturating_sub(1)..(row + 2).min(n);
            let least = near.min_by(|&a, &b| before[a].total_cmp(&before[b])).unwrap_or(row);
            from[row * n + col] = least;
            best[row] = before[least] + cost(row * n + col);
        }
    }
    let mut row = (0..n).min_by(|&a, &b| best[a].total_cmp(&best[b])).unwrap_or(0);
    let mut path = Vec::with_capacity(n);
    for col in (0..n).rev() {
        path.push(DVec2::new(col as f64, row as f64));
        row = from[row * n + col];
    }
    path
}

/// `count` points in view, equally spaced along the route.
fn points(field: &Field, route: &[DVec2], wedge: &Wedge, count: usize) -> Vec<ReferencePoint> {
    let at = |i: usize, of: usize| {
        let t = i as f64 / of as f64 * (route.len() - 2) as f64;
        let grid = route[t as usize].lerp(route[t as usize + 1], t.fract());
        let ground = field.surface_at(grid).expect("on the ground");
        ReferencePoint { layer: 0, feature: 0, along_m: 0.0, grid, ground, lift: 1.0, kind: PointKind::Line }
    };
    let all: Vec<ReferencePoint> = (0..10_000).map(|i| at(i, 10_000)).collect();
    let seen = in_view(field, &all, wedge, 1.5).0;
    (0..count).map(|i| all[seen[i * seen.len() / count]]).collect()
}

struct Case {
    field: Field,
    cells: Cells,
    pyramid: Pyramid,
    eye: DVec3,
    points: Vec<ReferencePoint>,
}

impl Case {
    fn new(seed: u64, count: usize) -> Self {
        let field = fractal(seed);
        let route = valley(&field);
        let eye_grid = DVec2::new(512.0, 1000.0);
        let ground = field.surface_at(eye_grid).expect("on the ground");
        let eye = field.scene_from_grid(eye_grid).extend(ground + 700.0);
        let wedge = Wedge { heading: DVec2::Y, half_angle: 35f64.to_radians(), ..Wedge::all_around(eye.truncate()) };
        let points = points(&field, &route, &wedge, count);
        let cells = Cells::new(&field, Cells::default_count(&field));
        Self { pyramid: Pyramid::new(&field), cells, field, eye, points }
    }

    fn greedy(&self) -> Naive {
        Naive::new(&self.field, &self.cells, &self.pyramid, &TerrainSettings::default(), self.eye, &self.points)
    }
}

/// Processor time of all threads so far, milliseconds; 0 where the kernel does not tell.
fn cpu_ms() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return 0.0 };
    let of_task = |t: std::fs::DirEntry| {
        let text = std::fs::read_to_string(t.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    tasks.flatten().filter_map(of_task).sum::<f64>() * 1e-6
}

/// Per run; the kernel counts in ticks of some milliseconds, so several runs are taken together.
fn median_cpu<T>(rounds: usize, work: impl Fn() -> T) -> f64 {
    let batch = |runs: usize| {
        let before = cpu_ms();
        (0..runs).for_each(|_| drop(black_box(work())));
        (cpu_ms() - before) / runs as f64
    };
    let runs = (100.0 / batch(4).max(1.0)).ceil() as usize;
    let mut times: Vec<f64> = (0..rounds.max(1)).map(|_| batch(runs)).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn processor_time(rounds: usize) {
    let case = Case::new(7, 670);
    println!("cells: {}, at {NODES} x {NODES}", case.cells.len());
    let count = Cells::default_count(&case.field);
    println!("cells          {:8.2} ms", median_cpu(rounds, || Cells::new(&case.field, count)));
    println!("pyramid        {:8.2} ms", median_cpu(rounds, || Pyramid::new(&case.field)));
    println!("greedy pass    {:8.2} ms   {:?}", median_cpu(rounds, || case.greedy()), case.greedy().counters());
    let naive = case.greedy();
    println!("displacement   {:8.2} ms", median_cpu(rounds, || naive.displacement(&case.field, &case.cells)));
    // The points of the paper's table, and one more to see the line.
    for count in [195, 202, 513, 560, 660, 670, 1340] {
        let case = Case::new(7, count);
        let c = *case.greedy().counters();
        println!(
            "{count:5} points   {:8.3} ms   {} traces, {} hits",
            median_cpu(rounds, || case.greedy()),
            c.traces,
            c.hits
        );
    }
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    if args.iter().any(|a| a == "cpu") {
        processor_time(args.iter().filter_map(|a| a.parse().ok()).next().unwrap_or(9));
        return;
    }
    let case = Case::new(7, 670);
    let mut criterion = Criterion::default().configure_from_args().sample_size(20);
    let count = Cells::default_count(&case.field);
    criterion.bench_function("cells 1025^2", |b| b.iter(|| Cells::new(&case.field, count)));
    criterion.bench_function("pyramid 1025^2", |b| b.iter(|| Pyramid::new(&case.field)));
    criterion.bench_function("greedy 670 points 1025^2", |b| b.iter(|| case.greedy()));
    criterion.final_summary();
}
