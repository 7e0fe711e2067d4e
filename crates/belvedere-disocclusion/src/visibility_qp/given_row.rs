//! Rows that are asked for from outside: by a judge, and to keep summits in their order.

use super::combination::Combination;
use super::row::{Constraint, Row};
use super::surface::Surface;
use belvedere_core::DVec2;

/// The displacement at a position of the ground, minus `1 - tau` times that of a point, is at most `bound`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GivenRow {
    /// Grid position of the ground, and of the point.
    at: DVec2,
    pub(crate) point: DVec2,
    /// Share of the way from the point to the eye at which the ground lies.
    tau: f64,
    /// Scene units.
    bound: f64,
    /// How both move, see [`Surface::moves`].
    moves: [Combination; 2],
    /// Whether it keeps the order of two summits, or clears a line of sight.
    pub(crate) is_order: bool,
}

impl GivenRow {
    /// The row that lowers the ground at a grid position by `by`, scene units, against the line of sight of a point, as they lie under
    /// the displacement `u`.
    pub(super) fn lowering(surface: &Surface, u: &[f64], [at, point]: [DVec2; 2], tau: f64, by: f64) -> Self {
        let [ground, of_point] = [at, point].map(|g| surface.combination(g, u).at(u));
        let bound = ground - (1.0 - tau) * of_point - by;
        Self { at, point, tau, bound, moves: surface.moves(at, point, u), is_order: false }
    }

    /// The row under which the lower of two summits does not become the higher.
    ///
    /// * `low`, `high`: grid positions; `by`: how much lower the former is, scene units, >= 0.
    pub(super) fn in_order(surface: &Surface, [low, high]: [DVec2; 2], by: f64) -> Self {
        let moves = surface.moves(low, high, &surface.u);
        Self { at: low, point: high, tau: 0.0, bound: by, moves, is_order: true }
    }

    /// The same row over another grid.
    ///
    /// * `u`: displacement of its nodes.
    pub(super) fn on(&self, surface: &Surface, u: &[f64]) -> Self {
        Self { moves: surface.moves(self.at, self.point, u), ..*self }
    }

    /// * `index`: of this row.
    pub(super) fn row(&self, index: u32) -> Row {
        let Self { tau, bound, moves: [ground, of_point], .. } = self;
        let rest = 1.0 - tau;
        let bound = bound - (ground.constant - rest * of_point.constant);
        Row::sight((ground, of_point), rest, bound, Constraint::Given(index))
    }
}
