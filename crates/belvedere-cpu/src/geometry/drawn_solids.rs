//! Which solids a band shows: those that hide what is behind them, or those of one layer that something shines through.

use crate::geometry::block::Block;
use belvedere_scene::Scene;
use belvedere_sight::{LayerPart, Solids};

/// Solids of a scene that are drawn together.
#[derive(Clone, Copy)]
pub(crate) struct DrawnSolids<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) solids: Solids,
}

impl DrawnSolids<'_> {
    /// What of a block is drawn.
    pub(crate) fn of(self, block: &Block) -> LayerPart {
        let layer = block.layer as usize;
        self.solids.of(layer, &self.scene.layers[layer].kind)
    }

    /// Whether a triangle of a block is drawn, by its number in the block.
    /// * `held`: answer of [`Self::of`] for the block.
    #[inline(always)]
    pub(crate) fn holds(self, held: LayerPart, block: &Block, parent: u32) -> bool {
        held == LayerPart::Everything || {
            let mesh = self.scene.layers[block.layer as usize].kind.triangles();
            mesh.is_some_and(|mesh| held.holds(mesh, block.origin[0] + parent as usize))
        }
    }
}
