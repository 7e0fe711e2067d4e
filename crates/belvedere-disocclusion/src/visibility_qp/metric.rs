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
