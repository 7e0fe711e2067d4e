//! What hides a point.

use super::super::line_of_sight::{SightSample, SightWalk, guard_tau};
use super::super::{Cells, Field, NO_CELL, ReferencePoint};
use super::scan::{High, Scan, merge};
use super::{Affine, Blocks, CLEARANCE, CLEARANCE_GROWS, Pieces};
use belvedere_core::DVec2;
use pulp::{Arch, Simd, WithSimd};

/// The line of sight of one point as the ground is now. Heights are over the datum.
pub(super) struct Sight {
    pub(super) from: DVec2,
    pub(super) eye: DVec2,
    /// Height of the line at the point and at the eye.
    pub(super) height: [f64; 2],
    /// Where the point's own ground ends.
    pub(super) guard: f64,
    /// Largest clearance.
    pub(super) clearance: f64,
}

impl Sight {
    /// The height that the ground must not exceed.
    pub(super) fn limit(&self, tau: f64) -> f64 {
        let line = (1.0 - tau) * self.height[0] + tau * self.height[1];
        line - self.clearance * (tau / CLEARANCE_GROWS).min(1.0)
    }
}

/// Ground over a line of sight.
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

/// Finds the samples of a line of sight that may lie too high.
pub(super) trait Sampler: Sync {
    /// Appends all samples whose ground is higher than the line of sight allows, in order, and possibly others.
    fn samples(&self, sight: &Sight, ground: &Lowered, room: &mut Room, out: &mut Vec<SightSample>);
}

/// Room to work in, kept from line to line.
#[derive(Default)]
pub(super) struct Room {
    parts: Vec<(f64, f64)>,
    high: Vec<High>,
    by_family: [Vec<SightSample>; 2],
}

/// The ground as it is now.
pub(super) struct Lowered {
    /// What is done to each cell.
    pub(super) pieces: Vec<Pieces>,
    /// A bound of the highest ground of each block.
    pub(super) ceilings: Vec<f32>,
    /// Cells that were lowered since those were set.
    lowered: Vec<usize>,
}

impl Lowered {
    /// Untouched.
    pub(super) fn new(blocks: &Blocks, cells: usize) -> Self {
        Self { pieces: vec![Pieces::default(); cells], ceilings: blocks.ceilings(), lowered: Vec::new() }
    }

    /// See [`Pieces::change`].
    pub(super) fn change(&mut self, cell: usize, below: f64, change: impl FnMut(Affine) -> Affine) -> bool {
        self.lowered.push(cell);
        self.pieces[cell].change(below, change)
    }

    /// Sets the bounds anew where ground was lowered; until then they are higher than need be.
    pub(super) fn settle(&mut self, blocks: &Blocks) {
        self.lowered.sort_unstable();
        self.lowered.dedup();
        self.lowered.drain(..).for_each(|cell| blocks.lower(cell, &self.pieces, &mut self.ceilings));
    }
}

/// Leaves out blocks that the line clears, and what was lowered enough.
pub(super) struct Skipping<'a> {
    pub(super) field: &'a Field,
    pub(super) cells: &'a Cells,
    pub(super) blocks: &'a Blocks,
}

impl Sampler for Skipping<'_> {
    fn samples(&self, sight: &Sight, ground: &Lowered, room: &mut Room, out: &mut Vec<SightSample>) {
        Arch::new().dispatch(Skip { all: self, sight, ground, room, out });
    }
}

/// With the instructions at hand: rounding is a call without them.
struct Skip<'a> {
    all: &'a Skipping<'a>,
    sight: &'a Sight,
    ground: &'a Lowered,
    room: &'a mut Room,
    out: &'a mut Vec<SightSample>,
}

impl WithSimd for Skip<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { all: Skipping { field, cells, blocks }, sight, ground: Lowered { pieces, ceilings, .. }, room, out } =
            self;
        let Room { parts, high, by_family: [columns, rows] } = room;
        let Some(walk) = SightWalk::new(field, sight.from, sight.eye, false) else { return };
        let height = sight.height.map(|h| h - sight.clearance);
        let (t0, t1) = walk.span();
        parts.clear();
        columns.clear();
        rows.clear();
        blocks.near_parts((sight.from, walk.dir()), (t0.max(sight.guard), t1), height, ceilings, parts);
        let scan = Scan { simd, field, cells, pieces, height };
        for &part in &*parts {
            scan.part::<0>(&walk, part, high, columns);
            scan.part::<1>(&walk, part, high, rows);
        }
        merge([columns, rows], out);
    }
}

/// The ground over the line of sight that lies nearer to the eye than `below`, in order.
pub(super) fn hits(
    samples: &[SightSample],
    field: &Field,
    cells: &Cells,
    pieces: &[Pieces],
    sight: &Sight,
    (below, slack): (f64, f64),
    out: &mut Vec<Hit>,
) {
    out.clear();
    for s in samples {
        if s.rho >= below {
            continue;
        }
        let (original, limit) = (s.of(field.heights()) - field.datum(), sight.limit(s.tau));
        // Ground is only ever lowered.
        if original <= limit + slack {
            continue;
        }
        let cell = cells.labels()[s.nearest()] as usize;
        let z = pieces[cell].at(s.rho).of(original);
        if z > limit + slack {
            out.push(Hit { cell, rho: s.rho, limit, original, z });
        }
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

    pub(super) fn sight(&self, field: &Field, pieces: &[Pieces], (eye, eye_z): (DVec2, f64)) -> Sight {
        let z = pieces[self.cell].at(self.rho).of(self.original) + self.lift;
        let clearance = CLEARANCE * field.relief();
        Sight { from: self.grid, eye, height: [z, eye_z], guard: self.guard, clearance }
    }
}
