//! Elevation rows W: the displacement at fixed points is drawn towards that of the naive terrain.

use belvedere_core::DVec2;

use super::hierarchy::Hierarchy;

/// Rows of W, `weight * (bilinear row of B)` at fixed points of the map: reference points of all features and kept
/// summits. They do not depend on the view; a frame changes only their target heights (equation (14)).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElevationRows {
    nodes: Vec<[u32; 4]>,
    factors: Vec<[f64; 4]>,
    weight: f64,
}

impl ElevationRows {
    /// * `points`: fine grid coordinates; points that are not finite are left out.
    /// * `weight`: weight of a row on this grid, >= 0 (see [`row_weight`]).
    pub fn new(hierarchy: &Hierarchy, points: impl IntoIterator<Item = DVec2>, weight: f64) -> Self {
        let rows = points.into_iter().filter(|p| p.is_finite()).map(|p| {
            let (nodes, factors) = hierarchy.weights(p);
            (nodes, factors.map(|f| f * weight))
        });
        let (nodes, factors) = rows.unzip();
        Self { nodes, factors, weight }
    }

    /// Rows.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// No rows.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Coarse nodes and factors of a row.
    pub fn row(&self, i: usize) -> ([u32; 4], [f64; 4]) {
        (self.nodes[i], self.factors[i])
    }

    /// `out += W^T W x`.
    pub fn add_normal(&self, x: &[f64], out: &mut [f64]) {
        for (nodes, factors) in self.nodes.iter().zip(&self.factors) {
            let value: f64 = nodes.iter().zip(factors).map(|(n, f)| x[*n as usize] * f).sum();
            nodes.iter().zip(factors).for_each(|(n, f)| out[*n as usize] += value * f);
        }
    }

    /// `out += W^T h`, `h(i)` = target displacement at point i, times the weight of its row.
    pub fn add_wanted(&self, h: impl Fn(usize) -> f64, out: &mut [f64]) {
        for (i, (nodes, factors)) in self.nodes.iter().zip(&self.factors).enumerate() {
            let value = self.weight * h(i);
            nodes.iter().zip(factors).for_each(|(n, f)| out[*n as usize] += value * f);
        }
    }
}

/// Weight of an elevation row on a grid of `intervals` intervals along its longer side, from the weight stated for 128 intervals: it
/// is proportional to the spacing (that of [`super::grid_weight`] to its square).
pub fn row_weight(weight: f64, intervals: f64) -> f64 {
    weight * 128.0 / intervals
}
