//! Bounds of the highest ground of every block as cells are lowered.

use super::blocks::{Blocks, SIDE};
use super::scan::UNSURE;
use super::{Affine, Pieces};
use belvedere_core::DVec2;

/// Heights are over the datum.
pub(super) struct Ceilings {
    /// Of what belongs to one cell in a block, and of the block.
    parts: Vec<f32>,
    blocks: Vec<f32>,
    /// Cells that were lowered since; until they are settled their bounds are higher than need be.
    lowered: Vec<usize>,
    /// Grid coordinates.
    eye: DVec2,
    spacing: DVec2,
}

impl Ceilings {
    /// Of the untouched ground.
    pub(super) fn new(blocks: &Blocks, eye: DVec2, spacing: DVec2) -> Self {
        let parts = blocks.all_parts().iter().map(|p| p.highest).collect();
        Self { parts, blocks: blocks.ceilings().to_vec(), lowered: Vec::new(), eye, spacing }
    }

    pub(super) fn of_blocks(&self) -> &[f32] {
        &self.blocks
    }

    pub(super) fn lower(&mut self, cell: usize) {
        self.lowered.push(cell);
    }

    pub(super) fn settle(&mut self, blocks: &Blocks, pieces: &[Pieces]) {
        let mut lowered = std::mem::take(&mut self.lowered);
        lowered.sort_unstable();
        lowered.dedup();
        for cell in lowered.drain(..) {
            let pieces = &pieces[cell];
            for &number in blocks.parts_of_cell(cell) {
                let part = &blocks.all_parts()[number as usize];
                let block = part.block as usize;
                let affine = if pieces.alike() { pieces.bound() } else { self.within(pieces, blocks.corner(block)) };
                self.parts[number as usize] = (affine.of(f64::from(part.highest)) as f32).next_up();
                let highest = |a: f32, &b: &f32| if b > a { b } else { a };
                self.blocks[block] = self.parts[blocks.numbers(block)].iter().fold(f32::NEG_INFINITY, highest);
            }
        }
        self.lowered = lowered;
    }

    /// A bound of what is done to a cell within a block.
    fn within(&self, pieces: &Pieces, corner: DVec2) -> Affine {
        let (from, to) = (corner - self.eye, corner + SIDE as f64 - self.eye);
        let (nearest, farthest) = (DVec2::ZERO.clamp(from, to), from.abs().max(to.abs()));
        let [near, far] = [nearest, farthest].map(|d| (d * self.spacing).length());
        // Rounding must not hide a ring.
        pieces.between([(1.0 - UNSURE) * near, (1.0 + UNSURE) * far]).0
    }
}
