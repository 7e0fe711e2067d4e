//! What of the features the displaced ground shows, by a tracer that knows nothing of the solver's rows.

use super::super::qp::LinesOfSight;
use super::super::{Field, ReferencePoint};
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::{Ground, Heightfield, NodeState};
use rayon::prelude::*;

/// Lines of sight that lie this much under ground are not hidden: heights are stored as f32.
const TOUCH: f64 = 2e-3;

/// Visible share of points, and how deep the worst of them is hidden, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shown {
    pub(super) share: f64,
    pub(super) hidden: usize,
    pub(super) worst: f64,
}

/// The ground displaced at its nodes.
pub(super) fn displaced(field: &Field, delta: Option<&[f64]>) -> Option<Heightfield> {
    let at = |i: usize| field.heights()[i] + delta.map_or(0.0, |d| d[i]);
    let heights = (0..field.heights().len()).map(|i| at(i) as f32).collect();
    let states = field.void().iter().map(|v| if *v { NodeState::Void } else { NodeState::Measured }).collect();
    Heightfield::new(field.north_west(), field.spacing(), field.cols(), field.rows(), heights, states).ok()
}

/// Judges points on the displaced ground: the line of sight beyond `guard` cells from its point stays over the ground.
pub(super) fn shown(
    ground: &Heightfield,
    field: &Field,
    points: &[ReferencePoint],
    sight: &dyn LinesOfSight,
    guard: f64,
) -> Shown {
    let tracer = Ground::new(ground);
    let depth = |p: &ReferencePoint| {
        let at = ground.surface_at(field.scene_from_grid(p.grid))?;
        let mut line = Vec::new();
        sight.trace(p.grid, at + p.lift, &mut line);
        if line.len() < 2 {
            return Some(f64::INFINITY);
        }
        let place = |(g, z): (DVec2, f64)| field.scene_from_grid(g).extend(z);
        let mut least = f64::INFINITY;
        for pair in line.windows(2) {
            let Some(from) = beyond(p.grid, guard, pair[0], pair[1]) else { continue };
            let (a, b): (DVec3, DVec3) = (place(from), place(pair[1]));
            least = least.min(tracer.min_gap(a, b, 1.0, f64::NEG_INFINITY));
        }
        Some((-least).max(0.0))
    };
    let depths: Vec<f64> = points.par_iter().filter_map(depth).collect();
    let hidden = depths.iter().filter(|d| **d > TOUCH).count();
    let share = if depths.is_empty() { 1.0 } else { 1.0 - hidden as f64 / depths.len() as f64 };
    Shown { share, hidden, worst: depths.into_iter().filter(|d| d.is_finite()).fold(0.0, f64::max) }
}

/// The start of the part of a piece that lies beyond `guard` cells of `p`.
fn beyond(p: DVec2, guard: f64, a: (DVec2, f64), b: (DVec2, f64)) -> Option<(DVec2, f64)> {
    if a.0.distance(p) >= guard {
        return Some(a);
    }
    let (d, f) = (b.0 - a.0, a.0 - p);
    // |f + t d| = guard, the crossing outwards.
    let (aa, bb, cc) = (d.length_squared(), f.dot(d), f.length_squared() - guard * guard);
    let t = (-bb + (bb * bb - aa * cc).max(0.0).sqrt()) / aa;
    (t.is_finite() && t <= 1.0).then(|| (a.0 + t * d, a.1 + t * (b.1 - a.1)))
}
