//! The price of a bend: whole stretches are given up, and the ground moves no more than is allowed.

use belvedere_core::View;
use belvedere_disocclusion::report::UnresolvedReason;
use belvedere_disocclusion::{DisocclusionError, TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_scene::Progress;
use belvedere_testkit::synthetic;
use std::sync::LazyLock;

fn solved(seed: u64, settings: TerrainSettings) -> TerrainReport {
    let scene = synthetic::scene(97, seed);
    let view = View::straight(synthetic::camera(&scene, 250.0, [640, 400]));
    let solver = TerrainSolver::new(settings).expect("settings");
    solver.solve(&scene, &view, &mut TerrainMemory::default(), &Progress::silent()).expect("a solution").report
}

fn priced(show: Option<f64>, move_at_most_m: Option<f64>) -> TerrainSettings {
    TerrainSettings { show, move_at_most_m, ..TerrainSettings::default() }
}

/// Seeds whose trail is hidden in large part, and what shows all of it.
static SEEDS: LazyLock<Vec<(u64, TerrainReport)>> = LazyLock::new(|| {
    let all = (1..40).map(|seed| (seed, solved(seed, priced(Some(1.0), None))));
    all.filter(|(_, all)| all.visible_dense_before < 0.8 && all.metrics.max_m > 20.0).take(3).collect()
});

#[test]
fn the_ground_moves_no_more_than_is_allowed_and_a_smaller_move_shows_less() {
    let mut tried = 0;
    for (seed, all) in SEEDS.iter() {
        let (mut before, mut shown) = (all.metrics.max_m, all.metrics.visible_dense);
        for part in [0.7, 0.4, 0.1] {
            let most = part * all.metrics.max_m;
            let found = solved(*seed, priced(None, Some(most)));
            let m = &found.metrics;
            assert!(m.max_m <= most * 1.001 && m.max_m < before, "{seed}: {} of {most}", m.max_m);
            assert!(m.visible_dense <= shown + 0.03 && m.rms_m < all.metrics.rms_m, "{seed} {part}: {m:?}");
            // Never less than before anything moved, but for what moved ground hides elsewhere.
            assert!(m.visible_dense >= found.visible_dense_before - 0.02, "{seed} {part}: {m:?}");
            let price = found.price.as_ref().expect("a price");
            assert!(!price.given_up.is_empty() && !found.guaranteed, "{seed} {part}");
            let gave_up =
                |reason: &UnresolvedReason| matches!(reason, UnresolvedReason::GivenUp { over_m } if *over_m > 0.0);
            let (named, others): (Vec<_>, Vec<_>) = found.hidden.iter().partition(|run| gave_up(&run.reason));
            let points =
                |runs: &[&belvedere_disocclusion::report::UnresolvedRun]| runs.iter().map(|r| r.points).sum::<usize>();
            assert!(m.visible_dense > 0.999 || points(&named) > 9 * points(&others), "{seed} {part}: {others:?}");
            (before, shown) = (m.max_m, m.visible_dense);
            tried += 1;
        }
    }
    assert!(tried > 6, "{tried}");
}

#[test]
fn the_dearest_stretches_take_more_of_the_displacement_than_of_the_trail() {
    let (mut least, mut tried) = (1.0f64, 0);
    for (seed, all) in SEEDS.iter() {
        let found = solved(*seed, priced(Some(0.85), None));
        let (m, price) = (&found.metrics, found.price.as_ref().expect("a price"));
        let asked = price.curve.last().expect("a solution").asked;
        assert!((0.85..0.9).contains(&asked) && m.visible_dense > 0.84, "{seed}: {asked}, {m:?}");
        let ratio = m.rms_m / all.metrics.rms_m;
        assert!(ratio < 0.95, "{seed}: {ratio}");
        least = least.min(ratio);
        // The first solution is that for all.
        assert_eq!(price.curve[0].asked, 1.0);
        assert!(price.curve.windows(2).all(|pair| pair[1].asked < pair[0].asked), "{:?}", price.curve);
        tried += 1;
    }
    assert!(tried == 3 && least < 0.8, "{tried}: {least}");
}

#[test]
fn a_price_that_is_not_reached_changes_nothing() {
    let (seed, all) = &SEEDS[0];
    for settings in [priced(None, Some(2.0 * all.metrics.max_m)), priced(Some(1.0), None)] {
        let found = solved(*seed, settings);
        assert_eq!((found.metrics, found.guaranteed), (all.metrics, all.guaranteed));
        assert!(found.price.is_some_and(|price| price.given_up.is_empty()));
    }
    for (settings, key) in [(priced(Some(1.2), None), "show"), (priced(None, Some(0.0)), "move_at_most_m")] {
        let refused = TerrainSolver::new(settings).expect_err("out of range");
        assert!(matches!(refused, DisocclusionError::Setting { key: found, .. } if found == key), "{refused}");
    }
}
