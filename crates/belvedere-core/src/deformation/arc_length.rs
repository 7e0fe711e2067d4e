//! Construction of the arc-length parametrisation.

use super::{Cell, DeformationCurve, Gate, angle, curvature_in, tangent_in};
use crate::bspline::{BSpline, CubicSpan};
use glam::DVec2;

/// Allowed error of the inverse, as a share of the curve's length.
const TOLERANCE: f64 = 1e-14;
/// Tangent jumps above this are corners, radians. One-sided tangents at zero speed are good to about 1e-4.
const CORNER: f64 = 1e-3;
/// Most cells of a curve, which bounds the subdivision; typical curves need 1 to 100.
const MAX_CELLS: usize = 4096;
const LOBATTO: usize = 8;
/// Coefficients of a polynomial in -1..=1.
type Poly = [f64; LOBATTO];

/// Positive nodes and weights of the 16-point Gauss-Legendre rule on -1..=1.
const GAUSS: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_58),
    (0.458_016_777_657_227_37, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_88),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_79),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
];

/// The curve's length is below 1e-9 curve units or not finite.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the deformation curve is {length:e} curve units long, a finite length of at least 1e-9 is needed; move its control points"
)]
pub struct CurveTooShort {
    /// Length found, curve units.
    pub length: f64,
}

fn gauss_length(span: &CubicSpan, x0: f64, x1: f64) -> f64 {
    let (mid, half) = (0.5 * (x0 + x1), 0.5 * (x1 - x0));
    let sum: f64 =
        GAUSS.iter().map(|&(x, w)| w * (span.d1(mid - half * x).length() + span.d1(mid + half * x).length())).sum();
    half * sum
}

impl DeformationCurve {
    /// Shortest accepted curve, curve units.
    pub const MIN_LENGTH: f64 = 1e-9;

    /// Arc-length parametrisation of `spline`.
    ///
    /// # Errors
    /// [`CurveTooShort`] below [`DeformationCurve::MIN_LENGTH`].
    pub fn new(spline: &BSpline) -> Result<Self, CurveTooShort> {
        let spans = spline.spans();
        let scale = spans.iter().flat_map(|s| s.c[1..].iter()).map(|c| c.length()).fold(0.0, f64::max);
        let knots: Vec<Vec<f64>> = spans.iter().map(|s| split_points(s, scale)).collect();
        let rough = |(s, k): (&CubicSpan, &Vec<f64>)| k.windows(2).map(|w| gauss_length(s, w[0], w[1])).sum::<f64>();
        let length: f64 = spans.iter().zip(&knots).map(rough).sum();
        if !(length >= Self::MIN_LENGTH && length.is_finite()) {
            return Err(CurveTooShort { length });
        }
        let mut builder = Builder { tolerance: TOLERANCE * length, scale, cells: Vec::new(), end: 0.0 };
        for (index, (span, knots)) in spans.iter().zip(&knots).enumerate() {
            for w in knots.windows(2) {
                builder.cover(span, index, w[0], w[1], 0);
            }
        }
        Ok(finish(spans, builder))
    }
}

/// Parameters 0..=1 of a span between which speed and curvature are monotone and the curvature keeps its sign.
fn split_points(span: &CubicSpan, scale: f64) -> Vec<f64> {
    let mut at = vec![0.0, 1.0];
    let s2 = scale * scale;
    roots(|x| span.d1(x).dot(span.d2(x)), 1e-12 * s2, &mut at);
    roots(|x| span.d1(x).perp_dot(span.d2(x)), 1e-12 * s2, &mut at);
    let curvature_slope = |x: f64| {
        let (d1, d2, d3) = (span.d1(x), span.d2(x), span.d3());
        d1.perp_dot(d3) * d1.length_squared() - 3.0 * d1.perp_dot(d2) * d1.dot(d2)
    };
    roots(curvature_slope, 1e-12 * s2 * s2, &mut at);
    at.sort_by(f64::total_cmp);
    at.dedup_by(|b, a| *b - *a < 1e-12);
    if let Some(last) = at.last_mut() {
        *last = 1.0;
    }
    at
}

/// Appends the sign changes of `f` in (0, 1) to `out`, by bisection; none if `|f|` never exceeds `noise`.
fn roots(f: impl Fn(f64) -> f64, noise: f64, out: &mut Vec<f64>) {
    const SAMPLES: usize = 48;
    let values: Vec<f64> = (0..=SAMPLES).map(|i| f(i as f64 / SAMPLES as f64)).collect();
    if values.iter().all(|v| v.abs() <= noise) {
        return;
    }
    for i in 0..SAMPLES {
        if (values[i] < 0.0) == (values[i + 1] < 0.0) {
            continue;
        }
        let (mut lo, mut hi) = (i as f64 / SAMPLES as f64, (i + 1) as f64 / SAMPLES as f64);
        let rising = values[i] < 0.0;
        while hi - lo > 1e-15 {
            let mid = 0.5 * (lo + hi);
            if mid <= lo || mid >= hi {
                break;
            }
            if (f(mid) < 0.0) == rising { lo = mid } else { hi = mid }
        }
        out.push(hi);
    }
}

struct Builder {
    tolerance: f64,
    scale: f64,
    cells: Vec<Cell>,
    end: f64,
}

impl Builder {
    /// Cells over the parameters `x0..=x1` of `span`, halved until length and inverse are within the tolerance.
    fn cover(&mut self, span: &CubicSpan, index: usize, x0: f64, x1: f64, depth: u32) {
        let mid = 0.5 * (x0 + x1);
        let whole = gauss_length(span, x0, x1);
        let halves = gauss_length(span, x0, mid) + gauss_length(span, mid, x1);
        let last = depth >= 52 || self.cells.len() >= MAX_CELLS || !(mid > x0 && mid < x1);
        if (whole - halves).abs() <= 0.1 * self.tolerance || last {
            let poly = fit_inverse(span, x0, x1, whole);
            if last || inverse_error(span, x0, x1, whole, &poly) <= self.tolerance {
                self.push(span, index, [x0, x1], whole, (poly, fit_length(span, x0, x1, whole)));
                return;
            }
        }
        self.cover(span, index, x0, mid, depth + 1);
        self.cover(span, index, mid, x1, depth + 1);
    }

    fn push(&mut self, span: &CubicSpan, index: usize, [x0, x1]: [f64; 2], length: f64, (poly, arc): (Poly, Poly)) {
        let (l0, l1) = (self.end, self.end + length);
        if !(l1 > l0) {
            return;
        }
        let x_mid = 0.5 * (x0 + x1);
        self.cells.push(Cell {
            l0,
            l1,
            span: index,
            x_mid,
            x_half: 0.5 * (x1 - x0),
            poly,
            arc,
            point: span.point(x0),
            tangent: [x0, x1].map(|x| tangent_in(span, x, x_mid, self.scale)),
            kap: [x0, x1].map(|x| curvature_in(span, x, x_mid, self.scale)),
            turning: 0.0,
            variation: 0.0,
        });
        self.end = l1;
    }
}

/// Span parameter at arc length `l` from `x0`, by Newton within a shrinking bracket.
fn solve(span: &CubicSpan, x0: f64, x1: f64, length: f64, l: f64) -> f64 {
    let (mut lo, mut hi) = (x0, x1);
    let mut x = x0 + (x1 - x0) * (l / length).clamp(0.0, 1.0);
    for _ in 0..60 {
        let error = gauss_length(span, x0, x) - l;
        if error > 0.0 {
            hi = x
        } else {
            lo = x
        }
        let newton = x - error / span.d1(x).length();
        let next = if newton >= lo && newton <= hi { newton } else { 0.5 * (lo + hi) };
        // Quadratic convergence: the step after this one would be below rounding.
        if (next - x).abs() <= 1e-9 * (x1 - x0) {
            return next;
        }
        x = next;
    }
    x
}

/// The parameter, as `y` of -1..=1, over the arc length.
fn fit_inverse(span: &CubicSpan, x0: f64, x1: f64, length: f64) -> Poly {
    fit(|y| {
        let x = solve(span, x0, x1, length, 0.5 * (y + 1.0) * length);
        (2.0 * x - x0 - x1) / (x1 - x0)
    })
}

/// The arc length, as `y` of -1..=1, over the parameter.
fn fit_length(span: &CubicSpan, x0: f64, x1: f64, length: f64) -> Poly {
    fit(|y| 2.0 * gauss_length(span, x0, 0.5 * (x0 + x1 + y * (x1 - x0))) / length - 1.0)
}

/// The polynomial through a function at the Chebyshev-Lobatto points; at -1 and 1 it is -1 and 1.
fn fit(of: impl Fn(f64) -> f64) -> Poly {
    let last = LOBATTO - 1;
    let y: Poly = std::array::from_fn(|k| -(std::f64::consts::PI * k as f64 / last as f64).cos());
    let mut c: Poly = std::array::from_fn(|k| match k {
        0 => -1.0,
        k if k == last => 1.0,
        k => of(y[k]),
    });
    for order in 1..LOBATTO {
        for k in (order..LOBATTO).rev() {
            c[k] = (c[k] - c[k - 1]) / (y[k] - y[k - order]);
        }
    }
    // Newton's form to powers of y.
    let mut poly: Poly = [0.0; LOBATTO];
    for k in (0..LOBATTO).rev() {
        for i in (1..LOBATTO).rev() {
            poly[i] = poly[i - 1] - y[k] * poly[i];
        }
        poly[0] = c[k] - y[k] * poly[0];
    }
    poly
}

/// Largest error in arc length of a fitted inverse, measured halfway between its nodes.
fn inverse_error(span: &CubicSpan, x0: f64, x1: f64, length: f64, poly: &Poly) -> f64 {
    (0..LOBATTO - 1)
        .map(|k| {
            let y = -(std::f64::consts::PI * (k as f64 + 0.5) / (LOBATTO - 1) as f64).cos();
            let x = 0.5 * (x0 + x1) + 0.5 * (x1 - x0) * poly.iter().rev().fold(0.0, |sum, c| sum * y + c);
            (gauss_length(span, x0, x) - 0.5 * (y + 1.0) * length).abs()
        })
        .fold(0.0, f64::max)
}

/// Fills in the prefix sums of turning and curvature variation, the corners and the far end.
fn finish(spans: Vec<CubicSpan>, builder: Builder) -> DeformationCurve {
    let Builder { mut cells, end: length, scale, .. } = builder;
    let (mut turning, mut variation) = (0.0, 0.0);
    let (mut kap, mut tangent): (f64, Option<DVec2>) = (0.0, None);
    let (mut corners, mut corner_sense) = (Vec::new(), [false; 2]);
    for cell in &mut cells {
        if let Some(before) = tangent {
            let jump = angle(before, cell.tangent[0]);
            turning += jump;
            if jump > CORNER {
                corners.push(cell.l0);
                corner_sense[usize::from(before.perp_dot(cell.tangent[0]) > 0.0)] = true;
            }
        }
        variation += (cell.kap[0] - kap).abs();
        (cell.turning, cell.variation) = (turning, variation);
        turning += angle(cell.tangent[0], cell.tangent[1]);
        variation += (cell.kap[1] - cell.kap[0]).abs();
        (kap, tangent) = (cell.kap[1], Some(cell.tangent[1]));
    }
    variation += kap.abs();
    let far_point = spans.last().map_or(DVec2::ZERO, |s| s.point(1.0));
    let starts = cells.iter().map(|c| c.l0).collect();
    DeformationCurve {
        far: (far_point, tangent.unwrap_or(DVec2::X)),
        spans,
        gates: gates(&cells, far_point),
        cells,
        starts,
        length,
        scale,
        turning,
        variation,
        corners,
        corner_sense,
    }
}

fn gates(cells: &[Cell], far: DVec2) -> Vec<Gate> {
    let mut out = Vec::with_capacity(cells.len() + 1);
    for (i, cell) in cells.iter().enumerate() {
        out.push(Gate { point: cell.point, tangent: cell.tangent[0], cell: Some(i) });
        let next = cells.get(i + 1);
        if next.is_none_or(|next| angle(cell.tangent[1], next.tangent[0]) > CORNER) {
            let point = next.map_or(far, |next| next.point);
            out.push(Gate { point, tangent: cell.tangent[1], cell: None });
        }
    }
    out
}
