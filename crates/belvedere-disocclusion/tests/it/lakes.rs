//! Lakes move as a whole or not at all, whatever makes the ground move.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_disocclusion::{Solved, SolverMode, TerrainMemory, TerrainSettings, TerrainSolver};
use belvedere_scene::{
    AreaFeature, AreaLayer, AreaSurface, Color, Heightfield, Hidden, Layer, LayerKind, NodeState, Progress, Scene,
};
use belvedere_testkit::synthetic::{line_layer, mountains, terrain_layer, trail};
use std::time::Duration;

const NODES: usize = 49;
const LEVEL: f64 = 1e-6;

/// A rough ring about a centre, scene x, y.
fn ring(seed: u64, center: DVec2, radius: f64) -> Vec<DVec2> {
    let corner = |k: u32| {
        let rough = 0.8 + 0.4 * f64::from((u64::from(k) * 7919 + seed * 104_729) as u32 % 97) / 97.0;
        center + radius * rough * DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 14.0)
    };
    (0..14).map(corner).collect()
}

fn inside(ring: &[DVec2], p: DVec2) -> bool {
    let crosses =
        |a: DVec2, b: DVec2| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    (0..ring.len()).filter(|&i| crosses(ring[i], ring[(i + 1) % ring.len()])).count() % 2 == 1
}

fn place(hf: &Heightfield, i: usize) -> DVec2 {
    let (x, y) = ((i % NODES) as f64, (i / NODES) as f64);
    hf.north_west() + DVec2::new(x, -y) * hf.spacing()
}

/// Seeded mountains with a trail and two lakes: one of about 50 nodes, and a tarn smaller than the cells of a coarse solver's grid.
struct Case {
    scene: Scene,
    lakes: [Vec<usize>; 2],
    view: View,
}

impl Case {
    fn new(seed: u64, surface: AreaSurface, lake_must_see: bool) -> Self {
        let hf = mountains(NODES, seed);
        let size = (NODES - 1) as f64 * hf.spacing();
        let south_west = hf.north_west() - DVec2::new(0.0, size.y);
        let rings = [
            ring(seed, south_west + size * DVec2::new(0.45, 0.45), 4.0 * hf.spacing().x),
            ring(seed + 1, south_west + size * DVec2::new(0.62, 0.3), 1.7 * hf.spacing().x),
        ];
        let lakes =
            [0, 1].map(|k| (0..NODES * NODES).filter(|&i| inside(&rings[k], place(&hf, i))).collect::<Vec<_>>());
        let mut heights = hf.heights().to_vec();
        for lake in &lakes {
            let low = lake.iter().map(|&i| heights[i]).fold(f32::INFINITY, f32::min);
            lake.iter().for_each(|&i| heights[i] = low);
        }
        let states = vec![NodeState::Measured; heights.len()];
        let hf = Heightfield::new(hf.north_west(), hf.spacing(), NODES, NODES, heights, states).unwrap();
        let eye = (south_west + size * DVec2::new(0.5, 0.04)).extend(0.0);
        let eye = eye.with_z(hf.surface_at(eye.truncate()).unwrap() + 250.0);
        let lens = Projection::Perspective { fov_y: 40f64.to_radians() };
        let toward = eye + DVec3::new(0.0, 1.0, -0.15);
        let view = View::straight(Pinhole::look_at(eye, toward, DVec3::Z, lens, [640, 360], 1.0, None).unwrap());
        let features = rings.map(|r| AreaFeature { style: None, name: "lake".into(), rings: vec![r] }).to_vec();
        let kind = LayerKind::Area(AreaLayer {
            features,
            fill: Color::rgb(0, 0, 200),
            outline: None,
            width_px: 1.0,
            surface,
            hidden: Hidden::Cut,
            lift_m: 0.5,
            label_px: None,
            beyond: 0.0,
        });
        let areas = Layer { id: "lakes".into(), must_see: lake_must_see, kind };
        let route = trail(&hf);
        let scene = Scene { layers: vec![terrain_layer(hf), line_layer("trail", route), areas], ..Scene::default() };
        Self { scene, lakes, view }
    }

    /// Largest difference of displacement on a lake, and the most that anything moves.
    fn range(&self, solved: &Solved) -> (f64, f64) {
        let hf = self.scene.terrain().unwrap();
        let moved = |i: usize| solved.stage.delta_at(place(hf, i).extend(0.0));
        let range = |lake: &Vec<usize>| {
            let values = || lake.iter().map(|&i| moved(i));
            values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
        };
        let most = (0..NODES * NODES).map(|i| moved(i).abs()).fold(0.0, f64::max);
        (self.lakes.iter().map(range).fold(0.0, f64::max), most)
    }
}

fn solve(settings: TerrainSettings, case: &Case) -> Solved {
    let solver = TerrainSolver::new(settings).unwrap();
    solver.solve(&case.scene, &case.view, &mut TerrainMemory::default(), &Progress::silent()).unwrap()
}

#[test]
fn lakes_are_level_in_every_mode_and_plain_areas_are_not() {
    let mut tilted = 0.0f64;
    for seed in [1, 5] {
        for must_see in [false, true] {
            let case = Case::new(seed, AreaSurface::Water, must_see);
            for mode in [SolverMode::Qp, SolverMode::PaperQp, SolverMode::Paper] {
                for solver_nodes in [13, 25] {
                    let solved = solve(TerrainSettings { mode, solver_nodes, ..TerrainSettings::default() }, &case);
                    let (range, most) = case.range(&solved);
                    assert!(most > 5.0, "nothing moves: seed {seed}, {mode:?}");
                    assert!(range < LEVEL, "{range} m: seed {seed}, {mode:?}, {solver_nodes} nodes, {must_see}");
                    let told = &solved.report.lakes;
                    assert!(told.len() == 2 && told.iter().all(|l| l.range_m < LEVEL && l.layer == 2), "{told:?}");
                }
            }
            let plain = Case::new(seed, AreaSurface::Plain, must_see);
            let solved = solve(TerrainSettings::default(), &plain);
            assert!(solved.report.lakes.is_empty());
            tilted = tilted.max(plain.range(&solved).0);
        }
    }
    assert!(tilted > 2.0, "areas that are no water tilt: {tilted} m");
}

/// A lake is shown as the same outline is that is no lake: all of it, for about as much displacement, and level.
#[test]
fn a_lake_is_promised_as_a_meadow_is() {
    let mut promised = 0;
    for seed in 1..9 {
        let [water, meadow] = [AreaSurface::Water, AreaSurface::Plain].map(|surface| {
            let case = Case::new(seed, surface, true);
            let solved = solve(TerrainSettings { limits: false, ..TerrainSettings::default() }, &case);
            assert!(surface == AreaSurface::Plain || case.range(&solved).0 < LEVEL, "seed {seed}");
            solved.report
        });
        if meadow.guaranteed {
            promised += 1;
            assert!(water.guaranteed, "seed {seed}: {} of the lake, {:?}", water.metrics.visible_dense, water.hidden);
        }
        let [rms, of_meadow] = [&water, &meadow].map(|report| report.metrics.rms_m);
        assert!(rms < 1.3 * of_meadow, "seed {seed}: {rms} m for the lake, {of_meadow} m for the meadow");
    }
    assert!(promised >= 6, "only {promised} of 8 meadows are promised");
}

#[test]
fn lakes_are_level_where_the_limits_fill_up_and_where_time_is_up() {
    // From low over the ground everything is hidden by much.
    let places = (1..9).flat_map(|seed| [240, 225, 200].map(|lower| (seed, lower)));
    // On a coarse grid whole valleys sink.
    let coarse = TerrainSettings { solver_nodes: 9, ..TerrainSettings::default() };
    let found = places.into_iter().find_map(|(seed, lower)| {
        let mut case = Case::new(seed, AreaSurface::Water, true);
        let from = case.view.pinhole().clone();
        let eye = from.eye - DVec3::Z * f64::from(lower);
        let pinhole = Pinhole::look_at(eye, eye + DVec3::Y, DVec3::Z, from.projection, [640, 360], 1.0, None).unwrap();
        case.view = View::straight(pinhole);
        let solver = TerrainSolver::new(coarse.clone()).unwrap();
        let solved = solver.solve(&case.scene, &case.view, &mut TerrainMemory::default(), &Progress::silent()).ok()?;
        solved.report.limited.is_some().then_some((case, solved))
    });
    let (case, solved) = found.expect("an eye from which the limits fill ground up");
    assert!(case.range(&solved).0 < LEVEL, "{:?}", solved.report.lakes);
    let solver = TerrainSolver::new(TerrainSettings::default()).unwrap();
    let soon = Progress::silent().limited(Duration::from_millis(40));
    let solved = solver.solve(&case.scene, &case.view, &mut TerrainMemory::default(), &soon).unwrap();
    assert!(case.range(&solved).0 < LEVEL, "{:?}", solved.report.taken);
}

#[test]
fn lakes_are_level_in_every_frame_of_a_film() {
    let case = Case::new(5, AreaSurface::Water, false);
    let solver = TerrainSolver::new(TerrainSettings::default()).unwrap().with_time_step(0.04);
    let mut memory = TerrainMemory::default();
    let mut moved = Vec::new();
    for frame in 0..5 {
        let from = case.view.pinhole();
        let eye = from.eye + DVec3::new(15.0 * f64::from(frame), 6.0 * f64::from(frame), 0.0);
        let toward = eye + DVec3::new(0.0, 1.0, -0.15);
        let pinhole = Pinhole::look_at(eye, toward, DVec3::Z, from.projection, [640, 360], 1.0, None).unwrap();
        let solved = solver.solve(&case.scene, &View::straight(pinhole), &mut memory, &Progress::silent()).unwrap();
        assert!(case.range(&solved).0 < LEVEL, "frame {frame}: {:?}", solved.report.lakes);
        moved.push(solved.report.lakes[0].moved_m);
    }
    let steps: Vec<f64> = moved.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    assert!(steps.iter().all(|s| *s < 25.0), "a lake leaps: {moved:?}");
}
