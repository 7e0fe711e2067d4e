//! Auto-probing in towns and canyons nobody has placed a turn in.

use crate::preview::{canyon, path};
use belvedere_construct::rays::{ProbeMemory, ProbeOptions, Probed, Target, TargetSight, auto_probe};
use belvedere_core::{Aabb, CurvedRays, DVec2, DVec3, Pinhole, Projection, View};
use belvedere_scene::{BoxShape, Progress, Scene};
use belvedere_testkit::Random;

const IMAGE: [u32; 2] = [640, 360];

fn camera(eye: DVec3, look_at: DVec3) -> View {
    let lens = Projection::Perspective { fov_y: 0.7 };
    View::straight(Pinhole::look_at(eye, look_at, DVec3::Z, lens, IMAGE, 1.0, None).unwrap())
}

fn probe(scene: &Scene, base: &View) -> Probed {
    let mut memory = ProbeMemory::default();
    auto_probe(scene, base, &ProbeOptions::default(), None, &mut memory, &Progress::silent()).unwrap()
}

/// Points on the walls and tops of boxes, chosen without the probe.
fn on_boxes(scene: &Scene, count: usize, random: &mut Random) -> Vec<DVec3> {
    let boxes = scene.layers.iter().filter_map(|l| l.kind.boxes().map(|b| &b.boxes));
    let boxes: Vec<&BoxShape> = boxes.flatten().collect();
    (0..count)
        .map(|_| {
            let shape = boxes[random.below(boxes.len())];
            let [u, v] = [random.range(-0.5, 0.5), random.range(-0.5, 0.5)];
            let side = match random.below(5) {
                0 => DVec3::new(0.5001, u, v + 0.5),
                1 => DVec3::new(-0.5001, u, v + 0.5),
                2 => DVec3::new(u, 0.5001, v + 0.5),
                3 => DVec3::new(u, -0.5001, v + 0.5),
                _ => DVec3::new(u, v, 1.0001),
            };
            shape.base + side * shape.size
        })
        .collect()
}

fn share(scene: &Scene, view: &View, points: &[DVec3]) -> f64 {
    let target = Target::points(points.iter().copied());
    TargetSight::new(scene, &target).share(view, 0.0)
}

/// The turns make a camera of their own, and its rays lead where its points are seen.
fn assert_valid(view: &View, bounds: &Aabb, random: &mut Random) {
    let rays = view.curved_rays().expect("bent");
    CurvedRays::new(view.pinhole(), rays.model(), rays.spec()).expect("valid");
    let mut seen = 0;
    for _ in 0..3000 {
        let p = random.point(bounds);
        let Ok(image) = view.project(p) else { continue };
        if view.pinhole().contains(image.pixel) && image.depth > 1.0 {
            seen += 1;
            let back = view.ray(image.pixel).at(image.depth).expect("on the ray").point;
            assert!(back.distance(p) < 1e-6 * (1.0 + p.length()), "{p} {back}");
        }
    }
    assert!(seen > 100, "{seen}");
}

#[test]
fn towns_show_more_of_what_their_towers_hide() {
    for seed in 0..5 {
        let (scene, _) = belvedere_builtin::street(seed).unwrap();
        let mut random = Random::new(seed);
        let around = random.range(0.0, std::f64::consts::TAU);
        let eye = (600.0 * DVec2::from_angle(around)).extend(random.range(60.0, 140.0));
        let base = camera(eye, DVec3::new(0.0, 0.0, 30.0));
        let found = probe(&scene, &base);
        let report = &found.report;
        assert!((1..=3).contains(&report.turns) && report.gained > 1.5 * report.lost, "{seed}: {report:?}");
        assert!(report.seen > 1.2 * report.seen_straight, "{seed}: {report:?}");
        assert!((report.gained - report.lost - (report.seen - report.seen_straight)).abs() < 1e-9);
        let boxes = scene.layers[3].bounds();
        assert_valid(&found.view, &boxes, &mut random);
        let points = on_boxes(&scene, 1500, &mut random);
        let [straight, bent] = [&base, &found.view].map(|v| share(&scene, v, &points));
        assert!(bent > 1.15 * straight, "{seed}: {straight} {bent}");
    }
}

#[test]
fn canyons_show_more_of_their_walls() {
    for seed in 0..3 {
        let path = path(seed);
        let scene = Scene::default().with_terrain("ground", canyon(&path));
        let base = camera(path[200] + 40.0 * DVec3::Z, path[235] + 40.0 * DVec3::Z);
        let found = probe(&scene, &base);
        assert!(found.report.turns >= 1, "{:?}", found.report);
        assert_valid(&found.view, &scene.bounds(), &mut Random::new(seed));
        // Points on the ground, a regular lattice.
        let ground = scene.terrain().unwrap();
        let (low, high) = (ground.bounds().min.truncate(), ground.bounds().max.truncate());
        let points: Vec<DVec3> = (0..10_000)
            .map(|i| low + (high - low) * DVec2::new(f64::from(i % 100) + 0.5, f64::from(i / 100) + 0.5) / 100.0)
            .filter_map(|xy| Some(xy.extend(ground.surface_at(xy)? + 0.5)))
            .collect();
        let [straight, bent] = [&base, &found.view].map(|v| share(&scene, v, &points));
        assert!(bent > straight, "{seed}: {straight} {bent}");
    }
}

#[test]
fn the_same_scene_gives_the_same_camera_and_open_ground_none() {
    let (scene, _) = belvedere_builtin::street(11).unwrap();
    let base = camera(DVec3::new(-600.0, 80.0, 90.0), DVec3::new(0.0, 0.0, 30.0));
    let [a, b] = [probe(&scene, &base), probe(&scene, &base)];
    assert_eq!((&a.view, &a.report), (&b.view, &b.report));
    let flat =
        belvedere_scene::Heightfield::measured(DVec2::ZERO, DVec2::splat(10.0), 50, 50, vec![0.0; 2500]).unwrap();
    let plain = Scene::default().with_terrain("ground", flat);
    let down = camera(DVec3::new(250.0, -400.0, 300.0), DVec3::new(250.0, -250.0, 0.0));
    let found = probe(&plain, &down);
    assert!(!found.view.is_bent() && found.report.turns == 0, "{:?}", found.report);
    assert_eq!(found.report.seen, found.report.seen_straight);
    assert!(!probe(&Scene::default(), &base).view.is_bent(), "nothing hides nothing");
}

#[test]
fn in_a_film_turns_come_in_gradually_and_stay() {
    let (scene, _) = belvedere_builtin::street(7).unwrap();
    let base = camera(DVec3::new(-700.0, 10.0, 60.0), DVec3::new(0.0, 0.0, 30.0));
    let (mut memory, progress) = (ProbeMemory::default(), Progress::silent());
    let options = ProbeOptions { cap_per_s: 0.5, ..ProbeOptions::default() };
    let mut random = Random::new(1);
    let bounds = scene.layers[3].bounds();
    let points: Vec<DVec3> = (0..500).map(|_| random.point(&bounds)).collect();
    let (mut before, mut seen): (Option<View>, Vec<f64>) = (None, Vec::new());
    for _ in 0..30 {
        let now = auto_probe(&scene, &base, &options, Some(0.1), &mut memory, &progress).unwrap();
        if let Some(before) = &before {
            let moved = points.iter().filter_map(|p| {
                let (a, b) = (before.project(*p).ok()?, now.view.project(*p).ok()?);
                base.pinhole().contains(a.pixel).then(|| a.pixel.distance(b.pixel))
            });
            // The whole comes to some hundred pixels.
            let most = moved.fold(0.0, f64::max);
            assert!(most < 40.0, "{most} px at {}", now.report.entered);
        }
        seen.push(now.report.seen);
        before = Some(now.view);
    }
    let still = probe(&scene, &base);
    assert_eq!(seen[0], still.report.seen_straight, "the first frame is straight");
    assert_eq!(before.as_ref(), Some(&still.view), "the last is what a still shows at once");
    // A camera that turns away is straight again, by degrees.
    let away = camera(DVec3::new(-700.0, 10.0, 60.0), DVec3::new(-1400.0, 0.0, 30.0));
    let mut entered = still.report.turns as f64;
    for _ in 0..30 {
        let now = auto_probe(&scene, &away, &options, Some(0.1), &mut memory, &progress).unwrap().report.entered;
        assert!((entered - now).abs() < 0.051, "{entered} {now}");
        entered = now;
    }
    assert!(entered < 0.6, "{entered}");
}

#[test]
fn parameters_out_of_range_orthographic_cameras_and_cancelling_are_errors() {
    let (scene, _) = belvedere_builtin::street(1).unwrap();
    let base = camera(DVec3::new(-600.0, 80.0, 90.0), DVec3::new(0.0, 0.0, 30.0));
    let fails = |base: &View, options: ProbeOptions, progress: &Progress| {
        auto_probe(&scene, base, &options, None, &mut ProbeMemory::default(), progress).unwrap_err().to_string()
    };
    let (usual, silent) = (ProbeOptions::default(), Progress::silent());
    assert!(fails(&base, ProbeOptions { turns: 7, ..usual }, &silent).contains("turns is 7"));
    assert!(fails(&base, ProbeOptions { reach: Some(0.0), ..usual }, &silent).contains("reach_m is 0"));
    assert!(fails(&base, ProbeOptions { cap_per_s: f64::NAN, ..usual }, &silent).contains("cap_per_s is NaN"));
    let lens = Projection::Orthographic { height: 100.0 };
    let flat = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, IMAGE, 1.0, None).unwrap();
    assert!(fails(&View::straight(flat), usual, &silent).contains("perspective"));
    let cancelled = Progress::silent();
    cancelled.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    assert!(fails(&base, usual, &cancelled).contains("cancelled"));
}
