//! Compares every pixel with a ray caster that uses no triangles on the image but walks along the (curved) ray.

use crate::support::{hills, layer, options, pinhole, render, scene, terrain};
use crate::support_views::views;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{BoxLayer, BoxShape, Color, Heightfield, LayerKind, NodeState, Scene};
use rayon::prelude::*;

/// Height of a point above the drawn ground; `None` outside the ground.
fn over_ground(hf: &Heightfield, p: DVec3) -> Option<f64> {
    Some(p.z - hf.surface_at(p.truncate())?)
}

fn in_box(shape: &BoxShape, p: DVec3) -> bool {
    let d = p - shape.base;
    let (sin, cos) = shape.yaw.sin_cos();
    let (x, y) = (cos * d.x + sin * d.y, cos * d.y - sin * d.x);
    x.abs() <= 0.5 * shape.size.x && y.abs() <= 0.5 * shape.size.y && (0.0..=shape.size.z).contains(&d.z)
}

/// Id and depth of the first hit of the ray of `pixel`: where it enters the ground or a box.
fn cast(scene: &Scene, view: &View, pixel: DVec2, far: f64, steps: usize) -> (u32, f64) {
    let ray = view.ray(pixel);
    let state = |depth: f64| {
        let p = ray.at(depth).ok()?.point;
        let mut side = None;
        let mut inside = 0u32;
        for (i, layer) in scene.layers.iter().enumerate() {
            match &layer.kind {
                LayerKind::Terrain(t) => side = over_ground(&t.heightfield, p).map(|h| h > 0.0),
                LayerKind::Boxes(b) if b.boxes.iter().any(|s| in_box(s, p)) => inside = 1 + i as u32,
                _ => {}
            }
        }
        Some((side, inside))
    };
    let near = view.pinhole().near;
    let mut before = (near, state(near));
    for i in 1..=steps {
        let depth = near + (far - near) * i as f64 / steps as f64;
        let now = (depth, state(depth));
        if let (Some(a), Some(b)) = (before.1, now.1) {
            let ground = matches!((a.0, b.0), (Some(x), Some(y)) if x != y);
            let boxed = a.1 == 0 && b.1 != 0;
            if ground || boxed {
                let (mut lo, mut hi) = (before.0, depth);
                for _ in 0..60 {
                    let mid = 0.5 * (lo + hi);
                    let changed =
                        state(mid).is_some_and(|m| (boxed && m.1 != 0) || (ground && m.0.is_some() && m.0 != a.0));
                    if changed { hi = mid } else { lo = mid }
                }
                let id = match state(hi) {
                    Some((_, inside)) if inside != 0 => inside,
                    _ => 1,
                };
                return (id, hi);
            }
        }
        before = now;
    }
    (0, f64::INFINITY)
}

/// Pixels with a neighbour of another id, or across which the depth jumps by more than 4 %.
fn silhouettes(reference: &[(u32, f64)], w: usize, h: usize) -> Vec<bool> {
    (0..w * h)
        .map(|i| {
            let (x, y) = (i % w, i / w);
            let (id, depth) = reference[i];
            (y.saturating_sub(1)..=(y + 1).min(h - 1)).any(|v| {
                (x.saturating_sub(1)..=(x + 1).min(w - 1)).any(|u| {
                    let (other, d) = reference[v * w + u];
                    other != id || (id != 0 && (d / depth - 1.0).abs() > 0.04)
                })
            })
        })
        .collect()
}

fn compare(name: &str, scene: &Scene, view: &View, tolerance: f64) {
    let [w, h] = view.pinhole().image.map(|s| s as usize);
    // An error of half a pixel in a bent edge would change the depth of grazing ground, so the comparison uses a fiftieth.
    let fine = belvedere_scene::RenderOptions { tolerance_px: 0.02, ..options(4) };
    let frame = render(scene, view, &fine);
    let reference: Vec<(u32, f64)> = (0..w * h)
        .into_par_iter()
        .map(|i| cast(scene, view, DVec2::new((i % w) as f64 + 0.5, (i / w) as f64 + 0.5), 2600.0, 1300))
        .collect();
    let band = silhouettes(&reference, w, h);
    let judged = band.iter().filter(|b| !**b).count();
    assert!(judged > w * h / 2, "{name}: only {judged} pixels lie off the silhouettes");
    let ground = reference.iter().filter(|r| r.0 == 1).count();
    assert!(ground > w * h / 4, "{name}: only {ground} pixels of ground");
    let wrong: Vec<String> = (0..w * h)
        .filter(|&i| !band[i])
        .filter(|&i| {
            let (id, depth) = reference[i];
            let off = (f64::from(frame.depth[i]) / depth - 1.0).abs();
            frame.id[i] != id || (id != 0 && !(off <= tolerance))
        })
        .map(|i| format!("({}, {}): {} at {} instead of {:?}", i % w, i / w, frame.id[i], frame.depth[i], reference[i]))
        .collect();
    assert!(
        wrong.len() as f64 <= 1e-3 * (w * h) as f64,
        "{name}: {} of {judged} pixels differ, such as {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(5)]
    );
}

fn tower(x: f64, y: f64, z: f64, yaw: f64) -> BoxShape {
    BoxShape { base: DVec3::new(x, y, z), size: DVec3::new(60.0, 40.0, 150.0), yaw, color: Color::rgb(190, 180, 170) }
}

fn hilly_scene() -> Scene {
    let hf = hills(24, 50.0, 160.0, 7);
    let boxes = [(-120.0, 60.0, 0.3), (140.0, -80.0, 1.1), (20.0, 260.0, 0.0)]
        .map(|(x, y, yaw)| tower(x, y, hf.surface_at(DVec2::new(x, y)).expect("on the hills") - 20.0, yaw));
    scene(vec![
        layer("ground", LayerKind::Terrain(terrain(hf))),
        layer("towers", LayerKind::Boxes(BoxLayer::new(boxes.to_vec()))),
    ])
}

#[test]
fn every_pixel_agrees_with_a_ray_caster() {
    let scene = hilly_scene();
    for (name, view) in views([96, 72]) {
        // A bent edge may be wrong by the tolerance, and the depth by the change (at most 4 % per pixel) of the ground over that distance.
        let tolerance = if view.stages().is_empty() { 1e-4 } else { 1e-3 };
        compare(name, &scene, &view, tolerance);
    }
}

#[test]
fn with_a_fine_tolerance_bent_depth_is_as_exact_as_straight_depth() {
    let scene = hilly_scene();
    for (name, view) in views([96, 72]).into_iter().filter(|(_, v)| !v.stages().is_empty()) {
        let fine = belvedere_scene::RenderOptions { tolerance_px: 0.01, ..options(1) };
        let coarse = render(&scene, &view, &options(1));
        let frame = render(&scene, &view, &fine);
        // A sharp turn has no curve that could be followed more closely: both cut at its plane.
        let more = frame.stats.edges_split > coarse.stats.edges_split;
        assert!(more || name == "a sharp turn", "{name}: nothing more was split");
        let mut off: Vec<f64> = frame
            .depth
            .iter()
            .zip(&coarse.depth)
            .filter(|(a, _)| a.is_finite())
            .map(|(a, b)| f64::from((a / b - 1.0).abs()))
            .collect();
        off.sort_by(f64::total_cmp);
        let typical = off[off.len() / 2];
        assert!(typical < 1e-3, "{name}: half of the depths change by more than {typical} with the tolerance");
    }
}

#[test]
fn holes_stay_holes() {
    let mut hf = hills(24, 50.0, 100.0, 3);
    let mut states = hf.states().to_vec();
    for (c, r) in [(12, 12), (13, 12), (12, 13), (6, 15), (18, 9)] {
        states[r * 24 + c] = NodeState::Void;
    }
    hf = Heightfield::new(hf.north_west(), hf.spacing(), 24, 24, hf.heights().to_vec(), states).expect("well formed");
    let scene = scene(vec![layer("ground", LayerKind::Terrain(terrain(hf)))]);
    let eye = DVec3::new(0.0, -250.0, 900.0);
    let view = View::straight(pinhole(eye, DVec3::new(0.0, 20.0, 0.0), 50.0, [128, 96]));
    compare("holes", &scene, &view, 1e-4);
    let frame = render(&scene, &view, &options(1));
    let sky = frame.id.iter().filter(|&&id| id == 0).count();
    assert!((30..6000).contains(&sky), "{sky} pixels of sky through the holes");
}
