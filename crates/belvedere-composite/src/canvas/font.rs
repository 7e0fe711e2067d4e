//! The embedded font: which letters it has, and where the outlines of a text lie.

use ab_glyph_rasterizer::{Point, Rasterizer, point};
use harfrust::{FontRef, GlyphId, ShapeOptions, Shaper, ShaperData, UnicodeBuffer};
use skrifa::MetadataProvider;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use std::sync::LazyLock;

/// DejaVu Sans Condensed: Latin, Greek, Cyrillic; licence beside it.
const BYTES: &[u8] = include_bytes!("../../assets/DejaVuSansCondensed-subset.ttf");

struct Font {
    letters: FontRef<'static>,
    shaping: ShaperData,
    /// Units of the font per em.
    em: f32,
}

static FONT: LazyLock<Option<Font>> = LazyLock::new(|| {
    let letters = FontRef::new(BYTES).ok()?;
    let em = f32::from(letters.metrics(Size::unscaled(), LocationRef::default()).units_per_em);
    (em > 0.0).then(|| Font { shaping: ShaperData::new(&letters), letters, em })
});

/// Whether the font has a letter.
pub(super) fn has(letter: char) -> bool {
    let glyph = FONT.as_ref().and_then(|font| font.letters.charmap().map(letter));
    glyph.is_some_and(|glyph| glyph != GlyphId::NOTDEF)
}

/// The font file, for documents that embed it.
pub const FONT_FILE: &[u8] = BYTES;

/// A letter of a text that is set in one line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Letter {
    /// Number of the glyph in [`FONT_FILE`].
    pub glyph: u16,
    /// Place from the beginning of the text, right and up, em.
    pub at: [f64; 2],
    /// The glyph's own width, em.
    pub width: f64,
    /// Number of the first character that the glyph stands for, bytes from the beginning of the text.
    pub cluster: usize,
}

/// The letters of a text as they are set, see [`FONT_FILE`].
pub fn letters(text: &str) -> Vec<Letter> {
    let Some(font) = FONT.as_ref() else { return Vec::new() };
    let metrics = font.letters.glyph_metrics(Size::unscaled(), LocationRef::default());
    let line = set(text);
    let em = |v: f32| f64::from(v / font.em);
    let letter = |(glyph, [x, y], cluster): &(GlyphId, [f32; 2], u32)| Letter {
        glyph: glyph.to_u32() as u16,
        at: [em(*x), em(*y)],
        width: metrics.advance_width(*glyph).map_or(0.0, em),
        cluster: *cluster as usize,
    };
    line.glyphs.iter().map(letter).collect()
}

/// A text set in one line: its letters and where each begins, in units of the font.
pub(super) struct Line {
    glyphs: Vec<(GlyphId, [f32; 2], u32)>,
    width: f32,
}

/// Sets `text` from the origin on.
pub(super) fn set(text: &str) -> Line {
    let mut line = Line { glyphs: Vec::new(), width: 0.0 };
    let Some(font) = FONT.as_ref() else { return line };
    let shaper: Shaper<'_> = font.shaping.shaper(&font.letters).build();
    let mut buffer = UnicodeBuffer::new();
    buffer.push_str(text);
    buffer.guess_segment_properties();
    let set = shaper.shape(buffer, ShapeOptions::new());
    for (glyph, place) in set.glyph_infos().iter().zip(set.glyph_positions()) {
        let at = [line.width + place.x_offset as f32, place.y_offset as f32];
        line.glyphs.push((GlyphId::new(glyph.glyph_id), at, glyph.cluster));
        line.width += place.x_advance as f32;
    }
    line
}

/// Coverage of pixels by letters.
pub(super) struct Ink {
    /// Column and row of the first pixel.
    pub(super) at: [i64; 2],
    /// Width and height, pixels.
    pub(super) size: [usize; 2],
    /// 0..=1, row-major.
    pub(super) coverage: Vec<f32>,
}

impl Line {
    /// Width with letters of `size_px` per em, pixels.
    pub(super) fn width(&self, size_px: f32) -> f64 {
        FONT.as_ref().map_or(0.0, |font| f64::from(self.width * size_px / font.em))
    }

    /// The letters as pixels, the line beginning at `origin`; `None` without ink between two rows.
    pub(super) fn ink(&self, size_px: f32, origin: [f32; 2], rows: [f64; 2]) -> Option<Ink> {
        let font = FONT.as_ref()?;
        let scale = size_px / font.em;
        let mut pen = Pen::default();
        let outlines = font.letters.outline_glyphs();
        for (glyph, [x, y], _) in &self.glyphs {
            pen.origin = [origin[0] + x * scale, origin[1] - y * scale];
            let settings = DrawSettings::unhinted(Size::new(size_px), LocationRef::default());
            // A letter without an outline, or with a damaged one, is left out.
            if let Some(outline) = outlines.get(*glyph) {
                let _ = outline.draw(settings, &mut pen);
            }
        }
        pen.ink(rows)
    }
}

/// A piece of an outline.
enum Piece {
    Line([Point; 2]),
    Quadratic([Point; 3]),
    Cubic([Point; 4]),
}

/// Collects outlines in pixels, y down.
#[derive(Default)]
struct Pen {
    origin: [f32; 2],
    start: Point,
    last: Point,
    pieces: Vec<Piece>,
}

impl Pen {
    fn place(&self, x: f32, y: f32) -> Point {
        point(self.origin[0] + x, self.origin[1] - y)
    }

    fn ink(&self, [top, bottom]: [f64; 2]) -> Option<Ink> {
        let corners = self.pieces.iter().flat_map(|piece| match piece {
            Piece::Line(p) => p.as_slice(),
            Piece::Quadratic(p) => p.as_slice(),
            Piece::Cubic(p) => p.as_slice(),
        });
        let (mut lo, mut hi) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for p in corners {
            (lo, hi) = ([lo[0].min(p.x), lo[1].min(p.y)], [hi[0].max(p.x), hi[1].max(p.y)]);
        }
        let at = lo.map(|v| v.floor());
        let size = [0, 1].map(|i| (hi[i].ceil() - at[i]) as usize);
        let is_apart = f64::from(hi[1]) < top - 1.0 || f64::from(lo[1]) > bottom + 1.0;
        if !at.iter().all(|v| v.is_finite()) || size.contains(&0) || is_apart {
            return None;
        }
        let moved = |p: &Point| point(p.x - at[0], p.y - at[1]);
        let mut raster = Rasterizer::new(size[0], size[1]);
        for piece in &self.pieces {
            match piece {
                Piece::Line([a, b]) => raster.draw_line(moved(a), moved(b)),
                Piece::Quadratic([a, b, c]) => raster.draw_quad(moved(a), moved(b), moved(c)),
                Piece::Cubic([a, b, c, d]) => raster.draw_cubic(moved(a), moved(b), moved(c), moved(d)),
            }
        }
        let mut coverage = vec![0.0f32; size[0] * size[1]];
        raster.for_each_pixel(|i, c| coverage[i] = c.clamp(0.0, 1.0));
        Some(Ink { at: at.map(|v| v as i64), size, coverage })
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.start = self.place(x, y);
        self.last = self.start;
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.place(x, y);
        self.pieces.push(Piece::Line([self.last, to]));
        self.last = to;
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let (by, to) = (self.place(cx, cy), self.place(x, y));
        self.pieces.push(Piece::Quadratic([self.last, by, to]));
        self.last = to;
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let (a, b, to) = (self.place(ax, ay), self.place(bx, by), self.place(x, y));
        self.pieces.push(Piece::Cubic([self.last, a, b, to]));
        self.last = to;
    }

    fn close(&mut self) {
        self.pieces.push(Piece::Line([self.last, self.start]));
        self.last = self.start;
    }
}
