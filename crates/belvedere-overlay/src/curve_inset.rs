//! An inset with the deformation curve from the side, as in figures of presets: the curve, its control and tag points, the eye, and the
//! part of the curve's plane that it sees.

use super::{INK, PAPER};
use belvedere_composite::canvas::{Canvas, text_size};
use belvedere_core::map::spline::SplineBend;
use belvedere_core::{DVec2, View};
use belvedere_scene::Color;

/// Ink of the curve, of its control points and of the tag points.
const CURVE: Color = Color::rgb(0, 114, 178);
const CONTROL: Color = Color::rgb(120, 128, 136);
const TAG: Color = Color::rgb(213, 94, 0);
/// Height of the inset as a share of the picture's smaller side, and its limits, pixels.
const SHARE: f64 = 0.24;
const HEIGHT_PX: [f64; 2] = [84.0, 260.0];
/// Ratio of width to height of the inset.
const ASPECT: f64 = 1.7;
const MARGIN: f64 = 10.0;
const LETTERS_PX: f64 = 11.0;
/// Number of points of the curve, and drawn length of its straight extensions, as a share of its length.
const POINTS: usize = 160;
const BEYOND: f64 = 0.12;

/// Contents of the inset; curve coordinates, u ahead and v up.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveFigure {
    curve: Vec<DVec2>,
    control: Vec<DVec2>,
    tags: Vec<DVec2>,
    eye: DVec2,
    /// Two straight rays, at the upper and the lower rim of the picture, each by its ends.
    rays: [[DVec2; 2]; 2],
    title: String,
}

impl CurveFigure {
    /// The curve of a view; `None` without a spline bend.
    pub fn of(view: &View) -> Option<Self> {
        let bend = view.spline_bend()?;
        let (curve, pinhole, resolved) = (bend.curve(), view.pinhole(), bend.resolved());
        let at = |share: f64| curve.at(share * curve.length()).0;
        let place = |i: usize| at((1.0 + 2.0 * BEYOND) * i as f64 / POINTS as f64 - BEYOND);
        let [width, height] = pinhole.image.map(f64::from);
        let far = farthest(bend, view);
        let ray = |y: f64| {
            let pixel = DVec2::new(0.5 * width, y);
            [0.0, far].map(|depth| bend.curve_position(pinhole.unproject(pixel, depth)))
        };
        let percent = 100.0 * resolved.sigma;
        let names = match (resolved.start == resolved.target, percent.round()) {
            (true, _) | (_, 0.0) => resolved.start.clone(),
            (_, 100.0) => resolved.target.clone(),
            (_, percent) => format!("{} > {} {percent} %", resolved.start, resolved.target),
        };
        Some(Self {
            curve: (0..=POINTS).map(place).collect(),
            control: bend.control(),
            tags: bend.sections().tags().iter().map(|tag| at(tag.u)).collect(),
            eye: bend.curve_position(pinhole.eye),
            rays: [0.0, height].map(ray),
            title: format!("{names}, {:.0} deg", resolved.phi_deg),
        })
    }

    /// Bounds of everything but the rays, which end at the rim.
    fn bounds(&self) -> [DVec2; 2] {
        let all = self.curve.iter().chain(&self.control).chain(&self.tags);
        all.fold([self.eye; 2], |[lo, hi], p| [lo.min(*p), hi.max(*p)])
    }
}

/// Depth of the end of the curve, or of its farthest point ahead of the eye.
fn farthest(bend: &SplineBend, view: &View) -> f64 {
    let pinhole = view.pinhole();
    let end = bend.curve().at((1.0 + BEYOND) * bend.curve().length()).0 - bend.curve_position(pinhole.eye);
    (end.length() * bend.scale()).max(pinhole.near)
}

/// Size of the figure in a picture whose smaller side is given.
pub fn room(smaller: f64) -> DVec2 {
    let height = (SHARE * smaller).clamp(HEIGHT_PX[0], HEIGHT_PX[1]).round();
    DVec2::new((ASPECT * height).round(), height)
}

/// Draws the figure into the upper left corner; returns whether the picture is large enough.
pub fn draw(canvas: &mut Canvas<'_>, figure: &CurveFigure) -> bool {
    let size = canvas.size();
    let room = room(size.min_element());
    if size.x < room.x + 2.0 * MARGIN || size.y < room.y + 2.0 * MARGIN {
        return false;
    }
    draw_in(canvas, figure, [DVec2::splat(MARGIN), room + MARGIN])
}

/// Draws the figure into a rectangle with equal scales along both axes; returns whether the figure was not empty.
pub fn draw_in(canvas: &mut Canvas<'_>, figure: &CurveFigure, [lo, hi]: [DVec2; 2]) -> bool {
    let [from, to] = figure.bounds();
    let extent = to - from;
    if !(extent.is_finite() && extent.max_element() > 0.0) {
        return false;
    }
    let (inner_lo, inner_hi) = (lo + DVec2::new(12.0, 10.0), hi - DVec2::new(12.0, 12.0 + LETTERS_PX));
    let room = inner_hi - inner_lo;
    let scale = (room.x / extent.x.max(1e-9)).min(room.y / extent.y.max(1e-9));
    let (middle, centre) = (0.5 * (from + to), 0.5 * (inner_lo + inner_hi));
    let at = |p: DVec2| centre + scale * DVec2::new(p.x - middle.x, middle.y - p.y);
    canvas.rect(lo, hi, 5.0, PAPER);
    let inside = |ends: [DVec2; 2]| clipped(ends.map(at), [lo + 2.0, hi - DVec2::new(2.0, 6.0 + LETTERS_PX)]);
    let rays = figure.rays.map(inside);
    if let [Some(a), Some(b)] = rays {
        canvas.polygon([&[a[0], a[1], b[1], b[0]][..]], TAG.with_alpha(36));
    }
    for ray in rays.into_iter().flatten() {
        canvas.line(&ray, 1.0, TAG.with_alpha(170));
    }
    let control: Vec<DVec2> = figure.control.iter().map(|p| at(*p)).collect();
    canvas.line(&control, 1.0, CONTROL);
    let curve: Vec<DVec2> = figure.curve.iter().map(|p| at(*p)).collect();
    canvas.line(&curve, 2.2, CURVE);
    for p in control {
        canvas.rect(p - 2.5, p + 2.5, 0.0, CONTROL);
    }
    for p in &figure.tags {
        canvas.disc(at(*p), 4.0, Color::rgb(255, 255, 255));
        canvas.disc(at(*p), 3.0, TAG);
    }
    canvas.disc(at(figure.eye), 3.5, INK);
    let letters = LETTERS_PX;
    let fits = |words: &str| text_size(letters, words).width <= hi.x - lo.x - 20.0;
    if fits(&figure.title) {
        canvas.text(DVec2::new(lo.x + 10.0, hi.y - 8.0), letters, &figure.title, INK, None);
    }
    true
}

/// The part of a segment within a rectangle.
fn clipped([a, b]: [DVec2; 2], [lo, hi]: [DVec2; 2]) -> Option<[DVec2; 2]> {
    let way = b - a;
    let mut part = [0.0f64, 1.0];
    for k in 0..2 {
        let (first, last) = ((lo[k] - a[k]) / way[k], (hi[k] - a[k]) / way[k]);
        if way[k] == 0.0 {
            if !(lo[k]..=hi[k]).contains(&a[k]) {
                return None;
            }
            continue;
        }
        part = [part[0].max(first.min(last)), part[1].min(first.max(last))];
    }
    (part[0] < part[1]).then(|| part.map(|t| a + t * way))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_end_at_the_rim() {
        let rim = [DVec2::ZERO, DVec2::new(10.0, 4.0)];
        let of = |a: [f64; 2], b: [f64; 2]| clipped([a, b].map(DVec2::from_array), rim);
        assert_eq!(of([5.0, 2.0], [25.0, 2.0]), Some([DVec2::new(5.0, 2.0), DVec2::new(10.0, 2.0)]));
        assert_eq!(of([-2.0, -1.0], [6.0, 3.0]), Some([DVec2::ZERO, DVec2::new(6.0, 3.0)]));
        assert_eq!(of([-2.0, 9.0], [30.0, 9.0]), None);
    }

    #[test]
    fn the_figure_is_drawn_where_there_is_room_and_inside_its_rectangle() {
        let curve: Vec<DVec2> = (0..=20).map(|i| DVec2::new(0.05 * f64::from(i), 0.002 * f64::from(i * i))).collect();
        let eye = DVec2::new(-0.4, 0.5);
        let figure = CurveFigure {
            control: vec![curve[0], DVec2::new(0.5, 0.0), curve[20]],
            tags: vec![curve[10]],
            rays: [[eye, DVec2::new(3.0, 1.0)], [eye, DVec2::new(0.2, -2.0)]],
            eye,
            title: "low".into(),
            curve,
        };
        let white = |width: usize, height: usize| vec![[255u8; 3]; width * height];
        let mut small = white(120, 90);
        assert!(!draw(&mut Canvas::new(&mut small, 120), &figure) && small == white(120, 90));
        let mut pixels = white(640, 360);
        assert!(draw(&mut Canvas::new(&mut pixels, 640), &figure));
        let (height, width) = ((SHARE * 360.0).round() + MARGIN, (ASPECT * (SHARE * 360.0).round()).round() + MARGIN);
        let outside = |i: usize| (i % 640) as f64 > width + 1.0 || (i / 640) as f64 > height + 1.0;
        assert!(pixels.iter().enumerate().all(|(i, p)| !outside(i) || *p == [255; 3]));
        let near = |color: Color| {
            let close = |p: &&[u8; 3]| [color.r, color.g, color.b].iter().zip(**p).all(|(a, b)| a.abs_diff(b) < 12);
            pixels.iter().filter(close).count()
        };
        for (what, color, least) in [("curve", CURVE, 60), ("tag", TAG, 10), ("eye", INK, 12), ("control", CONTROL, 20)]
        {
            assert!(near(color) >= least, "{what}: {}", near(color));
        }
    }
}
