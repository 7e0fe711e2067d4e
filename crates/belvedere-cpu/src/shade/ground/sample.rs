//! Position of a sample on any drawn triangle of ground.

use crate::geometry::block::{Block, DrawnTriangle};
use crate::geometry::grid::CELL_TRIANGLES;
use crate::raster::cells::SIDE;
use crate::screen::{SUB, Screen};
use crate::shade::SurfacePoint;
use belvedere_core::DVec2;

/// A triangle of ground around a sample.
pub(crate) struct GroundSample {
    /// Vertices relative to the sample, fixed-point steps.
    x: [f64; 3],
    y: [f64; 3],
    /// Their nearness (1 in parallel projection), and their columns and rows from the node of the cell.
    q: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    /// Column and row of the sample from that node.
    pub(crate) at: [f64; 2],
}

impl GroundSample {
    pub(crate) fn new(found: &DrawnTriangle<'_>, screen: &Screen, sample: [i32; 2]) -> Self {
        let step = found.block.step as f64;
        let nodes = CELL_TRIANGLES[(found.parent & 1) as usize].map(|n| [(n & 1) as f64, (n >> 1) as f64]);
        let along = |[a, b]: [f64; 2], d: usize| {
            step * (nodes[0][d] + a * (nodes[1][d] - nodes[0][d]) + b * (nodes[2][d] - nodes[0][d]))
        };
        let weights = found.v.map(|v| v.weights.map(f64::from));
        let [_, a, b] = SurfacePoint::new(found, screen, sample).weights;
        Self {
            x: found.v.map(|v| f64::from(v.screen.x - sample[0])),
            y: found.v.map(|v| f64::from(v.screen.y - sample[1])),
            q: found.v.map(|v| if screen.ortho { 1.0 } else { f64::from(v.screen.q) }),
            u: weights.map(|w| along(w, 0)),
            v: weights.map(|w| along(w, 1)),
            at: [along([a, b], 0), along([a, b], 1)],
        }
    }

    /// The node of the ground that columns and rows count from.
    pub(crate) fn node(found: &DrawnTriangle<'_>) -> [i32; 2] {
        let Block { origin, step, .. } = *found.block;
        let cell = (found.parent >> 1) as usize;
        [(origin[0] + step * (cell % SIDE)) as i32, (origin[1] + step * (cell / SIDE)) as i32]
    }

    /// Cells that a pixel of the triangle covers, without the perspective inside the triangle.
    pub(crate) fn cells_per_px(&self) -> f64 {
        let area = |x: &[f64; 3], y: &[f64; 3]| (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        (area(&self.u, &self.v) / area(&self.x, &self.y)).abs() * f64::from(SUB * SUB)
    }

    /// Columns and rows per pixel to the right and per pixel down.
    pub(crate) fn axes(&self) -> [DVec2; 2] {
        let Self { x, y, q, u, v, at } = self;
        let next = |k: usize| ((k + 1) % 3, (k + 2) % 3);
        // Weight of vertex k, and its change as the sample moves.
        let sum = |of: &dyn Fn(usize) -> f64| -> [f64; 3] {
            let mut sums = [0.0; 3];
            for k in 0..3 {
                let w = of(k) * q[k];
                sums.iter_mut().zip([w, w * u[k], w * v[k]]).for_each(|(s, v)| *s += v);
            }
            sums
        };
        let whole = sum(&|k| x[next(k).0] * y[next(k).1] - x[next(k).1] * y[next(k).0])[0];
        let right = sum(&|k| y[next(k).0] - y[next(k).1]);
        let down = sum(&|k| x[next(k).1] - x[next(k).0]);
        [right, down].map(|[w, wu, wv]| DVec2::new(wu - at[0] * w, wv - at[1] * w) * (f64::from(SUB) / whole))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns and rows as the sample moves, by differences of the interpolation in perspective.
    #[test]
    fn axes_are_how_columns_and_rows_change_as_the_sample_moves() {
        let (x, y) = ([-310.0, 520.0, 40.0], [-180.0, -90.0, 610.0]);
        let (u, v) = ([3.0, 4.0, 3.0], [1.0, 1.0, 2.0]);
        for q in [[1.0; 3], [0.9, 0.5, 0.2], [1e-3, 4e-3, 2e-3]] {
            let at = |moved: [f64; 2]| {
                let (x, y) = (x.map(|x| x - moved[0]), y.map(|y| y - moved[1]));
                let weight = |k: usize| {
                    let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                    q[k] * (x[a] * y[b] - x[b] * y[a])
                };
                let weights = [0, 1, 2].map(weight);
                let mean = |of: [f64; 3]| (0..3).map(|k| weights[k] * of[k]).sum::<f64>() / weights.iter().sum::<f64>();
                DVec2::new(mean(u), mean(v))
            };
            let sample = GroundSample { x, y, q, u, v, at: at([0.0; 2]).to_array() };
            let step = 0.25;
            let want =
                [[step, 0.0], [0.0, step]].map(|[a, b]| (at([a, b]) - at([-a, -b])) * f64::from(SUB) / (2.0 * step));
            for (found, want) in sample.axes().into_iter().zip(want) {
                assert!((found - want).length() < 1e-5 * want.length(), "{q:?}: {found}, {want}");
            }
        }
    }
}
