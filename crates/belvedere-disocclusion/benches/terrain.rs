//! Terrain that makes way: cells, and the greedy pass, on 1025 x 1025 nodes.
//!
//! `cargo bench -p belvedere-construct --bench terrain` measures wall time; with `-- cpu [ROUNDS]` the processor time of all
//! threads, medians (Linux only, where the kernel counts it), which is what to believe on a busy machine.
#![allow(missing_docs, clippy::print_stdout)]

mod ground;

use belvedere_core::{DVec2, DVec3};
use belvedere_disocclusion::TerrainSettings;
use belvedere_disocclusion::internals::{BlockMaxima, Cells, Field, Naive, ReferencePoint, Wedge};
use criterion::Criterion;
use ground::{NODES, cpu_ms, exponent, fractal, points, route};
use std::hint::black_box;

struct Case {
    field: Field,
    cells: Cells,
    blocks: BlockMaxima,
    eye: DVec3,
    points: Vec<ReferencePoint>,
}

impl Case {
    /// * `nodes`: per side.
    fn new(seed: u64, nodes: usize, count: usize) -> Self {
        let field = fractal(seed, nodes);
        let route = route(seed, nodes);
        let eye_grid = DVec2::new(512.0, 1000.0) * ((nodes - 1) as f64 / 1024.0);
        let ground = field.surface_at(eye_grid).expect("on the ground");
        let eye = field.scene_from_grid(eye_grid).extend(ground + 700.0);
        let wedge = Wedge { heading: DVec2::Y, half_angle: 35f64.to_radians(), ..Wedge::all_around(eye.truncate()) };
        let points = points(&field, &route, &wedge, count);
        let cells = Cells::new(&field, Cells::default_count(&field));
        Self { blocks: BlockMaxima::new(&field), cells, field, eye, points }
    }

    fn greedy(&self) -> Naive {
        self.run(Some(&self.blocks))
    }

    /// Without blocks every crossing is looked at.
    fn run(&self, blocks: Option<&BlockMaxima>) -> Naive {
        Naive::new(&self.field, &self.cells, blocks, &TerrainSettings::default(), self.eye, &self.points)
    }
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
    let case = Case::new(7, NODES, 670);
    println!("cells: {}, at {NODES} x {NODES}", case.cells.len());
    let count = Cells::default_count(&case.field);
    println!("cells          {:8.2} ms", median_cpu(rounds, || Cells::new(&case.field, count)));
    println!("blocks         {:8.2} ms", median_cpu(rounds, || BlockMaxima::new(&case.field)));
    println!("greedy pass    {:8.2} ms   {:?}", median_cpu(rounds, || case.greedy()), case.greedy().counters());
    let naive = case.greedy();
    println!("displacement   {:8.2} ms", median_cpu(rounds, || naive.displacement(&case.field, &case.cells)));
    // The points of the paper's table, and one more to see the line.
    let mut of_points = Vec::new();
    for count in [195, 202, 513, 560, 660, 670, 1340] {
        let case = Case::new(7, NODES, count);
        let c = *case.greedy().counters();
        let time = median_cpu(rounds, || case.greedy());
        println!("{count:5} points   {time:8.3} ms   {} traces, {} hits", c.traces, c.hits);
        of_points.push((count as f64, time));
    }
    println!("exponent of points {:.2}", exponent(&of_points));
    let mut of_cells = Vec::new();
    for keep in [80, 160, 320, 651, 1300, 2600] {
        let time = median_cpu(rounds, || Cells::new(&case.field, keep));
        let cells = Cells::new(&case.field, keep);
        let case = Case { cells, ..Case::new(7, NODES, 670) };
        let greedy = median_cpu(rounds, || case.greedy());
        println!("{keep:5} cells    {time:8.2} ms to make, greedy pass {greedy:8.3} ms");
        of_cells.push((keep as f64, greedy));
    }
    println!("exponent of cells  {:.2}", exponent(&of_cells));
    let (mut of_nodes, mut greedy_of_nodes) = (Vec::new(), Vec::new());
    for nodes in [257, 513, NODES] {
        let case = Case::new(7, nodes, 670);
        let (count, square) = (Cells::default_count(&case.field), (nodes * nodes) as f64);
        let cells = median_cpu(rounds, || Cells::new(&case.field, count));
        let greedy = median_cpu(rounds, || case.greedy());
        println!("{nodes:5} squared  {cells:8.2} ms to make {count} cells, greedy pass {greedy:8.3} ms");
        of_nodes.push((square, cells));
        greedy_of_nodes.push((square, greedy));
    }
    println!("exponents of nodes: cells {:.2}, greedy pass {:.2}", exponent(&of_nodes), exponent(&greedy_of_nodes));
}

/// Shortest wall time of many runs: what the work takes where nothing else runs.
fn shortest(runs: usize) {
    let case = Case::new(7, NODES, 670);
    for (name, blocks) in [("low blocks skipped", Some(&case.blocks)), ("every crossing", None)] {
        let ms = |_| {
            let start = std::time::Instant::now();
            drop(black_box(case.run(blocks)));
            1e3 * start.elapsed().as_secs_f64()
        };
        let mut times: Vec<f64> = (0..runs.max(1)).map(ms).collect();
        times.sort_by(f64::total_cmp);
        println!("greedy pass, {name}: shortest {:.2} ms, median {:.2} ms", times[0], times[times.len() / 2]);
    }
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    if args.iter().any(|a| a == "shortest") {
        shortest(args.iter().filter_map(|a| a.parse().ok()).next().unwrap_or(300));
        return;
    }
    if args.iter().any(|a| a == "cpu") {
        processor_time(args.iter().filter_map(|a| a.parse().ok()).next().unwrap_or(9));
        return;
    }
    let case = Case::new(7, NODES, 670);
    let mut criterion = Criterion::default().configure_from_args().sample_size(20);
    let count = Cells::default_count(&case.field);
    criterion.bench_function("cells 1025^2", |b| b.iter(|| Cells::new(&case.field, count)));
    criterion.bench_function("blocks 1025^2", |b| b.iter(|| BlockMaxima::new(&case.field)));
    criterion.bench_function("greedy 670 points 1025^2", |b| b.iter(|| case.greedy()));
    criterion.final_summary();
}
