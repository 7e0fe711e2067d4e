//! The stages of a view prepared for a frame, so that millions of points pass quickly.
//!
//! Everything that is drawn goes through here, points in rows and single ones alike, by the same arithmetic in the same
//! order: two pieces of a surface that share a point place it alike to the last bit.

use crate::Fast;
use crate::pass::points::{Points, each};
use crate::pass::spline_table::SplineTable;
use crate::pass::way::Way;
use belvedere_core::map::curved_rays::{StraightMap, Turn};
use belvedere_core::{CurvedRays, DVec3, Stage, View};

/// All stages of a view for one pass over the scene.
#[derive(Debug)]
pub(super) struct Displacer<'a> {
    steps: Vec<Step<'a>>,
}

#[derive(Debug)]
enum Step<'a> {
    /// A stage without a faster form.
    Stage(&'a Stage),
    Spline(SplineTable<'a>),
    /// A record of curved rays with conic arcs; the first one leaves points before the turn alone.
    Conic {
        turn: &'a Turn,
        m: f64,
        eye: DVec3,
        first: bool,
    },
    /// A straight part of curved rays.
    Straight {
        map: StraightMap,
        eye: DVec3,
    },
    /// A record of curved rays of another model.
    Record {
        rays: &'a CurvedRays,
        record: usize,
    },
    /// Records that displace as one map, each point by its own: one step per record, from the given one on.
    Chain {
        rays: &'a CurvedRays,
        first: usize,
        steps: Vec<Step<'a>>,
    },
}

impl<'a> Step<'a> {
    fn record(rays: &'a CurvedRays, record: usize) -> Self {
        match rays.turns().get(record).map(|turn| (turn, turn.m)) {
            Some((turn, Some(m))) => Self::Conic { turn, m, eye: rays.root().eye, first: record == 0 },
            _ => Self::Record { rays, record },
        }
    }

    fn row(&self, p: &mut Points<'_>) -> bool {
        match self {
            Step::Stage(stage) => each(p, |p| stage.apply(p).ok()),
            Step::Spline(table) => table.row(p),
            Step::Conic { turn, m, eye, first } => conic(turn, *m, *eye, *first, p),
            Step::Straight { map, eye } => each(p, |p| Some(*eye + map.linear * (p - map.viewpoint))),
            Step::Record { rays, record } => each(p, |p| rays.displace_in(*record, p).ok().map(|d| d.point)),
            Step::Chain { rays, first, steps } => {
                let of = |p: &Points<'_>, i: usize| {
                    rays.record_of(*first..=first + steps.len() - 1, DVec3::new(p.x[i], p.y[i], p.z[i])) - first
                };
                let (mut from, mut whole) = (0, true);
                while from < p.x.len() {
                    let record = of(p, from);
                    let to = (from + 1..p.x.len()).find(|&i| of(p, i) != record).unwrap_or(p.x.len());
                    let part = from..to;
                    let (x, y, z) = (&mut p.x[part.clone()], &mut p.y[part.clone()], &mut p.z[part]);
                    whole &= steps[record].row(&mut Points { x, y, z });
                    from = to;
                }
                whole
            }
        }
    }
}

impl<'a> Displacer<'a> {
    pub(super) fn new(view: &'a View, way: Way) -> Self {
        let step = |stage: &'a Stage| match Fast::of(stage) {
            Fast::Spline(bend) => Step::Spline(SplineTable::new(bend)),
            Fast::Rays(rays) => match way {
                Way::Records([first, last]) if first == last => Step::record(rays, first),
                Way::Records([first, last]) => {
                    let steps = (first..=last).map(|record| Step::record(rays, record)).collect();
                    Step::Chain { rays, first, steps }
                }
                Way::Segment(number) => match rays.straight_map(number) {
                    Some(map) => Step::Straight { map, eye: rays.root().eye },
                    None => Step::record(rays, number as usize / 2),
                },
            },
            Fast::Earth(_) | Fast::Ground(_) | Fast::Circle(_) | Fast::None => Step::Stage(stage),
        };
        Self { steps: view.stages().iter().map(step).collect() }
    }

    /// Whether nothing is displaced.
    pub(super) fn is_straight(&self) -> bool {
        self.steps.is_empty()
    }

    /// Displaced position; `None` where the point has no image.
    pub(super) fn point(&self, p: DVec3) -> Option<DVec3> {
        let (mut x, mut y, mut z) = ([p.x], [p.y], [p.z]);
        let known = self.row(&mut Points { x: &mut x, y: &mut y, z: &mut z });
        let p = DVec3::new(x[0], y[0], z[0]);
        (known && p.is_finite()).then_some(p)
    }

    /// Displaces points of slices of equal length; `false` if one of them has no image (the rest is then unspecified).
    /// A point that overflows comes out as not finite.
    pub(super) fn row(&self, p: &mut Points<'_>) -> bool {
        self.steps.iter().all(|step| step.row(p))
    }
}

/// `X' = eye + before (X - C') + phi(a, b) shift`, the first record `X' = X + phi shift`; phi is `max(0, a - b)` outside the wedge.
/// Without branches, so that several points are computed at once, unless all of them lie on one side.
fn conic(turn: &Turn, m: f64, eye: DVec3, first: bool, points: &mut Points<'_>) -> bool {
    let n = points.x.len();
    let (xs, ys, zs) = (&mut points.x[..n], &mut points.y[..n], &mut points.z[..n]);
    let [mut before, mut after] = [true; 2];
    for i in 0..n {
        let p = DVec3::new(xs[i], ys[i], zs[i]);
        let (a, b) = (turn.a.at(p), turn.b.at(p));
        before &= (a <= 0.0) & (a <= b);
        after &= (b <= 0.0) & (a > b);
    }
    if before && first {
        return true;
    }
    if before || after {
        for i in 0..n {
            let p = DVec3::new(xs[i], ys[i], zs[i]);
            let phi = if after { turn.h.at(p) } else { 0.0 };
            let base = if first { p } else { eye + turn.before * (p - turn.viewpoint_before) };
            let q = base + phi * turn.shift;
            (xs[i], ys[i], zs[i]) = (q.x, q.y, q.z);
        }
        return true;
    }
    for i in 0..n {
        let p = DVec3::new(xs[i], ys[i], zs[i]);
        let (a, b) = (turn.a.at(p), turn.b.at(p));
        let wedge = wedge_phi(m, a, b);
        let outside = if a > b { turn.h.at(p) } else { 0.0 };
        let phi = if (a > 0.0) & (b > 0.0) { wedge } else { outside };
        let base = if first { p } else { eye + turn.before * (p - turn.viewpoint_before) };
        let q = base + phi * turn.shift;
        (xs[i], ys[i], zs[i]) = (q.x, q.y, q.z);
    }
    true
}

/// phi of the modified model between the planes: `a = phi + m q`, `b = psi + m q`, `q = sqrt(phi psi)`; sums of positive
/// terms, scaled by `a + b`, so that nothing cancels near the planes. Anything outside.
#[inline]
fn wedge_phi(m: f64, a: f64, b: f64) -> f64 {
    let c = a + b;
    let (a, b) = (a / c, b / c);
    let ab = a * b;
    let difference = m * (a - b);
    let q = 2.0 * ab / (m + (difference * difference + 4.0 * ab).sqrt());
    let large = a.max(b) - m * q;
    let small = q * q / large;
    c * if a > b { large } else { small }
}

#[cfg(test)]
mod tests;
