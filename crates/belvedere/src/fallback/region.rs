//! The region of a cutaway in the picture: the convex hull of the target's image, or discs around points, with a margin.

use belvedere_construct::rays::Target;
use belvedere_core::{DVec2, DVec3, View};

/// Mask of the region.
pub(super) fn mask(view: &View, target: &Target, margin_px: f64, [width, height]: [usize; 2]) -> Vec<bool> {
    let solid = target.radius() == 0.0 && (!target.own_layers.is_empty() || target.own_parts.is_some());
    let image = |p: &DVec3| view.project(*p).ok().filter(|i| i.depth >= view.pinhole().near).map(|i| i.pixel);
    let shapes: Vec<(Vec<DVec2>, f64)> = if solid {
        vec![(hull(target.bounds.corners().iter().filter_map(image).collect()), margin_px)]
    } else {
        let of = |p: &DVec3| {
            let near = view.project(*p).ok().map_or(1.0, |i| i.depth).max(view.pinhole().near);
            image(p).map(|at| (vec![at], margin_px + target.radius() * view.pinhole().scale_px() / near))
        };
        target.points.iter().filter_map(of).collect()
    };
    let mut out = vec![false; width * height];
    for (shape, margin) in shapes.iter().filter(|(shape, _)| !shape.is_empty()) {
        let low = shape.iter().copied().fold(DVec2::INFINITY, DVec2::min) - *margin;
        let high = shape.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) + *margin;
        for y in low.y.max(0.0) as usize..(high.y.max(0.0).ceil() as usize).min(height) {
            for x in low.x.max(0.0) as usize..(high.x.max(0.0).ceil() as usize).min(width) {
                out[y * width + x] |= distance(shape, DVec2::new(x as f64 + 0.5, y as f64 + 0.5)) <= *margin;
            }
        }
    }
    out
}

/// Mask of an image widened by `margin_px`.
pub(super) fn around(image: &[bool], margin_px: f64, [width, height]: [usize; 2]) -> Vec<bool> {
    let mut out = image.to_vec();
    let reach = margin_px.floor() as isize;
    let at = |x: isize, y: isize| {
        let inside = (0..width as isize).contains(&x) && (0..height as isize).contains(&y);
        inside.then(|| y as usize * width + x as usize)
    };
    for i in (0..image.len()).filter(|i| image[*i]) {
        let (x, y) = ((i % width) as isize, (i / width) as isize);
        let beside = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
        if beside.into_iter().filter_map(|(x, y)| at(x, y)).all(|k| image[k]) {
            continue;
        }
        for (dx, dy) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))) {
            if let Some(k) = at(x + dx, y + dy).filter(|_| ((dx * dx + dy * dy) as f64).sqrt() <= margin_px) {
                out[k] = true;
            }
        }
    }
    out
}

/// The corners of the convex hull in turn (Andrew 1979).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut out: Vec<DVec2> = Vec::new();
        for p in points {
            while out.len() > 1 && (out[out.len() - 1] - out[out.len() - 2]).perp_dot(p - out[out.len() - 1]) <= 0.0 {
                out.pop();
            }
            out.push(p);
        }
        out.pop();
        out
    };
    let lower = half(&mut points.iter().copied());
    [lower, half(&mut points.iter().rev().copied())].concat()
}

/// Distance of a point from a convex polygon, a line or a point; 0 inside.
fn distance(shape: &[DVec2], p: DVec2) -> f64 {
    let edges = || (0..shape.len()).map(|i| (shape[i], shape[(i + 1) % shape.len()]));
    if shape.len() > 2 && edges().all(|(a, b)| (b - a).perp_dot(p - a) >= 0.0) {
        return 0.0;
    }
    let to = |(a, b): (DVec2, DVec2)| {
        let way = b - a;
        let s = if way == DVec2::ZERO { 0.0 } else { ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0) };
        p.distance(a + s * way)
    };
    edges().map(to).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_holds_its_points_and_distances_are_those_of_a_square() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0], [1.0, 0.0]].map(DVec2::from_array);
        let hull = hull(square.to_vec());
        assert_eq!(hull.len(), 4);
        for (p, expected) in [([1.0, 1.5], 0.0), ([3.0, 1.0], 1.0), ([5.0, 6.0], 5.0), ([-2.0, 1.0], 2.0)] {
            assert!((distance(&hull, DVec2::from_array(p)) - expected).abs() < 1e-12, "{p:?}");
        }
        assert_eq!(distance(&[DVec2::ZERO], DVec2::new(3.0, 4.0)), 5.0);
    }
}
