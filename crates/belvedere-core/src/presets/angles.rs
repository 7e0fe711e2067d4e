//! Curves given by their slope angles at arc lengths.

use crate::bspline::{BSpline, BSplineError};
use crate::deformation::DeformationCurve;
use glam::DVec2;

/// Largest turn of one piece, radians, which keeps the error of an arc below 1e-7 of its length.
const MOST_TURN: f64 = 0.15;
/// Most pieces of a curve.
const MOST_PIECES: f64 = 200.0;

/// The curve from (0, 0) whose slope runs through the knots `[arc length, degrees]`, linearly between them: straight parts and arcs.
///
/// Arc lengths rise from 0, curve units. Source: our specification of spline bends, section 11.7; the arcs as cubic pieces with common
/// tangents, whose parameter is the arc length to the same accuracy.
pub(super) fn curve(angles: &[[f64; 2]]) -> Result<BSpline, BSplineError> {
    let mut ends = vec![(0.0, DVec2::ZERO, slope_at(angles, 0.0))];
    for pair in angles.windows(2) {
        let ([from, a], [to, b]) = (pair[0], pair[1]);
        let turn = (b - a).to_radians().abs();
        let pieces = (turn / MOST_TURN).ceil().clamp(1.0, MOST_PIECES);
        for k in 1..=pieces as usize {
            let l = from + (to - from) * k as f64 / pieces;
            let &(before, start, slope) = &ends[ends.len() - 1];
            let next = slope_at(angles, l);
            let half = 0.5 * (next - slope);
            // The chord of an arc.
            let chord = (l - before) * if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
            ends.push((l, start + chord * DVec2::from_angle(0.5 * (slope + next)), next));
        }
    }
    let length = ends[ends.len() - 1].0;
    let (first, last) = (ends[0], ends[ends.len() - 1]);
    let mut control = vec![first.1];
    let mut knots = vec![0.0; 4];
    for pair in ends.windows(2) {
        let third = (pair[1].0 - pair[0].0) / 3.0;
        control.push(pair[0].1 + third * DVec2::from_angle(pair[0].2));
        control.push(pair[1].1 - third * DVec2::from_angle(pair[1].2));
        knots.extend([pair[1].0 / length; 2]);
    }
    control.push(last.1);
    knots.truncate(knots.len() - 2);
    knots.extend([1.0; 4]);
    BSpline::with_knots(control, knots)
}

/// Slope at an arc length, radians.
fn slope_at(angles: &[[f64; 2]], l: f64) -> f64 {
    let next = angles.partition_point(|knot| knot[0] <= l).clamp(1, angles.len().max(2) - 1);
    let (Some([l0, a]), Some([l1, b])) = (angles.get(next - 1), angles.get(next)) else { return 0.0 };
    let share = ((l - l0) / (l1 - l0)).clamp(0.0, 1.0);
    (a + share * (b - a)).to_radians()
}

/// Angles of two curves, interpolated at equal shares of their lengths: `sigma` 0 = `a`, 1 = `b`.
pub(super) fn between(a: &[[f64; 2]], b: &[[f64; 2]], sigma: f64) -> Vec<[f64; 2]> {
    let length = |angles: &[[f64; 2]]| angles.last().map_or(1.0, |knot| knot[0]);
    let (of_a, of_b) = (length(a), length(b));
    let mut shares: Vec<f64> = a.iter().map(|k| k[0] / of_a).chain(b.iter().map(|k| k[0] / of_b)).collect();
    shares.sort_by(f64::total_cmp);
    shares.dedup_by(|next, before| *next - *before < 1e-9);
    let mix = |p: f64, q: f64| p + sigma * (q - p);
    let knot = |t: f64| {
        let slope = mix(slope_at(a, t * of_a), slope_at(b, t * of_b));
        [t * mix(of_a, of_b), slope.to_degrees()]
    };
    shares.into_iter().map(knot).collect()
}

/// The angles of a curve at `count` evenly spaced arc lengths, degrees.
pub(super) fn of_curve(spline: &BSpline, count: usize) -> Option<Vec<[f64; 2]>> {
    let curve = DeformationCurve::new(spline).ok()?;
    let last = count.max(2) - 1;
    let mut before: Option<f64> = None;
    let knots = (0..=last).map(|k| {
        let l = curve.length() * k as f64 / last as f64;
        let tangent = curve.at(l).1;
        let angle = tangent.to_angle().to_degrees();
        // Unwrapped, so that the angle may exceed half a turn.
        let angle = before.map_or(angle, |before| angle - 360.0 * ((angle - before) / 360.0).round());
        before = Some(angle);
        [l, angle]
    });
    Some(knots.collect())
}
