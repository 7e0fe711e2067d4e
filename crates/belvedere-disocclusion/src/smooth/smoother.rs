//! H = L^2 + (w^2 + g^2) I and its inverse.

use super::cosine::{CosineTransform, eigenvalue};

/// A smooth pass that cannot be set up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SmoothError {
    /// Weight out of range.
    #[error("smoothness weight {w} on the solver's grid; give one from 1e-9 to 1e9")]
    Weight {
        /// Weight on the solver's grid.
        w: f64,
    },
    /// Temporal weight out of range.
    #[error("temporal weight {g} on the solver's grid; give one from 0 to 1e9")]
    Temporal {
        /// Weight on the solver's grid.
        g: f64,
    },
    /// No Cholesky factor.
    #[error("the matrix of {cols} x {rows} nodes with w^2 + g^2 = {shift} has no factor; give larger weights")]
    NotDefinite {
        /// Columns.
        cols: usize,
        /// Rows.
        rows: usize,
        /// w^2 + g^2 on the solver's grid.
        shift: f64,
    },
}

/// Smoothness weight on a grid of `intervals` intervals along the longer side, from the weight stated for 128 intervals: w is
/// proportional to the square of the spacing, because L is.
pub fn grid_weight(w: f64, intervals: f64) -> f64 {
    let ratio = 128.0 / intervals;
    w * ratio * ratio
}

/// Solves with H = L^2 + (w^2 + g^2) I on a grid; L is the five-point Laplacian with mirrored borders (diagonal = minus
/// the number of neighbours), the rows are those of equations (12), (13) and (15). Diagonal under the cosine transform:
/// `H = C^T diag((ex_i + ey_j)^2 + w^2 + g^2) C`.
#[derive(Debug, Clone)]
pub struct Smoother {
    transform: CosineTransform,
    ex: Vec<f64>,
    ey: Vec<f64>,
    w: f64,
    g: f64,
}

impl Smoother {
    /// * `cols`, `rows`: the grid, both >= 1.
    /// * `w`, `g`: smoothness and temporal weight on this grid (see [`grid_weight`]).
    ///
    /// # Errors
    /// [`SmoothError`] if a weight is out of range.
    pub fn new(cols: usize, rows: usize, w: f64, g: f64) -> Result<Self, SmoothError> {
        if !(1e-9..=1e9).contains(&w) {
            return Err(SmoothError::Weight { w });
        }
        if !(0.0..=1e9).contains(&g) {
            return Err(SmoothError::Temporal { g });
        }
        let e = |n: usize| (0..n).map(|k| eigenvalue(k, n)).collect();
        Ok(Self { transform: CosineTransform::new(cols, rows), ex: e(cols), ey: e(rows), w, g })
    }

    /// Columns.
    pub fn cols(&self) -> usize {
        self.ex.len()
    }

    /// Rows.
    pub fn rows(&self) -> usize {
        self.ey.len()
    }

    /// Smoothness weight on this grid.
    pub fn w(&self) -> f64 {
        self.w
    }

    /// Temporal weight on this grid.
    pub fn g(&self) -> f64 {
        self.g
    }

    /// Another temporal weight, clamped to what is possible. The transforms stay.
    pub fn set_g(&mut self, g: f64) {
        self.g = if g.is_finite() { g.clamp(0.0, 1e9) } else { 0.0 };
    }

    /// w^2 + g^2.
    pub fn shift(&self) -> f64 {
        self.w * self.w + self.g * self.g
    }

    /// Eigenvalues of the one-dimensional Laplacians, `2 cos(pi k / n) - 2`: along x (columns) and y (rows).
    pub fn eigenvalues(&self) -> (&[f64], &[f64]) {
        (&self.ex, &self.ey)
    }

    /// H^-1, in place: `rhs` (row-major) becomes the solution.
    ///
    /// # Panics
    /// If `rhs` has another size than the grid.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        assert_eq!(rhs.len(), self.ex.len() * self.ey.len(), "values of a grid");
        let (ex, ey, shift) = (&self.ex, &self.ey, self.shift());
        self.transform.filter(rhs, |k, l| {
            let e = ex[k] + ey[l];
            1.0 / (e * e + shift)
        });
    }

    /// H x into `out`, by the stencil; `work` is used up. All three have the size of the grid.
    pub fn apply(&self, x: &[f64], work: &mut [f64], out: &mut [f64]) {
        let shift = self.shift();
        laplacian(self.cols(), x, work);
        laplacian(self.cols(), work, out);
        for (o, x) in out.iter_mut().zip(x) {
            *o += shift * *x;
        }
    }
}

/// L x into `out`: sum of the neighbours minus their number times the value, for a grid of `cols` columns, row-major.
///
/// # Panics
/// If the sizes differ or are not a multiple of `cols`.
pub fn laplacian(cols: usize, x: &[f64], out: &mut [f64]) {
    assert!(cols > 0 && x.len().is_multiple_of(cols) && x.len() == out.len(), "values of a grid");
    let rows = x.len() / cols;
    for (r, line) in out.chunks_exact_mut(cols).enumerate() {
        let row = |r: usize| &x[r * cols..(r + 1) * cols];
        let (up, here, down) = (row(r.saturating_sub(1)), row(r), row((r + 1).min(rows - 1)));
        for (((o, u), h), d) in line.iter_mut().zip(up).zip(here).zip(down) {
            *o = (*u - *h) + (*d - *h);
        }
        for c in 1..cols {
            let step = here[c] - here[c - 1];
            line[c - 1] += step;
            line[c] -= step;
        }
    }
}
