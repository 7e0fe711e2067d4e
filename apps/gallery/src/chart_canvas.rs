//! Charts are drawn with the lines and letters of pictures.

use belvedere::composite::canvas::{Canvas, text_size};
use belvedere::core::DVec2;
use belvedere::scene::Color;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind};
use std::convert::Infallible;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// Size of letters per em, as a share of the height of a line.
const EM: f64 = 0.86;

/// Pixels that charts are drawn on.
pub(crate) struct ChartCanvas<'p> {
    canvas: Canvas<'p>,
}

impl<'p> ChartCanvas<'p> {
    /// A white picture of `width` columns, row-major.
    pub(crate) fn new(pixels: &'p mut [[u8; 3]], width: usize) -> Self {
        pixels.fill([255; 3]);
        Self { canvas: Canvas::new(pixels, width) }
    }
}

fn color_of(BackendColor { alpha, rgb: (r, g, b) }: BackendColor) -> (Color, f32) {
    (Color::rgb(r, g, b), alpha as f32)
}

fn corner_of((x, y): BackendCoord) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(y))
}

impl DrawingBackend for ChartCanvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        let size = self.canvas.size();
        (size.x as u32, size.y as u32)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        let (color, coverage) = color_of(color);
        self.canvas.blend(i64::from(x), i64::from(y), color, coverage);
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        let points: Vec<DVec2> = path.into_iter().map(|p| corner_of(p) + 0.5).collect();
        let (color, coverage) = color_of(style.color());
        let color = Color { a: (255.0 * coverage).round() as u8, ..color };
        self.canvas.line(&points, f64::from(style.stroke_width()), color);
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, at: BackendCoord) -> Drawn {
        let (color, coverage) = color_of(style.color());
        let size = EM * style.size();
        let set = text_size(size, text);
        let (width, height) = (set.width.ceil() as usize + 1, (set.ascent + set.descent).ceil() as usize + 1);
        // Black on white, so that the letters can be turned.
        let mut letters = vec![[255u8; 3]; width * height];
        Canvas::new(&mut letters, width).text(DVec2::new(0.0, set.ascent), size, text, Color::rgb(0, 0, 0), None);
        let left = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Right => width,
            HPos::Center => width / 2,
        };
        let top = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => height / 2,
            VPos::Bottom => height,
        };
        let transform = style.transform();
        for (i, [value, ..]) in letters.iter().enumerate().filter(|(_, p)| p[0] < 255) {
            let (x, y) = ((i % width) as i32 - left as i32, (i / width) as i32 - top as i32);
            let (x, y) = transform.transform(x, y);
            self.canvas.blend(i64::from(at.0 + x), i64::from(at.1 + y), color, inked(*value) * coverage);
        }
        Ok(())
    }

    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let set = text_size(EM * style.size(), text);
        Ok((set.width.ceil() as u32, (set.ascent + set.descent).ceil() as u32))
    }
}

/// Coverage of a pixel in which black letters were drawn on white.
fn inked(value: u8) -> f32 {
    1.0 - f32::from(value) / 255.0
}
