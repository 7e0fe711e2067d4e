//! Heat map of the displacement of the points in the picture.

use super::{INK, PAPER, length};
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{Color, Frame};
use belvedere_sight::RigidLayers;
use rayon::prelude::*;

/// Height of the legend, pixels.
pub const LEGEND_HEIGHT: f64 = 48.0;

/// Dark blue to yellow with evenly rising lightness, told apart with any colour vision (support colours of viridis, CC0).
const RAMP: [[f32; 3]; 9] = [
    [0.267, 0.005, 0.329],
    [0.279, 0.175, 0.483],
    [0.230, 0.322, 0.546],
    [0.173, 0.449, 0.558],
    [0.128, 0.567, 0.551],
    [0.158, 0.684, 0.502],
    [0.369, 0.789, 0.383],
    [0.678, 0.864, 0.190],
    [0.993, 0.906, 0.144],
];

/// Colour of a share of the largest displacement.
pub fn ramp(share: f64) -> [u8; 3] {
    let t = share.clamp(0.0, 1.0) as f32 * (RAMP.len() - 1) as f32;
    let i = (t as usize).min(RAMP.len() - 2);
    std::array::from_fn(|c| ((RAMP[i][c] + (t - i as f32) * (RAMP[i + 1][c] - RAMP[i][c])) * 255.0 + 0.5) as u8)
}

/// A colour with the lightness of `color` and a little of its hue, in the hue of `tone`.
pub fn tinted(color: [u8; 3], tone: [u8; 3]) -> [u8; 3] {
    let light = light(color);
    std::array::from_fn(|c| {
        let heat = f32::from(tone[c]) * (0.45 + 0.75 * light);
        (0.2 * f32::from(color[c]) + 0.8 * heat).min(255.0) as u8
    })
}

/// Lightness of a colour, 0..=1.
pub fn light(color: [u8; 3]) -> f32 {
    let [r, g, b] = color.map(f32::from);
    (0.30 * r + 0.59 * g + 0.11 * b) / 255.0
}

/// Tints the surfaces of `frame`; marks drawn over them are unchanged. Returns the largest displacement, scene units.
/// * `bare`: the same picture without marks, with world positions.
pub fn paint(frame: &mut Frame, bare: &Frame, (view, rigid): (&View, &RigidLayers)) -> f64 {
    let Some(world) = &bare.world else { return 0.0 };
    let straight = view.straightened();
    let moved: Vec<f64> = world
        .par_iter()
        .enumerate()
        .map(|(i, p)| {
            let p = DVec3::from_array(*p);
            match (rigid.displaced(view, bare, i, p), straight.displace(p)) {
                (Some(bent), Ok(plain)) => bent.distance(plain.point),
                _ => f64::NAN,
            }
        })
        .collect();
    let most = moved.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
    for ((color, bare), moved) in frame.color.iter_mut().zip(&bare.color).zip(&moved) {
        // A mark changes every pixel, except those that it hardly touches.
        if moved.is_finite() && color == bare {
            *color = tinted(*color, ramp(if most > 0.0 { moved / most } else { 0.0 }));
        }
    }
    most
}

/// The legend, in the lower left corner.
pub fn legend(canvas: &mut Canvas<'_>, most: f64) {
    let size = canvas.size();
    let (width, height) = (210.0, LEGEND_HEIGHT);
    if size.x < width + 20.0 || size.y < height + 20.0 {
        return;
    }
    let lo = DVec2::new(10.0, size.y - height - 10.0);
    canvas.rect(lo, lo + DVec2::new(width, height), 5.0, PAPER);
    canvas.text(lo + DVec2::new(10.0, 16.0), 12.0, "moved by the bend", INK, None);
    let bar = width - 20.0;
    for i in 0..bar as usize {
        let [r, g, b] = ramp(i as f64 / (bar - 1.0));
        let x = lo.x + 10.0 + i as f64;
        canvas.rect(DVec2::new(x, lo.y + 21.0), DVec2::new(x + 1.0, lo.y + 30.0), 0.0, Color::rgb(r, g, b));
    }
    for (share, shift) in [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0)] {
        let text = if share == 0.0 { "0".into() } else { length(share * most) };
        let x = lo.x + 10.0 + share * bar - shift * text_size(11.0, &text).width;
        canvas.text(DVec2::new(x, lo.y + 42.0), 11.0, &text, INK, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_rises_along_the_ramp() {
        let light = |s: f64| {
            let [r, g, b] = ramp(s).map(f64::from);
            0.2126 * (r / 255.0).powf(2.2) + 0.7152 * (g / 255.0).powf(2.2) + 0.0722 * (b / 255.0).powf(2.2)
        };
        for i in 0..32 {
            let (a, b) = (light(f64::from(i) / 32.0), light(f64::from(i + 1) / 32.0));
            assert!(b > a, "step {i}: {a} to {b}");
        }
    }
}
