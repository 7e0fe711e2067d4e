//! Search for ground above a line of sight.

use super::super::{Cells, Field, NO_CELL, ReferencePoint};
use super::blocks::BlockMaxima;
use super::transform::CellTransform;
use belvedere_core::DVec2;
use belvedere_sight::{EdgeFamily, SightLine, guard_tau};

/// Lines of sight clear the ground by this share of the relief, less near their points.
pub(super) const CLEARANCE: f64 = 1e-3;
/// Part of the line of sight in which the clearance grows from nothing.
const CLEARANCE_GROWS: f64 = 0.05;

/// A reference point as the greedy pass sees it. Heights are over the datum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Target {
    grid: DVec2,
    /// Height of the untouched ground.
    original: f64,
    lift: f64,
    pub(super) cell: usize,
    /// Distance to the eye in plan, scene units.
    pub(super) rho: f64,
    /// Scene units per cell along its line of sight.
    pub(super) per_cell: f64,
    /// Distance to the eye, at which the ground that counts as the point's own ends, see [`guard_tau`].
    pub(super) own: f64,
}

impl Target {
    /// * `eye`: grid coordinates; `guard`: cells.
    pub(super) fn new(field: &Field, cells: &Cells, point: &ReferencePoint, eye: DVec2, guard: f64) -> Self {
        let length = (eye - point.grid).length();
        let rho = ((eye - point.grid) * field.spacing()).length();
        Self {
            grid: point.grid,
            original: point.ground - field.datum(),
            lift: point.lift,
            cell: cells.cell_at(field, point.grid),
            rho,
            per_cell: if length > 0.0 { rho / length } else { 0.0 },
            own: (1.0 - guard_tau(point.grid, eye, guard)) * rho,
        }
    }
}

/// Ground over a line of sight. Heights are over the datum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Cell of the nearer node.
    pub(super) cell: usize,
    /// Distance to the eye in plan.
    pub(super) rho: f64,
    /// Height that the ground must not exceed here.
    pub(super) limit: f64,
    /// Height of the untouched ground.
    pub(super) original: f64,
    /// Height of the ground.
    pub(super) z: f64,
}

/// Finds the ground over lines of sight.
pub(super) struct Tracer<'a> {
    pub(super) field: &'a Field,
    pub(super) cells: &'a Cells,
    /// `None`: every crossing is tested.
    pub(super) blocks: Option<&'a BlockMaxima>,
    /// Eye in grid coordinates, and its height over the datum.
    pub(super) eye: (DVec2, f64),
    /// Heights that differ by less are equal.
    pub(super) slack: f64,
}

impl Tracer<'_> {
    /// Finds the ground over the line of sight of a point, from the point to the eye; only ground nearer to the eye than `below` counts.
    pub(super) fn hits(&self, target: &Target, below: f64, transforms: &[CellTransform], out: &mut Vec<Hit>) {
        out.clear();
        let Self { field, cells, slack, eye: (eye, eye_z), .. } = *self;
        let Some(line) = SightLine::new(field, target.grid, eye) else { return };
        let z = transforms[target.cell].at(target.rho).of(target.original) + target.lift;
        let clearance = CLEARANCE * field.relief();
        let parts = match self.blocks {
            Some(blocks) => blocks.parts_to_check(&line, 1.0 - below / target.rho, [z - clearance, eye_z - clearance]),
            None => vec![line.span()],
        };
        let samples = line.samples(&parts, &[EdgeFamily::Columns, EdgeFamily::Rows]);
        for s in samples.iter().filter(|s| s.rho < below) {
            let original = s.of(field.heights()) - field.datum();
            let limit = (1.0 - s.tau) * z + s.tau * eye_z - clearance * (s.tau / CLEARANCE_GROWS).min(1.0);
            let cell = cells.labels()[s.nearest()];
            // Ground is only ever lowered.
            if original > limit + slack && cell != NO_CELL {
                let z = transforms[cell as usize].at(s.rho).of(original);
                if z > limit + slack {
                    out.push(Hit { cell: cell as usize, rho: s.rho, limit, original, z });
                }
            }
        }
    }
}
