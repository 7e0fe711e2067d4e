//! The curved ray of a pixel as alternating straight and bent pieces.

use super::phi::{Hinge, ViewpointValues, c2_parameter, c2_profile};
use super::{CurvedRays, Turn};
use crate::Miss;
use crate::conic::{ConicArc, arc_length};
use glam::DVec3;

/// One piece of a ray, over a range of depths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayPiece {
    /// Segment of the ray, see [`crate::Displaced::segment`].
    pub segment: u32,
    /// First and last depth, scene units; the last piece ends at infinity.
    pub depth: [f64; 2],
    /// The curve.
    pub shape: Shape,
}

/// Curve of a [`RayPiece`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Straight.
    Line {
        /// Point at the first depth.
        from: DVec3,
        /// Change of the point per unit of depth.
        per_depth: DVec3,
    },
    /// A conic arc; of weight 1 in the original model.
    Conic(Bend<ConicArc>),
    /// The C2 model's rational quartic.
    C2(Bend<C2Arc>),
}

/// A bent piece: its curve and the depths of its control points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend<C> {
    /// The curve.
    pub curve: C,
    /// Depths at T (on t0), S (where the straight continuations meet, on t1) and Q (on t2), scene units.
    pub depths: [f64; 3],
}

/// Ray of the C2 model between t0 and t2, by pencil parameter s in 0..=1: `X = S + N(s) / W(s)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct C2Arc {
    /// Start, on t0.
    pub t: DVec3,
    /// Where the end tangents meet, on t1.
    pub s: DVec3,
    /// End, on t2.
    pub q: DVec3,
    values: ViewpointValues,
    sigma: f64,
    /// From S to the viewpoints before and after the turn.
    to_viewpoints: [DVec3; 2],
    /// Change of a(Y) and of b_far per unit of depth.
    rates: [f64; 2],
}

impl C2Arc {
    /// N, W, E and their derivatives at s.
    fn parts(&self, s: f64) -> [(DVec3, f64, f64); 2] {
        let v = &self.values;
        let [before, after] = self.to_viewpoints;
        let of = |g: f64, g_star: f64, one: f64| {
            let e = one + g * (v.a1 + v.b1) - g_star * (v.a0 + v.b0) / v.k0;
            let shift = 2.0 * self.sigma * (g_star / v.k0 * before - g * after);
            (shift, e - 2.0 * self.sigma * (g - g_star / v.k0), e)
        };
        let (g, slope) = c2_profile(s);
        [of(g, g - (2.0 * s - 1.0), 1.0), of(slope, slope - 2.0, 0.0)]
    }

    /// Point at pencil parameter `s` in 0..=1.
    pub fn point(&self, s: f64) -> DVec3 {
        let [(n, w, _), _] = self.parts(s);
        self.s + n / w
    }

    /// Derivative by `s`, scene units.
    pub fn derivative(&self, s: f64) -> DVec3 {
        let [(n, w, _), (dn, dw, _)] = self.parts(s);
        (dn - n * (dw / w)) / w
    }

    /// Depth at `s` as a multiple of the depth of S.
    fn stretch(&self, s: f64) -> f64 {
        let [(_, w, e), _] = self.parts(s);
        e / w
    }

    fn parameter(&self, depth: f64) -> f64 {
        let (alpha, b_far) = (self.values.a0 + depth * self.rates[0], self.values.b1 + depth * self.rates[1]);
        if alpha <= 0.0 {
            return 0.0;
        }
        if b_far <= 0.0 {
            return 1.0;
        }
        c2_parameter(&self.values, alpha, b_far).unwrap_or(0.5)
    }
}

impl Bend<ConicArc> {
    /// Parameter at a depth, from `(f_T - d) p^2 + 2 w u p (f_S - d) + (f_Q - d) u^2 = 0`; 0 or 1 outside the arc.
    pub fn parameter(&self, depth: f64) -> f64 {
        let [t, s, q] = self.depths.map(|d| d - depth);
        if t >= 0.0 {
            return 0.0;
        }
        if q <= 0.0 {
            return 1.0;
        }
        let half = self.curve.weight * s;
        let root = (half * half - t * q).sqrt();
        // v = u / p is the positive root of q v^2 + 2 half v + t.
        let (x, y) = if half > 0.0 { (-t, half + root) } else { (root - half, q) };
        x / (x + y)
    }

    /// Depth at parameter `u`.
    pub fn depth(&self, u: f64) -> f64 {
        let (p, w) = (1.0 - u, self.curve.weight);
        let [t, s, q] = self.depths;
        (p * p * t + 2.0 * w * u * p * s + u * u * q) / (p * p + 2.0 * w * u * p + u * u)
    }
}

impl Bend<C2Arc> {
    /// Parameter at a depth; 0 or 1 outside the arc.
    pub fn parameter(&self, depth: f64) -> f64 {
        self.curve.parameter(depth)
    }

    /// Depth at pencil parameter `s`.
    pub fn depth(&self, s: f64) -> f64 {
        self.depths[1] * self.curve.stretch(s)
    }
}

impl RayPiece {
    /// Point at a depth of the piece's range.
    pub fn at(&self, depth: f64) -> DVec3 {
        match &self.shape {
            Shape::Line { from, per_depth } => *from + (depth - self.depth[0]) * *per_depth,
            Shape::Conic(arc) => arc.curve.point(arc.parameter(depth)),
            Shape::C2(arc) => arc.curve.point(arc.parameter(depth)),
        }
    }

    /// Arc length from the beginning of the piece to a depth, which is clamped to its range; scene units.
    pub fn length_to(&self, depth: f64) -> f64 {
        let depth = depth.clamp(self.depth[0], self.depth[1]);
        match &self.shape {
            Shape::Line { per_depth, .. } => (depth - self.depth[0]) * per_depth.length(),
            Shape::Conic(arc) => arc_length(&|u| arc.curve.derivative(u).length(), 0.0, arc.parameter(depth)),
            Shape::C2(arc) => arc_length(&|s| arc.curve.derivative(s).length(), 0.0, arc.parameter(depth)),
        }
    }
}

impl Turn {
    /// The bent piece of the ray with displaced direction `v` per unit of depth; `None` for a kink.
    fn arc(&self, v: DVec3) -> Result<(Option<Shape>, [f64; 2]), Miss> {
        let (before, after) = (self.before_inverse * v, self.after_inverse * v);
        let values = &self.values;
        let s_depth = values.k0 / self.h.along(before);
        let t_depth = -values.a0 / self.a.along(before);
        let q_depth = -values.b1 / self.b.along(after);
        let ordered = 0.0 < t_depth && t_depth <= s_depth && s_depth <= q_depth && q_depth.is_finite();
        if self.hinge == Hinge::Broken {
            return if s_depth > 0.0 && s_depth.is_finite() {
                Ok((None, [s_depth; 2]))
            } else {
                Err(Miss::OutsideDomain)
            };
        }
        if !ordered {
            return Err(Miss::OutsideDomain);
        }
        let t = self.viewpoint_before + t_depth * before;
        let s = self.viewpoint_before + s_depth * before;
        let q = self.viewpoint + q_depth * after;
        let sigma = values.a0 + s_depth * self.a.along(before);
        let depths = [t_depth, s_depth, q_depth];
        let conic = |weight: f64| Shape::Conic(Bend { curve: ConicArc { t, s, q, weight }, depths });
        let shape = match self.hinge {
            Hinge::Conic { m } => conic(m / values.m_sigma(sigma).ok_or(Miss::OutsideDomain)?),
            Hinge::Bezier { sigma: [low, high] } if sigma < low || sigma > high => {
                let m = |sigma: f64| values.m_sigma(sigma).ok_or(Miss::OutsideDomain);
                conic(m(sigma.max(low).min(high))? / m(sigma)?)
            }
            Hinge::Bezier { .. } => conic(1.0),
            Hinge::C2 => {
                let to_viewpoints = [self.viewpoint_before - s, self.viewpoint - s];
                let rates = [self.a.along(before), self.b.along(after)];
                Shape::C2(Bend { curve: C2Arc { t, s, q, values: *values, sigma, to_viewpoints, rates }, depths })
            }
            Hinge::Broken => return Err(Miss::OutsideDomain),
        };
        Ok((Some(shape), [t_depth, q_depth]))
    }
}

impl CurvedRays {
    /// Pieces of the ray whose displaced points are `eye + depth * v`, from the eye to infinity.
    ///
    /// # Errors
    /// [`Miss::OutsideDomain`] if the ray lies so far outside the image that it does not pass all turns.
    pub(crate) fn pieces(&self, v: DVec3) -> Result<Vec<RayPiece>, Miss> {
        let mut pieces = Vec::with_capacity(2 * self.turns().len() + 1);
        let (mut begin, mut viewpoint, mut per_depth) = (0.0, self.root().eye, v);
        let mut segment = 0;
        for turn in self.turns() {
            let (shape, [t_depth, q_depth]) = turn.arc(v)?;
            if t_depth < begin {
                return Err(Miss::OutsideDomain);
            }
            let line = Shape::Line { from: viewpoint + begin * per_depth, per_depth };
            pieces.push(RayPiece { segment, depth: [begin, t_depth], shape: line });
            if let Some(shape) = shape {
                pieces.push(RayPiece { segment: segment + 1, depth: [t_depth, q_depth], shape });
            }
            (begin, viewpoint, per_depth) = (q_depth, turn.viewpoint, turn.after_inverse * v);
            segment += 2;
        }
        let line = Shape::Line { from: viewpoint + begin * per_depth, per_depth };
        pieces.push(RayPiece { segment, depth: [begin, f64::INFINITY], shape: line });
        Ok(pieces)
    }
}
