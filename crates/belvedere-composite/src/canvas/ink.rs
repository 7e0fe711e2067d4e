//! Outlines of a line of letters as coverage of pixels.

use super::line::Line;
use ab_glyph_rasterizer::{Point, Rasterizer, point};
use belvedere_core::DVec2;
use skrifa::outline::OutlinePen;

/// Largest side of a mask of letters, pixels.
const MOST_SIDE: f32 = 40_000.0;

/// Coverage of pixels by letters.
pub(super) struct Ink {
    /// Column and row of the first pixel.
    pub(super) at: [i64; 2],
    /// Width and height, pixels.
    pub(super) size: [usize; 2],
    /// 0..=1, row-major.
    pub(super) coverage: Vec<f32>,
}

impl Line<'_> {
    /// Width with letters of `size_px` per em, pixels.
    pub(super) fn width_px(&self, size_px: f32) -> f64 {
        f64::from(self.width * size_px)
    }

    /// The letters as pixels, the line beginning at `origin`; `None` without ink between two rows.
    pub(super) fn ink(&self, size_px: f32, origin: [f32; 2], rows: [f64; 2]) -> Option<Ink> {
        let mut pen = Pen::default();
        for glyph in &self.glyphs {
            let Some(face) = self.fonts.0.get(glyph.font) else { continue };
            pen.origin = [origin[0] + glyph.at[0] * size_px, origin[1] - glyph.at[1] * size_px];
            face.draw(glyph.id, size_px, &mut pen);
        }
        pen.ink(rows)
    }

    /// The letters along a baseline from its beginning on, each turned with it; `None` without ink between two rows.
    pub(super) fn ink_along(&self, size_px: f32, baseline: &[DVec2], rows: [f64; 2]) -> Option<Ink> {
        let mut pen = Pen::default();
        for (glyph, turn) in self.glyphs.iter().zip(self.turned(f64::from(size_px), baseline)) {
            let Some(face) = self.fonts.0.get(glyph.font) else { continue };
            pen.origin = turn.at.as_vec2().to_array();
            pen.turn = turn.direction.as_vec2().to_array();
            face.draw(glyph.id, size_px, &mut pen);
        }
        pen.ink(rows)
    }

    /// Origin and direction of every glyph along a baseline in pixels, y down.
    pub(super) fn turned(&self, size_px: f64, baseline: &[DVec2]) -> Vec<Turn> {
        let glyph = |glyph: &super::line::Placed| {
            let half = 0.5 * f64::from(glyph.advance) * size_px;
            let middle = f64::from(glyph.at[0]) * size_px + half;
            let (at, direction) = along(baseline, middle);
            let up = DVec2::new(direction.y, -direction.x);
            Turn { at: at - half * direction + f64::from(glyph.at[1]) * size_px * up, direction }
        };
        self.glyphs.iter().map(glyph).collect()
    }
}

/// Where a glyph begins on a curved baseline, and its direction there, of length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Left end of the glyph's own baseline, pixels.
    pub at: DVec2,
    /// Direction to the right of the glyph.
    pub direction: DVec2,
}

/// Place and direction at a length along a polyline; beyond its ends it goes on straight.
pub(crate) fn along(line: &[DVec2], length: f64) -> (DVec2, DVec2) {
    let mut left = length;
    let mut last = (line.first().copied().unwrap_or_default(), DVec2::X);
    for pair in line.windows(2) {
        let step = pair[1] - pair[0];
        let long = step.length();
        if !(long > 1e-9) {
            continue;
        }
        let direction = step / long;
        if left <= long {
            return (pair[0] + left * direction, direction);
        }
        left -= long;
        last = (pair[1], direction);
    }
    (last.0 + left * last.1, last.1)
}

/// A piece of an outline.
enum Piece {
    Line([Point; 2]),
    Quadratic([Point; 3]),
    Cubic([Point; 4]),
}

/// Collects outlines in pixels, y down.
struct Pen {
    origin: [f32; 2],
    /// Direction to the right of letters.
    turn: [f32; 2],
    start: Point,
    last: Point,
    pieces: Vec<Piece>,
}

impl Default for Pen {
    fn default() -> Self {
        let none = Point::default();
        Self { origin: [0.0; 2], turn: [1.0, 0.0], start: none, last: none, pieces: Vec::new() }
    }
}

impl Pen {
    fn place(&self, x: f32, y: f32) -> Point {
        let [cos, sin] = self.turn;
        point(self.origin[0] + cos * x + sin * y, self.origin[1] + sin * x - cos * y)
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
        let sides = [0, 1].map(|i| hi[i].ceil() - at[i]);
        let size = sides.map(|side| side as usize);
        if f64::from(hi[1]) < top - 1.0 || f64::from(lo[1]) > bottom + 1.0 {
            return None;
        }
        if !at.iter().all(|v| v.is_finite()) || size.contains(&0) || sides.iter().any(|side| !(*side <= MOST_SIDE)) {
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
