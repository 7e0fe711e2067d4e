//! The legend of highlights, in the lower left corner.

use super::{HighlightMark, HighlightRecord, ghosts, heat, outline};
use crate::{INK, PAPER};
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::DVec2;
use belvedere_scene::Color;

const LETTERS_PX: f64 = 12.0;
/// Height of a line of text, and of the bar with its numbers, pixels.
const ROW: f64 = 17.0;
const BAR: f64 = 44.0;
const WIDTH: f64 = 250.0;
const MARGIN: f64 = 10.0;

enum Sign {
    Swatch([u8; 3]),
    Line([Color; 2], bool),
}

/// Draws the entries that fit.
/// * `above`: height at the lower rim that is already occupied, pixels.
pub(super) fn draw(canvas: &mut Canvas<'_>, record: &HighlightRecord, above: f64) {
    let size = canvas.size();
    let bar = if record.marks.contains(&HighlightMark::Shift) { BAR } else { 0.0 };
    let room = ((size.y - above - bar - 3.0 * MARGIN) / ROW).floor().max(0.0) as usize;
    if size.x < WIDTH + 2.0 * MARGIN || (room == 0 && bar == 0.0) || size.y < above + bar + 3.0 * MARGIN {
        return;
    }
    let rows = rows(record, room);
    let height = bar + ROW * rows.len() as f64 + if rows.is_empty() { 0.0 } else { 8.0 };
    let lo = DVec2::new(MARGIN, size.y - above - height - MARGIN);
    canvas.rect(lo, lo + DVec2::new(WIDTH, height), 5.0, PAPER);
    if bar > 0.0 {
        draw_bar(canvas, lo, record.ramp_px);
    }
    for (k, (sign, words)) in rows.iter().enumerate() {
        let at = lo + DVec2::new(10.0, bar + 5.0 + ROW * k as f64);
        match sign {
            Sign::Swatch([r, g, b]) => {
                canvas.rect(at + DVec2::new(0.0, 2.0), at + DVec2::new(22.0, 13.0), 2.0, Color::rgb(*r, *g, *b));
            }
            Sign::Line(colors, dashed) => {
                for (width, color) in [4.0, 2.0].into_iter().zip(colors) {
                    for [from, to] in if *dashed { &[[0.0, 8.0], [14.0, 22.0]][..] } else { &[[0.0, 22.0]] } {
                        canvas.line(&[at + DVec2::new(*from, 8.0), at + DVec2::new(*to, 8.0)], width, *color);
                    }
                }
            }
        }
        canvas.text(at + DVec2::new(30.0, 12.0), LETTERS_PX, words, INK, None);
    }
}

fn rows(record: &HighlightRecord, room: usize) -> Vec<(Sign, String)> {
    let wants = |mark| record.marks.contains(&mark);
    let mut rows = Vec::new();
    if wants(HighlightMark::Stages) {
        let part = |p: &super::PartRecord| (Sign::Swatch(p.color), format!("{}: up to {:.0} px", p.name, p.max_px));
        rows.extend(record.parts.iter().map(part));
    }
    if wants(HighlightMark::Revealed) {
        rows.push((Sign::Line(outline::COLORS, false), "hidden in the straight picture".into()));
    }
    if wants(HighlightMark::GhostBox) && record.ghosts.iter().any(|g| g.straight_px.is_some()) {
        rows.push((Sign::Line(ghosts::COLORS, true), "where it would be, straight".into()));
    }
    rows.truncate(room);
    rows
}

fn draw_bar(canvas: &mut Canvas<'_>, lo: DVec2, ramp_px: f64) {
    canvas.text(lo + DVec2::new(10.0, 15.0), LETTERS_PX, "moved within the picture", INK, None);
    let width = WIDTH - 20.0;
    for i in 0..width as usize {
        let [r, g, b] = heat::ramp(i as f64 / (width - 1.0));
        let x = lo.x + 10.0 + i as f64;
        canvas.rect(DVec2::new(x, lo.y + 20.0), DVec2::new(x + 1.0, lo.y + 28.0), 0.0, Color::rgb(r, g, b));
    }
    let end = format!("{ramp_px} px and more");
    for (share, text) in [(0.0, "0"), (1.0, end.as_str())] {
        let x = lo.x + 10.0 + share * (width - text_size(11.0, text).width);
        canvas.text(DVec2::new(x, lo.y + 40.0), 11.0, text, INK, None);
    }
}
