//! Ground that an author moves: handles become the smoothest displacement that carries them out, keeps lakes level, rivers downhill and
//! routes as long as they are, and folds nowhere.
//!
//! Source: ours; the deformation by hand of panorama painters (Berann), and the "more general deformation" of Deng et al. 2013, section 7.

mod fit;
mod handles;
mod kept;
mod routes;

pub use handles::{Handle, HandleError, Move};
pub use kept::{Kept, KeptLine};

use belvedere_core::DVec2;
use belvedere_core::map::ground_moves::{GroundMoves, GroundMovesError, MoveNet, NetPlace};
use serde::Serialize;

/// Routes become no longer or shorter than by this share.
pub const ROUTES_WITHIN: f64 = 0.03;
/// Coefficients of the net along one side at most.
const MOST_COEFFICIENTS: f64 = 321.0;
/// Least reach of a move, in steps of the net: less holds no coefficient that moves nothing beyond it.
const LEAST_REACH: f64 = 4.0;
/// Coefficients across the shorter of what moves in full and what gives way around it.
const COEFFICIENTS: f64 = 2.5;
/// Rounds in which ground that folds and routes that change become stiffer, until all can be carried out.
const ROUNDS: u32 = 8;
/// Halvings of the share of the moves that can be carried out.
const HALVINGS: u32 = 12;

/// How one handle was carried out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MoveReport {
    /// Its kind, as scene files write it.
    pub kind: &'static str,
    /// Share of what was asked for that the ground does where the handle works in full; below 1 where others hold against it.
    pub carried_out: f64,
}

/// How long a route is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RouteReport {
    /// Its name, or that of its layer.
    pub name: String,
    /// Length in the scene, scene units.
    pub length_m: f64,
    /// Length on the moved ground, scene units.
    pub moved_length_m: f64,
}

/// What moved ground keeps, and how far it moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroundMovesReport {
    /// Share of all moves that could be carried out: 1, or less where the ground would fold or a route would change its length.
    pub share: f64,
    /// Each handle.
    pub moves: Vec<MoveReport>,
    /// Largest displacement in plan, scene units.
    pub plan_m: f64,
    /// Largest displacement up or down, scene units.
    pub height_m: f64,
    /// Proved lower bound on the determinant of the Jacobian: to no less than this share the ground shrinks in plan.
    pub least_determinant: f64,
    /// Routes that move.
    pub routes: Vec<RouteReport>,
    /// Lakes that moved up or down as a whole.
    pub lakes: usize,
    /// Most that a river rises downstream more than it did, scene units.
    pub rivers_rise_m: f64,
}

/// Errors of handles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GroundMovesFailure {
    /// A handle is not valid.
    #[error("{error}")]
    Handle {
        /// Number of the handle, from 0.
        index: usize,
        /// What is wrong.
        error: HandleError,
    },
    /// There is no handle.
    #[error("there is no move; give at least one")]
    Nothing,
    /// No displacement was found that does not fold.
    #[error("{0}")]
    Folds(GroundMovesError),
}

/// The ground as the handles move it.
///
/// * `moves`: the handles, at least one.
/// * `kept`: what lies on the ground and keeps its form.
///
/// # Errors
/// A handle that is not valid, with its number; no handle.
pub fn ground_moves(moves: &[Move], kept: &Kept) -> Result<(GroundMoves, GroundMovesReport), GroundMovesFailure> {
    if moves.is_empty() {
        return Err(GroundMovesFailure::Nothing);
    }
    for (index, one) in moves.iter().enumerate() {
        one.check().map_err(|error| GroundMovesFailure::Handle { index, error })?;
    }
    let place = net_over(moves);
    let least = LEAST_REACH * place.step;
    if let Some(index) = moves.iter().position(|one| one.reach < least) {
        let error = HandleError::Apart { reach: moves[index].reach, least };
        return Err(GroundMovesFailure::Handle { index, error });
    }
    let moves: Vec<Move> = moves.iter().map(|m| m.thinned(0.5 * place.step)).collect();
    let mut best: Option<(f64, GroundMoves, GroundMovesReport)> = None;
    let mut stiffness = fit::Stiffness::new(&place);
    for _ in 0..ROUNDS {
        let fitted = fit::fit(&place, &moves, kept, &stiffness);
        let Some(whole) = MoveNet::new(place, fitted.coefficients.clone()) else { break };
        let (share, map) = carried_out(&whole, kept).map_err(GroundMovesFailure::Folds)?;
        let report = report(&map, share, &moves, kept, &fitted);
        let done = report.moves.iter().map(|m| m.carried_out).sum::<f64>();
        let is_better = best.as_ref().is_none_or(|(most, ..)| done > *most);
        if is_better {
            best = Some((done, map, report));
        }
        if share == 1.0 {
            break;
        }
        stiffness.spread(&place, &fitted.coefficients);
        if routes::largest_change(&whole, &kept.routes) > ROUTES_WITHIN {
            stiffness.routes *= 3.0;
        }
    }
    best.map(|(_, map, report)| (map, report)).ok_or(GroundMovesFailure::Nothing)
}

/// The largest share of a displacement that folds nowhere and keeps the lengths of routes, and its map.
fn carried_out(whole: &MoveNet, kept: &Kept) -> Result<(f64, GroundMoves), GroundMovesError> {
    let folds = GroundMovesError::Folds { at: whole.place().first, bound: f64::NAN };
    let at = |share: f64| whole.scaled(share).ok_or(folds).and_then(GroundMoves::new);
    let is_kept = |map: &GroundMoves| routes::largest_change(map.net(), &kept.routes) <= ROUTES_WITHIN;
    if let Ok(map) = at(1.0)
        && is_kept(&map)
    {
        return Ok((1.0, map));
    }
    let (mut low, mut high, mut found) = (0.0, 1.0, at(0.0)?);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match at(middle) {
            Ok(map) if is_kept(&map) => (low, found) = (middle, map),
            _ => high = middle,
        }
    }
    Ok((low, found))
}

fn report(map: &GroundMoves, share: f64, moves: &[Move], kept: &Kept, fitted: &fit::Fitted) -> GroundMovesReport {
    let most = map.net().largest();
    let one = |m: &Move| MoveReport { kind: m.handle.kind(), carried_out: m.carried_out(map.net()) };
    GroundMovesReport {
        share,
        moves: moves.iter().map(one).collect(),
        plan_m: most[0],
        height_m: most[1],
        least_determinant: map.least_determinant(),
        routes: routes::lengths(map.net(), &kept.routes),
        lakes: fitted.lakes,
        rivers_rise_m: kept.rivers.iter().map(|river| river.rise_under(map.net())).fold(0.0, f64::max),
    }
}

/// A net over everything within reach, with three coefficients more on every side.
fn net_over(moves: &[Move]) -> NetPlace {
    let (mut min, mut max, mut step) = (DVec2::INFINITY, DVec2::NEG_INFINITY, f64::INFINITY);
    for one in moves {
        for p in one.handle.places() {
            min = min.min(*p - DVec2::splat(one.reach));
            max = max.max(*p + DVec2::splat(one.reach));
        }
        let inner = one.core.max(one.reach / 8.0).min(one.reach - one.core);
        step = step.min(inner / COEFFICIENTS);
    }
    let step = step.max((max - min).max_element() / (MOST_COEFFICIENTS - 9.0));
    let size = ((max - min) / step).ceil() + DVec2::splat(9.0);
    NetPlace { first: min - DVec2::splat(4.0 * step), step, size: [size.x as usize, size.y as usize] }
}
