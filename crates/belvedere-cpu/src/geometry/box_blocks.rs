//! Boxes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job};
use crate::geometry::pass::Pass;
use crate::geometry::refine::Refiner;
use crate::sections::Shown;
use belvedere_core::Aabb;
use belvedere_scene::{BoxLayer, BoxShape};
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

/// The boxes that are drawn as a block each.
fn chunk_of(layer: &BoxLayer, chunk: usize) -> &[BoxShape] {
    &layer.boxes[chunk * BOXES..layer.boxes.len().min((chunk + 1) * BOXES)]
}

/// Bounds of the parts of a layer that are drawn as a block each.
pub(crate) fn box_chunks(layer: &BoxLayer) -> Vec<Aabb> {
    let chunks = (0..layer.boxes.len().div_ceil(BOXES)).into_par_iter();
    chunks.map(|i| Aabb::of(chunk_of(layer, i).iter().flat_map(|b| b.corners()))).collect()
}

impl Job<'_> {
    /// Displaces, projects, subdivides and clips a part of the boxes.
    pub(crate) fn box_block(&self, pass: &Pass<'_>, layer: &BoxLayer, chunk: usize) -> Option<Block> {
        let boxes = chunk_of(layer, chunk);
        let shown = self.shown(&Aabb::of(boxes.iter().flat_map(|b| b.corners())));
        if shown == Shown::Nothing {
            return None;
        }
        let mut refiner = Refiner::new(pass, self.screen, self.tolerance_px, self.spare.soup());
        let judge = !pass.is_straight();
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
        let block = Block::soup(self.layer, pass.records, chunk * BOXES, refiner.out, counts)?;
        let Some(sections) = self.sections.filter(|_| shown == Shown::Partly) else { return Some(block) };
        Some(block.thinned(|parent| {
            let corners = boxes[parent as usize / 12].corners();
            BOX_TRIANGLES[parent as usize % 12].map(|n| sections.parameter(corners[n]))
        }))
    }
}
