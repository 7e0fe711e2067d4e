//! Path previews: what lies between the eye and the position is drawn.

use crate::preview::{canyon, path};
use belvedere_construct::rays::{Lens, PathPreview, Target, TargetSight};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_cpu::CpuRenderer;
use belvedere_scene::{
    BoxLayer, BoxShape, Color, Frame, Heightfield, Layer, Light, Progress, RenderJob, RenderOptions, Renderer, Scene,
};
use belvedere_testkit::Random;

const IMAGE: [u32; 2] = [96, 54];

fn frame(scene: &Scene, view: &View) -> Frame {
    let (light, progress) = (Light::default(), Progress::silent());
    let options = RenderOptions { samples: 1, ..RenderOptions::default() };
    let job = RenderJob { scene, view, light: &light, options: &options, progress: &progress };
    CpuRenderer::default().render(&job).unwrap()
}

/// Share of the lower half of a frame in which nothing is drawn.
fn sky(frame: &Frame) -> f64 {
    let lower = &frame.id[frame.id.len() / 2..];
    lower.iter().filter(|id| **id == 0).count() as f64 / lower.len() as f64
}

/// Houses on both sides of a street 16 m wide along a path that turns at crossings, on flat ground.
fn street(seed: u64) -> (Scene, Vec<DVec3>) {
    let mut random = Random::new(seed);
    let pitch = 46.0;
    let mut houses = Vec::new();
    for i in -12..12 {
        for j in -4..24 {
            houses.push(BoxShape {
                base: DVec3::new(pitch * (f64::from(i) + 0.5), pitch * (f64::from(j) + 0.5), 0.0),
                size: DVec3::new(30.0, 30.0, random.range(12.0, 40.0)),
                yaw: 0.0,
                color: Color::rgb(200, 180, 160),
            });
        }
    }
    let (mut at, mut heading, mut points) = (DVec2::new(0.0, -pitch), DVec2::Y, Vec::new());
    for _ in 0..7 {
        for _ in 0..(1 + (random.unit() * 2.5) as usize) {
            for k in 0..23 {
                points.push((at + f64::from(k) * 2.0 * heading).extend(0.3));
            }
            at += pitch * heading;
        }
        heading =
            if heading.y > 0.5 { DVec2::new(if random.unit() < 0.5 { 1.0 } else { -1.0 }, 0.0) } else { DVec2::Y };
    }
    points.push(at.extend(0.3));
    let ground =
        Heightfield::measured(DVec2::new(-800.0, 1400.0), DVec2::splat(100.0), 17, 20, vec![0.0; 340]).unwrap();
    let layer = Layer { id: "houses".into(), must_see: false, kind: BoxLayer::new(houses).into() };
    let mut scene = Scene::default().with_terrain("ground", ground);
    scene.layers.push(layer);
    (scene, points)
}

/// A preview in a scene: shares of sky in the lower half, and of the path ahead that is seen, from positions all along it.
fn previewed(scene: &Scene, path: &[DVec3], length: f64) -> (PathPreview, Vec<f64>, Vec<f64>) {
    let usual = Lens::for_preview(length, true);
    let preview = PathPreview::fitted(scene, path, length, usual, true, IMAGE).unwrap();
    let whole = preview.length();
    let (mut skies, mut shares) = (Vec::new(), Vec::new());
    for k in 0..12 {
        let at = whole * f64::from(k) / 12.0;
        let seen = preview.at(at, IMAGE, None).unwrap();
        skies.push(sky(&frame(scene, &seen.view)));
        let samples = preview.samples(at, length.min(whole - at) - 0.005 * length, 0.01 * length);
        let target = Target::points(samples.into_iter().map(|p| p + 0.1 * DVec3::Z));
        shares.push(TargetSight::new(scene, &target).share(&seen.view, 0.0));
    }
    (preview, skies, shares)
}

fn mean(all: &[f64]) -> f64 {
    all.iter().sum::<f64>() / all.len() as f64
}

#[test]
fn nothing_is_cut_away_before_the_position() {
    let mut seen = Vec::new();
    for seed in 0..3 {
        let path = path(seed);
        let scene = Scene::default().with_terrain("ground", canyon(&path));
        let (preview, skies, shares) = previewed(&scene, &path, 2000.0);
        assert!(skies.iter().all(|sky| *sky < 0.05), "canyon {seed}: {skies:.2?}");
        // The eye stands behind and above the position.
        let whole = preview.length();
        for k in 0..40 {
            let at = whole * f64::from(k) / 40.0;
            let view = preview.at(at, IMAGE, None).unwrap().view;
            let (eye, here) = (view.pinhole().eye, preview.samples(at - 1.0, 1.5, 1.0)[0]);
            let behind = (here - eye).dot(view.pinhole().forward);
            assert!(behind > view.pinhole().near && eye.z > here.z, "canyon {seed} at {at}: {behind} behind");
        }
        seen.extend(shares);
    }
    assert!(mean(&seen) >= 0.96, "{seen:.2?}");
}

#[test]
fn over_a_path_that_goes_down_the_eye_stands_above_the_ground() {
    // A hillside that falls by one in two, with a ledge in the middle.
    let fall = |y: f64| -0.5 * y + 40.0 * (y / 150.0).sin();
    let heights = (0..41 * 201).map(|i| fall(2000.0 - 10.0 * f64::from(i / 41)) as f32).collect();
    let ground = Heightfield::measured(DVec2::new(-200.0, 2000.0), DVec2::splat(10.0), 41, 201, heights).unwrap();
    let path: Vec<DVec3> = (20..190).map(|k| f64::from(k) * 10.0).map(|y| DVec3::new(0.0, y, fall(y))).collect();
    let scene = Scene::default().with_terrain("ground", ground.clone());
    for length in [300.0, 1000.0] {
        let usual = Lens::for_preview(length, true);
        let preview = PathPreview::fitted(&scene, &path, length, usual, true, IMAGE).unwrap();
        for k in 0..20 {
            let at = preview.length() * f64::from(k) / 20.0;
            let eye = preview.at(at, IMAGE, None).unwrap().view.pinhole().eye;
            let over = ground.surface_at(eye.truncate()).map_or(1.0, |height| eye.z - height);
            assert!(over > 0.0, "preview of {length} at {at}: the eye is {over} over the ground");
        }
    }
}

#[test]
fn streets_are_previewed_from_between_their_walls() {
    let mut seen = Vec::new();
    for seed in 0..3 {
        let (scene, path) = street(seed);
        let (_, skies, shares) = previewed(&scene, &path, 300.0);
        assert!(skies.iter().all(|sky| *sky < 0.01), "street {seed}: {skies:.2?}");
        seen.extend(shares);
    }
    // Turns by a right angle at every other crossing.
    assert!(mean(&seen) >= 0.85, "{seen:.2?}");
}
