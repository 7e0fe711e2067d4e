//! Points that a picture shows or would show if nothing hid them; visible shares are shares of these.

use super::super::{Field, ReferencePoint};
use super::in_picture;
use crate::DisocclusionError;
use belvedere_core::grid::Grid;
use belvedere_core::{Stage, TerrainDisocclusion, View};
use rayon::prelude::*;

/// A picture, or all ground between its left and its right border.
pub(super) enum Shown {
    Picture(Box<View>),
    InPlan,
}

impl Shown {
    /// The picture of `base` over undisplaced ground; `in_plan`: all that lies above and below it as well.
    pub(super) fn before(base: &View, in_plan: bool) -> Result<Self, DisocclusionError> {
        Self::with(base, None, in_plan)
    }

    /// The picture of `base` over displaced ground; `in_plan`: all that lies above and below it as well.
    pub(super) fn after(base: &View, delta: &Grid, in_plan: bool) -> Result<Self, DisocclusionError> {
        Self::with(base, Some(delta), in_plan)
    }

    fn with(base: &View, delta: Option<&Grid>, in_plan: bool) -> Result<Self, DisocclusionError> {
        if in_plan {
            return Ok(Self::InPlan);
        }
        let is_ground = |s: &Stage| matches!(s, Stage::TerrainDisocclusion(_));
        let mut stages: Vec<Stage> = base.stages().iter().filter(|s| !is_ground(s)).cloned().collect();
        if let Some(delta) = delta {
            let after_earth = stages.iter().position(|s| matches!(s, Stage::EarthCurvature(_))).map_or(0, |i| i + 1);
            stages.insert(after_earth, Stage::TerrainDisocclusion(TerrainDisocclusion::new(delta.clone())));
        }
        Ok(Self::Picture(Box::new(View::new(base.pinhole().clone(), stages)?)))
    }

    /// Whether a point lies in it, hidden or not.
    pub(super) fn holds(&self, field: &Field, p: &ReferencePoint) -> bool {
        match self {
            Self::InPlan => true,
            Self::Picture(view) => in_picture::holds(view, field.scene_from_grid(p.grid).extend(p.ground + p.lift)),
        }
    }

    /// The points that lie in it.
    pub(super) fn of(&self, field: &Field, points: &[ReferencePoint]) -> Vec<ReferencePoint> {
        points.par_iter().filter(|p| self.holds(field, p)).copied().collect()
    }
}
