//! Memory between frames, and the changes after which it must not be used.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, TerrainDisocclusion, View};
use belvedere_disocclusion::{Solved, SolverMode, TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere_scene::{Heightfield, NodeState, Progress, Scene};
use belvedere_testkit::synthetic::{line_layer, mountains, terrain_layer, trail};

const NODES: usize = 65;

fn ground(change: impl Fn(usize, f32) -> f32, void: impl Fn(usize) -> bool) -> Heightfield {
    let hf = mountains(NODES, 3);
    let heights = hf.heights().iter().enumerate().map(|(i, h)| change(i, *h)).collect();
    let states = (0..NODES * NODES).map(|i| if void(i) { NodeState::Void } else { NodeState::Measured }).collect();
    Heightfield::new(hf.north_west(), hf.spacing(), NODES, NODES, heights, states).unwrap()
}

fn scene(hf: Heightfield, route: Vec<DVec3>) -> Scene {
    Scene { layers: vec![terrain_layer(hf), line_layer("trail", route)], ..Scene::default() }
}

/// From 250 m over the southern rim, `turn` degrees east of north, `east` metres beside the middle.
fn view(turn: f64, east: f64) -> View {
    let eye = DVec3::new(1600.0 + east, 200.0, 1500.0);
    let (sin, cos) = turn.to_radians().sin_cos();
    let lens = Projection::Perspective { fov_y: 25f64.to_radians() };
    View::straight(
        Pinhole::look_at(eye, eye + DVec3::new(sin, cos, -0.2), DVec3::Z, lens, [640, 360], 1.0, None).unwrap(),
    )
}

fn solve(solver: &TerrainSolver, scene: &Scene, view: &View, memory: &mut TerrainMemory) -> Solved {
    solver.solve(scene, view, memory, &Progress::silent()).unwrap()
}

/// Largest difference of two displacements, metres.
fn apart(a: &TerrainDisocclusion, b: &TerrainDisocclusion) -> f64 {
    let nodes = (0..NODES * NODES).map(|i| DVec3::new((i % NODES) as f64, (i / NODES) as f64, 0.0) * 50.0);
    nodes.map(|p| (a.delta_at(p) - b.delta_at(p)).abs()).fold(0.0, f64::max)
}

#[test]
fn other_ground_or_features_of_the_same_size_begin_anew() {
    let plain = ground(|_, h| h, |_| false);
    let route = trail(&plain);
    let base = scene(plain.clone(), route.clone());
    let hill = |i: usize, h: f32| if i / NODES > 45 && i % NODES > 25 { h + 120.0 } else { h };
    let mut lifted = base.clone();
    if let Some(line) = lifted.layers[1].kind.lines_mut() {
        line.lift_m = 40.0;
    }
    let mut optional = base.clone();
    optional.layers.push(line_layer("other", route.iter().map(|p| DVec3::new(p.x, 3200.0 - p.y, p.z)).collect()));
    let others = [
        ("heights", scene(ground(hill, |_| false), route.clone())),
        ("voids", scene(ground(|_, h| h, |i| (30..40).contains(&(i / NODES))), route.clone())),
        ("route", scene(plain, route.iter().map(|p| *p + DVec3::X * 90.0).collect())),
        ("lift", lifted),
        ("one more line", optional),
    ];
    for mode in [SolverMode::Qp, SolverMode::Paper] {
        let solver = TerrainSolver::new(TerrainSettings { mode, ..TerrainSettings::default() }).unwrap();
        let view = view(0.0, 0.0);
        let mut kept = TerrainMemory::default();
        let first = solve(&solver, &base, &view, &mut kept);
        let again = solve(&solver, &base, &view, &mut kept.clone()).stage;
        // Rows of the solution before are taken over: where two rows do alike, the solutions differ by a little.
        assert!(apart(&again, &first.stage) < 3.0, "the same scene again");
        for (what, other) in &others {
            let fresh = solve(&solver, other, &view, &mut TerrainMemory::default());
            assert_ne!(fresh.stage, first.stage, "{what} make no difference in mode {mode:?}");
            let solved = solve(&solver, other, &view, &mut kept.clone());
            assert_eq!(solved.stage, fresh.stage, "other {what} in mode {mode:?}");
            assert_eq!(solved.report.metrics, fresh.report.metrics, "other {what} in mode {mode:?}");
        }
    }
}

#[test]
fn other_parameters_begin_anew() {
    let hf = mountains(NODES, 3);
    let route = trail(&hf);
    let scene = scene(hf, route);
    let solver = |settings: TerrainSettings| TerrainSolver::new(settings).unwrap();
    let plain = TerrainSettings { gamma_time_s: 5.0, ..TerrainSettings::default() };
    let first = solver(plain.clone());
    let mut kept = TerrainMemory::default();
    let before = solve(&first, &scene, &view(0.0, 0.0), &mut kept);
    // A margin is a parameter of the rows, a time step weighs the frame before.
    let others = [
        ("margin", solver(TerrainSettings { margin_m: 25.0, ..plain.clone() })),
        ("time step", solver(plain).with_time_step(0.04)),
    ];
    for (what, other) in others {
        let two = |mut memory: TerrainMemory| {
            solve(&other, &scene, &view(0.0, 0.0), &mut memory);
            solve(&other, &scene, &view(5.0, 0.0), &mut memory)
        };
        let fresh = two(TerrainMemory::default());
        assert_ne!(fresh.stage, before.stage, "{what} makes no difference");
        assert_eq!(two(kept.clone()).stage, fresh.stage, "other {what}");
    }
}

#[test]
fn a_turn_or_a_leap_of_the_view_forgets_the_frame_before() {
    let hf = mountains(NODES, 3);
    let route = trail(&hf);
    let scene = scene(hf, route);
    let settings = TerrainSettings { gamma_time_s: 5.0, ..TerrainSettings::default() };
    let solver = TerrainSolver::new(settings).unwrap().with_time_step(0.04);
    let diagonal = DVec2::splat((NODES - 1) as f64 * 50.0).length();
    // How far the frame before pulls at the ground of a second view.
    let pull = |second: &View| {
        let mut memory = TerrainMemory::default();
        solve(&solver, &scene, &view(0.0, 0.0), &mut memory);
        let after = solve(&solver, &scene, second, &mut memory).stage;
        let alone = solve(&solver, &scene, second, &mut TerrainMemory::default()).stage;
        apart(&after, &alone)
    };
    let steps = [pull(&view(19.0, 0.0)), pull(&view(0.0, 0.049 * diagonal))];
    let jumps = [pull(&view(21.0, 0.0)), pull(&view(-21.0, 0.0)), pull(&view(0.0, 0.051 * diagonal))];
    assert!(steps.iter().all(|p| *p > 10.0), "steps are pulled by {steps:?} m");
    // Rows of the frame before are taken over all the same.
    assert!(jumps.iter().all(|p| *p < 3.0), "jumps are pulled by {jumps:?} m, steps by {steps:?} m");
}
