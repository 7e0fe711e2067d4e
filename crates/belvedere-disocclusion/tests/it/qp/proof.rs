//! Rows that contradict each other, and the proof of it.

use belvedere_core::DVec2;
use belvedere_disocclusion::TerrainSettings;
use belvedere_disocclusion::internals::{Candidate, QpOptions, QpProblem, QpResult, QpSolver, Reason, StraightSight};
use belvedere_disocclusion::internals::{Field, Hierarchy, Smoother};
use belvedere_scene::{Heightfield, NodeState};

const COLS: usize = 97;
const ROWS: usize = 33;
const EYE: StraightSight = StraightSight { eye: DVec2::new(94.0, 16.0), z: 60.0 };

/// A plain with a post of 60 m every five cells, too narrow for the solver's grid.
fn posts() -> Field {
    let height = |i: usize| if i / COLS == 16 && (i % COLS).is_multiple_of(5) && i % COLS < 80 { 60.0 } else { 0.0 };
    let heights: Vec<f32> = (0..COLS * ROWS).map(height).collect();
    let states = vec![NodeState::Measured; heights.len()];
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), COLS, ROWS, heights, states).unwrap();
    Field::new(&hf, |_| 0.0).unwrap()
}

/// One point behind every post.
fn candidates() -> Vec<Candidate> {
    let behind = |k: u32| DVec2::new(5.0 * f64::from(k) + 2.5, 16.0);
    (0..15).map(|k| Candidate::new(100 + k, behind(k), 1.0)).collect()
}

fn solver(field: &Field) -> QpSolver {
    let hierarchy = Hierarchy::new(COLS, ROWS, 13);
    let smoother = Smoother::new(hierarchy.cols(), hierarchy.rows(), 0.3, 0.0).unwrap();
    QpSolver::new(field, &hierarchy, smoother, QpOptions::of(&TerrainSettings::default()))
}

fn problem(candidates: &[Candidate]) -> QpProblem<'_> {
    QpProblem { candidates, sight: &EYE, target: None, ceilings: None }
}

/// The multipliers of the rows prove the contradiction: over all displacements in the box their sum is missed.
fn gap(found: &QpResult, depth: f64, ceiling: f64) -> f64 {
    let mut sum = std::collections::BTreeMap::<u32, f64>::new();
    let (mut bound, mut total) = (0.0, 0.0);
    for row in &found.active {
        for (node, w) in &row.weights {
            *sum.entry(*node).or_default() += row.multiplier * w;
        }
        bound += row.multiplier * row.bound;
        total += row.multiplier;
    }
    let least: f64 = sum.values().map(|g| if *g > 0.0 { -g * depth } else { g * ceiling }).sum();
    (least - bound) / total
}

#[test]
fn contradicting_rows_are_proved_to_be_so() {
    let field = posts();
    let candidates = candidates();
    let found = solver(&field).solve(&problem(&candidates)).unwrap();
    let infeasible = found.unresolved.iter().find_map(|u| match &u.reason {
        Reason::Infeasible(proof) => Some(proof),
        _ => None,
    });
    let proof = infeasible.expect("a proof");
    assert!(proof.gap > 0.0 && (gap(&found, proof.depth, 0.25) - proof.gap).abs() < 1e-6 * proof.gap, "{proof:?}");
    let known = |id: &u32| candidates.iter().any(|c| c.id == *id);
    assert!(!proof.rows.is_empty() && proof.rows.iter().all(|(id, m)| known(id) && *m > 0.0));
    assert!(proof.rows.iter().map(|r| r.1).sum::<f64>() <= 1.0 + 1e-9);
}

#[test]
fn a_single_post_is_no_contradiction() {
    let field = posts();
    let found = solver(&field).solve(&problem(&candidates()[3..4])).unwrap();
    assert!(found.unresolved.is_empty(), "{:?}", found.unresolved);
    assert!(found.u.iter().any(|u| *u < -20.0));
}
