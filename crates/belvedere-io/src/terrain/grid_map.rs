//! Positions of the nodes of one grid in another.

use super::source::SourceGrid;
use crate::crs::{CoordinateSystem, Transform};
use crate::{Affine, IoError};
use glam::DVec2;
use rayon::prelude::*;
use std::path::Path;

/// An axis-aligned grid without its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Geometry {
    /// Scene position of node (0, 0).
    pub(crate) north_west: DVec2,
    /// Towards east and south, > 0.
    pub(crate) spacing: DVec2,
}

impl Geometry {
    pub(crate) fn scene_from_index(&self, index: DVec2) -> DVec2 {
        DVec2::new(self.north_west.x + index.x * self.spacing.x, self.north_west.y - index.y * self.spacing.y)
    }

    pub(crate) fn index_from_scene(&self, p: DVec2) -> DVec2 {
        DVec2::new((p.x - self.north_west.x) / self.spacing.x, (self.north_west.y - p.y) / self.spacing.y)
    }
}

/// Transform between the node indices of a source and scene coordinates.
pub(crate) struct Link {
    model_from_index: Affine,
    index_from_model: Affine,
    /// From the source's system to the scene's; `None` if they are the same (or the scene is local).
    transform: Option<Transform>,
    /// Middle longitude of a geographic source: longitudes are unwrapped around it.
    middle_lon: Option<f64>,
    /// Scene units per model unit if there is no transform.
    scale: f64,
}

impl Link {
    pub(crate) fn new(source: &SourceGrid, target: Option<&CoordinateSystem>, path: &Path) -> Result<Self, IoError> {
        Self::of(source.model_from_index, source.system.as_ref(), [source.cols, source.rows], target, path)
    }

    pub(crate) fn of(
        model_from_index: Affine,
        system: Option<&CoordinateSystem>,
        size: [usize; 2],
        target: Option<&CoordinateSystem>,
        path: &Path,
    ) -> Result<Self, IoError> {
        let bad = |reason: String| IoError::format(path, reason);
        let index_from_model = model_from_index
            .inverse()
            .ok_or_else(|| bad("its georeference is singular (no area); correct it or remove it".into()))?;
        let transform = match (system, target) {
            (Some(from), Some(to)) if from != to => Some(Transform::new(from, to).map_err(|e| bad(e.to_string()))?),
            _ => None,
        };
        let geographic = transform.is_some() && system.is_some_and(CoordinateSystem::is_geographic);
        let middle = model_from_index.apply(0.5 * (size[0] as f64 - 1.0), 0.5 * (size[1] as f64 - 1.0));
        let scale = match target {
            None => system.and_then(CoordinateSystem::metres_per_unit).unwrap_or(1.0),
            Some(_) => 1.0,
        };
        Ok(Self { model_from_index, index_from_model, transform, middle_lon: geographic.then_some(middle[0]), scale })
    }

    /// Scene position of a (fractional) node.
    pub(crate) fn scene_from_index(&self, index: DVec2) -> Option<DVec2> {
        let model = DVec2::from(self.model_from_index.apply(index.x, index.y));
        match &self.transform {
            Some(t) => t.forward_one(model),
            None => Some(model * self.scale).filter(|p| p.is_finite()),
        }
    }

    /// Fractional node of a scene position.
    pub(crate) fn index_from_scene(&self, p: DVec2) -> Option<DVec2> {
        let mut model = match &self.transform {
            Some(t) => t.inverse_one(p)?,
            None => p / self.scale,
        };
        if let Some(middle) = self.middle_lon {
            model.x += 360.0 * ((middle - model.x) / 360.0).round();
        }
        let index = DVec2::from(self.index_from_model.apply(model.x, model.y));
        index.is_finite().then_some(index)
    }

    /// Its nodes in the scene if they are an axis-aligned lattice there without a change of system, columns to the east and rows to the south.
    pub(crate) fn lattice(&self, size: [usize; 2]) -> Option<Geometry> {
        if self.transform.is_some() {
            return None;
        }
        let [across, down] = size.map(|n| (n - 1) as f64);
        let first = self.scene_from_index(DVec2::ZERO)?;
        let along = self.scene_from_index(DVec2::new(across, 0.0))? - first;
        let below = first - self.scene_from_index(DVec2::new(0.0, down))?;
        let spacing = DVec2::new(along.x / across, below.y / down);
        let skew = along.y.abs().max(below.x.abs());
        let aligned = spacing.min_element() > 0.0 && skew <= 1e-6 * spacing.min_element();
        aligned.then_some(Geometry { north_west: first, spacing })
    }

    /// Lengths of one step along columns and rows in the scene, at the middle of the grid; (1, 1) if that has no image.
    pub(crate) fn spacing_at_centre(&self, source: &SourceGrid) -> DVec2 {
        let middle = 0.5 * DVec2::new(source.cols as f64 - 1.0, source.rows as f64 - 1.0);
        match self.jacobian(middle) {
            Some([dc, dr]) => DVec2::new(dc.length(), dr.length()),
            None => DVec2::ONE,
        }
    }

    /// Spacing of an axis-aligned grid in the scene as dense as the source, from the first of a few positions that have an
    /// image.
    pub(crate) fn spacing_near(&self, size: [usize; 2]) -> Option<DVec2> {
        let size = DVec2::new((size[0] - 1) as f64, (size[1] - 1) as f64);
        [(0.5, 0.5), (0.5, 0.25), (0.5, 0.75), (0.25, 0.5), (0.75, 0.5)].into_iter().find_map(|share| {
            let [dc, dr] = self.jacobian(DVec2::from(share) * size)?;
            let det = dc.perp_dot(dr).abs();
            // cells crossed per metre along x and along y, from the inverse of the jacobian
            let spacing = DVec2::new(det / dr.y.hypot(dc.y), det / dr.x.hypot(dc.x));
            (spacing.is_finite() && spacing.min_element() > 0.0).then_some(spacing)
        })
    }

    /// Scene vectors of one step along columns and along rows.
    pub(crate) fn jacobian(&self, index: DVec2) -> Option<[DVec2; 2]> {
        let at = |dx: f64, dy: f64| self.scene_from_index(index + DVec2::new(dx, dy));
        let (h, w) = (0.5, 1.0);
        Some([(at(h, 0.0)? - at(-h, 0.0)?) / w, (at(0.0, h)? - at(0.0, -h)?) / w])
    }
}

/// Step of the coarsest lattice, nodes.
const COARSEST: usize = 32;
/// Positions along each side where the lattice is checked.
const CHECKS: usize = 9;

/// Image of every node of one grid in another, from a coarse lattice of exact images interpolated linearly. The lattice
/// is as fine as the tolerance demands (ours; GDAL's approximating transformer has the same purpose).
pub(crate) struct GridMap<'a> {
    step: usize,
    lattice_cols: usize,
    lattice: Vec<Option<DVec2>>,
    /// Length of one step in the target, roughly.
    unit: f64,
    exact: &'a (dyn Fn(DVec2) -> Option<DVec2> + Sync),
}

impl<'a> GridMap<'a> {
    /// Map of a grid of `cols` x `rows` nodes; the interpolated images are within `tolerance` of the exact ones, which
    /// should be about a thousandth of a step in the target.
    pub(crate) fn new(
        cols: usize,
        rows: usize,
        tolerance: f64,
        exact: &'a (dyn Fn(DVec2) -> Option<DVec2> + Sync),
    ) -> Self {
        let mut step = COARSEST;
        while step > 1 && !good_enough(cols, rows, step, tolerance, exact) {
            step /= 2;
        }
        let lattice_cols = (cols - 1).div_ceil(step) + 1;
        let lattice_rows = (rows - 1).div_ceil(step) + 1;
        let image = |i: usize| {
            let (c, r) = (i % lattice_cols * step, i / lattice_cols * step);
            exact(DVec2::new(c as f64, r as f64))
        };
        let lattice = (0..lattice_cols * lattice_rows).into_par_iter().with_min_len(256).map(image).collect();
        Self { step, lattice_cols, lattice, unit: 1000.0 * tolerance, exact }
    }

    /// Images of all nodes of a row; NaN for nodes without image.
    pub(crate) fn row(&self, row: usize, out: &mut [DVec2]) {
        let (j, v) = (row / self.step, (row % self.step) as f64 / self.step as f64);
        let below = if v == 0.0 { 0 } else { self.lattice_cols };
        let start = j * self.lattice_cols;
        for (i, part) in out.chunks_mut(self.step).enumerate() {
            let right = usize::from(part.len() > 1);
            let k = start + i;
            let corners = [k, k + right, k + below, k + below + right].map(|k| self.lattice.get(k).copied().flatten());
            // where the map jumps (at the antimeridian of a projection) the corners are not neighbours
            if let [Some(a), Some(b), Some(c), Some(d)] = corners
                && regular([a, b, c, d], self.step as f64 * self.unit)
            {
                let (left, end) = (a + (c - a) * v, b + (d - b) * v);
                let delta = (end - left) / self.step as f64;
                for (n, p) in part.iter_mut().enumerate() {
                    *p = left + delta * n as f64;
                }
            } else {
                for (n, p) in part.iter_mut().enumerate() {
                    let index = DVec2::new((i * self.step + n) as f64, row as f64);
                    *p = (self.exact)(index).unwrap_or(DVec2::NAN);
                }
            }
        }
    }
}

/// Whether the images of a cell's corners belong together: nearly a parallelogram and not many times larger than the
/// cell, `size` in the target. They do not where a projection jumps, at its antimeridian.
fn regular([a, b, c, d]: [DVec2; 4], size: f64) -> bool {
    let longest = [b - a, c - a, d - b, d - c].iter().map(|v| v.length()).fold(0.0, f64::max);
    (a + d - b - c).length() <= 0.25 * size && longest <= 16.0 * size
}

/// Whether cells of `step` nodes are linear enough, at their middles and at the middles of their sides.
fn good_enough(
    cols: usize,
    rows: usize,
    step: usize,
    tolerance: f64,
    exact: &(dyn Fn(DVec2) -> Option<DVec2> + Sync),
) -> bool {
    let size = step as f64;
    let cells = |n: usize| (n - 1).div_ceil(step).max(1);
    let checked = |n: usize| -> Vec<usize> {
        let cells = cells(n);
        let count = cells.min(CHECKS);
        (0..count).map(|k| if count == 1 { 0 } else { k * (cells - 1) / (count - 1) }).collect()
    };
    let columns = checked(cols);
    checked(rows).iter().all(|j| {
        columns.iter().all(|i| {
            let corner = DVec2::new((i * step) as f64, (j * step) as f64);
            let at = |u: f64, v: f64| exact(corner + size * DVec2::new(u, v));
            let (Some(a), Some(b), Some(c), Some(d)) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)) else {
                return true; // such cells are computed exactly
            };
            if !regular([a, b, c, d], size * 1000.0 * tolerance) {
                return true; // and such ones
            }
            let near = |u: f64, v: f64, guess: DVec2| at(u, v).is_none_or(|p| (p - guess).length() <= 0.5 * tolerance);
            near(0.5, 0.0, 0.5 * (a + b)) && near(0.0, 0.5, 0.5 * (a + c)) && near(0.5, 0.5, 0.25 * (a + b + c + d))
        })
    })
}

#[cfg(test)]
mod tests;
