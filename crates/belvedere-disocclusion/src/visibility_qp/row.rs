//! Rows of the program: `a u <= bound`.

use super::metric::Metric;
use crate::smooth::Between;
use belvedere_core::DVec2;

/// Two points of a river, by their indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stretch {
    pub(super) river: u32,
    pub(super) upstream: u32,
    pub(super) downstream: u32,
}

/// The condition of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Constraint {
    /// A node does not rise above its ceiling.
    Ceiling(u32),
    /// A river does not rise along a stretch.
    River(Stretch),
    /// The ground at `at` (grid) stays below the line of sight of a candidate; `tau` = share of the way to the eye.
    Sight { candidate: usize, at: DVec2, tau: f64 },
}

/// A row with at most eight nodes: four around the ground sample and four around the candidate, or around two points of a river.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) nodes: [u32; 8],
    pub(super) weights: [f64; 8],
    pub(super) len: usize,
    pub(super) bound: f64,
    pub(super) constraint: Constraint,
    /// The row as bilinear values at points, with their factors: two for the ground sample, two for the point that must be seen.
    pub(super) points: [(f64, Between); 4],
}

impl Row {
    /// * `at`: the node.
    pub(super) fn ceiling(node: u32, at: Between, bound: f64) -> Self {
        let (mut nodes, mut weights) = ([0; 8], [0.0; 8]);
        (nodes[0], weights[0]) = (node, 1.0);
        Self {
            nodes,
            weights,
            len: 1,
            bound,
            constraint: Constraint::Ceiling(node),
            points: [(1.0, at), (0.0, at), (0.0, at), (0.0, at)],
        }
    }

    /// Whether it must be met at any price, without slack.
    pub(super) fn is_firm(&self) -> bool {
        matches!(self.constraint, Constraint::Ceiling(_) | Constraint::River(_))
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = (u32, f64)> {
        self.nodes[..self.len].iter().copied().zip(self.weights[..self.len].iter().copied())
    }

    /// `a u`.
    pub(super) fn at(&self, u: &[f64]) -> f64 {
        self.entries().map(|(node, w)| w * u[node as usize]).sum()
    }

    /// `a H^-1 b` for the rows a and b.
    #[inline(always)]
    pub(super) fn product(&self, other: &Self, metric: &Metric) -> f64 {
        let mut sum = 0.0;
        for (f, a) in self.points.iter().filter(|p| p.0 != 0.0) {
            for (g, b) in other.points.iter().filter(|p| p.0 != 0.0) {
                sum += f * g * metric.between(*a, *b);
            }
        }
        sum
    }
}
