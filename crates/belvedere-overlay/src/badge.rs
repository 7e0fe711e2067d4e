//! The mark of bent pictures, and titles under pairs.

use super::{INK, PAPER, length_above, number_above};
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::DVec2;
use belvedere_scene::{Color, Unit};

/// The shortest words of the mark, and those of all frames of a film: figures would change from frame to frame.
pub const WORDS: &str = "bent view";
/// What is drawn by rule in a picture, and is no data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Made {
    /// Nothing.
    Nothing,
    /// Relief finer than the data; what covers the ground is data.
    Relief,
    /// Materials as well.
    Materials,
}

impl Made {
    /// What else the mark says.
    fn words(self) -> Option<&'static str> {
        match self {
            Self::Nothing => None,
            Self::Relief => Some("fine relief drawn by rule"),
            Self::Materials => Some("forest and fine relief drawn by rule"),
        }
    }
}
/// Smallest picture that the mark fits into, pixels.
const SMALLEST: [f64; 2] = [160.0, 90.0];
const LETTERS_PX: f64 = 12.0;
/// Height of the strip with the titles of a pair, pixels.
const STRIP: usize = 28;

/// Whether the mark fits into a picture of this size.
pub fn fits(width: usize, height: usize) -> bool {
    width as f64 >= SMALLEST[0] && height as f64 >= SMALLEST[1]
}

/// Width of the mark without its words, and its distance from the rim of the picture, pixels.
const BESIDE: f64 = 46.0;
const MARGIN: f64 = 10.0;

/// A displacement whose number is as wide as any that is usual, scene units.
const MOST_MOVED: f64 = 88_888.0;

/// Words of the mark: the largest displacement in the picture, in the longest form that fits.
/// * `moved`: largest displacement, scene units; `made`: what is drawn by rule.
pub fn words(width: usize, moved: f64, unit: Unit, made: Made) -> String {
    let most = self::moved(moved, unit);
    let room = width as f64 - 2.0 * MARGIN - BESIDE;
    let short = [format!("{WORDS}: moved by up to {most}"), format!("bent by up to {most}")];
    let long = made.words().map(|made| format!("{}; {made}", short[0]));
    long.into_iter()
        .chain(short)
        .find(|words| text_size(LETTERS_PX, words).width <= room)
        .unwrap_or_else(|| WORDS.to_owned())
}

/// Largest size of the mark in a picture of this width, pixels; its words are known when the picture is drawn.
pub fn room(width: usize, unit: Unit, made: Made) -> DVec2 {
    DVec2::new(BESIDE + text_size(LETTERS_PX, &words(width, MOST_MOVED, unit, made)).width, 24.0)
}

/// A displacement in words.
/// * `moved`: displacement, scene units.
pub fn moved(moved: f64, unit: Unit) -> String {
    match unit {
        Unit::Metre => length_above(moved),
        Unit::Angstrom => number_above(moved) + " angstrom",
        Unit::Voxel => number_above(moved) + " voxels",
    }
}

/// Draws the mark into the lower right corner: a ray that bends over a hill, and its words.
/// * `scale`: its size in multiples of the usual one.
pub fn draw(canvas: &mut Canvas<'_>, words: &str, scale: f64) {
    let size = canvas.size();
    let letters = scale * LETTERS_PX;
    let box_size = DVec2::new(scale * BESIDE + text_size(letters, words).width, scale * 24.0);
    let lo = size - box_size - scale * MARGIN;
    canvas.rect(lo, lo + box_size, scale * 5.0, PAPER);
    let at = |x: f64, y: f64| lo + scale * DVec2::new(8.0 + x, 4.0 + y);
    let hill: Vec<DVec2> = (0..=14)
        .map(|i| {
            let x = 4.0 + f64::from(i);
            at(x, 15.0 - 7.5 * (-((x - 11.0) / 3.4).powi(2)).exp())
        })
        .collect();
    canvas.line(&hill, scale * 1.4, Color::rgb(120, 128, 120));
    let ray: Vec<DVec2> = (0..=20)
        .map(|i| {
            let x = f64::from(i);
            at(x, 4.0 + 0.5 * (((x - 9.0) / 3.0).exp() + 1.0).ln() * 1.9)
        })
        .collect();
    canvas.line(&ray, scale * 1.8, Color::rgb(213, 94, 0));
    canvas.disc(ray[0], scale * 2.2, INK);
    canvas.text(lo + DVec2::new(scale * 36.0, 0.5 * box_size.y + 0.36 * letters), letters, words, INK, None);
}

/// Adds a strip with titles below pictures side by side: text and left edge of each. Narrow pictures are unchanged.
pub fn titled(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_says_how_far_in_the_longest_words_that_fit() {
        let said = |width, moved| words(width, moved, Unit::Metre, Made::Nothing);
        assert_eq!(said(1280, 341.2), "bent view: moved by up to 342 m");
        assert_eq!(said(1280, 0.0), "bent view: moved by up to 0 m");
        let made = |width| words(width, 341.2, Unit::Metre, Made::Materials);
        assert_eq!(made(1280), "bent view: moved by up to 342 m; forest and fine relief drawn by rule");
        let relief = words(1280, 341.2, Unit::Metre, Made::Relief);
        assert_eq!(relief, "bent view: moved by up to 342 m; fine relief drawn by rule");
        assert_eq!(made(320), "bent view: moved by up to 342 m");
        assert_eq!(said(200, 341.2), "bent by up to 342 m");
        assert_eq!(said(160, 12_345.6), "bent view");
        assert_eq!(words(1280, 3.04, Unit::Angstrom, Made::Nothing), "bent view: moved by up to 3.1 angstrom");
        assert_eq!(moved(0.004, Unit::Voxel), "0.1 voxels", "what moves is never said to rest");
        assert_eq!(moved(184.3, Unit::Angstrom), "185 angstrom");
        for width in [160, 200, 320, 640] {
            assert!(text_size(LETTERS_PX, &said(width, 99_999.0)).width + BESIDE + 2.0 * MARGIN <= width as f64);
        }
    }
}
