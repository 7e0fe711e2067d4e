//! Compares the rasteriser with the exact tracer along every valid kind of curved ray: wide wedges, bends beyond a right angle, chains,
//! bends in any plane. The scenes have boxes, huge triangles, ground and volumes along the whole rays, not at the turns alone.

use crate::exact::{Difference, difference, exactly, on_silhouette, trace};
use crate::support::{hills, layer, render, scene, terrain};
use belvedere_core::{DMat3, DVec2, DVec3, View};
use belvedere_scene::{
    BoxLayer, BoxShape, Color, LayerKind, Mesh, MeshColors, MeshLayer, Scene, TransferFunction, TransferPoint, Volume,
    VolumeLayer, VoxelValues,
};
use belvedere_testkit::Random;
use belvedere_testkit::rays::{MODELS, RandomRays, random_split};

const VIEWS: usize = 200;
const IMAGE: [u32; 2] = [48, 36];
/// Every eighth of these has branching rays.
const SPLITS: usize = 8;

/// A place through which a ray of the picture passes.
fn place(view: &View, random: &mut Random) -> DVec3 {
    for _ in 0..100 {
        let pixel = DVec2::new(random.unit(), random.unit()) * DVec2::from_array(IMAGE.map(f64::from));
        let depth = 10f64.powf(random.range(1.3, 3.2));
        if let Ok(seen) = view.ray(pixel).at(depth) {
            return seen.point;
        }
    }
    panic!("no ray passes any place");
}

fn boxes(view: &View, random: &mut Random) -> LayerKind {
    let shape = |i: usize, random: &mut Random| {
        let size = 10f64.powf(random.range(0.6, if i.is_multiple_of(8) { 2.6 } else { 1.8 }));
        let size = size * DVec3::new(random.range(0.3, 1.0), random.range(0.3, 1.0), random.range(0.3, 1.0));
        let base = place(view, random) - 0.5 * size;
        BoxShape { base, size, yaw: random.range(0.0, 3.0), color: Color::rgb(190, 180, 170) }
    };
    LayerKind::Boxes(BoxLayer::new((0..40).map(|i| shape(i, random)).collect()))
}

/// A few dozen triangles, most of them many times larger than the part that the picture shows.
fn triangles(view: &View, random: &mut Random) -> LayerKind {
    let mut places = Vec::new();
    for _ in 0..14 {
        let (center, size) = (place(view, random), 10f64.powf(random.range(1.5, 3.5)));
        let (u, v) = random.direction().any_orthonormal_pair();
        let corner = |x: f64, y: f64| center + size * (x * u + y * v);
        places.extend([corner(-0.6, -0.4), corner(0.7, -0.3), corner(random.range(-0.4, 0.4), 0.8)]);
    }
    let triangles = (0..places.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = Mesh::new(&places, triangles, MeshColors::Layer).expect("well formed");
    LayerKind::Mesh(MeshLayer::new(mesh, Color::rgb(220, 210, 190)))
}

fn scene_of(kind: usize, view: &View, random: &mut Random) -> Scene {
    let ground = |seed: u64| LayerKind::Terrain(terrain(hills(48, 40.0, 220.0, seed)));
    let layers = match kind {
        0 => vec![layer("boxes", boxes(view, random))],
        1 => vec![layer("triangles", triangles(view, random))],
        2 => vec![layer("ground", ground(random.bits() % 64))],
        _ => vec![
            layer("boxes", boxes(view, random)),
            layer("triangles", triangles(view, random)),
            layer("ground", ground(random.bits() % 64)),
        ],
    };
    scene(layers)
}

fn random_view(seed: usize) -> Option<View> {
    let mut random = Random::new(0x5eed + seed as u64);
    let model = MODELS[seed % 5];
    if seed.is_multiple_of(SPLITS) {
        return random_split(&mut random, model, IMAGE).map(|(view, _)| view);
    }
    RandomRays::new(&mut random, model, 1 + seed / 5 % 4, IMAGE).map(|made| made.view())
}

#[test]
fn rasteriser_and_tracer_agree_along_random_rays() {
    let (mut total, mut views, mut worst) = ([Difference::default(); 4], 0, Vec::new());
    for seed in 0..4 * VIEWS {
        let Some(view) = random_view(seed) else { continue };
        let mut random = Random::new(seed as u64);
        let kind = views % 4;
        let scene = scene_of(kind, &view, &mut random);
        let d = difference(&scene, &view);
        total[kind].add(d);
        if !d.is_small() {
            worst.push(format!("view {seed}, scene {kind}: {d:?}"));
        }
        views += 1;
        if views == VIEWS {
            break;
        }
    }
    assert_eq!(views, VIEWS);
    for d in total {
        assert!(d.judged > d.pixels / 3 && d.is_small(), "{d:?}; {worst:#?}");
    }
}

/// A volume of waves, most of it translucent.
fn body(center: DVec3, size: f64, turn: DMat3) -> VolumeLayer {
    let n = 16u32;
    let wave = |x: u32, y: u32, z: u32| {
        let [x, y, z] = [x, y, z].map(|v| 6.0 * f64::from(v) / f64::from(n));
        127.0 * (1.0 + (x.sin() * (y + 1.0).cos() + (z + 0.4 * x).sin()) / 2.0)
    };
    let values = (0..n * n * n).map(|i| wave(i % n, i / n % n, i / n / n) as u8).collect();
    let axes = turn * (size / f64::from(n));
    let origin = center - axes * DVec3::splat(0.5 * f64::from(n - 1));
    let volume = Volume::new([n as usize; 3], axes, origin, VoxelValues::U8(values)).expect("well formed");
    let point = |value, color, opacity| TransferPoint { value, color, opacity };
    let colors = [
        point(60.0, Color::rgb(40, 80, 160), 0.0),
        point(150.0, Color::rgb(220, 190, 120), 0.3),
        point(255.0, Color::rgb(250, 240, 240), 0.8),
    ];
    VolumeLayer::new(volume, TransferFunction::new("waves", colors.to_vec(), size / 30.0).expect("rising"))
}

#[test]
fn volumes_are_seen_along_random_rays_as_sample_by_sample() {
    let (mut views, mut pixels, mut other, mut seen, mut worst) = (0, 0, 0, 0, Vec::new());
    for seed in 0..200 {
        let Some(view) = random_view(1000 + seed) else { continue };
        let mut random = Random::new(seed as u64);
        let body = body(place(&view, &mut random), 10f64.powf(random.range(1.0, 2.5)), random.rotation());
        let scene = scene(vec![layer("body", LayerKind::Volume(body)), layer("boxes", boxes(&view, &mut random))]);
        let (a, b) = (render(&scene, &view, &exactly()), trace(&scene, &view, &exactly()));
        let differ = |i: usize| a.color[i].iter().zip(b.color[i]).any(|(a, b)| a.abs_diff(b) > 8);
        let off = (0..a.color.len()).filter(|&i| differ(i) && !on_silhouette(&b, i)).count();
        (pixels, other, views) = (pixels + a.color.len(), other + off, views + 1);
        seen += b.id.iter().filter(|id| **id == 1).count();
        if off * 1000 > a.color.len() {
            worst.push(format!("view {seed}: {off}"));
        }
        if views == 24 {
            break;
        }
    }
    assert!(views == 24 && seen * 50 > pixels, "{seen} of {pixels} pixels show a body");
    assert!(other * 1000 <= pixels, "{other} of {pixels} pixels: {worst:?}");
}
