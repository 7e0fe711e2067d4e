//! Terrain disocclusion as a displacement: the ground moves vertically.

use super::{Miss, SpaceMap, finite};
use crate::Aabb;
use crate::grid::{Grid, Nodes};
use glam::{DMat3, DVec2, DVec3};
use std::sync::Arc;

/// `X' = X + delta(x, y) z_up`: every point of a vertical line moves by the same height, so what stands on the ground stays on it.
///
/// `delta` is zero outside its grid; a grid whose rim is not zero makes a step there. Between nodes it is flat on the triangles of the
/// ground, so that there is one displaced ground, however it is drawn, traced, judged or written; without a ground it is bilinear.
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
        let values = self.delta.values().iter().map(|value| share * value).collect();
        self.delta.with_values(values).ok().map(Self::new)
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
        let step = (p1 - p0).truncate();
        let ends = [p0, p1].map(|p| self.delta_at(p));
        let chord = |t: f64| (1.0 - t) * ends[0] + t * ends[1];
        let (mut worst, mut from) = (0.0f64, 0.0);
        let mut crossings = self.crossings(p0.truncate(), p1.truncate());
        while from < 1.0 {
            let next = crossings.each_ref().map(Crossings::next);
            let to = next.into_iter().fold(1.0, f64::min).max(from);
            for (t, c) in next.into_iter().zip(&mut crossings) {
                if t <= to {
                    c.advance();
                }
            }
            let place = |t: f64| p0.truncate() + t * step;
            let patch = self.delta.patch(place(0.5 * (from + to)));
            let at = |t: f64| patch.map_or(0.0, |p| p.at(place(t)));
            let sag = patch.map_or(0.0, |p| p.bend(step).abs()) * (to - from).powi(2) / 4.0;
            worst = worst.max((at(from) - chord(from)).abs().max((at(to) - chord(to)).abs()) + sag);
            from = to;
        }
        worst
    }

    /// The parameters at which an edge crosses lines of the grid, and lines and diagonals of the ground.
    fn crossings(&self, p0: DVec2, p1: DVec2) -> [Crossings; 5] {
        let of = |nodes: Nodes| {
            let (a, b) = (nodes.grid_from_scene(p0), nodes.grid_from_scene(p1));
            [a, b - a, DVec2::new((nodes.cols - 1) as f64, (nodes.rows - 1) as f64)]
        };
        let [a, step, last] = of(self.delta.nodes());
        let lines = |[a, step, last]: [DVec2; 3]| [0, 1].map(|k| Crossings::new(a[k], step[k], [0.0, last[k]]));
        let [column, row] = lines([a, step, last]);
        let ground = self.delta.facets().map(of);
        let [ground_column, ground_row] = lines(ground.unwrap_or([a, DVec2::ZERO, last]));
        let diagonal = ground.map_or(Crossings::new(0.0, 0.0, [0.0; 2]), |[a, step, last]| {
            Crossings::new(a.x - a.y, step.x - step.y, [-last.y, last.x])
        });
        [column, row, ground_column, ground_row, diagonal]
    }

    /// See [`crate::map::StageMap::displaced_bounds`].
    pub fn displaced_bounds(&self, bounds: &Aabb) -> Option<Aabb> {
        if bounds.is_empty() || bounds.min.is_nan() || bounds.max.is_nan() {
            return None;
        }
        let [lo, hi] = self.delta.span_over(bounds.min.truncate(), bounds.max.truncate());
        let mut out = *bounds;
        out.min.z += lo;
        out.max.z += hi;
        Some(out)
    }
}

/// Parameters at which an edge crosses the lines of one direction, ascending.
struct Crossings {
    start: f64,
    step: f64,
    line: f64,
    range: [f64; 2],
}

impl Crossings {
    /// * `range`: numbers of the first and the last line.
    fn new(start: f64, step: f64, range: [f64; 2]) -> Self {
        let line = if step > 0.0 { (start.floor() + 1.0).max(range[0]) } else { (start.ceil() - 1.0).min(range[1]) };
        Self { start, step, line, range }
    }

    fn next(&self) -> f64 {
        if self.step == 0.0 || self.line < self.range[0] || self.line > self.range[1] {
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

    /// On a line between two cells or triangles the derivative of one of them.
    fn jacobian(&self, p: DVec3) -> Result<DMat3, Miss> {
        let xy = finite(p)?.truncate();
        let slope = self.delta.patch(xy).map_or(DVec2::ZERO, |patch| patch.gradient(xy));
        Ok(DMat3::from_cols(DVec3::new(1.0, 0.0, slope.x), DVec3::new(0.0, 1.0, slope.y), DVec3::Z))
    }
}
