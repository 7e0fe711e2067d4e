//! The paper's method: normal equations and one sparse Cholesky factorisation.

use std::collections::BTreeMap;

use rsparse::data::{Nmrc, Sprs, Symb};

use super::elevation::ElevationRows;
use super::smoother::SmoothError;

/// Sparse Cholesky factor of `A^T A = L^2 + (w^2 + g^2) I + W^T W` on a grid (Deng et al. 2013, equation (16)), in an order
/// that keeps it sparse (approximate minimum degree).
pub struct Cholesky {
    order: Symb,
    factor: Nmrc<f64>,
    permuted: Vec<f64>,
}

impl Cholesky {
    /// * `cols`, `rows`: the grid, both >= 1. `shift`: w^2 + g^2 on this grid.
    /// * `elevation`: W.
    ///
    /// # Errors
    /// [`SmoothError::NotDefinite`] if the matrix has no factor: `shift` is too small for it.
    pub fn new(cols: usize, rows: usize, shift: f64, elevation: &ElevationRows) -> Result<Self, SmoothError> {
        let not_definite = || SmoothError::NotDefinite { cols, rows, shift };
        let matrix = normal_equations(cols, rows, shift, elevation);
        let mut order = rsparse::schol(&matrix, 0);
        let factor = rsparse::chol(&matrix, &mut order).map_err(|_| not_definite())?;
        if !factor.l.x.iter().all(|l| l.is_finite()) {
            return Err(not_definite());
        }
        Ok(Self { order, factor, permuted: vec![0.0; cols * rows] })
    }

    /// Numbers in the factor that are not zero.
    pub fn entries(&self) -> usize {
        self.factor.l.x.len()
    }

    /// Solves in place.
    ///
    /// # Panics
    /// If `rhs` has another size than the grid.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        assert_eq!(rhs.len(), self.permuted.len(), "values of the grid");
        let place = |i: usize| self.order.pinv.as_ref().map_or(i, |p| p[i] as usize);
        for (i, b) in rhs.iter().enumerate() {
            self.permuted[place(i)] = *b;
        }
        rsparse::lsolve(&self.factor.l, &mut self.permuted);
        rsparse::ltsolve(&self.factor.l, &mut self.permuted);
        for (i, x) in rhs.iter_mut().enumerate() {
            *x = self.permuted[place(i)];
        }
    }
}

impl std::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cholesky").field("nodes", &self.permuted.len()).finish_non_exhaustive()
    }
}

/// The matrix by columns, both halves of it.
fn normal_equations(cols: usize, rows: usize, shift: f64, elevation: &ElevationRows) -> Sprs<f64> {
    let n = cols * rows;
    let mut columns: Vec<BTreeMap<usize, f64>> = (0..n).map(|i| BTreeMap::from([(i, shift)])).collect();
    let mut add_row = |terms: &[(usize, f64)]| {
        for (i, a) in terms {
            for (j, b) in terms {
                *columns[*i].entry(*j).or_default() += a * b;
            }
        }
    };
    for i in 0..n {
        let (x, y) = (i % cols, i / cols);
        let around = [
            (x > 0).then(|| i - 1),
            (x + 1 < cols).then_some(i + 1),
            (y > 0).then(|| i - cols),
            (y + 1 < rows).then_some(i + cols),
        ];
        let mut laplacian: Vec<(usize, f64)> = around.into_iter().flatten().map(|j| (j, 1.0)).collect();
        laplacian.push((i, -(laplacian.len() as f64)));
        add_row(&laplacian);
    }
    for k in 0..elevation.len() {
        let (nodes, factors) = elevation.row(k);
        let terms: Vec<(usize, f64)> = nodes.iter().zip(factors).map(|(n, f)| (*n as usize, f)).collect();
        add_row(&terms);
    }
    let mut out = Sprs::new();
    (out.m, out.n) = (n, n);
    out.p = vec![0];
    for column in columns {
        out.i.extend(column.keys());
        out.x.extend(column.values());
        out.p.push(out.i.len() as isize);
    }
    out.nzmax = out.i.len();
    out
}
