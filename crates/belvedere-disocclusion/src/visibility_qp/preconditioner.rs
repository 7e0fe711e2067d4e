//! Preconditioners of the equations `(K + diagonal) m = wanted` on a face.
//!
//! With few rows on it, Cholesky factors of crowds of neighbouring rows. With many, and a grid that is not too fine, the inverse as it was
//! for the face when it was made: with `K = A H^-1 A^T` it is `D^-1 - D^-1 A (H + A^T D^-1 A)^-1 A^T D^-1`, and the matrix in the middle is
//! sparse, of the size of the grid however many rows there are.

use super::cholesky::Cholesky;
use super::dissection::{Dissection, Pair};
use super::fronts::{Factor, Squares};
use super::metric::Metric;
use super::row::Row;
use pulp::Arch;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Number of neighbouring rows that share one Cholesky factor.
const CROWD: usize = 96;
/// A pivot below this share of its diagonal counts as dependent.
const DEPENDENT: f64 = 1e-6;

/// An approximate inverse over the rows of the face for which it was made.
pub(super) enum Preconditioner {
    Crowds(Vec<Crowd>),
    Direct(Box<Direct>),
}

/// Rows of a face with the factor of their block of the matrix.
pub(super) struct Crowd {
    members: Vec<usize>,
    factor: Cholesky,
}

/// The sparse factor for a face.
pub(super) struct Direct {
    /// Inverse diagonal of the rows of the face, 0 for others.
    light: Vec<f64>,
    factor: Factor,
    stands_for: Vec<u32>,
}

impl Preconditioner {
    /// By crowds.
    ///
    /// * `held`: rows of the face, neighbours following each other;
    /// * `whole`: diagonal of the matrix of the equations.
    pub(super) fn crowds(metric: &Metric, rows: &[Row], held: &[usize], whole: &[f64]) -> Self {
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
        Self::Crowds(held.par_chunks(CROWD).map(crowd).collect())
    }

    /// By the sparse factor.
    ///
    /// * `held`: rows of the face;
    /// * `diagonal`: of the equations, > 0, what is added to K.
    pub(super) fn direct(metric: &Metric, rows: &[Row], held: &[usize], diagonal: &[f64]) -> Self {
        let stands_for = metric.stands_for();
        let own = |node: u32| stands_for[node as usize];
        let mut squares = Squares::default();
        metric.squares(|entries, scale| squares.push(entries.iter().map(|(node, w)| (own(*node), *w)), scale));
        let mut pairs = BTreeSet::<Pair>::new();
        let mut light = vec![0.0; rows.len()];
        for &i in held {
            let row = &rows[i];
            light[i] = 1.0 / diagonal[i];
            squares.push(row.entries().map(|(node, w)| (own(node), w)), light[i]);
            if row.len > 1 {
                // Groups of four, or a node and others.
                let split = if row.len == 8 { 4 } else { 1 };
                let group = |from: usize, to: usize| [0, 1, 2, 3].map(|j| own(row.nodes[(from + j).min(to - 1)]));
                pairs.insert([group(0, split), group(split, row.len)]);
            }
        }
        let factor = Factor::new(&Dissection::new(metric.sides(), &stands_for, &pairs), &squares);
        Self::Direct(Box::new(Direct { light, factor, stands_for }))
    }

    /// Approximate solution for the rows `held`. Rows that joined since it was made stand for themselves.
    ///
    /// * `whole`: diagonal of the matrix of the equations.
    pub(super) fn apply(&self, rows: &[Row], held: &[usize], residual: &[f64], whole: &[f64]) -> Vec<f64> {
        match self {
            Self::Crowds(crowds) => by_crowds(crowds, held, residual, whole),
            Self::Direct(direct) => direct.apply(rows, held, residual, whole),
        }
    }
}

fn by_crowds(crowds: &[Crowd], held: &[usize], residual: &[f64], whole: &[f64]) -> Vec<f64> {
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
    let parts: Vec<Vec<f64>> = crowds.par_iter().with_min_len(16).map(solved).collect();
    let mut out: Vec<f64> = held.iter().zip(residual).map(|(&i, r)| r / whole[i]).collect();
    for (crowd, x) in crowds.iter().zip(parts) {
        for (&i, x) in crowd.members.iter().zip(x) {
            if let Some(k) = position[i] {
                out[k as usize] = x;
            }
        }
    }
    out
}

impl Direct {
    fn apply(&self, rows: &[Row], held: &[usize], residual: &[f64], whole: &[f64]) -> Vec<f64> {
        let mut v = vec![0.0; self.stands_for.len()];
        for (&i, r) in held.iter().zip(residual) {
            let r = self.light[i] * r;
            if r != 0.0 {
                for (node, w) in rows[i].entries() {
                    v[self.stands_for[node as usize] as usize] += w * r;
                }
            }
        }
        self.factor.solve(&mut v);
        let value = |i: usize| -> f64 {
            rows[i].entries().map(|(node, w)| w * v[self.stands_for[node as usize] as usize]).sum()
        };
        let of = |(&i, r): (&usize, &f64)| match self.light[i] {
            0.0 => r / whole[i],
            light => light * (r - value(i)),
        };
        held.iter().zip(residual).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smooth::{Between, Smoother};

    /// The sparse factor inverts the equations of its face, also where a lake moves as one, and for rows that occur twice.
    #[test]
    fn the_sparse_factor_inverts_the_equations() {
        let (cols, rows) = (23usize, 19usize);
        for lake in [false, true] {
            let mut metric = Metric::new(Smoother::new(cols, rows, 0.4, 0.0).unwrap());
            if lake {
                metric.tie(&[(6..12).flat_map(|y| (4..9).map(move |x| y * 23 + x)).collect()]);
            }
            let node = |i: usize| Between::node((i % (cols * rows)) as u32, cols, rows);
            let of = |k: usize| {
                let (a, b) = (k * 37, k * 53 + 11);
                let mut row = Row::ceiling((a % (cols * rows)) as u32, node(a), 0.0);
                if !k.is_multiple_of(3) {
                    (row.nodes[1], row.weights[1], row.len) = ((b % (cols * rows)) as u32, -0.3, 2);
                    row.points[1] = (-0.3, node(b));
                }
                row
            };
            let all: Vec<Row> = (0..60usize).map(|k| of(k / 2 * (1 + k % 5))).collect();
            let diagonal: Vec<f64> = (0..all.len()).map(|k| 1e-3 * (1 + k % 7) as f64).collect();
            let held: Vec<usize> = (0..all.len()).filter(|k| k % 4 != 3).collect();
            let inverse = Preconditioner::direct(&metric, &all, &held, &diagonal);
            let residual: Vec<f64> = held.iter().map(|k| ((k * 7919) % 13) as f64 - 6.0).collect();
            let solved = inverse.apply(&all, &held, &residual, &[]);
            let mut nodes = vec![0.0; cols * rows];
            for (&i, x) in held.iter().zip(&solved) {
                all[i].entries().for_each(|(node, w)| nodes[node as usize] += w * x);
            }
            metric.solve(&mut nodes);
            for ((&i, x), r) in held.iter().zip(&solved).zip(&residual) {
                let got = all[i].at(&nodes) + diagonal[i] * x;
                assert!((got - r).abs() < 1e-8, "row {i}: {got} and {r}");
            }
        }
    }
}
