//! Terrain disocclusion: the ground moves as little as possible so that the required features are visible.
//!
//! After Deng et al. 2013 (*Occlusion-free mountain navigation*): a greedy and a smooth pass; and a quadratic program that guarantees
//! visibility, which those two do not. [`TerrainSolver`] goes from [`TerrainSettings`] and a scene to a displacement and a
//! [`TerrainReport`].

// Internal modules are public only with the feature `internals`.
#![cfg_attr(not(feature = "internals"), allow(unreachable_pub, unused_imports, dead_code))]

mod cells;
pub mod error;
pub mod ghost;
mod greedy;
mod in_view;
mod metrics;
mod points;
pub mod rivers;
mod settings;
mod smooth;
mod solve;
mod spikes;
mod viewpoint;
mod visibility_qp;

pub use error::DisocclusionError;
pub use settings::{Detail, SolverMode, TerrainSettings};
pub use solve::{
    FileToWrite, HeightsUnder, LiveFrame, LiveTerrain, PlanMap, SampleGrid, Solved, TerrainMemory, TerrainReport,
    TerrainSolver, WrittenGround, WrittenShares,
};
pub use viewpoint::{AdjustedViewpoint, ViewpointOptions};

use belvedere_sight::Field;
use cells::{Cells, NO_CELL};
use greedy::{BlockMaxima, GreedyCounters, Naive};
use in_view::{LeftOut, Wedge, check_eye, in_view};
use metrics::{Deformation, TerrainMetrics};
use points::{
    KINDS, PointKind, ReferencePoint, Unusable, UnusableReason, candidate_points, judged_points, reference_points,
};
use settings::stated_spacing;
use smooth::{Hierarchy, SmoothPass, Smoother, grid_weight, temporal_weight};
use viewpoint::{ViewpointEnergy, adjust_viewpoint, height_slope};

/// Types of the parts of a [`TerrainReport`].
pub mod report {
    pub use super::rivers::RiverReport;
    pub use super::spikes::Spike;
    pub use crate::greedy::GreedyCounters;
    pub use crate::metrics::{FrameChange, TerrainMetrics};
    pub use crate::points::PointKind;
    pub use crate::solve::{
        BANK_M, CertifiedLine, Covered, Fallback, FeatureCost, HigherEye, LakeReport, LikenessFigures, LikenessReport,
        LimitsReport, PricePoint, PriceReport, PricedStretch, QpReport, Taken, TerrainTimes, TrimReport,
        UnresolvedReason, UnresolvedRun,
    };
}

/// The inside of the solver, for measurements, figures and tests. Not stable: any name may change or go without notice.
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod internals {
    pub use crate::cells::{Cells, NO_CELL};
    pub use crate::greedy::{BlockMaxima, Naive};
    pub use crate::in_view::{EyeError, LeftOut, Wedge, check_eye, in_view};
    pub use crate::metrics::{Deformation, terrain_metrics};
    pub use crate::points::{ReferencePoint, Unusable, UnusableReason, reference_points};
    pub use crate::settings::{LONGEST_SMOOTHING_M, stated_spacing};
    #[cfg(feature = "sparse")]
    pub use crate::smooth::Cholesky;
    pub use crate::smooth::{
        Between, ConjugateGradients, Convergence, ElevationRows, Green, Hierarchy, SmoothPass, Smoothed, Smoother,
        grid_weight, laplacian, row_weight, temporal_weight,
    };
    pub use crate::viewpoint::{ViewpointEnergy, adjust_viewpoint, height_slope};
    pub use crate::visibility_qp::{
        Candidate, Certificate, LinesOfSight, QpError, QpOptions, QpProblem, QpResult, QpSolver, Reason, SolvedRow,
        StraightSight, Unresolved, ViewSight,
    };
    pub use belvedere_sight::Field;
}
