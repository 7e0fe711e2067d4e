//! Points that stand for the surface of a target.

use belvedere_core::{Aabb, DVec3};
use belvedere_scene::BoxShape;
use std::collections::BTreeMap;

/// Points per edge of a cube, and most on a box: long ones have them along their length.
const LATTICE: usize = 3;
const MOST_POINTS: usize = 30;
/// Edges of a smaller share of the longest are short.
const SHORT: f64 = 0.45;
/// Steps along the edges of large triangles, at most.
const EDGE_STEPS: usize = 8;
/// Factor by which points lie nearer to the middle than the surface: the target may stand on something.
const INSIDE: f64 = 0.96;

/// Points along the edges of a box, about evenly far apart: at least 2, or 3 on edges that are not much shorter than the longest.
fn counts(size: DVec3) -> [usize; 3] {
    let cube = [LATTICE; 3];
    let longest = size.max_element();
    if !(longest > 0.0 && longest.is_finite()) {
        return cube;
    }
    let shares = (size / longest).to_array();
    let along = |steps: usize| {
        shares.map(|share| (1 + (steps as f64 * share) as usize).max(if share < SHORT { LATTICE - 1 } else { LATTICE }))
    };
    let inside = |n: [usize; 3]| n.map(|n| n - 2).into_iter().product::<usize>();
    let on_surface = |n: [usize; 3]| n.into_iter().product::<usize>() - inside(n);
    (LATTICE - 1..MOST_POINTS).map(along).take_while(|n| on_surface(*n) <= MOST_POINTS).last().unwrap_or(cube)
}

/// Points on the surface of a box about 0.
fn lattice(size: DVec3) -> impl Iterator<Item = DVec3> {
    let counts = counts(size);
    let [nx, ny, nz] = counts;
    let all = (0..nx * ny * nz).map(move |i| [i % nx, i / nx % ny, i / nx / ny]);
    let on_surface = all.filter(move |at| at.iter().zip(counts).any(|(i, n)| *i == 0 || *i == n - 1));
    let share = move |i: usize, n: usize| (i as f64 / (n - 1) as f64 - 0.5) * INSIDE;
    on_surface.map(move |[x, y, z]| DVec3::new(share(x, nx), share(y, ny), share(z, nz)) * size)
}

/// Points on the surface of a box along the axes.
pub(super) fn on_bounds(bounds: Aabb) -> Vec<DVec3> {
    lattice(bounds.max - bounds.min).map(|p| bounds.center() + p).collect()
}

/// Points on the surfaces of boxes, each as it is turned.
pub(super) fn on_boxes(boxes: &[BoxShape]) -> Vec<DVec3> {
    let points = boxes.iter().flat_map(|shape| {
        let (sin, cos) = shape.yaw.sin_cos();
        lattice(shape.size).map(move |own| {
            let up = own.z + 0.5 * shape.size.z;
            shape.base + DVec3::new(cos * own.x - sin * own.y, sin * own.x + cos * own.y, up)
        })
    });
    let points: Vec<DVec3> = points.collect();
    if boxes.len() > 1 { spread(&points) } else { points }
}

/// Points on triangles.
pub(super) fn on_triangles(triangles: impl Iterator<Item = [DVec3; 3]> + Clone) -> Vec<DVec3> {
    let bounds = Aabb::of(triangles.clone().flatten());
    let longest = (bounds.max - bounds.min).max_element();
    let step = longest / counts(bounds.max - bounds.min).into_iter().max().unwrap_or(LATTICE) as f64;
    let mut points = Vec::new();
    for [a, b, c] in triangles {
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let n = if step > 0.0 { ((longest / step).ceil() as usize).clamp(1, EDGE_STEPS) } else { 1 };
        for (i, j) in (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))) {
            points.push(a + (b - a) * (i as f64 / n as f64) + (c - a) * (j as f64 / n as f64));
        }
    }
    let middle = bounds.center();
    spread(&points).into_iter().map(|p| middle + INSIDE * (p - middle)).collect()
}

/// One of the points in each cell of a coarse lattice over their bounds: the one farthest from the middle.
fn spread(points: &[DVec3]) -> Vec<DVec3> {
    let bounds = Aabb::of(points.iter().copied());
    let size = (bounds.max - bounds.min).max(DVec3::splat(f64::MIN_POSITIVE));
    let off = |p: &DVec3| ((*p - bounds.center()) / size).length_squared();
    let counts = counts(bounds.max - bounds.min);
    let mut cells: BTreeMap<[usize; 3], DVec3> = BTreeMap::new();
    for p in points {
        let cell = ((*p - bounds.min) / size).to_array();
        let cell = [0, 1, 2].map(|i| ((cell[i] * counts[i] as f64) as usize).min(counts[i] - 1));
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
        assert!((20..=MOST_POINTS).contains(&points.len()), "{}", points.len());
        // No two neighbours along its length are farther apart than its height.
        let mut along: Vec<f64> = points
            .iter()
            .map(|p| (*p - turned.base).dot(DVec3::new(turned.yaw.cos(), turned.yaw.sin(), 0.0)))
            .collect();
        along.sort_by(f64::total_cmp);
        assert!(along.windows(2).all(|pair| pair[1] - pair[0] < 2.0), "{along:?}");
        assert_eq!(on_bounds(Aabb { min: DVec3::ZERO, max: DVec3::ONE }).len(), 26);
        for p in &points {
            let d = *p - turned.base;
            let across = turned.yaw.cos() * d.y - turned.yaw.sin() * d.x;
            assert!(across.abs() <= 0.5 && (0.0..=2.0).contains(&d.z), "{p}");
        }
        assert!(on_boxes(&vec![turned; 40]).len() <= 2 * MOST_POINTS);
        // One triangle across its bounds: nothing on the other side of the diagonal.
        let [a, b, c] = [DVec3::ZERO, DVec3::new(9.0, 0.0, 0.0), DVec3::new(0.0, 9.0, 0.0)];
        let points = on_triangles([[a, b, c]].into_iter());
        assert!(points.len() >= 5 && points.iter().all(|p| p.x + p.y <= 9.2), "{points:?}");
    }
}
