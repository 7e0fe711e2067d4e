//! Colours, pictures, transfer functions and progress.

use belvedere_scene::{Cancelled, Color, Progress, Texture, TransferFunction, TransferPoint, Wrap};
use glam::Vec2;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex};

/// The transfer curve of sRGB (IEC 61966-2-1) in double precision.
fn light(code: u8) -> f64 {
    let v = f64::from(code) / 255.0;
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// The product of linear light is found again by bisection over the codes, without the inverse of the curve.
#[test]
fn colours_multiply_in_linear_light() {
    for a in (0..=254u8).step_by(3) {
        for b in (0..=254u8).step_by(7) {
            let wanted = light(a) * light(b);
            let nearest = (0..=255u8).min_by(|x, y| (light(*x) - wanted).abs().total_cmp(&(light(*y) - wanted).abs()));
            let Color { r, g, b: blue, .. } = Color::rgb(a, b, a).times(Color::rgb(b, a, 255));
            let off = (i32::from(r) - i32::from(nearest.expect("codes"))).abs();
            assert!(off <= 1 && g == r && blue == a, "{a} {b}: {r}, {nearest:?}");
        }
    }
}

fn pixel(column: i64, row: i64) -> [u8; 4] {
    [(20 * column + 70 * row) as u8, (90 * column) as u8, (60 * row + 9) as u8, (255 - 30 * row) as u8]
}

/// Against the four pixels around a place, looked up by the rule of each way to go on beyond the edge.
#[test]
fn pictures_mix_the_four_pixels_around_a_place() {
    let (width, height) = (3i64, 2i64);
    let pixels: Vec<[u8; 4]> = (0..6).map(|i| pixel(i % width, i / width)).collect();
    let ways = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror];
    for wrap in ways.into_iter().flat_map(|across| ways.map(|down| [across, down])) {
        let texture = Texture::new(3, 2, pixels.clone(), wrap).expect("a picture");
        let inside = |i: i64, n: i64, wrap: Wrap| match wrap {
            Wrap::Repeat => (i + 10 * n) % n,
            Wrap::Clamp => i.max(0).min(n - 1),
            Wrap::Mirror => {
                [(i + 20 * n) % (2 * n), 2 * n - 1 - (i + 20 * n) % (2 * n)].into_iter().min().expect("two")
            }
        };
        for k in 0..200 {
            let place = Vec2::new(-1.3 + 0.0142 * k as f32, -0.9 + 0.01666 * k as f32);
            let (x, y) = (place.x * 3.0 - 0.5, place.y * 2.0 - 0.5);
            let weight = |from: i64, at: f32| (1.0 - (at - from as f32).abs()).max(0.0);
            let mut want = [0.0f32; 4];
            for row in -6..6 {
                for column in -9..9 {
                    let w = weight(column, x) * weight(row, y);
                    let part = pixel(inside(column, width, wrap[0]), inside(row, height, wrap[1]));
                    want.iter_mut().zip(part).for_each(|(sum, v)| *sum += w * f32::from(v));
                }
            }
            let Color { r, g, b, a } = texture.at(place, 1.0);
            let off = [r, g, b, a].iter().zip(want).map(|(v, w)| (f32::from(*v) - w).abs()).fold(0.0, f32::max);
            assert!(off < 0.51, "{wrap:?} {place}: {:?}, {want:?}", [r, g, b, a]);
        }
        let Color { r, g, b, a } = texture.at(Vec2::new(f32::NAN, 0.5), 1.0);
        assert_eq!([r, g, b, a], pixel(0, 0), "a place that is not finite shows the first pixel");
    }
}

#[test]
fn transfer_functions_mix_between_points_and_go_on_beyond_them() {
    let point = |value: f64, r: u8, opacity: f64| TransferPoint { value, color: Color::rgb(r, 0, 51), opacity };
    let points = vec![point(10.0, 0, 0.0), point(20.0, 255, 0.5), point(40.0, 255, 1.0)];
    let function = TransferFunction::new("t", points, 1.0).expect("valid");
    for (value, [red, opacity]) in [
        (-5.0, [0.0, 0.0]),
        (10.0, [0.0, 0.0]),
        (12.5, [0.25, 0.125]),
        (20.0, [1.0, 0.5]),
        (30.0, [1.0, 0.75]),
        (40.0, [1.0, 1.0]),
        (99.0, [1.0, 1.0]),
    ] {
        let found = function.at(value);
        let want = [red, 0.0, 0.2, opacity];
        assert!(found.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{value}: {found:?}");
    }
}

#[test]
fn progress_tells_its_listener_and_ends_when_it_is_cancelled() {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let log = Arc::clone(&heard);
    let progress = Progress::new(move |stage, done| log.lock().expect("free").push((stage.to_owned(), done)));
    assert_eq!(progress.tick("ground", 0.25), Ok(()));
    assert_eq!(progress.unheard().tick("ground", 0.5), Ok(()));
    progress.cancel_flag().store(true, Relaxed);
    assert_eq!(progress.tick("lines", 1.0), Err(Cancelled));
    assert_eq!(progress.unheard().tick("lines", 1.0), Err(Cancelled));
    assert_eq!(*heard.lock().expect("free"), [("ground".to_owned(), 0.25), ("lines".to_owned(), 1.0)]);
}
