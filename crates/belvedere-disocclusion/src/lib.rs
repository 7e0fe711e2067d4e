//! Terrain that makes way: the ground moves as little as possible so that what must be seen is seen.
//!
//! After Deng et al. 2013 (*Occlusion-free mountain navigation*): a greedy pass and a smooth one; and a quadratic program
//! that guarantees what those two only try.

mod cells;
mod error;
mod greedy;
mod metrics;
mod points;
mod register;
mod settings;
mod smooth;
mod solve;
mod viewpoint;
pub mod visibility_qp;

pub use belvedere_sight::{Field, FieldError};
pub use cells::{Cells, NO_CELL};
pub use error::DisocclusionError;
pub use greedy::{
    Affine, Blocks, EyeError, GreedyCounters, LeftOut, Naive, Pieces, Price, Wedge, blended, check_eye, in_view,
    scale_to_clear, shift_to_clear,
};
pub use metrics::{Deformation, FrameChange, TerrainMetrics, terrain_metrics};
pub use points::{PointKind, ReferencePoint, Unusable, UnusableReason, candidate_points, reference_points};
pub use settings::{Detail, LONGEST_SMOOTHING_M, SolverMode, TerrainSettings, stated_spacing};
#[cfg(feature = "sparse")]
pub use smooth::Cholesky;
pub use smooth::{
    Between, ConjugateGradients, Convergence, Dct, ElevationRows, Green, Hierarchy, Real, SmoothError, SmoothMemory,
    SmoothPass, Smoothed, Smoother, grid_weight, laplacian, row_weight, temporal_weight,
};
pub use solve::{
    Covered, Fallback, LiveFrame, LiveTerrain, QpReport, Solved, TerrainMemory, TerrainReport, TerrainSolver,
    TerrainTimes, UnresolvedReason, UnresolvedRun,
};
pub use viewpoint::{
    AdjustedViewpoint, ViewpointEnergy, ViewpointOptions, adjust_viewpoint, ghost_alpha, height_slope,
};
