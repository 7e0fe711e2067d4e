use belvedere_construct::{
    ConstructError, Goal, MeasureOptions, RevealMemory, RevealOptions, Revealed, measure, reveal,
};
use belvedere_core::{DVec3, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{Progress, Scene};
use belvedere_testkit::synthetic::{camera, line_layer, scene};

fn run(scene: &Scene, base: Option<&View>) -> Result<Revealed, ConstructError> {
    reveal(scene, base, &RevealOptions::default(), &mut RevealMemory::default(), &Progress::silent())
}

/// Checks the goals of the command by the measure with the renderer, not by the search's own figures.
pub(crate) fn assert_bars(name: &str, scene: &Scene, found: &Revealed) {
    let m = measure(scene, &found.view, Some(&CpuRenderer::default()), &MeasureOptions::default(), &Progress::silent())
        .unwrap();
    let lines = m.lines.unwrap();
    let share = |v: &measure::Visibility| v.sight.share.unwrap();
    let (straight, bent) = (share(&lines.straight), share(&lines.bent));
    assert!(straight <= 0.6, "{name}: the straight picture already shows {straight}");
    assert!(
        bent >= 0.75 && bent >= 1.5 * straight,
        "{name}: {bent} visible, {straight} straight; {:?}",
        found.report.goal
    );
    assert!(lines.bent.in_frame >= 0.9 * lines.straight.in_frame, "{name}: the route was pushed out of the picture");
    assert!(lines.bent.sight.visible >= 1.35 * lines.straight.sight.visible, "{name}: not more in absolute length");
    assert_eq!((m.bend.folded_share, lines.bent.folded_share), (0.0, 0.0), "{name}: folds");
    assert!(m.bend.facing_min.unwrap() > 0.0 && found.report.facing > 0.0, "{name}: ground turned away from the eye");
    assert!(m.largest_difference.unwrap() <= 0.01, "{name}: the two methods differ by {:?}", m.largest_difference);
    assert_eq!(found.report.goal, Goal::Reached, "{name}");
    assert!((found.report.bent.visible - bent).abs() < 0.03, "{name}: the report says {}", found.report.bent.visible);
}

#[test]
fn the_built_in_massif_shows_its_trail() {
    let (scene, _) = belvedere_builtin::massif(1, 257).unwrap();
    assert_bars("massif", &scene, &run(&scene, None).unwrap());
}

#[test]
fn a_given_camera_is_kept() {
    let (scene, suggested) = belvedere_builtin::massif(1, 257).unwrap();
    let lens = belvedere_core::Projection::Perspective { fov_y: suggested.fov_y };
    let pinhole =
        belvedere_core::Pinhole::look_at(suggested.eye, suggested.look_at, DVec3::Z, lens, [640, 360], 1.0, None)
            .unwrap();
    let base = View::straight(pinhole);
    let found = run(&scene, Some(&base)).unwrap();
    assert_eq!(found.view.pinhole(), base.pinhole());
    assert_eq!(found.straight, base);
    assert_eq!(found.report.eyes_tried, 0);
    let (straight, bent) = (found.report.straight, found.report.bent);
    assert!(bent.visible > 1.3 * straight.visible, "{bent:?} after {straight:?}");
    assert!(bent.in_frame >= 0.9 * straight.in_frame, "{bent:?} after {straight:?}");
}

#[test]
fn the_answer_does_not_depend_on_threads_and_starts_from_memory() {
    let scene = scene(64, 4);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let together = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
    let (a, b) = (alone.install(|| run(&scene, None).unwrap()), together.install(|| run(&scene, None).unwrap()));
    assert_eq!(a.view, b.view);
    assert_eq!(a.report, b.report);
    let mut memory = RevealMemory::default();
    let options = RevealOptions::default();
    let first = reveal(&scene, Some(&a.straight), &options, &mut memory, &Progress::silent()).unwrap();
    let again = reveal(&scene, Some(&a.straight), &options, &mut memory, &Progress::silent()).unwrap();
    assert!(again.report.bent.visible >= first.report.bent.visible - 0.05, "memory made it worse");
}

#[test]
fn the_document_describes_the_bend() {
    let scene = scene(64, 4);
    let found = run(&scene, None).unwrap();
    let json = serde_json::to_string(&found.document).unwrap();
    let document = serde_json::from_str(&json).unwrap();
    let plane = belvedere_core::map::spline::ReferencePlane::level(found.plane_height);
    let bend = belvedere_core::SplineBend::new(found.view.pinhole(), &document, &plane, found.pivot).unwrap();
    let p = scene.bounds().center();
    let stage = belvedere_core::Stage::SplineBend(bend);
    let again = stage.apply(p).unwrap();
    assert!(again.distance(found.view.displace(p).unwrap().point) < 1e-9);
}

#[test]
fn unusable_input_is_refused_with_a_reason() {
    let fixture = scene(48, 1);
    let refuse = |scene: &Scene, base: Option<&View>, wanted: &str| {
        let error = run(scene, base).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error:?} instead of {wanted:?}");
    };
    let mut nothing = fixture.clone();
    nothing.layers[1].must_see = false;
    refuse(&nothing, None, "must_see");
    let mut no_ground = fixture.clone();
    no_ground.layers.remove(0);
    refuse(&no_ground, None, "no terrain");
    let with = |points: Vec<DVec3>| {
        let mut s = fixture.clone();
        s.layers[1] = line_layer("odd", points);
        s
    };
    refuse(&with(Vec::new()), None, "odd");
    refuse(&with(vec![DVec3::new(-9e5, 0.0, 0.0), DVec3::new(-9e5, 10.0, 0.0)]), None, "hold no point on the terrain");
    let mut below = camera(&fixture, 500.0, [320, 180]);
    below.eye = DVec3::new(800.0, 800.0, 100.0);
    refuse(&fixture, Some(&View::straight(below)), "under ground");
    let mut away = camera(&fixture, 500.0, [320, 180]);
    (away.forward, away.right) = (-away.forward, -away.right);
    refuse(&fixture, Some(&View::straight(away)), "turn the camera");
}

#[test]
fn a_single_point_and_a_short_line_are_enough() {
    let mut scene = scene(64, 4);
    let z = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    scene.layers[1] = line_layer("short", vec![z(1500.0, 1500.0), z(1540.0, 1500.0)]);
    let found = run(&scene, None).unwrap();
    assert!(found.report.bent.in_frame > 0.9, "{:?}", found.report.bent);
    scene.layers[1] = belvedere_testkit::synthetic::point_layer("hut", z(1500.0, 1500.0));
    assert!(run(&scene, None).unwrap().report.bent.in_frame > 0.9);
}

#[test]
fn cancelling_stops_the_search() {
    let scene = scene(48, 1);
    let progress = Progress::silent();
    progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let result = reveal(&scene, None, &RevealOptions::default(), &mut RevealMemory::default(), &progress);
    assert!(matches!(result, Err(ConstructError::Cancelled(_))));
}
