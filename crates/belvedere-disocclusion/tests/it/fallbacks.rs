//! Fallbacks for rows that contradict each other on the solver's grid, and their report.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::report::{Fallback, UnresolvedReason};
use belvedere_disocclusion::{Solved, TerrainMemory, TerrainReport, TerrainSettings, TerrainSolver};
use belvedere_scene::{
    Color, Heightfield, Hidden, Layer, LayerKind, NodeState, PointFeature, PointLayer, PointStyle, Progress, Scene,
};
use belvedere_testkit::synthetic::{line_layer, terrain_layer};

const SPACING: f64 = 30.0;

/// Ground of `cols` x `rows` nodes with required point features at `points` (grid).
fn scene(cols: usize, rows: usize, height: impl Fn(usize, usize) -> f64, points: &[DVec2]) -> Scene {
    let heights = (0..cols * rows).map(|i| height(i % cols, i / cols) as f32).collect();
    let states = vec![NodeState::Measured; cols * rows];
    let hf = Heightfield::new(DVec2::ZERO, DVec2::splat(SPACING), cols, rows, heights, states).unwrap();
    let place = |g: &DVec2| PointFeature { style: None, name: String::new(), position: at(*g, 0.0) };
    let features = points.iter().map(place).collect();
    let color = Color::rgb(0, 0, 0);
    let (style, hidden) = (PointStyle::default(), Hidden::Fade);
    let kind = LayerKind::Point(PointLayer { features, color, size_px: 3.0, hidden, lift_m: 1.0, style, beyond: 0.0 });
    let huts = Layer { id: "huts".into(), must_see: true, kind };
    Scene { layers: vec![terrain_layer(hf), huts], ..Scene::default() }
}

fn at(grid: DVec2, z: f64) -> DVec3 {
    DVec3::new(grid.x * SPACING, -grid.y * SPACING, z)
}

fn solve(scene: &Scene, eye: DVec3, look: DVec3, settings: &TerrainSettings) -> Solved {
    let lens = Projection::Perspective { fov_y: 60f64.to_radians() };
    let pinhole = Pinhole::look_at(eye, look, DVec3::Z, lens, [640, 480], 1.0, None).unwrap();
    let solver = TerrainSolver::new(settings.clone()).unwrap();
    solver.solve(scene, &View::straight(pinhole), &mut TerrainMemory::default(), &Progress::silent()).unwrap()
}

/// Settings without limits, with posts and pits of one node counted as ground.
fn free() -> TerrainSettings {
    TerrainSettings { limits: false, spikes: true, ..TerrainSettings::default() }
}

fn five_nodes() -> TerrainSettings {
    TerrainSettings { solver_nodes: 5, ..free() }
}

const EYE: DVec2 = DVec2::new(94.0, 16.0);

/// A point feature every `gap` grid cells along row 16 of 97 x 33 nodes, seen from 60 m over the far end of the row.
fn row(gap: usize, offset: f64, height: impl Fn(usize) -> f64) -> Solved {
    let places: Vec<DVec2> = (0..75 / gap).map(|k| DVec2::new((k * gap) as f64 + offset, 16.0)).collect();
    let scene = scene(97, 33, |x, y| if y == 16 { height(x) } else { 0.0 }, &places);
    solve(&scene, at(EYE, 60.0), at(DVec2::new(0.0, 16.0), 0.0), &five_nodes())
}

fn assert_all_seen(report: &TerrainReport) {
    assert!(report.visible_before < 0.1, "{report:?}");
    assert!(report.unresolved.is_empty() && report.guaranteed, "{report:?}");
    assert_eq!((report.metrics.visible, report.metrics.visible_dense), (1.0, 1.0));
}

#[test]
fn a_bump_that_the_grid_cannot_hold_is_cut_down() {
    // A post of one node is right in front of every point: five nodes cannot lower the post and leave the point.
    let solved = row(5, 2.5, |x| if x.is_multiple_of(5) && x < 80 { 60.0 } else { 0.0 });
    assert_eq!(solved.report.fallbacks, [Fallback::Detail]);
    assert_all_seen(&solved.report);
    // The post is cut down, not the plain beside it.
    let sunk = |g: DVec2| -solved.stage.delta_at(at(g, 0.0));
    assert!(sunk(DVec2::new(40.0, 16.0)) > sunk(DVec2::new(42.5, 16.0)) + 20.0);
    assert!(solved.report.metrics.max_m < 70.0 && solved.report.metrics.raised_max_m <= 0.5);
}

#[test]
fn pits_need_a_finer_grid() {
    // No bump rises over the ground that the grid holds, but every point lies at the bottom of a hole.
    let solved = row(6, 3.0, |x| if x % 6 == 3 { -60.0 } else { 0.0 });
    let [Fallback::FinerGrid { nodes }] = solved.report.fallbacks[..] else { panic!("{:?}", solved.report.fallbacks) };
    assert!(nodes > 5 && nodes <= 97, "{nodes}");
    assert_all_seen(&solved.report);
    assert_eq!(solved.report.solver_grid[0], 5, "the grid that frames have in common");
}

#[test]
fn ground_inside_the_guard_is_left_before_a_finer_grid_is_taken() {
    // On the floor of a wide basin, so that it rises over nothing that two nodes hold, a post hides a place less than a cell behind it.
    let height = |x: usize, y: usize| match (x, y) {
        (201, 10) => -40.0,
        (150..250, _) => -100.0,
        _ => 0.0,
    };
    let scene = scene(401, 21, height, &[DVec2::new(200.2, 10.0)]);
    let (eye, look) = (at(DVec2::new(240.0, 10.0), 20.0), at(DVec2::new(200.0, 10.0), -100.0));
    let report = solve(&scene, eye, look, &TerrainSettings { solver_nodes: 2, ..free() }).report;
    assert_eq!(report.fallbacks, [Fallback::Guard], "{report:?}");
    assert_eq!((report.metrics.visible, report.metrics.hidden_in_guard), (0.0, 1.0));
    assert!(!report.guaranteed, "the judge does not agree: {report:?}");
    // A finer grid can show it, and then guarantees it.
    let fine = solve(&scene, eye, look, &free()).report;
    assert!(fine.fallbacks.is_empty() && fine.guaranteed && fine.metrics.hidden_in_guard == 0.0, "{fine:?}");
}

#[test]
fn what_lies_between_two_holes_is_not_counted_among_them() {
    // A path along row 8, over ground without data from column 20 to 25 and from 40 to 43.
    let (cols, rows) = (61, 17);
    let hole = |x: usize| (20..=25).contains(&x) || (40..=43).contains(&x);
    let state = |i: usize| if hole(i % cols) { NodeState::Void } else { NodeState::Measured };
    let states = (0..cols * rows).map(state).collect();
    let spacing = DVec2::splat(SPACING);
    let hf = Heightfield::new(DVec2::ZERO, spacing, cols, rows, vec![0.0; cols * rows], states).unwrap();
    let way = (4..57).map(|x| at(DVec2::new(f64::from(x), 8.0), 0.0)).collect();
    let scene = Scene { layers: vec![terrain_layer(hf), line_layer("way", way)], ..Scene::default() };
    let (eye, look) = (at(DVec2::new(30.0, 60.0), 900.0), at(DVec2::new(30.0, 8.0), 0.0));
    let report = solve(&scene, eye, look, &TerrainSettings::default()).report;
    let runs = &report.unresolved;
    assert!(runs.len() == 2 && runs.iter().all(|r| r.reason == UnresolvedReason::NoData), "{runs:?}");
    for (run, [first, last]) in runs.iter().zip([[19.0, 26.0], [39.0, 44.0]]) {
        // Lengths are counted from column 4 on.
        let [from, to] = [run.from_m, run.to_m].map(|m| 4.0 + m / SPACING);
        assert!(from > first && to < last && from < to, "{from} to {to} of {first} to {last}");
    }
}

#[test]
fn what_no_grid_shows_is_named_with_a_proof() {
    // A hole at every other node of ground with twice as many nodes as the finest grid.
    let places: Vec<DVec2> = (0..20).map(|k| DVec2::new(f64::from(2 * k + 201), 1.0)).collect();
    let scene = scene(1101, 3, |x, _| if x % 2 == 1 { -60.0 } else { 0.0 }, &places);
    let (eye, look) = (at(DVec2::new(300.0, 1.0), 60.0), at(DVec2::new(0.0, 1.0), 0.0));
    let solved = solve(&scene, eye, look, &TerrainSettings { guard: 0.2, ..five_nodes() });
    let report = &solved.report;
    assert!(!report.guaranteed && report.metrics.visible < 0.7, "{report:?}");
    let hidden = ((1.0 - report.metrics.visible) * report.points as f64).round() as usize;
    assert!(hidden >= 6 && report.unresolved.len() >= hidden, "{hidden} of {:?}", report.unresolved);
    for run in &report.unresolved {
        let UnresolvedReason::Infeasible { depth_m, gap_m, rows } = run.reason else { panic!("{run:?}") };
        assert!(depth_m >= 4.0 * 120.0 && gap_m > 0.0 && gap_m.is_finite() && rows > 0, "{run:?}");
    }
    // Finer grids come within metres of showing the rest.
    assert!(matches!(report.fallbacks.last(), Some(Fallback::FinerGrid { .. })), "{:?}", report.fallbacks);
    assert!(report.metrics.visible > 0.4 && report.metrics.hidden_worst_m < 3.0, "{:?}", report.metrics);
    // What shows every hole falls by 57 m per node (60 less what the line of sight rises) over the 38 nodes from the first to the last
    // of them, some 2100 m, for no grid here can hold steps. Slack spares a part of that.
    assert!(report.metrics.max_m < 2000.0 && report.metrics.raised_max_m <= 0.5, "{:?}", report.metrics);
}
