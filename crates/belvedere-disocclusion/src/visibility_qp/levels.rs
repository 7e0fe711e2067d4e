//! Nodes of the terrain that move with lakes.

use belvedere_core::DVec2;
use std::collections::BTreeMap;

/// Nodes of the terrain that move with a lake: its water by as much as the lake does; its bank and its shore as the solver's grid does,
/// but not above the water, and not below it by more than they stand over it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Levels {
    /// Grid position at which the displacement of each lake is that of the solver's grid.
    pub(crate) lakes: Vec<DVec2>,
    /// Of a node of the terrain its lake, and its height over the water: 0 of water, infinite on the shore.
    pub(crate) nodes: BTreeMap<u32, (u32, f64)>,
}
