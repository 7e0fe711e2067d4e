//! Boxes: tests against segments, and a bounding tree.

use crate::beam::{Beam, LightAxes, Reach};
use crate::{Lift, clip_segment};
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::BoxShape;

/// Most boxes in a leaf of the tree.
const LEAF: usize = 4;

/// An upright box of a scene, turned about the vertical, in coordinates of its own.
#[derive(Debug, Clone, Copy)]
pub struct UprightBox {
    /// Index of its layer in the scene.
    pub layer: usize,
    /// Its index in the layer.
    pub index: usize,
    center: DVec3,
    half: DVec3,
    sin_cos: (f64, f64),
    /// Range of the displacement of the ground under it.
    lift: [f64; 2],
}

impl UprightBox {
    fn new(layer: usize, index: usize, shape: &BoxShape, lift: Option<Lift<'_>>) -> Self {
        let half = 0.5 * shape.size;
        let bounds = Aabb::of(shape.corners());
        Self {
            layer,
            index,
            center: shape.base + DVec3::Z * half.z,
            half,
            sin_cos: shape.yaw.sin_cos(),
            lift: lift.map_or([0.0; 2], |lift| lift(bounds.min.truncate(), bounds.max.truncate())),
        }
    }

    #[inline]
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
    pub fn outside(&self, p: DVec3) -> f64 {
        (self.local(p).abs() - self.half).max_element()
    }

    /// Outward unit normal of the face nearest to `p`.
    pub fn normal(&self, p: DVec3) -> DVec3 {
        let (local, (sin, cos)) = (self.local(p), self.sin_cos);
        let away = (local.abs() - self.half).to_array();
        let axis = (0..3).max_by(|&i, &k| away[i].total_cmp(&away[k])).unwrap_or(2);
        let sign = if local[axis] < 0.0 { -1.0 } else { 1.0 };
        sign * [DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z][axis]
    }

    /// Extent of the box along the axes of light, for every displacement of the ground under it.
    pub(crate) fn reach_along(&self, light: &LightAxes) -> Reach {
        let ((sin, cos), half) = (self.sin_cos, self.half);
        let axes = [half.x * DVec3::new(cos, sin, 0.0), half.y * DVec3::new(-sin, cos, 0.0), half.z * DVec3::Z];
        let lift = [self.lift[0].min(0.0), self.lift[1].max(0.0)];
        let lifted = [axes[0], axes[1], axes[2] + 0.5 * (lift[1] - lift[0]) * DVec3::Z];
        light.reach_of_box(self.center + 0.5 * (lift[0] + lift[1]) * DVec3::Z, lifted)
    }

    /// Whether the segment `a b` meets the box, for every displacement of the ground under it.
    pub fn is_met(&self, a: DVec3, b: DVec3) -> bool {
        self.within(a, b, 0.0).is_some()
    }

    /// Parameters between which the segment `a b` lies within `reach` of the box, for every displacement of the ground under it.
    fn within(&self, a: DVec3, b: DVec3, reach: f64) -> Option<[f64; 2]> {
        let [low, high] = self.lift.map(|l| l * DVec3::Z);
        let (start, end) = (self.local(a), self.local(b));
        clip(start, end - start, &Aabb { min: low - self.half, max: high + self.half }, reach)
    }

    /// Depth of the segment `a b` inside the box, scene units: distance from the middle of its inner part to the nearest side or
    /// to the top; `None` if it runs outside or along a face.
    pub fn depth_inside(&self, a: DVec3, b: DVec3) -> Option<f64> {
        let (start, end) = (self.local(a), self.local(b));
        let [t0, t1] = clip(start, end - start, &Aabb { min: -self.half, max: self.half }, 0.0)?;
        let middle = start.lerp(end, 0.5 * (t0 + t1));
        let sides = self.half - middle.abs();
        (t0 < t1 && sides.min_element() > 0.0).then(|| sides.x.min(sides.y).min(self.half.z - middle.z))
    }

    /// Whether the displacement of the ground varies under the box.
    pub fn is_sheared(&self) -> bool {
        self.lift[0] != self.lift[1]
    }
}

#[inline]
fn clip(start: DVec3, dir: DVec3, bounds: &Aabb, reach: f64) -> Option<[f64; 2]> {
    let grown = [bounds.min - reach, bounds.max + reach].map(|corner| corner.to_array());
    let part = clip_segment(start.to_array(), dir.to_array(), grown);
    (part[0] <= part[1]).then_some(part)
}

#[derive(Debug)]
enum Node {
    Inner([u32; 2]),
    /// Boxes from one number to another.
    Leaf([u32; 2]),
}

/// Size of the stack of nodes to visit: halving a `usize` of boxes never needs more.
const DEPTH: usize = 72;

/// The boxes of a scene in a tree of bounds.
#[derive(Debug, Default)]
pub struct BoxTree {
    nodes: Vec<(Aabb, Node)>,
    /// Leaf after leaf.
    boxes: Vec<UprightBox>,
}

impl BoxTree {
    /// * `boxes`: each with the index of its layer and its index in that;
    /// * `lift`: displacement of the ground that they stand on.
    pub fn new<'b>(boxes: impl IntoIterator<Item = ([usize; 2], &'b BoxShape)>, lift: Option<Lift<'_>>) -> Self {
        let boxes = boxes.into_iter().map(|([layer, index], shape)| UprightBox::new(layer, index, shape, lift));
        let (boxes, mut out): (Vec<_>, _) = (boxes.collect(), Self::default());
        if !boxes.is_empty() {
            out.add(boxes);
        }
        out
    }

    fn add(&mut self, mut boxes: Vec<UprightBox>) -> u32 {
        let bounds = boxes.iter().fold(Aabb::EMPTY, |b, s| b.union(s.bounds()));
        let at = self.nodes.len();
        let first = self.boxes.len() as u32;
        self.nodes.push((bounds, Node::Leaf([first, first])));
        if boxes.len() > LEAF {
            let extent = bounds.max - bounds.min;
            let axis = if extent.x >= extent.y { 0 } else { 1 };
            boxes.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
            let rest = boxes.split_off(boxes.len() / 2);
            self.nodes[at].1 = Node::Inner([self.add(boxes), self.add(rest)]);
        } else {
            self.boxes.extend(boxes);
            self.nodes[at].1 = Node::Leaf([first, self.boxes.len() as u32]);
        }
        at as u32
    }

    /// Smallest box around all boxes, for every displacement of the ground under them.
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |(bounds, _)| *bounds)
    }

    /// The boxes, in the order of the tree.
    pub fn boxes(&self) -> &[UprightBox] {
        &self.boxes
    }

    /// Visits the boxes that come within `reach` (scene units) of the segment `a b`, in no order, with the parameters of
    /// its part there, until `visit` returns `false`; then the result is `false`.
    pub fn near(&self, a: DVec3, b: DVec3, reach: f64, visit: &mut dyn FnMut(&UprightBox, [f64; 2]) -> bool) -> bool {
        let holds = |bounds: &Aabb| clip(a, b - a, bounds, reach).is_some();
        self.visit(holds, |number| match self.boxes[number].within(a, b, reach) {
            Some(part) => visit(&self.boxes[number], part),
            None => true,
        })
    }

    /// Visits the numbers of the boxes that may come into a beam.
    pub(crate) fn in_beam(&self, beam: &Beam, mut visit: impl FnMut(usize)) {
        let meets = |bounds: &Aabb| beam.meets(bounds.center(), 0.5 * (bounds.max - bounds.min));
        self.visit(meets, |number| {
            visit(number);
            true
        });
    }

    /// Visits the boxes of the leaves all of whose nodes are wanted, until `visit` returns `false`; then the result is `false`.
    #[inline]
    fn visit(&self, wanted: impl Fn(&Aabb) -> bool, mut visit: impl FnMut(usize) -> bool) -> bool {
        let mut stack = [0u32; DEPTH];
        let mut height = usize::from(!self.nodes.is_empty());
        while height > 0 {
            height -= 1;
            let (bounds, node) = &self.nodes[stack[height] as usize];
            if !wanted(bounds) {
                continue;
            }
            match node {
                Node::Inner(children) => {
                    stack[height..height + 2].copy_from_slice(children);
                    height += 2;
                }
                Node::Leaf([first, end]) => {
                    for number in *first..*end {
                        if !visit(number as usize) {
                            return false;
                        }
                    }
                }
            }
        }
        true
    }
}
