//! A rose that lies on the ground, with the directions of its place, and a small one in a corner.

use super::record::CompassRecord;
use super::sighted::{Sighted, around, overlap};
use super::{Rect, Subject};
use crate::{INK, PAPER};
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Color, Unit};

/// Radius of a rose on the ground, pixels of a screen, and at most as a share of the picture's smaller side.
const RADIUS_PX: f64 = 46.0;
const MOST_SHARE: f64 = 0.10;
/// A rose on ground that is seen flatter than this cannot be read: shortest by longest radius.
const FLATTEST: f64 = 0.13;
/// Largest height of a rose with its letter, as a share of the picture's height, and of the letter in that.
const MOST_HEIGHT: f64 = 0.04;
const LETTER_SHARE: f64 = 0.38;
/// Share of that height that is planned for: the ground is no plane, and perspective no affine map.
const ROOM: f64 = 0.96;
/// From the northern end of a rose to the middle of its letter, in heights of the letter.
const FROM_TIP: f64 = 0.65;
/// Largest side of the small rose.
const MOST_SIDE: f64 = 52.0;

const WHITE: Color = Color::rgb(255, 255, 255);
/// Colour of the part of a rose that points to the north.
const NORTH: Color = Color::rgb(213, 94, 0);
/// Places that are tried, shares of the picture.
const COLUMNS: [f64; 9] = [0.12, 0.88, 0.2, 0.8, 0.3, 0.7, 0.4, 0.6, 0.5];
const ROWS: [f64; 5] = [0.88, 0.82, 0.76, 0.70, 0.62];
/// Vertices of the ring, and those that must be seen.
const RING: usize = 72;
const CHECKED: usize = 12;

/// A rose on the ground, in pixels of the picture.
pub(super) struct Rose {
    at: DVec3,
    north: DVec2,
    ring: Vec<DVec2>,
    /// Halves of the points, north first, the western half before the eastern one.
    halves: Vec<[Vec<DVec2>; 2]>,
    /// Middle of the letter at its northern end, and its height.
    letter: (DVec2, f64),
    centre: DVec2,
    bounds: Rect,
    /// Radius on the ground, scene units.
    reach: f64,
}

/// A small rose in a corner.
pub(super) struct Small {
    at: DVec3,
    north: DVec2,
    north_px: DVec2,
}

/// The rose at the place in the foreground where it is read best; `None` where it could nowhere be read.
///
/// * `taken`: rectangles of other furniture, pixels.
pub(super) fn on_ground(subject: &Subject<'_>, sighted: &Sighted<'_>, taken: &[Rect]) -> Option<Rose> {
    if subject.scene.unit != Unit::Metre {
        return None;
    }
    let size = sighted.size();
    let mut best: Option<(f64, Rose)> = None;
    for (row, y) in ROWS.into_iter().enumerate() {
        for x in COLUMNS {
            let Some(at) = sighted.place(size * DVec2::new(x, y)) else { continue };
            let Some((ratio, rose)) = rose(subject, sighted, at) else { continue };
            if taken.iter().any(|other| overlap(other, &rose.bounds)) {
                continue;
            }
            let covers = if sighted.has_feature_in(rose.bounds) { 0.5 } else { 0.0 };
            let score = ratio - covers - 0.04 * row as f64;
            if best.as_ref().is_none_or(|(known, _)| score > *known) && is_seen(sighted, &rose, subject) {
                best = Some((score, rose));
            }
        }
    }
    best.map(|(_, rose)| rose)
}

/// Whether the picture shows all of a rose: its pixels show ground about as far from its middle as it reaches.
fn is_seen(sighted: &Sighted<'_>, rose: &Rose, subject: &Subject<'_>) -> bool {
    let margin = 4.0 * subject.density;
    let is_near = |p: DVec3| p.truncate().distance(rose.at.truncate()) < 1.2 * rose.reach;
    let on_ring = (0..CHECKED).map(|i| rose.ring[i * RING / CHECKED]);
    rose.bounds[0].cmpge(DVec2::splat(margin)).all()
        && rose.bounds[1].cmple(sighted.size() - margin).all()
        && on_ring.chain([rose.centre]).all(|pixel| sighted.place(pixel).is_some_and(is_near))
}

/// The rose at a place and how flat it is seen, shortest by longest radius.
fn rose(subject: &Subject<'_>, sighted: &Sighted<'_>, at: DVec3) -> Option<(f64, Rose)> {
    let north = (subject.north)(at.truncate());
    let east = DVec2::new(north.y, -north.x);
    let [px, py] = sighted.per_unit(at)?;
    let to_px = |v: DVec2| v.x * px + v.y * py;
    let [longest, shortest] = radii(to_px(east), to_px(north));
    let most = MOST_HEIGHT * sighted.size().y;
    let letter_px = LETTER_SHARE * most;
    let ratio = shortest / longest;
    // The images of the unit vectors span an ellipse of this half height. The letter stands beyond it, beside, above or below.
    let half_height = to_px(east).y.hypot(to_px(north).y).max(1e-9);
    let beyond = (to_px(north).normalize_or(-DVec2::Y).y * FROM_TIP).abs() + 0.5;
    let with_letter = (ROOM * most - beyond * letter_px) / (half_height + to_px(north).y.abs());
    let target = (RADIUS_PX * subject.density).min(MOST_SHARE * sighted.size().min_element());
    let radius = (target / longest).min(0.5 * ROOM * most / half_height).min(with_letter);
    if !(ratio >= FLATTEST && radius.is_finite() && radius > 0.0) {
        return None;
    }
    // The plane that fits the ground under its rim, so that bumps do not dent it.
    let xy = |u: f64, v: f64| at.truncate() + radius * (u * east + v * north);
    let (mut middle, mut slope) = (0.0, DVec2::ZERO);
    for i in 0..CHECKED {
        let (sin, cos) = (i as f64 / CHECKED as f64 * std::f64::consts::TAU).sin_cos();
        let height = sighted.laid(xy(cos, sin), at)?.z;
        middle += height / CHECKED as f64;
        slope += 2.0 * height / CHECKED as f64 * DVec2::new(cos, sin);
    }
    let image = |u: f64, v: f64| {
        let height = middle + slope.dot(DVec2::new(u, v));
        Some(sighted.image(xy(u, v).extend(height))?.0)
    };
    let ring: Vec<DVec2> = (0..RING)
        .map(|i| {
            let (sin, cos) = (i as f64 / RING as f64 * std::f64::consts::TAU).sin_cos();
            image(cos, sin)
        })
        .collect::<Option<_>>()?;
    let turned = |[x, y]: [f64; 2], quarter: usize| match quarter {
        0 => [x, y],
        1 => [y, -x],
        2 => [-x, -y],
        _ => [-y, x],
    };
    let half = |side: f64, quarter: usize| {
        let corners = [[0.0, 0.0], [side * 0.2, 0.2], [0.0, 0.9]].map(|c| turned(c, quarter));
        let edge = |i: usize| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % 3]);
            (0..4).map(move |k| {
                let t = f64::from(k) / 4.0;
                (ax + t * (bx - ax), ay + t * (by - ay))
            })
        };
        (0..3).flat_map(edge).map(|(u, v)| image(u, v)).collect::<Option<Vec<_>>>()
    };
    let halves = (0..4).map(|q| Some([half(-1.0, q)?, half(1.0, q)?])).collect::<Option<Vec<_>>>()?;
    let centre = image(0.0, 0.0)?;
    let tip = image(0.0, 1.0)?;
    let letter = tip + (tip - centre).normalize_or(-DVec2::Y) * FROM_TIP * letter_px;
    let corners = [letter - 0.5 * letter_px, letter + 0.5 * letter_px];
    let bounds = around(ring.iter().copied().chain(corners), 2.0 * subject.density)?;
    Some((ratio, Rose { at, north, ring, halves, letter: (letter, letter_px), centre, bounds, reach: radius }))
}

/// Longest and shortest radius of the ellipse that the images of two orthogonal unit vectors span.
fn radii(a: DVec2, b: DVec2) -> [f64; 2] {
    let (sum, twice) = (a.length_squared() + b.length_squared(), 2.0 * a.perp_dot(b).abs());
    let (p, m) = ((sum + twice).max(0.0).sqrt(), (sum - twice).max(0.0).sqrt());
    [0.5 * (p + m), 0.5 * (p - m)]
}

impl Rose {
    pub(super) fn bounds(&self) -> Rect {
        self.bounds
    }

    pub(super) fn record(&self) -> CompassRecord {
        let north_px = (self.ring[RING / 4] - self.centre).normalize_or_zero().to_array();
        CompassRecord { on_ground: true, at: self.at.to_array(), north: self.north.to_array(), north_px }
    }

    /// Draws the rose; a unit of the canvas is a pixel.
    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, density: f64) {
        canvas.polygon([&self.ring[..]], PAPER.with_alpha(120));
        let closed: Vec<DVec2> = self.ring.iter().chain(self.ring.first()).copied().collect();
        canvas.line(&closed, 3.4 * density, WHITE.with_alpha(200));
        canvas.line(&closed, 1.4 * density, INK);
        for (quarter, [left, right]) in self.halves.iter().enumerate() {
            let dark = if quarter == 0 { NORTH } else { INK };
            canvas.polygon([&left[..]], dark);
            canvas.polygon([&right[..]], WHITE);
            for half in [left, right] {
                let rim: Vec<DVec2> = half.iter().chain(half.first()).copied().collect();
                canvas.line(&rim, 0.8 * density, dark);
            }
        }
        write(canvas, self.letter.0, self.letter.1, "N", density);
    }
}

/// Side of the small rose in a picture of some size.
pub(super) fn corner_side(size: DVec2) -> f64 {
    (MOST_HEIGHT * size.y).min(MOST_SIDE)
}

/// Writes a letter around a point.
fn write(canvas: &mut Canvas<'_>, at: DVec2, size: f64, text: &str, density: f64) {
    let wide = text_size(size, text).width;
    canvas.text(at + DVec2::new(-0.5 * wide, 0.36 * size), size, text, INK, Some((WHITE, 1.6 * density)));
}

/// The small rose: the direction to the north at the lowest place in the middle of the picture.
pub(super) fn in_corner(subject: &Subject<'_>, sighted: &Sighted<'_>) -> Option<Small> {
    if subject.scene.unit != Unit::Metre {
        return None;
    }
    let size = sighted.size();
    let rows = (1..=40).map(|i| size * DVec2::new(0.5, 1.0 - f64::from(i) / 41.0));
    let at = rows.into_iter().find_map(|pixel| sighted.place(pixel))?;
    let north = (subject.north)(at.truncate());
    let [px, py] = sighted.per_unit(at)?;
    let north_px = (north.x * px + north.y * py).try_normalize()?;
    Some(Small { at, north, north_px })
}

impl Small {
    pub(super) fn record(&self) -> CompassRecord {
        let north_px = self.north_px.to_array();
        CompassRecord { on_ground: false, at: self.at.to_array(), north: self.north.to_array(), north_px }
    }

    /// Draws the rose into a square with its upper left corner at `at`: an arrow, and the letter at its foot.
    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, at: DVec2, side: f64) {
        let (centre, along) = (at + 0.5 * side, self.north_px);
        let across = along.perp();
        canvas.disc(centre, 0.5 * side, PAPER);
        let point = |u: f64, v: f64| centre + 0.5 * side * (u * across + v * along);
        let (tip, middle) = (point(0.0, 0.92), point(0.0, 0.16));
        canvas.polygon([&[tip, point(-0.42, -0.04), middle][..]], NORTH);
        canvas.polygon([&[tip, point(0.42, -0.04), middle][..]], INK);
        write(canvas, point(0.0, -0.46), LETTER_SHARE * side, "N", 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_are_those_of_the_ellipse() {
        // A circle of radius 3 seen from 30 degrees, turned.
        let (sin, cos) = 0.7f64.sin_cos();
        let (a, b) = (DVec2::new(3.0 * cos, 1.5 * sin), DVec2::new(-3.0 * sin, 1.5 * cos));
        let [longest, shortest] = radii(a, b);
        assert!((longest - 3.0).abs() < 1e-12 && (shortest - 1.5).abs() < 1e-12, "{longest} {shortest}");
    }
}
