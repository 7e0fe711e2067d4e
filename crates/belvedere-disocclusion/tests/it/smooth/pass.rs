//! The smooth pass: against the paper's absolute form, over time, and with detail.

use belvedere_core::DVec2;
use belvedere_disocclusion::internals::{
    ConjugateGradients, ElevationRows, Hierarchy, SmoothPass, Smoother, grid_weight, row_weight, temporal_weight,
};

use super::support::{Dense, apart, laplacian_rows, numbers};

/// Points scattered over a grid, whole and in between.
fn points(seed: u64, count: usize, cols: usize, rows: usize) -> Vec<DVec2> {
    let xy = numbers(seed, 2 * count);
    let place = |k: usize| DVec2::new(xy[2 * k] + 1.0, xy[2 * k + 1] + 1.0) * 0.5;
    (0..count).map(|k| place(k) * DVec2::new((cols - 1) as f64, (rows - 1) as f64)).collect()
}

/// Normal equations of rows (11)-(15), solved densely for the heights f' themselves.
struct Literal {
    matrix: Dense,
    rhs: Vec<f64>,
}

impl Literal {
    fn new(n: usize) -> Self {
        Self { matrix: Dense::identity(n, 0.0), rhs: vec![0.0; n] }
    }

    fn row(&mut self, row: &[f64], value: f64) {
        self.matrix.add_outer(row, 1.0);
        self.rhs.iter_mut().zip(row).for_each(|(b, a)| *b += a * value);
    }

    fn unit_rows(&mut self, weight: f64, values: &[f64]) {
        let n = values.len();
        for (i, v) in values.iter().enumerate() {
            let mut row = vec![0.0; n];
            row[i] = weight;
            self.row(&row, weight * v);
        }
    }
}

#[test]
fn displacements_are_the_papers_absolute_form_with_detail_vectors() {
    let (cols, rows, n) = (13, 10, 130);
    let (w, time, dt, weight) = (0.6, 0.15, 1.0 / 30.0, 0.7);
    let ground: Vec<f64> = numbers(1, n).iter().map(|x| 2500.0 + 900.0 * x).collect();
    let naive: Vec<f64> = numbers(2, n).iter().map(|x| 300.0 * x.min(0.0)).collect();
    let last: Vec<f64> = numbers(3, n).iter().map(|x| 100.0 * x).collect();
    let places = points(4, 25, cols, rows);

    let hierarchy = Hierarchy::new(cols, rows, cols);
    let mut pass = SmoothPass::new(hierarchy.clone(), w, weight, &places).unwrap();
    let found = pass.run(&naive, Some([dt, time]), Some(&last));

    let (w, weight) = (grid_weight(w, (cols - 1) as f64), row_weight(weight, (cols - 1) as f64));
    let g = temporal_weight(w, dt, time);
    let moved = |u: &[f64]| -> Vec<f64> { ground.iter().zip(u).map(|(f, u)| f + u).collect() };
    let mut literal = Literal::new(n);
    for row in laplacian_rows(cols, rows) {
        // delta = L f.
        let delta: f64 = row.iter().zip(&ground).map(|(l, f)| l * f).sum();
        literal.row(&row, delta);
    }
    literal.unit_rows(w, &moved(&naive));
    literal.unit_rows(g, &moved(&last));
    for p in &places {
        let (c, r) = (p.x.floor().min((cols - 2) as f64), p.y.floor().min((rows - 2) as f64));
        let (a, b) = (p.x - c, p.y - r);
        let mut row = vec![0.0; n];
        let corner = r as usize * cols + c as usize;
        for (i, f) in [(0, (1.0 - a) * (1.0 - b)), (1, a * (1.0 - b)), (cols, (1.0 - a) * b), (cols + 1, a * b)] {
            row[corner + i] = f;
        }
        let wanted: f64 = row.iter().zip(&moved(&naive)).map(|(f, z)| f * z).sum();
        row.iter_mut().for_each(|f| *f *= weight);
        literal.row(&row, weight * wanted);
    }
    let heights = literal.matrix.solve(&literal.rhs);
    assert!(found.convergence.unwrap().residual <= 1e-6);
    assert!(apart(&moved(&found.u), &heights) < 1e-3, "{:e}", apart(&moved(&found.u), &heights));

    let mut direct = SmoothPass::new(hierarchy, 0.6, 0.0, &places).unwrap();
    let found = direct.run(&naive, Some([dt, time]), Some(&last));
    let mut literal = Literal::new(n);
    for row in laplacian_rows(cols, rows) {
        let delta: f64 = row.iter().zip(&ground).map(|(l, f)| l * f).sum();
        literal.row(&row, delta);
    }
    literal.unit_rows(w, &moved(&naive));
    literal.unit_rows(g, &moved(&last));
    let heights = literal.matrix.solve(&literal.rhs);
    assert!(found.convergence.is_none());
    assert!(apart(&moved(&found.u), &heights) < 1e-8, "{:e}", apart(&moved(&found.u), &heights));
}

#[test]
fn nothing_to_move_moves_nothing_to_the_last_bit() {
    for weight in [0.0, 1.0] {
        let places = points(5, 40, 50, 41);
        let mut pass = SmoothPass::new(Hierarchy::new(50, 41, 17), 0.6, weight, &places).unwrap();
        let found = pass.run(&vec![0.0; 50 * 41], Some([0.1, 0.15]), None);
        assert!(found.u.iter().all(|u| *u == 0.0));
        assert!(pass.plain(&found.u).iter().all(|u| *u == 0.0));
    }
}

/// A system of the size of terrain.md 6.5: 129 x 129 nodes, 1350 rows, w = 0.6 and gamma = 2 w.
fn large() -> (Smoother, ElevationRows, Vec<f64>) {
    let hierarchy = Hierarchy::new(1025, 1025, 129);
    let smoother = Smoother::new(129, 129, 0.6, 1.2).unwrap();
    let rows = ElevationRows::new(&hierarchy, points(6, 1350, 1025, 1025), 1.0);
    let naive: Vec<f64> = numbers(7, 129 * 129).iter().map(|x| 200.0 * x.min(0.0)).collect();
    let mut b: Vec<f64> = naive.iter().map(|u| smoother.shift() * u).collect();
    rows.add_wanted(|i| naive[(i * 37) % naive.len()], &mut b);
    (smoother, rows, b)
}

#[test]
fn elevation_rows_converge_in_six_iterations_cold_and_two_warm() {
    let (mut smoother, rows, b) = large();
    let mut cg = ConjugateGradients::default();
    let mut x = vec![0.0; b.len()];
    let cold = cg.solve(&mut smoother, &rows, &b, &mut x, 1e-6, 60);
    assert!(cold.iterations <= 6 && cold.residual <= 1e-6, "{cold:?}");
    // The reported residual is the true one, computed by the stencil.
    let (mut work, mut back) = (b.clone(), b.clone());
    smoother.apply(&x, &mut work, &mut back);
    rows.add_normal(&x, &mut back);
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
    let true_residual = norm(&mut back.iter().zip(&b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied());
    assert!((true_residual - cold.residual).abs() < 1e-9, "{true_residual:e} {cold:?}");
    // A frame later: the right-hand side moved by two per cent.
    let drift = numbers(8, b.len());
    let next: Vec<f64> = b.iter().zip(&drift).map(|(b, d)| b * (1.0 + 0.02 * d)).collect();
    let warm = cg.solve(&mut smoother, &rows, &next, &mut x, 1e-4, 60);
    assert!(warm.iterations <= 2 && warm.residual <= 1e-4, "{warm:?}");
}

#[test]
fn elevation_rows_pull_towards_what_they_ask_for() {
    let (cols, rows) = (65, 65);
    let place = DVec2::new(20.5, 30.25);
    let hierarchy = Hierarchy::new(cols, rows, cols);
    let mut naive = vec![0.0; cols * rows];
    (30..32).for_each(|r| (20..22).for_each(|c| naive[r * cols + c] = -100.0));
    let run = |weight: f64| {
        let mut pass = SmoothPass::new(hierarchy.clone(), 0.1, weight, &[place]).unwrap();
        let found = pass.run(&naive, None, None);
        hierarchy.at(&found.u, place)
    };
    let (none, some, much) = (run(0.0), run(0.5), run(20.0));
    assert!(none > some && some > much, "{none} {some} {much}");
    assert!((much + 100.0).abs() < 1.0, "{much}");
}

#[test]
fn the_temporal_weight_is_the_papers_at_thirty_frames_and_free_of_the_frame_rate() {
    let ratio = temporal_weight(0.6, 1.0 / 30.0, 0.15) / 0.6;
    assert!((ratio - 2.0).abs() < 0.01, "{ratio}");
    assert_eq!(temporal_weight(0.6, 0.1, 0.0), 0.0);
    assert!(temporal_weight(0.6, 0.0, 0.15).is_finite() && temporal_weight(0.6, 1e9, 0.15) < 1e-12);
    // A flat step is followed alike at 15 and at 60 frames per second.
    let after = |frames: usize| {
        let hierarchy = Hierarchy::new(9, 9, 9);
        let mut pass = SmoothPass::new(hierarchy, 0.6, 0.0, &[]).unwrap();
        let mut u = vec![0.0; 81];
        for _ in 0..frames {
            u = pass.run(&[-50.0; 81], Some([0.4 / frames as f64, 0.15]), Some(&u)).u;
        }
        u[40]
    };
    let expected = -50.0 * (1.0 - (-0.4f64 / 0.15).exp());
    for frames in [6, 24] {
        assert!((after(frames) - expected).abs() < 1e-9, "{frames}: {} {expected}", after(frames));
    }
}

#[test]
fn scaled_detail_shrinks_with_the_ground_under_it() {
    let (cols, rows) = (65, 49);
    let hierarchy = Hierarchy::new(cols, rows, 9);
    let mut pass = SmoothPass::new(hierarchy.clone(), 0.6, 0.0, &[]).unwrap();
    let heights: Vec<f64> = numbers(9, cols * rows).iter().map(|x| 700.0 + 40.0 * x).collect();
    let u = vec![-10.0; hierarchy.nodes()];
    // Scaled by 1/4 everywhere: detail keeps a quarter.
    let quarter = pass.scaled(&u, &heights, &vec![0.25; cols * rows]);
    let base = hierarchy.prolong(&hierarchy.restrict(&heights));
    for ((d, f), b) in quarter.iter().zip(&heights).zip(&base) {
        assert!((d - (-10.0 - 0.75 * (f - b))).abs() < 1e-9);
    }
    // Nothing scaled: detail is plain.
    let whole = pass.scaled(&u, &heights, &vec![1.0; cols * rows]);
    assert!(apart(&whole, &pass.plain(&u)) == 0.0);
}

#[test]
fn the_coarse_solution_is_near_the_full_one_where_the_change_is_wide() {
    // 8 does not divide 98 x 74.
    let (cols, rows) = (99, 75);
    let bump = |i: usize| {
        let (x, y) = ((i % cols) as f64 - 50.0, (i / cols) as f64 - 40.0);
        -100.0 * (-(x * x + y * y) / 600.0).exp()
    };
    let naive: Vec<f64> = (0..cols * rows).map(bump).collect();
    let run = |nodes| {
        let mut pass = SmoothPass::new(Hierarchy::new(cols, rows, nodes), 0.6, 0.0, &[]).unwrap();
        let found = pass.run(&naive, None, None);
        pass.plain(&found.u)
    };
    let (coarse, full) = (run(14), run(99));
    let rms = (coarse.iter().zip(&full).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / coarse.len() as f64).sqrt();
    assert!(rms < 2.0, "{rms}");
}
