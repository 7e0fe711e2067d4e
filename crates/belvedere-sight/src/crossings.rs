//! Crossings of a line of sight with the edges of the ground's triangles.

use crate::{Edge, EdgeFamily, Field, GridLine};
use belvedere_core::DVec2;

/// Lines that come closer to a node than this pass through it, cells.
pub const AT_NODE: f64 = 1e-9;

/// One crossing of the line of sight from a point P to the eye V with an edge of the ground.
///
/// The line of sight's height there is `(1 - tau) z_P + tau z_V`, the ground's
/// `(1 - weight) h[nodes[0]] + weight h[nodes[1]]`, both exact; between crossings (with the diagonals) both are linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SightSample {
    /// Parameter along the line of sight: 0 at the point, 1 at the eye.
    pub tau: f64,
    /// Ends of the edge as indices into the heights; both the same where the line passes through a node.
    pub nodes: [u32; 2],
    /// Share of the second node, 0..1.
    pub weight: f64,
    /// Distance to the eye in plan, scene units.
    pub rho: f64,
}

impl SightSample {
    /// Value of a field given at the nodes.
    pub fn of(&self, values: &[f64]) -> f64 {
        let [a, b] = self.nodes.map(|n| values[n as usize]);
        a + self.weight * (b - a)
    }

    /// Whether both are the same node, met on two lines of the grid.
    fn same_node(&self, other: &Self) -> bool {
        self.weight == 0.0 && other.weight == 0.0 && self.nodes == other.nodes
    }

    /// The end of the edge that is nearer to the crossing.
    pub fn nearest(&self) -> usize {
        self.nodes[usize::from(self.weight > 0.5)] as usize
    }
}

/// Parameter of the line of sight, 0..=1, up to which the ground lies within the guard and does not count as an occluder.
///
/// * `from`, `eye`: grid coordinates; `guard`: cells.
pub fn guard_tau(from: DVec2, eye: DVec2, guard: f64) -> f64 {
    let length = (eye - from).length();
    if length > guard { guard / length } else { 1.0 }
}

/// Crossings of the line of sight with the lines x = int and y = int, from the point to the eye, each once.
///
/// * `from`, `eye`: grid coordinates; either may lie beside the grid, where nothing is crossed;
/// * `diagonals`: also with the cells' north-west to south-east diagonals, where the drawn surface has its kinks.
///
/// Where an end of an edge is void there is no ground and no sample. A point under the eye has no samples.
pub fn sight_samples(field: &Field, from: DVec2, eye: DVec2, diagonals: bool) -> Vec<SightSample> {
    let families = if diagonals { &EdgeFamily::ALL[..] } else { &EdgeFamily::ALL[..2] };
    SightLine::new(field, from, eye).map_or_else(Vec::new, |line| line.samples(&[line.span], families))
}

/// A line of sight over the grid, in plan, from the point to the eye.
pub struct SightLine<'a> {
    field: &'a Field,
    line: GridLine,
    plan_m: f64,
    span: [f64; 2],
}

impl<'a> SightLine<'a> {
    /// `None` if the line does not meet the grid.
    pub fn new(field: &'a Field, from: DVec2, eye: DVec2) -> Option<Self> {
        let line = GridLine::between(from, eye);
        let span = line.over(field.nodes(), 0.0)?;
        Some(Self { field, line, plan_m: (line.dir * field.spacing()).length(), span })
    }

    /// The part of the line over the grid.
    pub fn span(&self) -> [f64; 2] {
        self.span
    }

    /// Where the line of sight starts, cells.
    pub fn from(&self) -> DVec2 {
        self.line.start
    }

    /// From the point to the eye, cells.
    pub fn dir(&self) -> DVec2 {
        self.line.dir
    }

    /// Crossings of parts of the line (ranges of the parameter, in order) with families of edges, each once.
    pub fn samples(&self, parts: &[[f64; 2]], families: &[EdgeFamily]) -> Vec<SightSample> {
        let (nodes, mut out) = (self.field.nodes(), Vec::new());
        for (&part, &family) in parts.iter().flat_map(|part| families.iter().map(move |family| (part, family))) {
            self.line.crossings(nodes, family, part, AT_NODE, |tau, _, edge| out.extend(self.sample(tau, edge)));
        }
        out.sort_by(|a, b| a.tau.total_cmp(&b.tau));
        out.dedup_by(|next, sample| sample.same_node(next));
        out
    }

    #[inline]
    fn sample(&self, tau: f64, Edge { first, second, weight }: Edge) -> Option<SightSample> {
        if !(tau > 0.0 && tau < 1.0) {
            return None;
        }
        let (nodes, weight) = match weight {
            w if w <= AT_NODE => ([first; 2], 0.0),
            w if w >= 1.0 - AT_NODE => ([second; 2], 0.0),
            w => ([first, second], w),
        };
        let solid = nodes.iter().all(|&n| !self.field.void()[n]);
        let nodes = nodes.map(|n| n as u32);
        solid.then_some(SightSample { tau, nodes, weight, rho: (1.0 - tau) * self.plan_m })
    }
}

#[cfg(test)]
mod tests;
