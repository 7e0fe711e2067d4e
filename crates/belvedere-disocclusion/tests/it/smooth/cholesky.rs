//! The paper's method for the smooth pass compared with ours.

use belvedere_core::DVec2;
use belvedere_disocclusion::error::SmoothError;
use belvedere_disocclusion::internals::{Cholesky, ConjugateGradients, ElevationRows, Hierarchy, Smoother};

use super::support::{apart, numbers};

#[test]
fn a_sparse_factor_agrees_with_the_cosine_transform() {
    for (cols, rows, w, g) in [(33, 25, 0.6, 1.2), (24, 41, 0.1, 0.0), (1, 9, 0.3, 0.0), (65, 65, 0.3, 0.0)] {
        let b = numbers(1, cols * rows);
        let mut ours = b.clone();
        let mut smoother = Smoother::new(cols, rows, w, g).unwrap();
        smoother.solve(&mut ours);
        let mut theirs = b.clone();
        Cholesky::new(cols, rows, smoother.shift(), &ElevationRows::default()).unwrap().solve(&mut theirs);
        assert!(apart(&ours, &theirs) < 1e-8, "{cols} x {rows}: {:e}", apart(&ours, &theirs));
        assert!(ours.iter().any(|x| x.abs() > 0.1));
    }
}

#[test]
fn a_sparse_factor_with_elevation_rows_agrees_with_conjugate_gradients() {
    let hierarchy = Hierarchy::new(257, 193, 65);
    let (cols, rows) = (hierarchy.cols(), hierarchy.rows());
    let xy = numbers(2, 400);
    let points = (0..200).map(|k| (DVec2::new(xy[2 * k], xy[2 * k + 1]) + 1.0) * DVec2::new(128.0, 96.0));
    let elevation = ElevationRows::new(&hierarchy, points, 1.0);
    let b = numbers(3, cols * rows);
    let mut smoother = Smoother::new(cols, rows, 0.6, 0.0).unwrap();
    let mut ours = vec![0.0; b.len()];
    ConjugateGradients::default().solve(&mut smoother, &elevation, &b, &mut ours, 1e-12, 200);
    let mut theirs = b.clone();
    Cholesky::new(cols, rows, smoother.shift(), &elevation).unwrap().solve(&mut theirs);
    assert!(apart(&ours, &theirs) < 1e-8, "{:e}", apart(&ours, &theirs));
    let mut without = b;
    smoother.solve(&mut without);
    assert!(apart(&without, &theirs) > 1e-2, "rows change something");
}

#[test]
fn a_matrix_without_a_factor_is_an_error() {
    let found = Cholesky::new(5, 4, -100.0, &ElevationRows::default());
    assert!(matches!(found, Err(SmoothError::NotDefinite { cols: 5, rows: 4, .. })), "{found:?}");
}
