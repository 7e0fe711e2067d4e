//! H = L^2 + (w^2 + g^2) I and its inverse.

use super::dct::Dct;
use super::line::Real;
use super::packs::Packs;
use super::products::{self, Products};

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

/// Weight on a grid of `longer` nodes along its longer side from the weight stated for 129 nodes: w goes with the square
/// of the spacing, because L does.
pub fn grid_weight(w: f64, longer: usize) -> f64 {
    let ratio = 128.0 / (longer.max(2) - 1) as f64;
    w * ratio * ratio
}

/// Solves with H = L^2 + (w^2 + g^2) I on a grid; L is the five-point Laplacian with mirrored borders (diagonal = minus
/// the number of neighbours), the rows are those of equations (12), (13) and (15). Diagonal under the cosine transform:
/// `H = C^T diag((ex_i + ey_j)^2 + w^2 + g^2) C`.
#[derive(Debug, Clone)]
pub struct Smoother<T: Real = f64> {
    dct: Dct<T>,
    fast: Fast,
    ex: Vec<T>,
    ey: Vec<T>,
    w: f64,
    g: f64,
}

/// The quickest way for a size, in f64.
#[derive(Debug, Clone)]
enum Fast {
    Products(Box<Products>),
    Packs(Packs),
    None,
}

impl Fast {
    fn new(cols: usize, rows: usize) -> Self {
        if cols.max(rows) <= products::MOST {
            return Self::Products(Box::new(Products::new(cols, rows)));
        }
        Packs::new(cols, rows).map_or(Self::None, Self::Packs)
    }
}

impl<T: Real> Smoother<T> {
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
        let e = |n: usize| (0..n).map(|k| T::of(eigenvalue(k, n))).collect();
        let fast = if T::doubles(&mut []).is_some() { Fast::new(cols, rows) } else { Fast::None };
        Ok(Self { dct: Dct::new(cols, rows), fast, ex: e(cols), ey: e(rows), w, g })
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
    pub fn eigenvalues(&self) -> (&[T], &[T]) {
        (&self.ex, &self.ey)
    }

    /// The cosine transform that makes H diagonal.
    pub fn dct(&mut self) -> &mut Dct<T> {
        &mut self.dct
    }

    /// H^-1, in place: `rhs` (row-major) becomes the solution.
    ///
    /// # Panics
    /// If `rhs` has another size than the grid.
    pub fn solve(&mut self, rhs: &mut [T]) {
        assert_eq!(rhs.len(), self.ex.len() * self.ey.len(), "values of a grid");
        let shift = self.shift();
        match (&mut self.fast, T::doubles(rhs)) {
            (Fast::Products(fast), Some(rhs)) => fast.solve(rhs, shift),
            (Fast::Packs(fast), Some(rhs)) => fast.solve(rhs, shift),
            _ => self.solve_by_lines(rhs),
        }
    }

    /// H^-1, in place, whatever the size of the grid; what [`Self::solve`] is judged by.
    pub fn solve_by_lines(&mut self, rhs: &mut [T]) {
        let (ex, ey, shift) = (&self.ex, &self.ey, T::of(self.shift()));
        self.dct.filter(rhs, |k, spectrum| {
            for (x, ey) in spectrum.iter_mut().zip(ey) {
                let e = ex[k] + *ey;
                *x = *x / (e * e + shift);
            }
        });
    }

    /// H x into `out`, by the stencil; `work` is used up. All three have the size of the grid.
    pub fn apply(&self, x: &[T], work: &mut [T], out: &mut [T]) {
        let shift = T::of(self.shift());
        laplacian(self.cols(), x, work);
        laplacian(self.cols(), work, out);
        for (o, x) in out.iter_mut().zip(x) {
            *o = *o + shift * *x;
        }
    }
}

/// k-th eigenvalue of the Laplacian of n nodes in a line with mirrored ends.
pub(super) fn eigenvalue(k: usize, n: usize) -> f64 {
    // 2 cos(x) - 2 without its cancellation at small x.
    let s = (std::f64::consts::FRAC_PI_2 * k as f64 / n as f64).sin();
    -4.0 * s * s
}

/// L x into `out`: sum of the neighbours minus their number times the value, for a grid of `cols` columns, row-major.
///
/// # Panics
/// If the sizes differ or are no multiple of `cols`.
pub fn laplacian<T: Real>(cols: usize, x: &[T], out: &mut [T]) {
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
            line[c - 1] = line[c - 1] + step;
            line[c] = line[c] - step;
        }
    }
}
