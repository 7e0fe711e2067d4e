//! Pictures of one size in rows, each with a title and a note below it, in lines as wide as the picture.

use anyhow::Result;
use belvedere::composite::canvas::{Canvas, text_size};
use belvedere::core::DVec2;
use belvedere::io::png::{self, Channels};
use belvedere::scene::{Color, Frame};
use std::path::Path;

/// Distance between pictures, pixels.
const GAP: usize = 10;
/// Sizes of the letters of titles and notes, distances of their lines, and room beside and below them, pixels.
const TITLE: f64 = 15.0;
const NOTE: f64 = 13.0;
const LINES: [usize; 2] = [19, 17];
const BESIDE: f64 = 4.0;
const BELOW: usize = 12;
const INK: Color = Color::rgb(38, 44, 54);
const GREY: Color = Color::rgb(96, 102, 112);

/// Width, height, and pixels row by row.
pub(crate) type Pixels = (usize, usize, Vec<[u8; 3]>);

/// A picture of a sheet.
pub(crate) struct Panel {
    pub(crate) title: String,
    /// Text under the title.
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
    let captions: Vec<Caption> = panels.iter().map(|panel| Caption::new(panel, w as f64)).collect();
    let caption = captions.iter().map(Caption::height).max().unwrap_or(0);
    let (width, height) = (columns * (w + GAP) - GAP, rows * (h + caption));
    let mut pixels = vec![[255u8; 3]; width * height];
    for (i, (panel, lines)) in panels.iter().zip(&captions).enumerate() {
        let (left, top) = ((i % columns) * (w + GAP), (i / columns) * (h + caption));
        for (y, row) in panel.frame.color.chunks_exact(panel.frame.width.max(1)).take(h).enumerate() {
            let at = (top + y) * width + left;
            let n = row.len().min(w);
            pixels[at..at + n].copy_from_slice(&row[..n]);
        }
        let mut canvas = Canvas::new(&mut pixels, width);
        lines.draw(&mut canvas, DVec2::new(left as f64 + BESIDE, (top + h) as f64));
    }
    (width, height, pixels)
}

/// Lines of a caption.
struct Caption([Vec<String>; 2]);

impl Caption {
    /// * `width`: of the picture, pixels.
    fn new(panel: &Panel, width: f64) -> Self {
        let room = width - 2.0 * BESIDE;
        Self([broken(&panel.title, TITLE, room), broken(&panel.note, NOTE, room)])
    }

    fn height(&self) -> usize {
        let [title, note] = &self.0;
        title.len() * LINES[0] + note.len() * LINES[1] + BELOW
    }

    fn draw(&self, canvas: &mut Canvas<'_>, at: DVec2) {
        let mut y = 0;
        let kinds = [(TITLE, LINES[0], INK), (NOTE, LINES[1], GREY)];
        for (lines, (size, step, color)) in self.0.iter().zip(kinds) {
            for line in lines {
                y += step;
                canvas.text(at + DVec2::new(0.0, y as f64), size, line, color, None);
            }
        }
    }
}

/// A text in lines of whole words, each as wide as `room` at most; a word that is wider stands by itself.
fn broken(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_size(size, &format!("{line} {word}")).width <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_keep_to_their_pictures_at_every_scale() {
        let title = "Forward, then to the right";
        let note = "second viewpoint 104 angstrom to the right, 56 up; 83 % of the left and 83 % of the right rays reach theirs";
        for width in [130usize, 224, 320, 760] {
            let frame = Frame { width, height: 40, color: vec![[200; 3]; width * 40], ..Frame::default() };
            let panel = |note: &str| Panel { title: title.into(), note: note.into(), frame: frame.clone() };
            for (text, size) in [(title, TITLE), (note, NOTE)] {
                let lines = broken(text, size, width as f64 - 2.0 * BESIDE);
                assert_eq!(lines.join(" "), text, "no word is lost");
                for line in &lines {
                    assert!(text_size(size, line).width <= width as f64, "{line} in {width} px");
                }
            }
            let (all, height, pixels) = sheet(&[panel(note), panel("short"), panel(note), panel(note)], 2);
            // White between the columns, and below the last line.
            for (y, row) in pixels.chunks_exact(all).enumerate() {
                assert!(row[width..width + GAP].iter().all(|p| *p == [255; 3]), "row {y} of {width} px");
            }
            assert!(pixels[(height - 3) * all..].iter().all(|p| *p == [255; 3]));
        }
    }
}
