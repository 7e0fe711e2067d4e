//! What a file of heights shows is judged on the file's own samples, all of them, whatever ground was solved on.

use belvedere_core::{DVec2, DVec3, Pinhole, Projection, TerrainDisocclusion, View};
use belvedere_disocclusion::report::LakeReport;
use belvedere_disocclusion::{
    FileToWrite, SampleGrid, Solved, TerrainMemory, TerrainSettings, TerrainSolver, WrittenGround, WrittenShares,
};
use belvedere_scene::{Heightfield, NodeState, Progress, Scene};
use belvedere_testkit::Random;
use belvedere_testkit::synthetic::{line_layer, terrain_layer};

/// Samples per side of the file, and their distance, metres; the solver works on every second one.
const FILE: usize = 161;
const STEP: f64 = 10.0;
const SIZE: f64 = (FILE - 1) as f64 * STEP;

/// Hills with noise of `noise_m` at the samples that the solver does not know.
fn file(noise_m: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    (0..FILE * FILE)
        .map(|i| {
            let (col, row) = (i % FILE, i / FILE);
            let (x, y) = (col as f64 * STEP, row as f64 * STEP);
            let known = col % 2 == 0 && row % 2 == 0;
            let noise = random.range(-1.0, 1.0) * if known { 0.0 } else { noise_m };
            400.0 + 90.0 * (x / 170.0).sin() * (y / 210.0 + 0.3).sin() + noise
        })
        .collect()
}

fn scene(heights: &[f64]) -> Scene {
    let n = FILE.div_ceil(2);
    let known = (0..n * n).map(|i| heights[2 * (i / n) * FILE + 2 * (i % n)] as f32).collect();
    let hf = Heightfield::new(
        DVec2::new(0.0, SIZE),
        DVec2::splat(2.0 * STEP),
        n,
        n,
        known,
        vec![NodeState::Measured; n * n],
    )
    .unwrap();
    let way = (0..=60).map(|k| DVec2::new(SIZE * (0.15 + 0.7 * f64::from(k) / 60.0), SIZE * 0.6));
    let way = way.map(|p| (p + 60.0 * (p.x / 90.0).sin() * DVec2::Y).extend(0.0)).collect();
    Scene { layers: vec![terrain_layer(hf), line_layer("way", way)], ..Scene::default() }
}

fn view() -> View {
    let lens = Projection::Perspective { fov_y: 60f64.to_radians() };
    let (eye, target) = (DVec3::new(0.5 * SIZE, 60.0, 760.0), DVec3::new(0.5 * SIZE, 0.6 * SIZE, 760.0));
    View::straight(Pinhole::look_at(eye, target, DVec3::Z, lens, [1280, 720], 1.0, None).unwrap())
}

/// How a file is taken into account.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    /// Not at all.
    No,
    /// Its samples are kept clear, and trimmed.
    OneDiagonal,
    BothDiagonals,
}

/// The file after the move, and what the judge says of it.
fn judged(noise_m: f64, seed: u64, known: Known) -> (Vec<f64>, Solved, WrittenShares) {
    let heights = file(noise_m, seed);
    let (scene, view) = (scene(&heights), view());
    let solver = TerrainSolver::new(TerrainSettings { limits: false, ..TerrainSettings::default() }).unwrap().in_plan();
    let grid = SampleGrid {
        nodes: [FILE; 2],
        spacing: DVec2::splat(STEP),
        index_from_scene: &|p| Some(DVec2::new(p.x, SIZE - p.y) / STEP),
        scene_from_index: &|g| Some(DVec2::new(g.x, SIZE / STEP - g.y) * STEP),
        other_diagonal: false,
    };
    let grids: &[SampleGrid<'_>] = match known {
        Known::No => &[],
        Known::OneDiagonal => &[grid],
        Known::BothDiagonals => &[grid, grid.cut_otherwise()],
    };
    let place = |i: usize| DVec2::new((i % FILE) as f64 * STEP, SIZE - (i / FILE) as f64 * STEP);
    let under = |stage: &TerrainDisocclusion, _: &[LakeReport]| -> Option<Vec<f64>> {
        Some((0..FILE * FILE).map(|i| heights[i] + stage.delta_at(place(i).extend(0.0))).collect())
    };
    let files: Vec<FileToWrite<'_>> =
        grids.iter().map(|grid| FileToWrite { grid: *grid, heights: &under, at_most: None }).collect();
    let (mut memory, silent) = (TerrainMemory::default(), Progress::silent());
    let mut solved = solver.solve_for_files(&scene, &view, &mut memory, &files, &silent).unwrap();
    let mut moved = under(&solved.stage, &[]).unwrap();
    if known != Known::No {
        let height = |i: usize| Some(moved[i]);
        let lowered = solver.trimmed((&scene, &view), grids, &height, &|_| false, &solved.report, &silent).unwrap();
        let most = grid.most_trimmed();
        assert!(lowered.values().all(|by| *by > 0.0 && *by <= most + 1e-9), "noise {noise_m}: more than {most} m");
        lowered.into_iter().for_each(|(i, by)| moved[i] -= by);
    }
    let of = |z: &Vec<f64>, grid: SampleGrid<'_>| {
        let ground = WrittenGround { grid, height: &|i| Some(z[i]), solved_on: false };
        solver.judge_written(&scene, &view, &ground, &solved.report, &silent).unwrap()
    };
    let [before, after] = [of(&heights, grid), of(&moved, grid)];
    if known == Known::BothDiagonals {
        let other = of(&moved, grid.cut_otherwise()).visible_dense;
        assert!(other >= 0.995, "noise {noise_m}: the other diagonal shows {other}");
    }
    after.put(&before, false, &mut solved.report);
    (moved, solved, after)
}

/// Height of a file's triangles, split from north-west to south-east.
fn surface(z: &[f64], g: DVec2) -> f64 {
    let (col, row) = ((g.x as usize).min(FILE - 2), (g.y as usize).min(FILE - 2));
    let (u, v) = (g.x - col as f64, g.y - row as f64);
    let [nw, ne, sw, se] = [0, 1, FILE, FILE + 1].map(|k| z[row * FILE + col + k]);
    if u >= v { nw + (ne - nw) * u + (se - ne) * v } else { nw + (sw - nw) * v + (se - sw) * u }
}

/// Visible share of the way by a march in steps of a fiftieth of a cell.
fn marched(z: &[f64]) -> f64 {
    let (scene, eye) = (scene(z), view().pinhole().eye);
    let belvedere_scene::LayerKind::Line(line) = &scene.layers[1].kind else { panic!("a line") };
    let index = |p: DVec3| DVec2::new(p.x, SIZE - p.y) / STEP;
    let (mut seen, mut all) = (0.0, 0.0);
    for pair in line.features[0].points.windows(2) {
        for k in 0..24 {
            let at = index(pair[0].lerp(pair[1], (f64::from(k) + 0.5) / 24.0));
            let (from, to) = (surface(z, at) + line.lift_m, index(eye));
            let steps = (at.distance(to) * 50.0) as usize;
            let is_over = |s: usize| {
                let t = s as f64 / steps as f64;
                surface(z, at.lerp(to, t)) > from + t * (eye.z - from) + 1e-6
            };
            let length = pair[0].truncate().distance(pair[1].truncate());
            all += length;
            seen += if (0..=steps).any(is_over) { 0.0 } else { length };
        }
    }
    seen / all
}

#[test]
fn a_guarantee_is_one_of_every_sample_of_the_written_file() {
    let mut kept = 0;
    for (noise_m, seed) in [(0.0, 1), (3.0, 2), (6.0, 3), (6.0, 4)] {
        let (moved, solved, after) = judged(noise_m, seed, Known::No);
        let report = &solved.report;
        assert!(report.metrics.visible_dense >= 0.9999, "the ground that was solved on shows all: {report:?}");
        assert!(report.visible_whole_before < 0.95, "{report:?}");
        let seen = marched(&moved);
        assert!((after.visible_dense - seen).abs() < 0.005, "said {}, the file shows {seen}", after.visible_dense);
        assert!((report.visible_whole - seen).abs() < 0.005, "{report:?}: {seen}");
        assert_eq!(report.guaranteed, seen >= 0.9999, "noise {noise_m}: {seen}");
        kept += usize::from(report.guaranteed);
        assert!(noise_m < 1.0 || seen < 0.97, "the noise hides something: {seen}");
    }
    assert!(kept >= 1, "ground without noise keeps what was promised");
}

#[test]
fn a_file_that_the_solver_knows_shows_what_the_solved_ground_shows() {
    for (noise_m, seed) in [(0.0, 1), (3.0, 2), (4.0, 3), (4.0, 4)] {
        let (_, alone, _) = judged(noise_m, seed, Known::No);
        for known in [Known::OneDiagonal, Known::BothDiagonals] {
            let (moved, solved, after) = judged(noise_m, seed, known);
            let report = &solved.report;
            let seen = marched(&moved);
            assert!(seen >= 0.995, "{known:?}, noise {noise_m}, seed {seed}: the file shows {seen}");
            assert!((after.visible_dense - seen).abs() < 0.005, "said {}, the file shows {seen}", after.visible_dense);
            assert_eq!(report.guaranteed, seen >= 0.9999, "noise {noise_m}: {seen}");
            let [with, without] = [report, &alone.report].map(|r| r.metrics.rms_m);
            assert!(with <= 1.3 * without + 0.5, "noise {noise_m}: {with} m instead of {without} m");
        }
    }
}
