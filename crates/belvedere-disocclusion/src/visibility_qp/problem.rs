//! Input and output of the visibility program.

use crate::TerrainSettings;
use belvedere_core::DVec2;

/// A point that must be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Identifier, the same in every frame: rows are remembered by it.
    pub id: u32,
    /// Grid coordinates, on the field.
    pub grid: DVec2,
    /// Height over the ground at which it must be seen, metres.
    pub lift: f64,
}

impl Candidate {
    /// A point that must be seen.
    pub fn new(id: u32, grid: DVec2, lift: f64) -> Self {
        Self { id, grid, lift }
    }
}

/// Lines of sight from points to the eye.
pub trait LinesOfSight: Sync {
    /// Appends the line of sight of the point at `grid` (grid coordinates) and height `z`, from the point to the eye, as a
    /// chain of (grid coordinates, height); nothing if the point has none, e.g. outside the domain of a stage.
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>);

    /// The eye (grid coordinates, height) if every line is a straight segment to it, or to a point over it that depends only on the
    /// plan position of the candidate, so that lines depend linearly on the heights of their points.
    fn straight(&self) -> Option<(DVec2, f64)> {
        None
    }
}

/// Straight lines to one eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightSight {
    /// Grid coordinates of the eye; may lie beside the field.
    pub eye: DVec2,
    /// Height of the eye.
    pub z: f64,
}

impl LinesOfSight for StraightSight {
    fn trace(&self, grid: DVec2, z: f64, out: &mut Vec<(DVec2, f64)>) {
        out.extend([(grid, z), (self.eye, self.z)]);
    }

    fn straight(&self) -> Option<(DVec2, f64)> {
        Some((self.eye, self.z))
    }
}

/// Parameters of the program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QpOptions {
    /// Ground nearer than this to a candidate cannot hide it, cells.
    pub guard: f64,
    /// Clearance required of lines of sight, metres; it fades over the fifth of the line next to the candidate.
    pub margin: f64,
    /// Tolerance of that clearance, metres, fading likewise; > 0.
    pub tolerance: f64,
    /// Share of both that is left at the candidate itself, 0..=1, of candidates at least `margin` above the ground; with the lowest
    /// lift it becomes less. At 0 rows next to candidates must be met to the millimetre, and there are twice as many.
    pub near: f64,
    /// Most a node may rise, metres.
    pub ceiling: f64,
    /// Height by which a node may exceed its ceiling, metres, > 0.
    pub ceiling_tolerance: f64,
    /// Price of a metre of occlusion squared: rows may be missed by a slack at this price; `None` = they must be met.
    pub slack_price: Option<f64>,
    /// Rounds of row generation at most.
    pub rounds: usize,
    /// Rounds end where no clearance is missed by more than this, metres; 0 = where each is met.
    pub enough: f64,
}

impl QpOptions {
    /// Options for `settings`. The limit of rise is split: half of its tolerance of 0.5 m goes to the program, which
    /// keeps the far field, where the displacement dies away in ripples, from being held node by node.
    pub fn of(settings: &TerrainSettings) -> Self {
        Self {
            guard: settings.guard,
            margin: settings.margin_m,
            tolerance: (0.2 * settings.margin_m).max(1e-3),
            near: 0.5,
            ceiling: settings.rise_limit_m + 0.25,
            ceiling_tolerance: 0.24,
            slack_price: settings.slack_price,
            rounds: 80,
            enough: 0.0,
        }
    }
}

/// One frame.
#[derive(Clone, Copy)]
pub struct QpProblem<'a> {
    /// Points that must be seen: those of the frame, dense along features.
    pub candidates: &'a [Candidate],
    /// Lines of sight of the candidates.
    pub sight: &'a dyn LinesOfSight,
    /// Displacement that the solution stays close to, at the solver's nodes; `None` = none. In mode `qp` the smoothed last
    /// frame, in mode `paper+qp` the smooth pass.
    pub target: Option<&'a [f64]>,
    /// Ceiling of each node where it is not [`QpOptions::ceiling`] everywhere.
    pub ceilings: Option<&'a [f64]>,
}

/// A row of the solution: the sum of weights times displacements of nodes is at most the bound.
#[derive(Debug, Clone, PartialEq)]
pub struct SolvedRow {
    /// Candidate whose line of sight it keeps clear; `None` = a node below its ceiling, or a river that does not rise.
    pub candidate: Option<u32>,
    /// Index among the rows that a judge asked for, of one of those.
    pub given: Option<u32>,
    /// Position at which the ground comes near the line, grid coordinates.
    pub at: DVec2,
    /// Share of the distance from the candidate to the eye in plan.
    pub tau: f64,
    /// Nodes with their weights; a node may occur twice.
    pub weights: Vec<(u32, f64)>,
    /// Bound, metres.
    pub bound: f64,
    /// Multiplier, >= 0.
    pub multiplier: f64,
    /// Metres of occlusion that were bought, >= 0.
    pub slack: f64,
}

/// Why a candidate is not seen.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// Nearer to the eye than three times the guard.
    TooNear,
    /// It has no line of sight.
    NoLine,
    /// No displacement of the solver's grid within the depth limit shows all points that are demanded.
    Infeasible(Certificate),
    /// Still missed, by these metres, when the rounds were used up.
    NotSettled {
        /// Height by which rows are still missed, metres.
        lacks: f64,
    },
}

/// Proof that rows contradict each other: weighted by their multipliers they add up to one that no displacement
/// between -depth and the ceilings meets.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// Displacements down to this are ruled out, metres.
    pub depth: f64,
    /// Height by which the sum of the rows is missed at best, metres per unit of multiplier, > 0.
    pub gap: f64,
    /// Candidates of the rows with their multipliers, which add up to 1 together with those of the ceilings.
    pub rows: Vec<(u32, f64)>,
}

/// A candidate that is not seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Unresolved {
    /// Candidate.
    pub id: u32,
    /// Why.
    pub reason: Reason,
}

/// A solution.
#[derive(Debug, Clone, Default)]
pub struct QpResult {
    /// Displacement at the nodes of the solver's grid, metres.
    pub u: Vec<f64>,
    /// Rows with a multiplier.
    pub active: Vec<SolvedRow>,
    /// Rows at the end.
    pub rows: usize,
    /// Rows taken over from the frame before.
    pub kept: usize,
    /// Rows added in this frame.
    pub added: usize,
    /// Rounds in which all lines of sight were checked.
    pub rounds: usize,
    /// Candidates that are not seen with the required clearance.
    pub unresolved: Vec<Unresolved>,
    /// `1/2 |u - u*|_H^2`.
    pub energy: f64,
    /// Wall time, milliseconds.
    pub milliseconds: f64,
    /// Whether it was stopped before it was done: more may be missed than is listed.
    pub stopped: bool,
}

/// A frame that cannot be solved at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QpError {
    /// The eye is under the ground.
    #[error(
        "the eye is {below:.1} m under the ground (height {eye:.1}, ground {ground:.1}); raise it above the ground"
    )]
    EyeUnderGround {
        /// Height of the eye.
        eye: f64,
        /// Height of the ground there.
        ground: f64,
        /// Difference.
        below: f64,
    },
    /// Arrays of the wrong length.
    #[error("{what} has {given} values for a solver's grid of {nodes} nodes; give one value per node")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        given: usize,
        /// Nodes of the solver's grid.
        nodes: usize,
    },
}
