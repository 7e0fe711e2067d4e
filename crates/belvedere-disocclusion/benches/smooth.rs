//! The smooth pass: cosine solves, elevation rows, and what a coarser grid saves.
#![allow(missing_docs)]

use belvedere_core::DVec2;
use belvedere_disocclusion::internals::{
    Cholesky, ConjugateGradients, ElevationRows, Hierarchy, SmoothPass, Smoother, grid_weight,
};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

/// Reproducible numbers in 0..1.
fn number(i: usize) -> f64 {
    (i as f64 * 0.618_033_988_749_895).fract()
}

fn solves(c: &mut Criterion) {
    let mut group = c.benchmark_group("solve");
    for n in [65, 129, 257, 513, 1025] {
        let mut smoother = Smoother::new(n, n, grid_weight(0.6, (n - 1) as f64), 0.0).expect("in range");
        let mut x: Vec<f64> = (0..n * n).map(number).collect();
        group.bench_function(BenchmarkId::from_parameter(n), |b| b.iter(|| smoother.solve(&mut x)));
    }
    group.finish();
}

/// 1350 rows on 129 x 129 nodes: from nothing to 1e-6, and from the last frame's solution to 1e-4.
fn elevation(c: &mut Criterion) {
    let hierarchy = Hierarchy::new(1025, 1025, 129);
    let points = (0..1350).map(|i| DVec2::new(number(i), number(7 * i + 3)) * 1024.0);
    let rows = ElevationRows::new(&hierarchy, points, 1.0);
    let mut smoother = Smoother::new(129, 129, 0.6, 1.2).expect("in range");
    let rhs = |k: f64| {
        let mut b: Vec<f64> = (0..129 * 129).map(|i| -360.0 * number(i)).collect();
        rows.add_wanted(|i| -200.0 * number(i) * k, &mut b);
        b
    };
    let (first, second) = (rhs(1.0), rhs(1.02));
    let mut cg = ConjugateGradients::default();
    let mut last = vec![0.0; first.len()];
    cg.solve(&mut smoother, &rows, &first, &mut last, 1e-6, 60);
    let mut x = last.clone();
    c.bench_function("elevation rows, cold", |b| {
        b.iter(|| {
            x.fill(0.0);
            cg.solve(&mut smoother, &rows, &first, &mut x, 1e-6, 60)
        });
    });
    c.bench_function("elevation rows, warm", |b| {
        b.iter(|| {
            x.copy_from_slice(&last);
            cg.solve(&mut smoother, &rows, &second, &mut x, 1e-4, 60)
        });
    });
}

/// The paper's way at its size: a factor, and a solution with it.
fn sparse(c: &mut Criterion) {
    let n = 129;
    let rows = ElevationRows::default();
    let make = || Cholesky::new(n, n, 0.36, &rows).expect("positive definite");
    let mut group = c.benchmark_group("sparse factor of 129 x 129");
    group.sample_size(10);
    group.bench_function("make", |b| b.iter(make));
    let mut factor = make();
    let mut x: Vec<f64> = (0..n * n).map(number).collect();
    group.bench_function("solve", |b| b.iter(|| factor.solve(&mut x)));
    group.finish();
}

/// The whole pass over 1025 x 1025 nodes with `solver_nodes` 65, 129 and all.
fn pass(c: &mut Criterion) {
    let n = 1025;
    let naive: Vec<f64> = (0..n * n).map(|i| -100.0 * number(i)).collect();
    let mut group = c.benchmark_group("pass over 1025, solver nodes");
    group.sample_size(10);
    for nodes in [65, 129, n] {
        let mut pass = SmoothPass::new(Hierarchy::new(n, n, nodes), 0.6, 0.0, &[]).expect("in range");
        group.bench_function(BenchmarkId::from_parameter(nodes), |b| {
            b.iter(|| {
                let found = pass.run(&naive, None, None);
                pass.plain(&found.u)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, solves, elevation, sparse, pass);
criterion_main!(benches);
