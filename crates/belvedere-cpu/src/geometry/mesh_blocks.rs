//! Meshes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job};
use crate::geometry::pass::Pass;
use crate::geometry::refine::{Corner, Refiner};
use belvedere_core::Aabb;
use belvedere_scene::Mesh;
use rayon::prelude::*;

/// Triangles to a block.
const TRIANGLES: usize = 512;

/// Bounds of the parts of a mesh that are drawn as a block each.
pub(crate) fn mesh_chunks(mesh: &Mesh) -> Vec<Aabb> {
    let chunks = mesh.triangles().par_chunks(TRIANGLES);
    chunks.map(|part| Aabb::of(part.iter().flatten().map(|&v| mesh.vertex(v)))).collect()
}

impl Job<'_> {
    /// Displaces, projects, subdivides and clips a part of a mesh, every vertex once.
    pub(crate) fn mesh_block(&self, pass: &Pass<'_>, mesh: &Mesh, chunk: usize) -> Option<Block> {
        let first = chunk * TRIANGLES;
        let triangles = mesh.triangles().get(first..mesh.triangles().len().min(first + TRIANGLES))?;
        let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut refiner = Refiner::new(pass, self.screen, self.tolerance_px, self.spare.soup());
        let corners: Vec<Corner> = vertices.iter().map(|&v| refiner.corner(mesh.vertex(v))).collect();
        let missed = corners.iter().filter(|c| c.is_missing()).count() as u64;
        let corner = |v: u32| vertices.binary_search(&v).ok().map(|at| corners[at]);
        let judge = !pass.is_straight();
        for (k, triangle) in triangles.iter().enumerate() {
            if let [Some(a), Some(b), Some(c)] = triangle.map(corner) {
                refiner.triangle([a, b, c], [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [judge; 3], k as u32);
            }
        }
        let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
        Block::soup(self.layer, pass.records, first, refiner.out, counts)
    }
}
