//! Common shape of the rays of an image row under a spline bend: along the curve and above it they are equal.

use belvedere_core::map::spline::SplineBend;
use belvedere_core::{DVec2, DVec3, Pinhole};
use std::cell::RefCell;

/// Least `1 - curvature x height` for which a bound is computed for a part of a ray.
const LEAST_STRETCH: f64 = 0.02;

/// Arc length and height over the curve, curve units.
pub(crate) type CurvePoint = [f64; 2];

/// A part of the rays: a node of a tree that halves depths and grows on demand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) depth: [f64; 2],
    pub(crate) ends: [Option<CurvePoint>; 2],
    /// Bound on the distance from the chord, scene units.
    pub(crate) reach: f64,
    children: Option<[u32; 2]>,
}

/// Common shape of the rays of an image row.
pub struct Row<'a> {
    bend: &'a SplineBend,
    /// In the plane of the curve: position at depth 0 and change per unit of depth, curve units.
    line: [DVec2; 2],
    nodes: RefCell<Vec<Node>>,
}

impl<'a> Row<'a> {
    pub(crate) fn new(bend: &'a SplineBend, pinhole: &Pinhole, y: f64, range: [f64; 2]) -> Self {
        let (from, per_depth) = pinhole.line(DVec2::new(pinhole.center_px().x, y));
        let along = bend.curve_axes().map(|axis| per_depth.dot(axis) / bend.scale());
        let line = [bend.curve_position(from), DVec2::from_array(along)];
        let row = Self { bend, line, nodes: RefCell::new(Vec::new()) };
        let ends = range.map(|w| row.foot(w));
        row.nodes.borrow_mut().push(row.new_node(range, ends));
        row
    }

    /// Distance of a ray from the pivot across the curve, at depth 0 and per unit of depth, scene units.
    pub(crate) fn lateral(&self, (from, per_depth): (DVec3, DVec3)) -> [f64; 2] {
        let right = self.bend.axes()[0];
        [(from - self.bend.pivot()).dot(right), per_depth.dot(right)]
    }

    pub(crate) fn node(&self, i: u32) -> Node {
        self.nodes.borrow()[i as usize]
    }

    /// World point of a point of the row at a distance across, before other stages are undone.
    pub(crate) fn world_point(&self, [l, d]: CurvePoint, across: f64) -> DVec3 {
        self.bend.unbent(l, d, across)
    }

    /// World point at a depth and a distance across.
    pub(crate) fn at(&self, depth: f64, across: f64) -> Option<DVec3> {
        let [l, d] = self.near_foot(depth)?;
        Some(self.bend.unbent(l, d, across))
    }

    fn foot(&self, depth: f64) -> Option<CurvePoint> {
        self.bend.curve().foot(self.line[0] + depth * self.line[1]).map(|(l, d)| [l, d])
    }

    /// Foot at a depth, by iteration from the smallest known part of the row.
    fn near_foot(&self, depth: f64) -> Option<CurvePoint> {
        let nodes = self.nodes.borrow();
        let mut node = &nodes[0];
        while let Some([first, second]) = node.children {
            node = &nodes[if depth <= nodes[first as usize].depth[1] { first } else { second } as usize];
        }
        let [Some(a), Some(b)] = node.ends else { return self.foot(depth) };
        let t = (depth - node.depth[0]) / (node.depth[1] - node.depth[0]);
        let q = self.line[0] + depth * self.line[1];
        self.bend.curve().foot_near(q, a[0] + t * (b[0] - a[0])).map(|(l, d)| [l, d])
    }

    /// Both halves of a node; `None` where depths cannot be halved further.
    pub(crate) fn children(&self, i: u32) -> Option<[u32; 2]> {
        let node = self.node(i);
        if node.children.is_some() {
            return node.children;
        }
        let [w0, w1] = node.depth;
        let middle = 0.5 * (w0 + w1);
        if !(w0 < middle && middle < w1) {
            return None;
        }
        let here = self.foot(middle);
        let halves =
            [self.new_node([w0, middle], [node.ends[0], here]), self.new_node([middle, w1], [here, node.ends[1]])];
        let mut nodes = self.nodes.borrow_mut();
        let first = nodes.len() as u32;
        nodes.extend(halves);
        nodes[i as usize].children = Some([first, first + 1]);
        Some([first, first + 1])
    }

    fn new_node(&self, depth: [f64; 2], ends: [Option<CurvePoint>; 2]) -> Node {
        let reach = match ends {
            [Some(a), Some(b)] => self.reach(depth, a, b).unwrap_or_else(|| self.estimate(depth, a, b)),
            _ => f64::INFINITY,
        };
        Node { depth, ends, reach, children: None }
    }

    /// Replaces the bound close to the fold: 1.5 times the largest distance of three points. Infinite for parts so long that a bound may
    /// exist for most of their halves.
    fn estimate(&self, [w0, w1]: [f64; 2], a: CurvePoint, b: CurvePoint) -> f64 {
        let curvature = self.bend.curve().curvature_range().map(f64::abs).into_iter().fold(0.0, f64::max);
        if self.line[1].length() * (w1 - w0) * curvature.min(1e3) > 1e-3 {
            return f64::INFINITY;
        }
        let off = |t: f64| {
            let here = self.foot(w0 + t * (w1 - w0))?;
            Some((here[0] - a[0] - t * (b[0] - a[0])).hypot(here[1] - a[1] - t * (b[1] - a[1])))
        };
        let worst = [0.25, 0.5, 0.75].into_iter().map(|t| off(t).unwrap_or(f64::INFINITY)).fold(0.0, f64::max);
        self.bend.scale() * 1.5 * worst
    }

    /// Bound on the distance of the undone ray from its chord, scene units; `None` where there is no bound.
    ///
    /// With `v` the direction of the line per depth, `T` and `N` tangent and normal of the curve at the foot, the foot moves by
    /// `l' = v T / (1 - kap d)`, `d' = v N`. `l` is monotone: where `v T = 0` it stands still for ever. A function whose derivative varies in
    /// total by `V` over a length `h` stays within `h V / 4` of its chord. `N` varies by the turning of the curve between the feet, and
    /// `1 / (1 - kap d)` by at most the variation of `kap d` over the square of the smallest `1 - kap d`. Source: ours.
    fn reach(&self, depth: [f64; 2], a: CurvePoint, b: CurvePoint) -> Option<f64> {
        let curve = self.bend.curve();
        let (l0, l1) = (a[0].min(b[0]), a[0].max(b[0]));
        let way = self.line[1].length() * (depth[1] - depth[0]);
        let height = a[1].abs().max(b[1].abs()) + 0.5 * way;
        let turning = curve.turning_to(l1) - curve.turning_to(l0);
        let variation = curve.curvature_variation_to(l1) - curve.curvature_variation_to(l0);
        let curvature = curve.curvature_at(l0).abs() + variation;
        let least = 1.0 - curvature * height;
        // Feet farther apart than the line's length allows lie on different parts of the curve.
        if !(least > LEAST_STRETCH) || (l1 - l0) * least > way * (1.0 + 1e-9) + 1e-12 {
            return None;
        }
        let across = 0.25 * way * turning;
        let along = 0.25 * way * (turning / least + (height * variation + curvature * way) / (least * least));
        let rounding = 1e-13 * (l0.abs() + l1.abs() + height);
        Some(self.bend.scale() * (across.hypot(along) + rounding))
    }
}
