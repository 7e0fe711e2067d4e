//! Preconditioner of the equations `(K + D) m = wanted` on a face: Cholesky factors of crowds of neighbouring rows.

use super::cholesky::Cholesky;
use super::metric::Metric;
use super::row::Row;
use pulp::Arch;
use rayon::prelude::*;

/// Number of neighbouring rows that share one Cholesky factor.
const CROWD: usize = 96;
/// A pivot below this share of its diagonal counts as dependent.
const DEPENDENT: f64 = 1e-6;

/// An approximate inverse over the rows of the face for which it was made.
pub(super) struct Preconditioner(Vec<Crowd>);

/// Rows of a face with the factor of their block of the matrix.
struct Crowd {
    members: Vec<usize>,
    factor: Cholesky,
}

impl Preconditioner {
    /// * `held`: rows of the face, neighbours following each other;
    /// * `whole`: diagonal of the matrix of the equations.
    pub(super) fn new(metric: &Metric, rows: &[Row], held: &[usize], whole: &[f64]) -> Self {
        let crowd = |members: &[usize]| {
            let mut factor = Cholesky::default();
            Arch::new().dispatch(
                #[inline(always)]
                || {
                    for (k, &i) in members.iter().enumerate() {
                        let products = members[..k].iter().map(|&j| rows[i].product(&rows[j], metric));
                        factor.push(products, whole[i], DEPENDENT);
                    }
                },
            );
            Crowd { members: members.to_vec(), factor }
        };
        Self(held.par_chunks(CROWD).map(crowd).collect())
    }

    /// Approximate solution for the rows `held`. Rows that joined since it was made stand for themselves.
    ///
    /// * `whole`: diagonal of the matrix of the equations.
    pub(super) fn apply(&self, held: &[usize], residual: &[f64], whole: &[f64]) -> Vec<f64> {
        let mut position = vec![None; whole.len()];
        held.iter().enumerate().for_each(|(k, &i)| position[i] = Some(k as u32));
        let solved = |crowd: &Crowd| {
            let of = |&i: &usize| position[i].map_or(0.0, |k| residual[k as usize]);
            let mut x: Vec<f64> = crowd.members.iter().map(of).collect();
            Arch::new().dispatch(
                #[inline(always)]
                || crowd.factor.solve(&mut x),
            );
            x
        };
        let parts: Vec<Vec<f64>> = self.0.par_iter().with_min_len(16).map(solved).collect();
        let mut out: Vec<f64> = held.iter().zip(residual).map(|(&i, r)| r / whole[i]).collect();
        for (crowd, x) in self.0.iter().zip(parts) {
            for (&i, x) in crowd.members.iter().zip(x) {
                if let Some(k) = position[i] {
                    out[k as usize] = x;
                }
            }
        }
        out
    }
}
