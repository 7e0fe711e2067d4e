//! Lines of equal height: of the heights of the map, wherever bends and solvers move the ground.
//!
//! A pixel is covered by its distance on the picture to the nearest height of a line, from the change of the heights from pixel to pixel;
//! lines that would come closer than some pixels fade, thin ones before thick ones.

use super::Seen;
use belvedere_composite::color::{Packed, Rgb, linear, smoothstep};
use belvedere_core::DVec2;
use belvedere_scene::{Color, Contours, Heightfield};
use rayon::prelude::*;

/// Half widths of thin and thick lines, points of a screen.
const HALF_WIDTHS: [f32; 2] = [0.45, 0.85];
/// Distances of two lines at which they are gone and at which they are whole, points of a screen.
const GONE: f32 = 2.5;
const WHOLE: f32 = 6.0;
/// Least change of the height from pixel to pixel, intervals: flatter ground has no line, but at its rim.
const FLATTEST: f32 = 1e-5;
/// Largest ratio of the changes on both sides of a pixel on one slope.
const SAME_SLOPE: f32 = 3.0;

/// Paints the lines.
///
/// * `around`: the rows above and below those of `out`, where the picture goes on; `interval`: scene units, > 0; `density`: pixels per point of
///   a screen; `ink`: the colour of lines, linear, as it is at a pixel and a place.
pub(super) fn paint(
    ground: &Seen<'_>,
    around: [Option<Seen<'_>>; 2],
    heights: &Heightfield,
    (interval, color, density): (f64, Color, f64),
    ink: &(dyn Fn(usize, DVec2, Rgb) -> Rgb + Sync),
    out: &mut [Packed],
) {
    let width = ground.width;
    // Numbers of lines instead of heights: lines lie at whole ones.
    let levels = |seen: &Seen<'_>| -> Vec<f32> {
        let level = |i| {
            let height = seen.place(i).and_then(|xy| heights.height_at(xy));
            height.map_or(f32::NAN, |h| (h / interval) as f32)
        };
        (0..seen.id.len()).into_par_iter().map(level).collect()
    };
    let level = levels(ground);
    let [above, below] = around.map(|row| row.map(|row| levels(&row)));
    let line = linear([color.r, color.g, color.b]);
    let rows = out.len() / width.max(1);
    out.par_iter_mut().enumerate().for_each(|(i, pixel)| {
        let (x, y) = (i % width, i / width);
        let here = level[i];
        if here.is_nan() {
            return;
        }
        let change = |before: Option<f32>, after: Option<f32>| {
            slope(before.map_or(f32::NAN, |before| here - before), after.map_or(f32::NAN, |after| after - here))
        };
        let across = change((x > 0).then(|| level[i - 1]), (x + 1 < width).then(|| level[i + 1]));
        let up = if y > 0 { Some(level[i - width]) } else { above.as_ref().map(|row| row[x]) };
        let down = if y + 1 < rows { Some(level[i + width]) } else { below.as_ref().map(|row| row[x]) };
        let down = change(up, down);
        let cover = cover(here, across.hypot(down), density as f32);
        if cover > 0.0
            && let Some(place) = ground.place(i)
        {
            let share = cover * f32::from(color.a) / 255.0;
            *pixel = Packed::new(pixel.rgb().lerp(ink(i, place, line), share));
        }
    });
}

/// Change of the level at a pixel from the changes on both sides: their mean on one slope, else the smaller one, so that no line is drawn where
/// one surface ends in front of another.
fn slope(before: f32, after: f32) -> f32 {
    match (before.is_nan(), after.is_nan()) {
        (true, true) => 0.0,
        (true, false) => after,
        (false, true) => before,
        (false, false) => {
            let (small, large) = if before.abs() < after.abs() { (before, after) } else { (after, before) };
            let same = large.abs() <= SAME_SLOPE * small.abs() + 0.02;
            if same { 0.5 * (before + after) } else { small }
        }
    }
}

/// Coverage of a pixel by lines, 0..=1.
///
/// * `level`: height in intervals; `change`: its change per pixel.
fn cover(level: f32, change: f32, density: f32) -> f32 {
    if !(change > FLATTEST) || level.is_nan() {
        return 0.0;
    }
    let steps = [1.0, Contours::INDEX as f32];
    let of = |k: usize| {
        let level = level / steps[k];
        let spacing = steps[k] / change;
        let off = (level - level.round()).abs() * spacing;
        let half = HALF_WIDTHS[k] * density;
        (half + 0.5 - off).clamp(0.0, 1.0) * smoothstep(GONE * density, WHOLE * density, spacing)
    };
    of(0).max(of(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_as_wide_as_stated_on_every_slope() {
        for change in [0.01f32, 0.03, 0.1] {
            // Along a way across the slope: the sum of the coverage around a line is its width.
            let around =
                |first: f32| (0..).map(move |i| first + i as f32 * change).take_while(move |l| *l < first + 1.0);
            let width = |k: f32| around(k - 0.5).map(|level| cover(level, change, 1.0)).sum::<f32>();
            assert!((width(1.0) - 2.0 * HALF_WIDTHS[0]).abs() < 0.25, "{change}: {}", width(1.0));
            assert!((width(5.0) - 2.0 * HALF_WIDTHS[1]).abs() < 0.25, "{change}: {}", width(5.0));
        }
    }

    #[test]
    fn lines_that_come_too_close_are_thinned() {
        // Lines 2 pixels apart are gone, every fifth one stays; where these are 2 pixels apart, nothing stays.
        assert_eq!(cover(1.0, 0.5, 1.0), 0.0);
        assert!(cover(5.0, 0.5, 1.0) > 0.9);
        assert_eq!(cover(5.0, 2.5, 1.0), 0.0);
        // At twice the density it is the distance on paper that counts.
        assert!(cover(1.0, 0.2, 1.0) > 0.3 && cover(1.0, 0.2, 2.0) < 0.1);
        assert_eq!([cover(3.0, 0.0, 1.0), cover(f32::NAN, 0.1, 1.0), cover(1.0, f32::NAN, 1.0)], [0.0; 3]);
    }

    #[test]
    fn slopes_do_not_reach_over_the_end_of_a_surface() {
        assert_eq!(slope(0.1, 0.12), 0.11);
        assert_eq!(slope(0.1, 40.0), 0.1);
        assert_eq!([slope(f32::NAN, 0.2), slope(0.3, f32::NAN), slope(f32::NAN, f32::NAN)], [0.2, 0.3, 0.0]);
    }
}
