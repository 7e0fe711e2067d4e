//! Target tracking among moving boxes, judged by the pixels of the target in small pictures.

use belvedere_construct::rays::{
    AroundOptions, FilmPlanner, Sidestep, Target, TrackingMemory, TrackingOptions, bend_around, track_target,
};
use belvedere_core::{DVec3, Pinhole, Projection, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Layer, LayerKind, Light, Mesh, MeshColors, MeshLayer, Progress, RenderJob,
    RenderOptions, Renderer, Scene,
};
use belvedere_testkit::Random;

const TARGET: usize = 1;
const DT: f64 = 1.0 / 30.0;

fn camera() -> View {
    let lens = Projection::Perspective { fov_y: 50f64.to_radians() };
    let eye = DVec3::new(0.0, 0.0, 6.0);
    View::straight(Pinhole::look_at(eye, DVec3::new(0.0, 100.0, 4.0), DVec3::Z, lens, [160, 90], 1.0, None).unwrap())
}

fn block(base: DVec3, size: DVec3) -> BoxShape {
    BoxShape { base, size, yaw: 0.3, color: Color::rgb(200, 120, 60) }
}

fn scene(walls: Vec<BoxShape>, target: BoxShape) -> Scene {
    let layer = |id: &str, boxes| Layer { id: id.into(), must_see: false, kind: BoxLayer::new(boxes).into() };
    Scene { layers: vec![layer("walls", walls), layer("target", vec![target])], ..Scene::default() }
}

/// Pixels of the target.
fn pixels(scene: &Scene, view: &View) -> usize {
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let job = RenderJob { scene, view, light: &light, options: &options, progress: &progress };
    let frame = CpuRenderer::default().render(&job).unwrap();
    frame.id.iter().filter(|&&id| id == TARGET as u32 + 1).count()
}

/// A target that wanders, and blocks that drift across before it.
struct Walk {
    blocks: Vec<(BoxShape, DVec3)>,
    phase: [f64; 4],
}

impl Walk {
    fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut between = |a: f64, b: f64| a + (b - a) * random.unit();
        let blocks = (0..5)
            .map(|_| {
                let base = DVec3::new(between(-22.0, 22.0), between(50.0, 74.0), 0.0);
                let size = DVec3::new(between(2.0, 7.0), between(2.0, 4.0), between(8.0, 16.0));
                (block(base, size), DVec3::new(between(-6.0, 6.0), 0.0, 0.0))
            })
            .collect();
        Self { blocks, phase: std::array::from_fn(|_| between(0.0, 6.0)) }
    }

    fn scene(&self, t: f64) -> Scene {
        let [a, b, c, d] = self.phase;
        let at = DVec3::new(
            14.0 * (0.5 * t + a).sin() + 4.0 * (0.9 * t + b).sin(),
            96.0 + 5.0 * (0.4 * t + c).sin(),
            d * 0.3,
        );
        let moved = |(shape, speed): &(BoxShape, DVec3)| {
            let x = (shape.base.x + speed.x * t + 22.0).rem_euclid(44.0) - 22.0;
            BoxShape { base: DVec3::new(x, shape.base.y, 0.0), ..*shape }
        };
        scene(self.blocks.iter().map(moved).collect(), block(at, DVec3::new(2.0, 2.0, 3.0)))
    }
}

#[test]
fn a_moving_target_stays_in_sight_where_any_side_step_shows_it() {
    // The margin is stated for pictures of 720 rows, these have 90.
    let (base, options) = (camera(), TrackingOptions { grow_px: 1.0, ..TrackingOptions::default() });
    let cap = options.cap_per_s * DT;
    let delay = (1.0 / options.cap_per_s / DT).ceil() as usize;
    let (mut solvable, mut kept, mut at_once, mut hidden_straight) = (0, 0, 0, 0);
    for seed in 0..6 {
        let walk = Walk::new(seed);
        let (mut memory, mut before, mut hidden_for) = (TrackingMemory::default(), 0.0, 0);
        for k in 0..150 {
            let scene = walk.scene(f64::from(k) * DT);
            let target = Target::layer(&scene, TARGET).unwrap();
            let tracked = track_target(&scene, &base, &target, &options, Some(DT), &mut memory).unwrap();
            let f = tracked.report.f;
            assert!(
                (k == 0 || (f - before).abs() <= cap * (1.0 + 1e-9)) && f.abs() <= 1.0,
                "seed {seed}, frame {k}: {before} -> {f}"
            );
            before = f;
            // Brute force over f, by pixels, independent of the tracker.
            let depth = (target.center() - base.pinhole().eye).dot(base.pinhole().forward);
            let reach = 0.5 * depth;
            let planes = [0.5 * depth, 0.625 * depth, 0.75 * depth];
            let shows = |f: f64| {
                let view = Sidestep { offset: f * reach * base.pinhole().right, planes }.view(&base).unwrap();
                pixels(&scene, &view) > 0
            };
            let any = (-10..=10).map(|i| 0.1 * f64::from(i)).any(shows);
            hidden_straight += usize::from(pixels(&scene, &base) == 0);
            let shown = pixels(&scene, &tracked.view) > 0;
            hidden_for = if any && !shown { hidden_for + 1 } else { 0 };
            solvable += usize::from(any);
            kept += usize::from(any && hidden_for <= delay);
            at_once += usize::from(any && shown);
        }
    }
    assert!(hidden_straight > 50, "the blocks hide the target in {hidden_straight} frames only");
    assert!(solvable > 500, "{solvable} frames can be solved");
    // Within the time that the set speed takes; mostly at once.
    assert!(kept as f64 >= 0.99 * solvable as f64, "{kept} of {solvable} frames show the target");
    assert!(at_once as f64 >= 0.9 * solvable as f64, "{at_once} of {solvable} frames show it without delay");
}

#[test]
fn nothing_bends_while_nothing_hides_and_rays_straighten_again() {
    let base = camera();
    let target = block(DVec3::new(0.0, 95.0, 0.0), DVec3::new(2.0, 2.0, 3.0));
    let wall = block(DVec3::new(0.0, 60.0, 0.0), DVec3::new(5.0, 3.0, 14.0));
    let (open, hidden) = (scene(Vec::new(), target), scene(vec![wall], target));
    let of = |scene: &Scene, dt, memory: &mut TrackingMemory| {
        let target = Target::layer(scene, TARGET).unwrap();
        track_target(scene, &base, &target, &TrackingOptions::default(), dt, memory).unwrap()
    };
    let mut memory = TrackingMemory::default();
    let still = of(&open, None, &mut memory);
    assert_eq!((still.report.f, still.view), (0.0, base.clone()));
    let still = of(&hidden, None, &mut memory);
    assert!(still.report.visible_straight < 0.5 && still.report.visible == 1.0, "{:?}", still.report);
    // The bend stays for a moment after the wall has gone, then goes at the set speed.
    let f = still.report.f;
    let first = of(&open, Some(DT), &mut memory);
    assert_eq!(first.report.f, f, "straightens at once");
    let mut frames = 0;
    while of(&open, Some(DT), &mut memory).report.f != 0.0 {
        frames += 1;
        assert!(frames < 90, "stays bent");
    }
    let least = f.abs() / (TrackingOptions::default().cap_per_s * DT);
    assert!(f64::from(frames) >= least.floor(), "{frames} frames from f = {f}");
}

#[test]
fn parameters_out_of_range_are_named() {
    let open = scene(Vec::new(), block(DVec3::new(0.0, 95.0, 0.0), DVec3::ONE));
    let target = Target::layer(&open, TARGET).unwrap();
    for (options, name) in [
        (TrackingOptions { f_step: 0.0, ..Default::default() }, "f_step"),
        (TrackingOptions { f_step: 1.5, ..Default::default() }, "f_step"),
        (TrackingOptions { cap_per_s: -1.0, ..Default::default() }, "cap_per_s"),
        (TrackingOptions { z0: Some(f64::NAN), ..Default::default() }, "z0"),
        (TrackingOptions { a: Some(0.0), ..Default::default() }, "a is 0"),
        (TrackingOptions { grow_px: -1.0, ..Default::default() }, "grow_px"),
    ] {
        let mut memory = TrackingMemory::default();
        let error = track_target(&open, &camera(), &target, &options, None, &mut memory).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}

#[test]
fn a_wide_wall_is_passed_over_and_a_tower_on_the_side() {
    let base = camera();
    let target = block(DVec3::new(0.0, 95.0, 0.0), DVec3::new(3.0, 3.0, 2.0));
    let wide = scene(vec![block(DVec3::new(0.0, 60.0, 0.0), DVec3::new(150.0, 2.0, 8.0))], target);
    let tower = scene(vec![block(DVec3::new(0.0, 60.0, 0.0), DVec3::new(6.0, 6.0, 60.0))], target);
    let find = |scene: &Scene| {
        let target = Target::layer(scene, TARGET).unwrap();
        bend_around(scene, &base, &target, &AroundOptions::default(), &Progress::silent()).unwrap()
    };
    for (scene, axis) in [(wide, -base.pinhole().down), (tower, base.pinhole().right)] {
        let found = find(&scene);
        let (view, sidestep) = found.bent.expect("a bend");
        assert!(found.report.visible_straight < 0.5 && found.report.visible >= 0.999, "{:?}", found.report);
        assert_eq!(pixels(&scene, &base), 0);
        assert!(pixels(&scene, &view) > 3);
        let along = sidestep.offset.normalize().dot(axis).abs();
        assert!(along > 0.9, "goes around by {} along {axis}", sidestep.offset);
    }
    let open = scene(Vec::new(), target);
    assert!(find(&open).bent.is_none(), "nothing hides the target, nothing bends");
}

/// Frames of a film past towers, in which some bend shows the whole target, those of them in which the film does, at once and but for swings
/// of at most 1 / cap seconds, and how often f turns round.
fn film_past_towers(seed: u64, towers: usize) -> (usize, [usize; 2], usize) {
    let (base, options) = (camera(), TrackingOptions { grow_px: 1.0, ..TrackingOptions::default() });
    let mut random = Random::new(seed);
    let mut between = |a: f64, b: f64| a + (b - a) * random.unit();
    let towers: Vec<BoxShape> = (0..towers)
        .map(|_| {
            let base = DVec3::new(between(-24.0, 24.0), between(52.0, 72.0), 0.0);
            block(base, DVec3::new(between(1.0, 3.0), 2.0, between(12.0, 26.0)))
        })
        .collect();
    let at = |k: usize| block(DVec3::new(-26.0 + 0.4 * k as f64, 96.0, 0.0), DVec3::new(2.0, 2.0, 3.0));
    let scenes: Vec<Scene> = (0..130).map(|k| scene(towers.clone(), at(k))).collect();
    let mut planner = FilmPlanner::new(options, DT).unwrap();
    loop {
        for scene in &scenes {
            planner.add(scene, &base, &Target::layer(scene, TARGET).unwrap());
        }
        if !planner.wants_more() {
            break;
        }
    }
    let bends = planner.finish();
    let (mut solvable, mut at_once, mut kept, mut hidden_for) = (0, 0, 0, 0);
    let (mut turns, mut side, mut before) = (0, 0.0, bends[0].f);
    let swing = (1.0 / options.cap_per_s / DT).ceil() as usize;
    let mut memory = TrackingMemory::default();
    for (k, (now, bend)) in scenes.iter().zip(&bends).enumerate() {
        memory.follow(Some(*bend));
        let target = Target::layer(now, TARGET).unwrap();
        let tracked = track_target(now, &base, &target, &options, Some(DT), &mut memory).unwrap();
        assert_eq!(tracked.report.f, bend.f);
        let step = bend.f - before;
        assert!(step.abs() <= options.cap_per_s * DT * (1.0 + 1e-9), "frame {k}: f moves by {step}");
        if step != 0.0 {
            turns += usize::from(side * step < 0.0);
            side = step.signum();
        }
        before = bend.f;
        // Brute force by pixels, independent of the plan.
        let whole = |view: &View| pixels(now, view) == pixels(&scene(Vec::new(), at(k)), view);
        let depth = (target.center() - base.pinhole().eye).dot(base.pinhole().forward);
        let planes = [0.5 * depth, 0.625 * depth, 0.75 * depth];
        let shows =
            |f: f64| whole(&Sidestep { offset: f * 0.5 * depth * base.pinhole().right, planes }.view(&base).unwrap());
        // Level with the eye or higher, the viewpoint stays above the ground.
        let up = bend.f * 0.5 * depth * bend.direction_deg.to_radians().sin();
        assert!(base.pinhole().eye.z + up >= 2.0, "frame {k}: the viewpoint is moved up by {up}");
        let shown = whole(&tracked.view);
        assert!(k > 0 || shown, "the film does not begin where the target is seen");
        if shown || (-10..=10).map(|i| 0.1 * f64::from(i)).any(shows) {
            solvable += 1;
            hidden_for = if shown { 0 } else { hidden_for + 1 };
            at_once += usize::from(shown);
            kept += usize::from(hidden_for <= swing);
        }
    }
    (solvable, [at_once, kept], turns)
}

#[test]
fn a_planned_film_shows_the_whole_target_past_nine_towers_and_does_not_hunt() {
    let (mut solvable, mut at_once, mut kept) = (0, 0, 0);
    for seed in 20..22 {
        let (of, seen, turns) = film_past_towers(seed, 9);
        assert!(turns <= 4, "seed {seed}: f turns round {turns} times");
        (solvable, at_once, kept) = (solvable + of, at_once + seen[0], kept + seen[1]);
    }
    assert!(solvable > 200, "{solvable} frames can be solved");
    assert!(kept as f64 >= 0.99 * solvable as f64, "{kept} of {solvable}");
    assert!(at_once as f64 >= 0.9 * solvable as f64, "{at_once} of {solvable}, swings counted as hidden");
}

#[test]
fn a_selection_of_parts_changes_the_target_and_the_rest_of_the_mesh_hides_it() {
    let triangle = |y: f64| [[-2.0, y, 1.0], [2.0, y, 1.0], [0.0, y, 5.0]].map(DVec3::from_array);
    let positions: Vec<DVec3> = [60.0, 95.0].into_iter().flat_map(triangle).collect();
    let mesh = Mesh::in_parts(&positions, vec![[0, 1, 2], [3, 4, 5]], MeshColors::Layer, vec![0, 1]).unwrap();
    let layer = |wanted| LayerKind::Mesh(MeshLayer { wanted, ..MeshLayer::new(mesh.clone(), Color::rgb(200, 60, 60)) });
    let scene = |wanted| Scene::default().with_layer("houses", layer(wanted));
    let (all, one) = (scene(None), scene(Some(vec![1])));
    let [whole, selected] = [&all, &one].map(|scene| Target::layer(scene, 0).unwrap());
    assert!(whole.center().y < 80.0 && selected.center().y == 95.0, "{} {}", whole.center(), selected.center());
    assert_eq!(selected.own_parts, Some((0, vec![1])));
    let tracked = |scene: &Scene, target: &Target| {
        let (options, mut memory) = (TrackingOptions::default(), TrackingMemory::default());
        track_target(scene, &camera(), target, &options, None, &mut memory).unwrap().report
    };
    assert_eq!(tracked(&all, &whole).f, 0.0);
    let report = tracked(&one, &selected);
    assert!(report.f != 0.0 && report.visible_straight < 0.999 && report.visible >= 0.999, "{report:?}");
}
