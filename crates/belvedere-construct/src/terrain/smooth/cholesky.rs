//! The paper's own way: normal equations, factorised once.

use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, MatMut, Side};

use super::elevation::ElevationRows;
use super::smoother::SmoothError;

/// Sparse Cholesky factor of `A^T A = L^2 + (w^2 + g^2) I + W^T W` on a grid (Deng et al. 2013, equation (16)).
pub struct Cholesky {
    cells: usize,
    factor: Llt<usize, f64>,
}

impl Cholesky {
    /// * `cols`, `rows`: the grid. `shift`: w^2 + g^2 on this grid.
    /// * `elevation`: W.
    ///
    /// # Errors
    /// [`SmoothError::NotDefinite`] if the matrix has no factor: `shift` is too small for it.
    pub fn new(cols: usize, rows: usize, shift: f64, elevation: &ElevationRows) -> Result<Self, SmoothError> {
        let cells = cols * rows;
        let mut entries = Vec::with_capacity(14 * cells);
        let mut outer = |terms: &[(usize, f64)]| {
            for (i, a) in terms {
                for (j, b) in terms.iter().filter(|(j, _)| j <= i) {
                    entries.push(Triplet::new(*i, *j, a * b));
                }
            }
        };
        let root = shift.sqrt();
        for i in 0..cells {
            let (x, y) = (i % cols, i / cols);
            let mut terms = vec![(i, 0.0)];
            let inside = [
                (x > 0, i.wrapping_sub(1)),
                (x + 1 < cols, i + 1),
                (y > 0, i.wrapping_sub(cols)),
                (y + 1 < rows, i + cols),
            ];
            terms.extend(inside.iter().filter(|(inside, _)| *inside).map(|(_, j)| (*j, 1.0)));
            terms[0].1 = -((terms.len() - 1) as f64);
            outer(&terms);
            outer(&[(i, root)]);
        }
        for k in 0..elevation.len() {
            let (nodes, factors) = elevation.row(k);
            let mut terms: Vec<(usize, f64)> = Vec::with_capacity(4);
            for (n, f) in nodes.iter().zip(factors) {
                match terms.iter_mut().find(|(m, _)| *m == *n as usize) {
                    Some(term) => term.1 += f,
                    None => terms.push((*n as usize, f)),
                }
            }
            outer(&terms);
        }
        let not_definite = || SmoothError::NotDefinite { cols, rows, shift };
        let matrix =
            SparseColMat::<usize, f64>::try_new_from_triplets(cells, cells, &entries).map_err(|_| not_definite())?;
        let factor = matrix.sp_cholesky(Side::Lower).map_err(|_| not_definite())?;
        Ok(Self { cells, factor })
    }

    /// Solves in place.
    ///
    /// # Panics
    /// If `rhs` has another size than the grid.
    pub fn solve(&self, rhs: &mut [f64]) {
        assert_eq!(rhs.len(), self.cells, "values of the grid");
        self.factor.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(rhs, self.cells, 1));
    }
}

impl std::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cholesky").field("cells", &self.cells).finish_non_exhaustive()
    }
}
