//! The outline of a target: a line where the picture shows it, dashes where something hides it.

use super::highlight::{border, regions, spread};
use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::{Color, Frame};

/// Widths of rim and line, pixels of a picture 720 high.
const WIDTHS: [f64; 2] = [3.6, 1.8];
const COLORS: [Color; 2] = [Color::rgb(255, 255, 255), Color::rgb(190, 30, 90)];
/// Half widths of gaps that are closed and of specks that are removed, pixels of a picture 720 high: between atoms, and between thin parts.
const CLOSED: f64 = 9.0;
const OPENED: f64 = 1.0;
/// Largest extent of a part that is too small for an outline to be found by, pixels of a picture 720 high; and most such parts.
const SMALL: f64 = 28.0;
const FEW: usize = 3;
/// Length of dashes and gaps, pixels of a picture 720 high.
const DASH: f64 = 6.0;

/// The middles of the parts of a target, and whether the picture shows any of each, where all are so small that an outline is easily
/// overlooked; nothing where a part is larger, or where there are many.
///
/// * `own`, `seen`: as for [`draw`].
pub fn small_parts(own: &[bool], seen: &[bool], width: usize) -> Vec<(DVec2, bool)> {
    let scale = ((own.len() / width.max(1)) as f64 / 720.0).max(0.4);
    let region = regions(own, width, (CLOSED * scale).round() as usize, 0);
    let mut left = region.clone();
    let mut parts = Vec::new();
    for first in 0..left.len() {
        if !left[first] {
            continue;
        }
        let (mut low, mut high, mut is_seen) = (DVec2::INFINITY, DVec2::NEG_INFINITY, false);
        let mut todo = vec![first];
        left[first] = false;
        while let Some(i) = todo.pop() {
            let at = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            (low, high, is_seen) = (low.min(at), high.max(at), is_seen || seen[i]);
            let beside = [(i % width > 0).then(|| i - 1), (i % width + 1 < width).then(|| i + 1)];
            let rows = [i.checked_sub(width), Some(i + width).filter(|k| *k < left.len())];
            for k in beside.into_iter().chain(rows).flatten() {
                if std::mem::take(&mut left[k]) {
                    todo.push(k);
                }
            }
        }
        if (high - low).max_element() > SMALL * scale || parts.len() == FEW {
            return Vec::new();
        }
        parts.push((0.5 * (low + high), is_seen));
    }
    parts
}

/// Draws the outline.
///
/// * `own`: whether a pixel is one of the target's, row by row; `seen`: whether the picture shows the target there.
pub fn draw(frame: &mut Frame, own: &[bool], seen: &[bool]) {
    let scale = (frame.height as f64 / 720.0).max(0.4);
    let width = frame.width;
    let dash = (scale * DASH).max(2.0);
    let [close, open] = [CLOSED, OPENED].map(|px| (px * scale).round() as usize);
    let region = regions(own, width, close, open);
    // The outline of a region with gaps may lie beside the target.
    let seen = spread(seen, width, close + 1, true);
    let is_inked = |i: usize| {
        let (x, y) = ((i % width) as f64, (i / width) as f64);
        seen[i] || (((x + y) / dash) as usize).is_multiple_of(2) && ((x - y) / dash).floor().rem_euclid(2.0) < 0.5
    };
    let outline: Vec<usize> = border(&region, width).into_iter().filter(|&i| is_inked(i)).collect();
    let mut canvas = Canvas::new(&mut frame.color, width);
    for (line, color) in WIDTHS.into_iter().zip(COLORS) {
        for &i in &outline {
            canvas.disc(DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5), 0.5 * scale * line, color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_targets_of_few_small_parts_are_ringed() {
        let (width, height) = (400, 300);
        let mask = |parts: &[[usize; 3]]| -> Vec<bool> {
            let is_in =
                |x: usize, y: usize| parts.iter().any(|[a, b, n]| (*a..a + n).contains(&x) && (*b..b + n).contains(&y));
            (0..width * height).map(|i| is_in(i % width, i / width)).collect()
        };
        let own = mask(&[[100, 80, 5], [200, 200, 6]]);
        let found = small_parts(&own, &mask(&[[200, 200, 2]]), width);
        assert_eq!(found, [(DVec2::new(102.5, 82.5), false), (DVec2::new(203.0, 203.0), true)]);
        assert_eq!(small_parts(&mask(&[[100, 80, 60], [200, 200, 5]]), &own, width), [], "a large part");
        let many: Vec<[usize; 3]> = (0..9).map(|k| [40 * k + 5, 100, 4]).collect();
        assert_eq!(small_parts(&mask(&many), &own, width), [], "many parts");
        assert_eq!(small_parts(&mask(&[]), &own, width), []);
    }
}
