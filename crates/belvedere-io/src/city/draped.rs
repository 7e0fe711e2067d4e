//! Plane pieces of ground over a grid of heights: cut along its facets, so that neighbouring pieces fit together.

use belvedere_scene::Heightfield;
use glam::{DVec2, DVec3};

/// The parts of a convex polygon over the facets of a field, each convex, turned as it is, at the heights of the field; parts
/// outside it are left out.
pub(super) fn draped(convex: &[DVec2], field: &Heightfield) -> Vec<Vec<DVec3>> {
    // Columns, rows, and the diagonals from north-west to south-east.
    let families: [fn(DVec2) -> f64; 3] = [|g| g.x, |g| g.y, |g| g.x - g.y];
    let mut pieces = vec![convex.to_vec()];
    for family in families {
        pieces = pieces.iter().flat_map(|piece| slices(piece, |p| family(field.grid_from_scene(p)))).collect();
        pieces.retain(|piece| piece.len() >= 3);
    }
    let lifted = |piece: Vec<DVec2>| piece.into_iter().map(|p| Some(p.extend(field.surface_at(p)?))).collect();
    pieces.into_iter().filter_map(lifted).collect()
}

/// A convex polygon, cut where a linear function is a whole number.
fn slices(convex: &[DVec2], of: impl Fn(DVec2) -> f64) -> Vec<Vec<DVec2>> {
    let [low, high] = convex.iter().map(|p| of(*p)).fold([f64::MAX, f64::MIN], |[a, b], v| [a.min(v), b.max(v)]);
    let mut rest = convex.to_vec();
    let mut out = Vec::new();
    for k in (low.floor() as i64 + 1)..(high.ceil() as i64) {
        out.push(side(&rest, |p| k as f64 - of(p)));
        rest = side(&rest, |p| of(p) - k as f64);
    }
    out.push(rest);
    out
}

/// The part of a convex polygon where a linear function is not negative.
fn side(convex: &[DVec2], of: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut out = Vec::with_capacity(convex.len() + 1);
    for (k, a) in convex.iter().enumerate() {
        let b = convex[(k + 1) % convex.len()];
        let [at_a, at_b] = [of(*a), of(b)];
        if at_a >= 0.0 {
            out.push(*a);
        }
        if (at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0) {
            // From the same end for both neighbours, so that they share the point.
            let (from, to, share) =
                if at_a < at_b { (*a, b, at_a / (at_a - at_b)) } else { (b, *a, at_b / (at_b - at_a)) };
            out.push(from.lerp(to, share));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_the_polygon_and_lie_on_the_field() {
        let heights = (0..7 * 6).map(|i| ((i * 37) % 11) as f32).collect();
        let field = Heightfield::measured(DVec2::new(-5.0, 45.0), DVec2::splat(10.0), 7, 6, heights).expect("a field");
        let triangle = [DVec2::new(-3.0, -2.0), DVec2::new(51.0, 7.5), DVec2::new(12.0, 41.0)];
        let doubled = |p: &[DVec2]| (2..p.len()).map(|k| (p[k - 1] - p[0]).perp_dot(p[k] - p[0])).sum::<f64>();
        let parts = draped(&triangle, &field);
        let mut area = 0.0;
        for part in &parts {
            let flat: Vec<DVec2> = part.iter().map(|p| p.truncate()).collect();
            assert!(doubled(&flat) > -1e-9, "turned");
            area += doubled(&flat);
            // Its middle lies on the field, so it lies in one facet.
            let middle = part.iter().sum::<DVec3>() / part.len() as f64;
            let z = field.surface_at(middle.truncate()).expect("in the field");
            assert!((z - middle.z).abs() < 1e-9, "{z} under {middle}");
        }
        assert!((area - doubled(&triangle)).abs() < 1e-9 && parts.len() > 20, "{area} in {}", parts.len());
    }
}
