//! Plots of presets: the deformation curve, its control points and sections, and the eye.

use super::{Shape, seen_at};
use belvedere_composite::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_core::deformation::DeformationCurve;
use belvedere_core::map::spline::SplineBend;
use belvedere_core::presets::PresetDocument;
use belvedere_core::{Pinhole, Projection};
use belvedere_scene::Color;

/// Size of a panel, pixels.
const PANEL: DVec2 = DVec2::new(720.0, 600.0);
/// Panels side by side.
const COLUMNS: usize = 3;
/// Panels of one plot at most.
const MOST_PANELS: usize = 24;
/// Margins of a panel's drawing, pixels: left and right, above, below.
const MARGIN: [f64; 3] = [36.0, 92.0, 56.0];
/// Number of pieces of a drawn curve.
const PIECES: usize = 160;
/// Drawn length of the extensions, curve units.
const EXTENSION: f64 = 0.45;
/// Facing that is coloured as good: sine of 20 degrees.
const WELL_SEEN: f64 = 0.34;

const PAPER: Color = Color::rgb(252, 252, 250);
const GRID: Color = Color::rgb(226, 228, 232);
const INK: Color = Color::rgb(38, 44, 54);
const FAINT: Color = Color::rgb(128, 134, 146);
const POLYGON: Color = Color::rgb(170, 176, 188);
const EYE: Color = Color::rgb(30, 96, 170);
const WEDGE: Color = Color { r: 30, g: 96, b: 170, a: 26 };
const TAG: Color = Color::rgb(190, 96, 10);
const TRANSITION: Color = Color { r: 240, g: 160, b: 40, a: 120 };

/// A drawing.
#[derive(Debug, Clone)]
pub struct Plot {
    /// RGB, row-major.
    pub pixels: Vec<[u8; 3]>,
    /// Columns.
    pub width: usize,
}

/// Draws every preset of a document, or the interpolated one at a viewing angle, degrees.
pub fn plot(document: &PresetDocument, phi_deg: Option<f64>) -> Plot {
    let panels: Vec<(String, f64)> = match phi_deg {
        Some(phi) => vec![(String::new(), phi)],
        None => document.sorted().iter().take(MOST_PANELS).map(|p| (p.name.clone(), p.phi)).collect(),
    };
    let columns = panels.len().clamp(1, COLUMNS);
    let rows = panels.len().div_ceil(columns).max(1);
    let size = PANEL * DVec2::new(columns as f64, rows as f64);
    let width = size.x as usize;
    let mut pixels = vec![[PAPER.r, PAPER.g, PAPER.b]; width * size.y as usize];
    let mut canvas = Canvas::new(&mut pixels, width);
    for (i, (name, phi)) in panels.iter().enumerate() {
        let corner = PANEL * DVec2::new((i % columns) as f64, (i / columns) as f64);
        if let Some((pinhole, bend)) = seen_at(document, *phi) {
            Panel::new(corner, &pinhole, &bend).draw(&mut canvas, &Shape::of(name, &bend));
        }
    }
    Plot { pixels, width }
}

/// Panel of one preset.
struct Panel<'a> {
    corner: DVec2,
    bend: &'a SplineBend,
    curve: &'a DeformationCurve,
    eye: DVec2,
    /// Directions of the upper and lower edge of the picture.
    wedge: [DVec2; 2],
    /// Curve coordinates at the lower left corner of the drawing, and pixels per curve unit.
    low: DVec2,
    scale: f64,
}

impl<'a> Panel<'a> {
    fn new(corner: DVec2, pinhole: &Pinhole, bend: &'a SplineBend) -> Self {
        let curve = bend.curve();
        let eye = bend.curve_position(pinhole.eye);
        let [u, v] = bend.curve_axes();
        let flat = |d: belvedere_core::DVec3| DVec2::new(d.dot(u), d.dot(v));
        let half = match pinhole.projection {
            Projection::Perspective { fov_y } => (0.5 * fov_y).tan(),
            Projection::Orthographic { .. } => 0.0,
        };
        let wedge = [-half, half].map(|h| flat(pinhole.forward + h * pinhole.down).normalize_or_zero());
        let control = bend.control().into_iter();
        let ends = [-EXTENSION, curve.length() + EXTENSION].map(|l| curve.at(l).0);
        // An eye that a dolly has moved far away is not drawn.
        let near = Some(eye).filter(|e| e.length() < 4.0);
        let all = control.chain(ends).chain(near);
        let [lo, hi] = all.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)]);
        let (lo, hi) = (lo - 0.05, hi + 0.05);
        let room = PANEL - DVec2::new(2.0 * MARGIN[0], MARGIN[1] + MARGIN[2]);
        let scale = (room / (hi - lo)).min_element();
        let low = 0.5 * (lo + hi) - 0.5 * room / scale;
        Self { corner, bend, curve, eye, wedge, low, scale }
    }

    fn pixel(&self, p: DVec2) -> DVec2 {
        let at = (p - self.low) * self.scale;
        self.corner + DVec2::new(MARGIN[0] + at.x, PANEL.y - MARGIN[2] - at.y)
    }

    /// The part of a line inside the drawing.
    fn line(&self, canvas: &mut Canvas<'_>, ends: [DVec2; 2], width: f64, color: Color) {
        let (lo, hi) = (self.corner + 2.0, self.corner + PANEL - 2.0);
        let [a, b] = ends.map(|p| self.pixel(p));
        let d = b - a;
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (a, d, lo, hi) in [(a.x, d.x, lo.x, hi.x), (a.y, d.y, lo.y, hi.y)] {
            if d.abs() < 1e-9 {
                if a < lo || a > hi {
                    return;
                }
                continue;
            }
            let (s, t) = ((lo - a) / d, (hi - a) / d);
            (from, to) = (from.max(s.min(t)), to.min(s.max(t)));
        }
        if from < to {
            canvas.line(&[a + from * d, a + to * d], width, color);
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, shape: &Shape) {
        self.grid(canvas);
        self.wedge(canvas);
        let control = self.bend.control();
        for pair in control.windows(2) {
            self.line(canvas, [pair[0], pair[1]], 1.5, POLYGON);
        }
        self.transitions(canvas);
        self.extensions(canvas);
        let length = self.curve.length();
        for i in 0..PIECES {
            let [l0, l1] = [i, i + 1].map(|k| length * k as f64 / PIECES as f64);
            self.line(canvas, [self.curve.at(l0).0, self.curve.at(l1).0], 4.0, self.seen(0.5 * (l0 + l1)));
        }
        for p in &control {
            canvas.disc(self.pixel(*p), 5.0, INK);
            canvas.disc(self.pixel(*p), 3.0, PAPER);
        }
        for tag in self.bend.sections().tags() {
            canvas.disc(self.pixel(self.curve.at(tag.u * length).0), 6.0, TAG);
        }
        canvas.disc(self.pixel(self.curve.at(self.bend.coordinates(self.bend.pivot()).l).0), 4.0, EYE);
        self.words(canvas, shape);
    }

    fn grid(&self, canvas: &mut Canvas<'_>) {
        let size = PANEL / self.scale;
        for k in -40..=40 {
            let at = 0.25 * f64::from(k);
            let (from, to) = (self.low - 1.0, self.low + size + 1.0);
            let width = if k == 0 { 2.0 } else { 1.0 };
            self.line(canvas, [DVec2::new(at, from.y), DVec2::new(at, to.y)], width, GRID);
            self.line(canvas, [DVec2::new(from.x, at), DVec2::new(to.x, at)], width, GRID);
        }
    }

    fn wedge(&self, canvas: &mut Canvas<'_>) {
        const RAYS: usize = 48;
        for k in 0..=RAYS {
            let way = self.wedge[0].lerp(self.wedge[1], k as f64 / RAYS as f64);
            let edge = k == 0 || k == RAYS;
            let (width, color) = if edge { (1.5, EYE) } else { (3.0, WEDGE) };
            self.line(canvas, [self.eye, self.eye + 1e4 * way], width, color);
        }
        let at = self.pixel(self.eye);
        let inside = at.cmpge(self.corner).all() && at.cmple(self.corner + PANEL).all();
        if inside {
            canvas.disc(at, 7.0, EYE);
            canvas.text(at + DVec2::new(10.0, -8.0), 15.0, "eye", EYE, Some((PAPER, 3.0)));
        }
    }

    /// Draws the transitions between sections.
    fn transitions(&self, canvas: &mut Canvas<'_>) {
        let length = self.curve.length();
        for tag in self.bend.sections().tags() {
            let place = |k: usize| (tag.u + tag.delta * (k as f64 / 8.0 - 1.0)).clamp(0.0, 1.0) * length;
            for k in 0..16 {
                self.line(canvas, [self.curve.at(place(k)).0, self.curve.at(place(k + 1)).0], 14.0, TRANSITION);
            }
        }
    }

    fn extensions(&self, canvas: &mut Canvas<'_>) {
        let length = self.curve.length();
        for [from, to] in [[-4.0, 0.0], [length, length + 4.0]] {
            self.line(canvas, [from, to].map(|l| self.curve.at(l).0), 2.0, self.seen(0.5 * (from + to)));
        }
    }

    /// Colour of the ground by its facing: green well visible, yellow at grazing angles, red from behind.
    fn seen(&self, l: f64) -> Color {
        let (p, tangent) = self.curve.at(l);
        let sine = tangent.perp().dot((self.eye - p).normalize_or_zero());
        let mix = |a: [f64; 3], b: [f64; 3], t: f64| {
            let [r, g, b] = std::array::from_fn(|i| (a[i] + t.clamp(0.0, 1.0) * (b[i] - a[i])) as u8);
            Color::rgb(r, g, b)
        };
        if sine <= 0.0 {
            Color::rgb(200, 30, 40)
        } else {
            mix([236.0, 176.0, 30.0], [40.0, 140.0, 80.0], sine / WELL_SEEN)
        }
    }

    fn words(&self, canvas: &mut Canvas<'_>, shape: &Shape) {
        let [near, pivot, far] = shape.slopes_deg;
        let resolved = self.bend.resolved();
        let title = if shape.name.is_empty() { "preset" } else { &shape.name };
        let folds = match shape.fold_heights {
            [None, None] => "never folds".to_owned(),
            [Some(low), None] => format!("folds below {low:.0}"),
            [None, Some(high)] => format!("folds above {high:.0}"),
            [Some(low), Some(high)] => format!("folds below {low:.0}, above {high:.0}"),
        };
        let at = |y: f64| self.corner + DVec2::new(MARGIN[0], y);
        canvas.text(at(32.0), 22.0, &format!("{title}, phi {:.0}°", shape.phi), INK, None);
        canvas.text(
            at(54.0),
            15.0,
            &format!("ground seen under {near:.0}°, {pivot:.0}°, {far:.0}° near, at the pivot, far"),
            FAINT,
            None,
        );
        canvas.text(
            at(74.0),
            15.0,
            &format!("length {:.2}, facing {:.3}, {folds}", shape.length, shape.facing),
            FAINT,
            None,
        );
        let names: Vec<String> = (0..self.bend.sections().len())
            .filter_map(|i| self.bend.sections().ids(i))
            .map(|(start, target)| if self.bend.sections().beta() < 0.5 { start } else { target }.to_owned())
            .collect();
        let below =
            format!("u = 0 at depth {:.0}, u = 1 at {:.0}; sections {}", resolved.s, resolved.e, names.join(", "));
        canvas.text(at(PANEL.y - 18.0), 15.0, &below, FAINT, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_builtin_has_a_plot_with_its_curve_on_it() {
        for builtin in belvedere_core::presets::BUILTINS {
            let document = PresetDocument::builtin(builtin.name).expect("built in");
            let drawn = plot(&document, None);
            assert_eq!(drawn.width, 720 * document.presets.len().min(3), "{}", builtin.name);
            let green = drawn.pixels.iter().filter(|[r, g, b]| g > r && i32::from(*g) > i32::from(*b) + 40).count();
            let red = drawn.pixels.iter().filter(|[r, g, b]| *r > 180 && *g < 60 && *b < 70).count();
            // Level ground seen along itself is the only one that is seen edge-on.
            let edge_on = builtin.name == "identity";
            assert!((green > 300 && red < 50) != edge_on, "{}: {green} {red}", builtin.name);
            assert_eq!(plot(&document, Some(40.0)).width, 720);
        }
    }
}
