//! The smoothing in force, as the report prints it.

use belvedere_core::{DVec2, View};
use belvedere_disocclusion::internals::LONGEST_SMOOTHING_M;
use belvedere_disocclusion::{TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_scene::{Heightfield, NodeState, Progress, Scene};
use belvedere_testkit::synthetic::{camera, line_layer, terrain_layer, trail};

/// Ridges across 33 x 33 nodes, which `stated_m` makes as wide as 129 nodes so far apart.
fn report(stated_m: f64, w: Option<f64>) -> TerrainReport {
    let (n, spacing) = (33, 4.0 * stated_m);
    let height = |i: usize| (1000.0 + 0.2 * spacing * (0.8 * (i / n) as f64).sin().abs()) as f32;
    let heights = (0..n * n).map(height).collect();
    let north_west = DVec2::new(0.0, (n - 1) as f64 * spacing);
    let states = vec![NodeState::Measured; n * n];
    let hf = Heightfield::new(north_west, DVec2::splat(spacing), n, n, heights, states).unwrap();
    let way = trail(&hf);
    let scene = Scene { layers: vec![terrain_layer(hf), line_layer("trail", way)], ..Scene::default() };
    let view = View::straight(camera(&scene, 0.3 * spacing, [320, 180]));
    let solver = TerrainSolver::new(TerrainSettings { w, show: Some(1.0), ..TerrainSettings::default() }).unwrap();
    solver.solve(&scene, &view, &mut TerrainMemory::default(), &Progress::silent()).unwrap().report
}

#[test]
fn the_report_prints_the_smoothness_in_force() {
    let fine = report(240.0, None);
    assert_eq!((fine.w, fine.parameters.w), (0.3, Some(0.3)));
    assert!((fine.smoothing_length_m - 240.0 / 0.3f64.sqrt()).abs() < 1e-9);
    let coarse = report(860.0, None);
    assert!((coarse.smoothing_length_m - LONGEST_SMOOTHING_M).abs() < 1e-9, "{}", coarse.smoothing_length_m);
    assert_eq!(coarse.parameters.w, Some(coarse.w));
    assert!((coarse.w - (860.0 / LONGEST_SMOOTHING_M).powi(2)).abs() < 1e-9);
    let literal = report(860.0, Some(0.3));
    assert_eq!(literal.w, 0.3);
    assert!((literal.smoothing_length_m - 860.0 / 0.3f64.sqrt()).abs() < 1e-9);
    assert!(literal.metrics.rms_m > 0.0 && coarse.metrics.rms_m < literal.metrics.rms_m, "{literal:?}");
    // The solution was made with the weight that is reported.
    let same = report(860.0, Some(coarse.w));
    assert_eq!(same.metrics, coarse.metrics);
}
