//! The outline of what the straight camera does not show.

use belvedere_core::DVec2;
use belvedere_cpu::canvas::Canvas;
use belvedere_scene::Color;

/// Widths of rim and line, pixels of a picture 720 high.
const WIDTHS: [f64; 2] = [4.2, 2.0];
/// Rim and line.
pub(super) const COLORS: [Color; 2] = [Color::rgb(255, 255, 255), Color::rgb(200, 0, 110)];

/// The mask without specks: a pixel goes with most of the nine around it.
pub(super) fn cleaned(mask: &[bool], width: usize) -> Vec<bool> {
    let height = mask.len().checked_div(width).unwrap_or(0);
    let most = |i: usize| {
        let (x, y) = (i % width, i / width);
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        let around = rows.flat_map(|row| (x.saturating_sub(1)..(x + 2).min(width)).map(move |col| row * width + col));
        let (set, all) = around.fold((0, 0), |(set, all), i| (set + usize::from(mask[i]), all + 1));
        2 * set > all
    };
    (0..mask.len()).map(most).collect()
}

/// Pixels of the mask that have a neighbour beside, above or below that is not in it.
fn border(mask: &[bool], width: usize) -> Vec<usize> {
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
    let border = border(mask, width);
    let scale = super::scale(canvas);
    for (line, color) in WIDTHS.into_iter().zip(COLORS) {
        for &i in &border {
            let at = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            canvas.disc(at, 0.5 * scale * line, color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six columns: a block of 3 x 3 and a speck.
    fn mask() -> Vec<bool> {
        let rows = ["......", ".###..", ".###..", ".###..", "......", ".....#"];
        rows.iter().flat_map(|r| r.bytes().map(|c| c == b'#')).collect()
    }

    #[test]
    fn specks_go_and_regions_stay() {
        let clean = cleaned(&mask(), 6);
        assert!(!clean[35] && clean[2 * 6 + 2] && !clean[0], "{clean:?}");
        assert_eq!(cleaned(&[true; 12], 4), [true; 12]);
        assert_eq!(cleaned(&[], 0), [] as [bool; 0]);
    }

    #[test]
    fn the_border_is_the_rim_of_the_region_and_not_that_of_the_picture() {
        let border = border(&mask(), 6);
        assert_eq!(border, [7, 8, 9, 13, 15, 19, 20, 21, 35]);
        assert_eq!(super::border(&[true; 12], 4), [] as [usize; 0]);
    }
}
