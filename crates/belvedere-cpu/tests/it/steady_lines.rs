//! Lines in motion: when the camera turns by a tenth of a pixel, no pixel of a line changes by much more than a tenth.

use crate::support::{hills, layer, line, options, pinhole, render, scene, terrain};
use crate::support_views::{spline, turns};
use belvedere_core::map::curved_rays::Model;
use belvedere_core::{DVec2, DVec3, Pinhole, View};
use belvedere_scene::{Color, Heightfield, Hidden, LayerKind, RenderOptions, Scene};

const IMAGE: [u32; 2] = [240, 160];
/// Turn from frame to frame, pixels.
const STEP_PX: f64 = 0.1;
const FRAMES: u32 = 8;

fn camera(turn_px: f64) -> Pinhole {
    let straight = pinhole(DVec3::new(-100.0, -700.0, 420.0), DVec3::new(20.0, 0.0, 0.0), 50.0, IMAGE);
    let angle = turn_px / straight.scale_px();
    let forward = straight.forward * angle.cos() + straight.right * angle.sin();
    pinhole(straight.eye, straight.eye + 1000.0 * forward, 50.0, IMAGE)
}

/// Hills with a path over them.
fn ground(nodes: usize) -> (Heightfield, Vec<DVec3>) {
    let hf = hills(nodes, 1152.0 / (nodes - 1) as f64, 120.0, 21);
    let points = (0..600)
        .map(|i| {
            let t = f64::from(i) / 599.0;
            let xy = DVec2::new(-500.0 + 1000.0 * t, 330.0 * (t * 9.0).sin());
            xy.extend(hf.surface_at(xy).expect("on the hills"))
        })
        .collect();
    (hf, points)
}

/// Share of each pixel that a black line covers, computed from how much darker the pixel is.
fn coverage([bare, lined]: [&Scene; 2], view: &View, lod_px: f64) -> Vec<f64> {
    let options = RenderOptions { lod_px, ..options(4) };
    let light = |v: u8| {
        let s = f64::from(v) / 255.0;
        if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
    };
    let [ground, drawn] = [bare, lined].map(|scene| render(scene, view, &options));
    let left = drawn.stats.triangles_drawn as f64 / drawn.stats.triangles_in as f64;
    assert!(lod_px == 0.0 || left < 0.5, "{left} of the triangles are drawn");
    ground.color.iter().zip(&drawn.color).map(|(g, d)| 1.0 - light(d[1]) / light(g[1])).collect()
}

/// Measurements of a line in motion.
#[derive(Debug, Default)]
struct Motion {
    /// Number of pixels, over all frames, of which the line covers more than a tenth.
    covered: usize,
    /// How many of those pixels, and of those that the line leaves, changed by more than half a pixel's worth in a step of a tenth.
    jumps: usize,
    /// Root mean square of the change of those pixels.
    change: f64,
    /// Largest relative change, from frame to frame, of the whole area that the line covers.
    ink: f64,
}

impl Motion {
    fn of(frames: &[Vec<f64>]) -> Self {
        let mut out = Self::default();
        let mut sum = 0.0;
        for pair in frames.windows(2) {
            let ink = pair.iter().map(|frame| frame.iter().sum::<f64>()).collect::<Vec<_>>();
            out.ink = out.ink.max((ink[1] / ink[0] - 1.0).abs());
            for (a, b) in pair[0].iter().zip(&pair[1]).filter(|(a, b)| a.max(**b) > 0.1) {
                out.covered += 1;
                out.jumps += usize::from((b - a).abs() > 0.5);
                sum += (b - a).powi(2);
            }
        }
        out.change = (sum / out.covered.max(1) as f64).sqrt();
        out
    }
}

fn judge(name: &str, width_px: f64, hidden: Hidden, lod_px: f64, view: impl Fn(Pinhole) -> View) {
    // Far more nodes than pixels where the detail is to be reduced.
    let (hf, points) = ground(if lod_px > 0.0 { 1025 } else { 257 });
    let below = || layer("ground", LayerKind::Terrain(terrain(hf.clone())));
    let mut style = line(points, hidden);
    (style.width_px, style.color, style.casing) = (width_px, Color::rgb(0, 0, 0), None);
    let (bare, lined) = (scene(vec![below()]), scene(vec![below(), layer("route", LayerKind::Line(style))]));
    let frames: Vec<Vec<f64>> =
        (0..FRAMES).map(|i| coverage([&bare, &lined], &view(camera(STEP_PX * f64::from(i))), lod_px)).collect();
    let motion = Motion::of(&frames);
    assert!(motion.covered > 3000, "{name}: {motion:?}");
    assert!(motion.jumps * 1000 <= motion.covered, "{name}: {motion:?}");
    assert!(motion.change < 0.1 && motion.ink < 0.03, "{name}: {motion:?}");
}

fn judge_all(lod_px: f64) {
    judge("straight", 3.0, Hidden::Cut, lod_px, View::straight);
    judge("fine", 1.2, Hidden::Fade, lod_px, View::straight);
    judge("a turn", 3.0, Hidden::Cut, lod_px, |ph| turns(ph, Model::Modified, &[(600.0, 220.0)]));
    judge("a spline", 2.0, Hidden::Cut, lod_px, |ph| spline(ph, "progressive"));
}

#[test]
fn lines_change_as_slowly_as_the_camera_turns() {
    judge_all(0.0);
}

#[test]
fn lines_on_ground_in_less_detail_do_too() {
    judge_all(0.5);
}
