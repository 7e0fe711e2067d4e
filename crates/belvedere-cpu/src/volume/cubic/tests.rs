use super::*;

#[test]
fn parts_inside_a_box_end_at_its_faces() {
    // Through a corner region of the box: in, out, in, out.
    let curve = Cubic([
        DVec3::new(-1.0, 1.0, 5.0),
        DVec3::new(12.0, 0.0, 0.0),
        DVec3::new(0.0, -12.0, 0.0),
        DVec3::new(0.0, 12.0, 0.0),
    ]);
    let most = DVec3::splat(10.0);
    let mut parts = Vec::new();
    curve.inside(most, |part| parts.push(part));
    assert_eq!(parts.len(), 2, "{parts:?}");
    let inside = |p: DVec3| p.cmpge(DVec3::ZERO).all() && p.cmple(most).all();
    let mut wrong = 0;
    for i in 0..10_000 {
        let t = (f64::from(i) + 0.5) / 1e4;
        wrong += u32::from(inside(curve.at(t)) != parts.iter().any(|p| p[0] <= t && t <= p[1]));
    }
    assert_eq!(wrong, 0);
    let part = curve.part(parts[1]);
    assert!(part.at(0.25).distance(curve.at(parts[1][0] + 0.25 * (parts[1][1] - parts[1][0]))) < 1e-12);
    curve.inside(DVec3::new(10.0, 10.0, 4.0), |part| panic!("outside: {part:?}"));
}

#[test]
fn parts_of_curves_that_do_not_turn_round_are_those_found_by_all_crossings() {
    let most = DVec3::new(10.0, 8.0, 6.0);
    let mut state = 5u32;
    let mut share = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let (mut found, mut cut) = (0, 0);
    for _ in 0..20_000 {
        let mut vector = |least: f64, most: f64| DVec3::from_array([0; 3].map(|_| least + (most - least) * share()));
        let c0 = vector(-8.0, 16.0);
        let curve = Cubic([c0, vector(-14.0, 14.0), vector(-1.5, 1.5), vector(-0.5, 0.5)]);
        let hull = curve.hull();
        let bounds = hull.iter().fold([hull[0]; 2], |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
        let Some([t0, t1]) = curve.inside_one_way(most, bounds) else { continue };
        let inside = |t: f64| {
            let p = curve.at(t);
            p.cmpge(DVec3::ZERO).all() && p.cmple(most).all()
        };
        for i in 0..50 {
            let t = (f64::from(i) + 0.5) / 50.0;
            let near_end = (t - t0).abs() < 1e-7 || (t - t1).abs() < 1e-7;
            assert!(near_end || inside(t) == (t0 <= t && t <= t1), "{curve:?} {t} {t0} {t1}");
        }
        found += u32::from(t0 < t1);
        cut += u32::from(t0 > 0.0 && t0 < t1);
    }
    assert!(found > 1000 && cut > 500, "{found} {cut}");
}

#[test]
fn hermite_curves_have_the_ends_asked_for() {
    let ends = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 9.0)];
    let slopes = [DVec3::new(0.3, 7.0, 1.0), DVec3::new(2.0, 2.0, -5.0)];
    let curve = Cubic::hermite(ends, slopes);
    let slope = |t: f64| (curve.at(t + 1e-6) - curve.at(t - 1e-6)) / 2e-6;
    for k in 0..2 {
        assert!(curve.at(k as f64).distance(ends[k]) < 1e-12 && slope(k as f64).distance(slopes[k]) < 1e-6);
    }
}
