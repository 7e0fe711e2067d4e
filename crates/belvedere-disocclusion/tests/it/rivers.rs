//! Rivers that are named do not run uphill on the displaced ground, whatever makes it move.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::{
    DisocclusionError, Solved, SolverMode, TerrainMemory, TerrainSettings, TerrainSolver, rivers::RIVER_TOLERANCE_M,
};
use belvedere_scene::{CellTriangle, Heightfield, Layer, NodeState, Progress, Scene};
use belvedere_testkit::synthetic::{line_layer, terrain_layer};
use std::time::Duration;

const NODES: usize = 65;

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
            let away = (x - middle(y)).abs();
            let side = steep * 0.25 * size * (1.0 - (-away / (0.25 * size)).exp());
            (500.0 + 0.08 * y + side + 0.03 * steep * spacing * rough(x, y)) as f32
        };
        let node = |i: usize| ((i % NODES) as f64 * spacing, (NODES - 1 - i / NODES) as f64 * spacing);
        let heights = (0..NODES * NODES).map(|i| node(i)).map(|(x, y)| height(x, y)).collect();
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

/// By how much a stream, given upstream, rises downstream on displaced ground more than on the ground as it was, at any of many places along
/// it; over flat facets between displaced nodes, and over the displacement as it is given.
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

#[test]
fn explore() {
    for (spacing, steep) in [(30.0, 0.6), (90.0, 0.5), (30.0, 1.5)] {
        for seed in 1..=4 {
            let valley = Valley::new(seed, spacing, steep);
            for rivers in [false, true] {
                let began = std::time::Instant::now();
                let s = valley.solve(TerrainSettings::default(), rivers);
                let r = &s.report;
                println!(
                    "{spacing} {steep} seed {seed} rivers {rivers}: excess {:.3} visible {:.4}->{:.4} guaranteed {} limited {} rows {:?} rounds {:?} {:.2} s {:?}",
                    valley.excess(&s),
                    r.visible_dense_before,
                    r.metrics.visible_dense,
                    r.guaranteed,
                    r.limited.is_some(),
                    r.qp.map(|q| q.rows),
                    r.qp.map(|q| q.rounds),
                    began.elapsed().as_secs_f64(),
                    r.rivers
                );
            }
        }
    }
}
