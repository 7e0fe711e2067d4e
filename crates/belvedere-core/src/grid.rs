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
}

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
        let range = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
        Ok(Self { north_west, spacing, cols, rows, values, range })
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
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for row in a.y as usize..=b.y as usize {
            let line = &self.values[row * self.cols..][a.x as usize..=b.x as usize];
            range = line.iter().fold(range, |[lo, hi], &v| [lo.min(v), hi.max(v)]);
        }
        Some(range)
    }
}
