//! Rows of the program: `a u <= bound`.

use super::combination::Combination;
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
    /// A row of [`super::QpSolver::keep_clear`], by its index.
    Given(u32),
}

/// Nodes of a row at most: four around each of its four points.
pub(super) const MOST_NODES: usize = 16;

/// A row over nodes: those around a ground sample and around the candidate, or around two points of a river.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) nodes: [u32; MOST_NODES],
    pub(super) weights: [f64; MOST_NODES],
    pub(super) len: usize,
    pub(super) bound: f64,
    pub(super) constraint: Constraint,
    /// The row as bilinear values at points, with their factors: two for the ground sample, two for the point that must be seen.
    pub(super) points: [(f64, Between); 4],
}

impl Row {
    /// * `at`: the node.
    pub(super) fn ceiling(node: u32, at: Between, bound: f64) -> Self {
        let (mut nodes, mut weights) = ([0; MOST_NODES], [0.0; MOST_NODES]);
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

    /// The row that keeps the ground at a position under a line of sight: the combination there minus `rest` times that of the point.
    pub(super) fn sight(
        (ground, point): (&Combination, &Combination),
        rest: f64,
        bound: f64,
        constraint: Constraint,
    ) -> Self {
        let (mut nodes, mut weights, mut len) = ([0; MOST_NODES], [0.0; MOST_NODES], 0);
        for (combination, factor) in [(ground, 1.0), (point, -rest)] {
            for (node, w) in combination.entries() {
                (nodes[len], weights[len]) = (node, factor * w);
                len += 1;
            }
        }
        let [a, b] = [ground.terms, point.terms];
        let points = [a[0], a[1], (-rest * b[0].0, b[0].1), (-rest * b[1].0, b[1].1)];
        Self { nodes, weights, len, bound, constraint, points }
    }

    /// Whether it must be met at any price, without slack.
    pub(super) fn is_firm(&self) -> bool {
        matches!(self.constraint, Constraint::Ceiling(_) | Constraint::River(_))
    }

    /// Nodes in groups of those around one point.
    pub(super) fn groups(&self) -> impl Iterator<Item = &[u32]> {
        let first = if self.len > 4 { 4 } else { 1 };
        let (first, rest) = self.nodes[..self.len].split_at(first);
        std::iter::once(first).chain(rest.chunks(4))
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
