//! The norm in which displacements are measured.

use crate::smooth::{Between, Green, Smoother};

/// `H = L^2 + (w^2 + g^2) I` with its inverse, as a whole and entry by entry. An entry costs four look-ups and no solve,
/// which is what makes the dual program cheap.
#[derive(Debug, Clone)]
pub(super) struct Metric {
    smoother: Smoother,
    green: Green,
}

impl Metric {
    pub(super) fn new(smoother: Smoother) -> Self {
        let green = Green::new(&smoother);
        Self { smoother, green }
    }

    /// Nodes of the grid.
    pub(super) fn nodes(&self) -> usize {
        self.smoother.cols() * self.smoother.rows()
    }

    /// `H^-1 v` in place.
    pub(super) fn solve(&mut self, v: &mut [f64]) {
        self.smoother.solve(v);
    }

    /// Inverse of H between the bilinear values at two points.
    #[inline(always)]
    pub(super) fn between(&self, a: Between, b: Between) -> f64 {
        self.green.between(a, b)
    }
}
