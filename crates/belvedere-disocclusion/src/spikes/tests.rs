use super::*;
use belvedere_core::DVec2;

const SIDE: usize = 60;

fn terrain(spacing: f64, height: impl Fn(f64, f64) -> f64) -> Arc<Heightfield> {
    let heights = (0..SIDE * SIDE).map(|i| height((i % SIDE) as f64, (i / SIDE) as f64) as f32).collect();
    let states = vec![NodeState::Measured; SIDE * SIDE];
    let made = Heightfield::new(DVec2::ZERO, DVec2::splat(spacing), SIDE, SIDE, heights, states);
    Arc::new(made.expect("terrain"))
}

fn hills(x: f64, y: f64) -> f64 {
    let noise = ((x * 12.9898 + y * 78.233).sin() * 43_758.545).fract();
    300.0 * (x * 0.13).sin() * (y * 0.11).cos() + 900.0 + 3.0 * noise
}

#[test]
fn spikes_of_both_signs_are_found_where_they_are_and_nothing_else() {
    assert!(without_spikes(&terrain(30.0, hills)).1.is_empty());
    let at = [((7.0, 9.0), 800.0), ((40.0, 33.0), -600.0), ((0.0, 0.0), 500.0), ((59.0, 20.0), -3000.0)];
    let spiked = |x: f64, y: f64| hills(x, y) + at.iter().find(|(p, _)| *p == (x, y)).map_or(0.0, |(_, h)| *h);
    let spiked = terrain(30.0, spiked);
    let (smooth, spikes) = without_spikes(&spiked);
    let places: Vec<[f64; 2]> = spikes.iter().map(|s| [s.at[0] / 30.0, -s.at[1] / 30.0]).collect();
    assert_eq!(places, [[59.0, 20.0], [7.0, 9.0], [40.0, 33.0], [0.0, 0.0]], "the farthest out first");
    for (i, (h, before)) in smooth.heights().iter().zip(spiked.heights()).enumerate() {
        let (x, y) = ((i % SIDE) as f64, (i / SIDE) as f64);
        match at.iter().any(|(p, _)| *p == (x, y)) {
            true => assert!((f64::from(*h) - hills(x, y)).abs() < 100.0, "{x} {y}: {h}"),
            false => assert_eq!(h, before),
        }
    }
}

#[test]
fn true_summits_are_no_spikes() {
    // A tower with walls of 82 degrees, three samples wide; a sharp cone; a needle no steeper than the cliffs around.
    let tower = |x: f64, y: f64| {
        let wide = (x - 20.0).abs() <= 1.0 && (y - 20.0).abs() <= 1.0;
        hills(x, y) + if wide { 220.0 } else { 0.0 }
    };
    let cone = |x: f64, y: f64| 40.0 * (30.0 - (x - 30.0).hypot(y - 30.0)).max(0.0);
    let cliffs = |x: f64, y: f64| {
        let needle = if (x, y) == (15.0, 15.0) { 250.0 } else { 0.0 };
        hills(x, y) + needle + 240.0 * (x / 6.0).floor()
    };
    assert_eq!(without_spikes(&terrain(30.0, tower)).1, []);
    assert_eq!(without_spikes(&terrain(30.0, cone)).1, []);
    assert_eq!(without_spikes(&terrain(30.0, cliffs)).1, []);
}
