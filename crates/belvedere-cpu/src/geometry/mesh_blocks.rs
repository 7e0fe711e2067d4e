//! Meshes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job};
use crate::geometry::pass::InView;
use crate::geometry::refine::{Corner, Refiner};
use belvedere_core::Aabb;
use belvedere_scene::Mesh;
use rayon::prelude::*;

/// Triangles to a block.
const TRIANGLES: usize = 512;

impl Job<'_> {
    /// Displaces, projects, subdivides and clips a mesh. Every vertex is displaced once for each block that uses it.
    pub(crate) fn mesh(&self, mesh: &Mesh) -> Vec<Block> {
        let blocks = mesh.triangles().par_chunks(TRIANGLES).enumerate();
        blocks.filter_map(|(i, triangles)| self.mesh_block(mesh, i * TRIANGLES, triangles)).collect()
    }

    fn mesh_block(&self, mesh: &Mesh, first: usize, triangles: &[[u32; 3]]) -> Option<Block> {
        let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let bounds = Aabb::of(vertices.iter().map(|&v| mesh.vertex(v)));
        if self.pass.in_view(self.screen, &bounds) == InView::No {
            return None;
        }
        let mut refiner = Refiner::new(self.pass, self.screen, self.tolerance_px, self.spare.soup());
        let corners: Vec<Corner> = vertices.iter().map(|&v| refiner.corner(mesh.vertex(v))).collect();
        let missed = corners.iter().filter(|c| c.is_missing()).count() as u64;
        let corner = |v: u32| vertices.binary_search(&v).ok().map(|at| corners[at]);
        let judge = !self.pass.is_straight();
        for (k, triangle) in triangles.iter().enumerate() {
            if let [Some(a), Some(b), Some(c)] = triangle.map(corner) {
                refiner.triangle([a, b, c], [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [judge; 3], k as u32);
            }
        }
        let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
        Block::soup(self.layer, first, refiner.out, counts)
    }
}
