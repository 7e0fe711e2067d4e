//! Pictures are defined for every input and equal for any number of threads.

use crate::support::{hills, layer, line, options, pinhole, render, scene, terrain};
use crate::support_views::views;
use belvedere_core::{DVec2, DVec3, Pinhole, Projection, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    Aux, BoxLayer, BoxShape, Color, Frame, Heightfield, Hidden, LayerKind, Light, NodeState, PointFeature, PointLayer,
    Progress, RenderError, RenderJob, RenderOptions, Renderer, Scene,
};

fn full_scene() -> Scene {
    let hf = hills(100, 12.0, 150.0, 4);
    let on = |x: f64, y: f64| DVec2::new(x, y).extend(hf.surface_at(DVec2::new(x, y)).expect("on the hills"));
    let route = (0..200).map(|i| on(-500.0 + 5.0 * f64::from(i), 80.0 * (f64::from(i) * 0.07).sin())).collect();
    let points = (0..9).map(|i| PointFeature {
        style: None,
        name: String::new(),
        position: on(-400.0 + 90.0 * f64::from(i), 60.0),
    });
    let shape = BoxShape { base: on(50.0, 0.0), size: DVec3::splat(60.0), yaw: 0.4, color: Color::rgb(200, 190, 180) };
    let points = PointLayer {
        features: points.collect(),
        color: Color::rgb(20, 60, 160),
        size_px: 9.0,
        hidden: Hidden::Fade,
        lift_m: 2.0,
        style: belvedere_scene::PointStyle::default(),
        beyond: 0.0,
    };
    scene(vec![
        layer("ground", LayerKind::Terrain(terrain(hf))),
        layer("house", LayerKind::Boxes(BoxLayer::new(vec![shape]))),
        layer("route", LayerKind::Line(line(route, Hidden::Dash))),
        layer("huts", LayerKind::Point(points)),
    ])
}

fn assert_sane(name: &str, frame: &Frame, layers: usize) {
    let n = frame.width * frame.height;
    assert_eq!((frame.color.len(), frame.depth.len(), frame.id.len()), (n, n, n), "{name}");
    assert!(frame.depth.iter().all(|d| *d > 0.0), "{name}: a depth is not positive");
    assert!(frame.id.iter().all(|&id| id as usize <= layers), "{name}: an id is no layer");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let scene = full_scene();
    for (name, view) in views([333, 217]) {
        for samples in [1, 4, 16] {
            let with =
                |threads| RenderOptions { threads, aux: Aux { world: true, ..Aux::default() }, ..options(samples) };
            let one = render(&scene, &view, &with(1));
            assert_sane(name, &one, 4);
            for threads in [2, 3, 7] {
                let other = render(&scene, &view, &with(threads));
                assert!(one.color == other.color, "{name}: colour differs with {threads} threads");
                assert!(
                    one.id == other.id && one.depth == other.depth,
                    "{name}: surfaces differ with {threads} threads"
                );
                let bits = |f: &Frame| f.world.iter().flatten().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
                assert!(bits(&one) == bits(&other), "{name}: positions differ with {threads} threads");
            }
        }
    }
}

#[test]
fn odd_cameras_give_defined_pictures() {
    let scene = full_scene();
    let look = |eye: [f64; 3], at: [f64; 3], fov: f64, image: [u32; 2]| {
        View::straight(pinhole(DVec3::from_array(eye), DVec3::from_array(at), fov, image))
    };
    let under = [0.0, 0.0, -400.0];
    let cases = [
        ("one pixel", look([0.0, -500.0, 300.0], [0.0; 3], 45.0, [1, 1])),
        ("one row", look([0.0, -500.0, 300.0], [0.0; 3], 45.0, [700, 1])),
        ("one column", look([0.0, -500.0, 300.0], [0.0; 3], 45.0, [1, 700])),
        ("fov 179.9", look([0.0, -500.0, 300.0], [0.0; 3], 179.9, [200, 150])),
        ("fov 0.001", look([0.0, -500.0, 300.0], [0.0; 3], 0.001, [200, 150])),
        ("under ground", look(under, [10.0, 100.0, -380.0], 60.0, [200, 150])),
        ("under ground, up", look(under, [10.0, 10.0, 0.0], 60.0, [200, 150])),
        ("in the ground", look([0.0, 0.0, 10.0], [10.0, 100.0, -5.0], 60.0, [200, 150])),
        ("down", look([0.0, 0.0, 900.0], [1.0, 1.0, 0.0], 60.0, [200, 150])),
        ("away", look([0.0, -900.0, 300.0], [0.0, -1800.0, 300.0], 60.0, [200, 150])),
        ("very far", look([0.0, -9e8, 3e8], [0.0; 3], 1e-5, [200, 150])),
    ];
    for (name, view) in &cases {
        let frame = render(&scene, view, &options(4));
        assert_sane(name, &frame, 4);
    }
    for far in [None, Some(950.0)] {
        let lens = Projection::Orthographic { height: 900.0 };
        let eye = DVec3::new(0.0, -700.0, 700.0);
        let camera = Pinhole::look_at(eye, DVec3::ZERO, DVec3::Z, lens, [200, 150], 1.0, far).expect("well formed");
        let frame = render(&scene, &View::straight(camera), &options(4));
        assert_sane("orthographic", &frame, 4);
        let seen = frame.depth.iter().filter(|d| d.is_finite()).fold(0.0f32, |a, &b| a.max(b));
        assert!(far.is_none_or(|f| seen <= f as f32) && seen > 0.0, "depth up to {seen} with far {far:?}");
    }
}

#[test]
fn odd_ground_gives_defined_pictures() {
    let view = View::straight(pinhole(DVec3::new(0.0, -50.0, 40.0), DVec3::ZERO, 60.0, [64, 48]));
    let field = |heights: Vec<f32>, states: Vec<NodeState>| {
        Heightfield::new(DVec2::new(-10.0, 10.0), DVec2::splat(20.0), 2, 2, heights, states).expect("well formed")
    };
    let solid = NodeState::Measured;
    let cases = [
        ("smallest", field(vec![0.0; 4], vec![solid; 4]), true),
        ("one node", field(vec![0.0; 4], vec![solid, NodeState::Void, NodeState::Void, NodeState::Void]), false),
        ("one triangle", field(vec![0.0; 4], vec![solid, NodeState::Void, solid, solid]), true),
        ("steep", field(vec![0.0, 1e30, -1e30, 0.0], vec![solid; 4]), false),
        ("tiny", field(vec![0.0, 1e-30, 0.0, 0.0], vec![solid; 4]), true),
    ];
    for (name, hf, visible) in cases {
        let frame = render(&scene(vec![layer("ground", LayerKind::Terrain(terrain(hf)))]), &view, &options(4));
        assert_sane(name, &frame, 1);
        assert!(!visible || frame.id.contains(&1), "{name}: nothing to be seen");
    }
    assert_sane("nothing", &render(&Scene::default(), &view, &options(16)), 0);
}

#[test]
fn wrong_options_are_refused() {
    let scene = full_scene();
    let view = View::straight(pinhole(DVec3::new(0.0, -500.0, 300.0), DVec3::ZERO, 45.0, [640, 480]));
    let attempt = |options: &RenderOptions, progress: &Progress| {
        CpuRenderer::default().render(&RenderJob {
            scene: &scene,
            view: &view,
            light: &Light::default(),
            options,
            progress,
        })
    };
    let silent = Progress::silent();
    for samples in [0, 2, 3, 5, 8, 17, u32::MAX] {
        assert!(
            matches!(attempt(&options(samples), &silent), Err(RenderError::Samples { samples: s }) if s == samples)
        );
    }
    let small = RenderOptions { max_bytes: 1 << 20, ..options(4) };
    assert!(matches!(attempt(&small, &silent), Err(RenderError::TooLarge { limit_mib: 1, .. })));
    let progress = Progress::silent();
    progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    assert!(matches!(attempt(&options(4), &progress), Err(RenderError::Cancelled(_))));
    for tolerance_px in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_sane("tolerance", &attempt(&RenderOptions { tolerance_px, ..options(1) }, &silent).expect("drawn"), 4);
    }
}

#[test]
fn progress_rises_to_its_end() {
    let seen = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
    let log = std::sync::Arc::clone(&seen);
    let progress = Progress::new(move |stage, done| log.lock().expect("no panic").push((stage.to_owned(), done)));
    let view = View::straight(pinhole(DVec3::new(0.0, -500.0, 300.0), DVec3::ZERO, 45.0, [640, 480]));
    let (scene, light, options) = (full_scene(), Light::default(), options(1));
    let job = RenderJob { scene: &scene, view: &view, light: &light, options: &options, progress: &progress };
    CpuRenderer::default().render(&job).expect("drawn");
    let seen = seen.lock().expect("no panic");
    assert!(seen.iter().all(|(_, d)| (0.0..=1.0).contains(d)));
    assert!(seen.iter().filter(|(s, _)| s == "draw").count() == 30, "one tick per band of 16 rows");
    assert_eq!(seen.last().map(|(_, d)| *d), Some(1.0));
}
