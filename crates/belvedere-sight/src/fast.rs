//! Stages that are computed faster than through [`belvedere_core::map::StageMap`]: the only file of what draws and judges that names
//! techniques; all others ask a stage for its properties.

use belvedere_core::map::unroll::Unroll;
use belvedere_core::{CurvedRays, EarthCurvature, SplineBend, Stage, TerrainDisocclusion};

/// A stage by its faster form.
#[derive(Debug, Clone, Copy)]
pub enum Fast<'a> {
    /// One addition that depends on the squared distance from the eye.
    Earth(&'a EarthCurvature),
    /// One addition, read from a grid; the ground is moved instead of bending rays.
    Ground(&'a TerrainDisocclusion),
    /// A table of the curve; the rays of an image row bend alike.
    Spline(&'a SplineBend),
    /// Closed forms of records and of the pieces of rays.
    Rays(&'a CurvedRays),
    /// Rays are straight in the world.
    Circle(&'a Unroll),
    /// No faster form: the stage's own methods are called.
    None,
}

impl<'a> Fast<'a> {
    /// The form of a stage.
    pub fn of(stage: &'a Stage) -> Self {
        match stage {
            Stage::EarthCurvature(earth) => Self::Earth(earth),
            Stage::TerrainDisocclusion(ground) => Self::Ground(ground),
            Stage::SplineBend(bend) => Self::Spline(bend),
            Stage::CurvedRays(rays) => Self::Rays(rays),
            Stage::Unroll(circle) => Self::Circle(circle),
            _ => Self::None,
        }
    }
}
