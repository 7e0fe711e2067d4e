//! Whether the strip around a curve overlaps itself.

use super::StripError;
use super::curve::PlanCurve;
use glam::{DVec2, IVec2};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Longest straight end, in multiples of the curve's length plus the half width.
const FAR: f64 = 1e4;

/// First and last arc length between which the strip, with its straight ends, does not overlap itself.
///
/// A curve of curvature at most 1 / rho stays outside the circles of radius rho that touch it, for an arc length of pi rho to both sides
/// (Blaschke); so no point within `half_width` < rho of it has two feet that near together. Feet farther apart are excluded where points of
/// the curve that are farther apart along it are farther than two half widths from each other. The proof is in docs/algorithms/strip.md.
///
/// # Errors
/// [`StripError::Overlap`] if the curve itself comes too close; its straight ends are cut short instead.
pub(super) fn reach(curve: &PlanCurve, half_width: f64) -> Result<[f64; 2], StripError> {
    let apart = PI / curve.largest_curvature();
    // A point between nodes is at most half a spacing from one of them.
    let least = 2.0 * half_width + curve.spacing();
    if let Some((i, j, distance)) = closest(curve, least, apart) {
        let at = curve.origin() + 0.5 * (curve.nodes()[i].p + curve.nodes()[j].p);
        let widest = 0.5 * (distance - curve.spacing());
        return Err(StripError::Overlap { at, distance, half_width, widest: widest.max(0.0) });
    }
    let far = FAR * (curve.length() + half_width);
    let [before, beyond] = ends(curve).map(|end| end.clear_of(curve, least, apart).min(far));
    // With less than half a circle between them, the ends diverge or stay apart like the legs of a U.
    let meet = curve.length() > apart;
    let both = if meet { apart_by(ends(curve), [before, beyond], least) } else { f64::INFINITY };
    Ok([-before.min(both), curve.length() + beyond.min(both)])
}

/// Two nodes nearer than `least` that are more than `apart` along the curve from each other: the closest.
fn closest(curve: &PlanCurve, least: f64, apart: f64) -> Option<(usize, usize, f64)> {
    let nodes = curve.nodes();
    let gap = (apart / curve.spacing()).floor();
    if !(gap < nodes.len() as f64) {
        return None;
    }
    let gap = gap as usize;
    let cell = |p: DVec2| (p / least).floor().as_ivec2();
    let mut cells: HashMap<IVec2, Vec<usize>> = HashMap::new();
    nodes.iter().enumerate().for_each(|(i, node)| cells.entry(cell(node.p)).or_default().push(i));
    let mut best: Option<(usize, usize, f64)> = None;
    for (i, node) in nodes.iter().enumerate() {
        let home = cell(node.p);
        let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| home + IVec2::new(x, y)));
        for &j in around.filter_map(|c| cells.get(&c)).flatten().filter(|&&j| j > i + gap) {
            let distance = nodes[j].p.distance(node.p);
            if distance <= least && best.is_none_or(|b| distance < b.2) {
                best = Some((i, j, distance));
            }
        }
    }
    best
}

/// A straight end, from the curve outwards.
#[derive(Clone, Copy)]
struct End {
    from: DVec2,
    along: DVec2,
    /// Whether it is the one before the curve.
    first: bool,
}

fn ends(curve: &PlanCurve) -> [End; 2] {
    let (first, last) = (curve.nodes()[0], curve.nodes()[curve.nodes().len() - 1]);
    [End { from: first.p, along: -first.tangent, first: true }, End { from: last.p, along: last.tangent, first: false }]
}

impl End {
    /// Length up to which the end stays `least` away from nodes that are more than `apart` from it along the curve.
    fn clear_of(&self, curve: &PlanCurve, least: f64, apart: f64) -> f64 {
        let nodes = curve.nodes().iter().enumerate();
        let limits = nodes.filter_map(|(i, node)| {
            let g = i as f64 * curve.spacing();
            let way = if self.first { g } else { curve.length() - g };
            let v = node.p - self.from;
            let (along, off) = (v.dot(self.along), v.perp_dot(self.along).abs());
            let half = (off < least).then(|| (least * least - off * off).sqrt())?;
            let enters = (along - half).max(apart - way).max(0.0);
            (enters <= along + half).then_some(enters)
        });
        limits.fold(f64::INFINITY, f64::min)
    }
}

/// Length up to which both ends stay `least` apart, by bisection; at most the greater of the given lengths.
fn apart_by(ends: [End; 2], lengths: [f64; 2], least: f64) -> f64 {
    let near = |reach: f64| {
        let [a, b] = [0, 1].map(|k| (ends[k].from, ends[k].from + lengths[k].min(reach) * ends[k].along));
        between(a, b) <= least
    };
    let [mut low, mut high] = [0.0, lengths[0].max(lengths[1])];
    if !near(high) {
        return high;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if near(middle) { high = middle } else { low = middle }
    }
    low
}

/// Distance of two segments.
fn between(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> f64 {
    let (u, v) = (a.1 - a.0, b.1 - b.0);
    let side = |from: DVec2, along: DVec2, p: DVec2| along.perp_dot(p - from);
    let crossed = side(a.0, u, b.0) * side(a.0, u, b.1) < 0.0 && side(b.0, v, a.0) * side(b.0, v, a.1) < 0.0;
    if crossed {
        return 0.0;
    }
    let off = |p: DVec2, (from, to): (DVec2, DVec2)| {
        let along = to - from;
        let t =
            if along == DVec2::ZERO { 0.0 } else { ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
        p.distance(from + t * along)
    };
    [off(a.0, b), off(a.1, b), off(b.0, a), off(b.1, a)].into_iter().fold(f64::INFINITY, f64::min)
}
