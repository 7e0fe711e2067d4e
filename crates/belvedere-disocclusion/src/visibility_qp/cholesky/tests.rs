use super::*;

#[test]
fn solves_and_regrows() {
    let n = 21;
    let a = |i: usize, j: usize| 1.0 / (1.0 + i.abs_diff(j) as f64) + f64::from(u8::from(i == j));
    let mut factor = Cholesky::default();
    for i in 0..n {
        factor.push((0..i).map(|j| a(i, j)), a(i, i), 0.0);
    }
    factor.truncate(9);
    for i in 9..n {
        factor.push((0..i).map(|j| a(i, j)), a(i, i), 0.0);
    }
    let x: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
    let mut b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a(i, j) * x[j]).sum()).collect();
    factor.solve(&mut b);
    for (x, b) in x.iter().zip(&b) {
        assert!((x - b).abs() < 1e-12, "{x} and {b}");
    }
    assert_eq!(factor.size(), n);
}

#[test]
fn a_factor_without_a_row_is_that_of_the_others() {
    let n = 12;
    let a = |i: usize, j: usize| 1.0 / (1.0 + i.abs_diff(j) as f64) + f64::from(u8::from(i == j));
    let of = |rows: &[usize]| {
        let mut factor = Cholesky::default();
        for (k, &i) in rows.iter().enumerate() {
            factor.push(rows[..k].iter().map(|&j| a(i, j)), a(i, i), 0.0);
        }
        factor
    };
    for gone in [0, 5, n - 1] {
        let mut factor = of(&(0..n).collect::<Vec<_>>());
        factor.remove(gone);
        let expected = of(&(0..n).filter(|i| *i != gone).collect::<Vec<_>>());
        assert_eq!((factor.size(), factor.packed.len()), (n - 1, expected.packed.len()));
        let apart = factor.packed.iter().zip(&expected.packed).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-14, "without {gone}: {apart:e}");
    }
}
