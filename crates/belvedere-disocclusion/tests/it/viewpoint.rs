//! Viewpoint adjustment on energies that are known in closed form, and on solved ground.

use belvedere_core::{DVec2, DVec3, EarthCurvature, Pinhole, Projection, Stage, View};
use belvedere_disocclusion::ghost::opacity;
use belvedere_disocclusion::internals::{ViewpointEnergy, adjust_viewpoint, height_slope};
use belvedere_disocclusion::{TerrainMemory, TerrainSettings, TerrainSolver, ViewpointOptions};
use belvedere_scene::{Heightfield, Progress, Scene};
use belvedere_testkit::synthetic::{line_layer, terrain_layer};

const USER: DVec3 = DVec3::new(0.0, -1000.0, 500.0);
const TARGET: DVec3 = DVec3::new(0.0, 0.0, 100.0);
const FLAT: &dyn Fn(DVec2) -> Option<f64> = &|_| Some(0.0);

/// Energy that is the square of the height by which a ridge at y = -300 rises over the line of sight to the target, in metres.
struct Ridge {
    top: f64,
    asked: usize,
    slope: Option<f64>,
    offers: bool,
}

impl Ridge {
    fn new(top: f64, offers: bool) -> Self {
        Self { top, asked: 0, slope: None, offers }
    }
}

impl ViewpointEnergy for Ridge {
    fn energy(&mut self, eye: DVec3) -> Option<f64> {
        self.asked += 1;
        let tau = 300.0 / -eye.y;
        let lack = (self.top - (1.0 - tau) * TARGET.z - tau * eye.z).max(0.0);
        self.slope = self.offers.then_some(height_slope([(2.0 * lack, tau)]));
        Some(lack * lack)
    }

    fn slope(&mut self) -> Option<f64> {
        self.slope
    }
}

#[test]
fn the_minimum_inside_the_box_is_found_when_only_the_camera_moves() {
    let best = DVec3::new(60.0, -950.0, 560.0);
    let mut bowl = |eye: DVec3| Some(1.0 + (eye - best).length_squared());
    let options = ViewpointOptions { slider: 0.0, steps: 60, ..ViewpointOptions::default() };
    let found = adjust_viewpoint(USER, TARGET, FLAT, &mut bowl, &options).unwrap();
    assert!(found.eye.distance(best) < 5.0, "{found:?}");
    assert!((found.moved_m - found.eye.distance(USER)).abs() < 1e-9);
}

#[test]
fn the_slider_goes_from_moving_the_camera_to_staying() {
    let run = |slider| {
        let options = ViewpointOptions { slider, ..ViewpointOptions::default() };
        adjust_viewpoint(USER, TARGET, FLAT, &mut Ridge::new(280.0, false), &options).unwrap()
    };
    let found: Vec<_> = [0.0, 0.1, 0.3, 0.6, 0.9, 1.0].map(run).into();
    for pair in found.windows(2) {
        assert!(pair[1].moved_m <= pair[0].moved_m + 1.0, "{pair:?}");
        assert!(pair[1].energy[1] >= pair[0].energy[1] - 1e-6, "{pair:?}");
    }
    assert!(found[0].energy[1] < 0.02 * found[0].energy[0], "{:?}", found[0]);
    assert_eq!((found[5].eye, found[5].moved_m, found[5].evaluations), (USER, 0.0, [0, 1]));
}

#[test]
fn nothing_to_deform_leaves_the_eye() {
    let found = adjust_viewpoint(USER, TARGET, FLAT, &mut Ridge::new(50.0, false), &ViewpointOptions::default());
    assert_eq!(found.unwrap().eye, USER);
    let unusable = adjust_viewpoint(USER, TARGET, FLAT, &mut |_| None, &ViewpointOptions::default());
    assert!(unusable.is_none());
}

#[test]
fn the_result_never_costs_more_than_staying_and_lies_in_the_box() {
    let options = ViewpointOptions::default();
    for seed in 0..20 {
        // Bumpy, with holes where the energy is unusable.
        let bumpy = |eye: DVec3| {
            let p = eye * 0.013 + DVec3::splat(f64::from(seed));
            let e = 2.0 + p.x.sin() + (1.7 * p.y).cos() + (2.3 * p.z).sin() * p.x.cos();
            (eye == USER || (p.x * 3.0).sin() < 0.9).then_some(e.max(0.1))
        };
        let found = adjust_viewpoint(USER, TARGET, FLAT, &mut { bumpy }, &options).unwrap();
        assert!(found.energy[1] <= found.energy[0] + 1e-12, "{found:?}");
        let (a, b) = ((USER - TARGET).truncate(), (found.eye - TARGET).truncate());
        assert!(a.angle_to(b).abs() <= options.azimuth + 1e-9);
        assert!((b.length() / a.length() - 1.0).abs() <= options.distance + 1e-9);
        assert!((found.eye.z - USER.z).abs() <= options.height_m + 1e-9);
    }
}

#[test]
fn the_eye_stays_clear_of_the_ground() {
    // The lower the better, but the ground rises to 20 m under the lowest eye of the box.
    let mut low = |eye: DVec3| Some(1.0 + (eye.z - 100.0).max(0.0));
    let options = ViewpointOptions { slider: 0.0, steps: 40, ..ViewpointOptions::default() };
    let found = adjust_viewpoint(USER, TARGET, &|_| Some(280.0), &mut low, &options).unwrap();
    assert!(found.eye.z > 300.0 && found.eye.z < 400.0, "{found:?}");
    let found = adjust_viewpoint(USER, TARGET, &|_| None, &mut low, &options).unwrap();
    assert!((found.eye.z - 300.0).abs() < 1.0, "no ground, no barrier: {found:?}");
}

#[test]
fn the_envelope_theorem_is_the_derivative_and_saves_evaluations() {
    let energy = |z: f64| Ridge::new(280.0, true).energy(DVec3::new(0.0, -1000.0, z)).unwrap();
    let mut ridge = Ridge::new(280.0, true);
    ridge.energy(USER);
    let difference = (energy(500.01) - energy(499.99)) / 0.02;
    assert!((ridge.slope().unwrap() - difference).abs() < 1e-6 * difference.abs());
    let run = |offers| {
        let mut ridge = Ridge::new(280.0, offers);
        let options = ViewpointOptions { slider: 0.2, search: [1; 3], steps: 20, ..ViewpointOptions::default() };
        (adjust_viewpoint(USER, TARGET, FLAT, &mut ridge, &options).unwrap(), ridge.asked)
    };
    let ((by_theorem, few), (by_difference, many)) = (run(true), run(false));
    assert!(by_theorem.eye.distance(by_difference.eye) < 10.0, "{by_theorem:?} {by_difference:?}");
    assert!(few < many, "{few} < {many}");
}

#[test]
fn ghosts_fade_with_slack() {
    assert_eq!(opacity(0.0, 5.0), 1.0);
    assert_eq!(opacity(5.0, 5.0), 0.5);
    assert!(opacity(1e6, 5.0) < 1e-5 && opacity(-1.0, 5.0) == 1.0);
}

/// A ridge 20 km and a lowland route 30 km north of the eye, on an earth that has dropped by 70 m there.
fn far_ridge() -> (Scene, DVec3) {
    let n = 81usize;
    let height = |i: usize| {
        let y = (n - 1 - i / n) as f64 * 500.0;
        (300.0 * (-((y - 22_000.0) / 2000.0).powi(2)).exp()) as f32
    };
    let heights = (0..n * n).map(height).collect();
    let hf = Heightfield::measured(DVec2::new(0.0, 40_000.0), DVec2::splat(500.0), n, n, heights).unwrap();
    let route = (0..=20).map(|i| DVec3::new(15_000.0 + 500.0 * f64::from(i), 32_000.0, 0.0)).collect();
    let scene = Scene { layers: vec![terrain_layer(hf), line_layer("route", route)], ..Scene::default() };
    (scene, DVec3::new(20_000.0, 2000.0, 500.0))
}

#[test]
fn energies_of_the_adjustment_are_those_of_the_round_earth_under_each_eye() {
    let (scene, user) = far_ridge();
    let target = DVec3::new(20_000.0, 32_000.0, 0.0);
    let lens = Projection::Perspective { fov_y: 60f64.to_radians() };
    let view = |eye: DVec3, earth: bool| {
        let pinhole = Pinhole::look_at(eye, target, DVec3::Z, lens, [640, 480], 1.0, None).unwrap();
        let stage = EarthCurvature { eye, radius: 6.371e6, refraction: EarthCurvature::REFRACTION };
        View::new(pinhole, if earth { vec![Stage::EarthCurvature(stage)] } else { Vec::new() }).unwrap()
    };
    let solver = TerrainSolver::new(TerrainSettings::default()).unwrap();
    let energy = |base: &View| {
        let solved = solver.solve(&scene, base, &mut TerrainMemory::default(), &Progress::silent()).unwrap();
        solved.report.qp.unwrap().energy
    };
    let options = ViewpointOptions { slider: 0.1, distance: 0.3, ..ViewpointOptions::default() };
    let found = solver.adjust(&scene, &view(user, true), target, &options, &Progress::silent()).unwrap().unwrap();
    assert!(found.moved_m > 100.0, "the camera stays: {found:?}");
    for (eye, theirs) in [(user, found.energy[0]), (found.eye, found.energy[1])] {
        let (round, flat) = (energy(&view(eye, true)), energy(&view(eye, false)));
        assert!((theirs - round).abs() < 0.01 * round, "{theirs} is not the energy {round} at {eye}");
        assert!((flat - round).abs() > 0.1 * round, "the earth makes no difference: {flat} and {round} at {eye}");
    }
}
