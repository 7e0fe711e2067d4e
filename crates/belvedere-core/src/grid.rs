//! Values on a regular grid of nodes.

use glam::DVec2;

/// A grid that cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// Fewer than 2 x 2 nodes.
    #[error("displacement grid has {cols} x {rows} nodes, at least 2 x 2 are needed")]
    TooSmall {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
    },
    /// The number of values is not `cols * rows`.
    #[error("displacement grid of {cols} x {rows} nodes needs as many values, got {given}")]
    Length {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
        /// Values given.
        given: usize,
    },
    /// The position is not finite, or a spacing is not finite and > 0.
    #[error(
        "displacement grid has its north-west node at ({x}, {y}) and spacing {dx} x {dy}; finite values and spacings greater than 0 are needed"
    )]
    Placement {
        /// x of the north-west node.
        x: f64,
        /// y of the north-west node.
        y: f64,
        /// Spacing along x.
        dx: f64,
        /// Spacing along y.
        dy: f64,
    },
    /// A value is NaN or infinite.
    #[error("displacement grid node (column {col}, row {row}) holds {value}; every node needs a finite value")]
    NotFinite {
        /// Column.
        col: usize,
        /// Row.
        row: usize,
        /// Value found.
        value: f64,
    },
}

/// Where the nodes of a grid lie, aligned with the axes of the scene. Row 0 is the northernmost; x east, y north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nodes {
    /// Scene x, y of node (column 0, row 0).
    pub north_west: DVec2,
    /// Scene units between columns (towards east) and rows (towards south), both > 0.
    pub spacing: DVec2,
    /// Columns, at least 2.
    pub cols: usize,
    /// Rows, at least 2.
    pub rows: usize,
}

impl Nodes {
    /// Fractional column and row of a scene position (may lie outside).
    pub fn grid_from_scene(&self, xy: DVec2) -> DVec2 {
        DVec2::new((xy.x - self.north_west.x) / self.spacing.x, (self.north_west.y - xy.y) / self.spacing.y)
    }

    /// Scene x, y of fractional column and row.
    pub fn scene_from_grid(&self, g: DVec2) -> DVec2 {
        DVec2::new(self.north_west.x + g.x * self.spacing.x, self.north_west.y - g.y * self.spacing.y)
    }

    /// Whether fractional column and row lie on the grid, rim included.
    pub fn contains(&self, g: DVec2) -> bool {
        g.x >= 0.0 && g.y >= 0.0 && g.x <= (self.cols - 1) as f64 && g.y <= (self.rows - 1) as f64
    }

    /// First node of the cell of fractional column and row on the grid; on a grid line that of the cell to its east or south.
    fn cell(&self, g: DVec2) -> [usize; 2] {
        [(g.x as usize).min(self.cols - 2), (g.y as usize).min(self.rows - 2)]
    }
}

/// Values on nodes. Between them they are bilinear, or those of a ground that is flat on its triangles, see [`Grid::on_facets`].
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    nodes: Nodes,
    facets: Option<Nodes>,
    values: Vec<f64>,
    range: [f64; 2],
    /// Smallest and largest value of each square of [`TILE`] x [`TILE`] nodes, row by row.
    tiles: Vec<[f64; 2]>,
}

/// Distance from a node, cells, below which a position is the node but for rounding.
const AT_NODE: f64 = 1e-9;

/// Nodes along the side of a square whose range is known.
const TILE: usize = 16;

/// The values on one cell of a grid, or on one triangle: `c[0] + c[1] u + c[2] v + c[3] u v`, where `u` and `v` are columns and rows
/// from its first node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Patch {
    nodes: Nodes,
    first: DVec2,
    c: [f64; 4],
}

impl Patch {
    fn on_cell(nodes: Nodes, first: [usize; 2], [nw, ne, sw, se]: [f64; 4]) -> Self {
        let first = DVec2::new(first[0] as f64, first[1] as f64);
        Self { nodes, first, c: [nw, ne - nw, sw - nw, se - sw - ne + nw] }
    }

    /// Cells are split from north-west to south-east, as ground is drawn and written; `inside`: the place in the cell.
    fn on_triangle(nodes: Nodes, first: [usize; 2], [nw, ne, sw, se]: [f64; 4], inside: DVec2) -> Self {
        let slope = if inside.x > inside.y { [ne - nw, se - ne] } else { [se - sw, sw - nw] };
        Self { nodes, first: DVec2::new(first[0] as f64, first[1] as f64), c: [nw, slope[0], slope[1], 0.0] }
    }

    fn inside(&self, xy: DVec2) -> DVec2 {
        self.nodes.grid_from_scene(xy) - self.first
    }

    /// Value at a scene position.
    pub(crate) fn at(&self, xy: DVec2) -> f64 {
        let DVec2 { x: u, y: v } = self.inside(xy);
        self.c[0] + self.c[1] * u + self.c[2] * v + self.c[3] * u * v
    }

    /// Change along scene x and y.
    pub(crate) fn gradient(&self, xy: DVec2) -> DVec2 {
        let DVec2 { x: u, y: v } = self.inside(xy);
        // Rows run towards south.
        DVec2::new(self.c[1] + self.c[3] * v, -self.c[2] - self.c[3] * u) / self.nodes.spacing
    }

    /// The second derivative along a step of the scene's plane, halved.
    pub(crate) fn bend(&self, step: DVec2) -> f64 {
        -self.c[3] * step.x * step.y / (self.nodes.spacing.x * self.nodes.spacing.y)
    }
}

const EMPTY: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// The range grown by all values.
fn with_all(range: [f64; 2], values: &[f64]) -> [f64; 2] {
    values.iter().fold(range, |[lo, hi], &v| [lo.min(v), hi.max(v)])
}

impl Grid {
    /// * `north_west`: scene x, y of node (0, 0);
    /// * `spacing`: scene units between columns (towards east) and rows (towards south), both > 0;
    /// * `values`: row-major, `cols * rows`, all finite.
    ///
    /// # Errors
    /// Every [`GridError`].
    pub fn new(
        north_west: DVec2,
        spacing: DVec2,
        cols: usize,
        rows: usize,
        values: Vec<f64>,
    ) -> Result<Self, GridError> {
        if cols < 2 || rows < 2 {
            return Err(GridError::TooSmall { cols, rows });
        }
        if cols.checked_mul(rows) != Some(values.len()) {
            return Err(GridError::Length { cols, rows, given: values.len() });
        }
        if !(spacing.x > 0.0 && spacing.y > 0.0 && spacing.is_finite() && north_west.is_finite()) {
            let (x, y, dx, dy) = (north_west.x, north_west.y, spacing.x, spacing.y);
            return Err(GridError::Placement { x, y, dx, dy });
        }
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return Err(GridError::NotFinite { col: i % cols, row: i / cols, value: values[i] });
        }
        let tiles = values.chunks(TILE * cols).flat_map(|lines| {
            let columns = (0..cols).step_by(TILE).map(|first| first..(first + TILE).min(cols));
            columns.map(|part| lines.chunks(cols).fold(EMPTY, |range, line| with_all(range, &line[part.clone()])))
        });
        let tiles: Vec<[f64; 2]> = tiles.collect();
        let range = tiles.iter().fold(EMPTY, |range, tile| with_all(range, tile));
        Ok(Self { nodes: Nodes { north_west, spacing, cols, rows }, facets: None, values, range, tiles })
    }

    /// The same values at the nodes of a ground, flat on its triangles between them: what moves by these values and stands on the
    /// ground stays on it. Beside the ground they stay bilinear, and where it lies beside this grid they are 0.
    pub fn on_facets(self, ground: Nodes) -> Self {
        Self { facets: Some(ground), ..self }
    }

    /// The ground on whose triangles the values are flat.
    pub fn facets(&self) -> Option<Nodes> {
        self.facets
    }

    /// Other values at the same nodes.
    pub(crate) fn with_values(&self, values: Vec<f64>) -> Result<Self, GridError> {
        let Nodes { north_west, spacing, cols, rows } = self.nodes;
        Ok(Self { facets: self.facets, ..Self::new(north_west, spacing, cols, rows, values)? })
    }

    /// Where the nodes lie.
    pub fn nodes(&self) -> Nodes {
        self.nodes
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.nodes.cols
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.nodes.rows
    }

    /// Scene units between columns and between rows.
    pub fn spacing(&self) -> DVec2 {
        self.nodes.spacing
    }

    /// Scene x, y of node (column 0, row 0).
    pub fn north_west(&self) -> DVec2 {
        self.nodes.north_west
    }

    /// Values, row-major.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Smallest and largest value.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// Fractional column and row of a scene position (may lie outside).
    pub fn grid_from_scene(&self, xy: DVec2) -> DVec2 {
        self.nodes.grid_from_scene(xy)
    }

    /// The values of the cell around a scene position; `None` beside the grid.
    fn cell(&self, xy: DVec2) -> Option<Patch> {
        let g = self.nodes.grid_from_scene(xy);
        self.nodes.contains(g).then(|| {
            let first = self.nodes.cell(g);
            let cols = self.nodes.cols;
            let i = first[1] * cols + first[0];
            Patch::on_cell(self.nodes, first, [i, i + 1, i + cols, i + cols + 1].map(|k| self.values[k]))
        })
    }

    /// The values around a scene position; `None` where they are 0 because it lies beside the grid.
    pub(crate) fn patch(&self, xy: DVec2) -> Option<Patch> {
        let Some((ground, g)) = self.on_ground(xy) else { return self.cell(xy) };
        let first = ground.cell(g);
        let corner = DVec2::new(first[0] as f64, first[1] as f64);
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        let value = |d: DVec2| self.at_node(ground.scene_from_grid(corner + d));
        Some(Patch::on_triangle(ground, first, corners.map(value), g - corner))
    }

    /// The ground whose triangles count at a scene position, and the column and row there.
    fn on_ground(&self, xy: DVec2) -> Option<(Nodes, DVec2)> {
        let ground = self.facets?;
        let g = ground.grid_from_scene(xy);
        ground.contains(g).then_some((ground, g))
    }

    fn at_node(&self, xy: DVec2) -> f64 {
        self.cell(xy).map_or(0.0, |cell| cell.at(xy))
    }

    /// Value at a scene position; `None` beside the grid.
    pub fn sample(&self, xy: DVec2) -> Option<f64> {
        match self.on_ground(xy) {
            Some((_, g)) if (g - g.round()).abs().max_element() > AT_NODE => self.patch(xy).map(|patch| patch.at(xy)),
            _ => self.cell(xy).map(|cell| cell.at(xy)),
        }
    }

    /// Smallest and largest value over the rectangle `min..=max` (scene x, y), with the 0 beside the grid.
    pub fn span_over(&self, min: DVec2, max: DVec2) -> [f64; 2] {
        let [low, high] = self.range_over(min, max).unwrap_or([0.0; 2]);
        let is_inside = |xy: DVec2| self.nodes.contains(self.nodes.grid_from_scene(xy));
        if self.reach(min, max).into_iter().all(is_inside) { [low, high] } else { [low.min(0.0), high.max(0.0)] }
    }

    /// The rectangle whose nodes the values over the rectangle `min..=max` (scene x, y) come from.
    fn reach(&self, min: DVec2, max: DVec2) -> [DVec2; 2] {
        let Some(ground) = self.facets else { return [min, max] };
        let last = DVec2::new((ground.cols - 1) as f64, (ground.rows - 1) as f64);
        let (a, b) =
            (ground.grid_from_scene(DVec2::new(min.x, max.y)), ground.grid_from_scene(DVec2::new(max.x, min.y)));
        if !(a.cmple(last).all() && b.cmpge(DVec2::ZERO).all()) {
            return [min, max];
        }
        let [nw, se] = [a.max(DVec2::ZERO).floor(), b.min(last).ceil()].map(|g| ground.scene_from_grid(g));
        [min.min(DVec2::new(nw.x, se.y)), max.max(DVec2::new(se.x, nw.y))]
    }

    /// Smallest and largest value at the nodes around the rectangle `min..=max` (scene x, y); `None` if it lies beside the grid.
    pub fn range_over(&self, min: DVec2, max: DVec2) -> Option<[f64; 2]> {
        let [min, max] = self.reach(min, max);
        let a = self.grid_from_scene(DVec2::new(min.x, max.y));
        let b = self.grid_from_scene(DVec2::new(max.x, min.y));
        let Nodes { cols: across, rows: down, .. } = self.nodes;
        let last = DVec2::new((across - 1) as f64, (down - 1) as f64);
        if !(a.x <= last.x && a.y <= last.y && b.x >= 0.0 && b.y >= 0.0) {
            return None;
        }
        let (a, b) = (a.floor().max(DVec2::ZERO), b.ceil().min(last));
        if a == DVec2::ZERO && b == last {
            return Some(self.range);
        }
        let (cols, rows) = (a.x as usize..b.x as usize + 1, a.y as usize..b.y as usize + 1);
        // Whole squares, and what lies around them.
        let [inner_cols, inner_rows] = [&cols, &rows].map(|n| n.start.div_ceil(TILE)..n.end / TILE);
        let is_inner = !inner_cols.is_empty() && !inner_rows.is_empty();
        let mut range = EMPTY;
        for row in rows {
            let line = &self.values[row * across..][..across];
            if !(is_inner && inner_rows.contains(&(row / TILE))) {
                range = with_all(range, &line[cols.clone()]);
                continue;
            }
            if row.is_multiple_of(TILE) {
                let tiles = &self.tiles[row / TILE * across.div_ceil(TILE)..][inner_cols.clone()];
                range = tiles.iter().fold(range, |range, tile| with_all(range, tile));
            }
            range = with_all(range, &line[cols.start..inner_cols.start * TILE]);
            range = with_all(range, &line[inner_cols.end * TILE..cols.end]);
        }
        Some(range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_rectangles_are_those_of_their_nodes() {
        for (cols, rows) in [(2, 2), (15, 70), (64, 33), (101, 97)] {
            let value = |i: usize| (i as f64 * 0.618_033_988_75).fract() * (1.0 + (i % 7) as f64) - 2.0;
            let grid = Grid::new(
                DVec2::new(5.0, 9.0),
                DVec2::new(2.0, 3.0),
                cols,
                rows,
                (0..cols * rows).map(value).collect(),
            );
            let grid = grid.expect("grid");
            for k in 0..400u32 {
                let at = |seed: f64, n: usize| (f64::from(k) * seed).fract() * (n as f64 + 1.0) - 1.0;
                let (a, b) =
                    (DVec2::new(at(0.317, cols), at(0.731, rows)), DVec2::new(at(0.557, cols), at(0.113, rows)));
                let (from, to) = (a.min(b), a.max(b));
                let scene = |g: DVec2| DVec2::new(5.0 + 2.0 * g.x, 9.0 - 3.0 * g.y);
                let found = grid.range_over(scene(DVec2::new(from.x, to.y)), scene(DVec2::new(to.x, from.y)));
                let touched = |lo: f64, hi: f64, i: usize| i as f64 >= lo.floor() && i as f64 <= hi.ceil();
                let nodes =
                    (0..cols * rows).filter(|i| touched(from.x, to.x, i % cols) && touched(from.y, to.y, i / cols));
                let all: Vec<f64> = nodes.map(value).collect();
                match found {
                    Some(range) => assert_eq!(range, with_all(EMPTY, &all), "{cols} x {rows}: {from} to {to}"),
                    None => assert!(to.min_element() < 0.0 || from.x > (cols - 1) as f64 || from.y > (rows - 1) as f64),
                }
            }
            assert_eq!(grid.range(), with_all(EMPTY, grid.values()));
        }
    }
}
