//! Rivers that are named do not run uphill on the displaced ground, whatever makes it move.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::{
    DisocclusionError, Solved, SolverMode, TerrainMemory, TerrainSettings, TerrainSolver, rivers::RIVER_TOLERANCE_M,
};
use belvedere_scene::{
    AreaFeature, AreaLayer, AreaSurface, CellTriangle, Color, Heightfield, Hidden, Layer, LayerKind, NodeState,
    Progress, Scene,
};
use belvedere_testkit::synthetic::{line_layer, terrain_layer};
use std::time::Duration;

const NODES: usize = 33;

/// A winding valley between spurs, along which a stream runs south, and a trail on its sides.
struct Valley {
    scene: Scene,
    stream: Vec<DVec2>,
    view: View,
}

impl Valley {
    /// * `steep`: fall of the sides, rise over run.
    fn new(seed: u64, spacing: f64, steep: f64) -> Self {
        let phase = seed as f64 * 1.7;
        let size = (NODES - 1) as f64 * spacing;
        let middle = |y: f64| size * (0.5 + 0.16 * (7.0 * y / size + phase).sin());
        let rough = |x: f64, y: f64| (x / (2.3 * spacing) + phase).sin() * (y / (1.9 * spacing) - phase).cos();
        let height = |x: f64, y: f64| {
            let away = ((x - middle(y)).abs() - 2.0 * spacing).max(0.0);
            let side = steep * 0.25 * size * (1.0 - (-away / (0.25 * size)).exp());
            (500.0 + 0.02 * y + side + 0.03 * steep * spacing * rough(x, y)) as f32
        };
        let node = |i: usize| ((i % NODES) as f64 * spacing, (NODES - 1 - i / NODES) as f64 * spacing);
        let heights = (0..NODES * NODES).map(node).map(|(x, y)| height(x, y)).collect();
        let states = vec![NodeState::Measured; NODES * NODES];
        let north_west = DVec2::new(0.0, size);
        let hf = Heightfield::new(north_west, DVec2::splat(spacing), NODES, NODES, heights, states).unwrap();
        let along = |k: i32| f64::from(k) / 150.0 * 0.9 * size + 0.05 * size;
        let stream: Vec<DVec2> = (0..=150).map(|k| DVec2::new(middle(along(k)), along(k))).collect();
        let beside = |p: &DVec2| *p + DVec2::new(0.1 * size * (3.0 * p.y / size + phase).cos(), 0.0);
        let drape = |p: DVec2| p.extend(hf.surface_at(p).unwrap());
        let trail: Vec<DVec3> = stream[40..].iter().map(|p| drape(beside(p))).collect();
        let eye = DVec2::new(middle(0.02 * size), 0.02 * size);
        let eye = eye.extend(hf.surface_at(eye).unwrap() + 0.06 * size);
        let toward = drape(stream[100]);
        let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
        let view = View::straight(Pinhole::look_at(eye, toward, DVec3::Z, lens, [640, 480], 1.0, None).unwrap());
        let river = Layer { must_see: false, ..line_layer("stream", stream.iter().map(|p| drape(*p)).collect()) };
        let scene = Scene { layers: vec![terrain_layer(hf), line_layer("trail", trail), river], ..Scene::default() };
        Self { scene, stream, view }
    }

    fn solve(&self, settings: TerrainSettings, rivers: bool) -> Solved {
        let rivers = if rivers { vec!["stream".into()] } else { Vec::new() };
        let solver = TerrainSolver::new(TerrainSettings { rivers, ..settings }).unwrap();
        solver.solve(&self.scene, &self.view, &mut TerrainMemory::default(), &Progress::silent()).unwrap()
    }

    /// By how much the stream rises downstream on the displaced ground more than on the ground as it was.
    fn excess(&self, solved: &Solved) -> f64 {
        let hf = self.scene.terrain().unwrap();
        excess(hf, &self.stream, |p| solved.stage.delta_at(p.extend(0.0)))
    }
}

/// Height by which a stream, given upstream, rises downstream on displaced ground more than on the undisplaced one, the largest at
/// many points along it; over flat facets between displaced nodes, and over the displacement as it is given.
fn excess(hf: &Heightfield, upstream: &[DVec2], moved: impl Fn(DVec2) -> f64) -> f64 {
    let faceted = |p: DVec2| {
        let g = (p - hf.north_west()) * DVec2::new(1.0, -1.0) / hf.spacing();
        let cell = g.floor().min(DVec2::new((hf.cols() - 2) as f64, (hf.rows() - 2) as f64));
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| cell + DVec2::new(x, y));
        let at = corners.map(|c| moved(hf.north_west() + c * DVec2::new(1.0, -1.0) * hf.spacing()));
        CellTriangle::at(g - cell).height(at, g - cell)
    };
    let mut places = Vec::new();
    for pair in upstream.windows(2) {
        let parts = ((pair[1] - pair[0]) / hf.spacing()).length().mul_add(25.0, 1.0).ceil();
        places.extend((0..parts as usize).map(|k| pair[0].lerp(pair[1], k as f64 / parts)));
    }
    let mut most = 0.0f64;
    for ground in [&faceted as &dyn Fn(DVec2) -> f64, &|p| moved(p)] {
        let [mut bed, mut lowest] = [f64::INFINITY; 2];
        for p in places.iter().rev() {
            let before = hf.surface_at(*p).unwrap();
            let after = before + ground(*p);
            (bed, lowest) = (bed.min(before), lowest.min(after));
            most = most.max((after - lowest) - (before - bed));
        }
    }
    most
}

/// All is shown, whatever it does to the landscape.
fn all() -> TerrainSettings {
    TerrainSettings { show: Some(1.0), ..TerrainSettings::default() }
}

/// Solves for seeded valleys with and without the river, and checks the guarantee of the former; returns the number of valleys in
/// which the stream runs uphill without it.
fn uphill_of(seeds: &[u64], spacing: f64, steep: f64) -> usize {
    let mut uphill = 0;
    for &seed in seeds {
        let valley = Valley::new(seed, spacing, steep);
        let free = valley.solve(all(), false);
        assert!(free.report.rivers.is_empty());
        uphill += usize::from(valley.excess(&free) > 0.1);
        let kept = valley.solve(all(), true);
        let (excess, told) = (valley.excess(&kept), &kept.report.rivers);
        assert!(excess < RIVER_TOLERANCE_M, "{excess} m: spacing {spacing}, seed {seed}");
        assert!(told.len() == 1 && told[0].layer == 2 && told[0].name == "stream", "{told:?}");
        assert!(told[0].excess_m < RIVER_TOLERANCE_M, "{told:?}");
        assert!(told[0].rise_after_m <= told[0].rise_before_m + RIVER_TOLERANCE_M, "{told:?}");
        let seen = kept.report.metrics.visible_dense;
        assert!(seen > kept.report.visible_dense_before + 0.2, "seed {seed}: {seen}");
        assert!(!kept.report.guaranteed || seen >= 0.9999, "seed {seed}: {seen}");
    }
    uphill
}

#[test]
fn rivers_run_downhill_in_fine_valleys() {
    assert!(uphill_of(&[2, 4, 6], 30.0, 0.6) >= 2, "streams do not run uphill where nobody asks");
}

#[test]
fn rivers_run_downhill_in_coarse_valleys() {
    assert!(uphill_of(&[4, 6], 90.0, 0.5) >= 1, "streams do not run uphill where nobody asks");
}

#[test]
fn rivers_run_downhill_in_steep_valleys() {
    assert_eq!(uphill_of(&[2], 30.0, 1.5), 1, "the stream does not run uphill where nobody asks");
}

#[test]
fn a_river_costs_displacement_and_no_sight() {
    // Showing all of the trail takes ground along which the stream would rise by some metres.
    let valley = Valley::new(6, 90.0, 0.5);
    let [free, kept] = [false, true].map(|rivers| valley.solve(all(), rivers));
    assert!(valley.excess(&free) > 0.1 && valley.excess(&kept) < RIVER_TOLERANCE_M);
    for report in [&free.report, &kept.report] {
        assert!(report.guaranteed && report.metrics.visible_dense >= 0.9999, "{}", report.metrics.visible_dense);
    }
    let [free, kept] = [free, kept].map(|solved| solved.report.metrics.rms_m);
    assert!(kept > 1.001 * free && kept < 1.5 * free, "{kept} m, {free} m where nobody asks");
}

#[test]
fn rivers_run_downhill_in_every_mode_and_where_time_is_up() {
    let valley = Valley::new(2, 90.0, 1.0);
    for mode in [SolverMode::PaperQp, SolverMode::Paper] {
        let settings = TerrainSettings { mode, ..TerrainSettings::default() };
        let free = valley.excess(&valley.solve(settings.clone(), false));
        let kept = valley.excess(&valley.solve(settings, true));
        assert!(free > 0.5 && kept < RIVER_TOLERANCE_M, "{mode:?}: {kept} m, {free} m where nobody asks");
    }
    let settings = TerrainSettings { rivers: vec!["stream".into()], ..TerrainSettings::default() };
    let solver = TerrainSolver::new(settings).unwrap();
    let soon = Progress::silent().limited(Duration::from_millis(60));
    let solved = solver.solve(&valley.scene, &valley.view, &mut TerrainMemory::default(), &soon).unwrap();
    assert!(valley.excess(&solved) < RIVER_TOLERANCE_M, "{:?}", solved.report.taken);
}

#[test]
fn rivers_run_downhill_in_every_frame_of_a_film() {
    let valley = Valley::new(2, 90.0, 0.5);
    let settings = TerrainSettings { rivers: vec!["stream".into()], ..TerrainSettings::default() };
    let solver = TerrainSolver::new(settings).unwrap().with_time_step(0.04);
    let mut memory = TerrainMemory::default();
    for frame in 0..4 {
        let from = valley.view.pinhole();
        let eye = from.eye + DVec3::new(4.0, 12.0, 1.0) * f64::from(frame);
        let pinhole = Pinhole::look_at(eye, eye + from.forward, DVec3::Z, from.projection, [640, 480], 1.0, None);
        let view = View::straight(pinhole.unwrap());
        let solved = solver.solve(&valley.scene, &view, &mut memory, &Progress::silent()).unwrap();
        let excess = valley.excess(&solved);
        assert!(excess < RIVER_TOLERANCE_M, "frame {frame}: {excess} m");
    }
}

#[test]
fn a_lake_on_a_river_stays_level_and_the_river_runs_downhill() {
    let mut valley = Valley::new(2, 90.0, 1.0);
    let hf = valley.scene.terrain().unwrap();
    let middle = valley.stream[75];
    let node = |i: usize| hf.north_west() + DVec2::new((i % NODES) as f64, -((i / NODES) as f64)) * hf.spacing();
    let on_lake = |i: &usize| node(*i).distance(middle) < 270.0;
    let lake: Vec<usize> = (0..NODES * NODES).filter(on_lake).collect();
    let mut heights = hf.heights().to_vec();
    let low = lake.iter().map(|&i| heights[i]).fold(f32::INFINITY, f32::min);
    lake.iter().for_each(|&i| heights[i] = low);
    let states = vec![NodeState::Measured; heights.len()];
    let flat = Heightfield::new(hf.north_west(), hf.spacing(), NODES, NODES, heights, states).unwrap();
    let ring = |k: i32| middle + 275.0 * DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 40.0);
    let kind = LayerKind::Area(AreaLayer {
        features: vec![AreaFeature { style: None, name: "lake".into(), rings: vec![(0..40).map(ring).collect()] }],
        fill: Color::rgb(0, 0, 200),
        outline: None,
        width_px: 1.0,
        surface: AreaSurface::Water,
        hidden: Hidden::Cut,
        lift_m: 0.5,
        label_px: None,
        beyond: 0.0,
    });
    valley.scene.layers[0] = terrain_layer(flat);
    valley.scene.layers.push(Layer { id: "lakes".into(), must_see: false, kind });
    for mode in [SolverMode::Qp, SolverMode::Paper] {
        let solved = valley.solve(TerrainSettings { mode, ..TerrainSettings::default() }, true);
        let excess = valley.excess(&solved);
        assert!(excess < RIVER_TOLERANCE_M, "{mode:?}: {excess} m");
        let lakes = &solved.report.lakes;
        assert!(lakes.len() == 1 && lakes[0].range_m < 1e-6 && lakes[0].moved_m != 0.0, "{mode:?}: {lakes:?}");
    }
}

#[test]
fn rivers_that_are_no_lines_of_the_scene_are_refused_by_name() {
    let valley = Valley::new(1, 30.0, 0.6);
    for wrong in ["ground", "strem"] {
        let settings = TerrainSettings { rivers: vec![wrong.into()], ..TerrainSettings::default() };
        let solver = TerrainSolver::new(settings).unwrap();
        let found = solver.solve(&valley.scene, &valley.view, &mut TerrainMemory::default(), &Progress::silent());
        let Err(e) = found else { panic!("{wrong} is taken for a river") };
        assert!(matches!(e, DisocclusionError::River { .. }), "{e}");
        assert!(e.to_string().contains(wrong) && e.to_string().contains("trail, stream"), "{e}");
    }
}

/// The path of steepest descent from a node, over small pits.
fn traced(hf: &Heightfield, from: [usize; 2]) -> Vec<[usize; 2]> {
    let height = |[x, y]: [usize; 2]| hf.heights()[y * hf.cols() + x];
    let mut path = vec![from];
    while let Some(&at) = path.last() {
        let around = (0..9).map(|k| [(at[0] + k % 3).wrapping_sub(1), (at[1] + k / 3).wrapping_sub(1)]);
        let free = around.filter(|p| p[0] < hf.cols() && p[1] < hf.rows() && !path.contains(p));
        let lowest = free.min_by(|a, b| height(*a).total_cmp(&height(*b)));
        match lowest.filter(|p| height(*p) < height(at) + 3.0) {
            Some(next) => path.push(next),
            None => break,
        }
    }
    path
}

#[test]
fn a_stream_of_andorra_runs_downhill_behind_the_ground_that_makes_way() {
    let Some(path) = belvedere_testkit::data("andorra/N42E001.hgt") else { return };
    let bytes = std::fs::read(path).unwrap();
    let whole: Vec<f32> = bytes.chunks_exact(2).map(|b| f32::from(i16::from_be_bytes([b[0], b[1]]))).collect();
    let side = 81;
    for [col, row] in CROPS {
        let heights: Vec<f32> = (0..side * side).map(|i| whole[(row + i / side) * 1201 + col + i % side]).collect();
        assert!(heights.iter().all(|h| *h > 0.0), "{col} {row}: no data");
        let states = vec![NodeState::Measured; side * side];
        // Three seconds of arc at 42.5 degrees north.
        let spacing = DVec2::new(68.4, 92.6);
        let hf = Heightfield::new(DVec2::ZERO, spacing, side, side, heights, states).unwrap();
        let springs = (0..64).map(|k| [5 + k % 8 * 10, 5 + k / 8 * 10]);
        let stream = springs.map(|spring| traced(&hf, spring)).max_by_key(Vec::len).unwrap();
        let downstream: Vec<DVec2> = stream.iter().map(|[x, y]| hf.node_xy(*x, *y)).collect();
        let (first, last) = (downstream[0], downstream[downstream.len() - 1]);
        let drape = |p: DVec2| p.extend(hf.surface_at(p).unwrap());
        // Far up the stream is to be seen from over its mouth, and it winds.
        let trail: Vec<DVec3> = downstream[..downstream.len() / 2].iter().map(|p| drape(*p)).collect();
        let eye = drape(last) + DVec3::Z * 200.0;
        let lens = Projection::Perspective { fov_y: 60f64.to_radians() };
        let view = View::straight(Pinhole::look_at(eye, drape(first), DVec3::Z, lens, [640, 480], 1.0, None).unwrap());
        let river = Layer { must_see: false, ..line_layer("stream", downstream.iter().map(|p| drape(*p)).collect()) };
        let upstream: Vec<DVec2> = downstream.iter().rev().copied().collect();
        let scene =
            Scene { layers: vec![terrain_layer(hf.clone()), line_layer("trail", trail), river], ..Scene::default() };
        let valley = Valley { scene, stream: upstream, view };
        let [free, kept] = [false, true]
            .map(|rivers| valley.solve(TerrainSettings { solver_nodes: 41, ..TerrainSettings::default() }, rivers));
        let [uphill, excess] = [&free, &kept].map(|solved| valley.excess(solved));
        assert!(excess < RIVER_TOLERANCE_M, "{col} {row}: {excess} m");
        assert!(uphill > 1.0, "{col} {row}: no uphill where nobody asks, {uphill} m");
    }
}

/// First column and row of parts of the elevation model.
const CROPS: [[usize; 2]; 2] = [[480, 520], [600, 640]];
