//! Displacements of space: the stages of a view.

pub mod curved_rays;
pub mod earth;
pub mod relief;
pub mod rigid;
pub mod spline;
pub mod split_rays;
pub mod strip;
pub mod terrain;

use crate::Aabb;
use glam::{DMat3, DVec3};

/// Why a point has no image. An answer, not an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Miss {
    /// The (displaced) point does not lie in front of the eye.
    BehindEye,
    /// The point lies where the map is not defined.
    OutsideDomain,
}

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

/// One displacement of a view. A closed set: the vocabulary of scene files and renderers.
#[derive(Debug, Clone, PartialEq)]
pub enum Stage {
    /// The ground falls away with the distance as on a sphere (`earth = "curved"`).
    EarthCurvature(earth::EarthCurvature),
    /// The ground moves so that routes are seen (Deng et al. 2013).
    TerrainDisocclusion(terrain::TerrainDisocclusion),
    /// A strip along a route is unrolled in plan.
    Strip(strip::Strip),
    /// Heights are raised, lowered, shown in plan or levelled.
    Relief(relief::Relief),
    /// Space is carried onto a B-spline over the reference plane (Pasewaldt et al. 2011).
    SplineBend(spline::SplineBend),
    /// A body is carried as a whole, see [`crate::View::of_body`]: in place of all stages up to the spline bend.
    Body(rigid::RigidMotion),
    /// Rays bend around occluders (Cui et al. 2010).
    CurvedRays(curved_rays::CurvedRays),
    /// Rays bend, and part at seams of the picture.
    SplitRays(split_rays::SplitRays),
}

impl Stage {
    /// This stage as a map.
    pub fn as_map(&self) -> &dyn SpaceMap {
        match self {
            Self::EarthCurvature(m) => m,
            Self::TerrainDisocclusion(m) => m,
            Self::Strip(m) => m,
            Self::Relief(m) => m,
            Self::SplineBend(m) => m,
            Self::Body(m) => m,
            Self::CurvedRays(m) => m,
            Self::SplitRays(m) => m,
        }
    }

    /// This stage at a share of its strength; the earth's curvature stays whole.
    ///
    /// * `share`: 0 < share <= 1; towards 0 the stage becomes the identity.
    ///
    /// `None` where there is no such stage, as with turns that only hold in full.
    pub fn eased(&self, share: f64) -> Option<Self> {
        match self {
            Self::EarthCurvature(m) => Some(Self::EarthCurvature(*m)),
            Self::TerrainDisocclusion(m) => m.eased(share).map(Self::TerrainDisocclusion),
            Self::Strip(m) => m.eased(share).map(Self::Strip),
            Self::Relief(m) => Some(Self::Relief(m.eased(share))),
            Self::SplineBend(m) => m.eased(share).map(Self::SplineBend),
            // A body moves by what the stages that carry it are: those are eased.
            Self::Body(_) => None,
            Self::CurvedRays(m) => m.eased(share).map(Self::CurvedRays),
            Self::SplitRays(m) => m.eased(share).map(Self::SplitRays),
        }
    }

    /// Whether the stage bends rays about turns, the last of a chain: [`Stage::CurvedRays`] or [`Stage::SplitRays`].
    pub fn bends_rays(&self) -> bool {
        matches!(self, Self::CurvedRays(_) | Self::SplitRays(_))
    }

    /// Whether points of a vertical line all move along it, by the same height.
    pub fn is_upright(&self) -> bool {
        matches!(self, Self::EarthCurvature(_) | Self::TerrainDisocclusion(_))
    }

    /// Position in the fixed order of application: earth, terrain, strip, relief, spline, curved rays.
    pub fn rank(&self) -> u32 {
        match self {
            Self::EarthCurvature(_) => 0,
            Self::TerrainDisocclusion(_) => 1,
            Self::Strip(_) => 2,
            Self::Relief(_) => 3,
            Self::SplineBend(_) | Self::Body(_) => 4,
            Self::CurvedRays(_) | Self::SplitRays(_) => 5,
        }
    }

    /// Name of the stage as scene files write it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::EarthCurvature(_) => "earth",
            Self::TerrainDisocclusion(_) => "terrain_disocclusion",
            Self::Strip(_) => "strip",
            Self::Relief(_) => "relief",
            Self::SplineBend(_) => "spline_bend",
            Self::Body(_) => "body",
            Self::CurvedRays(_) | Self::SplitRays(_) => "curved_rays",
        }
    }

    /// `apply` with the segment and the fold flag.
    pub fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        match self {
            Self::SplineBend(m) => Ok(Displaced { point: m.apply(p)?, segment: 0, folded: m.is_folded(p) }),
            Self::CurvedRays(m) => m.displace(p),
            Self::SplitRays(m) => m.displace(p),
            _ => Ok(Displaced { point: self.as_map().apply(p)?, segment: 0, folded: false }),
        }
    }

    /// Bound on the distance, in scene units, between the image of the straight edge `p0 p1` and the
    /// straight edge between the images of its ends (the error a renderer makes by not subdividing it).
    /// Infinite where no bound is known.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        match self {
            Self::EarthCurvature(m) => m.edge_bound(p0, p1),
            Self::TerrainDisocclusion(m) => m.edge_bound(p0, p1),
            Self::Strip(m) => m.edge_bound(p0, p1),
            Self::Relief(m) => m.edge_bound(p0, p1),
            Self::SplineBend(m) => m.edge_bound(p0, p1),
            Self::Body(_) => 0.0,
            Self::CurvedRays(m) => m.edge_bound(p0, p1),
            Self::SplitRays(m) => m.edge_bound(p0, p1),
        }
    }

    /// A box that contains the displaced image of every point of `bounds`; `None` if part of it has no image or no bound is known.
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        match self {
            Self::EarthCurvature(m) => m.displaced_bounds(bounds),
            Self::TerrainDisocclusion(m) => m.displaced_bounds(bounds),
            Self::Strip(m) => m.displaced_bounds(bounds),
            Self::Relief(m) => m.displaced_bounds(bounds),
            Self::SplineBend(m) => m.displaced_bounds(bounds),
            Self::Body(m) => Some(Aabb::of(bounds.corners().map(|p| m.carry(p)))),
            Self::CurvedRays(m) => m.displaced_bounds(bounds),
            Self::SplitRays(m) => m.displaced_bounds(bounds),
        }
    }

    /// Whether no point of `bounds` has an image; `false` also where that is not known.
    pub fn misses(&self, bounds: &Aabb) -> bool {
        matches!(self, Self::Strip(m) if m.misses(bounds))
    }
}
