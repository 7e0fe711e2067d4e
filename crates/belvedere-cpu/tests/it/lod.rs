//! Ground with reduced detail far away has no cracks, and its error on the image is no larger than allowed.

use crate::real_data::andorra;
use crate::support::{hills, layer, options, pinhole, render, scene, show, terrain};
use crate::support_views::{spline_over, turns, views};
use belvedere_core::map::curved_rays::Model;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Aux, Frame, Heightfield, LayerKind, RenderOptions, Scene};

const LOD_PX: f64 = 0.5;

fn ground(hf: &Heightfield) -> Scene {
    scene(vec![layer("ground", LayerKind::Terrain(terrain(hf.clone())))])
}

fn coarse() -> RenderOptions {
    RenderOptions { lod_px: LOD_PX, aux: Aux { world: true, ..Aux::default() }, ..options(1) }
}

/// Largest distance, in pixels, between a pixel and the image of the true ground at the place seen there, and the number of pixels
/// compared.
fn off_px(frame: &Frame, hf: &Heightfield, view: &View) -> (f64, usize) {
    let (mut worst, mut n) = (0.0f64, 0);
    for (i, p) in frame.world.as_ref().expect("asked for").iter().enumerate().filter(|(i, _)| frame.id[*i] != 0) {
        let xy = DVec2::new(p[0], p[1]);
        let Some(z) = hf.surface_at(xy) else { continue };
        let Ok(image) = view.project(xy.extend(z)) else { continue };
        let centre = DVec2::new((i % frame.width) as f64 + 0.5, (i / frame.width) as f64 + 0.5);
        worst = worst.max(image.pixel.distance(centre));
        n += 1;
    }
    (worst, n)
}

/// Number of sky pixels surrounded by ground. No skyline moves that far.
fn cracks(frame: &Frame, full: &Frame) -> usize {
    let (w, h) = (frame.width, frame.height);
    let inside = |x: usize, y: usize| (0..9).all(|k| full.id[(y + k / 3 - 1) * w + x + k % 3 - 1] != 0);
    let places = (1..h - 1).flat_map(|y| (1..w - 1).map(move |x| (x, y)));
    places.filter(|&(x, y)| frame.id[y * w + x] == 0 && inside(x, y)).count()
}

fn judge(name: &str, hf: &Heightfield, view: &View, at_most: f64) {
    let scene = ground(hf);
    let full = render(&scene, view, &RenderOptions { lod_px: 0.0, ..coarse() });
    let frame = render(&scene, view, &coarse());
    show(&format!("lod-{name}"), &frame);
    let share = frame.stats.triangles_drawn as f64 / full.stats.triangles_drawn as f64;
    assert!(share < at_most, "{name}: {share:.2} of the triangles are left");
    assert_eq!(cracks(&frame, &full), 0, "{name}: cracks");
    let (worst, n) = off_px(&frame, hf, view);
    assert!(n > frame.id.len() / 4, "{name}: {n} pixels judged");
    // The bent edges of leaves have a separate tolerance, and fixed-point pixels add another hundredth.
    assert!(worst <= LOD_PX + 0.02, "{name}: what a pixel sees lies {worst:.3} px away from it");
    let other = full.id.iter().zip(&frame.id).filter(|(a, b)| a != b).count();
    assert!(other < frame.id.len() / 200, "{name}: {other} pixels see something else");
}

#[test]
fn less_detail_is_within_half_a_pixel_under_every_bend() {
    let hf = hills(1025, 1.1, 60.0, 3);
    for (name, view) in views([400, 300]) {
        judge(name, &hf, &view, 0.8);
    }
}

#[test]
fn sizes_that_are_no_power_of_two_have_no_cracks() {
    for (n, spacing) in [(300, 3.8), (414, 2.8), (65, 18.0), (34, 34.0)] {
        let hf = hills(n, spacing, 90.0, n as u64);
        for (name, view) in views([320, 240]) {
            let [frame, full] =
                [LOD_PX, 0.0].map(|lod_px| render(&ground(&hf), &view, &RenderOptions { lod_px, ..options(1) }));
            assert!(frame.id.contains(&1));
            assert_eq!(cracks(&frame, &full), 0, "{name}, {n} nodes");
        }
    }
}

#[test]
fn andorra_has_no_cracks_in_less_detail() {
    let Some(hf) = andorra() else { return };
    let eye = |above: f64| DVec3::new(1500.0, -26_000.0, 2400.0 + above);
    let camera = |above: f64| pinhole(eye(above), DVec3::new(2500.0, 10_000.0, 1200.0), 42.0, [960, 540]);
    judge("andorra", &hf, &View::straight(camera(2000.0)), 0.95);
    judge("andorra-turn", &hf, &turns(camera(1500.0), Model::Modified, &[(14_000.0, 2500.0)]), 0.95);
    judge("andorra-spline", &hf, &spline_over(camera(3500.0), "progressive", 1400.0), 0.99);
}

#[test]
fn without_a_tolerance_every_cell_is_drawn() {
    let hf = hills(129, 8.0, 20.0, 5);
    let view = View::straight(pinhole(DVec3::new(0.0, -900.0, 700.0), DVec3::ZERO, 60.0, [320, 240]));
    let draw = |lod_px| render(&ground(&hf), &view, &RenderOptions { lod_px, ..options(1) }).stats.triangles_drawn;
    assert_eq!(draw(0.0), 2 * 128 * 128);
    assert!(draw(1.0) < 2 * 128 * 128 && draw(4.0) < draw(1.0));
    for odd in [f64::NAN, -1.0] {
        assert_eq!(draw(odd), 2 * 128 * 128);
    }
}

#[test]
fn less_detail_does_not_depend_on_threads() {
    let hf = hills(257, 4.4, 140.0, 8);
    for (name, view) in views([333, 217]) {
        let draw = |threads| render(&ground(&hf), &view, &RenderOptions { threads, ..coarse() });
        let (one, three) = (draw(1), draw(3));
        assert!(one.color == three.color && one.depth == three.depth && one.id == three.id, "{name}");
    }
}

#[test]
fn coarse_pictures_from_amid_the_ground_have_few_triangles_no_cracks_and_the_error_allowed() {
    let hf = hills(1025, 4.0, 60.0, 3);
    let camera = pinhole(DVec3::new(330.0, 250.0, 120.0), DVec3::new(0.0, 2000.0, -100.0), 45.0, [268, 151]);
    for (name, view) in
        [("plain", View::straight(camera.clone())), ("spline", spline_over(camera.clone(), "degressive", 0.0))]
    {
        let scene = ground(&hf);
        let draw = |lod_px, tolerance_px| render(&scene, &view, &RenderOptions { lod_px, tolerance_px, ..coarse() });
        let (full, careful, frame) = (draw(0.0, 0.5), draw(20.0, 0.5), draw(20.0, 8.0));
        let [careful, few] = [&careful, &frame].map(|frame| frame.stats.triangles_drawn);
        assert!(3 * few < 2 * careful, "{name}: {few} of {careful} triangles");
        assert_eq!(cracks(&frame, &full), 0, "{name}: cracks");
        let (worst, n) = off_px(&frame, &hf, &view);
        assert!(n > frame.id.len() / 2 && worst <= 20.0 + 8.0, "{name}: {worst:.1} px off in {n} pixels");
    }
}
