//! A ring around the image of the target point.

use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::{Color, Frame};

/// Radius and widths of ring and rim, pixels of a picture 720 high.
const RADIUS: f64 = 13.0;
const WIDTHS: [f64; 2] = [5.0, 2.4];
const COLORS: [Color; 2] = [Color::rgb(255, 255, 255), Color::rgb(190, 30, 90)];
/// Numbers of corners of the ring, and of each dash and gap.
const CORNERS: usize = 72;
const DASH: usize = 6;

/// Draws the ring, dashed where the point is hidden.
pub(crate) fn draw(frame: &mut Frame, at: DVec2, hidden: bool) {
    let scale = (frame.height as f64 / 720.0).max(0.4);
    let corner = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / CORNERS as f64).sin_cos();
        at + scale * RADIUS * DVec2::new(cos, sin)
    };
    let mut canvas = Canvas::new(&mut frame.color, frame.width);
    for (width, color) in WIDTHS.into_iter().zip(COLORS) {
        let (every, length) = if hidden { (2 * DASH, DASH) } else { (CORNERS, CORNERS) };
        for first in (0..CORNERS).step_by(every) {
            let dash: Vec<DVec2> = (first..=first + length).map(corner).collect();
            canvas.line(&dash, scale * width, color);
        }
    }
}
