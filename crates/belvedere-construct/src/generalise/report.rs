//! What a generalisation says about itself.

use serde::Serialize;

/// Figures of a generalisation.
#[derive(Debug, Clone, Serialize)]
pub struct GeneraliseReport {
    /// Buildings of the city.
    pub buildings: usize,
    /// Buildings without an outline that has an area, left out.
    pub without_area: usize,
    /// Footprint area times height over all other buildings, m^3.
    pub volume_m3: f64,
    /// The levels, finest first.
    pub levels: Vec<LevelReport>,
    /// What was odd or assumed.
    pub notes: Vec<String>,
    /// Time, seconds.
    pub seconds: f64,
}

/// Figures of one level.
#[derive(Debug, Clone, Serialize)]
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
    /// Cells without a block that are green.
    pub green_cells: usize,
    /// Buildings in green cells, which are not shown.
    pub buildings_in_green: usize,
    /// Their volume, m^3.
    pub volume_in_green_m3: f64,
    /// Buildings kept in their own shape.
    pub landmarks: usize,
    /// Area times height times coverage of the blocks, and the volume of the landmarks, m^3.
    pub volume_m3: f64,
    /// The same as a share of all that came in.
    pub volume_share: f64,
    /// Whether that share lies in 0.9..=1.1.
    pub volume_kept: bool,
    /// Cells whose own volume is not kept to 10 %, green ones included.
    pub cells_failing: Vec<FailingCell>,
}

/// A cell whose block does not hold the volume of its buildings.
#[derive(Debug, Clone, Serialize)]
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
}
