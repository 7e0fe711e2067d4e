//! The stages of a view: their trait for drawing, picking and measuring, the maps of scene files, and users' own maps.

use super::{
    Displaced, Miss, SpaceMap, curved_rays, earth, ground_moves, relief, rigid, spline, split_rays, straighten,
    terrain, unroll,
};
use crate::Aabb;
use glam::{DMat3, DVec3};
use std::fmt::Debug;
use std::ops::Deref;
use std::sync::Arc;

/// A map as a stage of a view. The default methods are right for any map that is smooth at the scale of the drawn edges, but slower or less
/// tight than methods made for the map.
pub trait StageMap: SpaceMap + Debug + Send + Sync {
    /// Name of the stage, as scene files write it where they have it.
    fn name(&self) -> &'static str {
        "own"
    }

    /// `apply` with the segment and the fold flag.
    ///
    /// # Errors
    /// Those of [`SpaceMap::apply`].
    fn displace(&self, p: DVec3) -> Result<Displaced, Miss> {
        Ok(Displaced { point: self.apply(p)?, segment: 0, folded: false })
    }

    /// `invert` with the segment of the ray.
    ///
    /// # Errors
    /// Those of [`SpaceMap::invert`].
    fn undisplace(&self, p_displaced: DVec3) -> Result<(DVec3, u32), Miss> {
        Ok((self.invert(p_displaced)?, 0))
    }

    /// This stage at a share of its strength, 0 < share <= 1; towards 0 it becomes the identity. Stages of the world keep full strength.
    ///
    /// `None` if the stage is not valid at that share, as some turns. By default `None`.
    fn eased(&self, _share: f64) -> Option<Stage> {
        None
    }

    /// Bound on the distance, in scene units, between the image of the straight edge `p0 p1` and the straight edge between the images of its
    /// ends (the error a renderer makes by not subdividing it). Infinite where no bound is known.
    ///
    /// By default an estimate: 1.5 times the largest distance at the quarters of the edge, which is a bound for parabolas and cubics.
    fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        bow(self, p0, p1)
    }

    /// Images of both ends of an edge and [`StageMap::edge_bound`]; `None` if an end has no image.
    fn edge(&self, p0: DVec3, p1: DVec3) -> Option<(DVec3, DVec3, f64)> {
        Some((self.apply(p0).ok()?, self.apply(p1).ok()?, self.edge_bound(p0, p1)))
    }

    /// A box that contains the displaced image of every point of `bounds`; `None` if part of it has no image or no bound is known, as by
    /// default: then nothing is culled.
    fn displaced_bounds(&self, _bounds: &Aabb) -> Option<Aabb> {
        None
    }

    /// Whether no point of `bounds` has an image; `false` also where that is not known, as by default.
    fn misses(&self, _bounds: &Aabb) -> bool {
        false
    }

    /// Whether points without image may lie between points that have one, so that renderers test edges between their ends. By default
    /// `true`.
    fn has_border(&self) -> bool {
        true
    }

    /// Whether points of a nearly straight way between displaced points, its ends and its middle, may be images of points; `None` where that
    /// is not known, as by default.
    fn may_hold(&self, _way: [DVec3; 3]) -> Option<bool> {
        None
    }

    /// Where the images of points beside each other lie apart; `None` where that is nowhere, as by default.
    fn seam(&self) -> Option<unroll::Seam> {
        None
    }

    /// Points of a domain that is small or winding, all through its part in `bounds`, so that renderers do not miss it; by default none.
    fn points_within(&self, _bounds: &Aabb) -> Vec<DVec3> {
        Vec::new()
    }

    /// Whether the stage belongs to the world: it stays in the straight picture, and is no bend. By default `false`.
    fn is_of_world(&self) -> bool {
        false
    }

    /// Whether the stage moves the ground and its light with it. By default `false`: a bend leaves the light as on the undisplaced ground.
    fn moves_ground(&self) -> bool {
        false
    }

    /// Whether points of a vertical line all move along it, by the same height. By default `false`.
    fn is_upright(&self) -> bool {
        false
    }

    /// Whether heights may point anywhere after the stage, or change their length. By default `true`.
    fn turns_heights(&self) -> bool {
        true
    }

    /// How a rigid body turns that the stage carries as a whole, with its foot at `foot`. By default the rotation nearest to the derivative.
    ///
    /// # Errors
    /// Those of [`SpaceMap::jacobian`].
    fn rotation_of_body(&self, foot: DVec3) -> Result<DMat3, Miss> {
        nearest_rotation(self.jacobian(foot)?).ok_or(Miss::OutsideDomain)
    }
}

/// 1.5 times the largest distance between the image of a straight edge and the edge between the images of its ends at the quarters.
pub(super) fn bow<M: SpaceMap + ?Sized>(map: &M, p0: DVec3, p1: DVec3) -> f64 {
    let (Ok(a), Ok(b)) = (map.apply(p0), map.apply(p1)) else { return f64::INFINITY };
    let off = |t: f64| map.apply(p0.lerp(p1, t)).map_or(f64::INFINITY, |p| p.distance(a.lerp(b, t)));
    1.5 * [0.25, 0.5, 0.75].into_iter().map(off).fold(0.0, f64::max)
}

/// The rotation nearest to a matrix of positive determinant, by Higham's iteration `q <- (q + q^-T) / 2`. `None` where the determinant is
/// not positive.
///
/// Source: Higham, Computing the polar decomposition, 1986.
fn nearest_rotation(m: DMat3) -> Option<DMat3> {
    let mut q = m;
    for _ in 0..64 {
        if !(q.determinant() > 0.0) {
            return None;
        }
        let next = 0.5 * (q + q.inverse().transpose());
        let change = (next - q).to_cols_array().into_iter().fold(0.0f64, |most, v| most.max(v.abs()));
        q = next;
        if change < 1e-14 {
            break;
        }
    }
    q.is_finite().then_some(q)
}

/// One displacement of a view. It dereferences ([`Deref`]) to [`StageMap`], which renderers use; only the conversion from scene files and
/// the choice of faster forms name the variants.
#[derive(Debug, Clone, PartialEq)]
pub enum Stage {
    /// The ground falls away with the distance as on a sphere (`earth = "curved"`).
    EarthCurvature(earth::EarthCurvature),
    /// The ground moves so that routes are seen (Deng et al. 2013).
    TerrainDisocclusion(terrain::TerrainDisocclusion),
    /// The ground moves sideways and up or down as an author set it.
    GroundMoves(ground_moves::GroundMoves),
    /// A strip along a route is unrolled in plan.
    Strip(straighten::Strip),
    /// A tube along a centreline is straightened.
    Tube(straighten::Tube),
    /// The circle around the eye is unrolled.
    Unroll(unroll::Unroll),
    /// Heights are raised, lowered, shown in plan or levelled.
    Relief(relief::Relief),
    /// Space is carried onto a B-spline over the reference plane (Pasewaldt et al. 2011).
    SplineBend(spline::SplineBend),
    /// A body is carried as a whole, see [`crate::View::of_body`]: in place of all stages up to the spline bend.
    Body(rigid::RigidMotion),
    /// A user's own map; there may be several.
    Own(OwnMap),
    /// Rays bend around occluders (Cui et al. 2010).
    CurvedRays(curved_rays::CurvedRays),
    /// Rays bend, and part at seams of the picture.
    SplitRays(split_rays::SplitRays),
}

/// A user's own map as a stage; equal only to itself and its clones.
#[derive(Debug, Clone)]
pub struct OwnMap(Arc<dyn StageMap>);

impl PartialEq for OwnMap {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Stage {
    /// A user's own map as a stage.
    ///
    /// ```
    /// use belvedere_core::map::StageMap;
    /// use belvedere_core::{DMat3, DVec3, Miss, Pinhole, Projection, SpaceMap, Stage, View};
    ///
    /// /// Raises every point by the given height.
    /// #[derive(Debug)]
    /// struct Raised(f64);
    ///
    /// impl SpaceMap for Raised {
    ///     fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
    ///         Ok(p + self.0 * DVec3::Z)
    ///     }
    ///     fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
    ///         Ok(p_displaced - self.0 * DVec3::Z)
    ///     }
    ///     fn jacobian(&self, _: DVec3) -> Result<DMat3, Miss> {
    ///         Ok(DMat3::IDENTITY)
    ///     }
    /// }
    /// impl StageMap for Raised {}
    ///
    /// let lens = Projection::Perspective { fov_y: 0.8 };
    /// let camera = Pinhole::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens, [640, 480], 0.1, None)?;
    /// let view = View::new(camera, vec![Stage::own(Raised(1.0))])?;
    /// assert_eq!(view.ray(view.project(DVec3::Y).unwrap().pixel).at(1.0).unwrap().point, DVec3::Y);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn own(map: impl StageMap + 'static) -> Self {
        Self::Own(OwnMap(Arc::new(map)))
    }

    /// Position in the fixed order of application: earth, terrain, moved ground, strip, tube or circle, relief, spline, own maps, curved rays.
    pub fn rank(&self) -> u32 {
        match self {
            Self::EarthCurvature(_) => 0,
            Self::TerrainDisocclusion(_) => 1,
            Self::GroundMoves(_) => 2,
            Self::Strip(_) | Self::Tube(_) | Self::Unroll(_) => 3,
            Self::Relief(_) => 4,
            Self::SplineBend(_) | Self::Body(_) => 5,
            Self::Own(_) => 6,
            Self::CurvedRays(_) | Self::SplitRays(_) => 7,
        }
    }

    /// Whether the stage bends rays about turns, the last of a chain: [`Stage::CurvedRays`] or [`Stage::SplitRays`].
    pub fn bends_rays(&self) -> bool {
        matches!(self, Self::CurvedRays(_) | Self::SplitRays(_))
    }
}

impl Deref for Stage {
    type Target = dyn StageMap;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::EarthCurvature(m) => m,
            Self::TerrainDisocclusion(m) => m,
            Self::GroundMoves(m) => m,
            Self::Strip(m) => m,
            Self::Tube(m) => m,
            Self::Unroll(m) => m,
            Self::Relief(m) => m,
            Self::SplineBend(m) => m,
            Self::Body(m) => m,
            Self::Own(m) => &*m.0,
            Self::CurvedRays(m) => m,
            Self::SplitRays(m) => m,
        }
    }
}
