//! The outline of a target: a line where the picture shows it, dashes where something hides it.

use super::highlight::{border, regions, spread};
use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::{Color, Frame};

/// Widths of rim and line, pixels of a picture 720 high.
const WIDTHS: [f64; 2] = [3.6, 1.8];
const COLORS: [Color; 2] = [Color::rgb(255, 255, 255), Color::rgb(190, 30, 90)];
/// Half widths of gaps that are closed and of specks that are removed, pixels of a picture 720 high: between atoms, and between thin parts.
const CLOSED: f64 = 9.0;
const OPENED: f64 = 1.0;
/// Length of dashes and gaps, pixels of a picture 720 high.
const DASH: f64 = 6.0;

/// Draws the outline.
///
/// * `own`: whether a pixel is one of the target's, row by row; `seen`: whether the picture shows the target there.
pub fn draw(frame: &mut Frame, own: &[bool], seen: &[bool]) {
    let scale = (frame.height as f64 / 720.0).max(0.4);
    let width = frame.width;
    let dash = (scale * DASH).max(2.0);
    let [close, open] = [CLOSED, OPENED].map(|px| (px * scale).round() as usize);
    let region = regions(own, width, close, open);
    // The outline of a region with gaps may lie beside the target.
    let seen = spread(seen, width, close + 1, true);
    let is_inked = |i: usize| {
        let (x, y) = ((i % width) as f64, (i / width) as f64);
        seen[i] || (((x + y) / dash) as usize).is_multiple_of(2) && ((x - y) / dash).floor().rem_euclid(2.0) < 0.5
    };
    let outline: Vec<usize> = border(&region, width).into_iter().filter(|&i| is_inked(i)).collect();
    let mut canvas = Canvas::new(&mut frame.color, width);
    for (line, color) in WIDTHS.into_iter().zip(COLORS) {
        for &i in &outline {
            canvas.disc(DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5), 0.5 * scale * line, color);
        }
    }
}
