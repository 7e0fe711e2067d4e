use super::*;

fn letters(width: f64) -> Letters {
    Letters { width, size_px: 12.0, gap: 4.0 }
}

#[test]
fn baselines_stay_beside_their_line_and_read_from_left_to_right() {
    // From right to left, in a gentle bow.
    let bow: Vec<DVec2> =
        (0..600).map(|i| DVec2::new(600.0 - f64::from(i), 300.0 + 80.0 * (f64::from(i) * 0.006).sin())).collect();
    let found = baselines(&bow, letters(120.0), None);
    assert!(found.len() >= 4, "{} baselines", found.len());
    for baseline in &found {
        let baseline = &baseline.points;
        assert!(baseline.windows(2).all(|pair| pair[1].x > pair[0].x));
        for share in [-DESCENT, ASCENT] {
            let lifted = baseline.iter().map(|p| *p - DVec2::Y * share * 12.0);
            let nearest = lifted.flat_map(|p| bow.iter().map(move |q| p.distance(*q))).fold(f64::INFINITY, f64::min);
            assert!(nearest > 2.5, "{nearest} px from the line");
        }
    }
    // The first is above the line.
    assert!(found[0].upper && found[0].points.iter().all(|p| bow.iter().any(|q| q.y > p.y && (q.x - p.x).abs() < 8.0)));
}

#[test]
fn a_held_middle_and_side_come_first_and_stay_within_the_line() {
    let line: Vec<DVec2> = (0..500).map(|i| DVec2::new(f64::from(i), 100.0)).collect();
    let first = |middle: f64, upper: bool| baselines(&line, letters(120.0), Some((middle, upper))).swap_remove(0);
    let held = first(0.62, false);
    assert!(!held.upper && (held.middle - 0.62).abs() < 0.01, "{}", held.middle);
    assert!(held.points.iter().all(|p| p.y > 100.0));
    // A line that begins a little later carries it at the same place.
    let (share, later) = ((0.62 * 499.0 - 1.3) / 497.7, [&[DVec2::new(1.3, 100.0)], &line[2..]].concat());
    let again = baselines(&later, letters(120.0), Some((share, false))).swap_remove(0);
    assert!(held.points.iter().zip(&again.points).all(|(a, b)| a.distance(*b) < 1e-6));
    let last = first(1.0, true);
    assert!(last.upper && (0.8..0.9).contains(&last.middle), "{}", last.middle);
    assert_eq!(baselines(&line, letters(120.0), None)[0].middle, 0.5);
}

#[test]
fn short_steep_and_winding_lines_have_none() {
    let line = |f: fn(f64) -> [f64; 2]| (0..400).map(|i| DVec2::from_array(f(f64::from(i)))).collect::<Vec<_>>();
    assert!(baselines(&line(|i| [0.1 * i, 0.0]), letters(120.0), None).is_empty());
    assert!(baselines(&line(|i| [50.0, i]), letters(120.0), None).is_empty());
    assert!(
        baselines(&line(|i| [200.0 + 30.0 * (i * 0.03).cos(), 200.0 + 30.0 * (i * 0.03).sin()]), letters(120.0), None)
            .is_empty()
    );
    assert!(baselines(&[], letters(5.0), None).is_empty() && baselines(&[DVec2::ONE], letters(5.0), None).is_empty());
    assert!(baselines(&line(|i| [i, 0.0]), letters(f64::NAN), None).is_empty());
}
