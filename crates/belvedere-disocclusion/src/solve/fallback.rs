//! Fallbacks for rows of the quadratic program that contradict each other on the solver's grid.
//!
//! They are tried in this order: slack, which the program buys by itself; cutting down the detail of the ground around rows with
//! slack; leaving ground nearer to a point than the guard as it is; finer grids, up to the terrain's own where that is small enough.

use super::super::visibility_qp::{QpResult, Reason, SolvedRow};
use super::super::{Field, Hierarchy};
use belvedere_core::DVec2;
use serde::Serialize;

/// A fallback for contradicting rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Fallback {
    /// Bumps that the solver's grid cannot hold were cut down where they hide something.
    Detail,
    /// Ground nearer to a point than the guard was left as it is.
    Guard,
    /// The program was solved again on a finer grid.
    FinerGrid {
        /// Nodes along its longer side.
        nodes: usize,
    },
}

/// Nodes along the longer side of the finest grid that is tried.
const MOST_NODES: usize = 513;
/// Radius in which detail is cut down, steps of the solver's grid.
const REACH: f64 = 1.5;

/// Number of candidates that the program could not make visible, though they have a line of sight.
pub(super) fn stuck(result: &QpResult) -> usize {
    let open = |reason: &Reason| matches!(reason, Reason::Infeasible(_) | Reason::NotSettled { .. });
    result.unresolved.iter().filter(|u| open(&u.reason)).count()
}

/// The grids to try after `grid`: each has about half the step of the one before.
pub(super) fn finer(grid: &Hierarchy, field: &Field) -> impl Iterator<Item = Hierarchy> {
    let [cols, rows] = field.nodes();
    let half = move |grid: &Hierarchy| {
        let next = Hierarchy::whole(cols, rows, 2 * grid.cols().max(grid.rows()) - 1);
        (next.step().x < grid.step().x && next.cols().max(next.rows()) <= MOST_NODES).then_some(next)
    };
    std::iter::successors(Some(grid.clone()), half).skip(1)
}

/// Cuts down the bumps that the solver's grid cannot hold around the rows with slack, fading to nothing [`REACH`] steps away. Returns
/// the change of every node, scene units, <= 0.
pub(super) fn cut_detail(field: &Field, ground: &[f64], grid: &Hierarchy, rows: &[SolvedRow]) -> Vec<f64> {
    let smooth = grid.prolong(&grid.restrict(ground));
    let mut gain = vec![0.0f64; ground.len()];
    for row in rows.iter().filter(|r| r.candidate.is_some() && r.slack > 0.0) {
        let reach = REACH * grid.step();
        let from = (row.at - reach).ceil().max(DVec2::ZERO);
        let to = (row.at + reach).floor();
        for y in from.y as usize..=(to.y.max(0.0) as usize).min(field.rows() - 1) {
            for x in from.x as usize..=(to.x.max(0.0) as usize).min(field.cols() - 1) {
                let away = ((DVec2::new(x as f64, y as f64) - row.at) / reach).length();
                let slot = &mut gain[y * field.cols() + x];
                *slot = slot.max((2.0 - 2.0 * away).clamp(0.0, 1.0));
            }
        }
    }
    let cut = |i: usize| if field.void()[i] { 0.0 } else { -gain[i] * (ground[i] - smooth[i]).max(0.0) };
    (0..ground.len()).map(cut).collect()
}

/// Values of one grid at the nodes of another over the same ground.
pub(super) fn resampled(from: &Hierarchy, u: &[f64], to: &Hierarchy) -> Vec<f64> {
    let node = |i: usize| DVec2::new((i % to.cols()) as f64, (i / to.cols()) as f64) * to.step();
    (0..to.nodes()).map(|i| from.at(u, node(i))).collect()
}
