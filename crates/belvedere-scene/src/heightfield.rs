//! Terrain heights on a regular metric grid with holes.

use crate::cell::CellTriangle;
use belvedere_core::grid::Nodes;
use belvedere_core::{Aabb, DVec2, DVec3};
use std::ops::Index;

/// Whether a node carries a height.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum NodeState {
    /// No data: a hole.
    Void = 0,
    /// A measured (or resampled) height.
    #[default]
    Measured = 1,
    /// A height made up to close a hole (`fill_voids`).
    Filled = 2,
}

/// A heightfield that cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HeightfieldError {
    /// Fewer than 2 x 2 nodes.
    #[error("terrain has {cols} x {rows} nodes, at least 2 x 2 are needed")]
    TooSmall {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
    },
    /// Number of heights or states is not cols * rows.
    #[error("terrain of {cols} x {rows} nodes needs {expected} heights and states, got {heights} and {states}")]
    Length {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
        /// cols * rows.
        expected: usize,
        /// Heights given.
        heights: usize,
        /// States given.
        states: usize,
    },
    /// Spacing not positive.
    #[error("terrain spacing is {x} x {y}, both must be greater than 0")]
    Spacing {
        /// Along x.
        x: f64,
        /// Along y.
        y: f64,
    },
    /// A node that is not a void has no finite height.
    #[error("terrain node (column {col}, row {row}) has height {height}; mark it as a void instead")]
    NotFinite {
        /// Column.
        col: usize,
        /// Row.
        row: usize,
        /// Height found.
        height: f32,
    },
    /// No node has a height.
    #[error("terrain of {cols} x {rows} nodes holds no data at all")]
    AllVoid {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
    },
}

/// Heights on a grid of nodes, aligned with the axes of the scene. Row 0 is the northernmost.
///
/// Holes are a mask ([`NodeState::Void`]), never a magic height; the height stored at a void is 0 and has no meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Heightfield {
    north_west: DVec2,
    spacing: DVec2,
    cols: usize,
    rows: usize,
    heights: Vec<f32>,
    /// `None` where every node is measured, which saves a byte per node.
    states: Option<Vec<NodeState>>,
    z_range: [f64; 2],
}

/// States of all nodes, row-major. Takes no memory where every node is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct States<'a> {
    each: Option<&'a [NodeState]>,
    len: usize,
}

impl<'a> States<'a> {
    /// Number of nodes.
    pub fn len(self) -> usize {
        self.len
    }

    /// Whether there is no node; never true for a heightfield.
    pub fn is_empty(self) -> bool {
        self.len == 0
    }

    /// State of node `i`; `None` past the last.
    pub fn get(self, i: usize) -> Option<&'a NodeState> {
        self.each.map_or((i < self.len).then_some(&NodeState::Measured), |each| each.get(i))
    }

    /// The states in order.
    pub fn iter(self) -> impl ExactSizeIterator<Item = &'a NodeState> + Clone {
        (0..self.len).map(move |i| self.each.map_or(&NodeState::Measured, |each| &each[i]))
    }

    /// A copy.
    pub fn to_vec(self) -> Vec<NodeState> {
        self.each.map_or_else(|| vec![NodeState::Measured; self.len], <[_]>::to_vec)
    }

    /// The states node by node; `None` where every node is measured.
    pub fn each(self) -> Option<&'a [NodeState]> {
        self.each
    }
}

impl Index<usize> for States<'_> {
    type Output = NodeState;

    fn index(&self, i: usize) -> &NodeState {
        self.each.map_or(&NodeState::Measured, |each| &each[i])
    }
}

/// Nodes along each side whose slopes stand for all.
const SLOPES: usize = 128;

impl Heightfield {
    /// * `north_west`: scene x, y of node (0, 0);
    /// * `spacing`: metres between columns (towards east) and between rows (towards south), both > 0;
    /// * `heights`, `states`: row-major, `cols * rows` each.
    ///
    /// # Errors
    /// Every [`HeightfieldError`].
    pub fn new(
        north_west: DVec2,
        spacing: DVec2,
        cols: usize,
        rows: usize,
        heights: Vec<f32>,
        states: Vec<NodeState>,
    ) -> Result<Self, HeightfieldError> {
        let every = states.iter().all(|s| *s == NodeState::Measured) && states.len() == heights.len();
        Self::with_states(north_west, spacing, [cols, rows], heights, (!every).then_some(states))
    }

    /// [`Heightfield::new`] with a measured height at every node.
    ///
    /// # Errors
    /// Every [`HeightfieldError`].
    pub fn measured(
        north_west: DVec2,
        spacing: DVec2,
        cols: usize,
        rows: usize,
        heights: Vec<f32>,
    ) -> Result<Self, HeightfieldError> {
        Self::with_states(north_west, spacing, [cols, rows], heights, None)
    }

    fn with_states(
        north_west: DVec2,
        spacing: DVec2,
        [cols, rows]: [usize; 2],
        mut heights: Vec<f32>,
        states: Option<Vec<NodeState>>,
    ) -> Result<Self, HeightfieldError> {
        if cols < 2 || rows < 2 {
            return Err(HeightfieldError::TooSmall { cols, rows });
        }
        let given = states.as_ref().map_or(heights.len(), Vec::len);
        if heights.len() != cols * rows || given != cols * rows {
            let (expected, heights) = (cols * rows, heights.len());
            return Err(HeightfieldError::Length { cols, rows, expected, heights, states: given });
        }
        if !(spacing.x > 0.0 && spacing.y > 0.0 && spacing.is_finite() && north_west.is_finite()) {
            return Err(HeightfieldError::Spacing { x: spacing.x, y: spacing.y });
        }
        let mut z_range = [f64::INFINITY, f64::NEG_INFINITY];
        for (i, h) in heights.iter_mut().enumerate() {
            if states.as_ref().is_some_and(|states| states[i] == NodeState::Void) {
                *h = 0.0;
                continue;
            }
            if !h.is_finite() {
                return Err(HeightfieldError::NotFinite { col: i % cols, row: i / cols, height: *h });
            }
            z_range = [z_range[0].min(f64::from(*h)), z_range[1].max(f64::from(*h))];
        }
        if z_range[0] > z_range[1] {
            return Err(HeightfieldError::AllVoid { cols, rows });
        }
        Ok(Self { north_west, spacing, cols, rows, heights, states, z_range })
    }

    /// Where the nodes lie.
    pub fn nodes(&self) -> Nodes {
        Nodes { north_west: self.north_west, spacing: self.spacing, cols: self.cols, rows: self.rows }
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Metres between columns and between rows.
    pub fn spacing(&self) -> DVec2 {
        self.spacing
    }

    /// Scene x, y of node (column 0, row 0).
    pub fn north_west(&self) -> DVec2 {
        self.north_west
    }

    /// Heights, row-major; meaningless where [`Heightfield::states`] says void.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// States, row-major.
    pub fn states(&self) -> States<'_> {
        States { each: self.states.as_deref(), len: self.heights.len() }
    }

    /// Mean slope of the ground, rise by way, from an even selection of its nodes.
    pub fn usual_slope(&self) -> f64 {
        let [step_c, step_r] = [self.cols, self.rows].map(|n| (n / SLOPES).max(1));
        let (mut sum, mut count) = (0.0, 0u32);
        for row in (0..self.rows.saturating_sub(1)).step_by(step_r) {
            for col in (0..self.cols.saturating_sub(1)).step_by(step_c) {
                let around = [self.node(col, row), self.node(col + 1, row), self.node(col, row + 1)];
                if let [Some(here), Some(east), Some(south)] = around {
                    let rise = DVec2::new(east.z - here.z, south.z - here.z) / self.spacing;
                    (sum, count) = (sum + rise.length(), count + 1);
                }
            }
        }
        if count > 0 { sum / f64::from(count) } else { 0.0 }
    }

    /// Median height of the nodes that have one, the mean of the middle two of an even number; 0 without any.
    pub fn median_height(&self) -> f64 {
        let with_data = |(h, s): (&f32, &NodeState)| (*s != NodeState::Void).then_some(*h);
        let mut heights: Vec<f32> = self.heights.iter().zip(self.states().iter()).filter_map(with_data).collect();
        let middle = heights.len() / 2;
        if heights.is_empty() {
            return 0.0;
        }
        let (below, upper, _) = heights.select_nth_unstable_by(middle, f32::total_cmp);
        let upper = f64::from(*upper);
        match below.iter().copied().reduce(f32::max).filter(|_| heights.len().is_multiple_of(2)) {
            Some(lower) => 0.5 * (f64::from(lower) + upper),
            None => upper,
        }
    }

    fn is_void(&self, i: usize) -> bool {
        self.states.as_ref().is_some_and(|states| states[i] == NodeState::Void)
    }

    /// Smallest and largest height.
    pub fn z_range(&self) -> [f64; 2] {
        self.z_range
    }

    /// Scene position of a node; `None` at a void.
    pub fn node(&self, col: usize, row: usize) -> Option<DVec3> {
        let i = row * self.cols + col;
        (!self.is_void(i)).then(|| self.node_xy(col, row).extend(f64::from(self.heights[i])))
    }

    /// Scene x, y of a node.
    pub fn node_xy(&self, col: usize, row: usize) -> DVec2 {
        DVec2::new(self.north_west.x + col as f64 * self.spacing.x, self.north_west.y - row as f64 * self.spacing.y)
    }

    /// Fractional column and row of a scene position (may lie outside the grid).
    pub fn grid_from_scene(&self, xy: DVec2) -> DVec2 {
        DVec2::new((xy.x - self.north_west.x) / self.spacing.x, (self.north_west.y - xy.y) / self.spacing.y)
    }

    /// The cell (column, row) of a scene position and the position within it, 0..=1 each; `None` outside the grid.
    fn cell_at(&self, xy: DVec2) -> Option<([usize; 2], DVec2)> {
        let g = self.grid_from_scene(xy);
        let last = DVec2::new((self.cols - 1) as f64, (self.rows - 1) as f64);
        if !(g.x >= 0.0 && g.x <= last.x && g.y >= 0.0 && g.y <= last.y) {
            return None;
        }
        let (c, r) = ((g.x as usize).min(self.cols - 2), (g.y as usize).min(self.rows - 2));
        Some(([c, r], g - DVec2::new(c as f64, r as f64)))
    }

    /// Bilinear height at a scene position; `None` outside the grid or where one of the four nodes is a void.
    pub fn height_at(&self, xy: DVec2) -> Option<f64> {
        let ([c, r], f) = self.cell_at(xy)?;
        let (u, v) = (f.x, f.y);
        let i = r * self.cols + c;
        let corners = [i, i + 1, i + self.cols, i + self.cols + 1];
        let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let mut height = 0.0;
        for (k, w) in corners.into_iter().zip(weights) {
            if w == 0.0 {
                continue; // on a grid line the nodes beside it have no influence
            }
            if self.is_void(k) {
                return None;
            }
            height += w * f64::from(self.heights[k]);
        }
        Some(height)
    }

    /// Height of the drawn surface inside cell (`col`, `row`) at fractions `u` (east) and `v` (south) of the cell, 0..=1.
    ///
    /// Every cell is two triangles, see [`CellTriangle`]; a triangle with a void among its nodes is a hole (`None`).
    /// Renderers and lines of sight both stand on this surface.
    ///
    /// # Panics
    /// If the cell is not in the grid: `col + 1 < cols` and `row + 1 < rows` are needed.
    pub fn surface_in_cell(&self, col: usize, row: usize, u: f64, v: f64) -> Option<f64> {
        let nw = row * self.cols + col;
        let height = |i: usize| (!self.is_void(i)).then(|| f64::from(self.heights[i]));
        let corners = [nw, nw + 1, nw + self.cols, nw + self.cols + 1].map(height);
        CellTriangle::surface(corners, DVec2::new(u, v))
    }

    /// Height of the drawn surface (two triangles per cell, see [`Heightfield::surface_in_cell`]) at a scene
    /// position; `None` outside the grid and in holes. Differs from the bilinear [`Heightfield::height_at`] inside cells only.
    pub fn surface_at(&self, xy: DVec2) -> Option<f64> {
        let ([c, r], f) = self.cell_at(xy)?;
        self.surface_in_cell(c, r, f.x, f.y)
    }

    /// Share of nodes in `state`, 0..=1.
    pub fn share_of(&self, state: NodeState) -> f64 {
        self.states().iter().filter(|&&s| s == state).count() as f64 / self.heights.len() as f64
    }

    /// Smallest box around all nodes.
    pub fn bounds(&self) -> Aabb {
        let se = self.node_xy(self.cols - 1, self.rows - 1);
        Aabb {
            min: DVec3::new(self.north_west.x, se.y, self.z_range[0]),
            max: DVec3::new(se.x, self.north_west.y, self.z_range[1]),
        }
    }
}

#[cfg(test)]
mod tests;
