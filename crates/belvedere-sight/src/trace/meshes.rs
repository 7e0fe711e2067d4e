//! Intersections of a ray with the triangles of meshes.

use crate::MeshTree;
use crate::trace::curve::Span;
use crate::trace::root::root;
use crate::trace::tracer::{Found, Part, Walk};
use belvedere_core::DVec3;

/// Slack of the barycentric weights at which a bent ray still hits a triangle: more than rounding, so that no ray slips between
/// two triangles.
const SLACK: f64 = 1e-9;
/// Largest number of halvings of a part of a span that may graze a triangle.
const MAX_HALVINGS: u32 = 12;

impl Walk<'_, '_> {
    /// Passes the first hit of every mesh within a nearly straight span to `take`.
    pub(crate) fn meet_meshes(&self, span: &Span, (a, b): (DVec3, DVec3), reach: f64, take: &mut dyn FnMut(Found)) {
        for (layer, tree) in self.tracer.obstacles.meshes() {
            let straight = span.is_straight() && tree.is_still() && self.shows_all(*layer);
            let mut best: Option<(f64, usize)> = None;
            if straight {
                best = tree.first_crossing(a, b).map(|(t, triangle)| (span.depth_at(t), triangle));
            } else {
                tree.near(a, b, reach, &mut |triangle| {
                    let found = Plane::new(self, tree, triangle).meet(span, reach).map(|depth| (depth, triangle));
                    let found = found.filter(|(depth, _)| self.shows_triangle(*layer, tree, triangle, *depth));
                    if let Some(found) = found.filter(|f| best.is_none_or(|b| *f < b)) {
                        best = Some(found);
                    }
                    // A little beyond the hit, since bounds are met before the curve is.
                    best.map_or(1.0, |(depth, _)| (depth - span.depth[0]) / (span.depth[1] - span.depth[0]) + 1e-6)
                });
            }
            if let Some((depth, triangle)) = best {
                take((depth, *layer, Part::Triangle(triangle, true)));
            }
        }
    }
}

/// The plane of a triangle.
struct Plane<'w, 't, 'a> {
    walk: &'w Walk<'t, 'a>,
    tree: &'w MeshTree<'a>,
    triangle: usize,
    corner: DVec3,
    normal: DVec3,
}

impl<'w, 't, 'a> Plane<'w, 't, 'a> {
    fn new(walk: &'w Walk<'t, 'a>, tree: &'w MeshTree<'a>, triangle: usize) -> Self {
        let mesh = tree.mesh();
        Self { walk, tree, triangle, corner: mesh.corners(triangle)[0], normal: mesh.face_normal(triangle) }
    }

    fn over(&self, depth: f64) -> f64 {
        self.walk.true_point(depth).map_or(f64::NAN, |p| self.normal.dot(p - self.corner))
    }

    /// Depth at which the span crosses the triangle, if it does.
    fn meet(&self, span: &Span, reach: f64) -> Option<f64> {
        let [w0, w1] = span.depth;
        self.between(span, reach, (w0, self.over(w0)), (w1, self.over(w1)), 0)
    }

    fn between(&self, span: &Span, reach: f64, start: (f64, f64), end: (f64, f64), halvings: u32) -> Option<f64> {
        if start.1.is_nan() || end.1.is_nan() {
            return None;
        }
        if (start.1 > 0.0) != (end.1 > 0.0) {
            let depth = root(start, end, |w| self.over(w));
            let weights = self.tree.mesh().weights_at(self.triangle, self.walk.true_point(depth)?);
            if weights.iter().all(|w| *w >= -SLACK) {
                return Some(depth);
            }
        }
        // A bent span, or one over displaced ground, may cross the plane more than once.
        let least = start.1.abs().min(end.1.abs());
        let sway = self.walk.sway(span, reach, start.0, end.0);
        if sway == 0.0 || least > sway || halvings >= MAX_HALVINGS {
            return None;
        }
        let middle = 0.5 * (start.0 + end.0);
        let here = (middle, self.over(middle));
        self.between(span, reach, start, here, halvings + 1)
            .or_else(|| self.between(span, reach, here, end, halvings + 1))
    }
}
