//! Rings in plan: closed, whether the first point is repeated at the end or not.

use crate::DVec2;

/// x coordinates at which a ring crosses the line of constant `y`.
pub fn crossings(ring: &[DVec2], y: f64) -> impl Iterator<Item = f64> + '_ {
    let sides = (0..ring.len()).map(move |i| (ring[i], ring[(i + 1) % ring.len()]));
    sides.filter(move |(a, b)| (a.y > y) != (b.y > y)).map(move |(a, b)| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x))
}

/// Whether a point lies inside rings, holes among them, by the even-odd rule.
///
/// ```
/// use belvedere_core::{DVec2, polygon};
/// let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]].map(DVec2::from).to_vec();
/// assert!(polygon::is_inside([&square], DVec2::splat(4.0)) && !polygon::is_inside([&square], DVec2::splat(-4.0)));
/// ```
pub fn is_inside<R: AsRef<[DVec2]>>(rings: impl IntoIterator<Item = R>, p: DVec2) -> bool {
    let right_of = |ring: R| crossings(ring.as_ref(), p.y).filter(|x| p.x < *x).count();
    rings.into_iter().map(right_of).sum::<usize>() % 2 == 1
}

/// Twice the signed area of a ring; positive counter-clockwise.
pub fn doubled_area(ring: &[DVec2]) -> f64 {
    let origin = ring.first().copied().unwrap_or_default();
    (0..ring.len()).map(|k| (ring[k] - origin).perp_dot(ring[(k + 1) % ring.len()] - origin)).sum()
}

/// Vector from `p` to the nearest point of the segment `a b`.
#[inline]
pub fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    let d = b - a;
    let len2 = d.length_squared();
    let t = if len2 > 0.0 { ((p - a).dot(d) / len2).clamp(0.0, 1.0) } else { 0.0 };
    a + t * d - p
}
