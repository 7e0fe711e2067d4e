//! Boxes as blocks of triangles.

use crate::geometry::block::{Block, Counts, Job};
use crate::geometry::pass::Pass;
use crate::geometry::refine::Refiner;
use belvedere_core::{Aabb, DVec3};
use belvedere_scene::{BoxLayer, BoxShape};
use belvedere_sight::CarriedLayer;
use belvedere_sight::sections::Shown;
use rayon::prelude::*;

/// Number of boxes of a block.
const BOXES: usize = 64;

/// The boxes of a block, by its number.
fn chunk_of(layer: &BoxLayer, chunk: usize) -> &[BoxShape] {
    &layer.boxes[chunk * BOXES..layer.boxes.len().min((chunk + 1) * BOXES)]
}

/// Corners of the boxes of a block, displaced if they are rigid bodies; `None` for a body without image.
fn corners_of<'b>(
    layer: &'b BoxLayer,
    carried: Option<&'b CarriedLayer>,
    chunk: usize,
) -> impl Iterator<Item = Option<[DVec3; 8]>> + 'b {
    chunk_of(layer, chunk).iter().enumerate().map(move |(k, shape)| match carried {
        Some(bodies) => bodies.motion(chunk * BOXES + k).map(|motion| shape.corners().map(|p| motion.carry(p))),
        None => Some(shape.corners()),
    })
}

/// Bounds of the blocks of a layer.
/// * `carried`: motions of its boxes if they are rigid bodies.
pub(crate) fn box_chunks(layer: &BoxLayer, carried: Option<&CarriedLayer>) -> Vec<Aabb> {
    let chunks = (0..layer.boxes.len().div_ceil(BOXES)).into_par_iter();
    chunks.map(|i| Aabb::of(corners_of(layer, carried, i).flatten().flatten())).collect()
}

impl Job<'_> {
    /// Displaces, projects, subdivides and clips the boxes of a block.
    /// * `carried`: motions of the boxes if they are rigid bodies; `pass` is then one of `BodyPasses`.
    pub(crate) fn box_block(
        &self,
        pass: &Pass<'_>,
        layer: &BoxLayer,
        carried: Option<&CarriedLayer>,
        chunk: usize,
    ) -> Option<Block> {
        let boxes = chunk_of(layer, chunk);
        let shown = self.shown(&Aabb::of(boxes.iter().flat_map(|b| b.corners())));
        if shown == Shown::Nothing {
            return None;
        }
        let mut refiner = Refiner::new(&pass.plain, self.screen, self.tolerance_px, self.spare.soup());
        let judge = !pass.plain.keeps_edges();
        let mut missed = 0;
        for (k, corners) in corners_of(layer, carried, chunk).enumerate() {
            let Some(corners) = corners.map(|c| c.map(|p| refiner.corner(p))) else {
                missed += 8;
                continue;
            };
            missed += corners.iter().filter(|c| c.is_missing()).count() as u64;
            for (t, tri) in BoxShape::TRIANGLES.iter().enumerate() {
                let weights = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
                refiner.triangle(tri.map(|n| corners[n]), weights, [judge; 3], (12 * k + t) as u32);
            }
        }
        let counts = Counts { drawn: refiner.out.len() as u64, split: refiner.splits, missed };
        let block = Block::soup(self.layer, pass.plain.numbers(), chunk * BOXES, refiner.out, counts)?;
        let block = Block { bodies: carried.is_some(), ..block };
        let Some(sections) = self.sections.filter(|_| shown == Shown::Partly) else { return Some(block) };
        Some(block.thinned(|parent| {
            let corners = boxes[parent as usize / 12].corners();
            BoxShape::TRIANGLES[parent as usize % 12].map(|n| sections.parameter(corners[n]))
        }))
    }
}
