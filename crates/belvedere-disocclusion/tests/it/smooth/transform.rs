//! Cosine transforms, H^-1 and its Green's function.

use belvedere_disocclusion::error::SmoothError;
use belvedere_disocclusion::internals::{Between, Green, Smoother, grid_weight, laplacian};

use super::support::{apart, dense_h, laplacian_rows, numbers};

const SIZES: [(usize, usize); 9] = [(1, 1), (2, 1), (1, 3), (2, 2), (5, 4), (7, 9), (8, 16), (17, 23), (40, 13)];

/// With small and large prime factors.
const LARGER: [(usize, usize); 5] = [(131, 97), (205, 210), (260, 17), (1, 1025), (197, 67)];

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    for (cols, rows) in LARGER {
        let data = numbers(4, cols * rows);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut x = data.clone();
                Smoother::new(cols, rows, 0.3, 0.1).unwrap().solve(&mut x);
                x
            })
        };
        let one = run(1);
        assert!(one == run(2) && one == run(5), "{cols} x {rows}");
    }
}

#[test]
fn the_stencil_is_its_definition_and_a_product_of_cosines_is_an_eigenvector() {
    for (cols, rows) in SIZES {
        let x = numbers(5, cols * rows);
        let mut out = vec![0.0; x.len()];
        laplacian(cols, &x, &mut out);
        let dense: Vec<f64> =
            laplacian_rows(cols, rows).iter().map(|row| row.iter().zip(&x).map(|(a, b)| a * b).sum()).collect();
        assert!(apart(&out, &dense) < 1e-14, "{cols} x {rows}");
        let smoother = Smoother::new(cols, rows, 0.5, 0.0).unwrap();
        let (ex, ey) = smoother.eigenvalues();
        let (k, l) = (cols / 2, rows / 3);
        let cosine =
            |k: usize, i: usize, n: usize| (std::f64::consts::PI * k as f64 * (i as f64 + 0.5) / n as f64).cos();
        let wave: Vec<f64> = (0..x.len()).map(|i| cosine(k, i % cols, cols) * cosine(l, i / cols, rows)).collect();
        laplacian(cols, &wave, &mut out);
        let scaled: Vec<f64> = wave.iter().map(|x| (ex[k] + ey[l]) * x).collect();
        assert!(apart(&scaled, &out) < 1e-12, "{cols} x {rows}");
    }
}

#[test]
fn solving_agrees_with_the_dense_matrix_and_undoes_the_stencil() {
    for (cols, rows) in SIZES {
        for (w, g) in [(0.3, 0.0), (0.6, 1.2), (0.01, 0.0)] {
            let b = numbers(6, cols * rows);
            let mut smoother = Smoother::new(cols, rows, w, g).unwrap();
            let mut x = b.clone();
            smoother.solve(&mut x);
            let dense = dense_h(cols, rows, w * w + g * g).solve(&b);
            let largest = dense.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
            assert!(apart(&x, &dense) < 1e-10 * largest, "{cols} x {rows}, w {w}: {:e}", apart(&x, &dense));
            let (mut work, mut back) = (b.clone(), b.clone());
            smoother.apply(&x, &mut work, &mut back);
            assert!(apart(&back, &b) < 1e-10 * largest);
        }
    }
}

#[test]
fn four_looks_into_the_table_are_an_entry_of_the_inverse() {
    for (cols, rows) in SIZES {
        let n = cols * rows;
        let smoother = Smoother::new(cols, rows, 0.6, 0.0).unwrap();
        let green = Green::new(&smoother);
        let dense = dense_h(cols, rows, smoother.shift());
        for b in [0, n / 3, n / 2, n - 1] {
            let mut unit = vec![0.0; n];
            unit[b] = 1.0;
            let column = dense.solve(&unit);
            let entries: Vec<f64> = (0..n).map(|a| green.entry(a as u32, b as u32)).collect();
            assert!(apart(&column, &entries) < 1e-12, "{cols} x {rows}: {:e}", apart(&column, &entries));
        }
    }
}

#[test]
fn points_between_nodes_are_bilinear_in_the_entries() {
    for (cols, rows) in SIZES {
        let smoother = Smoother::new(cols, rows, 0.6, 0.0).unwrap();
        let green = Green::new(&smoother);
        let xy = numbers(9, 40);
        let point = |k: usize| {
            let cell = |v: f64, n: usize| {
                let at = 0.5 * (v + 1.0) * (n - 1) as f64;
                let first = (at as usize).min(n.saturating_sub(2));
                (first as u32, at - first as f64)
            };
            let ((col, x), (row, y)) = (cell(xy[2 * k], cols), cell(xy[2 * k + 1], rows));
            Between { col, row, x, y }
        };
        let corners = |p: Between| {
            let step = |n: usize| u32::from(n > 1);
            [0, 1, 2, 3].map(|k: u32| {
                let (i, j) = (k % 2, k / 2);
                let hat = |k: u32, x: f64| if k == 1 { x } else { 1.0 - x };
                ((p.row + j * step(rows)) * cols as u32 + p.col + i * step(cols), hat(i, p.x) * hat(j, p.y))
            })
        };
        let nodes = [0, cols * rows - 1, cols * rows / 2].map(|n| Between::node(n as u32, cols, rows));
        let points: Vec<Between> = (0..20).map(point).chain(nodes).collect();
        for a in &points {
            for b in &points {
                let entry =
                    |(i, f): (u32, f64)| corners(*b).map(|(j, g)| f * g * green.entry(i, j)).iter().sum::<f64>();
                let expected: f64 = corners(*a).map(entry).iter().sum();
                let found = green.between(*a, *b);
                assert!((found - expected).abs() < 1e-13, "{cols} x {rows}, {a:?}, {b:?}: {found} and {expected}");
            }
        }
    }
}

#[test]
fn the_weight_follows_the_square_of_the_spacing() {
    assert_eq!(grid_weight(0.3, 128.0), 0.3);
    assert_eq!(grid_weight(0.3, 1024.0), 0.3 / 64.0);
    // A bump of the same size in metres is damped alike on two grids.
    let gain = |nodes: usize, wave: usize| {
        let smoother = Smoother::new(nodes, 1, grid_weight(0.3, (nodes - 1) as f64), 0.0).unwrap();
        let e = smoother.eigenvalues().0[wave];
        smoother.shift() / (e * e + smoother.shift())
    };
    for wave in [4, 12, 20] {
        assert!((gain(129, wave) - gain(513, wave)).abs() < 0.02, "{wave}");
    }
    assert!(gain(129, 20) < 0.9 && gain(129, 4) > 0.99);
}

#[test]
fn weights_without_a_solution_are_errors() {
    for w in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200] {
        assert!(matches!(Smoother::new(3, 3, w, 0.0), Err(SmoothError::Weight { .. })));
    }
    assert!(matches!(Smoother::new(3, 3, 1.0, -1.0), Err(SmoothError::Temporal { .. })));
}
