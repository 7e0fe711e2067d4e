//! The large forms of the ground as a bicubic B-spline surface.

use glam::DVec2;

/// A bicubic B-spline surface over a regular grid of control heights; constant beyond its rim, twice differentiable everywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseSurface {
    /// Scene position of control height (0, 0); columns go east, rows north.
    south_west: DVec2,
    spacing: f64,
    cols: usize,
    control: Vec<f64>,
    /// Bounds on the second derivatives xx, xy and yy, 1 / scene unit.
    curvature: [f64; 3],
}

/// Control heights that do not form a grid of finite values.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BaseError {
    /// Fewer than 2 x 2 heights, or not a whole number of rows.
    #[error("{count} heights are no grid of {cols} columns; at least 2 by 2 are needed")]
    Shape {
        /// Heights.
        count: usize,
        /// Columns.
        cols: usize,
    },
    /// A height or position is not finite, or the spacing is not > 0.
    #[error("the base surface needs finite heights and a spacing > 0, not {value}")]
    NotFinite {
        /// The value.
        value: f64,
    },
}

impl BaseSurface {
    /// * `south_west`: position of the first height, scene coordinates.
    /// * `spacing`: between heights, scene units, > 0.
    /// * `control`: heights, rows from south to north, scene units.
    ///
    /// # Errors
    /// Every [`BaseError`].
    pub fn new(south_west: DVec2, spacing: f64, cols: usize, control: Vec<f64>) -> Result<Self, BaseError> {
        let count = control.len();
        if cols < 2 || count < 2 * cols || !count.is_multiple_of(cols) {
            return Err(BaseError::Shape { count, cols });
        }
        let numbers = control.iter().chain([&spacing, &south_west.x, &south_west.y]);
        if let Some(&value) = numbers.into_iter().find(|v| !v.is_finite()) {
            return Err(BaseError::NotFinite { value });
        }
        if spacing <= 0.0 {
            return Err(BaseError::NotFinite { value: spacing });
        }
        let mut base = Self { south_west, spacing, cols, control, curvature: [0.0; 3] };
        base.curvature = base.differences().map(|d| d / (spacing * spacing));
        Ok(base)
    }

    /// Largest second differences of neighbours, which bound the second derivatives: those are averages of them.
    fn differences(&self) -> [f64; 3] {
        let mut most = [0.0f64; 3];
        for r in 0..self.rows() as i64 {
            for c in 0..self.cols as i64 {
                let at = |i: i64, j: i64| self.control_at(c + i, r + j);
                let [xx, yy] = [[1, 0], [0, 1]].map(|[i, j]| at(i, j) - 2.0 * at(0, 0) + at(-i, -j));
                let xy = at(1, 1) - at(1, 0) - at(0, 1) + at(0, 0);
                most = [most[0].max(xx.abs()), most[1].max(xy.abs()), most[2].max(yy.abs())];
            }
        }
        most
    }

    fn rows(&self) -> usize {
        self.control.len() / self.cols
    }

    /// Control height; beyond the rim that of the nearest node.
    fn control_at(&self, col: i64, row: i64) -> f64 {
        let [c, r] = [(col, self.cols), (row, self.rows())].map(|(i, n)| i.clamp(0, n as i64 - 1) as usize);
        self.control[r * self.cols + c]
    }

    /// Cell (column, row) and position in it, 0..1; clamped three cells outside the grid, where the surface is constant.
    fn place(&self, xy: DVec2) -> ([i64; 2], DVec2) {
        let last = DVec2::new(self.cols as f64 + 2.0, self.rows() as f64 + 2.0);
        let g = ((xy - self.south_west) / self.spacing).clamp(DVec2::splat(-3.0), last);
        let cell = g.floor();
        ([cell.x as i64, cell.y as i64], g - cell)
    }

    fn blend(&self, [col, row]: [i64; 2], u: [f64; 4], v: [f64; 4]) -> f64 {
        let line =
            |j: usize| (0..4).map(|i| u[i] * self.control_at(col + i as i64 - 1, row + j as i64 - 1)).sum::<f64>();
        (0..4).map(|j| v[j] * line(j)).sum()
    }

    /// Height at `xy`, scene units. `xy` must be finite.
    pub fn height(&self, xy: DVec2) -> f64 {
        let (cell, t) = self.place(xy);
        self.blend(cell, weights(t.x), weights(t.y))
    }

    /// Slope towards east and north.
    pub fn gradient(&self, xy: DVec2) -> DVec2 {
        let (cell, t) = self.place(xy);
        let [dx, dy] = [(slopes(t.x), weights(t.y)), (weights(t.x), slopes(t.y))].map(|(u, v)| self.blend(cell, u, v));
        DVec2::new(dx, dy) / self.spacing
    }

    /// Bound on the second derivative along an edge with this extent in plan, times its length squared.
    pub(super) fn bow(&self, along: DVec2) -> f64 {
        let [xx, xy, yy] = self.curvature;
        let (x, y) = (along.x.abs(), along.y.abs());
        xx * x * x + 2.0 * xy * x * y + yy * y * y
    }

    /// Lower and upper bound of the height over a rectangle.
    pub(super) fn range(&self, min: DVec2, max: DVec2) -> [f64; 2] {
        /// For more control heights than this the range of the whole grid is returned.
        const RANGED: i64 = 4096;
        let (([c0, r0], _), ([c1, r1], _)) = (self.place(min), self.place(max));
        let fold = |[lo, hi]: [f64; 2], v: f64| [lo.min(v), hi.max(v)];
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        // A B-spline lies within the hull of the control heights that act on it.
        if (c1 - c0 + 4) * (r1 - r0 + 4) > RANGED {
            return self.control.iter().copied().fold(none, fold);
        }
        let rows = r0 - 1..=r1 + 2;
        rows.flat_map(|r| (c0 - 1..=c1 + 2).map(move |c| (c, r))).map(|(c, r)| self.control_at(c, r)).fold(none, fold)
    }
}

/// Weights of four neighbours: the uniform cubic B-spline.
fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    let inner = |t: f64| (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0;
    [s * s * s / 6.0, inner(t), inner(s), t * t * t / 6.0]
}

/// Derivatives of the four weights.
fn slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    let inner = |t: f64| (-12.0 * t + 9.0 * t * t) / 6.0;
    [-s * s / 2.0, inner(t), -inner(s), t * t / 2.0]
}
