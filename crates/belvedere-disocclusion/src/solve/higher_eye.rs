//! Advice where features were given up: how much of the displacement a higher eye saves.

use super::super::visibility_qp::{Candidate, QpOptions, QpProblem, StraightSight};
use super::super::{Field, Hierarchy, TerrainSettings};
use super::PointsInView;
use super::memory::{self, Prepared, Weights};
use crate::DisocclusionError;
use belvedere_scene::Progress;
use serde::Serialize;

/// First height by which the eye is raised, scene units, doubled until it is the relief.
const FIRST_M: f64 = 50.0;
/// Share of the displacement that is worth a higher eye, and that ends the search.
const WORTH: f64 = 0.2;
const ENOUGH: f64 = 0.6;
/// Rounds of each solution: the displacements are compared, not drawn.
const ROUNDS: usize = 6;
/// Nodes of the grid on which displacements are compared, and candidates, about.
const NODES: usize = 65;
const CANDIDATES: usize = 400;

/// An eye over that of the picture from which the same features cost less.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HigherEye {
    /// How much higher it is.
    pub up_m: f64,
    /// Share of the root mean square displacement for all features that it saves, 0..=1, about: estimated on a coarse grid.
    pub saves: f64,
}

/// The lowest eye over that of the picture that saves most of the displacement, or the best of those tried; `None` if none saves much, and
/// where lines of sight are bent.
pub(super) fn higher_eye(
    settings: &TerrainSettings,
    (field, prepared): (&Field, &Prepared),
    in_view: &PointsInView<'_>,
    progress: &Progress,
) -> Result<Option<HigherEye>, DisocclusionError> {
    let Some((eye, z)) = in_view.sight.straight() else { return Ok(None) };
    let progress = &progress.unheard();
    let grid = Hierarchy::whole(field.cols(), field.rows(), NODES);
    let weights = Weights { g: 0.0, ..Weights::new(settings, &prepared.despiked, None) };
    let options = QpOptions { rounds: ROUNDS, ..memory::options(settings, false) };
    let mut solver = memory::program(field, &grid, weights, options, &prepared.waters)?;
    let every = in_view.candidates.len().div_ceil(CANDIDATES).max(1);
    let few: Vec<Candidate> = in_view.candidates.iter().step_by(every).copied().collect();
    let mut energy = |up_m: f64| {
        let sight = StraightSight { eye, z: z + up_m };
        let problem = QpProblem { candidates: &few, sight: &sight, target: None, ceilings: None };
        solver.solve_with(&problem, progress).map(|result| result.energy)
    };
    let own = energy(0.0)?;
    let raises = std::iter::successors(Some(FIRST_M), |up| Some(2.0 * up)).take_while(|up| *up <= field.relief());
    let mut best: Option<HigherEye> = None;
    for up_m in raises {
        if progress.should_end() {
            break;
        }
        let saves = 1.0 - (energy(up_m)? / own.max(f64::MIN_POSITIVE)).sqrt();
        if saves > best.map_or(WORTH, |best| best.saves) {
            best = Some(HigherEye { up_m, saves });
        }
        if saves >= ENOUGH {
            break;
        }
    }
    Ok(best)
}
