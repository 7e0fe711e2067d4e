//! Guaranteed visibility: the displacement of least change and bending under which every candidate is seen.
//!
//! `min 1/2 |u - u*|_H^2` over displacements u of the solver's grid, subject to one row per position where the ground
//! would come too close to a line of sight, and to a ceiling for every node. That a point is seen is linear in u, so the
//! program is convex and its solution is the only one. Not in the paper.

mod augmented;
mod bundle;
mod candidate_line;
mod cholesky;
mod combination;
mod dissection;
mod dual;
mod front;
mod fronts;
mod given_row;
mod lanes;
mod levels;
mod matrix_free;
mod metric;
mod preconditioner;
mod problem;
mod register;
mod remembered;
mod rise;
mod row;
mod rows_in_play;
mod single_line;
mod solver;
mod surface;
mod ties;
mod uphill;
mod view_rays;
mod walk;

pub(crate) use given_row::GivenRow;
pub(crate) use levels::Levels;
pub use problem::{
    Candidate, Certificate, LinesOfSight, QpError, QpOptions, QpProblem, QpResult, Reason, SolvedRow, StraightSight,
    Unresolved,
};
pub(crate) use remembered::RememberedLines;
pub use solver::QpSolver;
pub use view_rays::ViewSight;
