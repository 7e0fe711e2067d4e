use super::*;

/// Cost of a picture, milliseconds.
type Cost = fn(Quality) -> f64;

/// Costs of several kinds, each within the target at the least quality.
const COSTS: [(&str, Cost); 7] = [
    ("cheap", |_| 3.0),
    ("pixels", |q| 120.0 * q.pixels()),
    ("many pixels", |q| 500.0 * q.pixels()),
    ("detail", |q| [400.0, 90.0, 25.0, 6.0][q.coarseness as usize]),
    ("both", |q| 60.0 * q.pixels() + [900.0, 200.0, 50.0, 12.0][q.coarseness as usize] * q.width()),
    ("constant", |q| 14.0 + 90.0 * q.pixels()),
    ("all", |q| (10.0 + 300.0 * q.pixels()) * [2.0, 1.5, 1.2, 1.0][q.coarseness as usize]),
];

/// Times and qualities of pictures.
fn drawn(rate: &mut Rate, pictures: usize, cost: impl Fn(Quality) -> f64) -> Vec<(f64, Quality)> {
    let mut draw = |_| {
        let quality = rate.quality();
        rate.note(cost(quality));
        (cost(quality), quality)
    };
    (0..pictures).map(&mut draw).collect()
}

fn changes(pictures: &[(f64, Quality)]) -> usize {
    pictures.windows(2).filter(|pair| pair[0].1 != pair[1].1).count()
}

#[test]
fn pictures_are_in_time_after_a_few_and_the_quality_settles() {
    for (name, cost) in COSTS {
        let all = drawn(&mut Rate::default(), 400, cost);
        let late = all.iter().filter(|(ms, _)| *ms > LATE_MS).count();
        assert!(late <= 10, "{name}: {late} late pictures");
        let (ms, quality) = all[399];
        assert!(ms <= LATE_MS, "{name}: {ms} ms at {quality:?}");
        assert!(changes(&all[60..280]) == 0, "{name}: the quality swings");
        let better = Quality { narrowing: quality.narrowing.saturating_sub(2), ..quality };
        assert!(better == quality || cost(better) > EARLY_MS, "{name}: {quality:?} is worse than needed");
    }
}

#[test]
fn a_scene_that_costs_ten_times_as_much_at_once_is_drawn_in_time_soon() {
    for (name, cost) in COSTS {
        let mut rate = Rate::default();
        drawn(&mut rate, 200, |q| 0.3 * cost(q));
        let after = drawn(&mut rate, 200, |q| 3.0 * cost(q));
        let possible = 3.0 * cost(Quality::LEAST) <= LATE_MS;
        let soon = after.iter().position(|(ms, _)| *ms <= LATE_MS);
        assert!(!possible || soon.is_some_and(|n| n <= 6), "{name}: {soon:?} of {:?}", &after[..8]);
        assert!(changes(&after[80..]) == 0, "{name}: the quality swings");
    }
}

#[test]
fn what_nothing_makes_faster_is_drawn_with_the_least_quality_and_one_slow_picture_is_overcome() {
    let all = drawn(&mut Rate::default(), 60, |_| 90.0);
    assert_eq!((all[59].1, changes(&all[20..])), (Quality::LEAST, 0));
    let mut rate = Rate::default();
    let before = drawn(&mut rate, 100, |_| 3.0)[99].1;
    assert_eq!(before, Quality::FULL);
    rate.note(400.0);
    assert!(rate.quality().width() < 0.9);
    // The pixels are back soon, the detail once the slow picture is forgotten.
    let after = drawn(&mut rate, FRESH as usize + 20, |_| 3.0);
    assert!(after[20].1.width() == 1.0 && after[20].1.coarseness <= 2, "{:?}", after[20]);
    assert_eq!(after.last().map(|(_, quality)| *quality), Some(Quality::FULL));
    rate.broken_off(66.0);
    assert!(rate.quality() != Quality::FULL, "what was broken off was late");
}

#[test]
fn sizes_are_shares_of_the_screen() {
    assert_eq!(Quality::FULL.size([1280, 720]), [1280, 720]);
    let [w, h] = Quality::LEAST.size([1280, 720]);
    assert!((0.2..0.22).contains(&(f64::from(w) / 1280.0)) && (150..155).contains(&h));
    assert_eq!(Quality::LEAST.size([20, 20]), [16, 16]);
}
