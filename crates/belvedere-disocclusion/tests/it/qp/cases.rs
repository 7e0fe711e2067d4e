//! Odd views and odd ground.

use belvedere_core::DVec2;
use belvedere_disocclusion::TerrainSettings;
use belvedere_disocclusion::internals::{
    Candidate, QpError, QpOptions, QpProblem, QpResult, QpSolver, Reason, StraightSight,
};
use belvedere_disocclusion::internals::{Field, Hierarchy, Smoother};
use belvedere_scene::{Heightfield, NodeState};

fn field(cols: usize, rows: usize, height: impl Fn(usize, usize) -> f64) -> Field {
    let heights = (0..cols * rows).map(|i| height(i % cols, i / cols) as f32).collect();
    let states = vec![NodeState::Measured; cols * rows];
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(30.0), cols, rows, heights, states).unwrap();
    Field::new(&hf, |_| 0.0).unwrap()
}

fn solver(field: &Field, nodes: [usize; 2], options: QpOptions) -> QpSolver {
    let hierarchy = Hierarchy::new(field.cols(), field.rows(), nodes[0]);
    let smoother = Smoother::new(nodes[0], nodes[1], 0.3, 0.0).unwrap();
    QpSolver::new(field, &hierarchy, smoother, options)
}

fn ask(solver: &mut QpSolver, points: &[DVec2], eye: DVec2, z: f64) -> Result<QpResult, QpError> {
    let candidates: Vec<Candidate> =
        points.iter().enumerate().map(|(i, p)| Candidate::new(i as u32, *p, 1.0)).collect();
    let sight = StraightSight { eye, z };
    solver.solve(&QpProblem { candidates: &candidates, sight: &sight, target: None, ceilings: None })
}

fn options() -> QpOptions {
    QpOptions::of(&TerrainSettings::default())
}

/// A wall across the ground.
fn wall(x: usize, _: usize) -> f64 {
    if (15..=17).contains(&x) { 120.0 } else { 0.0 }
}

#[test]
fn an_eye_beside_the_ground_on_lines_and_vertices() {
    let ground = field(33, 33, wall);
    for eye in [DVec2::new(60.0, 16.0), DVec2::new(28.0, 16.0), DVec2::new(28.0, 28.0), DVec2::new(27.5, 4.0)] {
        let mut solver = solver(&ground, [9, 9], options());
        let got = ask(&mut solver, &[DVec2::new(6.0, 16.0), DVec2::new(6.0, 6.0), DVec2::new(0.0, 32.0)], eye, 60.0);
        let got = got.unwrap();
        assert!(got.unresolved.is_empty(), "{eye}: {:?}", got.unresolved);
        let lowest = got.u.iter().copied().fold(0.0, f64::min);
        assert!(lowest < -40.0, "{eye}: the wall sank by {lowest} only");
        assert!(got.u.iter().all(|v| *v <= 0.5), "{eye}: {:?}", got.u.iter().copied().fold(0.0, f64::max));
    }
}

#[test]
fn nothing_moves_where_nothing_hides() {
    let got = ask(
        &mut solver(&field(33, 33, |_, _| 500.0), [9, 9], options()),
        &[DVec2::splat(5.0)],
        DVec2::splat(28.0),
        560.0,
    );
    let got = got.unwrap();
    assert!(got.u.iter().all(|v| *v == 0.0) && got.active.is_empty() && got.energy == 0.0);
    let none = ask(&mut solver(&field(33, 33, wall), [9, 9], options()), &[], DVec2::splat(28.0), 560.0).unwrap();
    assert!(none.u.iter().all(|v| *v == 0.0));
}

#[test]
fn two_by_two_nodes_are_enough() {
    let ground = field(2, 2, |x, y| (x + y) as f64);
    let got = ask(&mut solver(&ground, [2, 2], options()), &[DVec2::splat(0.2)], DVec2::new(9.0, 9.0), 50.0).unwrap();
    assert!(got.u.iter().all(|v| v.is_finite()) && got.unresolved.is_empty());
}

#[test]
fn an_eye_under_the_ground_is_refused_and_a_near_point_is_named() {
    let ground = field(33, 33, wall);
    let under = ask(&mut solver(&ground, [9, 9], options()), &[DVec2::splat(6.0)], DVec2::splat(16.0), 100.0);
    let text = under.unwrap_err().to_string();
    assert!(text.contains("20.0 m under the ground"), "{text}");
    let near = ask(&mut solver(&ground, [9, 9], options()), &[DVec2::splat(25.0)], DVec2::splat(27.0), 100.0).unwrap();
    assert_eq!(near.unresolved.len(), 1);
    assert_eq!(near.unresolved[0].reason, Reason::TooNear);
}

#[test]
fn the_height_of_the_datum_does_not_matter() {
    let points = [DVec2::new(6.0, 16.0), DVec2::new(5.5, 9.0)];
    let low = ask(&mut solver(&field(33, 33, wall), [9, 9], options()), &points, DVec2::new(29.0, 14.5), 60.0).unwrap();
    let high = field(33, 33, |x, y| wall(x, y) + 4096.0);
    let high = ask(&mut solver(&high, [9, 9], options()), &points, DVec2::new(29.0, 14.5), 4156.0).unwrap();
    let apart = low.u.iter().zip(&high.u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart}");
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let ground = field(65, 65, |x, y| 90.0 * ((x as f64) * 0.31).sin() * ((y as f64) * 0.23).cos());
    let points: Vec<DVec2> =
        (0..400).map(|i| DVec2::new(4.0 + 0.05 * f64::from(i), 8.0 + 0.11 * f64::from(i))).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| ask(&mut solver(&ground, [17, 17], options()), &points, DVec2::new(60.0, 20.0), 140.0).unwrap())
    };
    let (one, three) = (run(1), run(3));
    assert!(one.u.iter().any(|v| *v < -10.0));
    assert_eq!(one.u, three.u);
    assert_eq!(one.active, three.active);
}
