//! The published trends of the two-pass method: effects of the smoothness weight and of the price of steps.

use belvedere_core::DVec3;
use belvedere_core::grid::Grid;
use belvedere_disocclusion::TerrainSettings;
use belvedere_disocclusion::internals::StraightSight;
use belvedere_disocclusion::internals::{
    BlockMaxima, Cells, Deformation, Field, Hierarchy, Naive, ReferencePoint, Smoother, Wedge, check_eye, grid_weight,
    in_view, reference_points, terrain_metrics,
};
use belvedere_disocclusion::report::TerrainMetrics;
use belvedere_scene::Scene;
use belvedere_testkit::synthetic::{camera, scene};

/// One of several seeded mountains, its trail, and an eye above the southern rim.
struct Case {
    scene: Scene,
    field: Field,
    cells: Cells,
    eye: DVec3,
    wedge: Wedge,
    points: Vec<ReferencePoint>,
}

impl Case {
    fn new(seed: u64) -> Self {
        let scene = scene(161, seed);
        let field = Field::new(scene.terrain().unwrap(), |_| 0.0).unwrap();
        let camera = camera(&scene, 900.0, [1600, 900]);
        check_eye(&field, camera.eye).unwrap();
        let (settings, wedge) = (TerrainSettings::default(), Wedge::of_pinhole(&camera));
        let all = reference_points(&scene, &field, &settings, settings.spacing).0;
        let points = in_view(&field, &all, &wedge, settings.guard).0.into_iter().map(|i| all[i]).collect();
        let cells = Cells::new(&field, Cells::default_count(&field));
        Self { scene, field, cells, eye: camera.eye, wedge, points }
    }

    fn naive(&self, settings: &TerrainSettings) -> Vec<f64> {
        let blocks = BlockMaxima::new(&self.field);
        let naive = Naive::new(&self.field, &self.cells, Some(&blocks), settings, self.eye, &self.points);
        naive.displacement(&self.field, &self.cells)
    }

    /// `u` on `cols` x `rows` nodes over the field.
    fn judge(&self, settings: &TerrainSettings, [cols, rows]: [usize; 2], u: Vec<f64>) -> TerrainMetrics {
        let last = [self.field.cols() - 1, self.field.rows() - 1].map(|n| n as f64);
        let step = belvedere_core::DVec2::new(last[0] / (cols - 1) as f64, last[1] / (rows - 1) as f64);
        let delta = Grid::new(self.field.north_west(), step * self.field.spacing(), cols, rows, u).unwrap();
        let all = reference_points(&self.scene, &self.field, settings, 0.2).0;
        let dense = in_view(&self.field, &all, &self.wedge, settings.guard).0;
        let dense: Vec<ReferencePoint> = dense.into_iter().map(|i| all[i]).collect();
        let sight = StraightSight { eye: self.field.grid_from_scene(self.eye.truncate()), z: self.eye.z };
        terrain_metrics(&Deformation {
            field: &self.field,
            delta: &delta,
            previous: None,
            cells: Some(&self.cells),
            points: &self.points,
            dense: &dense,
            sight: &sight,
            every_node: true,
            guard: settings.guard,
        })
    }

    /// The naive ground smoothed, without elevation and temporal rows.
    fn smooth(&self, settings: &TerrainSettings, naive: &[f64]) -> TerrainMetrics {
        let grid = Hierarchy::new(self.field.cols(), self.field.rows(), 81);
        let w = grid_weight(settings.w.unwrap(), grid.intervals());
        let mut u: Vec<f64> = grid.restrict(naive).into_iter().map(|u| w * w * u).collect();
        Smoother::new(grid.cols(), grid.rows(), w, 0.0).unwrap().solve(&mut u);
        self.judge(settings, [grid.cols(), grid.rows()], u)
    }
}

#[test]
fn visibility_and_steps_rise_with_w() {
    let cases: Vec<Case> = (1..4).map(Case::new).collect();
    let settings = |w: f64| TerrainSettings { w: Some(w), ..TerrainSettings::default() };
    let naive: Vec<Vec<f64>> = cases.iter().map(|c| c.naive(&TerrainSettings::default())).collect();
    let mut before = [0.0f64; 2];
    for w in [0.1, 0.6, 1.0, 10.0] {
        let all: Vec<TerrainMetrics> = cases.iter().zip(&naive).map(|(c, u)| c.smooth(&settings(w), u)).collect();
        let mean = |f: &dyn Fn(&TerrainMetrics) -> f64| all.iter().map(f).sum::<f64>() / all.len() as f64;
        let now = [mean(&|m| m.visible), mean(&|m| m.step_p999_m)];
        assert!(now[0] >= before[0] && now[1] > before[1], "w = {w}: {before:?}, then {now:?}");
        before = now;
    }
}

#[test]
fn the_naive_ground_shows_nearly_everything_and_smoothing_hides_some_of_it() {
    for case in (1..4).map(Case::new) {
        let settings = TerrainSettings { w: Some(0.1), ..TerrainSettings::default() };
        let still = case.judge(&settings, [2, 2], vec![0.0; 4]);
        let u = case.naive(&settings);
        let naive = case.judge(&settings, [case.field.cols(), case.field.rows()], u.clone());
        let smooth = case.smooth(&settings, &u);
        // The greedy pass clears nothing nearer than the guard, and nodes, not facets: those hide a hundredth more.
        let [before, naive_seen, after] = [still, naive, smooth].map(|m| m.visible_dense + m.hidden_in_guard);
        assert!(before < 0.8 && naive_seen > 0.88 && after < naive_seen, "{before} {naive_seen} {after}");
        assert!(after > before);
        assert_eq!(naive.raised_max_m, 0.0);
        // Points stand for the length.
        assert!((naive.visible_dense - naive.visible).abs() < 0.05, "{naive:?}");
    }
}
