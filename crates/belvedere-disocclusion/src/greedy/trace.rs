//! What hides a point.

use super::super::{Cells, Field, NO_CELL, ReferencePoint};
use super::ceilings::Ceilings;
use super::gather::Crossings;
use super::scan::{High, Scan, UNSURE, merge};
use super::under::Under;
use super::{Affine, Blocks, CLEARANCE, CLEARANCE_GROWS, Pieces};
use belvedere_core::DVec2;
use belvedere_sight::{SightLine, guard_tau};
use pulp::{Arch, Simd, WithSimd};

/// Of all heights in use.
const DOUBT: f64 = 1e-12;
/// Of the relief, for heights are kept in single precision.
const ROUNDED: f64 = 1.2e-7;

/// The line of sight of one point as the ground is now. Heights are over the datum.
pub(super) struct Sight {
    pub(super) from: DVec2,
    pub(super) eye: DVec2,
    /// Distance from the point to the eye in plan, scene units.
    pub(super) rho: f64,
    /// Height of the line at the point and at the eye.
    pub(super) height: [f64; 2],
    /// Where the point's own ground ends.
    pub(super) guard: f64,
    /// Largest clearance.
    pub(super) clearance: f64,
    /// Height up to which scaling means nothing.
    pub(super) low: f64,
    /// Heights are not known better than this before they are computed exactly.
    pub(super) doubt: f64,
}

impl Sight {
    /// Whether a crossing may stand for others of its cell: it surely counts, and scaling means something there.
    #[inline(always)]
    pub(super) fn comparable(&self, high: &High) -> bool {
        high.tau > self.guard + UNSURE && high.tau < 1.0 - UNSURE && high.limit > self.low
    }

    /// A line nowhere higher than [`Self::limit`], rounding counted: its height at the point, and what it rises to the eye.
    #[inline(always)]
    pub(super) fn clear(&self) -> (f64, f64) {
        (self.height[0] - self.clearance - self.doubt, self.height[1] - self.height[0])
    }

    /// The height that the ground must not exceed.
    pub(super) fn limit(&self, tau: f64) -> f64 {
        let line = (1.0 - tau) * self.height[0] + tau * self.height[1];
        line - self.clearance * (tau / CLEARANCE_GROWS).min(1.0)
    }
}

/// Finds the ground that may lie over a line of sight.
pub(super) trait Sampler: Sync {
    /// Appends, in order, what may lie over the line of sight now or after cells were lowered further; what others of the
    /// same cell make needless may be missing, see [`Scan::family`].
    fn samples(&self, line: &SightLine<'_>, sight: &Sight, ground: &Lowered, room: &mut Room, out: &mut Vec<High>);
}

/// Room to work in, kept from line to line.
#[derive(Default)]
pub(super) struct Room {
    stretches: Vec<[f64; 2]>,
    crossings: [Crossings; 2],
    by_family: [Vec<High>; 2],
}

/// The ground as it is now.
pub(super) struct Lowered {
    /// What is done to each cell.
    pub(super) pieces: Vec<Pieces>,
    /// The most that is done to ground of each cell, as scale and shift; and a last one for no cell.
    cells: Vec<[f64; 2]>,
    pub(super) ceilings: Ceilings,
}

impl Lowered {
    /// Untouched.
    ///
    /// * `eye`: grid coordinates.
    pub(super) fn new(field: &Field, blocks: &Blocks, cells: usize, eye: DVec2) -> Self {
        Self {
            pieces: vec![Pieces::default(); cells],
            cells: vec![[1.0, 0.0]; cells + 1],
            ceilings: Ceilings::new(blocks, eye, field.spacing()),
        }
    }

    /// See [`Pieces::change`].
    pub(super) fn change(&mut self, cell: usize, below: f64, change: impl FnMut(Affine) -> Affine) -> bool {
        self.ceilings.lower(cell);
        let divided = self.pieces[cell].change(below, change);
        let Affine { scale, shift } = self.pieces[cell].bound();
        self.cells[cell] = [scale, shift];
        divided
    }

    /// Scale and shift of each cell: ground of it that was at least 0 high is nowhere higher than these make it. The last
    /// ones, which change nothing, are for what belongs to none.
    pub(super) fn cells(&self) -> &[[f64; 2]] {
        &self.cells
    }

    /// Sets the bounds anew where ground was lowered.
    pub(super) fn settle(&mut self, blocks: &Blocks) {
        self.ceilings.settle(blocks, &self.pieces);
    }
}

/// Leaves out blocks that the line clears, and what was lowered enough.
pub(super) struct Skipping<'a> {
    pub(super) blocks: &'a Blocks,
}

impl Sampler for Skipping<'_> {
    fn samples(&self, line: &SightLine<'_>, sight: &Sight, ground: &Lowered, room: &mut Room, out: &mut Vec<High>) {
        Arch::new().dispatch(Skip { all: self, line, sight, ground, room, out });
    }
}

/// With the instructions at hand: rounding is a call without them.
struct Skip<'a> {
    all: &'a Skipping<'a>,
    line: &'a SightLine<'a>,
    sight: &'a Sight,
    ground: &'a Lowered,
    room: &'a mut Room,
    out: &'a mut Vec<High>,
}

impl WithSimd for Skip<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { all: Skipping { blocks }, line, sight, ground, room, out } = self;
        let Room { stretches, crossings: [columns, rows], by_family } = room;
        stretches.clear();
        by_family.iter_mut().for_each(Vec::clear);
        Under { size: blocks.size(), ceilings: ground.ceilings.of_blocks() }.near(simd, line, sight, stretches);
        columns.gather::<S, 0>(simd, line, stretches, blocks, ground.cells());
        rows.gather::<S, 1>(simd, line, stretches, blocks, ground.cells());
        let scan = Scan { simd, ground, sight };
        scan.family::<0>(columns, &mut by_family[0]);
        scan.family::<1>(rows, &mut by_family[1]);
        merge(by_family, out);
    }
}

/// The cell of the node with data that is nearest to a place on the ground.
pub(super) fn cell_at(field: &Field, cells: &Cells, g: DVec2) -> usize {
    let (col, row) = ((g.x as usize).min(field.cols() - 2), (g.y as usize).min(field.rows() - 2));
    let corners = [(col, row), (col + 1, row), (col, row + 1), (col + 1, row + 1)];
    let away = |(c, r): (usize, usize)| (DVec2::new(c as f64, r as f64) - g).length_squared();
    let solid = corners.into_iter().filter(|&(c, r)| cells.labels()[r * field.cols() + c] != NO_CELL);
    let (c, r) = solid.min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or((col, row));
    cells.labels()[r * field.cols() + c] as usize
}

/// A reference point on its way through the pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Target {
    pub(super) grid: DVec2,
    /// Height of the untouched ground over the datum.
    pub(super) original: f64,
    pub(super) lift: f64,
    pub(super) cell: usize,
    /// Distance to the eye in plan.
    pub(super) rho: f64,
    /// Scene units per cell along its line of sight.
    pub(super) per_cell: f64,
    /// See [`guard_tau`].
    pub(super) guard: f64,
}

impl Target {
    pub(super) fn new(field: &Field, cells: &Cells, point: &ReferencePoint, eye: DVec2, guard: f64) -> Self {
        let length = (eye - point.grid).length();
        let rho = ((eye - point.grid) * field.spacing()).length();
        Self {
            grid: point.grid,
            original: point.ground - field.datum(),
            lift: point.lift,
            cell: cell_at(field, cells, point.grid),
            rho,
            per_cell: if length > 0.0 { rho / length } else { 0.0 },
            guard: guard_tau(point.grid, eye, guard),
        }
    }

    /// Where its own ground ends, as distance to the eye.
    pub(super) fn below(&self) -> f64 {
        (1.0 - self.guard) * self.rho
    }

    /// * `below`: only ground that is nearer to the eye counts.
    pub(super) fn sight(&self, field: &Field, pieces: &[Pieces], (eye, eye_z): (DVec2, f64), below: f64) -> Sight {
        let z = pieces[self.cell].at(self.rho).of(self.original) + self.lift;
        let clearance = CLEARANCE * field.relief();
        let guard = if below < self.below() { 1.0 - below / self.rho } else { self.guard };
        let doubt = DOUBT * (field.relief() + field.datum().abs() + eye_z.abs()) + ROUNDED * field.relief();
        Sight { from: self.grid, eye, rho: self.rho, height: [z, eye_z], guard, clearance, low: clearance, doubt }
    }
}
