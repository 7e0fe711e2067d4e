//! Errors of terrain disocclusion. A reference point that cannot be made visible is a result, not an error.

use belvedere_core::grid::GridError;
use belvedere_core::plain::number;
use belvedere_scene::Cancelled;

pub use crate::in_view::EyeError;
pub use crate::rivers::RiverError;
pub use crate::smooth::SmoothError;
pub use crate::visibility_qp::QpError;
pub use belvedere_sight::FieldError;

/// Terrain that could not be solved at all.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DisocclusionError {
    /// Cancelled through [`belvedere_scene::Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The scene has no terrain.
    #[error("the scene has no terrain layer; terrain disocclusion needs one")]
    NoTerrain,
    /// No layer of the scene must be seen.
    #[error("none of the {layers} layers has must_see = true; mark the features that the picture is made for")]
    NothingToSee {
        /// Layers of the scene.
        layers: usize,
    },
    /// A river is not a line layer of the scene.
    #[error(transparent)]
    River(#[from] RiverError),
    /// A parameter out of range.
    #[error("{key} is {}, it must be {range}", number(*value))]
    Setting {
        /// Name, as scene files write it.
        key: &'static str,
        /// Value given.
        value: f64,
        /// Range, as `in 0..=1` or `greater than 0`.
        range: &'static str,
    },
    /// An eye from which terrain cannot be solved.
    #[error(transparent)]
    Eye(#[from] EyeError),
    /// Terrain that cannot be solved on.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A smooth pass that cannot be set up.
    #[error(transparent)]
    Smooth(#[from] SmoothError),
    /// A quadratic program that cannot be set up.
    #[error(transparent)]
    Qp(#[from] QpError),
    /// A displacement that does not form a grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A pinhole whose stages do not form a view.
    #[error(transparent)]
    View(#[from] belvedere_core::ViewError),
}
