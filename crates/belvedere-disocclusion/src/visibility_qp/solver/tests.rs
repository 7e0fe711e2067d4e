//! A program that begins with the rows of one on a coarser grid.

use super::*;
use crate::smooth::grid_weight;
use crate::visibility_qp::{Candidate, StraightSight};
use belvedere_scene::{Heightfield, NodeState};

const N: usize = 65;

/// Wide hills, which grids of 9 and of 17 nodes a side can lower in much the same way.
fn field() -> Field {
    let hill = |x: f64, y: f64, [cx, cy, r, h]: [f64; 4]| h * (-((x - cx).powi(2) + (y - cy).powi(2)) / (r * r)).exp();
    let height = |i: usize| {
        let (x, y) = ((i % N) as f64, (i / N) as f64);
        (hill(x, y, [32.0, 28.0, 10.0, 90.0]) + hill(x, y, [48.0, 40.0, 9.0, 60.0])) as f32
    };
    let heights = (0..N * N).map(height).collect();
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), N, N, heights, vec![NodeState::Measured; N * N]);
    Field::new(&hf.unwrap(), |_| 0.0).unwrap()
}

fn solver(nodes: usize) -> (QpSolver, Hierarchy) {
    let grid = Hierarchy::new(N, N, nodes);
    let smoother = Smoother::new(nodes, nodes, grid_weight(2e-3, grid.intervals()), 0.0).unwrap();
    let options = QpOptions {
        near: 0.5,
        guard: 1.0,
        margin: 1.0,
        tolerance: 1e-4,
        ceiling: 0.0,
        ceiling_tolerance: 1e-4,
        slack_price: None,
        rounds: 200,
        enough: 0.0,
    };
    (QpSolver::new(&field(), &grid, smoother, options), grid)
}

fn solve(solver: &mut QpSolver) -> QpResult {
    let place = |i: u32| DVec2::new(6.0 + 0.4 * f64::from(i), 5.0 + 2.3 * f64::from(i));
    let candidates: Vec<Candidate> = (0..24).map(|i| Candidate::new(i, place(i), 1.0)).collect();
    let sight = StraightSight { eye: DVec2::new(61.0, 34.5), z: 95.0 };
    solver.solve(&QpProblem { candidates: &candidates, sight: &sight, target: None, ceilings: None }).unwrap()
}

/// Sum of the multipliers of lines of sight.
fn sights(rows: &[RememberedRow]) -> f64 {
    rows.iter().filter(|row| matches!(row.key, RowKey::Sight { .. })).map(|row| row.multiplier).sum()
}

#[test]
fn a_finer_grid_begins_with_multipliers_of_its_own_scale() {
    let ((mut coarse, from), (mut cold, to), (mut warm, _)) = (solver(9), solver(17), solver(17));
    let before = solve(&mut coarse);
    let alone = solve(&mut cold);
    assert!(before.unresolved.is_empty() && alone.unresolved.is_empty() && before.energy > 0.0);
    // Bending counts per node: with half the step the same metre costs about a quarter.
    let share = sights(&cold.kept) / sights(&coarse.kept);
    let node = |i: usize| DVec2::new((i % 17) as f64, (i / 17) as f64) * to.step();
    let u: Vec<f64> = (0..to.nodes()).map(|i| from.at(&before.u, node(i))).collect();
    warm.begin_from(&coarse, &u);
    assert_eq!(warm.surface.u, u);
    assert_eq!(warm.kept.len(), coarse.kept.len());
    let scaled = sights(&warm.kept) / sights(&coarse.kept);
    assert!((scaled - 0.25).abs() < 1e-12, "{scaled}");
    assert!((share / scaled - 1.0).abs() < 0.3, "the finer grid's own multipliers are {share} of the coarse one's");
    let mut ceilings = 0;
    for (kept, row) in coarse.kept.iter().zip(&warm.kept) {
        match (kept.key, row.key) {
            // The node at the same place.
            (RowKey::Ceiling(a), RowKey::Ceiling(b)) => {
                ceilings += 1;
                assert_eq!([b % 17, b / 17], [a % 9, a / 9].map(|k| 2 * k));
            }
            (RowKey::Sight { id: a, at: p }, RowKey::Sight { id: b, at: q }) => assert_eq!((a, p), (b, q)),
            keys => panic!("{keys:?}"),
        }
    }
    assert!(ceilings > 0, "no node is held at its ceiling");
    // Rows to begin with do not change the solution.
    let after = solve(&mut warm);
    assert!(after.kept > 5 && after.unresolved.is_empty(), "{} rows", after.kept);
    assert!((after.energy - alone.energy).abs() < 1e-3 * alone.energy, "{} and {}", after.energy, alone.energy);
}
