//! Nodes that move together: the surface of a lake stays level.
//!
//! With equalities `C u = 0` the program is that of the metric on the space of level displacements, whose inverse is
//! `H^-1 - H^-1 C^T (C H^-1 C^T)^-1 C H^-1`. So no row is added and no tolerance: every displacement of the program is level.

use super::cholesky::{Cholesky, dot};
use crate::smooth::{Between, Green, Smoother};

/// A pivot below this share of its diagonal counts as dependent.
const DEPENDENT: f64 = 1e-12;

/// Sets of nodes that share one value each.
#[derive(Debug, Clone)]
pub(super) struct Ties {
    /// At least two nodes each.
    sets: Vec<Vec<u32>>,
    /// Cholesky factor of `C H^-1 C^T`.
    factor: Cholesky,
    lattice: [usize; 2],
}

/// The equations: a node, and the first of its set to which it is equal.
fn equations(sets: &[Vec<u32>]) -> impl Iterator<Item = (u32, u32)> + '_ {
    sets.iter().flat_map(|set| set.iter().skip(1).map(|n| (*n, set[0])))
}

impl Ties {
    /// `None` where nothing is tied.
    pub(super) fn new(sets: &[Vec<u32>], smoother: &Smoother, green: &Green) -> Option<Self> {
        let sets: Vec<Vec<u32>> = sets.iter().filter(|set| set.len() > 1).cloned().collect();
        let rows: Vec<(u32, u32)> = equations(&sets).collect();
        let product = |a: (u32, u32), b: (u32, u32)| {
            let to = |n: u32| green.entry(n, b.0) - green.entry(n, b.1);
            to(a.0) - to(a.1)
        };
        let mut factor = Cholesky::default();
        for (i, row) in rows.iter().enumerate() {
            factor.push(rows[..i].iter().map(|other| product(*row, *other)), product(*row, *row), DEPENDENT);
        }
        (!rows.is_empty()).then(|| Self { sets, factor, lattice: [smoother.cols(), smoother.rows()] })
    }

    /// Sets of at least two nodes.
    pub(super) fn sets(&self) -> &[Vec<u32>] {
        &self.sets
    }

    /// `C v`.
    fn apart(&self, value: impl Fn(u32) -> f64) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.factor.size());
        for set in &self.sets {
            let first = value(set[0]);
            out.extend(set[1..].iter().map(|node| value(*node) - first));
        }
        out
    }

    /// The level displacement nearest to `u` in the norm of the metric, in place.
    ///
    /// * `solve`: `H^-1` in place.
    pub(super) fn level(&self, u: &mut [f64], solve: impl FnOnce(&mut [f64])) {
        let mut m = self.apart(|node| u[node as usize]);
        self.factor.solve(&mut m);
        let mut change = vec![0.0; u.len()];
        for ((node, first), m) in equations(&self.sets).zip(m) {
            change[node as usize] += m;
            change[first as usize] -= m;
        }
        solve(&mut change);
        u.iter_mut().zip(change).for_each(|(u, c)| *u -= c);
        // Removes the differences that rounding leaves.
        for set in &self.sets {
            let mean = set.iter().map(|n| u[*n as usize]).sum::<f64>() / set.len() as f64;
            set.iter().for_each(|n| u[*n as usize] = mean);
        }
    }

    /// Part of a row that the equalities take: they reduce the product of two rows by the product of these parts.
    pub(super) fn shared(&self, points: &[(f64, Between); 4], green: &Green) -> Vec<f64> {
        let [cols, rows] = self.lattice;
        let value = |node: u32| -> f64 {
            let node = Between::node(node, cols, rows);
            points.iter().filter(|p| p.0 != 0.0).map(|(f, at)| f * green.between(*at, node)).sum()
        };
        let mut out = self.apart(value);
        self.factor.forward(&mut out);
        out
    }
}

/// Product of these parts of two rows.
pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    dot(a, b)
}

#[cfg(test)]
mod tests;
