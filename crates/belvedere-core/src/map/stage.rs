//! The stages of a view: the maps of scene files, and maps of one's own.

use super::{StageMap, curved_rays, earth, relief, rigid, spline, split_rays, strip, terrain};
use std::ops::Deref;
use std::sync::Arc;

/// One displacement of a view. What drawing asks of it is [`StageMap`], to which it leads by [`Deref`]; the variants are named where scene
/// files become stages and where a faster form is chosen.
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
    /// A map of one's own; there may be several.
    Own(OwnMap),
    /// Rays bend around occluders (Cui et al. 2010).
    CurvedRays(curved_rays::CurvedRays),
    /// Rays bend, and part at seams of the picture.
    SplitRays(split_rays::SplitRays),
}

/// A map of one's own as a stage; equal to itself and its clones alone.
#[derive(Debug, Clone)]
pub struct OwnMap(Arc<dyn StageMap>);

impl PartialEq for OwnMap {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Stage {
    /// A map of one's own as a stage.
    ///
    /// ```
    /// use belvedere_core::map::{Miss, StageMap};
    /// use belvedere_core::{DMat3, DVec3, Pinhole, Projection, SpaceMap, Stage, View};
    ///
    /// /// Raises everything by as much.
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

    /// Place in the fixed order of application: earth, terrain, strip, relief, spline, own maps, curved rays.
    pub fn rank(&self) -> u32 {
        match self {
            Self::EarthCurvature(_) => 0,
            Self::TerrainDisocclusion(_) => 1,
            Self::Strip(_) => 2,
            Self::Relief(_) => 3,
            Self::SplineBend(_) | Self::Body(_) => 4,
            Self::Own(_) => 5,
            Self::CurvedRays(_) | Self::SplitRays(_) => 6,
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
            Self::Strip(m) => m,
            Self::Relief(m) => m,
            Self::SplineBend(m) => m,
            Self::Body(m) => m,
            Self::Own(m) => &*m.0,
            Self::CurvedRays(m) => m,
            Self::SplitRays(m) => m,
        }
    }
}
