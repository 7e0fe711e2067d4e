//! A planar curve parametrised by arc length, with its curvature, turning and closest points.

mod arc_length;
mod foot;

pub use arc_length::CurveTooShort;

use crate::bspline::CubicSpan;
use glam::DVec2;

/// A B-spline parametrised by its arc length `l` in 0..=[`DeformationCurve::length`], with straight extensions along its end tangents.
///
/// Arc length is inverted by polynomial pieces fitted to the Newton solution on Gauss-Legendre lengths; pieces are split until
/// the error in arc length is below 1e-14 of the curve's length. Curve units.
#[derive(Debug, Clone, PartialEq)]
pub struct DeformationCurve {
    spans: Vec<CubicSpan>,
    cells: Vec<Cell>,
    gates: Vec<Gate>,
    starts: Vec<f64>,
    length: f64,
    scale: f64,
    far: (DVec2, DVec2),
    turning: f64,
    variation: f64,
    corners: Vec<f64>,
    corner_sense: [bool; 2],
}

/// Piece of the curve on which the curvature is monotone and of one sign.
#[derive(Debug, Clone, PartialEq)]
struct Cell {
    l0: f64,
    l1: f64,
    span: usize,
    x_mid: f64,
    x_half: f64,
    /// Span parameter as `x_mid + x_half * poly(y)`, `y` in -1..=1 over the cell's arc length.
    poly: [f64; 8],
    /// Roughly its inverse: `y` by `(x - x_mid) / x_half`.
    arc: [f64; 8],
    point: DVec2,
    /// Tangents at the start and at the end.
    tangent: [DVec2; 2],
    /// Curvature at the start and at the end.
    kap: [f64; 2],
    /// Turning and total variation of the curvature from `l = -inf` to the start of the cell.
    turning: f64,
    variation: f64,
}

/// A point between cells, or an end, with the tangent there; corners have one for each of their tangents.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gate {
    point: DVec2,
    tangent: DVec2,
    /// The cell that begins here.
    cell: Option<usize>,
}

/// Point, unit tangent and curvature of a [`DeformationCurve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveFrame {
    /// Position, curve units.
    pub point: DVec2,
    /// Unit tangent towards the far end.
    pub tangent: DVec2,
    /// Signed curvature in 1 / curve unit, > 0 where the curve bends upwards; 0 on the extensions.
    pub kap: f64,
}

/// The frame of a [`DeformationCurve`] at an arc length, and what the curve has turned up to there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// [`DeformationCurve::frame_at`].
    pub frame: CurveFrame,
    /// [`DeformationCurve::turning_to`].
    pub turning: f64,
    /// [`DeformationCurve::curvature_variation_to`].
    pub variation: f64,
}

impl CurveFrame {
    /// Unit normal, the tangent turned by +90 degrees: upwards on a curve that runs to the right.
    pub fn normal(&self) -> DVec2 {
        self.tangent.perp()
    }
}

impl DeformationCurve {
    /// Length of the curve, curve units.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Point and unit tangent at arc length `l`; on the straight extensions outside 0..=length. `l` must be finite.
    pub fn at(&self, l: f64) -> (DVec2, DVec2) {
        if l < 0.0 {
            let near = &self.cells[0];
            return (near.point + l * near.tangent[0], near.tangent[0]);
        }
        if l > self.length {
            let (p, t) = self.far;
            return (p + (l - self.length) * t, t);
        }
        let cell = self.cell_at(l);
        let x = cell.parameter(l);
        let span = &self.spans[cell.span];
        (span.point(x), self.tangent_in(cell, x))
    }

    /// Point, tangent and curvature at arc length `l`. At the ends of the curve the curvature is that of the curve.
    pub fn frame_at(&self, l: f64) -> CurveFrame {
        if !(0.0..=self.length).contains(&l) {
            let (point, tangent) = self.at(l);
            return CurveFrame { point, tangent, kap: 0.0 };
        }
        let cell = self.cell_at(l);
        let (span, x) = (&self.spans[cell.span], cell.parameter(l));
        let (tangent, kap) = frame_in(span, x, cell.x_mid, self.scale);
        CurveFrame { point: span.point(x), tangent, kap }
    }

    /// Signed curvature at arc length `l`, 1 / curve unit; at its jumps that of the far side.
    pub fn curvature_at(&self, l: f64) -> f64 {
        if !(0.0..=self.length).contains(&l) {
            return 0.0;
        }
        let cell = self.cell_at(l);
        curvature_in(&self.spans[cell.span], cell.parameter(l), cell.x_mid, self.scale)
    }

    /// Turning of the tangent from the near extension to `l`: the integral of `|kap|`, radians, never decreasing.
    pub fn turning_to(&self, l: f64) -> f64 {
        self.station(l).turning
    }

    /// Total variation of the curvature from the near extension to `l`, jumps included, 1 / curve unit, never decreasing.
    pub fn curvature_variation_to(&self, l: f64) -> f64 {
        self.station(l).variation
    }

    /// Smallest (<= 0) and largest (>= 0) curvature, 1 / curve unit, exact; infinite at a corner.
    pub fn curvature_range(&self) -> [f64; 2] {
        let range = self.cells.iter().flat_map(|c| c.kap).fold([0.0f64, 0.0f64], |[lo, hi], k| [lo.min(k), hi.max(k)]);
        let [down, up] = self.corner_sense;
        [if down { f64::NEG_INFINITY } else { range[0] }, if up { f64::INFINITY } else { range[1] }]
    }

    /// Everything that the curve knows of arc length `l`, which must be finite: one evaluation where the methods above take one each.
    pub fn station(&self, l: f64) -> Station {
        let frame = self.frame_at(l);
        if !(0.0..=self.length).contains(&l) {
            let (turning, variation) = if l < 0.0 { (0.0, 0.0) } else { (self.turning, self.variation) };
            return Station { frame, turning, variation };
        }
        let cell = self.cell_at(l);
        Station {
            frame,
            turning: cell.turning + angle(cell.tangent[0], frame.tangent),
            variation: cell.variation + (frame.kap - cell.kap[0]).abs(),
        }
    }

    /// Arc lengths at which the tangent jumps (at three or more coincident control points or knots).
    pub fn corners(&self) -> &[f64] {
        &self.corners
    }

    /// Smallest sine of the angle between the curve and the ray from `eye`, for `l` between `l0 <= l1`; negative where the eye lies
    /// below the tangent. Sampled sixteen times on each monotone piece; exact in sign on the extensions.
    pub fn min_facing(&self, eye: DVec2, l0: f64, l1: f64) -> f64 {
        let at = |l: f64| {
            let (p, t) = self.at(l);
            (eye - p).normalize_or_zero().dot(t.perp())
        };
        let inner = self.cells.iter().filter(|c| c.l1 >= l0 && c.l0 <= l1).flat_map(|c| {
            let sample = move |k: u32| c.l0 + (c.l1 - c.l0) * f64::from(k) / 16.0;
            (0..=16).map(sample).filter(|l| (l0..=l1).contains(l))
        });
        inner.map(at).fold(at(l0).min(at(l1)), f64::min)
    }

    fn cell_at(&self, l: f64) -> &Cell {
        let i = self.starts.partition_point(|&s| s <= l);
        &self.cells[i.max(1) - 1]
    }

    fn tangent_in(&self, cell: &Cell, x: f64) -> DVec2 {
        tangent_in(&self.spans[cell.span], x, cell.x_mid, self.scale)
    }
}

impl Cell {
    fn parameter(&self, l: f64) -> f64 {
        let y = ((2.0 * l - self.l0 - self.l1) / (self.l1 - self.l0)).clamp(-1.0, 1.0);
        self.x_mid + self.x_half * self.poly.iter().rev().fold(0.0, |sum, c| sum * y + c)
    }

    /// Arc length at a parameter: one step of Newton's method on `poly` from `arc`.
    fn arc_length(&self, x: f64) -> f64 {
        let u = (x - self.x_mid) / self.x_half;
        let y = self.arc.iter().rev().fold(0.0, |sum, c| sum * u + c);
        let (value, slope) = self.poly.iter().rev().fold((0.0, 0.0), |(v, d), c| (v * y + c, d * y + v));
        let y = (y - (value - u) / slope).clamp(-1.0, 1.0);
        0.5 * (self.l0 + self.l1 + y * (self.l1 - self.l0))
    }
}

/// Angle between two unit vectors, 0..=pi, accurate near 0.
fn angle(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b).abs().atan2(a.dot(b))
}

/// Unit tangent at `x`; where the speed vanishes, the one-sided tangent on the side of `inward`.
fn tangent_in(span: &CubicSpan, x: f64, inward: f64, scale: f64) -> DVec2 {
    let d = span.d1(x);
    let speed2 = d.length_squared();
    if speed2 > 1e-18 * scale * scale {
        return d / speed2.sqrt();
    }
    span.d1(moving(span, x, inward, 1e-9 * scale)).normalize_or(DVec2::X)
}

/// Curvature at `x`; where the speed vanishes, the one-sided curvature on the side of `inward`. At most 1e8 / scale.
fn curvature_in(span: &CubicSpan, x: f64, inward: f64, scale: f64) -> f64 {
    let slow = SLOW * scale;
    let x = if span.d1(x).length_squared() > slow * slow { x } else { moving(span, x, inward, slow) };
    let d1 = span.d1(x);
    curvature(d1, d1.length(), span.d2(x), scale)
}

/// Both [`tangent_in`] and [`curvature_in`].
fn frame_in(span: &CubicSpan, x: f64, inward: f64, scale: f64) -> (DVec2, f64) {
    let d1 = span.d1(x);
    let speed = d1.length();
    if speed > SLOW * scale {
        (d1 / speed, curvature(d1, speed, span.d2(x), scale))
    } else {
        (tangent_in(span, x, inward, scale), curvature_in(span, x, inward, scale))
    }
}

/// At speeds below this share of the scale the curvature is inaccurate.
const SLOW: f64 = 1e-7;

fn curvature(d1: DVec2, speed: f64, d2: DVec2, scale: f64) -> f64 {
    let cross = d1.perp_dot(d2);
    // A smaller cross product is rounding error.
    if cross * cross <= 1e-30 * scale * scale * d2.length_squared() {
        return 0.0;
    }
    let limit = 1e8 / scale;
    (cross / (speed * speed * speed)).clamp(-limit, limit)
}

/// The nearest of a few parameters between `x` and `inward` at which the speed exceeds `slow`.
fn moving(span: &CubicSpan, x: f64, inward: f64, slow: f64) -> f64 {
    let toward = if inward >= x { 1.0 } else { -1.0 };
    [1e-6, 1e-5, 1e-4, 1e-3, 1e-2]
        .into_iter()
        .map(|h| x + toward * h)
        .find(|&x| span.d1(x).length() > slow)
        .unwrap_or(inward)
}
