//! Lines: where they are visible, and that the styles for hidden lines change nothing else.

use crate::support::{hills, layer, line, options, pinhole, render, scene, terrain};
use crate::support_views::views;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Color, Frame, Heightfield, Hidden, LayerKind, LineLayer, Scene};

const LIFT_M: f64 = 2.0;

fn ground() -> Heightfield {
    hills(120, 10.0, 220.0, 21)
}

fn route(hf: &Heightfield, n: usize) -> Vec<DVec3> {
    (0..n)
        .map(|i| {
            let t = i as f64 / (n - 1) as f64;
            let xy = DVec2::new(-480.0 + 960.0 * t, 330.0 * (t * 9.0).sin());
            xy.extend(hf.surface_at(xy).expect("on the hills"))
        })
        .collect()
}

fn with_line(hf: &Heightfield, style: LineLayer) -> Scene {
    scene(vec![layer("ground", LayerKind::Terrain(terrain(hf.clone()))), layer("route", LayerKind::Line(style))])
}

/// Smallest height above the ground of the (curved) ray from the eye to just before the point, in metres; negative if the point is
/// hidden.
fn clearance(hf: &Heightfield, view: &View, pixel: DVec2, depth: f64) -> f64 {
    let ray = view.ray(pixel);
    let (near, steps) = (view.pinhole().near, 4000);
    (0..=steps)
        .filter_map(|i| {
            let p = ray.at(near + (depth - 0.5 - near) * f64::from(i) / f64::from(steps)).ok()?.point;
            Some(p.z - hf.surface_at(p.truncate())?)
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn visibility_agrees_with_lines_of_sight() {
    let hf = ground();
    let points = route(&hf, 400);
    // The line is so high that the ray to a visible point passes the ground at more than the size of a pixel.
    let mut style = line(points.clone(), Hidden::Cut);
    style.lift_m = 8.0;
    let scene = with_line(&hf, style);
    for (name, view) in views([640, 480]) {
        let frame = render(&scene, &view, &options(1));
        let seen: Vec<(DVec2, f64)> = points
            .iter()
            .filter_map(|p| view.project(*p + DVec3::Z * 8.0).ok())
            .filter(|s| (4.0..636.0).contains(&s.pixel.x) && (4.0..476.0).contains(&s.pixel.y))
            .map(|s| (s.pixel, clearance(&hf, &view, s.pixel, s.depth)))
            .collect();
        let (mut judged, mut wrong, mut hidden) = (0, Vec::new(), 0);
        for &(pixel, clear) in &seen {
            // A grazing ray may count as visible or hidden within a pixel, and a hidden point may be next to a visible part.
            let beside = |other: &&(DVec2, f64)| other.1 > -4.0 && other.0.distance(pixel) < 5.0;
            if clear.abs() < 4.0 || (clear < 0.0 && seen.iter().any(|o| beside(&o))) {
                continue;
            }
            let drawn = frame.id[pixel.y as usize * 640 + pixel.x as usize] == 2;
            judged += 1;
            hidden += usize::from(clear < 0.0);
            if drawn != (clear > 0.0) {
                wrong.push((pixel, clear));
            }
        }
        assert!(judged > 80 && hidden > 5, "{name}: {judged} points judged, {hidden} hidden");
        assert!(wrong.len() * 100 <= judged, "{name}: {} of {judged} points judged wrongly: {wrong:?}", wrong.len());
    }
}

fn changed(a: &Frame, b: &Frame) -> Vec<bool> {
    a.color.iter().zip(&b.color).map(|(a, b)| a != b).collect()
}

#[test]
fn hidden_styles_change_only_hidden_parts() {
    let hf = ground();
    let points = route(&hf, 400);
    let (_, view) = views([640, 480]).remove(0);
    let frame = |hidden| render(&with_line(&hf, line(points.clone(), hidden)), &view, &options(4));
    let bare = render(&scene(vec![layer("ground", LayerKind::Terrain(terrain(hf.clone())))]), &view, &options(4));
    let cut = frame(Hidden::Cut);
    let visible = cut.id.iter().filter(|&&id| id == 2).count();
    assert!(visible > 500, "{visible} pixels of line");
    let mut touched = Vec::new();
    for style in [Hidden::Show, Hidden::Fade, Hidden::Dash] {
        let styled = frame(style);
        assert!(styled.depth == cut.depth && styled.id == cut.id, "{style:?}: hidden parts reach into id or depth");
        let difference = changed(&styled, &cut);
        for (i, _) in difference.iter().enumerate().filter(|(_, d)| **d) {
            assert!(cut.id[i] != 2 || style == Hidden::Show, "{style:?}: a visible pixel of the line changed");
        }
        touched.push(difference.iter().filter(|d| **d).count());
    }
    let [show, fade, dash] = touched[..] else { panic!("three styles") };
    assert!(show > fade && fade > dash && dash > 200, "pixels changed: show {show}, fade {fade}, dash {dash}");
    assert!(changed(&cut, &bare).iter().filter(|d| **d).count() >= visible);
}

#[test]
fn width_and_casing_are_as_asked() {
    let flat = hills(60, 20.0, 0.0, 1);
    let points = vec![DVec3::new(-300.0, 0.0, 0.0), DVec3::new(300.0, 0.0, 0.0)];
    let view = View::straight(pinhole(DVec3::new(0.0, -1.0, 700.0), DVec3::ZERO, 50.0, [400, 300]));
    for width_px in [1.0, 2.0, 3.0, 5.0, 12.0] {
        let mut style = line(points.clone(), Hidden::Cut);
        style.width_px = width_px;
        style.color = Color::rgb(0, 0, 0);
        style.casing = None;
        let frame = render(&with_line(&flat, style), &view, &options(4));
        let bare = render(&scene(vec![layer("ground", LayerKind::Terrain(terrain(flat.clone())))]), &view, &options(4));
        // Ink across the line in the middle of the picture, in linear light.
        let light = |f: &Frame, y: usize| (f64::from(f.color[y * 400 + 200][1]) / 255.0).powf(2.2);
        let ink: f64 = (0..300).map(|y| 1.0 - light(&frame, y) / light(&bare, y)).sum();
        assert!((ink - width_px).abs() < 0.15 + 0.03 * width_px, "{width_px} px wide line has {ink:.2} px of ink");
    }
}

#[test]
fn a_line_on_rough_ground_does_not_flicker() {
    // From above nothing is hidden, so the line must be one piece, whatever the twist of the cells.
    let hf = hills(60, 20.0, 260.0, 33);
    let points = route(&hf, 90);
    let view = View::straight(pinhole(DVec3::new(0.0, -250.0, 1500.0), DVec3::ZERO, 50.0, [640, 480]));
    let frame = render(&with_line(&hf, line(points.clone(), Hidden::Cut)), &view, &options(1));
    for pair in points.windows(2) {
        for k in 0..8 {
            let xy = pair[0].lerp(pair[1], f64::from(k) / 8.0).truncate();
            let p = xy.extend(hf.surface_at(xy).expect("on the hills") + LIFT_M);
            let seen = view.project(p).expect("in front").pixel.floor();
            assert_eq!(frame.id[seen.y as usize * 640 + seen.x as usize], 2, "gap at {p}");
        }
    }
}
