//! The solver compared with the slow reference, on small ground.

use super::reference::{DenseRow, Small};
use belvedere_core::DVec2;
use belvedere_disocclusion::internals::{Candidate, QpOptions, QpProblem, QpResult, QpSolver, StraightSight};
use belvedere_disocclusion::internals::{Field, Hierarchy, Smoother};
use belvedere_scene::{Heightfield, NodeState};

/// Hills between a path and an eye.
fn hills(step: f64, nodes: usize) -> Small {
    let n = 33;
    let height = |x: f64, y: f64| {
        let hill = |cx: f64, cy: f64, r: f64, h: f64| h * (-((x - cx).powi(2) + (y - cy).powi(2)) / (r * r)).exp();
        hill(16.0, 14.0, 5.0, 90.0) + hill(24.0, 20.0, 4.0, 60.0) + 8.0 * (0.9 * x).sin() * (0.7 * y).cos()
    };
    let ground = (0..n * n).map(|i| f64::from(height((i % n) as f64, (i / n) as f64) as f32)).collect();
    Small { n, ground, nodes, step, weight: 0.09 }
}

fn field(small: &Small) -> Field {
    let heights = small.ground.iter().map(|h| *h as f32).collect();
    let states = vec![NodeState::Measured; small.ground.len()];
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), small.n, small.n, heights, states).unwrap();
    Field::new(&hf, |_| 0.0).unwrap()
}

const EYE: DVec2 = DVec2::new(30.5, 17.25);
const EYE_Z: f64 = 95.0;

fn points() -> Vec<(DVec2, f64)> {
    (0..12).map(|i| (DVec2::new(4.0 + 0.31 * f64::from(i), 3.0 + 2.3 * f64::from(i)), 1.0)).collect()
}

fn exact() -> QpOptions {
    QpOptions {
        near: 0.0,
        guard: 1.5,
        margin: 1.0,
        tolerance: 1e-7,
        ceiling: 0.0,
        ceiling_tolerance: 1e-7,
        slack_price: None,
        rounds: 200,
        enough: 0.0,
    }
}

fn solver(small: &Small, options: QpOptions) -> QpSolver {
    let hierarchy = Hierarchy::new(small.n, small.n, small.nodes);
    let smoother = Smoother::new(small.nodes, small.nodes, small.weight.sqrt(), 0.0).unwrap();
    QpSolver::new(&field(small), &hierarchy, smoother, options)
}

fn solve(solver: &mut QpSolver, eye: DVec2, target: Option<&[f64]>) -> QpResult {
    let candidates: Vec<Candidate> =
        points().iter().enumerate().map(|(i, (grid, lift))| Candidate::new(i as u32, *grid, *lift)).collect();
    let sight = StraightSight { eye, z: EYE_Z };
    solver.solve(&QpProblem { candidates: &candidates, sight: &sight, target, ceilings: None }).unwrap()
}

/// Every ceiling, and every row at the kinks of the ground.
fn all_rows(small: &Small, eye: DVec2, options: &QpOptions) -> Vec<DenseRow> {
    let mut rows = small.sight_rows(&points(), (eye, EYE_Z), options.guard, options.margin, 1);
    let count = small.nodes * small.nodes;
    if options.ceiling.is_finite() {
        rows.extend((0..count).map(|j| DenseRow {
            row: (0..count).map(|k| f64::from(u8::from(j == k))).collect(),
            bound: options.ceiling,
        }));
    }
    rows
}

fn missed(row: &DenseRow, u: &[f64]) -> f64 {
    row.row.iter().zip(u).map(|(a, u)| a * u).sum::<f64>() - row.bound
}

/// Compares with the slow solution: the objective, and that no row of all is missed, between kinks either.
fn assert_optimal(small: &Small, eye: DVec2, options: &QpOptions, target: &[f64], got: &QpResult) {
    let mut rows = all_rows(small, eye, options);
    let (u, energy) = small.solve(&rows, target);
    rows.extend(small.sight_rows(&points(), (eye, EYE_Z), options.guard, options.margin, 16));
    assert!(energy > 1.0, "nothing to do");
    assert!((got.energy - energy).abs() <= 1e-6 * energy, "energy {} against {energy}", got.energy);
    let worst = rows.iter().map(|r| missed(r, &got.u)).fold(f64::NEG_INFINITY, f64::max);
    assert!(worst < 1e-5, "a row is missed by {worst}");
    let apart = u.iter().zip(&got.u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 0.05, "displacements differ by {apart}");
    assert!(got.unresolved.is_empty(), "{:?}", got.unresolved);
}

#[test]
fn lazy_rows_find_the_same_optimum_as_all_rows_at_once() {
    for (step, nodes) in [(4.0, 9), (8.0, 5)] {
        let small = hills(step, nodes);
        for ceiling in [0.0, 7.0, f64::INFINITY] {
            let options = QpOptions { ceiling, ..exact() };
            let got = solve(&mut solver(&small, options), EYE, None);
            assert_optimal(&small, EYE, &options, &vec![0.0; nodes * nodes], &got);
        }
    }
}

#[test]
fn a_target_is_left_as_little_as_possible() {
    let small = hills(4.0, 9);
    let target: Vec<f64> = (0..81).map(|i| -20.0 - 15.0 * (f64::from(i) * 0.37).sin()).collect();
    let got = solve(&mut solver(&small, exact()), EYE, Some(&target));
    assert_optimal(&small, EYE, &exact(), &target, &got);
}

#[test]
fn warm_frames_find_the_same_optimum_as_cold_ones() {
    let small = hills(4.0, 9);
    let mut warm = solver(&small, exact());
    for k in 0..5 {
        let eye = EYE + DVec2::new(-0.2, 0.9) * f64::from(k);
        let got = solve(&mut warm, eye, None);
        assert_optimal(&small, eye, &exact(), &[0.0; 81], &got);
        assert!(k == 0 || got.kept > 5, "frame {k} kept {}", got.kept);
    }
}

/// Stationarity `H (u - u*) + A^T m = 0` by the stencil, multipliers and complementarity.
#[test]
fn solutions_meet_the_conditions_of_karush_kuhn_and_tucker() {
    let small = hills(4.0, 9);
    let got = solve(&mut solver(&small, exact()), EYE, None);
    let mut force: Vec<f64> =
        small.metric().iter().map(|r| r.iter().zip(&got.u).map(|(h, u)| h * u).sum::<f64>()).collect();
    let mut most = 0.0f64;
    for row in &got.active {
        assert!(row.multiplier > 0.0);
        let mut value = -row.bound;
        for (node, w) in &row.weights {
            force[*node as usize] += row.multiplier * w;
            value += w * got.u[*node as usize];
        }
        assert!(value.abs() < 1e-5, "a row with a multiplier has slack {value}");
        most = most.max(row.multiplier);
    }
    let left = force.iter().map(|f| f.abs()).fold(0.0, f64::max);
    assert!(left < 1e-8 * most, "forces of {left} are left over of {most}");
    assert!(got.active.iter().any(|r| r.candidate.is_some()) && got.active.iter().any(|r| r.candidate.is_none()));
}
