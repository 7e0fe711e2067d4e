//! Ground with a soft edge: it fades in every sample of a pixel.

use crate::support::{hills, layer, options, pinhole, scene, terrain};
use crate::support_views::spline;
use belvedere_core::{DVec3, View};
use belvedere_cpu::{CpuRenderer, ExactRenderer};
use belvedere_scene::{
    Color, Edge, Frame, LayerKind, Light, Progress, RenderJob, RenderOptions, Renderer, Scene, Sky, TerrainLayer,
};

/// Hills with a soft edge, several cells per pixel, with the peaks of rough ground along the rim.
fn fading(seed: u64) -> Scene {
    let ground = TerrainLayer { edge: Edge::Soft, ..terrain(hills(251, 4.6, 160.0, seed)) };
    scene(vec![layer("ground", LayerKind::Terrain(ground))])
}

fn drawn(renderer: &dyn Renderer, scene: &Scene, view: &View, sky: Sky, options: &RenderOptions) -> Frame {
    let light = Light { sky, haze: belvedere_scene::Haze::None, ..Light::default() };
    let job = RenderJob { scene, view, light: &light, options, progress: &Progress::silent() };
    renderer.render(&job).expect("a picture")
}

/// Sums of red, green and blue, as they differ from a background.
fn off(frame: &Frame, background: u8) -> Vec<i32> {
    let of = |c: &[u8; 3]| c.iter().map(|v| i32::from(v.abs_diff(background))).sum();
    frame.color.iter().map(of).collect()
}

/// Pixels that stand out by more than 90 of 765, and twice as much as each pixel beside them, where the median of the 5 x 5 pixels around is
/// below 30. Peaks of the skyline are joined to ground.
fn specks(off: &[i32], [width, height]: [usize; 2]) -> usize {
    let lone = |x: usize, y: usize| {
        let mut around: Vec<i32> =
            (y - 2..=y + 2).flat_map(|v| (x - 2..=x + 2).map(move |u| v * width + u)).map(|i| off[i]).collect();
        around.sort_unstable();
        let here = off[y * width + x];
        let beside = (y - 1..=y + 1).flat_map(|v| (x - 1..=x + 1).map(move |u| (u, v))).filter(|at| *at != (x, y));
        let lone = beside.map(|(u, v)| off[v * width + u]).all(|other| 2 * other < here);
        here > 90 && around[12] < 30 && lone
    };
    (2..height - 2).flat_map(|y| (2..width - 2).map(move |x| (x, y))).filter(|&(x, y)| lone(x, y)).count()
}

fn views(image: [u32; 2]) -> [(&'static str, View); 2] {
    let camera = pinhole(DVec3::new(0.0, -1500.0, 700.0), DVec3::new(0.0, 0.0, 30.0), 45.0, image);
    [("straight", View::straight(camera.clone())), ("progressive", spline(camera, "progressive"))]
}

#[test]
fn beyond_the_fade_of_a_soft_edge_no_pixel_stands_out() {
    for (seed, image) in [(3, [320, 200]), (4, [217, 131]), (5, [320, 200])] {
        let scene = fading(seed);
        for ((name, view), background) in views(image).into_iter().flat_map(|v| [0, 255].map(|b| (v.clone(), b))) {
            let sky = Sky::Plain(Color::rgb(background, background, background));
            for samples in [1, 4, 16] {
                let frame = drawn(&CpuRenderer::default(), &scene, &view, sky, &options(samples));
                let off = off(&frame, background);
                let [width, height] = image.map(|n| n as usize);
                let said = format!("seed {seed}, {image:?}, {name}, {samples} samples, sky {background}");
                assert_eq!(specks(&off, [width, height]), 0, "{said}");
                let whole = off.iter().filter(|v| **v > 150).count();
                assert!(whole > off.len() / 12, "the ground within is there: {whole} pixels, {said}");
            }
        }
    }
}

#[test]
fn faded_pixels_are_the_mean_of_faded_samples_in_both_renderers() {
    let scene = fading(7);
    let (view, finer) = (views([160, 100])[0].1.clone(), views([1280, 800])[0].1.clone());
    let sky = Sky::Plain(Color::rgb(0, 0, 0));
    // Eight times as fine, one sample each: the means in linear light.
    let fine = drawn(&CpuRenderer::default(), &scene, &finer, sky, &options(1));
    let linear = |v: u8| (f64::from(v) / 255.0).powf(2.2);
    let mean = |i: usize, k: usize| {
        let (x, y) = (8 * (i % 160), 8 * (i / 160));
        let of = |j: usize| linear(fine.color[(y + j / 8) * 1280 + x + j % 8][k]);
        255.0 * ((0..64).map(of).sum::<f64>() / 64.0).powf(1.0 / 2.2)
    };
    for renderer in [&CpuRenderer::default() as &dyn Renderer, &ExactRenderer] {
        let frame = drawn(renderer, &scene, &view, sky, &options(16));
        let far = (0..frame.color.len())
            .filter(|&i| (0..3).any(|k| (mean(i, k) - f64::from(frame.color[i][k])).abs() > 40.0));
        let far = far.count();
        // 54 of them when this was written.
        assert!(far < 100, "{}: {far} of {} pixels differ", renderer.name(), frame.color.len());
    }
}
