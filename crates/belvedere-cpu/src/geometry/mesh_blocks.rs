//! Meshes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job, SoupTriangle, SoupVertex};
use crate::geometry::pass::Pass;
use crate::geometry::refine::Refiner;
use crate::geometry::screen::ScreenVertex;
use crate::sections::Shown;
use belvedere_core::{Aabb, DVec3, EdgePoint};
use belvedere_scene::Mesh;
use rayon::prelude::*;

/// Triangles to a block.
const TRIANGLES: usize = 512;
/// Weights of vertices 1 and 2 of a triangle at its corners.
const WEIGHTS: [[f32; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// Bounds of the parts of a mesh that are drawn as a block each.
pub(crate) fn mesh_chunks(mesh: &Mesh) -> Vec<Aabb> {
    let chunks = mesh.triangles().par_chunks(TRIANGLES);
    chunks.map(|part| Aabb::of(part.iter().flatten().map(|&v| mesh.vertex(v)))).collect()
}

/// A vertex of a mesh on the image.
struct Vertex {
    p: DVec3,
    /// Its image if it needs no clipping, and beyond which sides of the image it lies.
    image: Option<(ScreenVertex, u8)>,
    /// For the error of edges; `None` where it is not known.
    edge: Option<EdgePoint>,
    missed: bool,
}

impl Job<'_> {
    /// Displaces, projects, subdivides and clips a part of a mesh, every vertex once.
    pub(crate) fn mesh_block(&self, pass: &Pass<'_>, mesh: &Mesh, chunk: usize) -> Option<Block> {
        let first = chunk * TRIANGLES;
        let triangles = mesh.triangles().get(first..mesh.triangles().len().min(first + TRIANGLES))?;
        let (numbers, corners) = distinct(triangles);
        let bounds = Aabb::of(numbers.iter().map(|&v| mesh.vertex(v)));
        if self.shown(&bounds) == Shown::Nothing {
            return None;
        }
        let judge = !pass.is_straight_in(&bounds, self.tolerance_px);
        let vertices: Vec<Vertex> = numbers.iter().map(|&v| self.mesh_vertex(pass, mesh.vertex(v), judge)).collect();
        let missed = vertices.iter().filter(|v| v.missed).count() as u64;
        let mut refiner = Refiner::new(pass, self.screen, self.tolerance_px, self.spare.soup());
        for (k, corners) in corners.iter().enumerate() {
            let corners = corners.map(|c| &vertices[c as usize]);
            match self.whole(pass, corners, judge) {
                Some([a, b, c]) => {
                    let vertex = |screen, corner: usize| SoupVertex { screen, weights: WEIGHTS[corner] };
                    let v = [vertex(a, 0), vertex(b, 1), vertex(c, 2)];
                    refiner.out.push(SoupTriangle { v, parent: k as u32 });
                }
                None => refiner.triangle(corners.map(|v| refiner.corner(v.p)), WEIGHTS, [judge; 3], k as u32),
            }
        }
        let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
        let block = Block::soup(self.layer, pass.records, first, refiner.out, counts)?;
        let Some(sections) = self.sections.filter(|_| self.shown(&bounds) == Shown::Partly) else { return Some(block) };
        Some(block.thinned(|k| triangles[k as usize].map(|v| sections.parameter(mesh.vertex(v)))))
    }

    fn mesh_vertex(&self, pass: &Pass<'_>, p: DVec3, judge: bool) -> Vertex {
        let v = pass.displace(p).map(|d| self.screen.view_from(d)).filter(|v| v.is_finite());
        let whole = |v: &DVec3| self.screen.is_drawable(*v) && pass.margins(p).iter().all(|m| *m >= 0.0);
        let image = v.filter(whole).map(|v| (self.screen.snap(v), self.screen.outcode(v, self.tolerance_px)));
        let edge = if judge { pass.edge_point(p) } else { None };
        Vertex { p, image, edge, missed: v.is_none_or(|v| !(v.z > 0.0)) }
    }

    /// The image of a triangle that may lie in the picture and needs neither clipping nor subdivision; `None` for any other.
    fn whole(&self, pass: &Pass<'_>, corners: [&Vertex; 3], judge: bool) -> Option<[ScreenVertex; 3]> {
        let [(a, beyond_a), (b, beyond_b), (c, beyond_c)] = [corners[0].image?, corners[1].image?, corners[2].image?];
        let straight = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            // Always in the same direction: two triangles must judge their common edge alike to the last bit.
            let swap = a.p.to_array().partial_cmp(&b.p.to_array()) == Some(std::cmp::Ordering::Greater);
            let (a, b) = if swap { (b, a) } else { (a, b) };
            let error = pass.edge_error_between(a.edge.as_ref(), b.edge.as_ref());
            error.is_some_and(|error| error <= self.tolerance_px)
        };
        let whole = beyond_a & beyond_b & beyond_c == 0 && (!judge || (0..3).all(straight));
        whole.then_some([a, b, c])
    }
}

/// Numbers of the vertices of triangles, each once, and for every corner the place of its vertex among them.
fn distinct(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut order: Vec<(u32, u32)> =
        triangles.as_flattened().iter().enumerate().map(|(slot, &v)| (v, slot as u32)).collect();
    order.sort_unstable();
    let (mut numbers, mut corners) = (Vec::new(), vec![[0; 3]; triangles.len()]);
    for (vertex, slot) in order {
        if numbers.last() != Some(&vertex) {
            numbers.push(vertex);
        }
        corners.as_flattened_mut()[slot as usize] = numbers.len() as u32 - 1;
    }
    (numbers, corners)
}
