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

/// Values on nodes, aligned with the axes of the scene, bilinear in between. Row 0 is the northernmost; x east, y north.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    north_west: DVec2,
    spacing: DVec2,
    cols: usize,
    rows: usize,
    values: Vec<f64>,
    range: [f64; 2],
    /// Smallest and largest value of each square of [`TILE`] x [`TILE`] nodes, row by row.
    tiles: Vec<[f64; 2]>,
}

/// Nodes along the side of a square whose range is known.
const TILE: usize = 16;

/// One cell of a [`Grid`]: `c[0] + c[1] u + c[2] v + c[3] u v`, `u` = column - `col`, `v` = row - `row`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bilinear {
    pub(crate) col: f64,
    pub(crate) row: f64,
    pub(crate) c: [f64; 4],
}

impl Bilinear {
    /// Value at fractional column and row.
    pub(crate) fn at(&self, g: DVec2) -> f64 {
        let (u, v) = (g.x - self.col, g.y - self.row);
        self.c[0] + self.c[1] * u + self.c[2] * v + self.c[3] * u * v
    }

    /// Derivatives along column and row.
    pub(crate) fn gradient(&self, g: DVec2) -> DVec2 {
        let (u, v) = (g.x - self.col, g.y - self.row);
        DVec2::new(self.c[1] + self.c[3] * v, self.c[2] + self.c[3] * u)
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
        Ok(Self { north_west, spacing, cols, rows, values, range, tiles })
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Scene units between columns and between rows.
    pub fn spacing(&self) -> DVec2 {
        self.spacing
    }

    /// Scene x, y of node (column 0, row 0).
    pub fn north_west(&self) -> DVec2 {
        self.north_west
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
        DVec2::new((xy.x - self.north_west.x) / self.spacing.x, (self.north_west.y - xy.y) / self.spacing.y)
    }

    /// Whether fractional column and row lie on the grid, rim included.
    pub fn contains(&self, g: DVec2) -> bool {
        g.x >= 0.0 && g.y >= 0.0 && g.x <= (self.cols - 1) as f64 && g.y <= (self.rows - 1) as f64
    }

    /// The cell of fractional column and row; on a grid line the one to its east or south. `None` outside.
    pub(crate) fn cell(&self, g: DVec2) -> Option<Bilinear> {
        self.contains(g).then(|| {
            let (col, row) = ((g.x as usize).min(self.cols - 2), (g.y as usize).min(self.rows - 2));
            let i = row * self.cols + col;
            let [nw, ne, sw, se] = [i, i + 1, i + self.cols, i + self.cols + 1].map(|k| self.values[k]);
            Bilinear { col: col as f64, row: row as f64, c: [nw, ne - nw, sw - nw, se - sw - ne + nw] }
        })
    }

    /// Bilinear value at a scene position; `None` outside.
    pub fn sample(&self, xy: DVec2) -> Option<f64> {
        let g = self.grid_from_scene(xy);
        self.cell(g).map(|cell| cell.at(g))
    }

    /// Smallest and largest value on the cells that touch the rectangle `min..=max` (scene x, y); `None` if none does.
    pub fn range_over(&self, min: DVec2, max: DVec2) -> Option<[f64; 2]> {
        let a = self.grid_from_scene(DVec2::new(min.x, max.y));
        let b = self.grid_from_scene(DVec2::new(max.x, min.y));
        let last = DVec2::new((self.cols - 1) as f64, (self.rows - 1) as f64);
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
            let line = &self.values[row * self.cols..][..self.cols];
            if !(is_inner && inner_rows.contains(&(row / TILE))) {
                range = with_all(range, &line[cols.clone()]);
                continue;
            }
            if row.is_multiple_of(TILE) {
                let tiles = &self.tiles[row / TILE * self.cols.div_ceil(TILE)..][inner_cols.clone()];
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
