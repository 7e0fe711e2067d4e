use super::super::cells::tests::{field_of, noise};
use super::super::visibility_qp::StraightSight;
use super::super::{TerrainSettings, Wedge, in_view, reference_points};
use super::*;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Color, Hidden, Layer, LayerKind, LineFeature, LineLayer, Scene};

fn line(field: &Field, path: &[[f64; 2]]) -> Scene {
    let points = path.iter().map(|&g| field.scene_from_grid(DVec2::from(g)).extend(0.0)).collect();
    let kind = LayerKind::Line(LineLayer {
        features: vec![LineFeature { style: None, name: String::new(), points }],
        color: Color::rgb(0, 0, 0),
        width_px: 1.0,
        casing: None,
        hidden: Hidden::Dash,
        lift_m: 1.0,
        markers: None,
        label_px: None,
        marker_px: belvedere_scene::SMALL_LETTERS_PX,
        beyond: 0.0,
    });
    Scene { layers: vec![Layer { id: "line".into(), must_see: true, kind }], ..Scene::default() }
}

/// Displacement by a function of grid coordinates, on a grid of `n` x `n` nodes over the field.
fn delta_of(field: &Field, n: usize, f: impl Fn(f64, f64) -> f64) -> Grid {
    let size = DVec2::new((field.cols() - 1) as f64, (field.rows() - 1) as f64);
    let step = size / (n - 1) as f64;
    let values = (0..n * n).map(|i| f((i % n) as f64 * step.x, (i / n) as f64 * step.y)).collect();
    Grid::new(field.north_west(), step * field.spacing(), n, n, values).unwrap()
}

fn rough(cols: usize, rows: usize, seed: u64) -> Field {
    field_of(cols, rows, DVec2::new(40.0, 30.0), |c, r| {
        1000.0 + 60.0 * noise(r * cols + c, seed) + 150.0 * (c as f64 / 4.0).sin() * (r as f64 / 5.0).cos()
    })
}

fn sight(field: &Field, eye: DVec3) -> StraightSight {
    StraightSight { eye: field.grid_from_scene(eye.truncate()), z: eye.z }
}

fn judge(scene: &Scene, field: &Field, delta: &Grid, eye: DVec3) -> TerrainMetrics {
    let settings = TerrainSettings::default();
    let wedge = Wedge::all_around(eye.truncate());
    let [points, dense] = [settings.spacing, 0.2].map(|spacing| {
        let all = reference_points(scene, field, &settings, spacing).0;
        in_view(field, &all, &wedge, settings.guard).0.into_iter().map(|i| all[i]).collect::<Vec<_>>()
    });
    let cells = Cells::new(field, 4);
    let sight = sight(field, eye);
    let (cells, guard) = (Some(&cells), settings.guard);
    terrain_metrics(&Deformation {
        field,
        delta,
        previous: None,
        cells,
        points: &points,
        dense: &dense,
        sight: &sight,
        every_node: true,
        guard,
    })
}

#[test]
fn rays_find_what_a_hundred_thousand_steps_find() {
    let mut hidden = 0;
    for seed in 0..6 {
        let field = rough(31, 27, seed);
        let delta = delta_of(&field, 9, |x, y| -40.0 + 30.0 * (0.4 * x + 0.2 * y).sin() - 0.02 * x * y);
        let u = change::at_nodes(&field, &delta);
        let displaced = field_of(31, 27, DVec2::new(40.0, 30.0), |c, r| field.heights()[r * 31 + c] + u[r * 31 + c]);
        for k in 0..12 {
            let r = |i: usize, limit: f64| limit * noise(100 * k + i, seed + 40);
            let p = DVec2::new(r(0, 30.0), r(1, 26.0));
            let eye_grid = [DVec2::new(r(2, 30.0), r(3, 26.0)), DVec2::new(-9.0, 40.0), DVec2::new(p.x, 60.0)][k % 3];
            // On grid lines and nodes, too.
            let p = if k % 4 == 0 { p.round() } else { p };
            let eye = field.scene_from_grid(eye_grid).extend(1250.0 + r(4, 100.0));
            let sight = sight(&field, eye);
            let height = |g: DVec2| displaced.surface_at(g);
            let ours = Judge::new(&field, &delta, &sight).excess(p, 1.0, 1.5).unwrap().over;
            let (z, guard) = (height(p).unwrap() + 1.0, 1.5 / (eye_grid - p).length());
            let steps = 100_000;
            let over = (0..steps).filter_map(|i| {
                let t = guard + (1.0 - guard) * f64::from(i) / f64::from(steps);
                height(p.lerp(eye_grid, t)).map(|h| h - (z + t * (eye.z - z)))
            });
            let marched = over.fold(-1.0, f64::max);
            assert!(ours >= marched - 1e-3 && ours <= marched + 0.1, "seed {seed}, ray {k}: {ours} {marched}");
            hidden += usize::from(ours > 0.0);
        }
    }
    assert!(hidden > 15, "{hidden}");
}

#[test]
fn a_wall_hides_what_is_behind_it_until_it_is_lowered() {
    // A wall 50 m high along column 20; the eye stands 100 m high at column 35.
    let field = field_of(41, 21, DVec2::splat(10.0), |c, _| if c == 20 { 550.0 } else { 500.0 });
    let scene = line(&field, &[[2.0, 10.0], [30.0, 10.0]]);
    let eye = field.scene_from_grid(DVec2::new(35.0, 10.0)).extend(600.0);
    let still = delta_of(&field, 2, |_, _| 0.0);
    let before = judge(&scene, &field, &still, eye);
    // Seen are: up to column 5 no, the line over the wall reaches the ground at 35 - 30 = 5 columns; 5.6 with the lift.
    let expected = |cut: f64| (28.0 - (20.0 - cut)) / 28.0;
    assert!(before.visible_dense > expected(5.0) - 0.4 / 28.0 - 1.6 / 28.0, "{before:?}");
    assert!(before.visible_dense < expected(5.0) + 2.5 / 28.0, "{before:?}");
    assert!(before.visible < 0.6);
    // The point two cells behind the wall sees it 50 - (1 + 99 * 2/17) m too high.
    assert!(before.hidden_worst_m > 35.0 && before.hidden_worst_m < 49.0);
    assert_eq!((before.rms_m, before.max_m, before.step_p999_m, before.normal_mean_deg), (0.0, 0.0, 0.0, 0.0));
    let lowered = delta_of(&field, 41, |x, _| if x == 20.0 { -50.0 } else { 0.0 });
    let after = judge(&scene, &field, &lowered, eye);
    assert_eq!((after.visible, after.visible_dense, after.hidden_worst_m), (1.0, 1.0, 0.0));
    assert!((after.rms_m - (2500.0f64 / 41.0).sqrt()).abs() < 1e-9);
    assert_eq!((after.max_m, after.raised_max_m), (50.0, 0.0));
}

#[test]
fn what_only_ground_inside_the_guard_hides_is_counted_by_itself() {
    // A bank 10 m high, less than a cell in front of the line; the eye stands 100 m high 15 cells behind it.
    let field = field_of(41, 21, DVec2::splat(10.0), |c, _| if c == 20 { 510.0 } else { 500.0 });
    let scene = line(&field, &[[19.0, 10.0], [19.4, 10.0]]);
    let eye = field.scene_from_grid(DVec2::new(35.0, 10.0)).extend(600.0);
    let still = judge(&scene, &field, &delta_of(&field, 2, |_, _| 0.0), eye);
    assert_eq!((still.visible, still.visible_dense, still.hidden_in_guard), (0.0, 0.0, 1.0));
    let lowered = judge(&scene, &field, &delta_of(&field, 41, |x, _| if x == 20.0 { -10.0 } else { 0.0 }), eye);
    assert_eq!((lowered.visible_dense, lowered.hidden_in_guard), (1.0, 0.0));
    // Hidden by something beyond the guard as well, it is hidden.
    let both = field_of(41, 21, DVec2::splat(10.0), |c, _| if c == 20 || c == 24 { 560.0 } else { 500.0 });
    let both = judge(&scene, &both, &delta_of(&both, 2, |_, _| 0.0), eye);
    assert_eq!((both.visible_dense, both.hidden_in_guard), (0.0, 0.0));
}

#[test]
fn a_tilt_turns_every_normal_alike_and_a_shift_none() {
    let field = field_of(30, 20, DVec2::new(10.0, 25.0), |_, _| 700.0);
    let scene = Scene::default();
    let eye = DVec3::new(0.0, 0.0, 5000.0);
    let tilted = judge(&scene, &field, &delta_of(&field, 5, |x, _| -2.0 * x), eye);
    let angle = 0.2f64.atan().to_degrees();
    assert!((tilted.normal_mean_deg - angle).abs() < 1e-9 && (tilted.normal_p95_deg - angle).abs() < 1e-9);
    assert!((tilted.max_m - 58.0).abs() < 1e-9 && (tilted.step_p999_m - 2.0).abs() < 1e-9);
    assert_eq!((tilted.visible, tilted.visible_dense, tilted.border_step_m), (1.0, 1.0, None));
    let south = judge(&scene, &field, &delta_of(&field, 5, |_, y| 5.0 * y), eye);
    assert!((south.normal_mean_deg - angle).abs() < 1e-9, "25 m between rows");
    assert!((south.raised_max_m - 95.0).abs() < 1e-9);
    let shifted = judge(&scene, &field, &delta_of(&field, 5, |_, _| -7.0), eye);
    assert_eq!((shifted.rms_m, shifted.normal_mean_deg, shifted.step_p999_m), (7.0, 0.0, 0.0));
}

#[test]
fn steps_between_cells_and_frames_are_those_of_the_displacement() {
    // Two cells: the valley is at column 15.
    let field = field_of(31, 12, DVec2::splat(10.0), |c, r| 500.0 + (c as f64 - 15.2).abs() * 10.0 + 0.01 * r as f64);
    let cells = Cells::new(&field, 2);
    assert_eq!(cells.len(), 2);
    let cut = (0..31).find(|&c| cells.labels()[c] != cells.labels()[0]).unwrap();
    assert!((0..12).all(|r| (0..31).all(|c| (c < cut) == (cells.labels()[r * 31 + c] == cells.labels()[0]))));
    let delta = delta_of(&field, 61, |x, _| if x < cut as f64 - 0.5 { -30.0 } else { 0.0 });
    let before = delta_of(&field, 61, |_, _| -10.0);
    let sight = sight(&field, DVec3::new(0.0, 0.0, 5000.0));
    let of = Deformation {
        field: &field,
        delta: &delta,
        previous: Some(&before),
        cells: Some(&cells),
        points: &[],
        dense: &[],
        sight: &sight,
        every_node: true,
        guard: 1.5,
    };
    let metrics = terrain_metrics(&of);
    assert_eq!((metrics.border_step_m, metrics.step_p999_m), (Some(30.0), 30.0));
    let frame = metrics.frame.unwrap();
    let (low, high) = (cut as f64 / 31.0, 1.0 - cut as f64 / 31.0);
    assert!((frame.rms_m - (400.0 * low + 100.0 * high).sqrt()).abs() < 1e-9);
    assert_eq!(frame.max_m, 20.0);
    let json = serde_json::to_value(metrics).unwrap();
    for key in [
        "visible",
        "visible_dense",
        "hidden_in_guard",
        "hidden_worst_m",
        "rms_m",
        "max_m",
        "raised_max_m",
        "normal_mean_deg",
        "normal_p95_deg",
        "border_step_m",
        "step_p999_m",
        "frame",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
}

#[test]
fn voids_hide_nothing_and_are_not_counted() {
    let field = field_of(41, 21, DVec2::splat(10.0), |c, _| match c {
        20 => f64::NAN,
        21 => 560.0,
        22 => f64::NAN,
        _ => 500.0,
    });
    let scene = line(&field, &[[2.0, 10.0], [18.0, 10.0]]);
    let eye = field.scene_from_grid(DVec2::new(35.0, 10.0)).extend(600.0);
    let metrics = judge(&scene, &field, &delta_of(&field, 2, |_, _| -3.0), eye);
    assert_eq!((metrics.visible, metrics.visible_dense), (1.0, 1.0), "a wall of voids is no wall");
    assert_eq!(metrics.rms_m, 3.0);
    let nowhere = line(&field, &[[20.0, 3.0], [20.0, 9.0]]);
    assert_eq!(judge(&nowhere, &field, &delta_of(&field, 2, |_, _| -3.0), eye).visible_dense, 1.0);
}

#[test]
fn threads_do_not_matter() {
    let field = rough(80, 70, 3);
    let scene = line(&field, &[[3.0, 4.0], [70.0, 60.0]]);
    let delta = delta_of(&field, 13, |x, y| -0.3 * x - 0.2 * y);
    let eye = field.scene_from_grid(DVec2::new(10.0, 66.0)).extend(1400.0);
    let with = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| judge(&scene, &field, &delta, eye))
    };
    assert_eq!(with(1), with(3));
}
