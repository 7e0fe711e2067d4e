//! Letters: outlines of the embedded font, set from left to right.

use crate::canvas::Canvas;
use ab_glyph::{Font, FontRef, Glyph, GlyphId, PxScale, ScaleFont, point};
use belvedere_core::DVec2;
use belvedere_scene::Color;
use std::sync::LazyLock;

/// DejaVu Sans Condensed: Latin, Greek, Cyrillic; licence beside it.
pub const FONT_BYTES: &[u8] = include_bytes!("../../assets/DejaVuSansCondensed-subset.ttf");

static FONT: LazyLock<Option<FontRef<'static>>> = LazyLock::new(|| FontRef::try_from_slice(FONT_BYTES).ok());

/// Longest text that is set, characters; longer ones end in an ellipsis.
const MAX_CHARS: usize = 80;

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
    let plain = |c: char| c.is_control() || c.is_whitespace();
    let none = GlyphId::default();
    FONT.as_ref().is_some_and(|font| text.chars().filter(|c| !plain(*c)).all(|c| font.glyph_id(c) != none))
}

/// Size of `text` with letters of `size_px`, pixels.
pub fn text_size(size_px: f64, text: &str) -> TextSize {
    let Some(font) = FONT.as_ref() else { return TextSize { width: 0.0, ascent: 0.0, descent: 0.0 } };
    let (_, width) = set(font, size_px, text);
    TextSize { width, ascent: 0.76 * size_px, descent: 0.24 * size_px }
}

/// Pixels per em as the library counts them: its scale is the height from ascent to descent.
fn scale(font: &FontRef<'_>, size_px: f64) -> PxScale {
    let em = font.units_per_em().unwrap_or(1000.0);
    PxScale::from((size_px.clamp(1.0, 400.0) as f32) * font.height_unscaled() / em)
}

/// Glyphs placed from the origin on, and their width.
fn set(font: &FontRef<'_>, size_px: f64, text: &str) -> (Vec<Glyph>, f64) {
    let scale = scale(font, size_px);
    let scaled = font.as_scaled(scale);
    let (mut glyphs, mut x, mut last) = (Vec::new(), 0.0f32, None::<GlyphId>);
    let long = text.chars().count() > MAX_CHARS;
    let shown = text.chars().take(MAX_CHARS - usize::from(long)).chain(long.then_some('…'));
    for c in shown.filter(|c| !c.is_control()) {
        let id = font.glyph_id(c);
        x += last.map_or(0.0, |l| scaled.kern(l, id));
        glyphs.push(id.with_scale_and_position(scale, point(x, 0.0)));
        x += scaled.h_advance(id);
        last = Some(id);
    }
    (glyphs, f64::from(x))
}

pub(super) fn draw(
    canvas: &mut Canvas<'_>,
    at: DVec2,
    size_px: f64,
    text: &str,
    color: Color,
    halo: Option<(Color, f64)>,
) {
    let Some(font) = FONT.as_ref() else { return };
    if !at.is_finite() {
        return;
    }
    let (glyphs, width) = set(font, size_px, text);
    let rim = halo.map_or(0.0, |(_, w)| w);
    let pad = rim.ceil() as i64 + 2;
    let size = size_px.clamp(1.0, 400.0);
    // The mask begins at a whole pixel; the letters keep their subpixel position.
    let corner = DVec2::new(at.x.floor(), (at.y - size * 1.1).floor()) - pad as f64;
    let (w, h) = ((width.ceil() as usize + 2 * pad as usize + 2), ((1.5 * size).ceil() as usize + 2 * pad as usize));
    let mut mask = vec![0.0f32; w * h];
    for mut glyph in glyphs {
        glyph.position.x += (at.x - corner.x) as f32;
        glyph.position.y += (at.y - corner.y) as f32;
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let bounds = outline.px_bounds();
        let (x0, y0) = (bounds.min.x as i64, bounds.min.y as i64);
        outline.draw(|x, y, c| {
            let (x, y) = (x0 + i64::from(x), y0 + i64::from(y));
            if x >= 0 && y >= 0 && (x as usize) < w && (y as usize) < h {
                let m = &mut mask[y as usize * w + x as usize];
                *m = (*m + c).min(1.0);
            }
        });
    }
    let (x0, y0) = (corner.x as i64, corner.y as i64);
    let mut paint = |mask: &[f32], color: Color| {
        for (i, &c) in mask.iter().enumerate().filter(|(_, c)| **c > 0.0) {
            canvas.blend(x0 + (i % w) as i64, y0 + (i / w) as i64, color, c);
        }
    };
    if let Some((rim_color, _)) = halo.filter(|_| rim > 0.0) {
        paint(&grown(&mask, w, h, rim), rim_color);
    }
    paint(&mask, color);
}

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
                *m = m.max(c * b);
            }
        }
    }
    out
}
