//! Traces rows of pixels together: free space that is proved for a group of rays is skipped by each of them.

use crate::trace::curve::{Curve, Span};
use crate::trace::row::Row;
use crate::trace::tracer::{RayHit, Tracer, nearer};
use belvedere_core::{Aabb, DVec2, DVec3};

/// Number of pixels traced together.
const GROUP: usize = 8;
/// Largest number of halvings of a part of the rays.
const MAX_HALVINGS: u32 = 16;
/// Parts shorter than this many cells of the ground are traced ray by ray.
const CELLS: f64 = 3.0;

/// Rays of one image row.
pub struct RowRays<'t, 'a> {
    tracer: &'t Tracer<'a>,
    row: Option<Row<'a>>,
    y: f64,
    /// Number of the sample of a pixel.
    sample: usize,
    /// The same rays in the space of the rigid bodies.
    bodies: Option<Box<RowRays<'t, 'a>>>,
}

impl<'t, 'a> RowRays<'t, 'a> {
    /// * `y`: of the row, pixels; `sample`: number of the sample of every pixel.
    pub fn new(tracer: &'t Tracer<'a>, y: f64, sample: usize) -> Self {
        let bodies = tracer.bodies.as_ref().map(|bodies| Box::new(RowRays::new(bodies, y, sample)));
        Self { tracer, row: tracer.split.row(y, tracer.range), y, sample, bodies }
    }

    fn curve(&self, x: f64) -> Curve<'_, 'a> {
        self.tracer.split.curve(DVec2::new(x, self.y), self.row.as_ref())
    }

    /// First hit of one ray.
    pub fn first_hit(&self, x: f64) -> Option<RayHit> {
        let bodies = self.bodies.as_ref().and_then(|bodies| bodies.first_hit(x));
        nearer(self.hit_from(x, self.tracer.range[0]), bodies)
    }

    fn hit_from(&self, x: f64, start: f64) -> Option<RayHit> {
        let threshold = self.tracer.threshold(self.sample, DVec2::new(x, self.y));
        self.tracer.hit_on(&self.curve(x), start, threshold)
    }

    /// First hits of the rays at `x` = 0.5, 1.5 ..
    pub fn first_hits(&self, out: &mut [Option<RayHit>]) {
        for (i, group) in out.chunks_mut(GROUP).enumerate() {
            let x = |k: usize| (i * GROUP + k) as f64 + 0.5;
            let start = self.clear_until(x(0), x(group.len() - 1));
            for (k, out) in group.iter_mut().enumerate() {
                *out = if start < self.tracer.range[1] { self.hit_from(x(k), start) } else { None };
            }
        }
        if let Some(bodies) = &self.bodies {
            let mut others = vec![None; out.len()];
            bodies.first_hits(&mut others);
            out.iter_mut().zip(others).for_each(|(out, other)| *out = nearer(*out, other));
        }
    }

    /// Depth up to which the rays from `x0` to `x1` hit nothing.
    fn clear_until(&self, x0: f64, x1: f64) -> f64 {
        let range = self.tracer.range;
        if !self.tracer.split.rows_are_straight() {
            return range[0];
        }
        let (a, b) = (self.curve(x0), self.curve(x1));
        let cell = CELLS * self.tracer.cell();
        let beam = Beam { tracer: self.tracer, sides: [&a, &b], cell };
        let (left, right) = (a.spans(range), b.spans(range));
        if left.len() != right.len() {
            return range[0];
        }
        left.iter().zip(&right).find_map(|(a, b)| beam.blocked(a, b, 0)).unwrap_or(range[1])
    }
}

/// All rays of a row between two of them.
struct Beam<'b, 'a> {
    tracer: &'b Tracer<'a>,
    sides: [&'b Curve<'b, 'a>; 2],
    cell: f64,
}

impl Beam<'_, '_> {
    /// Depth at which the first part begins where a hit is possible.
    fn blocked(&self, a: &Span, b: &Span, halvings: u32) -> Option<f64> {
        let stop = Some(a.depth[0]);
        let (Some((a0, a1)), Some((b0, b1))) = (a.chord(), b.chord()) else { return stop };
        let reach = a.reach.max(b.reach);
        if reach.is_finite() {
            let sag = self.tracer.split.sag(a0, b0).max(self.tracer.split.sag(a1, b1));
            let tight = Aabb::of([a0, a1, b0, b1]);
            let room = Aabb { min: tight.min - reach - sag * DVec3::Z, max: tight.max + reach };
            if self.tracer.is_empty(&room) {
                return None;
            }
        }
        if halvings >= MAX_HALVINGS || (a1 - a0).truncate().length() <= self.cell {
            return stop;
        }
        let (left, right) = (self.sides[0].halves(a), self.sides[1].halves(b));
        if left.len() != right.len() || left.is_empty() {
            return stop;
        }
        left.iter().zip(&right).find_map(|(a, b)| self.blocked(a, b, halvings + 1))
    }
}
