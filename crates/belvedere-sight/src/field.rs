//! The ground in grid coordinates, lowered by the curvature of the earth: the input of terrain disocclusion.

use belvedere_core::DVec2;
use belvedere_core::grid::Nodes;
use belvedere_scene::{CellTriangle, Heightfield, NodeState};

/// Terrain that has no heights.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// No node holds data.
    #[error("terrain of {cols} x {rows} nodes holds no data at all; give a DEM with heights, or fill its voids")]
    Empty {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
    },
}

/// Heights at the nodes of a grid. Grid coordinates: x = column (east), y = row (south); heights are scene units above
/// the scene's datum.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    cols: usize,
    rows: usize,
    north_west: DVec2,
    spacing: DVec2,
    heights: Vec<f64>,
    void: Vec<bool>,
    range: [f64; 2],
}

impl Field {
    /// * `drop`: height, scene units, by which the curvature of the earth lowers a node at scene x, y; 0 if flat.
    ///
    /// Void nodes take the lowest height of the data, so that they never hide anything, and are marked.
    ///
    /// # Errors
    /// [`FieldError::Empty`].
    pub fn new(hf: &Heightfield, drop: impl Fn(DVec2) -> f64) -> Result<Self, FieldError> {
        let node = |i: usize| hf.node_xy(i % hf.cols(), i / hf.cols());
        let void: Vec<bool> = hf.states().iter().map(|s| *s == NodeState::Void).collect();
        let heights = hf.heights().iter().enumerate().map(|(i, h)| f64::from(*h) - drop(node(i))).collect();
        Self::with([hf.cols(), hf.rows()], (hf.north_west(), hf.spacing()), heights, void)
    }

    /// The samples of a file in coordinates of its own grid: column times spacing, and minus row times spacing.
    ///
    /// * `nodes`: columns and rows, at least 2 each; `spacing`: scene units between them, about, both > 0;
    /// * `heights`: row-major; a height that is not finite is a void.
    ///
    /// # Errors
    /// [`FieldError::Empty`].
    pub fn of_samples(nodes: [usize; 2], spacing: DVec2, heights: Vec<f64>) -> Result<Self, FieldError> {
        let void = heights.iter().map(|h| !h.is_finite()).collect();
        Self::with(nodes, (DVec2::ZERO, spacing), heights, void)
    }

    fn with(
        [cols, rows]: [usize; 2],
        (north_west, spacing): (DVec2, DVec2),
        mut heights: Vec<f64>,
        void: Vec<bool>,
    ) -> Result<Self, FieldError> {
        let solid = heights.iter().zip(&void).filter(|(_, v)| !**v).map(|(h, _)| *h);
        let range = solid.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], h| [lo.min(h), hi.max(h)]);
        if range[0] > range[1] {
            return Err(FieldError::Empty { cols, rows });
        }
        for (h, v) in heights.iter_mut().zip(&void) {
            if *v {
                *h = range[0];
            }
        }
        Ok(Self { cols, rows, north_west, spacing, heights, void, range })
    }

    /// Grid coordinates of the node with an index, row-major.
    pub fn node(&self, i: usize) -> DVec2 {
        DVec2::new((i % self.cols) as f64, (i / self.cols) as f64)
    }

    /// Columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Columns and rows.
    pub fn nodes(&self) -> [usize; 2] {
        [self.cols, self.rows]
    }

    /// Where the nodes lie.
    pub fn places(&self) -> Nodes {
        Nodes { north_west: self.north_west, spacing: self.spacing, cols: self.cols, rows: self.rows }
    }

    /// Scene x, y of node (0, 0).
    pub fn north_west(&self) -> DVec2 {
        self.north_west
    }

    /// Scene units between columns and rows, both > 0.
    pub fn spacing(&self) -> DVec2 {
        self.spacing
    }

    /// Heights, row-major, row 0 north.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Whether each node is without data, row-major.
    pub fn void(&self) -> &[bool] {
        &self.void
    }

    /// Lowest height of the data: the datum of the greedy pass.
    pub fn datum(&self) -> f64 {
        self.range[0]
    }

    /// Highest minus lowest height of the data.
    pub fn relief(&self) -> f64 {
        self.range[1] - self.range[0]
    }

    /// Grid coordinates of scene x, y.
    pub fn grid_from_scene(&self, p: DVec2) -> DVec2 {
        DVec2::new((p.x - self.north_west.x) / self.spacing.x, (self.north_west.y - p.y) / self.spacing.y)
    }

    /// Whether grid coordinates lie on the grid, rim included.
    pub fn contains(&self, g: DVec2) -> bool {
        g.x >= 0.0 && g.y >= 0.0 && g.x <= (self.cols - 1) as f64 && g.y <= (self.rows - 1) as f64
    }

    /// Height of the drawn surface (see [`CellTriangle`]) at grid coordinates;
    /// `None` outside the grid and in triangles with a void among their nodes.
    pub fn surface_at(&self, g: DVec2) -> Option<f64> {
        if !self.contains(g) {
            return None;
        }
        let (col, row) = ((g.x as usize).min(self.cols - 2), (g.y as usize).min(self.rows - 2));
        let (u, v) = (g.x - col as f64, g.y - row as f64);
        let nw = row * self.cols + col;
        let height = |i: usize| (!self.void[i]).then(|| self.heights[i]);
        let corners = [nw, nw + 1, nw + self.cols, nw + self.cols + 1].map(height);
        CellTriangle::surface(corners, DVec2::new(u, v))
    }

    /// Lowers a node, by scene units; to raise it again, by less than it was lowered at most.
    pub fn lower(&mut self, i: usize, by: f64) {
        self.heights[i] -= by;
        self.range[0] = self.range[0].min(self.heights[i]);
    }

    /// Scene x, y of grid coordinates.
    pub fn scene_from_grid(&self, g: DVec2) -> DVec2 {
        DVec2::new(self.north_west.x + g.x * self.spacing.x, self.north_west.y - g.y * self.spacing.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_go_there_and_back_and_voids_lie_low() {
        let heights = vec![5.0, 7.0, -9999.0, 6.0, 4.0, 8.0];
        let states = (0..6).map(|i| if i == 2 { NodeState::Void } else { NodeState::Measured }).collect();
        let hf = Heightfield::new(DVec2::new(100.0, 900.0), DVec2::new(10.0, 20.0), 3, 2, heights, states).unwrap();
        let field = Field::new(&hf, |p| if p.x > 115.0 { 1.0 } else { 0.0 }).unwrap();
        assert_eq!(field.heights(), [5.0, 7.0, 4.0, 6.0, 4.0, 7.0]);
        assert_eq!((field.datum(), field.relief()), (4.0, 3.0));
        let g = DVec2::new(1.25, 0.5);
        assert_eq!(field.scene_from_grid(g), DVec2::new(112.5, 890.0));
        assert_eq!(field.grid_from_scene(field.scene_from_grid(g)), g);
    }

    #[test]
    fn the_surface_is_that_of_the_heightfield() {
        let heights: Vec<f32> = (0..20).map(|i| (i * i % 17) as f32).collect();
        let states = (0..20).map(|i| if i == 7 { NodeState::Void } else { NodeState::Measured }).collect();
        let hf = Heightfield::new(DVec2::new(0.0, 30.0), DVec2::splat(10.0), 5, 4, heights, states).unwrap();
        let field = Field::new(&hf, |_| 0.0).unwrap();
        for i in 0..45 * 35 {
            let g = 0.1 * DVec2::new(f64::from(i % 45), f64::from(i / 45)) - 0.1;
            let (ours, theirs) = (field.surface_at(g), hf.surface_at(field.scene_from_grid(g)));
            if let (Some(a), Some(b)) = (ours, theirs) {
                assert!((a - b).abs() < 1e-9, "{g}: {a} {b}");
            } else {
                // On the border of a hole rounding decides.
                assert!(ours.is_some() == theirs.is_some() || on_an_edge(g), "{g}: {ours:?} {theirs:?}");
            }
        }
    }

    fn on_an_edge(g: DVec2) -> bool {
        [g.x, g.y, g.x - g.y].iter().any(|x| (x - x.round()).abs() < 1e-9)
    }
}
