//! The naive terrain: the ground after the greedy pass.

use super::super::{Cells, Field, NO_CELL, ReferencePoint, TerrainSettings};
use super::blocks::BlockMaxima;
use super::equations::Affine;
use super::pass::{self, GreedyCounters, Outcome};
use super::transform::CellTransform;
use belvedere_core::{DVec2, DVec3};
use rayon::prelude::*;

/// The ground after the greedy pass: one affine transform per cell and ring around the eye.
#[derive(Debug, Clone, PartialEq)]
pub struct Naive {
    eye: DVec2,
    transforms: Vec<CellTransform>,
    unresolved: Vec<usize>,
    counters: GreedyCounters,
}

impl Naive {
    /// Runs the pass, in the plane of [`Field`] (straight lines of sight).
    ///
    /// * `cells`, `blocks`: of `field`; without blocks every crossing of every line is tested, with the same result;
    /// * `eye`: scene coordinates, see [`check_eye`];
    /// * `points`: those in view, see [`in_view`].
    ///
    /// Deterministic, one thread. Between two backward events every point is followed at most once in full, so there are at
    /// most (1 + cells) x points full traces.
    ///
    /// Source: Deng et al. 2013, section on the naive deformation; order, split and repairs: ours.
    pub fn new(
        field: &Field,
        cells: &Cells,
        blocks: Option<&BlockMaxima>,
        settings: &TerrainSettings,
        eye: DVec3,
        points: &[ReferencePoint],
    ) -> Self {
        let Outcome { transforms, unresolved, counters } = pass::run(field, cells, blocks, settings, eye, points);
        Self { eye: field.grid_from_scene(eye.truncate()), transforms, unresolved, counters }
    }

    /// Counts of what happened.
    pub fn counters(&self) -> &GreedyCounters {
        &self.counters
    }

    /// Indices of the points that this pass could not make visible, ascending.
    pub fn unresolved(&self) -> &[usize] {
        &self.unresolved
    }

    /// Displacement of every node, scene units, row-major; 0 at voids.
    pub fn displacement(&self, field: &Field, cells: &Cells) -> Vec<f64> {
        self.at_nodes(field, cells, 0.0, |a, h| a.of(h) - h)
    }

    /// Scale of every node, row-major; 1 at voids.
    pub fn scale(&self, field: &Field, cells: &Cells) -> Vec<f64> {
        self.at_nodes(field, cells, 1.0, |a, _| a.scale)
    }

    /// Displacement at a reference point, that of the nearest node's cell, scene units.
    pub fn displacement_at(&self, field: &Field, cells: &Cells, point: &ReferencePoint) -> f64 {
        let h = point.ground - field.datum();
        let rho = ((point.grid - self.eye) * field.spacing()).length();
        self.transforms[cells.cell_at(field, point.grid)].at(rho).of(h) - h
    }

    fn at_nodes(&self, field: &Field, cells: &Cells, void: f64, of: impl Fn(Affine, f64) -> f64 + Sync) -> Vec<f64> {
        let (cols, spacing, datum) = (field.cols(), field.spacing(), field.datum());
        let unchanged: Vec<bool> = self.transforms.iter().map(|t| !t.changed()).collect();
        let mut out = vec![void; field.heights().len()];
        out.par_chunks_mut(cols).enumerate().with_min_len(32).for_each(|(row, out)| {
            for (col, out) in out.iter_mut().enumerate() {
                let i = row * cols + col;
                let cell = cells.labels()[i];
                if cell == NO_CELL || unchanged[cell as usize] {
                    continue;
                }
                let rho = ((DVec2::new(col as f64, row as f64) - self.eye) * spacing).length();
                *out = of(self.transforms[cell as usize].at(rho), field.heights()[i] - datum);
            }
        });
        out
    }
}
