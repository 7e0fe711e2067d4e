//! Boxes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job};
use crate::geometry::pass::InView;
use crate::geometry::refine::Refiner;
use belvedere_core::Aabb;
use belvedere_scene::BoxLayer;
use rayon::prelude::*;

/// Boxes to a block.
const BOXES: usize = 64;

/// Corner numbers (see [`belvedere_scene::BoxShape::corners`]) of the twelve triangles of a box, two per face.
pub(crate) const BOX_TRIANGLES: [[usize; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

impl Job<'_> {
    /// Displaces, projects, subdivides and clips boxes.
    pub(crate) fn boxes(&self, layer: &BoxLayer) -> Vec<Block> {
        (0..layer.boxes.len().div_ceil(BOXES)).into_par_iter().filter_map(|i| self.box_block(layer, i)).collect()
    }

    fn box_block(&self, layer: &BoxLayer, i: usize) -> Option<Block> {
        let boxes = &layer.boxes[i * BOXES..layer.boxes.len().min((i + 1) * BOXES)];
        let bounds = Aabb::of(boxes.iter().flat_map(|b| b.corners()));
        if self.pass.in_view(self.screen, &bounds) == InView::No {
            return None;
        }
        let mut refiner = Refiner::new(self.pass, self.screen, self.tolerance_px, self.spare.soup());
        let judge = !self.pass.is_straight();
        let mut missed = 0;
        for (k, shape) in boxes.iter().enumerate() {
            let corners = shape.corners().map(|p| refiner.corner(p));
            missed += corners.iter().filter(|c| c.is_missing()).count() as u64;
            for (t, tri) in BOX_TRIANGLES.iter().enumerate() {
                let weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
                refiner.triangle(tri.map(|n| corners[n]), weights, [judge; 3], (12 * k + t) as u32);
            }
        }
        let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
        Block::soup(self.layer, i * BOXES, refiner.out, counts)
    }
}
