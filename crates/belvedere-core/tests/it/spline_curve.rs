//! B-splines and arc length against slow reference implementations.

use belvedere_core::DVec2;
use belvedere_core::bspline::{BSpline, BSplineError};
use belvedere_core::deformation::DeformationCurve;
use belvedere_core::presets::PresetDocument;
use belvedere_testkit::Random;

/// Point of a clamped cubic B-spline by the recursion of Cox and de Boor, term by term.
pub(crate) fn by_basis(control: &[DVec2], knots: &[f64], t: f64) -> DVec2 {
    fn basis(i: usize, degree: usize, knots: &[f64], t: f64) -> f64 {
        if degree == 0 {
            let closed = t == 1.0 && knots[i + 1] == 1.0 && knots[i] < 1.0;
            return if (knots[i] <= t && t < knots[i + 1]) || closed { 1.0 } else { 0.0 };
        }
        let part = |num: f64, den: f64| if den > 0.0 { num / den } else { 0.0 };
        let up = part(t - knots[i], knots[i + degree] - knots[i]);
        let down = part(knots[i + degree + 1] - t, knots[i + degree + 1] - knots[i + 1]);
        up * basis(i, degree - 1, knots, t) + down * basis(i + 1, degree - 1, knots, t)
    }
    control.iter().enumerate().map(|(i, &p)| basis(i, 3, knots, t) * p).sum()
}

fn points(list: &[[f64; 2]]) -> Vec<DVec2> {
    list.iter().map(|&p| DVec2::from(p)).collect()
}

/// Curves of all built-in documents and a few harder ones.
pub(crate) fn curves() -> Vec<(String, BSpline)> {
    let mut curves: Vec<(String, BSpline)> = Vec::new();
    for name in ["progressive", "degressive", "hybrid-flat-steep-flat", "hybrid-steep-flat-steep", "map"] {
        let document = PresetDocument::builtin(name).unwrap();
        curves.push((name.to_owned(), document.presets[0].spline().unwrap()));
    }
    let mut add = |name: &str, control: &[[f64; 2]]| {
        curves.push((name.to_owned(), BSpline::clamped_uniform(points(control)).unwrap()));
    };
    add("five points", &[[0.0, 0.0], [0.1, 0.4], [0.5, -0.3], [0.8, 0.2], [1.0, 0.0]]);
    add(
        "eight points",
        &[[0.0, 0.0], [0.1, 0.1], [0.2, 0.2], [0.3, 0.3], [0.7, 0.3], [0.8, 0.3], [0.9, 0.3], [1.0, 0.3]],
    );
    add("doubled first point", &[[0.0, 0.0], [0.0, 0.0], [0.4, 0.3], [1.0, 0.2]]);
    add("tripled first point", &[[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [1.0, 0.2]]);
    add("tripled inner point", &[[0.0, 0.0], [0.3, 0.0], [0.5, 0.1], [0.5, 0.1], [0.5, 0.1], [0.8, 0.6], [1.0, 1.0]]);
    add("almost a cusp", &[[0.0, 0.0], [1.0, 0.5001], [0.0, 0.5], [1.0, 0.0]]);
    let knots = vec![2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 7.0, 7.0, 7.0, 7.0];
    let control = points(&[[0.0, 0.0], [0.2, 0.3], [0.3, 0.1], [0.6, 0.2], [0.8, 0.5], [1.0, 0.4]]);
    curves.push(("double knot".to_owned(), BSpline::with_knots(control, knots).unwrap()));
    curves
}

#[test]
fn points_agree_with_the_basis_functions() {
    for (name, curve) in curves() {
        for i in 0..=1000 {
            let t = f64::from(i) / 1000.0;
            let error = (curve.point(t) - by_basis(curve.control(), curve.knots(), t)).length();
            assert!(error < 1e-15, "{name} at {t}: {error:e}");
        }
    }
}

#[test]
fn derivatives_agree_with_differences() {
    let h = 1e-5;
    for (name, curve) in curves() {
        for order in 0..3 {
            for i in 1..100 {
                // An irrational step keeps away from the knots.
                let t = f64::from(i) * 0.0099 + 0.000_123;
                if curve.knots().iter().any(|k| (k - t).abs() < 2.0 * h) {
                    continue;
                }
                let slope = (curve.derivative(order, t + h) - curve.derivative(order, t - h)) / (2.0 * h);
                let error = (curve.derivative(order + 1, t) - slope).length();
                assert!(error < 3e-7, "{name}: derivative {} at {t} off by {error:e}", order + 1);
            }
        }
        assert_eq!(curve.derivative(4, 0.5), DVec2::ZERO);
    }
}

#[test]
fn knot_insertion_and_unification_keep_the_shape() {
    let mut random = Random::new(11);
    let all = curves();
    for (name, curve) in &all {
        let mut refined = curve.clone();
        for _ in 0..6 {
            refined = refined.with_knot_inserted(random.unit());
        }
        assert_eq!(refined.control().len(), curve.control().len() + 6);
        for i in 0..=500 {
            let t = f64::from(i) / 500.0;
            let error = (refined.point(t) - curve.point(t)).length();
            assert!(error < 2e-15, "{name} at {t}: {error:e}");
        }
    }
    for (a_name, a) in &all {
        for (b_name, b) in &all {
            let (a1, b1) = BSpline::unified(a, b);
            assert_eq!(a1.knots(), b1.knots(), "{a_name}, {b_name}");
            let between = BSpline::lerp(a, b, 0.3);
            for i in 0..=100 {
                let t = f64::from(i) / 100.0;
                let error = (a1.point(t) - a.point(t)).length() + (b1.point(t) - b.point(t)).length();
                assert!(error < 2e-15, "{a_name}, {b_name} at {t}: {error:e}");
                let error = (between.point(t) - a.point(t).lerp(b.point(t), 0.3)).length();
                assert!(error < 2e-15, "{a_name} to {b_name} at {t}: {error:e}");
            }
        }
    }
}

#[test]
fn four_points_refined_to_six_match_the_measured_error() {
    let four = BSpline::clamped_uniform(points(&[[0.0, -0.42], [0.17, -0.08], [0.42, 0.03], [1.0, 0.2]])).unwrap();
    let six = four.with_knot_inserted(1.0 / 3.0).with_knot_inserted(2.0 / 3.0);
    let worst = (0..=1000).map(|i| f64::from(i) / 1000.0).map(|t| (six.point(t) - four.point(t)).length());
    assert!(worst.fold(0.0, f64::max) <= 4.5e-16);
}

/// Arc lengths of `samples` equidistant parameters by Simpson's rule on the speed.
pub(crate) fn dense_lengths(curve: &BSpline, samples: usize) -> Vec<f64> {
    let speed = |i: f64| curve.derivative(1, i / samples as f64).length();
    let (mut lengths, mut sum, mut lost) = (vec![0.0], 0.0, 0.0);
    for i in 0..samples {
        let i = i as f64;
        let piece = (speed(i) + 4.0 * speed(i + 0.5) + speed(i + 1.0 - 1e-9)) / (6.0 * samples as f64);
        // Compensated summation: the rounding errors of this many sums would fail the test.
        let before: f64 = sum;
        sum += piece - lost;
        lost = (sum - before) - (piece - lost);
        lengths.push(sum);
    }
    lengths
}

#[test]
fn arc_length_agrees_with_a_hundred_thousand_samples() {
    for (name, spline) in curves() {
        let samples = 99_990; // so that every knot is a sample
        let lengths = dense_lengths(&spline, samples);
        let curve = DeformationCurve::new(&spline).unwrap();
        // Simpson's rule is of low order where the speed (almost) vanishes.
        let slow = ["tripled", "doubled first", "cusp"].iter().any(|n| name.contains(n));
        let tolerance = if slow { 1e-9 } else { 2e-13 };
        let length = lengths[samples];
        assert!((curve.length() - length).abs() < tolerance, "{name}: length {}, dense {length}", curve.length());
        for i in (0..=samples).step_by(37) {
            let error = (curve.at(lengths[i]).0 - spline.point(i as f64 / samples as f64)).length();
            assert!(error < tolerance, "{name}: point at {} of {length} off by {error:e}", lengths[i]);
        }
    }
}

#[test]
fn tangent_curvature_turning_and_variation_agree_with_dense_sums() {
    for (name, spline) in curves() {
        let curve = DeformationCurve::new(&spline).unwrap();
        if name.contains("tripled") || name.contains("doubled first") || name.contains("cusp") {
            continue; // curvature beyond what samples resolve
        }
        let n = 200_000;
        let (mut turning, mut variation) = (0.0, curve.curvature_at(0.0).abs());
        let mut last = curve.frame_at(0.0);
        for i in 1..=n {
            let l = curve.length() * f64::from(i) / f64::from(n);
            let now = curve.frame_at(l);
            assert!((now.tangent.length() - 1.0).abs() < 1e-15);
            turning += last.tangent.perp_dot(now.tangent).abs();
            variation += (now.kap - last.kap).abs();
            last = now;
            if i % 1000 == 0 {
                let error = (curve.turning_to(l) - turning).abs();
                assert!(error < 1e-6, "{name}: turning to {l} off by {error:e}");
                let error = (curve.curvature_variation_to(l) - variation).abs() / (1.0 + variation);
                assert!(error < 1e-4, "{name}: variation to {l}: {variation}, off by {error:e}");
                let h = 1e-6;
                if !curve.corners().is_empty() || l + h > curve.length() {
                    continue;
                }
                let (ahead, behind) = (curve.at(l + h), curve.at(l - h));
                let slope = (ahead.0 - behind.0) / (2.0 * h);
                assert!((slope - now.tangent).length() < 1e-7 + 1e-10 * now.kap * now.kap, "{name}: tangent at {l}");
            }
        }
        let [low, high] = curve.curvature_range();
        assert!(low <= 0.0 && high >= 0.0 && curve.curvature_at(-1e-9) == 0.0);
        assert!(
            (curve.curvature_variation_to(2.0 * curve.length()) - variation - last.kap.abs()).abs() < 1e-3 * variation
        );
    }
}

#[test]
fn extensions_run_straight_along_the_end_tangents() {
    for (name, spline) in curves() {
        let curve = DeformationCurve::new(&spline).unwrap();
        for (end, sign) in [(0.0, -1.0), (curve.length(), 1.0)] {
            let (p, t) = curve.at(end);
            let (q, u) = curve.at(end + sign * 2.5);
            assert!((q - p - sign * 2.5 * t).length() < 1e-14 && (u - t).length() < 1e-14, "{name}");
        }
    }
}

#[test]
fn curves_stay_finite_and_continuous_where_the_speed_vanishes() {
    for name in ["doubled first point", "tripled first point", "tripled inner point", "almost a cusp"] {
        let spline = curves().into_iter().find(|c| c.0 == name).unwrap().1;
        let curve = DeformationCurve::new(&spline).unwrap();
        assert_eq!(curve.corners().len(), usize::from(name == "tripled inner point"), "{name}: {:?}", curve.corners());
        for l in curve.corners() {
            let turn = curve.at(l - 1e-9).1.angle_to(curve.at(l + 1e-9).1);
            assert!(turn > 0.3 && curve.curvature_range()[1] == f64::INFINITY, "{name}: corner of {turn}");
        }
        let mut last = curve.at(0.0).0;
        for i in 1..=20_000 {
            let l = curve.length() * f64::from(i) / 20_000.0;
            let frame = curve.frame_at(l);
            assert!(frame.point.is_finite() && frame.kap.is_finite() && frame.tangent.is_normalized(), "{name} at {l}");
            let step = (frame.point - last).length() / (curve.length() / 20_000.0);
            assert!(step <= 1.0 + 1e-9, "{name}: step {step} at {l}");
            last = frame.point;
        }
    }
    let back_and_forth = points(&[[0.0, 0.0], [1.5, 0.0], [-0.5, 0.0], [1.0, 0.0]]);
    let curve = DeformationCurve::new(&BSpline::clamped_uniform(back_and_forth).unwrap()).unwrap();
    assert_eq!(curve.corners().len(), 2, "{:?}", curve.corners());
}

#[test]
fn feet_agree_with_a_dense_search() {
    let mut random = Random::new(5);
    for (name, spline) in curves() {
        let curve = DeformationCurve::new(&spline).unwrap();
        let [low, high] = curve.curvature_range();
        if !curve.corners().is_empty() || name.contains("cusp") || name.contains("first") {
            continue;
        }
        for _ in 0..200 {
            let l = random.range(-0.5, 1.5) * curve.length();
            let d = random.range(-0.8, 0.8) / if random.unit() < 0.5 { high.max(0.7) } else { (-low).max(0.7) };
            let frame = curve.frame_at(l);
            let q = frame.point + d * frame.normal();
            let (foot, distance) = curve.foot(q).unwrap();
            let dense = (-2000..=6000).map(|i| f64::from(i) / 2000.0 * curve.length() - 0.5);
            let nearest = dense.map(|l| (q - curve.at(l).0).length()).fold(f64::INFINITY, f64::min);
            assert!(distance.abs() <= nearest + 1e-12, "{name}: foot at {foot}, distance {distance}, dense {nearest}");
            let (p, t) = curve.at(foot);
            assert!((q - p).dot(t).abs() < 1e-14 && ((q - p).dot(t.perp()) - distance).abs() < 1e-14, "{name}");
        }
    }
}

#[test]
fn unusable_control_points_and_knots_are_refused() {
    let four = points(&[[0.0, 0.0], [0.3, 0.1], [0.6, 0.1], [1.0, 0.2]]);
    let with = |knots: &[f64]| BSpline::with_knots(four.clone(), knots.to_vec()).unwrap_err();
    assert_eq!(BSpline::clamped_uniform(four[..3].to_vec()).unwrap_err(), BSplineError::TooFew { count: 3 });
    let mut bad = four.clone();
    bad[2].y = f64::NAN;
    assert!(matches!(BSpline::clamped_uniform(bad).unwrap_err(), BSplineError::NotFinite { index: 2, .. }));
    assert!(matches!(with(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), BSplineError::KnotCount { given: 6, needed: 8, .. }));
    assert!(matches!(with(&[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.5, 1.0]), BSplineError::KnotOrder { index: 6, .. }));
    assert!(matches!(with(&[0.0, 0.0, 0.0, 0.1, 1.0, 1.0, 1.0, 1.0]), BSplineError::NotClamped { .. }));
    assert!(matches!(with(&[0.0; 8]), BSplineError::NotClamped { .. }));
    let five = [four.clone(), vec![DVec2::ONE]].concat();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    assert!(matches!(BSpline::with_knots(five, knots).unwrap_err(), BSplineError::KnotMultiplicity { count: 5, .. }));
    let point = BSpline::clamped_uniform(vec![DVec2::ONE; 4]).unwrap();
    let error = DeformationCurve::new(&point).unwrap_err();
    assert!(error.to_string().contains("1e-9"), "{error}");
}

#[test]
fn hostile_control_points_end_in_a_finite_curve_or_an_error() {
    let mut random = Random::new(99);
    let values = [0.0, 1e-12, -1e-9, 1e-5, 0.3, 0.3, 1.0, -1.0, 1e6];
    for round in 0..150 {
        let count = 4 + random.below(5);
        let control = (0..count).map(|_| DVec2::new(values[random.below(9)], values[random.below(9)])).collect();
        let Ok(curve) = DeformationCurve::new(&BSpline::clamped_uniform(control).unwrap()) else { continue };
        for i in -5..=105 {
            let l = curve.length() * f64::from(i) / 100.0;
            let frame = curve.frame_at(l);
            assert!(frame.point.is_finite() && frame.kap.is_finite(), "round {round}: {frame:?}");
            assert!((frame.tangent.length() - 1.0).abs() < 1e-12, "round {round}: {frame:?}");
            assert!(curve.turning_to(l).is_finite() && curve.curvature_variation_to(l).is_finite());
            if let Some((foot, d)) = curve.foot(frame.point) {
                assert!(foot.is_finite() && d.is_finite(), "round {round}");
            }
        }
    }
    for huge in [1e160, 1e300] {
        let control = points(&[[0.0, 0.0], [huge, 0.0], [huge, huge], [2.0 * huge, 0.0]]);
        assert!(DeformationCurve::new(&BSpline::clamped_uniform(control).unwrap()).is_err());
    }
}

/// The nearest foot by bisection between places half a thousandth of the curve apart: arc length and signed distance.
fn slow_foot(curve: &DeformationCurve, q: DVec2) -> Option<(f64, f64)> {
    let along = |l: f64| {
        let frame = curve.frame_at(l);
        (q - frame.point).dot(frame.tangent)
    };
    let reach = curve.length() + q.length() + curve.at(0.0).0.length();
    let inner = (0..=2000).map(|i| f64::from(i) / 2000.0 * curve.length());
    let places: Vec<f64> = std::iter::once(-reach).chain(inner).chain([curve.length() + reach]).collect();
    let root = |[mut lo, mut hi]: [f64; 2]| {
        for _ in 0..120 {
            let middle = 0.5 * (lo + hi);
            if along(middle) > 0.0 { lo = middle } else { hi = middle }
        }
        let frame = curve.frame_at(hi);
        (hi, (q - frame.point).dot(frame.normal()))
    };
    let falls = |pair: &&[f64]| along(pair[0]) > 0.0 && along(pair[1]) <= 0.0;
    let roots = places.windows(2).filter(falls).map(|pair| root([pair[0], pair[1]]));
    roots.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

#[test]
fn feet_are_those_of_bisection_near_centres_of_curvature_and_beyond_the_ends_too() {
    let mut random = Random::new(77);
    let mut tight = 0;
    for round in 0..60 {
        let mut x = 0.0;
        let mut next = || {
            x += random.range(0.2, 1.0);
            DVec2::new(x, random.range(-0.6, 0.6))
        };
        let control = (0..7).map(|_| next()).collect();
        let curve = DeformationCurve::new(&BSpline::clamped_uniform(control).unwrap()).unwrap();
        for _ in 0..12 {
            let frame = curve.frame_at(random.range(-0.3, 1.3) * curve.length());
            // Up to the centre of curvature, where a foot is no longer the nearest point, and on the other side.
            let share = [random.range(-2.0, 0.9), random.range(0.9, 0.999)][random.below(2)];
            let d = if frame.kap == 0.0 { random.range(-1.0, 1.0) } else { (share / frame.kap).clamp(-3.0, 3.0) };
            let q = frame.point + d * frame.normal();
            let (Some((l, d)), Some((want_l, want_d))) = (curve.foot(q), slow_foot(&curve, q)) else {
                panic!("round {round}: no foot of {q}")
            };
            assert!((d.abs() - want_d.abs()).abs() < 1e-12, "round {round}: {d} for {want_d} from {q}");
            // Two feet may be equally near; near centres of curvature the foot is less certain than its distance.
            let stretch = (1.0 - curve.curvature_at(want_l) * want_d).abs();
            if (d - want_d).abs() < 1e-12 && (l - want_l).abs() < 0.1 * curve.length() {
                assert!((l - want_l).abs() * stretch < 1e-12, "round {round}: {l} for {want_l} from {q}");
                tight += u32::from(stretch < 0.1 && frame.kap != 0.0);
            }
        }
    }
    assert!(tight > 20, "{tight} feet near centres of curvature");
}
