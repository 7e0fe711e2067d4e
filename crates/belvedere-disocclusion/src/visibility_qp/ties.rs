//! Nodes that move together: the surface of a lake stays level.
//!
//! With equalities `C u = 0` the program is that of the metric on the space of level displacements, whose inverse is
//! `H^-1 - H^-1 C^T (C H^-1 C^T)^-1 C H^-1`. So no row is added and no tolerance: every displacement of the program is level.

use super::cholesky::{Cholesky, dot};
use crate::smooth::{Between, Green, Smoother};

/// A pivot below this share of its diagonal counts as dependent.
const DEPENDENT: f64 = 1e-12;

/// Sets of nodes that share one value each, or keep that of zero.
#[derive(Debug, Clone)]
pub(super) struct Ties {
    sets: Vec<TiedNodes>,
    /// Of `C H^-1 C^T`.
    factor: Cholesky,
    lattice: [usize; 2],
}

/// Nodes of the solver's grid that move together.
#[derive(Debug, Clone, PartialEq)]
pub struct TiedNodes {
    /// Nodes, each in one set alone.
    pub nodes: Vec<u32>,
    /// Whether they do not move at all.
    pub held: bool,
}

impl TiedNodes {
    /// The equations: a node and the one that it is equal to.
    fn rows(&self) -> impl Iterator<Item = (u32, Option<u32>)> + '_ {
        let first = self.nodes.first().copied().filter(|_| !self.held);
        self.nodes.iter().skip(usize::from(!self.held)).map(move |n| (*n, first))
    }
}

impl Ties {
    /// `None` where nothing is tied.
    pub(super) fn new(sets: &[TiedNodes], smoother: &Smoother, green: &Green) -> Option<Self> {
        let sets: Vec<TiedNodes> = sets.iter().filter(|s| s.rows().next().is_some()).cloned().collect();
        let rows: Vec<(u32, Option<u32>)> = sets.iter().flat_map(TiedNodes::rows).collect();
        let product = |a: (u32, Option<u32>), b: (u32, Option<u32>)| {
            let to = |n: u32| green.entry(n, b.0) - b.1.map_or(0.0, |r| green.entry(n, r));
            to(a.0) - a.1.map_or(0.0, to)
        };
        let mut factor = Cholesky::default();
        for (i, row) in rows.iter().enumerate() {
            factor.push(rows[..i].iter().map(|other| product(*row, *other)), product(*row, *row), DEPENDENT);
        }
        (!rows.is_empty()).then(|| Self { sets, factor, lattice: [smoother.cols(), smoother.rows()] })
    }

    /// `C v`.
    fn apart(&self, value: impl Fn(u32) -> f64) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.factor.size());
        for set in &self.sets {
            let first = if set.held { 0.0 } else { value(set.nodes[0]) };
            out.extend(set.rows().map(|(node, _)| value(node) - first));
        }
        out
    }

    /// The level displacement next to `u` in the norm of the metric, in place.
    ///
    /// * `solve`: `H^-1` in place.
    pub(super) fn level(&self, u: &mut [f64], solve: impl FnOnce(&mut [f64])) {
        let mut m = self.apart(|node| u[node as usize]);
        self.factor.solve(&mut m);
        let mut change = vec![0.0; u.len()];
        let rows = self.sets.iter().flat_map(TiedNodes::rows);
        for ((node, first), m) in rows.zip(m) {
            change[node as usize] += m;
            if let Some(first) = first {
                change[first as usize] -= m;
            }
        }
        solve(&mut change);
        u.iter_mut().zip(change).for_each(|(u, c)| *u -= c);
        // What rounding leaves.
        for TiedNodes { nodes, held } in &self.sets {
            let mean = nodes.iter().map(|n| u[*n as usize]).sum::<f64>() / nodes.len() as f64;
            nodes.iter().for_each(|n| u[*n as usize] = if *held { 0.0 } else { mean });
        }
    }

    /// What the equalities share with a row: the product of two rows is less by the product of what they share.
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

/// Product of what two rows share.
pub(super) fn product(a: &[f64], b: &[f64]) -> f64 {
    dot(a, b)
}

#[cfg(test)]
mod tests {
    use super::super::metric::Metric;
    use super::super::row::Row;
    use super::*;

    fn sets() -> [TiedNodes; 2] {
        let lake = (6..12).flat_map(|y| (4..9).map(move |x| y * 21 + x)).collect();
        let pond = vec![15 * 21 + 12, 15 * 21 + 13, 16 * 21 + 12];
        [TiedNodes { nodes: lake, held: false }, TiedNodes { nodes: pond, held: true }]
    }

    #[test]
    fn the_inverse_is_level_and_its_entries_are_those_of_rows() {
        let mut metric = Metric::new(Smoother::new(21, 19, 0.4, 0.0).unwrap());
        metric.tie(&sets());
        for k in [0u32, 7 * 21 + 5, 15 * 21 + 12, 9 * 21 + 14, 200] {
            let mut u = vec![0.0; 21 * 19];
            u[k as usize] = 1.0;
            metric.solve(&mut u);
            let lake: Vec<f64> = sets()[0].nodes.iter().map(|n| u[*n as usize]).collect();
            assert!(lake.iter().all(|v| *v == lake[0]), "{lake:?}");
            assert!(sets()[1].nodes.iter().all(|n| u[*n as usize] == 0.0));
            let row = |n: u32| Row::ceiling(n, Between::node(n, 21, 19), 0.0);
            let shared = |n: u32| metric.shared(&row(n).points).unwrap();
            for other in [0u32, 6 * 21 + 4, 100, 9 * 21 + 13, 300] {
                let entry = row(k).product(&row(other), &metric) - product(&shared(k), &shared(other));
                assert!((entry - u[other as usize]).abs() < 1e-10, "{k} {other}: {entry} and {}", u[other as usize]);
            }
        }
    }

    #[test]
    fn the_level_displacement_next_to_one_is_the_nearest() {
        let (nodes, w) = (21 * 19, 0.4);
        let mut metric = Metric::new(Smoother::new(21, 19, w, 0.0).unwrap());
        metric.tie(&sets());
        let from: Vec<f64> = (0..nodes).map(|i| ((i * 7919) % 31) as f64 - 15.0).collect();
        let mut level = from.clone();
        metric.level(&mut level);
        let norm = |u: &[f64]| {
            let mut bent = vec![0.0; u.len()];
            crate::smooth::laplacian(21, u, &mut bent);
            bent.iter().map(|v| v * v).sum::<f64>() + w * w * u.iter().map(|v| v * v).sum::<f64>()
        };
        let apart = |u: &[f64]| norm(&u.iter().zip(&from).map(|(a, b)| a - b).collect::<Vec<_>>());
        let least = apart(&level);
        for k in 0..20 {
            let mut other = level.clone();
            let step = 0.01 * f64::from(k % 5 - 2) + 0.003;
            match k % 2 {
                0 => sets()[0].nodes.iter().for_each(|n| other[*n as usize] += step),
                _ => other[(k as usize * 61) % 80] += step,
            }
            assert!(apart(&other) > least, "{k}: {} and {least}", apart(&other));
        }
    }
}
