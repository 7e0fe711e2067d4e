//! The mark of bent pictures, and titles under pairs.

use super::{INK, PAPER};
use belvedere_core::DVec2;
use belvedere_cpu::canvas::{Canvas, text_size};
use belvedere_scene::Color;

/// Words of the mark.
pub(crate) const WORDS: &str = "bent view";
/// Smallest picture that has room for the mark, pixels.
const SMALLEST: [f64; 2] = [160.0, 90.0];
const LETTERS_PX: f64 = 12.0;
/// Height of the strip with the titles of a pair, pixels.
const STRIP: usize = 28;

/// Whether a picture of this size has room for the mark.
pub(crate) fn fits(width: usize, height: usize) -> bool {
    width as f64 >= SMALLEST[0] && height as f64 >= SMALLEST[1]
}

/// Draws the mark into the lower right corner: a ray that bends over a hill, and two words.
pub(crate) fn draw(canvas: &mut Canvas<'_>) {
    let size = canvas.size();
    let words = text_size(LETTERS_PX, WORDS);
    let box_size = DVec2::new(28.0 + words.width + 18.0, 24.0);
    let lo = size - box_size - 10.0;
    canvas.rect(lo, lo + box_size, 5.0, PAPER);
    let at = |x: f64, y: f64| lo + DVec2::new(8.0 + x, 4.0 + y);
    let hill: Vec<DVec2> = (0..=14)
        .map(|i| {
            let x = 4.0 + f64::from(i);
            at(x, 15.0 - 7.5 * (-((x - 11.0) / 3.4).powi(2)).exp())
        })
        .collect();
    canvas.line(&hill, 1.4, Color::rgb(120, 128, 120));
    let ray: Vec<DVec2> = (0..=20)
        .map(|i| {
            let x = f64::from(i);
            at(x, 4.0 + 0.5 * (((x - 9.0) / 3.0).exp() + 1.0).ln() * 1.9)
        })
        .collect();
    canvas.line(&ray, 1.8, Color::rgb(213, 94, 0));
    canvas.disc(ray[0], 2.2, INK);
    canvas.text(lo + DVec2::new(36.0, 0.5 * box_size.y + 0.36 * LETTERS_PX), LETTERS_PX, WORDS, INK, None);
}

/// Adds a strip with titles under pictures that stand side by side: text and left edge of each. Narrow pictures stay as they are.
pub(crate) fn titled(
    (width, height, mut pixels): (usize, usize, Vec<[u8; 3]>),
    titles: &[(&str, usize)],
) -> (usize, usize, Vec<[u8; 3]>) {
    if (width as f64) < 2.0 * SMALLEST[0] {
        return (width, height, pixels);
    }
    pixels.resize(width * (height + STRIP), [255; 3]);
    let mut canvas = Canvas::new(&mut pixels, width);
    for (text, left) in titles {
        canvas.text(DVec2::new(*left as f64 + 8.0, height as f64 + 19.0), 14.0, text, INK, None);
    }
    (width, height + STRIP, pixels)
}
