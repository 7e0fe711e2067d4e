//! The quadratic program on ground whose detail moves as well.
//!
//! The program knows ground of triangles plus a displacement that is bilinear between the nodes of its own grid. Where detail moves
//! too, both are drawn as one displacement that is bilinear between the nodes of the terrain: inside a cell, and in cells that a line
//! of the solver's grid crosses, that is other ground by a part of what four neighbours differ. On cells of hundreds of metres
//! this comes to many metres. So the drawn ground is looked at, and where it rises over a line of sight the program is told that
//! the ground stands so much higher there.

use super::super::metrics::hiding;
use super::super::visibility_qp::{QpOptions, QpProblem, QpResult, QpSolver};
use super::super::{Field, Hierarchy};
use super::at_every_node;
use crate::DisocclusionError;
use belvedere_core::DVec2;
use std::collections::BTreeSet;

/// Looks at the drawn ground, at most.
const LOOKS: usize = 12;
/// Room left over what was found, metres: the places that hide nothing yet are not to come up in the next look.
const ROOM_M: f64 = 0.25;

/// Ground that is drawn from a displacement at every node.
pub(super) struct Drawn<'a> {
    pub(super) field: &'a Field,
    /// The solver's grid.
    pub(super) grid: &'a Hierarchy,
    /// Change of detail at every node.
    pub(super) detail: &'a [f64],
    pub(super) options: QpOptions,
}

impl Drawn<'_> {
    /// Solves until the drawn ground hides no candidate that the program holds for seen.
    ///
    /// * `qp`: knows `ground`, the undisplaced one with its change of detail; `result`: its solution.
    pub(super) fn agree(
        &self,
        qp: &mut QpSolver,
        ground: &[f64],
        problem: &QpProblem<'_>,
        mut result: QpResult,
    ) -> Result<QpResult, DisocclusionError> {
        // At a price the program leaves places covered.
        if self.options.slack_price.is_some() {
            return Ok(result);
        }
        let mut told = ground.to_vec();
        for _ in 0..LOOKS {
            let found = self.hiding(problem, &result)?;
            if found.is_empty() {
                break;
            }
            let before = told.clone();
            for (at, over) in found {
                for node in self.around(at) {
                    told[node] = told[node].max(before[node] + over + ROOM_M);
                }
            }
            qp.set_heights(&told)?;
            let next = qp.solve(problem)?;
            let (rounds, added) = (result.rounds + next.rounds, result.added + next.added);
            result = QpResult { rounds, added, kept: result.kept, ..next };
        }
        Ok(result)
    }

    /// Places where the drawn ground rises over the line of sight of a candidate, and by how much.
    fn hiding(&self, problem: &QpProblem<'_>, result: &QpResult) -> Result<Vec<(DVec2, f64)>, DisocclusionError> {
        let smooth = self.grid.prolong(&result.u);
        let full: Vec<f64> = smooth.iter().zip(self.detail).map(|(a, b)| a + b).collect();
        let delta = at_every_node(self.field, &full)?;
        let named: BTreeSet<u32> = result.unresolved.iter().map(|u| u.id).collect();
        let asked = problem.candidates.iter().filter(|c| !named.contains(&c.id));
        let places: Vec<(DVec2, f64)> = asked.map(|c| (c.grid, c.lift)).collect();
        let over = hiding(self.field, &delta, self.options.guard, problem.sight, &places);
        Ok(over.into_iter().flatten().collect())
    }

    /// Nodes of the cell around a place.
    fn around(&self, at: DVec2) -> [usize; 4] {
        let index = |v: f64, n: usize| (v.max(0.0) as usize).min(n.saturating_sub(2));
        let (cols, rows) = (self.field.cols(), self.field.rows());
        let nw = index(at.y, rows) * cols + index(at.x, cols);
        [nw, nw + 1, nw + cols, nw + cols + 1]
    }
}
