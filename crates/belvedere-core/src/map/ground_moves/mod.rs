//! Ground that an author moves: a displacement in three components, set by handles.

mod net;
mod proof;

pub use net::{MoveNet, Moved, NetPlace, NetWeights};

use super::{Miss, SpaceMap, finite};
use crate::Aabb;
use glam::{DMat2, DMat3, DVec2, DVec3};
use std::sync::Arc;

/// The plan shrinks nowhere to less than this share of its area.
pub const LEAST_DETERMINANT: f64 = 0.05;

/// Newton steps of one inversion.
const STEPS: u32 = 30;
/// Parts in which the displacement is taken back one after the other where one step of Newton's method does not find the way.
const PARTS: [u32; 3] = [1, 16, 256];

/// Errors of moved ground.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GroundMovesError {
    /// The moved ground lies over itself.
    #[error(
        "the moved ground folds or nearly does at ({:.1}, {:.1}): the bound on the determinant of its plan is {bound:.3} there, it must be above {LEAST_DETERMINANT}; move less, or let it take effect over a longer reach",
        at.x, at.y
    )]
    Folds {
        /// Where, scene coordinates.
        at: DVec2,
        /// Lower bound on the determinant that was found there.
        bound: f64,
    },
}

/// `X' = X + d(x, y)`, d with three components: the ground and what stands on it go sideways and up or down.
///
/// The same for all points of a vertical line, so heights stay upright and keep their length, and the determinant of the Jacobian is that of
/// the plan. It is proved above [`LEAST_DETERMINANT`] on every cell when the map is made, for every share of the displacement; as
/// nothing moves beside the net, the map is one to one.
///
/// Source: ours, after the "more general deformation" that Deng et al. 2013 leave to future work; free-form deformation on B-splines is
/// that of Sederberg and Parry 1986.
///
/// ```
/// use belvedere_core::map::ground_moves::{GroundMoves, MoveNet, NetPlace};
/// use belvedere_core::{DVec2, DVec3, SpaceMap};
/// let place = NetPlace { first: DVec2::ZERO, step: 100.0, size: [11, 11] };
/// let mut coefficients = vec![DVec3::ZERO; 121];
/// coefficients[5 * 11 + 5] = DVec3::new(60.0, 0.0, 90.0);
/// let ground = GroundMoves::new(MoveNet::new(place, coefficients).unwrap())?;
/// let moved = ground.apply(DVec3::new(500.0, 500.0, 700.0)).unwrap();
/// assert!((moved - DVec3::new(500.0 + 60.0 * 4.0 / 9.0, 500.0, 740.0)).length() < 1e-9);
/// assert!((ground.invert(moved).unwrap() - DVec3::new(500.0, 500.0, 700.0)).length() < 1e-9);
/// # Ok::<(), belvedere_core::map::ground_moves::GroundMovesError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GroundMoves {
    net: Arc<MoveNet>,
    least_determinant: f64,
}

impl GroundMoves {
    /// # Errors
    /// [`GroundMovesError::Folds`].
    pub fn new(net: MoveNet) -> Result<Self, GroundMovesError> {
        let least_determinant = proof::least_determinant(&net, LEAST_DETERMINANT)
            .map_err(|(at, bound)| GroundMovesError::Folds { at, bound })?;
        Ok(Self { net: Arc::new(net), least_determinant })
    }

    /// The displacements.
    pub fn net(&self) -> &MoveNet {
        &self.net
    }

    /// Proved lower bound on the determinant of the Jacobian.
    pub fn least_determinant(&self) -> f64 {
        self.least_determinant
    }

    /// These displacements times `share`, 0..=1.
    pub(crate) fn eased(&self, share: f64) -> Option<Self> {
        // The proof holds for every share.
        Some(Self { net: Arc::new(self.net.scaled(share)?), least_determinant: self.least_determinant })
    }

    /// See [`crate::map::StageMap::edge_bound`].
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        if !(p0.is_finite() && p1.is_finite()) {
            return f64::INFINITY;
        }
        self.net.bend_along(p0.truncate(), p1.truncate()) / 8.0
    }

    /// See [`crate::map::StageMap::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        if bounds.is_empty() || bounds.min.is_nan() || bounds.max.is_nan() {
            return None;
        }
        let by = self.net.range_over(bounds.min.truncate(), bounds.max.truncate());
        Some(Aabb { min: bounds.min + by.min, max: bounds.max + by.max })
    }

    /// Rotation about the vertical that a body at `foot` takes: that of the polar form of the plan's derivative.
    pub(super) fn turn_at(&self, foot: DVec2) -> f64 {
        let Moved { along_x: x, along_y: y, .. } = self.net.moved(foot);
        (x.y - y.x).atan2(2.0 + x.x + y.y)
    }

    /// The place in plan that the share of the displacement carries to `to`, from a place near it.
    fn newton(&self, to: DVec2, share: f64, mut at: DVec2) -> Option<DVec2> {
        let goal = 1e-13 * (to.abs().max_element() + self.net.place().step);
        let off = |at: DVec2, by: DVec3| at + share * by.truncate() - to;
        let mut moved = self.net.moved(at);
        for _ in 0..STEPS {
            let error = off(at, moved.by);
            if error.length() <= goal {
                return Some(at);
            }
            let columns = [DVec2::X + share * moved.along_x.truncate(), DVec2::Y + share * moved.along_y.truncate()];
            let step = DMat2::from_cols(columns[0], columns[1]).inverse() * error;
            let mut part = 1.0;
            loop {
                let next = at - part * step;
                let there = self.net.moved(next);
                if off(next, there.by).length() < error.length() {
                    (at, moved) = (next, there);
                    break;
                }
                part *= 0.5;
                if part < 1e-4 {
                    // No step helps: rounding, or a way round.
                    return (error.length() <= 1e4 * goal).then_some(at);
                }
            }
        }
        None
    }
}

impl SpaceMap for GroundMoves {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        let p = finite(p)?;
        finite(p + self.net.at(p.truncate()))
    }

    /// Newton's method in plan; where it does not arrive, the displacement is taken back in parts, whose way is unique because no part folds.
    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        let p = finite(p_displaced)?;
        let to = p.truncate();
        let in_parts =
            |parts: u32| (1..=parts).try_fold(to, |at, k| self.newton(to, f64::from(k) / f64::from(parts), at));
        let at = PARTS.into_iter().find_map(in_parts).ok_or(Miss::OutsideDomain)?;
        finite(at.extend(p.z - self.net.at(at).z))
    }

    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let Moved { along_x, along_y, .. } = self.net.moved(finite(p)?.truncate());
        Ok(DMat3::from_cols(DVec3::X + along_x, DVec3::Y + along_y, DVec3::Z))
    }
}
