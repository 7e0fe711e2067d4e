//! Legend and scale bar of a picture of the camera.

use super::super::{INK, PAPER, length, round_below};
use super::subject::CameraFigure;
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::Unit;

const LETTERS_PX: f64 = 12.0;
const ROW: f64 = 17.0;
/// Margin between the legend and the rim of the picture, pixels.
const MARGIN: f64 = 10.0;

/// Most of the width and of the height of a picture that a legend takes up: in smaller pictures there is none, and names of planes and viewpoints
/// alone.
const MOST: DVec2 = DVec2::new(0.5, 0.6);
/// Distance of the places along rays that a legend should not cover, pixels.
const STEP: f64 = 8.0;

/// Draws the legend, and in pictures from above also scale bar and north arrow.
///
/// * `title`, `unit`: those of the scene.
pub fn draw(canvas: &mut Canvas<'_>, figure: &CameraFigure, (title, unit): (&str, Unit)) {
    let size = canvas.size();
    let pinhole = figure.view.pinhole();
    if pinhole.is_orthographic() {
        scale_bar(canvas, size, pinhole.scale_px(), unit);
    }
    let widest = figure.legend.iter().map(|(_, text)| text_size(LETTERS_PX, text).width + 42.0);
    let width = widest.fold(text_size(14.0, title).width + 20.0, f64::max);
    let height = 30.0 + ROW * figure.legend.len() as f64;
    let legend = DVec2::new(width, height);
    if legend.cmpgt(MOST * size).any() {
        return;
    }
    let lo = corner(figure, size, legend);
    canvas.rect(lo, lo + legend, 5.0, PAPER);
    canvas.text(lo + DVec2::new(10.0, 18.0), 14.0, title, INK, None);
    for (i, (color, text)) in figure.legend.iter().enumerate() {
        let row = lo + DVec2::new(10.0, 33.0 + ROW * i as f64);
        canvas.line(&[row, row + DVec2::new(14.0, 0.0)], 3.0, *color);
        canvas.text(row + DVec2::new(20.0, 0.36 * LETTERS_PX), LETTERS_PX, text, INK, None);
    }
}

/// Upper left corner of the legend: the corner of the picture where it covers the fewest rays, the upper left one in doubt.
fn corner(figure: &CameraFigure, size: DVec2, legend: DVec2) -> DVec2 {
    let far = size - legend - MARGIN;
    let place = |p: DVec3| figure.view.project(p).ok().map(|image| image.pixel);
    let lines = figure.overlay.over.iter().filter(|line| line.color.a == 255);
    let pieces =
        lines.flat_map(|line| line.points.windows(2)).filter_map(|ends| Some([place(ends[0])?, place(ends[1])?]));
    let along = pieces.flat_map(|[a, b]| {
        let steps = (a.distance(b) / STEP).ceil().clamp(1.0, 1000.0);
        (0..steps as usize).map(move |i| a.lerp(b, i as f64 / steps))
    });
    let drawn: Vec<DVec2> = along.chain(figure.overlay.points.iter().filter_map(|mark| place(mark.position))).collect();
    let covered = |lo: DVec2| drawn.iter().filter(|at| at.cmpgt(lo).all() && at.cmplt(lo + legend).all()).count();
    let places = [DVec2::splat(MARGIN), DVec2::new(far.x, MARGIN), far];
    places.into_iter().min_by_key(|lo| covered(*lo)).unwrap_or(places[0])
}

fn scale_bar(canvas: &mut Canvas<'_>, size: DVec2, px_per_unit: f64, unit: Unit) {
    let units = round_below(0.2 * size.x / px_per_unit);
    let bar = units * px_per_unit;
    if !(bar > 20.0) {
        return;
    }
    let lo = DVec2::new(10.0, size.y - 44.0);
    canvas.rect(lo, lo + DVec2::new(bar + 52.0, 34.0), 5.0, PAPER);
    let [a, b] = [lo + DVec2::new(12.0, 24.0), lo + DVec2::new(12.0 + bar, 24.0)];
    let tick = DVec2::new(0.0, 5.0);
    canvas.line(&[a - tick, a, b, b - tick], 1.6, INK);
    let text = match unit {
        Unit::Metre => length(units),
        Unit::Angstrom => format!("{units} angstrom"),
        Unit::Voxel => format!("{units} voxels"),
    };
    let middle = a.x + 0.5 * (bar - text_size(11.0, &text).width);
    canvas.text(DVec2::new(middle, a.y - 5.0), 11.0, &text, INK, None);
    let north = lo + DVec2::new(bar + 34.0, 8.0);
    canvas.line(&[north + DVec2::new(0.0, 20.0), north, north + DVec2::new(-4.0, 7.0)], 1.6, INK);
    canvas.line(&[north, north + DVec2::new(4.0, 7.0)], 1.6, INK);
    canvas.text(north + DVec2::new(6.0, 20.0), 11.0, "N", INK, None);
}
