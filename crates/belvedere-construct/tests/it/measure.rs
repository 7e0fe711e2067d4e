use belvedere_construct::{ConstructError, MeasureOptions, Measures, measure};
use belvedere_core::{DVec3, View};
use belvedere_scene::{Progress, Renderer, Scene};
use belvedere_testkit::synthetic::{Marcher, camera, line_layer, on_a_small_planet, point_layer, scene};

fn run(scene: &Scene, view: &View, renderer: Option<&dyn Renderer>) -> Result<Measures, ConstructError> {
    measure(
        scene,
        view,
        renderer,
        &MeasureOptions { buffer_scale: Some(1), ..MeasureOptions::default() },
        &Progress::silent(),
    )
}

#[test]
fn line_of_sight_and_depth_buffer_agree_within_one_percent() {
    for (seed, height) in [(1, 500.0), (5, 300.0)] {
        let scene = scene(48, seed);
        let pinhole = camera(&scene, height, [640, 360]);
        for view in [View::straight(pinhole.clone()), on_a_small_planet(pinhole.clone(), 15_000.0)] {
            let m = run(&scene, &view, Some(&Marcher { fault: 1.0 })).unwrap();
            let lines = m.lines.unwrap();
            assert!(lines.straight.in_frame > 1000.0, "route out of the picture: {lines:?}");
            assert!(m.largest_difference.unwrap() <= 0.01, "seed {seed}: {lines:#?}");
            assert!(lines.bent.surface_missed_share.unwrap() < 0.01, "seed {seed}: {lines:#?}");
            let share = lines.straight.sight.share.unwrap();
            assert!((0.05..0.97).contains(&share), "seed {seed}: share {share} tests one side only");
        }
    }
}

#[test]
fn a_depth_buffer_one_percent_off_is_found_out() {
    let scene = scene(48, 1);
    let view = View::straight(camera(&scene, 500.0, [480, 270]));
    let judge = |fault| run(&scene, &view, Some(&Marcher { fault })).unwrap();
    let (nearer, farther) = (judge(0.99), judge(1.01));
    assert!(nearer.largest_difference.unwrap() > 0.1, "ground 1 % too near went unnoticed: {:#?}", nearer.lines);
    let missed = farther.lines.unwrap().straight.surface_missed_share.unwrap();
    assert!(missed > 0.3, "ground 1 % too far went unnoticed: {missed}");
}

#[test]
fn amounts_add_up() {
    let mut scene = scene(48, 1);
    scene.layers.push(point_layer("summit", DVec3::new(1000.0, 1200.0, 0.0)));
    let view = View::straight(camera(&scene, 500.0, [480, 270]));
    let m = run(&scene, &view, None).unwrap();
    let (lines, points) = (m.lines.unwrap(), m.points.unwrap());
    assert_eq!(m.features.len(), 2);
    let Some(trail) = scene.layers[1].kind.lines() else { unreachable!("the second layer is the trail") };
    let corners = trail.features[0].points.windows(2);
    let plan: f64 = corners.map(|w| w[0].truncate().distance(w[1].truncate())).sum();
    assert!((lines.total - plan).abs() < 1e-6, "a trail of {plan} m in plan measures {} m", lines.total);
    assert!(lines.straight.sight.visible <= lines.straight.in_frame && lines.straight.in_frame <= lines.total + 1e-9);
    assert_eq!(lines.straight, lines.bent, "no bend, no difference");
    assert_eq!((points.total, points.samples), (1.0, 1));
    assert_eq!(m.bend.folded_share, 0.0);
    assert_eq!(m.bend.displacement_max, 0.0);
    assert!(m.bend.facing_min.unwrap() > 0.0);
    assert!(m.largest_difference.is_none(), "nothing to compare without a renderer");
    let json = serde_json::to_string(&m.bend).unwrap();
    assert!(!json.contains("null"), "{json}");
}

#[test]
fn degenerate_features_have_defined_answers() {
    let base = scene(32, 1);
    let view = View::straight(camera(&base, 500.0, [160, 90]));
    let with = |points: Vec<DVec3>| {
        let mut s = base.clone();
        s.layers[1] = line_layer("odd", points);
        run(&s, &view, Some(&Marcher { fault: 1.0 })).unwrap()
    };
    let empty = with(Vec::new());
    assert_eq!(empty.lines.as_ref().unwrap().straight.sight.share, None);
    assert!(empty.warnings[0].text().contains("no point to judge"), "{:?}", empty.warnings);
    let one = with(vec![DVec3::new(700.0, 700.0, 0.0)]);
    assert_eq!(one.lines.unwrap().total, 0.0);
    let outside = with(vec![DVec3::new(-9000.0, -9000.0, 0.0), DVec3::new(-9500.0, -9000.0, 0.0)]);
    let lines = outside.lines.unwrap();
    assert!((lines.total - 500.0).abs() < 1e-6, "{}", lines.total);
    assert_eq!((lines.straight.in_frame, lines.straight.sight.share), (0.0, None));
    let nothing = [lines.straight.in_frame, lines.straight.sight.visible];
    assert!(nothing.iter().all(|x| x.is_sign_positive()), "reports do not say -0.0: {nothing:?}");
    let not_finite = with(vec![DVec3::new(f64::NAN, 700.0, 0.0), DVec3::new(700.0, 700.0, 0.0)]);
    assert_eq!(not_finite.lines.unwrap().total, 0.0);
}

#[test]
fn an_eye_under_ground_sees_nothing_and_says_why() {
    let scene = scene(32, 1);
    let mut pinhole = camera(&scene, 500.0, [480, 270]);
    pinhole.eye = DVec3::new(800.0, 200.0, 900.0);
    let m = run(&scene, &View::straight(pinhole), None).unwrap();
    assert_eq!(m.lines.unwrap().straight.sight.visible, 0.0);
    assert!(m.warnings[0].text().contains("under ground"), "{:?}", m.warnings);
}

#[test]
fn nothing_to_see_is_an_error() {
    let mut scene = scene(16, 1);
    scene.layers[1].must_see = false;
    let view = View::straight(camera(&scene, 500.0, [480, 270]));
    let error = run(&scene, &view, None).unwrap_err().to_string();
    assert!(error.contains("must_see"), "{error}");
}

#[test]
fn cancelling_stops_the_measure() {
    let scene = scene(16, 1);
    let progress = Progress::silent();
    progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let view = View::straight(camera(&scene, 500.0, [480, 270]));
    let result = measure(&scene, &view, None, &MeasureOptions::default(), &progress);
    assert!(matches!(result, Err(ConstructError::Cancelled(_))));
}

#[test]
fn shares_are_of_whole_features_wherever_they_lie() {
    let base = scene(48, 3);
    let bounds = base.bounds();
    let pinhole = camera(&base, 4000.0, [480, 270]);
    let middle = bounds.center();
    // A line along the direction of view: part in the picture, part before its lower border, part behind the eye, part beside the ground.
    let ahead = pinhole.forward.truncate().normalize();
    let along = |t: f64| (middle.truncate() + t * ahead).extend(0.0);
    let half = 0.5 * (bounds.max - bounds.min).truncate().length();
    for (from, to) in [(-3.0, 0.4), (-0.2, 0.2), (-6.0, -3.0), (0.1, 5.0)] {
        let mut long = base.clone();
        long.layers[1] = line_layer("long", vec![along(from * half), along(to * half)]);
        let view = View::straight(pinhole.clone());
        let m = run(&long, &view, None).unwrap();
        let ([straight, bent], line) = (m.shares().unwrap(), m.lines.unwrap());
        assert_eq!(straight, bent, "no bend, no difference");
        assert!((straight.in_frame - line.straight.in_frame / line.total).abs() < 1e-12);
        assert!((straight.visible - line.straight.sight.visible / line.total).abs() < 1e-12);
        assert!(straight.visible <= straight.in_frame && straight.in_frame <= 1.0, "{straight:?}");
        assert_eq!(line.straight.in_frame_share, Some(straight.in_frame));
        assert_eq!(line.straight.visible_share, Some(straight.visible));
        // The same points, projected one by one.
        let steps = 4000;
        let inside = (0..steps).filter(|i| {
            let p = along(half * (from + (to - from) * (f64::from(*i) + 0.5) / f64::from(steps)));
            let on_ground = long.terrain().unwrap().surface_at(p.truncate()).unwrap_or(0.0);
            let image = view.project(p.truncate().extend(on_ground));
            image.is_ok_and(|i| i.depth >= pinhole.near && pinhole.contains(i.pixel))
        });
        let expected = inside.count() as f64 / f64::from(steps);
        assert!((straight.in_frame - expected).abs() < 0.02, "{from}..{to}: {straight:?}, {expected} by projection");
    }
    // Nothing in the frame: nothing is visible, and that is said with a number.
    let away = belvedere_core::Pinhole { forward: -pinhole.forward, right: -pinhole.right, ..pinhole.clone() };
    let [nothing, _] = run(&base, &View::straight(away), None).unwrap().shares().unwrap();
    assert_eq!((nothing.visible, nothing.in_frame), (0.0, 0.0));
    // Of two kinds the least counts: a point outside the picture is not seen.
    let mut two = base.clone();
    two.layers.push(point_layer("behind", along(-3.0 * half)));
    let [both, _] = run(&two, &View::straight(pinhole), None).unwrap().shares().unwrap();
    assert_eq!((both.visible, both.in_frame), (0.0, 0.0));
}
