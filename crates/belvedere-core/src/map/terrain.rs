//! Terrain disocclusion as a displacement: the ground moves vertically.

use super::{Miss, SpaceMap, finite};
use crate::Aabb;
use crate::grid::Grid;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// `X' = X + delta(x, y) z_up`: every point of a vertical line moves by the same height, so what stands on the ground stays on it.
///
/// `delta` is bilinear between the nodes of a grid and zero outside it; a grid whose rim is not zero makes a step there.
/// Source: Deng et al. 2013, the displacement form of their hierarchical deformation.
///
/// ```
/// use belvedere_core::{DVec2, DVec3, SpaceMap, TerrainDisocclusion, grid::Grid};
/// let delta = Grid::new(DVec2::new(0.0, 100.0), DVec2::splat(100.0), 2, 2, vec![0.0, -10.0, 0.0, -10.0])?;
/// let ground = TerrainDisocclusion::new(delta);
/// assert_eq!(ground.apply(DVec3::new(50.0, 50.0, 700.0)).unwrap(), DVec3::new(50.0, 50.0, 695.0));
/// # Ok::<(), belvedere_core::grid::GridError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TerrainDisocclusion {
    delta: Arc<Grid>,
}

impl TerrainDisocclusion {
    /// Displacement by `delta`, scene units, positive upwards. Clones share the grid.
    pub fn new(delta: impl Into<Arc<Grid>>) -> Self {
        Self { delta: delta.into() }
    }

    /// The displacement grid, scene units.
    pub fn grid(&self) -> &Grid {
        &self.delta
    }

    /// These displacements times `share`.
    pub(crate) fn eased(&self, share: f64) -> Option<Self> {
        let delta = &*self.delta;
        let values = delta.values().iter().map(|value| share * value).collect();
        Grid::new(delta.north_west(), delta.spacing(), delta.cols(), delta.rows(), values).ok().map(Self::new)
    }

    /// Displacement at a scene position, scene units; 0 outside the grid.
    pub fn delta_at(&self, p: DVec3) -> f64 {
        self.delta.sample(p.truncate()).unwrap_or(0.0)
    }

    /// Vertical distance between the displaced edge and its chord, see [`crate::map::StageMap::edge_bound`]; tight to within a factor of 2.
    pub fn edge_bound(&self, p0: DVec3, p1: DVec3) -> f64 {
        if !(p0.is_finite() && p1.is_finite()) {
            return f64::INFINITY;
        }
        let (g0, g1) = (self.delta.grid_from_scene(p0.truncate()), self.delta.grid_from_scene(p1.truncate()));
        let step = g1 - g0;
        let ends = [p0, p1].map(|p| self.delta_at(p));
        let chord = |t: f64| (1.0 - t) * ends[0] + t * ends[1];
        let mut worst = 0.0f64;
        let mut from = 0.0;
        let mut crossings = [Crossings::new(g0.x, step.x), Crossings::new(g0.y, step.y)];
        let [last_col, last_row] = [self.delta.cols() - 1, self.delta.rows() - 1].map(|n| n as f64);
        crossings[0].limit(last_col);
        crossings[1].limit(last_row);
        while from < 1.0 {
            let [tx, ty] = crossings.each_ref().map(Crossings::next);
            let to = tx.min(ty).clamp(from, 1.0);
            for (t, c) in [tx, ty].into_iter().zip(&mut crossings) {
                if t <= to {
                    c.advance();
                }
            }
            let cell = self.delta.cell(g0 + 0.5 * (from + to) * step);
            let at = |t: f64| cell.map_or(0.0, |c| c.at(g0 + t * step));
            let sag = cell.map_or(0.0, |c| (c.c[3] * step.x * step.y).abs() * (to - from).powi(2) / 4.0);
            worst = worst.max((at(from) - chord(from)).abs().max((at(to) - chord(to)).abs()) + sag);
            from = to;
        }
        worst
    }

    /// See [`crate::map::StageMap::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        if bounds.is_empty() || bounds.min.is_nan() || bounds.max.is_nan() {
            return None;
        }
        let (min, max) = (bounds.min.truncate(), bounds.max.truncate());
        let inside = [min, max].into_iter().all(|xy| self.delta.contains(self.delta.grid_from_scene(xy)));
        let [mut lo, mut hi] = self.delta.range_over(min, max).unwrap_or([0.0; 2]);
        if !inside {
            (lo, hi) = (lo.min(0.0), hi.max(0.0));
        }
        let mut out = *bounds;
        out.min.z += lo;
        out.max.z += hi;
        Some(out)
    }
}

/// Parameters at which an edge crosses the grid lines of one direction, ascending.
struct Crossings {
    start: f64,
    step: f64,
    line: f64,
    last: f64,
}

impl Crossings {
    fn new(start: f64, step: f64) -> Self {
        let line = if step > 0.0 { start.floor() + 1.0 } else { start.ceil() - 1.0 };
        Self { start, step, line, last: 0.0 }
    }

    /// Limits the crossings to the grid lines 0..=last.
    fn limit(&mut self, last: f64) {
        self.last = last;
        self.line = if self.step > 0.0 { self.line.max(0.0) } else { self.line.min(last) };
    }

    fn next(&self) -> f64 {
        if self.step == 0.0 || self.line < 0.0 || self.line > self.last {
            return f64::INFINITY;
        }
        (self.line - self.start) / self.step
    }

    fn advance(&mut self) {
        self.line += self.step.signum();
    }
}

impl SpaceMap for TerrainDisocclusion {
    fn apply(&self, p: DVec3) -> Result<DVec3, Miss> {
        let p = finite(p)?;
        finite(p + self.delta_at(p) * DVec3::Z)
    }

    fn invert(&self, p_displaced: DVec3) -> Result<DVec3, Miss> {
        let p = finite(p_displaced)?;
        finite(p - self.delta_at(p) * DVec3::Z)
    }

    /// On a grid line the derivative of the cell to its east or south; on the last line that of the last cell.
    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let g = self.delta.grid_from_scene(finite(p)?.truncate());
        let slope = self.delta.cell(g).map_or(glam::DVec2::ZERO, |cell| cell.gradient(g)) / self.delta.spacing();
        // Rows run towards south.
        Ok(DMat3::from_cols(DVec3::new(1.0, 0.0, slope.x), DVec3::new(0.0, 1.0, -slope.y), DVec3::Z))
    }
}
