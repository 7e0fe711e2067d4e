//! Points that stand for the surface of a target.

use belvedere_core::{Aabb, DVec3};
use belvedere_scene::BoxShape;
use std::collections::BTreeMap;

/// Points per edge of a box.
const LATTICE: usize = 3;
/// Steps along the edges of large triangles, at most.
const STEPS: usize = 8;
/// Points are a little inside: what they stand for may stand on something.
const INSIDE: f64 = 0.96;

/// Corners, middles of edges and faces of a unit box about 0.
fn lattice() -> impl Iterator<Item = DVec3> {
    let at = |i: usize| (i as f64 / (LATTICE - 1) as f64 - 0.5) * INSIDE;
    let all = (0..LATTICE.pow(3))
        .map(move |i| DVec3::new(at(i % LATTICE), at(i / LATTICE % LATTICE), at(i / LATTICE / LATTICE)));
    all.filter(|p| *p != DVec3::ZERO)
}

/// On a box along the axes.
pub(super) fn on_bounds(bounds: Aabb) -> Vec<DVec3> {
    lattice().map(|p| bounds.center() + p * (bounds.max - bounds.min)).collect()
}

/// On boxes, each as it is turned.
pub(super) fn on_boxes(boxes: &[BoxShape]) -> Vec<DVec3> {
    let points = boxes.iter().flat_map(|shape| {
        let (sin, cos) = shape.yaw.sin_cos();
        lattice().map(move |p| {
            let own = p * shape.size;
            let up = own.z + 0.5 * shape.size.z;
            shape.base + DVec3::new(cos * own.x - sin * own.y, sin * own.x + cos * own.y, up)
        })
    });
    let points: Vec<DVec3> = points.collect();
    if boxes.len() > 1 { spread(&points) } else { points }
}

/// On triangles.
pub(super) fn on_triangles(triangles: impl Iterator<Item = [DVec3; 3]> + Clone) -> Vec<DVec3> {
    let bounds = Aabb::of(triangles.clone().flatten());
    let step = (bounds.max - bounds.min).max_element() / LATTICE as f64;
    let mut points = Vec::new();
    for [a, b, c] in triangles {
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let n = if step > 0.0 { ((longest / step).ceil() as usize).clamp(1, STEPS) } else { 1 };
        for (i, j) in (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))) {
            points.push(a + (b - a) * (i as f64 / n as f64) + (c - a) * (j as f64 / n as f64));
        }
    }
    let middle = bounds.center();
    spread(&points).into_iter().map(|p| middle + INSIDE * (p - middle)).collect()
}

/// Of many points one in each cell of a coarse lattice, that farthest from the middle.
fn spread(points: &[DVec3]) -> Vec<DVec3> {
    let bounds = Aabb::of(points.iter().copied());
    let size = (bounds.max - bounds.min).max(DVec3::splat(f64::MIN_POSITIVE));
    let off = |p: &DVec3| ((*p - bounds.center()) / size).length_squared();
    let mut cells: BTreeMap<[usize; 3], DVec3> = BTreeMap::new();
    for p in points {
        let cell = ((*p - bounds.min) / size * LATTICE as f64).to_array().map(|v| (v as usize).min(LATTICE - 1));
        let kept = cells.entry(cell).or_insert(*p);
        if off(p) > off(kept) {
            *kept = *p;
        }
    }
    cells.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::Color;

    #[test]
    fn points_lie_on_turned_boxes_and_triangles_not_on_the_box_around_them() {
        let shape = |yaw| BoxShape {
            base: DVec3::new(5.0, 0.0, 1.0),
            size: DVec3::new(10.0, 1.0, 2.0),
            yaw,
            color: Color::rgb(0, 0, 0),
        };
        let turned = shape(0.7);
        let points = on_boxes(&[turned]);
        assert_eq!(points.len(), 26);
        for p in &points {
            let d = *p - turned.base;
            let across = turned.yaw.cos() * d.y - turned.yaw.sin() * d.x;
            assert!(across.abs() <= 0.5 && (0.0..=2.0).contains(&d.z), "{p}");
        }
        assert!(on_boxes(&vec![turned; 40]).len() <= 27);
        // One triangle across its bounds: nothing on the other side of the diagonal.
        let [a, b, c] = [DVec3::ZERO, DVec3::new(9.0, 0.0, 0.0), DVec3::new(0.0, 9.0, 0.0)];
        let points = on_triangles([[a, b, c]].into_iter());
        assert!(points.len() >= 5 && points.iter().all(|p| p.x + p.y <= 9.2), "{points:?}");
    }
}
