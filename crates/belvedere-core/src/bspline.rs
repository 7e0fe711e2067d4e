//! Planar cubic B-splines with clamped knots.

use glam::DVec2;

const DEGREE: usize = 3;
/// Knots closer than this (on a curve of parameter range 0..1) are the same knot.
const SAME_KNOT: f64 = 1e-12;

/// A cubic B-spline in the plane, clamped: it starts at its first and ends at its last control point. Parameter range 0..=1.
#[derive(Debug, Clone, PartialEq)]
pub struct BSpline {
    control: Vec<DVec2>,
    knots: Vec<f64>,
}

/// Control points or knots that are not valid for a cubic B-spline.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BSplineError {
    /// Fewer than four control points.
    #[error("{count} control points were given, a cubic curve needs at least 4")]
    TooFew {
        /// Points given.
        count: usize,
    },
    /// A control point or knot is NaN or infinite.
    #[error("{what} {index} is not a finite number; give finite values")]
    NotFinite {
        /// `control point` or `knot`.
        what: &'static str,
        /// Its index, from 0.
        index: usize,
    },
    /// The number of knots is not that of the control points + 4.
    #[error("{given} knots were given, {control} control points need {needed}")]
    KnotCount {
        /// Knots given.
        given: usize,
        /// Control points given.
        control: usize,
        /// Control points + 4.
        needed: usize,
    },
    /// A knot smaller than the one before.
    #[error("knot {index} is {value}, less than the knot before it ({before}); sort the knots")]
    KnotOrder {
        /// Index, from 0.
        index: usize,
        /// The knot.
        value: f64,
        /// The knot before.
        before: f64,
    },
    /// First or last four knots differ, or the whole range is empty.
    #[error(
        "the knots run from {first} to {last} but are not clamped; the first four must be equal, the last four too"
    )]
    NotClamped {
        /// First knot.
        first: f64,
        /// Last knot.
        last: f64,
    },
    /// An inner knot with more than three copies tears the curve apart.
    #[error("inner knot {value} occurs {count} times, at most 3 keep the curve in one piece; remove copies")]
    KnotMultiplicity {
        /// The knot.
        value: f64,
        /// Number of copies.
        count: usize,
    },
}

/// One polynomial piece: `c[0] + x c[1] + x^2 c[2] + x^3 c[3]`, `x` in 0..=1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CubicSpan {
    pub(crate) c: [DVec2; 4],
}

impl CubicSpan {
    pub(crate) fn point(&self, x: f64) -> DVec2 {
        self.c[0] + x * (self.c[1] + x * (self.c[2] + x * self.c[3]))
    }

    pub(crate) fn d1(&self, x: f64) -> DVec2 {
        self.c[1] + x * (2.0 * self.c[2] + 3.0 * x * self.c[3])
    }

    pub(crate) fn d2(&self, x: f64) -> DVec2 {
        2.0 * self.c[2] + 6.0 * x * self.c[3]
    }

    pub(crate) fn d3(&self) -> DVec2 {
        6.0 * self.c[3]
    }
}

impl BSpline {
    /// Curve with knots 0 (four times), `i / (n - 3)`, 1 (four times) over the `n >= 4` points of `control`.
    ///
    /// # Errors
    /// [`BSplineError::TooFew`], [`BSplineError::NotFinite`].
    ///
    /// ```
    /// use belvedere_core::{DVec2, bspline::BSpline};
    /// let arch = BSpline::clamped_uniform(vec![
    ///     DVec2::new(0.0, 0.0), DVec2::new(0.0, 1.0), DVec2::new(1.0, 1.0), DVec2::new(1.0, 0.0),
    /// ])?;
    /// assert_eq!(arch.point(0.5), DVec2::new(0.5, 0.75));
    /// # Ok::<(), belvedere_core::bspline::BSplineError>(())
    /// ```
    pub fn clamped_uniform(control: Vec<DVec2>) -> Result<Self, BSplineError> {
        check_control(&control)?;
        let spans = control.len() - DEGREE;
        let inner = (1..spans).map(|i| i as f64 / spans as f64);
        let knots = [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect();
        Ok(Self { control, knots })
    }

    /// Curve with given knots: `control.len() + 4` of them, ascending, the first four equal and the last four equal.
    /// Any range; it is mapped to 0..=1, which does not change the curve.
    ///
    /// # Errors
    /// Every [`BSplineError`].
    pub fn with_knots(control: Vec<DVec2>, knots: Vec<f64>) -> Result<Self, BSplineError> {
        check_control(&control)?;
        let (given, n) = (knots.len(), control.len());
        if given != n + DEGREE + 1 {
            return Err(BSplineError::KnotCount { given, control: n, needed: n + DEGREE + 1 });
        }
        if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
            return Err(BSplineError::NotFinite { what: "knot", index });
        }
        if let Some(i) = (1..given).find(|&i| knots[i] < knots[i - 1]) {
            return Err(BSplineError::KnotOrder { index: i, value: knots[i], before: knots[i - 1] });
        }
        let (first, last) = (knots[0], knots[given - 1]);
        let range = last - first;
        if !(range > 0.0 && range.is_finite()) || knots[DEGREE] > first || knots[given - 1 - DEGREE] < last {
            return Err(BSplineError::NotClamped { first, last });
        }
        let knots: Vec<f64> = knots.iter().map(|k| (k - first) / range).collect();
        for &value in &knots[4..given - 4] {
            let count = knots.iter().filter(|&&k| (k - value).abs() <= SAME_KNOT).count();
            if count > DEGREE {
                return Err(BSplineError::KnotMultiplicity { value: first + value * range, count });
            }
        }
        Ok(Self { control, knots })
    }

    /// Control points, first to last.
    pub fn control(&self) -> &[DVec2] {
        &self.control
    }

    /// Knots, ascending, from 0 to 1.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Point at parameter `t`, clamped to 0..=1.
    pub fn point(&self, t: f64) -> DVec2 {
        self.derivative(0, t)
    }

    /// Derivative of `order` 0..=3 with respect to `t` (clamped to 0..=1), by hodographs; right-sided at knots, left-sided at 1.
    /// Zero for higher orders.
    pub fn derivative(&self, order: usize, t: f64) -> DVec2 {
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        self.derivative_in_span(self.span_of(t), order, t)
    }

    /// Index `k` of the non-empty knot interval with `knots[k] <= t < knots[k + 1]`; the last one at `t = 1`.
    fn span_of(&self, t: f64) -> usize {
        let k = self.knots.partition_point(|&k| k <= t).min(self.control.len());
        // Only at t = 1 may interval k - 1 be empty.
        (DEGREE..k).rev().find(|&i| self.knots[i] < self.knots[i + 1]).unwrap_or(DEGREE)
    }

    fn derivative_in_span(&self, k: usize, order: usize, t: f64) -> DVec2 {
        if order > DEGREE {
            return DVec2::ZERO;
        }
        let knots = &self.knots;
        let mut d = [DVec2::ZERO; DEGREE + 1];
        d.copy_from_slice(&self.control[k - DEGREE..=k]);
        for r in 1..=order {
            for j in 0..=DEGREE - r {
                let i = k - DEGREE + j;
                d[j] = (DEGREE + 1 - r) as f64 * (d[j + 1] - d[j]) / (knots[i + DEGREE + 1] - knots[i + r]);
            }
        }
        let q = DEGREE - order;
        for s in 1..=q {
            for j in (s..=q).rev() {
                let i = k - q + j;
                let alpha = (t - knots[i]) / (knots[i + q + 1 - s] - knots[i]);
                d[j] = (1.0 - alpha) * d[j - 1] + alpha * d[j];
            }
        }
        d[q]
    }

    /// The same curve with one more knot at `t` (Boehm's knot insertion): one more control point, shape unchanged.
    /// Returned as it is for `t` outside (0, 1) and where the knot already has three copies.
    pub fn with_knot_inserted(&self, t: f64) -> Self {
        let copies = self.knots.iter().filter(|&&k| (k - t).abs() <= SAME_KNOT).count();
        if !(t > 0.0 && t < 1.0) || copies >= DEGREE {
            return self.clone();
        }
        let k = self.span_of(t);
        let control = (0..=self.control.len())
            .map(|i| {
                if i + DEGREE <= k {
                    self.control[i]
                } else if i > k {
                    self.control[i - 1]
                } else {
                    let alpha = (t - self.knots[i]) / (self.knots[i + DEGREE] - self.knots[i]);
                    alpha * self.control[i] + (1.0 - alpha) * self.control[i - 1]
                }
            })
            .collect();
        let mut knots = self.knots.clone();
        knots.insert(k + 1, t);
        Self { control, knots }
    }

    /// Both curves over the union of their knots: the same number of control points, shapes unchanged.
    pub fn unified(a: &Self, b: &Self) -> (Self, Self) {
        let (mut a1, mut b1) = (a.clone(), b.clone());
        for t in missing_knots(&a.knots, &b.knots) {
            a1 = a1.with_knot_inserted(t);
        }
        for t in missing_knots(&b.knots, &a.knots) {
            b1 = b1.with_knot_inserted(t);
        }
        (a1, b1)
    }

    /// Curve between `a` (`sigma` = 0) and `b` (`sigma` = 1): control points and knots interpolated linearly after [`BSpline::unified`].
    pub fn lerp(a: &Self, b: &Self, sigma: f64) -> Self {
        let (a, b) = Self::unified(a, b);
        let control = a.control.iter().zip(&b.control).map(|(&p, &q)| p.lerp(q, sigma)).collect();
        let knots = a.knots.iter().zip(&b.knots).map(|(p, q)| p + sigma * (q - p)).collect();
        Self { control, knots }
    }

    /// Polynomial pieces in order.
    pub(crate) fn spans(&self) -> Vec<CubicSpan> {
        (DEGREE..self.control.len())
            .filter(|&k| self.knots[k] < self.knots[k + 1])
            .map(|k| {
                let (t, w) = (self.knots[k], self.knots[k + 1] - self.knots[k]);
                let d = |order| self.derivative_in_span(k, order, t);
                CubicSpan { c: [d(0), d(1) * w, d(2) * (w * w / 2.0), d(3) * (w * w * w / 6.0)] }
            })
            .collect()
    }
}

fn check_control(control: &[DVec2]) -> Result<(), BSplineError> {
    if control.len() <= DEGREE {
        return Err(BSplineError::TooFew { count: control.len() });
    }
    match control.iter().position(|p| !p.is_finite()) {
        Some(index) => Err(BSplineError::NotFinite { what: "control point", index }),
        None => Ok(()),
    }
}

/// Inner knots of `wanted` that `present` lacks, with multiplicity.
fn missing_knots(present: &[f64], wanted: &[f64]) -> Vec<f64> {
    let (mut i, mut missing) = (4, Vec::new());
    for &t in &wanted[4..wanted.len() - 4] {
        while present[i] < t - SAME_KNOT {
            i += 1;
        }
        if (present[i] - t).abs() <= SAME_KNOT && i < present.len() - 4 {
            i += 1;
        } else {
            missing.push(t);
        }
    }
    missing
}
