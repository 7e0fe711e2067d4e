//! Boxes: a tree of bounds, and where a ray enters one.

use belvedere_core::{Aabb, DVec3};
use belvedere_scene::BoxShape;

/// Boxes to a leaf.
const LEAF: usize = 4;

/// A box in coordinates of its own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Solid {
    pub(crate) layer: usize,
    pub(crate) index: usize,
    center: DVec3,
    half: DVec3,
    sin_cos: (f64, f64),
    /// Range of the displacement of the ground under it.
    lift: [f64; 2],
}

impl Solid {
    pub(crate) fn new(layer: usize, index: usize, shape: &BoxShape, lift: impl Fn(&Aabb) -> [f64; 2]) -> Self {
        let half = 0.5 * shape.size;
        Self {
            layer,
            index,
            center: shape.base + DVec3::Z * half.z,
            half,
            sin_cos: shape.yaw.sin_cos(),
            lift: lift(&Aabb::of(shape.corners())),
        }
    }

    fn local(&self, p: DVec3) -> DVec3 {
        let ((sin, cos), d) = (self.sin_cos, p - self.center);
        DVec3::new(cos * d.x + sin * d.y, cos * d.y - sin * d.x, d.z)
    }

    fn bounds(&self) -> Aabb {
        let (sin, cos) = (self.sin_cos.0.abs(), self.sin_cos.1.abs());
        let reach =
            DVec3::new(cos * self.half.x + sin * self.half.y, sin * self.half.x + cos * self.half.y, self.half.z);
        Aabb {
            min: self.center - reach + DVec3::Z * self.lift[0].min(0.0),
            max: self.center + reach + DVec3::Z * self.lift[1].max(0.0),
        }
    }

    /// Positive outside the box, negative inside, zero on its surface; scene units at the faces.
    pub(crate) fn outside(&self, p: DVec3) -> f64 {
        (self.local(p).abs() - self.half).max_element()
    }

    /// Outward unit normal of the face nearest to `p`.
    pub(crate) fn normal(&self, p: DVec3) -> DVec3 {
        let (local, (sin, cos)) = (self.local(p), self.sin_cos);
        let away = (local.abs() - self.half).to_array();
        let axis = (0..3).max_by(|&i, &k| away[i].total_cmp(&away[k])).unwrap_or(2);
        let sign = if local[axis] < 0.0 { -1.0 } else { 1.0 };
        sign * [DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z][axis]
    }

    /// Parameters between which the straight segment `a b` lies within `reach` of the box, wherever the ground has moved it to.
    pub(crate) fn within(&self, a: DVec3, b: DVec3, reach: f64) -> Option<[f64; 2]> {
        let grow = |lo: DVec3, hi: DVec3| Aabb { min: lo - reach, max: hi + reach };
        let lift = self.lift.map(|l| l * DVec3::Z);
        slab(&grow(-self.half + lift[0], self.half + lift[1]), self.local(a), self.local(b))
    }

    /// Whether the ground under the box moves unevenly.
    pub(crate) fn is_sheared(&self) -> bool {
        self.lift[0] != self.lift[1]
    }
}

/// Parameters in 0..=1 between which the segment `a b` lies in the box.
fn slab(bounds: &Aabb, a: DVec3, b: DVec3) -> Option<[f64; 2]> {
    let (mut t0, mut t1) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (p, d) = (a[axis], b[axis] - a[axis]);
        let (lo, hi) = (bounds.min[axis], bounds.max[axis]);
        if d == 0.0 {
            if !(lo <= p && p <= hi) {
                return None;
            }
            continue;
        }
        let (s0, s1) = ((lo - p) / d, (hi - p) / d);
        t0 = t0.max(s0.min(s1));
        t1 = t1.min(s0.max(s1));
    }
    (t0 <= t1).then_some([t0, t1])
}

#[derive(Debug)]
enum Node {
    Inner([usize; 2]),
    Leaf(Vec<Solid>),
}

/// All boxes of a scene.
#[derive(Debug, Default)]
pub(crate) struct Boxes {
    nodes: Vec<(Aabb, Node)>,
}

impl Boxes {
    pub(crate) fn new(solids: Vec<Solid>) -> Self {
        let mut out = Self::default();
        if !solids.is_empty() {
            out.add(solids);
        }
        out
    }

    fn add(&mut self, mut solids: Vec<Solid>) -> usize {
        let bounds = solids.iter().fold(Aabb::EMPTY, |b, s| b.union(s.bounds()));
        let at = self.nodes.len();
        self.nodes.push((bounds, Node::Leaf(Vec::new())));
        if solids.len() > LEAF {
            let extent = bounds.max - bounds.min;
            let axis = if extent.x >= extent.y { 0 } else { 1 };
            solids.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
            let rest = solids.split_off(solids.len() / 2);
            self.nodes[at].1 = Node::Inner([self.add(solids), self.add(rest)]);
        } else {
            self.nodes[at].1 = Node::Leaf(solids);
        }
        at
    }

    /// Around all boxes, wherever the ground has moved them to.
    pub(crate) fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |(bounds, _)| *bounds)
    }

    /// Visits the boxes that come within `reach` of the segment, in no order, until `visit` says false.
    pub(crate) fn near(&self, a: DVec3, b: DVec3, reach: f64, visit: &mut dyn FnMut(&Solid, [f64; 2]) -> bool) {
        let mut stack = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(i) = stack.pop() {
            let (bounds, node) = &self.nodes[i];
            if slab(&Aabb { min: bounds.min - reach, max: bounds.max + reach }, a, b).is_none() {
                continue;
            }
            match node {
                Node::Inner(children) => stack.extend(children),
                Node::Leaf(solids) => {
                    for solid in solids {
                        if let Some(part) = solid.within(a, b, reach)
                            && !visit(solid, part)
                        {
                            return;
                        }
                    }
                }
            }
        }
    }
}
