//! Outline of the region that the straight camera does not show.

use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::Color;

/// Widths of rim and line, pixels of a picture 720 high.
const WIDTHS: [f64; 2] = [4.2, 2.0];
/// Colours of rim and line.
pub(super) const COLORS: [Color; 2] = [Color::rgb(255, 255, 255), Color::rgb(200, 0, 110)];

/// Half widths of gaps that are closed and of specks that are removed, pixels of a picture 720 high.
const CLOSED: f64 = 5.0;
const OPENED: f64 = 1.5;

/// The mask with gaps closed and then specks removed (morphological closing and opening).
/// * `close`, `open`: half widths of these gaps and specks, pixels.
pub fn regions(mask: &[bool], width: usize, close: usize, open: usize) -> Vec<bool> {
    let closed = spread(&spread(mask, width, close, true), width, close, false);
    spread(&spread(&closed, width, open, false), width, open, true)
}

/// Sets every pixel to `value` within a disc around a pixel with that value (dilation or erosion), in time linear in their number.
///
/// * `reach`: pixels; the disc holds those less than half a pixel farther away.
pub fn spread(mask: &[bool], width: usize, reach: usize, value: bool) -> Vec<bool> {
    // Distance to the nearest such pixel of the column, and how far the disc extends along the row there.
    let mut away: Vec<usize> = mask.iter().map(|m| if *m == value { 0 } else { reach + 1 }).collect();
    let half: Vec<usize> = (0..=reach).map(|d| (reach * reach + reach - d * d).isqrt()).collect();
    for i in width..away.len() {
        away[i] = away[i].min(away[i - width] + 1);
    }
    for i in (0..away.len().saturating_sub(width)).rev() {
        away[i] = away[i].min(away[i + width] + 1);
    }
    let mut out = vec![!value; mask.len()];
    for (row, away) in out.chunks_mut(width.max(1)).zip(away.chunks(width.max(1))) {
        // Discs that begin less those that end at each column.
        let mut begun = vec![0i32; width + 1];
        for (x, half) in away.iter().enumerate().filter_map(|(x, d)| Some((x, half.get(*d)?))) {
            begun[x.saturating_sub(*half)] += 1;
            begun[(x + half + 1).min(width)] -= 1;
        }
        let mut covering = 0;
        for (pixel, begun) in row.iter_mut().zip(begun) {
            covering += begun;
            *pixel = if covering > 0 { value } else { !value };
        }
    }
    out
}

/// Pixels of the mask with a neighbour beside, above or below that is not in it.
pub fn border(mask: &[bool], width: usize) -> Vec<usize> {
    let height = mask.len().checked_div(width).unwrap_or(0);
    let is_border = |&i: &usize| {
        let (x, y) = (i % width, i / width);
        let open = |inside: bool, at: usize| inside && !mask[at];
        mask[i]
            && (open(x > 0, i.wrapping_sub(1))
                || open(x + 1 < width, i + 1)
                || open(y > 0, i.wrapping_sub(width))
                || open(y + 1 < height, i + width))
    };
    (0..mask.len()).filter(is_border).collect()
}

/// Draws the outline.
pub(super) fn draw(canvas: &mut Canvas<'_>, mask: &[bool], width: usize) {
    let scale = super::scale(canvas);
    let [close, open] = [CLOSED, OPENED].map(|px| (px * scale).round() as usize);
    let border = border(&regions(mask, width, close, open), width);
    for (line, color) in WIDTHS.into_iter().zip(COLORS) {
        for &i in &border {
            let at = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            canvas.disc(at, 0.5 * scale * line, color);
        }
    }
}

#[cfg(test)]
mod tests;
