//! Pictures of one size in rows, each with a caption of two lines below it.

use anyhow::Result;
use belvedere::composite::canvas::Canvas;
use belvedere::core::DVec2;
use belvedere::io::png::{self, Channels};
use belvedere::scene::{Color, Frame};
use std::path::Path;

/// Distance between pictures, pixels.
const GAP: usize = 10;
/// Height of a caption, pixels.
const CAPTION: usize = 48;
const INK: Color = Color::rgb(38, 44, 54);
const GREY: Color = Color::rgb(96, 102, 112);

/// Width, height, and pixels row by row.
pub(crate) type Pixels = (usize, usize, Vec<[u8; 3]>);

/// A picture of a sheet.
pub(crate) struct Panel {
    pub(crate) title: String,
    /// Second line of the caption.
    pub(crate) note: String,
    pub(crate) frame: Frame,
}

/// Writes a picture as PNG with `comment` stored in the file.
pub(crate) fn write(path: &Path, (width, height, pixels): Pixels, comment: &str, overwrite: bool) -> Result<()> {
    let program = format!("belvedere {}", belvedere::VERSION);
    let text = [("Software", program.as_str()), ("Comment", comment)];
    Ok(png::write(path, overwrite, width, height, Channels::Rgb, pixels.as_flattened(), &text)?)
}

/// Arranges panels in rows of `columns`.
pub(crate) fn sheet(panels: &[Panel], columns: usize) -> Pixels {
    let Some(first) = panels.first() else { return (0, 0, Vec::new()) };
    let (w, h) = (first.frame.width, first.frame.height);
    let columns = columns.clamp(1, panels.len());
    let rows = panels.len().div_ceil(columns);
    let (width, height) = (columns * (w + GAP) - GAP, rows * (h + CAPTION));
    let mut pixels = vec![[255u8; 3]; width * height];
    for (i, panel) in panels.iter().enumerate() {
        let (left, top) = ((i % columns) * (w + GAP), (i / columns) * (h + CAPTION));
        for (y, row) in panel.frame.color.chunks_exact(panel.frame.width.max(1)).take(h).enumerate() {
            let at = (top + y) * width + left;
            let n = row.len().min(w);
            pixels[at..at + n].copy_from_slice(&row[..n]);
        }
        let mut canvas = Canvas::new(&mut pixels, width);
        let at = |y: usize| DVec2::new(left as f64 + 4.0, (top + h + y) as f64);
        canvas.text(at(18), 15.0, &panel.title, INK, None);
        canvas.text(at(37), 13.0, &panel.note, GREY, None);
    }
    (width, height, pixels)
}
