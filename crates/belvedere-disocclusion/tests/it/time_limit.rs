//! Choice of a ground when time is up: it never shows less than the undisplaced ground, and never exceeds the limits.

use belvedere_core::View;
use belvedere_disocclusion::report::Taken;
use belvedere_disocclusion::{Solved, SolverMode, TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere_scene::{Progress, Scene};
use belvedere_testkit::synthetic::{camera, scene};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn hidden_trail(nodes: usize, seed: u64) -> (Scene, View) {
    let scene = scene(nodes, seed);
    let view = View::straight(camera(&scene, 150.0, [640, 360]));
    (scene, view)
}

fn solved(settings: &TerrainSettings, (scene, view): &(Scene, View), progress: &Progress) -> Solved {
    let solver = TerrainSolver::new(settings.clone()).unwrap();
    solver.solve(scene, view, &mut TerrainMemory::default(), progress).unwrap()
}

/// A listener for whom every round of the program takes long, but not those for a sample.
fn slow_rounds() -> Progress {
    let sampling = AtomicBool::new(false);
    Progress::new(move |stage, _| {
        if stage.contains("sample") {
            sampling.store(true, Ordering::Relaxed);
        } else if stage.contains("round") && !sampling.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1500));
        }
    })
}

#[test]
fn what_is_taken_shows_no_less_than_the_ground_before_and_keeps_the_limits() {
    for mode in [SolverMode::Qp, SolverMode::PaperQp] {
        for (seed, milliseconds) in [(3, 0), (4, 1), (3, 5), (5, 20), (6, 80)] {
            let place = hidden_trail(97, seed);
            let settings = TerrainSettings { mode, ..TerrainSettings::default() };
            let progress = Progress::silent().limited(Duration::from_millis(milliseconds));
            let report = solved(&settings, &place, &progress).report;
            let about = format!("{mode:?}, seed {seed}, {milliseconds} ms: {:?}", report.taken);
            let (before, after) = (report.visible_dense_before, report.metrics.visible_dense);
            assert!(after >= before - 1e-9, "{about}: {before} -> {after}");
            assert_eq!(report.taken.is_some(), report.out_of_time, "{about}");
            assert!(!(report.out_of_time && report.guaranteed), "{about}");
            let [low, high] = place.0.terrain().unwrap().z_range();
            assert!(report.metrics.raised_max_m <= 0.5, "{about}: {}", report.metrics.raised_max_m);
            assert!(report.metrics.sunk_below_m <= 0.2 * (high - low) + 1e-3, "{about}");
            if milliseconds == 0 {
                assert!(report.out_of_time, "{about}");
            }
        }
    }
}

#[test]
fn a_sample_of_what_is_asked_is_shown_where_there_is_no_time_for_all() {
    let place = hidden_trail(97, 3);
    let settings = TerrainSettings { show: Some(1.0), ..TerrainSettings::default() };
    let short = solved(&settings, &place, &slow_rounds().limited(Duration::from_secs(2))).report;
    assert!(short.out_of_time && !short.guaranteed);
    let (before, after) = (short.visible_dense_before, short.metrics.visible_dense);
    assert!(after > before + 0.2 * (1.0 - before), "{before} -> {after} by {:?}", short.taken);
    // On a machine that is slow or busy the time is too short for a sample, too.
    if matches!(short.taken, Some(Taken::Sample { .. })) {
        assert!(!short.costliest.is_empty() && short.qp.is_some_and(|qp| qp.active > 0));
    }
    let all = solved(&settings, &place, &Progress::silent()).report;
    assert!(all.taken.is_none() && all.metrics.visible_dense >= after);
}

#[test]
fn out_of_time_the_landscape_stays_like_itself_and_no_more_moves_than_in_the_end() {
    for seed in [3, 5] {
        let (place, settings) = (hidden_trail(97, seed), TerrainSettings::default());
        let short = solved(&settings, &place, &slow_rounds().limited(Duration::from_secs(2))).report;
        let all = solved(&settings, &place, &Progress::silent()).report;
        let strain = short.likeness.expect("a still").strain;
        assert!(short.out_of_time && strain <= 1.0, "seed {seed}: {strain}");
        assert!(
            short.metrics.rms_m <= all.metrics.rms_m,
            "seed {seed}: {} of {}",
            short.metrics.rms_m,
            all.metrics.rms_m
        );
    }
}

#[test]
fn with_time_enough_a_limit_changes_nothing() {
    let place = hidden_trail(65, 4);
    let settings = TerrainSettings::default();
    let free = solved(&settings, &place, &Progress::silent());
    let limited = solved(&settings, &place, &Progress::silent().limited(Duration::from_secs(3600)));
    assert_eq!(free.stage, limited.stage);
    assert_eq!(free.report.metrics, limited.report.metrics);
    assert_eq!(limited.report.judged_every, 1);
}
