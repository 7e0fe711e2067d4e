//! A bounding volume hierarchy over the triangles of a mesh, for rays and lines of sight.

mod memory;

pub use memory::TreeMemory;

use crate::beam::Beam;
use crate::clip_segment;
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::Mesh;
use glam::Vec3A;
use obvhs::Boundable;
use obvhs::aabb::Aabb as Bounds;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use std::borrow::Cow;
use std::sync::Arc;

/// Most triangles of a leaf, and the cost of a step down the tree, in triangle tests.
const LEAF: u32 = 4;
const STEP_COST: f32 = 2.0;

/// A mesh with a bounding volume hierarchy over its triangles.
///
/// The bounds are exact: vertices are single precision relative to [`Mesh::origin`], and so are they. Segments are double precision.
pub struct MeshTree<'a> {
    mesh: Cow<'a, Mesh>,
    tree: Arc<Bvh2>,
    lift: [f64; 2],
}

struct Corners<'m>(&'m Mesh, [u32; 3]);

impl Boundable for Corners<'_> {
    fn aabb(&self) -> Bounds {
        let [a, b, c] = self.1.map(|v| Vec3A::from(self.0.positions()[v as usize]));
        Bounds { min: a.min(b).min(c), max: a.max(b).max(c) }
    }
}

impl<'a> MeshTree<'a> {
    /// Builds the tree, in about the time of sorting the triangles.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self::lifted(mesh, [0.0; 2])
    }

    /// The tree of a mesh whose points may be displaced vertically within a range, scene units.
    pub fn lifted(mesh: &'a Mesh, lift: [f64; 2]) -> Self {
        let all = (0..mesh.triangles().len() as u32).collect();
        Self::of(Cow::Borrowed(mesh), all, lift)
    }

    /// The tree of a mesh that it owns.
    pub fn owned(mesh: Mesh) -> MeshTree<'static> {
        let all = (0..mesh.triangles().len() as u32).collect();
        MeshTree::of(Cow::Owned(mesh), all, [0.0; 2])
    }

    /// [`MeshTree::lifted`] over some triangles alone, by their numbers.
    pub fn over(mesh: &'a Mesh, triangles: Vec<u32>, lift: [f64; 2]) -> Self {
        Self::of(Cow::Borrowed(mesh), triangles, lift)
    }

    /// The tree over all triangles but those of some parts.
    pub fn without_parts(mesh: &'a Mesh, parts: &[u32]) -> Self {
        let out: std::collections::HashSet<u32> = parts.iter().copied().collect();
        let kept = (0..mesh.triangles().len()).filter(|&t| mesh.part(t).is_none_or(|part| !out.contains(&part)));
        Self::of(Cow::Borrowed(mesh), kept.map(|t| t as u32).collect(), [0.0; 2])
    }

    fn of(mesh: Cow<'a, Mesh>, held: Vec<u32>, lift: [f64; 2]) -> Self {
        let triangles: Vec<Corners<'_>> = held.iter().map(|&t| Corners(&mesh, mesh.triangles()[t as usize])).collect();
        let mut tree = Bvh2::default();
        if !triangles.is_empty() {
            let all = (0..triangles.len() as u32).collect();
            let mut builder = PlocBuilder::with_capacity(triangles.len());
            tree = builder.build(PlocSearchDistance::Low, &triangles, all, SortPrecision::U64, 2);
            collapse(&mut tree, LEAF, STEP_COST);
            tree.primitive_indices.iter_mut().for_each(|i| *i = held[*i as usize]);
        }
        Self { mesh, tree: tree.into(), lift: [lift[0].min(0.0), lift[1].max(0.0)] }
    }

    /// The mesh with a tree that was built over the same triangles.
    fn with_tree(mesh: &'a Mesh, tree: Arc<Bvh2>) -> Self {
        Self { mesh: Cow::Borrowed(mesh), tree, lift: [0.0; 2] }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Whether the mesh is never displaced.
    pub fn is_still(&self) -> bool {
        self.lift == [0.0; 2]
    }

    /// Smallest box around the mesh, for every displacement in its range.
    pub fn bounds(&self) -> Aabb {
        let b = self.mesh.bounds();
        Aabb { min: b.min + self.lift[0] * DVec3::Z, max: b.max + self.lift[1] * DVec3::Z }
    }

    /// Visits the triangles whose bounds come within `reach` (scene units) of the straight segment `a b`, roughly
    /// from `a` to `b`. `visit` returns the parameter (0 at `a`, 1 at `b`) beyond which triangles may be skipped.
    pub fn near(&self, a: DVec3, b: DVec3, reach: f64, visit: &mut dyn FnMut(usize) -> f64) {
        if self.tree.nodes.is_empty() {
            return;
        }
        let segment = Segment::new(a - self.mesh.origin(), b - self.mesh.origin(), reach, self.lift);
        let mut limit = 1.0f64;
        let mut stack = vec![(0usize, 0.0f64)];
        while let Some((at, enter)) = stack.pop() {
            if enter > limit {
                continue;
            }
            let node = &self.tree.nodes[at];
            let first = node.first_index as usize;
            if node.prim_count > 0 {
                for &triangle in &self.tree.primitive_indices[first..first + node.prim_count as usize] {
                    limit = limit.min(visit(triangle as usize));
                }
                continue;
            }
            let child = |i: usize| segment.enter(self.tree.nodes[i].aabb()).map(|t| (i, t));
            match (child(first), child(first + 1)) {
                (Some(l), Some(r)) => stack.extend(if l.1 <= r.1 { [r, l] } else { [l, r] }),
                (l, r) => stack.extend(l.or(r)),
            }
        }
    }

    /// Where the straight segment `a b` first passes a triangle: its parameter (0 at `a`, 1 at `b`) and its number.
    pub fn first_crossing(&self, a: DVec3, b: DVec3) -> Option<(f64, usize)> {
        let mut best: Option<(f64, usize)> = None;
        self.near(a, b, 0.0, &mut |triangle| {
            if let Some(t) = self.crossing(triangle, a, b)
                && best.is_none_or(|(s, other)| (t, triangle) < (s, other))
            {
                best = Some((t, triangle));
            }
            best.map_or(1.0, |(t, _)| t)
        });
        best
    }

    /// Whether the straight segment `a b` passes any triangle: faster than [`MeshTree::first_crossing`].
    pub fn is_crossed(&self, a: DVec3, b: DVec3) -> bool {
        if self.tree.nodes.is_empty() {
            return false;
        }
        let slabs = Slabs::new(a - self.mesh.origin(), b - self.mesh.origin(), self.lift);
        let mut stack = [0u32; DEPTH];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let node = &self.tree.nodes[stack[height] as usize];
            let first = node.first_index as usize;
            if node.prim_count > 0 {
                let leaf = &self.tree.primitive_indices[first..first + node.prim_count as usize];
                if leaf.iter().any(|&triangle| self.crossing(triangle as usize, a, b).is_some()) {
                    return true;
                }
                continue;
            }
            for child in [first + 1, first] {
                if slabs.meet(self.tree.nodes[child].aabb()) {
                    // The tree is deeper than the stack: the slower method has no limit.
                    let Some(place) = stack.get_mut(height) else { return self.first_crossing(a, b).is_some() };
                    *place = child as u32;
                    height += 1;
                }
            }
        }
        false
    }

    /// Visits the numbers of the triangles whose bounds may come into a beam. Displacements count for nothing, as in [`MeshTree::crossing`].
    pub(crate) fn in_beam(&self, beam: &Beam, mut visit: impl FnMut(usize)) {
        let mut stack = if self.tree.nodes.is_empty() { Vec::new() } else { vec![0usize] };
        while let Some(at) = stack.pop() {
            let node = &self.tree.nodes[at];
            let (low, high) = (node.aabb().min.as_dvec3(), node.aabb().max.as_dvec3());
            if !beam.meets(self.mesh.origin() + 0.5 * (low + high), 0.5 * (high - low)) {
                continue;
            }
            let first = node.first_index as usize;
            if node.prim_count == 0 {
                stack.extend([first + 1, first]);
                continue;
            }
            let leaf = &self.tree.primitive_indices[first..first + node.prim_count as usize];
            leaf.iter().for_each(|triangle| visit(*triangle as usize));
        }
    }

    /// Parameter at which the straight segment `a b` passes a triangle. A segment through an edge passes at least one triangle at it.
    pub fn crossing(&self, triangle: usize, a: DVec3, b: DVec3) -> Option<f64> {
        let along = b - a;
        let corner = |v: u32| self.mesh.positions()[v as usize].as_dvec3() - (a - self.mesh.origin());
        let [p, q, r] = self.mesh.triangles()[triangle].map(corner);
        // Volumes over the edges: swapping an edge's ends changes nothing but the sign.
        let volumes = [q.cross(r), r.cross(p), p.cross(q)].map(|n| n.dot(along));
        if volumes.iter().any(|v| *v < 0.0) && volumes.iter().any(|v| *v > 0.0) {
            return None;
        }
        let normal = (q - p).cross(r - p);
        let t = p.dot(normal) / along.dot(normal);
        (0.0..=1.0).contains(&t).then_some(t)
    }
}

/// A segment and the growth of the boxes that are tested against it.
struct Segment {
    a: DVec3,
    along: DVec3,
    /// Growth of a box at its smallest and its largest corner, scene units.
    grow: [DVec3; 2],
}

impl Segment {
    fn new(a: DVec3, b: DVec3, reach: f64, lift: [f64; 2]) -> Self {
        let grow = [DVec3::splat(-reach) + lift[0] * DVec3::Z, DVec3::splat(reach) + lift[1] * DVec3::Z];
        Self { a, along: b - a, grow }
    }

    /// Parameter at which the segment enters a box.
    fn enter(&self, bounds: &Bounds) -> Option<f64> {
        let (low, high) = (bounds.min.as_dvec3() + self.grow[0], bounds.max.as_dvec3() + self.grow[1]);
        let [t0, t1] = clip_segment(self.a.to_array(), self.along.to_array(), [low.to_array(), high.to_array()]);
        // Rounding of the quotients must not lose a box that is only just touched.
        (t0 - 1e-12 <= t1 + 1e-12).then_some(t0 - 1e-12)
    }
}

/// Size of the stack of nodes to visit.
const DEPTH: usize = 96;

/// A segment prepared for slab tests against boxes.
struct Slabs {
    a: DVec3,
    /// 1 / the segment's extent along each axis, huge where it has none.
    inverse: DVec3,
    lift: [f64; 2],
}

impl Slabs {
    /// Extents below this count as 0.
    const LEAST: f64 = 1e-300;

    fn new(a: DVec3, b: DVec3, lift: [f64; 2]) -> Self {
        let inverse = (b - a).to_array().map(|d| if d.abs() < Self::LEAST { 1.0 / Self::LEAST } else { 1.0 / d });
        Self { a, inverse: DVec3::from_array(inverse), lift }
    }

    fn meet(&self, bounds: &Bounds) -> bool {
        let low = (bounds.min.as_dvec3() + self.lift[0] * DVec3::Z - self.a) * self.inverse;
        let high = (bounds.max.as_dvec3() + self.lift[1] * DVec3::Z - self.a) * self.inverse;
        let (enter, leave) = (low.min(high).max_element().max(0.0), low.max(high).min_element().min(1.0));
        // Rounding must not lose a box that is only just touched.
        enter - 1e-12 <= leave + 1e-12
    }
}

#[cfg(test)]
mod tests;
