//! A ring with four strokes around the image of the target point, between which the point itself stays free.

use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::{Color, Frame};

/// Radius of the ring, and where the strokes end, units of the symbols in a picture.
const RADIUS: f64 = 17.0;
const STROKES: f64 = 29.0;
/// Widths of the dark casing, the light one and the line, in the same unit: one of the two casings differs from whatever lies below.
const WIDTHS: [f64; 3] = [8.4, 6.2, 3.2];
const COLORS: [Color; 3] = [Color::rgb(24, 26, 34), Color::rgb(255, 255, 255), Color::rgb(208, 20, 88)];
/// Height or width of a picture, whichever is less, from which on the mark grows with it, and largest share of that which its radius takes.
const USUAL: f64 = 720.0;
const LARGEST: f64 = 0.1;
/// Numbers of corners of the ring, and of each dash and gap.
const CORNERS: usize = 72;
const DASH: usize = 6;

/// Size of the unit of the mark in a picture, pixels: that of all symbols, more in large pictures, less where it would fill a small one.
/// * `density`: pixels per unit of symbols.
fn unit_px(frame: &Frame, density: f64) -> f64 {
    let smaller = frame.width.min(frame.height) as f64;
    density.max(smaller / USUAL).min(LARGEST * smaller / RADIUS)
}

/// Draws the ring, dashed where the point is hidden.
/// * `density`: pixels per unit of symbols.
pub fn draw(frame: &mut Frame, at: DVec2, hidden: bool, density: f64) {
    let scale = unit_px(frame, density);
    let direction = |share: f64| DVec2::from_angle(std::f64::consts::TAU * share);
    let corner = |i: usize| at + scale * RADIUS * direction(i as f64 / CORNERS as f64);
    let (every, length) = if hidden { (2 * DASH, DASH) } else { (CORNERS, CORNERS) };
    let dashes = (0..CORNERS).step_by(every).map(|first| (first..=first + length).map(corner).collect::<Vec<_>>());
    let strokes = (0..4).map(|k| [RADIUS, STROKES].map(|r| at + scale * r * direction(0.25 * f64::from(k))).to_vec());
    let lines: Vec<Vec<DVec2>> = dashes.chain(strokes).collect();
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    for (width, color) in WIDTHS.into_iter().zip(COLORS) {
        for line in &lines {
            canvas.line(line, scale * width, color);
        }
    }
}

#[cfg(test)]
mod tests;
