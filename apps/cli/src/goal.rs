//! Goals.

/// Whether a verb reached its stated goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Goal {
    /// It did, or has none.
    Reached,
    /// It did not; the reasons are in its report.
    Missed,
}

impl Goal {
    /// Whether a stated goal was missed.
    pub(crate) fn is_missed(self) -> bool {
        self != Self::Reached
    }
}
