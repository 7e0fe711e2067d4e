//! Report of a generalisation.

use belvedere_core::{Warning, WarningKind};
use belvedere_scene::city::Keep;
use serde::Serialize;

/// Figures of a generalisation.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GeneraliseReport {
    /// What blocks keep of their buildings.
    pub keep: Keep,
    /// Buildings of the city.
    pub buildings: usize,
    /// Buildings without an outline that has an area, left out.
    pub without_area: usize,
    /// Volume of all other buildings, m^3: between their surfaces, or of the prism over the footprint.
    pub volume_m3: f64,
    /// Triangles of all other buildings as prisms.
    pub triangles: usize,
    /// The levels, finest first.
    pub levels: Vec<LevelReport>,
    /// Oddities and assumptions; the subject of those of one level is its name.
    pub notes: Vec<Warning>,
    /// Time, seconds.
    pub seconds: f64,
}

/// Figures of one level.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelReport {
    /// `loa1` or `loa2`.
    pub name: &'static str,
    /// Centre lines that divide the cells.
    pub streets: usize,
    /// Cells.
    pub cells: usize,
    /// Cells too small that joined a neighbour.
    pub cells_merged: usize,
    /// Cells too small without a building and without a neighbour, left out.
    pub cells_dropped: usize,
    /// Blocks.
    pub blocks: usize,
    /// Cells that are hardly built; their ground is green.
    pub green_cells: usize,
    /// Buildings in green cells; blocks follow them.
    pub buildings_in_green: usize,
    /// Their volume, m^3.
    pub volume_in_green_m3: f64,
    /// Buildings kept in their own shape.
    pub landmarks: usize,
    /// Footprints of the blocks, m^2.
    pub block_area_m2: f64,
    /// Ground of the buildings that blocks stand for, overlaps counted once, m^2.
    pub built_area_m2: f64,
    /// Share of that ground that lies in their blocks.
    pub covered_share: f64,
    /// Triangles of blocks and landmarks on level ground.
    pub triangles: usize,
    /// Volume of its blocks and landmarks as they are drawn and written, m^3.
    pub volume_m3: f64,
    /// That volume as a share of the volume of all buildings that have an area.
    pub volume_share: f64,
    /// Whether that share lies in 0.9..=1.1.
    pub volume_kept: bool,
    /// Cells whose own volume is not kept to 10 %, whose block leaves a tenth of its buildings' ground out, or whose buildings overlap.
    pub cells_failing: Vec<FailingCell>,
    /// Figures of every block, in the order of the level's buildings.
    pub each_block: Vec<BlockReport>,
}

/// Most names of one sentence.
const MOST_NAMES: usize = 5;
/// How far the volume of a level, or of a cell, may differ from that of its buildings, as a share of it.
pub(super) const VOLUME_OFF: f64 = 0.1;

impl LevelReport {
    /// One sentence if the level does not keep the volume of the buildings.
    pub fn missed(&self) -> Option<String> {
        let built = self.built_area_m2 / self.block_area_m2.max(f64::MIN_POSITIVE);
        (!self.volume_kept).then(|| {
            format!(
                "{} holds {:.0} % of the volume of the buildings, 90 to 110 are good; buildings cover {:.0} % of its blocks, which may keep their volume instead of their height",
                self.name,
                100.0 * self.volume_share,
                100.0 * built.min(1.0)
            )
        })
    }

    /// Which cells fail, one sentence for each reason.
    pub fn failing(&self) -> Vec<Warning> {
        // That blocks are larger or smaller is said once for the level.
        let of_shape = |reason: &&str| *reason != FailingCell::GAPS && *reason != FailingCell::SMALL;
        let mut reasons: Vec<&str> = self.cells_failing.iter().map(|c| c.reason).filter(of_shape).collect();
        reasons.sort_unstable();
        reasons.dedup();
        let text = |reason: &str| {
            let of: Vec<&FailingCell> = self.cells_failing.iter().filter(|c| c.reason == reason).collect();
            let one = |c: &&FailingCell| {
                let volume = 100.0 * c.volume_out_m3 / c.volume_in_m3.max(f64::MIN_POSITIVE);
                format!("{} ({volume:.0} % of the volume, {:.0} % covered)", c.cell, 100.0 * c.covered_share)
            };
            let more = of.len().saturating_sub(MOST_NAMES);
            let names = of.iter().take(MOST_NAMES).map(one).collect::<Vec<_>>().join(", ");
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let text = format!("{}: {reason} in {names}{more}", self.name);
            Warning::new(WarningKind::Inexact, text).about(self.name).with("cells", of.len() as f64)
        };
        reasons.into_iter().map(text).collect()
    }
}

/// Figures of one block.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BlockReport {
    /// Name, that of its cell.
    pub block: String,
    /// Buildings that it stands for.
    pub buildings: usize,
    /// Footprint, m^2.
    pub area_m2: f64,
    /// Height over its ground, metres.
    pub height_m: f64,
    /// Share of its buildings' ground that lies in the footprint.
    pub covered_share: f64,
    /// Share of the footprint that its buildings cover.
    pub coverage: f64,
    /// Volume of its buildings, m^3.
    pub volume_in_m3: f64,
    /// Its own volume, m^3.
    pub volume_out_m3: f64,
}

/// A cell whose block does not hold the volume of its buildings.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FailingCell {
    /// Name of the cell.
    pub cell: String,
    /// A point of it, metres.
    pub at: [f64; 2],
    /// Why.
    pub reason: &'static str,
    /// Buildings in it.
    pub buildings: usize,
    /// Volume of its buildings, m^3.
    pub volume_in_m3: f64,
    /// Volume of its block and landmarks, m^3.
    pub volume_out_m3: f64,
    /// Share of its buildings' ground that lies in its block or in landmarks.
    pub covered_share: f64,
}

impl FailingCell {
    /// Reasons of blocks that lie over their buildings as they should, and hold more or less.
    pub const GAPS: &str = "the block fills the gaps between its buildings";
    /// The same.
    pub const SMALL: &str = "the block is smaller than its buildings";
}
