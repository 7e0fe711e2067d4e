//! A displacement that can be used when time is up.

use super::super::visibility_qp::{QpResult, SolvedRow, Unresolved};
use super::{LimitsReport, Outcome, QpReport, Taken};

/// A displacement that can be used when time is up.
#[derive(Default)]
pub(super) struct Ground {
    pub(super) taken: Taken,
    pub(super) coarse: Vec<f64>,
    /// Change of detail at every node.
    pub(super) detail: Option<Vec<f64>>,
    pub(super) full: Option<Vec<f64>>,
    pub(super) limited: Option<LimitsReport>,
    pub(super) qp: Option<QpReport>,
    pub(super) unresolved: Vec<Unresolved>,
    pub(super) rows: Vec<SolvedRow>,
}

impl Ground {
    pub(super) fn plain(taken: Taken, coarse: Vec<f64>) -> Self {
        Self { taken, coarse, ..Self::default() }
    }

    /// The greedy and the smooth pass, with the change of detail at every node.
    pub(super) fn single_pass(coarse: &[f64], detail: Option<Vec<f64>>) -> Self {
        Self { detail, ..Self::plain(Taken::SinglePass, coarse.to_vec()) }
    }

    /// A solution of the quadratic program.
    pub(super) fn solved(taken: Taken, result: QpResult, candidates: usize) -> Self {
        let qp = Some(QpReport::of(&result, candidates));
        let QpResult { u, unresolved, active, .. } = result;
        Self { qp, unresolved, rows: active, ..Self::plain(taken, u) }
    }

    /// Replaces the outcome by this ground.
    pub(super) fn put(self, done: &mut Outcome) {
        let Self { coarse, full, limited, qp, unresolved, rows, .. } = self;
        (done.coarse, done.full, done.fine) = (coarse, full, None);
        (done.limited, done.qp_unresolved, done.rows) = (limited, unresolved, rows);
        done.qp = qp.or(done.qp);
        done.fallbacks.clear();
    }
}
