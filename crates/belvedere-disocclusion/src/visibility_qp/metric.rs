//! The norm in which displacements are measured.

use super::ties::Ties;
use crate::smooth::{Between, Green, Smoother};
use std::sync::Arc;

/// `H = L^2 + (w^2 + g^2) I` with its inverse, as a whole and entry by entry. An entry costs four look-ups and no solve,
/// which is what makes the dual program cheap. Where nodes are tied the inverse is that on level displacements.
#[derive(Debug, Clone)]
pub(super) struct Metric {
    smoother: Smoother,
    green: Green,
    ties: Option<Arc<Ties>>,
}

impl Metric {
    pub(super) fn new(smoother: Smoother) -> Self {
        let green = Green::new(&smoother);
        Self { smoother, green, ties: None }
    }

    /// Ties sets of nodes together.
    pub(super) fn tie(&mut self, sets: &[Vec<u32>]) {
        self.ties = Ties::new(sets, &self.smoother, &self.green).map(Arc::new);
    }

    /// Nodes of the grid.
    pub(super) fn nodes(&self) -> usize {
        self.smoother.cols() * self.smoother.rows()
    }

    /// Columns and rows of the grid.
    pub(super) fn sides(&self) -> [usize; 2] {
        [self.smoother.cols(), self.smoother.rows()]
    }

    /// For each node the first of those that move together with it.
    pub(super) fn stands_for(&self) -> Vec<u32> {
        let mut out: Vec<u32> = (0..self.nodes() as u32).collect();
        for set in self.ties.iter().flat_map(|ties| ties.sets()) {
            set.iter().for_each(|node| out[*node as usize] = set[0]);
        }
        out
    }

    /// Calls `visit` with weights at nodes, and a factor: H is the sum of the squares of these combinations times their factors.
    pub(super) fn squares(&self, mut visit: impl FnMut(&[(u32, f64)], f64)) {
        let [cols, rows] = self.sides();
        let shift = self.smoother.shift();
        for y in 0..rows {
            for x in 0..cols {
                let node = y * cols + x;
                let around = [
                    (x > 0).then(|| node - 1),
                    (x + 1 < cols).then(|| node + 1),
                    (y > 0).then(|| node - cols),
                    (y + 1 < rows).then(|| node + cols),
                ];
                let mut entries = [(node as u32, 0.0); 5];
                let mut len = 1;
                for other in around.into_iter().flatten() {
                    entries[len] = (other as u32, 1.0);
                    entries[0].1 -= 1.0;
                    len += 1;
                }
                visit(&entries[..len], 1.0);
                visit(&[(node as u32, 1.0)], shift);
            }
        }
    }

    /// `H^-1 v` in place.
    pub(super) fn solve(&mut self, v: &mut [f64]) {
        self.smoother.solve(v);
        self.level(v);
    }

    /// Takes the nearest displacement that moves tied nodes together.
    pub(super) fn level(&mut self, u: &mut [f64]) {
        if let Some(ties) = &self.ties {
            ties.level(u, |change| self.smoother.solve(change));
        }
    }

    /// The part of a row that ties subtract from its products with other rows; `None` without ties. See [`Ties::shared`].
    pub(super) fn shared(&self, points: &[(f64, Between); 4]) -> Option<Vec<f64>> {
        self.ties.as_ref().map(|ties| ties.shared(points, &self.green))
    }

    /// Inverse of H between the bilinear values at two points, without ties.
    #[inline(always)]
    pub(super) fn between(&self, a: Between, b: Between) -> f64 {
        self.green.between(a, b)
    }
}
