//! The local scale: bars of round lengths that lie on the ground along the picture's horizontal. In a bent view the scale changes from place
//! to place, so one bar would mislead.

use super::record::ScaleRecord;
use super::sighted::{Sighted, around, overlap};
use super::{Rect, Subject};
use crate::{INK, length, round_below};
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Color, Unit};

/// Wanted length of a bar, pixels of a screen, and at most as a share of the width of the picture.
const WANTED_PX: f64 = 120.0;
const MOST_SHARE: f64 = 0.22;
/// Vertices of a bar.
const POINTS: usize = 33;
const LETTERS_PX: f64 = 11.0;
const WHITE: Color = Color::rgb(255, 255, 255);
/// Columns that are tried, shares of the width, and number of rows.
const COLUMNS: [f64; 5] = [0.5, 0.32, 0.68, 0.18, 0.82];
const ROWS: usize = 32;
/// Shortest distance between depths of two bars, as their ratio.
const APART: f64 = 1.25;

/// A bar, in pixels of the picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bar {
    ends: [DVec3; 2],
    length: f64,
    points: Vec<DVec2>,
    depth: f64,
    label: String,
}

/// Words of a length in the unit of a scene.
fn words(value: f64, unit: Unit) -> String {
    let plain = (value * 1e6).round() / 1e6;
    match unit {
        Unit::Metre => length(value),
        Unit::Angstrom => format!("{plain} Å"),
        Unit::Voxel => format!("{plain} voxels"),
    }
}

/// The bar at a place; `None` where the picture does not show it.
fn at(subject: &Subject<'_>, sighted: &Sighted<'_>, place: DVec3) -> Option<Bar> {
    let along = direction(sighted, place)?;
    let step = 1e-3 * sighted.image(place)?.1;
    let [a, b] = [-step, step].map(|s| sighted.image(place + s * along));
    let per_unit = (b?.0 - a?.0).length() / (2.0 * step);
    let wanted = (WANTED_PX * subject.density).min(MOST_SHARE * sighted.size().x);
    let long = round_below(wanted / per_unit);
    if !(long > 0.0 && long.is_finite()) {
        return None;
    }
    let laid = |share: f64| {
        let p = place + (share - 0.5) * long * along;
        if sighted.has_ground() { sighted.laid(p.truncate(), place) } else { Some(p) }
    };
    let places: Vec<DVec3> = (0..POINTS).map(|i| laid(i as f64 / (POINTS - 1) as f64)).collect::<Option<_>>()?;
    let images: Vec<(DVec2, f64)> = places.iter().map(|p| sighted.image(*p)).collect::<Option<_>>()?;
    let seen = [0, POINTS / 4, POINTS / 2, 3 * POINTS / 4, POINTS - 1].into_iter().all(|i| sighted.shows(images[i]));
    let drawn: f64 = images.windows(2).map(|w| w[0].0.distance(w[1].0)).sum();
    // Where the ground or the bend makes it much longer, it is read wrongly.
    if !seen || !(0.15 * wanted..1.8 * wanted).contains(&drawn) {
        return None;
    }
    Some(Bar {
        ends: [places[0], places[POINTS - 1]],
        length: long,
        points: images.iter().map(|(pixel, _)| *pixel).collect(),
        depth: images[POINTS / 2].1,
        label: words(long, subject.scene.unit),
    })
}

/// The level direction whose image is horizontal at a place, a unit vector.
fn direction(sighted: &Sighted<'_>, place: DVec3) -> Option<DVec3> {
    let right = sighted.view.pinhole().right;
    if !sighted.has_ground() {
        return Some(right);
    }
    let [px, py] = sighted.per_unit(place)?;
    // The image of (x, y) has no vertical part.
    let level = DVec2::new(py.y, -px.y).try_normalize().or_else(|| right.truncate().try_normalize())?;
    let level = if (level.x * px + level.y * py).x < 0.0 { -level } else { level };
    Some(level.extend(0.0))
}

/// The bar at a place on the map.
pub(super) fn at_place(subject: &Subject<'_>, sighted: &Sighted<'_>, xy: DVec2) -> Option<Bar> {
    let middle = subject.scene.bounds().center();
    at(subject, sighted, sighted.laid(xy, middle)?)
}

/// Bars in the foreground, in the middle and far away, as far as there are three depths.
///
/// * `taken`: rectangles of other furniture, pixels.
pub(super) fn at_three_depths(subject: &Subject<'_>, sighted: &Sighted<'_>, taken: &[Rect]) -> Vec<Bar> {
    let size = sighted.size();
    let mut found: Vec<Bar> = Vec::new();
    for row in 0..ROWS {
        let y = size.y * (0.95 - 0.9 * row as f64 / (ROWS - 1) as f64);
        let in_row = COLUMNS.iter().filter_map(|x| {
            let bar = at(subject, sighted, sighted.place(DVec2::new(size.x * x, y))?)?;
            let bounds = bar.bounds(subject.density);
            let inside = bounds[0].cmpge(DVec2::ZERO).all() && bounds[1].cmple(size).all();
            (inside && !taken.iter().any(|other| overlap(other, &bounds))).then_some(bar)
        });
        // One that covers no line or point, if there is one, and of these the most level one.
        let tilt = |bar: &Bar| {
            let way = bar.points[POINTS - 1] - bar.points[0];
            let covers = if sighted.has_feature_in(bar.bounds(subject.density)) { 10.0 } else { 0.0 };
            (way.y / way.x).abs() + covers
        };
        found.extend(in_row.min_by(|a, b| tilt(a).total_cmp(&tilt(b))));
    }
    let by_depth = |a: &&Bar, b: &&Bar| a.depth.total_cmp(&b.depth);
    let (Some(near), Some(far)) = (found.iter().min_by(by_depth), found.iter().max_by(by_depth)) else {
        return Vec::new();
    };
    let between = (near.depth * far.depth).sqrt();
    let off = |bar: &&Bar| (bar.depth / between).ln().abs();
    let middle = found.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    let mut bars: Vec<Bar> = vec![near.clone()];
    for bar in middle.into_iter().chain([far]) {
        let bounds = bar.bounds(subject.density);
        let apart = bars.iter().all(|other| {
            let ratio = (bar.depth / other.depth).max(other.depth / bar.depth);
            ratio >= APART && !overlap(&other.bounds(subject.density), &bounds)
        });
        if apart {
            bars.push(bar.clone());
        }
    }
    bars
}

impl Bar {
    pub(super) fn record(&self) -> ScaleRecord {
        ScaleRecord {
            ends: self.ends.map(|p| p.to_array()),
            length: self.length,
            pixels: [self.points[0], self.points[POINTS - 1]].map(|p| p.to_array()),
        }
    }

    /// Left end of the baseline of the label.
    fn label_at(&self, density: f64) -> DVec2 {
        let top = self.points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let wide = text_size(LETTERS_PX * density, &self.label).width;
        DVec2::new(self.points[POINTS / 2].x - 0.5 * wide, top - 8.0 * density)
    }

    /// Rectangle around the bar and its label, pixels.
    pub(super) fn bounds(&self, density: f64) -> Rect {
        let at = self.label_at(density);
        let size = text_size(LETTERS_PX * density, &self.label);
        let text = [at - DVec2::Y * size.ascent, at + DVec2::new(size.width, size.descent)];
        around(self.points.iter().copied().chain(text), 6.0 * density).unwrap_or([DVec2::ZERO; 2])
    }

    /// Draws the bar; a unit of the canvas is a pixel.
    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, density: f64) {
        let ticks = [0, POINTS / 2, POINTS - 1].map(|i| {
            let half = density * if i == POINTS / 2 { 2.5 } else { 4.5 };
            [self.points[i] - half * DVec2::Y, self.points[i] + half * DVec2::Y]
        });
        for (width, color) in [(4.6, WHITE), (1.9, INK)] {
            canvas.line(&self.points, width * density, color);
            ticks.iter().for_each(|tick| canvas.line(tick, width * density, color));
        }
        let halo = Some((WHITE, 1.6 * density));
        canvas.text(self.label_at(density), LETTERS_PX * density, &self.label, INK, halo);
    }
}
