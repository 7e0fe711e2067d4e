//! Grid cells of hundreds of metres: points that the program counts as seen are seen on the drawn ground, or are listed as hidden.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::report::{UnresolvedReason, UnresolvedRun};
use belvedere_disocclusion::{Detail, SolverMode, TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_scene::{Heightfield, NodeState, Progress, Scene};
use belvedere_testkit::Random;
use belvedere_testkit::synthetic::{line_layer, terrain_layer};

/// Ridges of 1200 m on 97 x 97 nodes 300 m apart, every node up to 120 m off; a path across.
fn scene() -> Scene {
    let n = 97usize;
    let mut random = Random::new(31);
    let height = |i: usize, random: &mut Random| {
        let (x, y) = ((i % n) as f64, (i / n) as f64);
        let ridges = (0.31 * x + (0.2 * y).sin()).sin().abs() + (0.27 * y + (0.15 * x).cos()).sin().abs();
        (1000.0 + 600.0 * ridges + random.range(-120.0, 120.0)) as f32
    };
    let heights = (0..n * n).map(|i| height(i, &mut random)).collect();
    let states = vec![NodeState::Measured; n * n];
    let size = (n - 1) as f64 * 300.0;
    let hf = Heightfield::new(DVec2::new(0.0, size), DVec2::splat(300.0), n, n, heights, states).unwrap();
    let at = |t: f64| DVec2::new(size * (0.15 + 0.7 * t), size * (0.5 + 0.2 * (7.0 * t).sin()));
    let way = (0..=200).map(|i| at(f64::from(i) / 200.0)).map(|xy| xy.extend(hf.surface_at(xy).unwrap())).collect();
    Scene { layers: vec![terrain_layer(hf), line_layer("way", way)], ..Scene::default() }
}

fn report(scene: &Scene, eye: [f64; 3], settings: &TerrainSettings) -> TerrainReport {
    let hf = scene.terrain().unwrap();
    let eye = DVec3::from(eye);
    let eye = eye.truncate().extend(hf.surface_at(eye.truncate()).unwrap() + eye.z);
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    let pinhole =
        Pinhole::look_at(eye, DVec3::new(14_400.0, 14_400.0, 1500.0), DVec3::Z, lens, [640, 480], 1.0, None).unwrap();
    let solver = TerrainSolver::new(settings.clone()).unwrap();
    solver.solve(scene, &View::straight(pinhole), &mut TerrainMemory::default(), &Progress::silent()).unwrap().report
}

const EYES: [[f64; 3]; 4] =
    [[3000.0, 6000.0, 500.0], [25_000.0, 5000.0, 700.0], [14_000.0, 2500.0, 400.0], [22_000.0, 26_000.0, 900.0]];

#[test]
fn scaled_detail_hides_nothing_that_the_program_holds_for_seen() {
    let scene = scene();
    let mode = SolverMode::PaperQp;
    for detail in [Detail::Scaled, Detail::Plain] {
        let settings = TerrainSettings {
            mode,
            detail: Some(detail),
            solver_nodes: 33,
            cells: Some(12),
            limits: false,
            ..TerrainSettings::default()
        };
        for eye in EYES {
            let report = report(&scene, eye, &settings);
            assert!(report.visible_before < 0.9, "{eye:?} {report:?}");
            let m = &report.metrics;
            assert!(m.visible_dense + m.hidden_in_guard > 0.98, "{eye:?} {detail:?} {report:?}");
            assert!(detail == Detail::Scaled || m.visible == 1.0, "{eye:?} {report:?}");
            let judged = |r: &UnresolvedRun| matches!(r.reason, UnresolvedReason::Judged { .. });
            assert!(report.unresolved.iter().all(judged), "{eye:?} {detail:?} {:?}", report.unresolved);
        }
    }
}

#[test]
fn what_the_judge_finds_hidden_is_named() {
    let scene = scene();
    let (mut between, mut inside, mut smoothed) = (0, 0, 0);
    for mode in [SolverMode::Paper, SolverMode::PaperQp, SolverMode::Qp] {
        let settings =
            TerrainSettings { mode, solver_nodes: 33, cells: Some(12), limits: false, ..TerrainSettings::default() };
        for eye in EYES {
            let report = report(&scene, eye, &settings);
            let named: usize = report
                .unresolved
                .iter()
                .filter(|r| r.reason != UnresolvedReason::NearerThanGuard)
                .map(|r| r.points)
                .sum();
            let hidden = (1.0 - report.metrics.visible) * report.points as f64;
            assert!(named as f64 >= hidden.round(), "{mode:?} {eye:?}: {named} of {hidden}");
            let mut of_length = [0usize; 2];
            for run in &report.hidden {
                match run.reason {
                    UnresolvedReason::InsideGuard { .. } => of_length[1] += run.points,
                    _ => of_length[0] += run.points,
                }
                match run.reason {
                    UnresolvedReason::Between { over_m } => between += usize::from(over_m > 0.0),
                    UnresolvedReason::InsideGuard { over_m } => inside += usize::from(over_m > 0.0),
                    UnresolvedReason::Smoothed { over_m } => smoothed += usize::from(over_m > 0.0),
                    reason => panic!("{reason:?}"),
                }
            }
            let m = &report.metrics;
            let shares = [1.0 - m.visible_dense - m.hidden_in_guard, m.hidden_in_guard];
            // Crossings with the mesh stand for no length, but lie everywhere.
            let [a, b] = of_length.map(|n| n as f64);
            let off = (a * shares[1] - b * shares[0]).abs();
            assert!(off < 0.1 * (a + b + 10.0) * (shares[0] + shares[1] + 1e-3), "{of_length:?} {shares:?}");
            assert!(!report.hidden.is_empty() || m.visible_dense == 1.0, "{shares:?}");
        }
    }
    assert!(inside > 0 && smoothed > 0 && between <= inside + smoothed, "{between} {inside} {smoothed}");
}
