//! Displacements of space: the stages of a view.

mod answers;
pub mod curved_rays;
pub mod earth;
pub mod ground_moves;
pub mod relief;
pub mod rigid;
pub mod spline;
pub mod split_rays;
mod stage;
pub mod straighten;
pub mod terrain;
pub mod unroll;

pub use stage::{OwnMap, Stage, StageMap};

use crate::Miss;
use glam::{DMat3, DVec3};

/// A point after a displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displaced {
    /// Displaced point, scene coordinates.
    pub point: DVec3,
    /// Segment of the curved ray that sees the point: `2k` straight part of viewpoint `k`, `2j-1` transition of turn `j`; 0 without curved rays.
    pub segment: u32,
    /// Whether the map has folded over at this point (beyond a spline's fold limit): orientation is reversed there.
    pub folded: bool,
}

/// A smooth, orientation-preserving displacement of space.
///
/// Laws: `invert(apply(p)) = p`; `det jacobian > 0` on the domain; identity at zero strength; never NaN.
pub trait SpaceMap {
    /// Displaced position of `p`, scene coordinates.
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss>;
    /// The point that `apply` carries onto `p_displaced`.
    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss>;
    /// Derivative of `apply` at `p`, dimensionless; column `i` is the derivative along axis `i`.
    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss>;
}

/// A point with finite coordinates; others are outside every domain.
fn finite(p: DVec3) -> Result<DVec3, Miss> {
    if p.is_finite() { Ok(p) } else { Err(Miss::OutsideDomain) }
}
