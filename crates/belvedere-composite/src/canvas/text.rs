//! Texts of one line over a picture.

use super::font::Fonts;
use super::ink::Ink;
use crate::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::Color;

/// Longest text that is set, characters; longer ones end in an ellipsis.
const MAX_CHARS: usize = 80;

/// Largest letters, pixels per em: those of 400 pixels of a scene at 2400 pixels per inch.
const MOST_PX: f64 = 10_000.0;

/// Size of a line of text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextSize {
    /// Width, pixels.
    pub width: f64,
    /// Above the baseline, pixels.
    pub ascent: f64,
    /// Below the baseline, pixels, > 0.
    pub descent: f64,
}

/// Whether the embedded font has all letters of a text.
pub fn can_set(text: &str) -> bool {
    Fonts::default().can_set(text)
}

/// Size of `text` with letters of `size_px` of the embedded font, pixels.
pub fn text_size(size_px: f64, text: &str) -> TextSize {
    Fonts::default().text_size(size_px, text)
}

impl Fonts {
    /// Size of `text` with letters of `size_px`, pixels.
    pub fn text_size(&self, size_px: f64, text: &str) -> TextSize {
        let width = self.set(&shown(text)).width_px(drawn_size(size_px) as f32);
        TextSize { width, ascent: 0.76 * size_px, descent: 0.24 * size_px }
    }

    /// Where the letters of a text lie on a curved baseline, in the order of [`Fonts::letters`].
    pub fn turned(&self, size_px: f64, text: &str, baseline: &[DVec2]) -> Vec<super::Turn> {
        self.set(text).turned(size_px, baseline)
    }
}

/// Sizes of letters that are drawn, pixels per em.
pub(super) fn drawn_size(size_px: f64) -> f64 {
    size_px.clamp(1.0, MOST_PX)
}

/// The text as it is set: without control characters, and not too long.
pub(super) fn shown(text: &str) -> String {
    let long = text.chars().count() > MAX_CHARS;
    let shown = text.chars().take(MAX_CHARS - usize::from(long)).chain(long.then_some('…'));
    shown.filter(|c| !c.is_control()).collect()
}

/// A text, where it begins, and how it is painted.
pub(super) struct Writing<'a> {
    pub(super) text: &'a str,
    pub(super) at: DVec2,
    /// The baseline of a curved text, else empty.
    pub(super) along: &'a [DVec2],
    pub(super) size_px: f64,
    pub(super) color: Color,
    pub(super) halo: Option<(Color, f64)>,
}

pub(super) fn draw(canvas: &mut Canvas<'_>, writing: &Writing<'_>) {
    let [w, h] = canvas.extent().to_array();
    let far = 1e6 + w.max(h);
    let near = |p: &DVec2| p.abs().max_element() < far;
    if !near(&writing.at) || !writing.along.iter().all(near) {
        return;
    }
    // The letters keep their subpixel position.
    let whole = writing.at.floor();
    let size = drawn_size(writing.size_px) as f32;
    let fonts = canvas.fonts.clone();
    let line = fonts.set(&shown(writing.text));
    let pad = rim(writing).ceil() + 1.0;
    let [top, bottom] = canvas.drawn_rows();
    let rows = [top - whole.y - pad, bottom - whole.y + pad];
    let ink = match writing.along {
        [] => line.ink(size, (writing.at - whole).as_vec2().to_array(), rows),
        baseline => line.ink_along(size, &baseline.iter().map(|p| *p - whole).collect::<Vec<_>>(), rows),
    };
    if let Some(ink) = ink {
        paint(canvas, &ink, [whole.x as i64, whole.y as i64], writing);
    }
}

/// Width of the rim around letters, pixels.
fn rim(writing: &Writing<'_>) -> f64 {
    writing.halo.map_or(0.0, |(_, width)| width)
}

fn paint(canvas: &mut Canvas<'_>, ink: &Ink, whole: [i64; 2], writing: &Writing<'_>) {
    let rim = rim(writing);
    let pad = rim.ceil() as i64 + 1;
    let (w, h) = (ink.size[0] + 2 * pad as usize, ink.size[1] + 2 * pad as usize);
    let mut mask = vec![0.0f32; w * h];
    for (y, row) in ink.coverage.chunks_exact(ink.size[0]).enumerate() {
        let start = (y + pad as usize) * w + pad as usize;
        mask[start..start + row.len()].copy_from_slice(row);
    }
    let (x0, y0) = (whole[0] + ink.at[0] - pad, whole[1] + ink.at[1] - pad);
    let mut paint = |mask: &[f32], color: Color| {
        for (i, &c) in mask.iter().enumerate().filter(|(_, c)| **c > 0.0) {
            canvas.blend(x0 + (i % w) as i64, y0 + (i / w) as i64, color, c);
        }
    };
    if let Some((rim_color, _)) = writing.halo.filter(|_| rim > 0.0) {
        paint(&grown(&mask, w, h, rim), rim_color);
    }
    paint(&mask, writing.color);
}

/// Coverage from which on a letter has its whole rim: thin strokes cover no pixel whole.
const WHOLE: f32 = 0.4;

/// The mask widened by a soft disc of radius `rim`.
fn grown(mask: &[f32], w: usize, h: usize, rim: f64) -> Vec<f32> {
    let reach = rim.ceil() as i64;
    let brush: Vec<(i64, i64, f32)> = (-reach..=reach)
        .flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)))
        .map(|(dx, dy)| (dx, dy, (rim + 0.5 - ((dx * dx + dy * dy) as f64).sqrt()).clamp(0.0, 1.0) as f32))
        .filter(|(_, _, c)| *c > 0.0)
        .collect();
    let mut out = vec![0.0f32; mask.len()];
    for (i, &c) in mask.iter().enumerate().filter(|(_, c)| **c > 0.0) {
        let (x, y) = ((i % w) as i64, (i / w) as i64);
        for &(dx, dy, b) in &brush {
            let (x, y) = (x + dx, y + dy);
            if x >= 0 && y >= 0 && x < w as i64 && y < h as i64 {
                let m = &mut out[y as usize * w + x as usize];
                *m = m.max((c / WHOLE).min(1.0) * b);
            }
        }
    }
    out
}
