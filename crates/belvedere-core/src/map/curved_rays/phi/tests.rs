use super::*;

const PENCIL: ViewpointValues = ViewpointValues { k0: 1.3, a0: -1.1, b0: 0.2, a1: -0.3, b1: 0.7 };

fn hinges() -> [Hinge; 5] {
    [0.2, 1.0, 20.0]
        .map(|m| Hinge::Conic { m })
        .into_iter()
        .chain([Hinge::Bezier { sigma: [0.05, 0.4] }, Hinge::C2])
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

/// The condition that defines a modified ray, as printed at the top of this file.
#[test]
fn conic_phi_satisfies_its_definition() {
    for m in [0.2, 0.7, 1.0, 3.0, 20.0] {
        for i in 1..200 {
            let s = f64::from(i) / 200.0;
            let (a, b) = (3.7 * s, 3.7 * (1.0 - s));
            let phi = conic_phi(m, a, b).phi;
            let q = (phi * (phi - a + b)).sqrt();
            assert!((phi + m * q - a).abs() < 1e-13 * m.max(1.0), "m {m} s {s}");
        }
    }
    let canonical = conic_phi(1.0, 2.0, 3.0).phi;
    assert!((canonical - 4.0 / 5.0).abs() < 1e-15);
}

#[test]
fn derivatives_match_differences() {
    for hinge in hinges() {
        for i in 1..20 {
            let s = f64::from(i) / 20.0;
            let (a, b, h) = (0.3 * s, 0.3 * (1.0 - s), 1e-6);
            let phi = |a: f64, b: f64| hinge.phi(&PENCIL, a, b).unwrap().phi;
            let exact = hinge.phi(&PENCIL, a, b).unwrap();
            assert!((exact.phi_a - (phi(a + h, b) - phi(a - h, b)) / (2.0 * h)).abs() < 1e-7, "{hinge:?} {s}");
            assert!((exact.phi_b - (phi(a, b + h) - phi(a, b - h)) / (2.0 * h)).abs() < 1e-7, "{hinge:?} {s}");
        }
    }
}

#[test]
fn phi_of_the_displaced_point_is_phi_of_the_point() {
    for hinge in hinges().into_iter().chain([Hinge::Broken]) {
        for i in 0..=40 {
            let s = (f64::from(i) / 40.0).clamp(1e-12, 1.0 - 1e-12);
            let (a, b) = (0.3 * s, 0.3 * (1.0 - s));
            let phi = hinge.phi(&PENCIL, a, b).unwrap().phi;
            let (alpha, beta) = (a + phi * (PENCIL.a1 - PENCIL.a0), b + phi * (PENCIL.b1 - PENCIL.b0));
            let b_far = alpha - (alpha - beta) / PENCIL.k0 * PENCIL.p();
            let again = hinge.phi_of_displaced(&PENCIL, alpha, b_far).unwrap();
            assert!((again - phi).abs() < 2e-15, "{hinge:?} s {s}: {again} instead of {phi}");
        }
    }
}
