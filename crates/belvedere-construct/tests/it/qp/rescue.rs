//! Rows that contradict each other: the proof, and what is done about it.

use belvedere_construct::terrain::qp::{
    Candidate, QpOptions, QpProblem, QpResult, QpSolver, Reason, Rescued, StraightSight,
};
use belvedere_construct::terrain::{Field, Hierarchy, Smoother, TerrainSettings};
use belvedere_core::DVec2;
use belvedere_scene::{Heightfield, NodeState};

const COLS: usize = 97;
const ROWS: usize = 33;
const EYE: StraightSight = StraightSight { eye: DVec2::new(94.0, 16.0), z: 60.0 };

/// A plain with a post of 60 m every five cells, too narrow for the solver's grid.
fn posts() -> Field {
    field(|x, y| if y == 16 && x % 5 == 0 && x < 80 { 60.0 } else { 0.0 })
}

fn field(height: impl Fn(usize, usize) -> f32) -> Field {
    let heights: Vec<f32> = (0..COLS * ROWS).map(|i| height(i % COLS, i / COLS)).collect();
    let states = vec![NodeState::Measured; heights.len()];
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), COLS, ROWS, heights, states).unwrap();
    Field::new(&hf, |_| 0.0).unwrap()
}

/// One point behind every post.
fn candidates() -> Vec<Candidate> {
    let behind = |k: u32| DVec2::new(5.0 * f64::from(k) + 2.5, 16.0);
    (0..15).map(|k| Candidate { id: 100 + k, grid: behind(k), lift: 1.0 }).collect()
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
        for (node, w) in row.nodes.iter().zip(row.weights).filter(|(_, w)| *w != 0.0) {
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
    let text = proof.to_string();
    assert!(text.contains("cannot be clear at once") && text.contains("raise the eye"), "{text}");
    let known = |id: &u32| candidates.iter().any(|c| c.id == *id);
    assert!(!proof.rows.is_empty() && proof.rows.iter().all(|(id, m)| known(id) && *m > 0.0));
    assert!(proof.rows.iter().map(|r| r.1).sum::<f64>() <= 1.0 + 1e-9);
}

/// Whether the candidate is seen over the ground with detail and displacement, by small steps.
fn sees(field: &Field, found: &Rescued, c: &Candidate) -> bool {
    let hierarchy = Hierarchy::new(COLS, ROWS, 13);
    let lowered: Vec<f32> =
        (0..COLS * ROWS).map(|i| (field.heights()[i] + found.detail.as_ref().map_or(0.0, |d| d[i])) as f32).collect();
    let states = vec![NodeState::Measured; lowered.len()];
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), COLS, ROWS, lowered, states).unwrap();
    let ground = Field::new(&hf, |_| 0.0).unwrap();
    let z = |g: DVec2| ground.surface_at(g).unwrap() + hierarchy.at(&found.result.u, g);
    let (from, way) = (z(c.grid) + c.lift, (EYE.eye - c.grid).length());
    let steps = ((way - 1.5) / 0.05) as usize;
    (0..steps).map(|k| (1.5 + 0.05 * k as f64) / way).all(|t| z(c.grid.lerp(EYE.eye, t)) <= from + t * (EYE.z - from))
}

#[test]
fn detail_gives_way_where_the_solvers_grid_cannot() {
    let field = posts();
    let candidates = candidates();
    let mut solver = solver(&field);
    let found = solver.solve_or_rescue(&problem(&candidates)).unwrap();
    assert!(found.result.unresolved.is_empty(), "{:?}", found.result.unresolved);
    assert!(found.without_detail > 0);
    let detail = found.detail.as_ref().expect("the posts gave way");
    assert!(detail.iter().all(|d| *d <= 0.0) && detail.iter().any(|d| *d < -20.0));
    for c in &candidates {
        assert!(sees(&field, &found, c), "candidate {}", c.id);
    }
    let again = solver.solve_or_rescue(&problem(&candidates)).unwrap();
    assert_eq!(again.detail.is_some(), found.detail.is_some(), "the ground is as it was given");
}

#[test]
fn what_a_program_cut_short_leaves_is_lowered_at_full_resolution() {
    let field = field(|x, _| if (60..=68).contains(&x) { 65.0 } else { 0.0 });
    let candidates = &candidates()[..8];
    let mut solver = solver(&field);
    solver.set_options(QpOptions { rounds: 1, ..QpOptions::of(&TerrainSettings::default()) });
    let found = solver.solve_or_rescue(&problem(candidates)).unwrap();
    assert!(found.at_full_resolution > 0 && found.result.unresolved.is_empty(), "{:?}", found.result.unresolved);
    for c in candidates {
        assert!(sees(&field, &found, c), "candidate {}", c.id);
    }
}

#[test]
fn ground_that_can_give_way_keeps_its_detail() {
    let field = posts();
    let one = &candidates()[3..4];
    let found = solver(&field).solve_or_rescue(&problem(one)).unwrap();
    assert!(found.result.unresolved.is_empty() && found.detail.is_none() && found.without_detail == 0);
    assert!(sees(&field, &found, &one[0]));
}
