use belvedere_construct::{default_spacing, sample_features};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{BoxLayer, BoxShape, Color, Heightfield, Layer, LayerKind, NodeState, Scene};
use belvedere_sight::{Ground, Obstacles, SightOptions};
use belvedere_testkit::synthetic::{camera, march, mountains, on_a_small_planet, scene};

/// Smallest height above the surface at ten thousand points of the segment.
fn dense_gap(hf: &Heightfield, a: DVec3, b: DVec3) -> f64 {
    let gaps = (0..=10_000).filter_map(|i| {
        let p = a.lerp(b, f64::from(i) / 10_000.0);
        Some(p.z - hf.surface_at(p.truncate())?)
    });
    gaps.fold(f64::INFINITY, f64::min)
}

#[test]
fn smallest_gap_of_a_segment_is_that_of_ten_thousand_points() {
    let hf = mountains(48, 3);
    let ground = Ground::new(&hf);
    let size = hf.bounds().max.x;
    let mut hidden = 0;
    for i in 0..400 {
        let r = |k: u32| (f64::from(i * 7 + k) * 0.754_877_666).fract();
        // Some start or end outside the terrain, some run along grid lines.
        let mut a = DVec3::new(size * (1.4 * r(0) - 0.2), size * (1.4 * r(1) - 0.2), 1050.0 + 400.0 * r(2));
        let b = DVec3::new(size * (1.4 * r(3) - 0.2), size * r(4), 1050.0 + 400.0 * r(5));
        if i % 10 == 0 {
            a.x = b.x;
        }
        let dense = dense_gap(&hf, a, b);
        let gap = ground.min_gap(a, b, 1e6, f64::NEG_INFINITY);
        if !dense.is_finite() {
            assert_eq!(gap, 1e6, "segment {i} never lies over the terrain");
            continue;
        }
        // The exact minimum is never above the sampled one; samples are under 0.6 m apart on slopes below 3.
        assert!(gap <= dense + 1e-9 && gap > dense - 1.0, "segment {i}: {gap} instead of {dense}");
        assert_eq!(ground.sees(a, b), gap >= 0.0, "segment {i}");
        assert_eq!(
            ground.min_gap(a, b, 20.0, f64::NEG_INFINITY),
            gap.min(20.0),
            "segment {i}: the cap changes the answer"
        );
        hidden += i32::from(gap < 0.0);
    }
    assert!((50..350).contains(&hidden), "{hidden} of 400 hidden: the fixture tests one side only");
}

#[test]
fn a_segment_along_a_grid_line_and_a_vertical_one_are_exact() {
    let hf =
        Heightfield::new(DVec2::new(0.0, 20.0), DVec2::splat(10.0), 3, 3, vec![5.0; 9], vec![NodeState::Measured; 9])
            .unwrap();
    let ground = Ground::new(&hf);
    let gap = |a: [f64; 3], b: [f64; 3]| ground.min_gap(a.into(), b.into(), 1e3, f64::NEG_INFINITY);
    assert!((gap([10.0, -5.0, 9.0], [10.0, 25.0, 9.0]) - 4.0).abs() < 1e-9);
    assert!((gap([10.0, 10.0, 9.0], [10.0, 10.0, 6.0]) - 1.0).abs() < 1e-9);
    assert!((gap([20.0, 0.0, 8.0], [0.0, 20.0, 4.0]) + 1.0).abs() < 1e-9);
    assert_eq!(gap([-5.0, 0.0, 8.0], [-1.0, 20.0, 4.0]), 1e3, "beside the terrain");
    assert_eq!(gap([f64::NAN, 0.0, 8.0], [-1.0, 20.0, 4.0]), 1e3, "not a number is nowhere");
}

/// Line of sight against a dense march along the same ray, for straight and for curved rays.
fn against_march(view: &View, scene: &Scene) -> (usize, usize) {
    let obstacles = Obstacles::new(scene);
    let hf = scene.terrain().unwrap();
    let options = SightOptions { chord_m: 0.05, cap_m: 50.0, guard_m: 75.0 };
    let (mut judged, mut hidden) = (0, 0);
    for sample in &sample_features(scene, default_spacing(scene))[0].samples {
        let image = view.project(sample.p_world).unwrap();
        let clearance = obstacles.clearance(view, (sample.p_world, sample.lift), (image.pixel, image.depth), &options);
        let first = march(view, hf, image.pixel, 1.0, image.depth * (1.0 - 1e-7), 20_000);
        if clearance.abs() < 0.5 {
            continue; // grazing: twenty thousand steps may slip through
        }
        judged += 1;
        hidden += usize::from(first.is_some());
        assert_eq!(clearance < 0.0, first.is_some(), "clearance {clearance}, first hit {first:?} of {}", image.depth);
    }
    (judged, hidden)
}

#[test]
fn straight_lines_of_sight_agree_with_a_dense_march() {
    let scene = scene(64, 1);
    let (judged, hidden) = against_march(&View::straight(camera(&scene, 500.0, [320, 180])), &scene);
    assert!(judged > 150 && hidden > 20 && hidden + 20 < judged, "{hidden} of {judged} hidden");
}

#[test]
fn curved_lines_of_sight_agree_with_a_dense_march() {
    let scene = scene(64, 2);
    let view = on_a_small_planet(camera(&scene, 900.0, [320, 180]), 12_000.0);
    let (judged, hidden) = against_march(&view, &scene);
    assert!(judged > 150 && hidden > 20 && hidden + 20 < judged, "{hidden} of {judged} hidden");
}

#[test]
fn boxes_hide_what_is_behind_them_only() {
    let tower =
        BoxShape { base: DVec3::ZERO, size: DVec3::new(10.0, 20.0, 30.0), yaw: 0.5, color: Color::rgb(1, 2, 3) };
    let kind = LayerKind::Boxes(BoxLayer::new(vec![tower]));
    let scene = Scene { layers: vec![Layer { id: "towers".into(), must_see: false, kind }], ..Scene::default() };
    let obstacles = Obstacles::new(&scene);
    let gap = |a: [f64; 3], b: [f64; 3]| obstacles.min_gap(a.into(), b.into(), 100.0, f64::NEG_INFINITY);
    assert!(gap([-50.0, 0.0, 10.0], [50.0, 0.0, 10.0]) < 0.0, "through the middle");
    assert_eq!(gap([-50.0, 0.0, 31.0], [50.0, 0.0, 31.0]), 100.0, "over the top");
    assert_eq!(gap([-50.0, 0.0, 10.0], [-14.0, 0.0, 10.0]), 100.0, "ends in front");
    assert_eq!(gap([9.5, -50.0, 10.0], [9.5, 50.0, 10.0]), 100.0, "passes the turned corner");
}
