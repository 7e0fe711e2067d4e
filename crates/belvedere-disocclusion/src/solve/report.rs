//! Report of a displacement: visibility, displacement and cost, written as JSON.

use super::super::visibility_qp::QpResult;
use super::super::{GreedyCounters, PointKind, TerrainMetrics, TerrainSettings};
use super::{Fallback, HigherEye, LakeReport, LikenessReport, LimitsReport, PriceReport};
use crate::rivers::RiverReport;
use crate::spikes::Spike;
use serde::Serialize;

/// Everything about a solved displacement. Lengths in scene units.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TerrainReport {
    /// The parameters, with defaults filled in.
    pub parameters: TerrainSettings,
    /// Smoothness weight in force, for a solver's grid of 129 nodes.
    pub w: f64,
    /// Wavelength over 2 pi at which the smoothing halves a displacement; in mode qp at most
    /// `LONGEST_SMOOTHING_M` unless w was stated.
    pub smoothing_length_m: f64,
    /// Columns and rows of the solver's grid.
    pub solver_grid: [usize; 2],
    /// Reference points in view.
    pub points: usize,
    /// Number of points that are demanded: reference points and candidates in view. 0 = no point is, and the ground stays as it is.
    pub asked: usize,
    /// Visibility and displacement, by a judge that is independent of the solver. Dense points lie every tenth of a grid cell along
    /// lines and rims and on the edges of the ground's triangles inside areas; those in the picture count (but see
    /// [`super::TerrainSolver::in_plan`]).
    #[serde(flatten)]
    pub metrics: TerrainMetrics,
    /// Likeness to the undisplaced ground; `None` in films.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub likeness: Option<LikenessReport>,
    /// One of this many dense points was judged: 1, but more in frames of films and where time was up, so that judging takes no
    /// longer than solving. Where it is more than 1, a guarantee needs all reference points and all judged points to be seen.
    pub judged_every: usize,
    /// [`TerrainMetrics::visible`] without the displacement.
    pub visible_before: f64,
    /// [`TerrainMetrics::visible_dense`] without the displacement.
    pub visible_dense_before: f64,
    /// Share of the whole features on the ground that is in view, 0..=1, by the dense points: the least of lines by length, areas by area
    /// and points by number. 1 without features.
    pub in_view: f64,
    /// Visible share of the whole features, 0..=`in_view`: what is not in view is not visible.
    pub visible_whole: f64,
    /// `visible_whole` without the displacement.
    pub visible_whole_before: f64,
    /// The greedy pass; `None` in mode qp.
    pub greedy: Option<GreedyCounters>,
    /// The quadratic program; `None` in mode paper.
    pub qp: Option<QpReport>,
    /// Features that the ground moves for most, at most three, the most expensive first; empty in mode paper.
    pub costliest: Vec<FeatureCost>,
    /// Fallbacks that were used for contradicting rows, in their order; usually empty.
    pub fallbacks: Vec<Fallback>,
    /// Ground that was filled up to keep the limits of depth and slope; `None` if the limits changed nothing.
    pub limited: Option<LimitsReport>,
    /// Spikes of the elevation model, the largest first; the solver replaced them by the median of their surroundings.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub spikes: Vec<Spike>,
    /// Lakes and how they moved: each as a whole.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lakes: Vec<LakeReport>,
    /// The rivers that must not run uphill, and how they run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rivers: Vec<RiverReport>,
    /// Whether every candidate in view is guaranteed to be seen in this picture, no river that was named runs uphill by more than
    /// [`crate::rivers::RIVER_TOLERANCE_M`], and the judge agrees: of what is in view at
    /// least 0.9999 is seen ([`TerrainMetrics::visible_dense`]); `hidden` names the rest. Where nothing is asked for nothing is
    /// guaranteed.
    pub guaranteed: bool,
    /// Whether the solver shows all that is asked for and no river runs uphill: `guaranteed` without the judge.
    #[serde(skip)]
    pub(super) promised: bool,
    /// Whether the solver was out of time and ended with the best it had.
    pub out_of_time: bool,
    /// Which ground was taken when time was up: the one that shows most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub taken: Option<Taken>,
    /// Parts of features that cannot be seen, with the reason.
    pub unresolved: Vec<UnresolvedRun>,
    /// Other parts in view that the judge finds hidden, with the reason: points between two candidates.
    pub hidden: Vec<UnresolvedRun>,
    /// What was given up so that the ground moves less, where a price is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub price: Option<PriceReport>,
    /// A higher eye that would save much of the displacement, where something was given up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub higher_eye: Option<HigherEye>,
    /// Points that stay covered at the price of slack.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub covered: Vec<Covered>,
    /// Times.
    pub times: TerrainTimes,
}

/// A point that stays covered because clearing it costs more than the price of slack allows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Covered {
    /// Scene x, y.
    pub at: [f64; 2],
    /// Height over the ground at which it must be seen.
    pub lift_m: f64,
    /// How far the ground rises over its line of sight.
    pub over_m: f64,
}

/// Cost of a feature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FeatureCost {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Share of the energy that its lines of sight ask for, 0..=1.
    pub share: f64,
}

/// Figures of the quadratic program.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QpReport {
    /// Rounds in which all lines of sight were checked.
    pub rounds: usize,
    /// Rows at the end.
    pub rows: usize,
    /// Rows with a multiplier.
    pub active: usize,
    /// Rows added.
    pub added: usize,
    /// Rows taken over from the frame before.
    pub kept: usize,
    /// Points that had to be seen.
    pub candidates: usize,
    /// Half the squared norm of the displacement against its target.
    pub energy: f64,
}

impl QpReport {
    /// * `candidates`: points that had to be seen.
    pub(super) fn of(result: &QpResult, candidates: usize) -> Self {
        let QpResult { rounds, rows, added, kept, energy, .. } = *result;
        Self { rounds, rows, active: result.active.len(), added, kept, candidates, energy }
    }
}

/// Wall times, milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TerrainTimes {
    /// Preparation of cells, points and tables; nearly 0 after the first frame.
    pub prepare_ms: f64,
    /// Greedy pass.
    pub greedy_ms: f64,
    /// Smooth pass.
    pub smooth_ms: f64,
    /// Quadratic program.
    pub qp_ms: f64,
    /// Figures of this report.
    pub report_ms: f64,
}

/// Why a part of a feature is not seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum UnresolvedReason {
    /// Beside the terrain.
    OutsideDem,
    /// Where the terrain holds no data.
    NoData,
    /// Nearer to the eye than three times the guard.
    NearerThanGuard,
    /// It has no line of sight, for it lies outside the domain of a later stage.
    NoLineOfSight,
    /// Rows contradict each other: no displacement down to `depth_m` shows all points that are demanded.
    Infeasible {
        /// Displacements down to this are ruled out.
        depth_m: f64,
        /// Height by which the weighted rows are missed at best, > 0.
        gap_m: f64,
        /// Rows of the proof.
        rows: usize,
    },
    /// The quadratic program used up its rounds.
    NotSettled {
        /// Height by which rows are still missed, metres.
        lacks_m: f64,
    },
    /// The greedy pass could not show it.
    Greedy,
    /// The greedy pass showed it and the smooth pass covered it again, as mode `paper` does.
    Smoothed {
        /// How far the ground rises over its line of sight.
        over_m: f64,
    },
    /// The program counts it as seen, the judge as hidden.
    Judged {
        /// How far the ground rises over its line of sight.
        over_m: f64,
    },
    /// The ground that was solved on shows it; the samples of the written file, which are others, hide it.
    Written {
        /// How far they rise over its line of sight.
        over_m: f64,
    },
    /// It lies between two points that are seen.
    Between {
        /// How far the ground rises over its line of sight.
        over_m: f64,
    },
    /// It was given up, for showing it moves more ground than is allowed.
    GivenUp {
        /// How far the ground rises over its line of sight.
        over_m: f64,
    },
    /// Showing it takes ground deeper or steeper than the limits.
    Limits {
        /// How far the ground rises over its line of sight.
        over_m: f64,
    },
    /// Ground nearer to it than the guard hides it.
    InsideGuard {
        /// How far that ground rises over its line of sight.
        over_m: f64,
    },
}

/// A part of a feature that is not seen: points one after the other with the same reason.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnresolvedRun {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Kind of points.
    pub kind: PointKind,
    /// Length along the feature at the first point.
    pub from_m: f64,
    /// Length along the feature at the last point.
    pub to_m: f64,
    /// Scene x, y of the first point.
    pub at: [f64; 2],
    /// Points.
    pub points: usize,
    /// Reason, with the figures of the first point, but the largest rise of ground over a line of sight of all points.
    #[serde(flatten)]
    pub reason: UnresolvedReason,
}

/// The ground that was taken where time was up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "ground", rename_all = "snake_case")]
pub enum Taken {
    /// The undisplaced ground: no other showed more.
    #[default]
    Unmoved,
    /// The ground of the frame before.
    FrameBefore,
    /// The solution of the quadratic program for a sample of its candidates.
    Sample {
        /// One of this many candidates was demanded.
        every: usize,
    },
    /// The unfinished solution of the quadratic program.
    Unfinished,
    /// The ground of the greedy and the smooth pass.
    SinglePass,
}
