use super::super::super::cells::tests::noise;
use super::*;

fn random(i: usize) -> impl FnMut(f64, f64) -> f64 {
    let mut k = 100 * i;
    move |low, high| {
        k += 1;
        low + (high - low) * noise(k, 77)
    }
}

#[test]
fn lambda_is_the_best_of_4001() {
    let mut inside = 0;
    for i in 0..200 {
        let mut r = random(i);
        let neighbours: Vec<(f64, Affine)> =
            (0..5).map(|_| (0.2, Affine { scale: r(0.3, 1.0), shift: r(-400.0, 0.0) })).collect();
        let cost = BlendCost {
            now: Affine { scale: r(0.3, 1.0), shift: r(-300.0, 0.0) },
            scale: r(0.2, 1.0),
            shift: r(-500.0, 0.0),
            higher_share: r(0.0, 1.0),
            higher_mean: r(100.0, 2000.0),
            mean: r(100.0, 1500.0),
            neighbours: &neighbours,
            eta: r(0.0, 10.0),
            mu: r(0.0, 20.0),
            mu_dev: r(0.1, 20.0),
        };
        let ours = cost.best_lambda();
        let searched = (0..=4000).map(|k| f64::from(k) / 4000.0).min_by(|&x, &y| cost.of(x).total_cmp(&cost.of(y)));
        assert!((ours - searched.unwrap()).abs() <= 0.5 / 4000.0 + 1e-9, "case {i}: {ours} {searched:?}");
        inside += usize::from(ours > 0.0 && ours < 1.0);
    }
    assert!(inside > 50, "only {inside} cases have their best inside");
}

#[test]
fn a_blend_clears_what_scaling_and_displacement_clear() {
    for i in 0..200 {
        let mut r = random(i);
        let now = Affine { scale: r(0.3, 1.0), shift: r(-100.0, 0.0) };
        let h = r(500.0, 1000.0);
        let z = now.of(h);
        let limit = r(1.0, z);
        let (s, d) = (scale_to_clear(limit, z), shift_to_clear(limit, z));
        assert!(s < 1.0 && d < 0.0);
        let cleared = blended(now, s, d, r(0.0, 1.0));
        assert!((cleared.of(h) - limit).abs() < 1e-9, "a single sample ends exactly at the line of sight");
        assert!(cleared.scale <= now.scale && cleared.scale >= 0.0 && cleared.of(h) < z);
    }
}

#[test]
fn nothing_to_weigh_means_displacement() {
    let cost = BlendCost {
        now: Affine::IDENTITY,
        scale: 1.0,
        shift: 0.0,
        higher_share: 0.0,
        higher_mean: 0.0,
        mean: 0.0,
        neighbours: &[],
        eta: 5.0,
        mu: 10.0,
        mu_dev: 10.0,
    };
    assert_eq!(cost.best_lambda(), 0.0);
}
