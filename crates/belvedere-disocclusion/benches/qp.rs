//! The quadratic program on 1025 x 1025 nodes: one cold frame and 23 warm ones of a fly-through, for 670 reference points
//! (5360 dense ones). The eye moves by 0.86 cells and 3 m from frame to frame.
//!
//! `cargo bench -p belvedere-construct --bench qp`: wall time and, where the kernel counts it, processor time of all threads;
//! with `-- exponents` how a warm frame grows with points and grid.
#![allow(missing_docs, clippy::print_stdout)]

mod ground;

use belvedere_core::DVec2;
use belvedere_disocclusion::TerrainSettings;
use belvedere_disocclusion::internals::{Candidate, QpOptions, QpProblem, QpSolver, StraightSight};
use belvedere_disocclusion::internals::{Hierarchy, Smoother, Wedge, grid_weight, stated_spacing};
use ground::{NODES, cpu_ms, exponent, fractal, points, route};
use std::time::Instant;

const FRAMES: usize = 24;
const POINTS: usize = 5360;

/// Processor time of a warm frame, median.
///
/// * `g`: temporal weight as a multiple of w: the frame before is the target;
/// * `nodes`: of the ground, per side; `count`: dense points.
fn fly(g: f64, nodes: usize, count: usize) -> f64 {
    let field = fractal(7, nodes);
    let route = route(7, nodes);
    let settings = TerrainSettings::default();
    let hierarchy = Hierarchy::new(nodes, nodes, settings.solver_nodes);
    let cells = (nodes - 1) as f64 / 1024.0;
    let start = DVec2::new(512.0, 1000.0) * cells;
    let z = field.surface_at(start).expect("on the ground") + 700.0;
    let eye = field.scene_from_grid(start);
    let wedge = Wedge { heading: DVec2::Y, half_angle: 35f64.to_radians(), ..Wedge::all_around(eye) };
    let dense = points(&field, &route, &wedge, count).into_iter().enumerate();
    let candidates: Vec<Candidate> = dense.map(|(i, p)| Candidate::new(i as u32, p.grid, p.lift)).collect();
    let w = grid_weight(
        settings.smoothness(stated_spacing(field.cols(), field.rows(), field.spacing())),
        hierarchy.intervals(),
    );
    let smoother = Smoother::new(hierarchy.cols(), hierarchy.rows(), w, g * w).expect("in range");
    let mut solver = QpSolver::new(&field, &hierarchy, smoother, QpOptions::of(&settings));
    let mut last: Option<Vec<f64>> = None;
    let (mut walls, mut cpus, mut most) = (Vec::new(), Vec::new(), 0.0f64);
    for k in 0..FRAMES {
        let sight = StraightSight { eye: start + DVec2::new(0.86 * cells * k as f64, 0.0), z: z + 3.0 * k as f64 };
        let kept = g * g / (1.0 + g * g);
        let target: Option<Vec<f64>> = last.as_ref().filter(|_| g > 0.0).map(|u| u.iter().map(|v| kept * v).collect());
        let (cpu, wall) = (cpu_ms(), Instant::now());
        let problem = QpProblem { candidates: &candidates, sight: &sight, target: target.as_deref(), ceilings: None };
        let found = solver.solve(&problem).expect("solvable");
        let (wall, cpu) = (wall.elapsed().as_secs_f64() * 1e3, cpu_ms() - cpu);
        assert!(found.unresolved.is_empty(), "frame {k}: {:?}", found.unresolved);
        if let Some(last) = &last {
            most = last.iter().zip(&found.u).map(|(a, b)| (a - b).abs()).fold(most, f64::max);
            walls.push(wall);
            cpus.push(cpu);
        } else {
            println!("cold          wall {wall:7.1} ms   processor {cpu:7.1} ms   {} rows", found.rows);
        }
        last = Some(found.u);
    }
    walls.sort_by(f64::total_cmp);
    cpus.sort_by(f64::total_cmp);
    let at = |times: &[f64], share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!("warm, median  wall {:7.1} ms   processor {:7.1} ms", at(&walls, 0.5), at(&cpus, 0.5));
    println!("warm, 95 %    wall {:7.1} ms   processor {:7.1} ms", at(&walls, 0.95), at(&cpus, 0.95));
    println!("largest step between frames {most:.2} m");
    at(&cpus, 0.5)
}

fn main() {
    if std::env::args().any(|a| a == "exponents") {
        let of = |nodes: usize, count: usize| {
            println!("{nodes} x {nodes} nodes, {count} points");
            fly(2.0, nodes, count)
        };
        let of_nodes = [257, 513, NODES].map(|nodes| ((nodes * nodes) as f64, of(nodes, POINTS)));
        let of_points = [1340, 2680, 5360, 10_000].map(|count| (count as f64, of(NODES, count)));
        println!("exponents: points {:.2}, nodes {:.2}", exponent(&of_points), exponent(&of_nodes));
        return;
    }
    for g in [0.0, 2.0] {
        println!("temporal weight {g} w");
        fly(g, NODES, POINTS);
    }
}
