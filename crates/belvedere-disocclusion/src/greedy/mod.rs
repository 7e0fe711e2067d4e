//! The greedy pass: cell by cell, far to near, the ground is scaled and displaced until every point is seen.

mod blocks;
mod ceilings;
mod equations;
mod gather;
mod hits;
mod pieces;
mod queue;
#[cfg(test)]
mod reference;
mod scan;
#[cfg(test)]
mod tests;
mod trace;
mod under;
mod view;

use super::{Cells, Field, NO_CELL, ReferencePoint, TerrainSettings};
use belvedere_core::{DVec2, DVec3};
use rayon::prelude::*;

pub use blocks::Blocks;
pub use equations::{Affine, Price, blended, scale_to_clear, shift_to_clear};
pub use pieces::Pieces;
pub use view::{EyeError, LeftOut, Wedge, check_eye, in_view};

/// Lines of sight clear the ground by this share of the relief, less near their points.
const CLEARANCE: f64 = 1e-3;
/// Part of the line of sight in which the clearance grows from nothing.
const CLEARANCE_GROWS: f64 = 0.05;
/// How often all of a cell may be changed although that lowers points farther away that were finished.
const BACKWARD: u32 = 1;
/// A point's own cell is changed from here on, cells; what hides it farther away is treated as a point of its own.
const NEAR: f64 = 2.0;

/// What the greedy pass did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct GreedyCounters {
    /// Lines of sight followed, parts of them included.
    pub traces: usize,
    /// Transforms: `regular` + `backfacing`.
    pub hits: usize,
    /// Transforms of another cell than the point's.
    pub regular: usize,
    /// Transforms of the nearer part of the point's own cell.
    pub backfacing: usize,
    /// Parts of lines of sight that were put back to be followed later.
    pub aux: usize,
    /// Transforms that lowered finished points farther away.
    pub backward: usize,
    /// Rings of cells divided.
    pub splits: usize,
    /// Cells that are not as they were.
    pub cells_changed: usize,
    /// Points that this pass could not make visible.
    pub unresolved: usize,
}

/// The ground after the greedy pass: one affine transform per cell and ring around the eye.
#[derive(Debug, Clone, PartialEq)]
pub struct Naive {
    eye: DVec2,
    pieces: Vec<Pieces>,
    unresolved: Vec<usize>,
    counters: GreedyCounters,
}

impl Naive {
    /// Runs the pass, in the plane of [`Field`] (straight lines of sight).
    ///
    /// * `cells`, `blocks`: of `field`;
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
        blocks: &Blocks,
        settings: &TerrainSettings,
        eye: DVec3,
        points: &[ReferencePoint],
    ) -> Self {
        let mut pass = queue::Pass::new(field, cells, blocks, settings, eye, points);
        pass.run(&trace::Skipping { blocks });
        pass.finish()
    }

    /// Counts of what happened.
    pub fn counters(&self) -> &GreedyCounters {
        &self.counters
    }

    /// Indices of the points that this pass could not make visible, ascending.
    pub fn unresolved(&self) -> &[usize] {
        &self.unresolved
    }

    /// What is done to a cell.
    pub fn pieces(&self, cell: usize) -> &Pieces {
        &self.pieces[cell]
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
        self.pieces[trace::cell_at(field, cells, point.grid)].at(rho).of(h) - h
    }

    fn at_nodes(&self, field: &Field, cells: &Cells, void: f64, of: impl Fn(Affine, f64) -> f64 + Sync) -> Vec<f64> {
        let (cols, spacing, datum) = (field.cols(), field.spacing(), field.datum());
        let unchanged: Vec<bool> = self.pieces.iter().map(|p| !p.changed()).collect();
        let mut out = vec![void; field.heights().len()];
        out.par_chunks_mut(cols).enumerate().with_min_len(32).for_each(|(row, out)| {
            for (col, out) in out.iter_mut().enumerate() {
                let i = row * cols + col;
                let cell = cells.labels()[i];
                if cell == NO_CELL || unchanged[cell as usize] {
                    continue;
                }
                let rho = ((DVec2::new(col as f64, row as f64) - self.eye) * spacing).length();
                *out = of(self.pieces[cell as usize].at(rho), field.heights()[i] - datum);
            }
        });
        out
    }
}
