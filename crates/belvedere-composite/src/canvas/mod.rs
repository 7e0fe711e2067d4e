//! Drawing over a finished picture: rectangles, lines and letters, anti-aliased.

mod bidi;
mod font;
mod ink;
mod line;
mod polygon;
mod shape;
mod text;

pub use font::{FONT_FILE, Fonts, fonts_in};
pub use ink::Turn;
pub(crate) use ink::along;
pub use line::{Letter, OutlinePiece};
pub use shape::CanvasShape;
pub use text::{TextSize, can_set, text_size};

use belvedere_core::{DVec2, polygon::to_segment};
use belvedere_scene::Color;

/// A finished picture to draw on. Coordinates are pixels, (0, 0) the outer corner of the top-left one; drawing outside the picture is clipped.
///
/// ```
/// use belvedere_core::DVec2;
/// use belvedere_composite::canvas::Canvas;
/// use belvedere_scene::Color;
/// let mut pixels = vec![[255u8; 3]; 60 * 20];
/// let mut canvas = Canvas::new(&mut pixels, 60);
/// canvas.text(DVec2::new(2.0, 15.0), 13.0, "bent", Color::rgb(0, 0, 0), None);
/// assert!(pixels.iter().any(|p| p[0] < 64));
/// ```
#[derive(Debug)]
pub struct Canvas<'a> {
    pixels: &'a mut [[u8; 3]],
    width: usize,
    /// Height of the picture; its rows from `first` on are drawn on.
    height: usize,
    first: usize,
    /// Pixels per unit of all lengths and positions.
    scale: f64,
    /// What is recorded instead of drawn.
    record: Option<&'a mut Vec<CanvasShape>>,
    /// Fonts of its texts.
    fonts: Fonts,
}

impl<'a> Canvas<'a> {
    /// A picture of `width` columns, row-major, row 0 on top.
    pub fn new(pixels: &'a mut [[u8; 3]], width: usize) -> Self {
        let height = pixels.len().checked_div(width).unwrap_or(0);
        Self { pixels, width, height, first: 0, scale: 1.0, record: None, fonts: Fonts::default() }
    }

    /// Some rows of a picture of this size, pixels, from row `first` on: drawing in the other rows is left out.
    pub fn rows(pixels: &'a mut [[u8; 3]], [width, height]: [usize; 2], first: usize) -> Self {
        Self { pixels, width, height, first, scale: 1.0, record: None, fonts: Fonts::default() }
    }

    /// First and last but one of the rows that are drawn on, pixels.
    fn drawn_rows(&self) -> [f64; 2] {
        let rows = self.pixels.len().checked_div(self.width).unwrap_or(0);
        [self.first, (self.first + rows).min(self.height)].map(|row| row as f64)
    }

    /// A picture of this size, pixels, that records shapes and draws nothing; [`Canvas::blend`] is left out.
    pub fn recording(shapes: &'a mut Vec<CanvasShape>, [width, height]: [usize; 2]) -> Self {
        Self { pixels: &mut [], width, height, first: 0, scale: 1.0, record: Some(shapes), fonts: Fonts::default() }
    }

    /// Records a shape; whether that is all there is to do.
    fn records(&mut self, shape: impl FnOnce() -> CanvasShape) -> bool {
        if let Some(record) = &mut self.record {
            record.push(shape());
        }
        self.record.is_some()
    }

    /// The same picture with lengths and positions in units of `scale` pixels, more than 0; but [`Canvas::blend`] counts pixels.
    pub fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Texts are written in these fonts from now on, instead of the embedded one alone.
    pub fn in_fonts(&mut self, fonts: &Fonts) -> &mut Self {
        self.fonts = fonts.clone();
        self
    }

    /// Width and height, pixels, or units if it is scaled.
    pub fn size(&self) -> DVec2 {
        self.extent() / self.scale
    }

    /// Width and height, pixels.
    fn extent(&self) -> DVec2 {
        DVec2::new(self.width as f64, self.height as f64)
    }

    /// Blends `color` over a pixel; `coverage` in 0..=1 scales its opacity. sRGB values are mixed, as SVG and PDF viewers do: in linear
    /// light small dark letters would be pale.
    pub fn blend(&mut self, x: i64, y: i64, color: Color, coverage: f32) {
        let row = y - self.first as i64;
        if self.record.is_some() || x < 0 || row < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return;
        }
        let alpha = coverage.clamp(0.0, 1.0) * f32::from(color.a) / 255.0;
        if !(alpha > 0.0) {
            return;
        }
        let Some(pixel) = self.pixels.get_mut(row as usize * self.width + x as usize) else { return };
        let over = [color.r, color.g, color.b];
        *pixel = std::array::from_fn(|c| {
            let (under, over) = (f32::from(pixel[c]), f32::from(over[c]));
            (under + (over - under) * alpha + 0.5) as u8
        });
    }

    /// Fills a shape given by its signed distance, negative inside, within the box `lo..hi`.
    fn shape(&mut self, lo: DVec2, hi: DVec2, color: Color, distance: impl Fn(DVec2) -> f64) {
        let size = self.extent();
        let (lo, hi) = ((lo - 1.0).floor().clamp(DVec2::ZERO, size), (hi + 1.0).ceil().clamp(DVec2::ZERO, size));
        let [top, bottom] = self.drawn_rows();
        for y in lo.y.max(top) as i64..hi.y.min(bottom) as i64 {
            for x in lo.x as i64..hi.x as i64 {
                let d = distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
                self.blend(x, y, color, (0.5 - d) as f32);
            }
        }
    }

    /// Fills the rectangle between two corners, with corners rounded by `radius`.
    pub fn rect(&mut self, lo: DVec2, hi: DVec2, radius: f64, color: Color) {
        let [lo, hi] = [lo, hi].map(|p| p * self.scale);
        let radius = radius * self.scale;
        if self.records(|| CanvasShape::Rect { corners: [lo, hi], radius, color }) {
            return;
        }
        let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo) - radius);
        self.shape(lo, hi, color, |p| {
            let q = (p - middle).abs() - half;
            q.max(DVec2::ZERO).length() + q.max_element().min(0.0) - radius
        });
    }

    /// Draws a polyline with round ends and joints, `width` pixels wide.
    pub fn line(&mut self, points: &[DVec2], width: f64, color: Color) {
        let points: Vec<DVec2> = points.iter().map(|p| *p * self.scale).collect();
        let Some(&first) = points.first() else { return };
        let (lo, hi) = points.iter().fold((first, first), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        let half = 0.5 * width * self.scale;
        if self.records(|| CanvasShape::Line { points: points.clone(), width: 2.0 * half, color }) {
            return;
        }
        self.shape(lo - half, hi + half, color, |p| {
            let nearest = points.windows(2).map(|w| to_segment(p, w[0], w[1]).length());
            nearest.fold(p.distance(first), f64::min) - half
        });
    }

    /// Fills a disc.
    pub fn disc(&mut self, at: DVec2, radius: f64, color: Color) {
        let (at, radius) = (at * self.scale, radius * self.scale);
        if self.records(|| CanvasShape::Disc { at, radius, color }) {
            return;
        }
        self.shape(at - radius, at + radius, color, |p| p.distance(at) - radius);
    }

    /// Writes a line of text: `at` is the left end of its baseline, `size_px` the height of the letters' em square; `halo` a rim and its width.
    pub fn text(&mut self, at: DVec2, size_px: f64, text: &str, color: Color, halo: Option<(Color, f64)>) {
        self.write(at, &[], (size_px, text), (color, halo));
    }

    /// Writes a line of text along a curved baseline from its first point on, the letters turned with it; as [`Canvas::text`].
    pub fn text_along(&mut self, line: &[DVec2], size_px: f64, text: &str, color: Color, halo: Option<(Color, f64)>) {
        let Some(first) = line.first() else { return };
        self.write(*first, line, (size_px, text), (color, halo));
    }

    fn write(
        &mut self,
        at: DVec2,
        along: &[DVec2],
        (size_px, text): (f64, &str),
        (color, halo): (Color, Option<(Color, f64)>),
    ) {
        let (at, size_px) = (at * self.scale, size_px * self.scale);
        let along: Vec<DVec2> = along.iter().map(|p| *p * self.scale).collect();
        let halo = halo.map(|(color, width)| (color, width * self.scale));
        let fonts = self.fonts.clone();
        let recorded = || CanvasShape::Text {
            at,
            size: text::drawn_size(size_px),
            text: text::shown(text),
            width: fonts.text_size(size_px, text).width,
            along: along.clone(),
            fonts,
            color,
            halo,
        };
        if !self.records(recorded) {
            text::draw(self, &text::Writing { text, at, along: &along, size_px, color, halo });
        }
    }
}

#[cfg(test)]
mod tests;
