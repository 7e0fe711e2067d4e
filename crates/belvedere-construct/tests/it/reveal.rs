use belvedere_construct::{
    ConstructError, Goal, MeasureOptions, RevealMemory, RevealOptions, Revealed, measure, reveal,
};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{Heightfield, Progress, Scene};
use belvedere_testkit::synthetic::{camera, line_layer, scene, terrain_layer};

fn run(scene: &Scene, base: Option<&View>) -> Result<Revealed, ConstructError> {
    reveal(scene, base, &RevealOptions::default(), &mut RevealMemory::default(), &Progress::silent())
}

/// Checks the goals of the command by the measure with the renderer, not by the search's own figures.
pub(crate) fn assert_bars(name: &str, scene: &Scene, found: &Revealed) {
    let m = measure(scene, &found.view, Some(&CpuRenderer::default()), &MeasureOptions::default(), &Progress::silent())
        .unwrap();
    let [straight, bent] = m.shares().unwrap();
    assert!(bent.in_frame >= 0.9, "{name}: {bent}; {:?}", found.report.warnings);
    assert!(bent.visible >= 0.8, "{name}: {bent}, straight {straight}; {:?}", found.report.goal);
    assert!(bent.visible >= straight.visible, "{name}: {bent}, straight {straight}");
    assert_eq!((m.bend.folded_share, m.lines.unwrap().bent.folded_share), (0.0, 0.0), "{name}: folds");
    assert!(m.bend.facing_min.unwrap() > 0.0 && found.report.facing > 0.0, "{name}: ground turned away from the eye");
    assert!(m.largest_difference.unwrap() <= 0.01, "{name}: the two methods differ by {:?}", m.largest_difference);
    assert_eq!(found.report.goal, Goal::Reached, "{name}");
    let said = found.report.bent;
    assert!((said.visible - bent.visible).abs() < 0.03, "{name}: the report says {}", said.visible);
    assert!((said.in_frame - bent.in_frame).abs() < 0.03, "{name}: the report says {}", said.in_frame);
}

#[test]
fn the_built_in_massif_shows_its_trail() {
    let (scene, _) = belvedere_builtin::massif(1, 257).unwrap();
    assert_bars("massif", &scene, &run(&scene, None).unwrap());
}

/// Ground without relief that could hide anything, inclined by `slope`, with gentle waves of `waves` m.
fn gentle(slope: f64, waves: f64, line: [[f64; 2]; 3]) -> Scene {
    let n = 70;
    let height = |c: usize, r: usize| {
        let (x, y) = (c as f64 / n as f64, r as f64 / n as f64);
        (500.0 + slope * 60.0 * (c + r) as f64 + waves * (5.0 * x).sin() * (4.0 * y).cos()) as f32
    };
    let heights = (0..n).flat_map(|r| (0..n).map(move |c| height(c, r))).collect();
    let size = DVec2::splat(60.0 * n as f64);
    let hf = Heightfield::measured(DVec2::new(0.0, size.y), DVec2::splat(60.0), n, n, heights).unwrap();
    let points = line.map(|[x, y]| DVec3::new(x * size.x, y * size.y, 0.0)).to_vec();
    Scene { layers: vec![terrain_layer(hf), line_layer("way", points)], ..Scene::default() }
}

#[test]
fn where_nothing_is_hidden_nothing_is_bent() {
    let lines = [
        [[0.2, 0.2], [0.5, 0.7], [0.8, 0.8]],
        [[0.5, 0.1], [0.52, 0.5], [0.5, 0.9]],
        [[0.1, 0.5], [0.5, 0.5], [0.9, 0.45]],
    ];
    for (k, (slope, waves)) in [(0.0, 0.0), (0.05, 0.0), (0.0, 40.0), (-0.1, 25.0)].into_iter().enumerate() {
        let scene = gentle(slope, waves, lines[k % 3]);
        let found = run(&scene, None).unwrap();
        assert!(found.bend.is_none() && found.view == found.straight, "{slope} {waves}: {:?}", found.report);
        let report = &found.report;
        assert!(report.bent.in_frame >= 0.97, "{slope} {waves}: {report:?}");
        assert_eq!((&report.goal, report.bent), (&Goal::Reached, report.straight));
        // The same camera, given.
        let given = run(&scene, Some(&found.straight)).unwrap();
        assert!(given.bend.is_none() && given.view == found.straight);
    }
}

#[test]
fn no_answer_is_worse_than_the_straight_picture_and_whole_ways_are_in_the_frame() {
    for seed in 1..5 {
        let mut scene = scene(56, seed);
        let size = scene.bounds().max.x;
        let at = |x: f64, y: f64| DVec3::new(x * size, y * size, 0.0);
        let ways = [
            vec![at(0.1, 0.1), at(0.9, 0.9)],
            vec![at(0.05, 0.5), at(0.5, 0.55), at(0.95, 0.4)],
            vec![at(0.45, 0.5), at(0.55, 0.52)],
        ];
        scene.layers[1] = line_layer("way", ways[seed as usize % 3].clone());
        let low = View::straight(camera(&scene, 250.0 + 150.0 * seed as f64, [640, 360]));
        for base in [None, Some(&low)] {
            let found = run(&scene, base).unwrap();
            let m = measure(&scene, &found.view, None, &MeasureOptions::default(), &Progress::silent()).unwrap();
            let [straight, bent] = m.shares().unwrap();
            assert!(bent.visible >= straight.visible - 1e-9, "seed {seed}: {bent} bent, {straight} straight");
            assert!(found.bend.is_some() || bent == straight);
            let said = found.report.warnings.iter().any(|w| w.text().contains("lie in the frame"));
            assert!(base.is_some() || bent.in_frame >= 0.9 || said, "seed {seed}: {bent}");
            assert!(base.is_some() || bent.visible >= 0.9, "seed {seed}: {bent}, {straight} straight");
        }
    }
}

#[test]
fn drafts_look_from_different_sides() {
    let scene = scene(56, 2);
    let options = RevealOptions::default();
    let views = reveal::views(&scene, 5, &options, &Progress::silent()).unwrap();
    assert!(views.len() >= 3, "{} drafts", views.len());
    assert_eq!(views[0], run(&scene, None).unwrap().straight, "the first is that of reveal");
    for (i, a) in views.iter().enumerate() {
        for b in &views[..i] {
            let [a, b] = [a, b].map(|view| view.pinhole().forward.truncate());
            assert!(a.angle_to(b).abs().to_degrees() > 20.0);
        }
    }
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
    let bend = found.bend.as_ref().expect("these mountains hide a part of the trail");
    let json = serde_json::to_string(&bend.document).unwrap();
    let document = serde_json::from_str(&json).unwrap();
    let plane = belvedere_core::map::spline::ReferencePlane::level(found.plane_height);
    let bend = belvedere_core::SplineBend::new(found.view.pinhole(), &document, &plane, bend.pivot).unwrap();
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
