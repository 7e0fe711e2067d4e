//! Edges of volumes: smooth in pictures of four samples per pixel.

use crate::exact::trace;
use crate::support::{layer, options, pinhole, render, scene};
use belvedere_core::{DMat3, DVec3, View};
use belvedere_scene::{
    Color, Frame, LayerKind, Scene, TransferFunction, TransferPoint, Volume, VolumeLayer, VoxelValues,
};

const IMAGE: [u32; 2] = [120, 90];
/// How many times wider and higher the picture is that tells the right colours.
const FINER: u32 = 8;

/// Two opaque balls in one volume, one before the other.
fn balls() -> Scene {
    let n = 32usize;
    let near = |p: DVec3, center: DVec3, radius: f64| (radius - p.distance(center)).clamp(-3.0, 3.0);
    let value = |i: usize| {
        let p = DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64);
        let d = near(p, DVec3::new(12.0, 11.0, 15.0), 8.0).max(near(p, DVec3::new(21.0, 22.0, 15.0), 6.0));
        (127.5 + 42.0 * d) as u8
    };
    let values = (0..n * n * n).map(value).collect();
    let volume =
        Volume::new([n; 3], DMat3::IDENTITY, DVec3::splat(-15.5), VoxelValues::U8(values)).expect("well formed");
    let point = |value, opacity| TransferPoint { value, color: Color::rgb(150, 40, 30), opacity };
    let transfer =
        TransferFunction::new("balls", vec![point(120.0, 0.0), point(135.0, 0.999), point(255.0, 0.999)], 1.0);
    scene(vec![layer("balls", LayerKind::Volume(VolumeLayer::new(volume, transfer.expect("rising"))))])
}

fn view(image: [u32; 2]) -> View {
    View::straight(pinhole(DVec3::new(-60.0, -45.0, 30.0), DVec3::ZERO, 30.0, image))
}

fn linear(v: u8) -> f64 {
    let s = f64::from(v) / 255.0;
    if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}

/// Root mean square difference of linear light from the mean of the finer picture's pixels.
fn difference(frame: &Frame, fine: &Frame) -> f64 {
    let n = FINER as usize;
    let mut sum = 0.0;
    for (i, color) in frame.color.iter().enumerate() {
        let [x, y] = [i % frame.width, i / frame.width];
        for (c, value) in color.iter().take(3).enumerate() {
            let of = |k: usize| fine.color[(y * n + k / n) * fine.width + x * n + k % n][c];
            let mean = (0..n * n).map(|k| linear(of(k))).sum::<f64>() / (n * n) as f64;
            sum += (linear(*value) - mean).powi(2);
        }
    }
    (sum / frame.color.len() as f64).sqrt()
}

#[test]
fn edges_of_volumes_are_smooth_and_show_the_same_places() {
    let scene = balls();
    let fine = render(&scene, &view(IMAGE.map(|n| n * FINER)), &options(1));
    let [rough, smooth] = [1, 4].map(|samples| render(&scene, &view(IMAGE), &options(samples)));
    let [off, left] = [&rough, &smooth].map(|frame| difference(frame, &fine));
    assert!(left < 0.45 * off, "{left} of {off}");
    assert!(rough.depth == smooth.depth && rough.id == smooth.id);
    assert!(smooth.stats.samples < 2 * rough.stats.samples, "{} samples", smooth.stats.samples);
    let exact = trace(&scene, &view(IMAGE), &options(4));
    let differ = |i: &usize| smooth.color[*i].iter().zip(exact.color[*i]).any(|(a, b)| a.abs_diff(b) > 8);
    let differing = (0..exact.color.len()).filter(differ).count();
    assert!(differing * 500 < exact.color.len(), "{differing} pixels differ from those of the exact renderer");
}
