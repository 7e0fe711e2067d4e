//! The greedy pass: lines of sight are followed far to near, and each lowers the cells that hide its point.

use super::super::{Cells, Field, ReferencePoint, TerrainSettings};
use super::blocks::BlockMaxima;
use super::equations::{Affine, BlendCost, blended, scale_to_clear, shift_to_clear};
use super::hits::{CLEARANCE, Hit, Target, Tracer};
use super::transform::CellTransform;
use belvedere_core::DVec3;
use std::collections::BinaryHeap;

/// Heights that differ by less than this share of the relief are equal.
const EQUAL: f64 = 1e-12;
/// How many times a whole cell may be changed although this lowers finished points farther away.
const BACKWARD: u32 = 1;
/// Distance from a point within which its own cell is changed at once, grid cells; from a hit farther away the line is queued anew.
const NEAR: f64 = 2.0;

/// Counts of the greedy pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// Cells that were changed.
    pub cells_changed: usize,
    /// Points that this pass could not make visible.
    pub unresolved: usize,
}

/// A line of sight to follow, or the part of it nearer to the eye than `below`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Entry {
    /// Distance to the eye at which it starts; farthest first.
    rho: f64,
    point: usize,
    below: f64,
    whole: bool,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let whole = self.whole.cmp(&other.whole);
        self.rho.total_cmp(&other.rho).then(other.point.cmp(&self.point)).then(whole)
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Result of the pass.
pub(super) struct Outcome {
    pub(super) transforms: Vec<CellTransform>,
    /// Indices of points, ascending.
    pub(super) unresolved: Vec<usize>,
    pub(super) counters: GreedyCounters,
}

struct Pass<'a> {
    field: &'a Field,
    cells: &'a Cells,
    settings: &'a TerrainSettings,
    targets: Vec<Target>,
    /// Indices of the points on each cell.
    on_cell: Vec<Vec<usize>>,
    transforms: Vec<CellTransform>,
    slack: f64,
    /// Whether the whole line of a point waits in the queue.
    waiting: Vec<bool>,
    unresolved: Vec<bool>,
    /// Backward events of each cell.
    backward: Vec<u32>,
    queue: BinaryHeap<Entry>,
    counters: GreedyCounters,
}

/// Follows every line of sight until the queue is empty.
///
/// * `blocks`: of `field`; without them the result is the same, but takes longer.
pub(super) fn run(
    field: &Field,
    cells: &Cells,
    blocks: Option<&BlockMaxima>,
    settings: &TerrainSettings,
    eye: DVec3,
    points: &[ReferencePoint],
) -> Outcome {
    let eye = (field.grid_from_scene(eye.truncate()), eye.z - field.datum());
    let target = |p: &ReferencePoint| Target::new(field, cells, p, eye.0, settings.guard);
    let targets: Vec<Target> = points.iter().map(target).collect();
    let mut on_cell = vec![Vec::new(); cells.len()];
    targets.iter().enumerate().for_each(|(i, t)| on_cell[t.cell].push(i));
    let mut pass = Pass {
        field,
        cells,
        settings,
        on_cell,
        transforms: vec![CellTransform::default(); cells.len()],
        slack: EQUAL * (field.relief() + eye.1.abs()),
        waiting: vec![false; targets.len()],
        unresolved: vec![false; targets.len()],
        backward: vec![0; cells.len()],
        queue: BinaryHeap::new(),
        counters: GreedyCounters::default(),
        targets,
    };
    let tracer = Tracer { field, cells, blocks, eye, slack: pass.slack };
    (0..pass.targets.len()).for_each(|point| pass.enqueue(point));
    let mut hits = Vec::new();
    while let Some(entry) = pass.queue.pop() {
        pass.counters.traces += 1;
        tracer.hits(&pass.targets[entry.point], entry.below, &pass.transforms, &mut hits);
        pass.clear_line(entry, &mut hits);
    }
    let unresolved: Vec<usize> = (0..pass.targets.len()).filter(|&i| pass.unresolved[i]).collect();
    pass.counters.unresolved = unresolved.len();
    pass.counters.cells_changed = pass.transforms.iter().filter(|t| t.changed()).count();
    Outcome { transforms: pass.transforms, unresolved, counters: pass.counters }
}

impl Pass<'_> {
    fn enqueue(&mut self, point: usize) {
        if !std::mem::replace(&mut self.waiting[point], true) {
            self.queue.push(self.whole(point));
        }
    }

    /// Clears a line of sight of its hits, cell by cell.
    fn clear_line(&mut self, entry: Entry, hits: &mut Vec<Hit>) {
        let target = self.targets[entry.point];
        if entry.whole {
            self.waiting[entry.point] = false;
            self.unresolved[entry.point] = false;
        }
        // Clearing a cell changes nothing in the others.
        while let Some(&first) = hits.first() {
            let below = if first.cell == target.cell {
                if entry.below - first.rho > NEAR * target.per_cell {
                    self.counters.aux += 1;
                    let (rho, below) = (first.rho, first.rho.next_up());
                    self.queue.push(Entry { rho, point: entry.point, below, whole: false });
                    return;
                }
                self.counters.backfacing += 1;
                entry.below
            } else {
                self.counters.regular += 1;
                self.reach(&entry, first.cell)
            };
            self.counters.hits += 1;
            self.clear(first.cell, below, hits);
            self.put_back(&entry, first.cell, below);
            if !self.cleared(first.cell, hits) {
                self.unresolved[entry.point] = true;
                return;
            }
        }
    }

    /// Distance from the eye up to which the cell of another point may be changed: infinite, unless that lowers finished points
    /// farther away and has done so before.
    fn reach(&mut self, entry: &Entry, cell: usize) -> f64 {
        let mut points = self.on_cell[cell].iter().copied();
        let lowers_finished = points.any(|i| !self.waiting[i] && self.whole(i) > *entry);
        if !lowers_finished {
            return f64::INFINITY;
        }
        if self.backward[cell] < BACKWARD {
            self.backward[cell] += 1;
            self.counters.backward += 1;
            return f64::INFINITY;
        }
        entry.below
    }

    /// Queue entry for the whole line of a point.
    fn whole(&self, point: usize) -> Entry {
        let target = &self.targets[point];
        Entry { rho: target.rho, point, below: target.own, whole: true }
    }

    /// Lowers the part of a cell that is nearer to the eye than `below` until none of its hits is left.
    fn clear(&mut self, cell: usize, below: f64, hits: &[Hit]) {
        let mine = || hits.iter().filter(|h| h.cell == cell);
        let shift = mine().map(|h| shift_to_clear(h.limit, h.z)).fold(f64::INFINITY, f64::min);
        let Some(worst) = mine().max_by(|a, b| (a.z - a.limit).total_cmp(&(b.z - b.limit))) else { return };
        // Scaling means nothing below the datum.
        let low = mine().any(|h| h.z <= CLEARANCE * self.field.relief() || h.limit <= 0.0);
        let scale = mine().map(|h| scale_to_clear(h.limit, h.z)).fold(1.0, f64::min);
        let (scale, lambda) = if low { (1.0, 0.0) } else { (scale, self.best_lambda(cell, worst, scale, shift)) };
        let deepest = -self.field.relief();
        let divided = self.transforms[cell].change(below, |now| {
            let new = blended(now, scale, shift, lambda);
            Affine { shift: new.shift.max(deepest), ..new }
        });
        self.counters.splits += usize::from(divided);
    }

    fn best_lambda(&self, cell: usize, worst: &Hit, scale: f64, shift: f64) -> f64 {
        let now = self.transforms[cell].at(worst.rho);
        let (higher_share, higher_mean) = self.cells.higher(cell, (worst.limit - now.shift) / now.scale);
        let (ids, shares) = self.cells.neighbours(cell);
        let neighbours: Vec<(f64, Affine)> =
            ids.iter().zip(shares).map(|(&n, &w)| (w, self.transforms[n as usize].at(worst.rho))).collect();
        let &TerrainSettings { eta, mu, mu_dev, .. } = self.settings;
        let mean = self.cells.mean_height(cell);
        BlendCost { now, scale, shift, higher_share, higher_mean, mean, neighbours: &neighbours, eta, mu, mu_dev }
            .best_lambda()
    }

    /// Points on the lowered ground that were followed before are followed again.
    fn put_back(&mut self, entry: &Entry, cell: usize, below: f64) {
        for k in 0..self.on_cell[cell].len() {
            let i = self.on_cell[cell][k];
            if i != entry.point && self.targets[i].rho < below {
                self.enqueue(i);
            }
        }
    }

    /// Drops the hits of a cell that no longer rise over the line; returns whether none is left.
    fn cleared(&self, cell: usize, hits: &mut Vec<Hit>) -> bool {
        let slack = 2.0 * self.slack;
        hits.retain_mut(|h| {
            if h.cell == cell {
                h.z = self.transforms[cell].at(h.rho).of(h.original);
            }
            h.cell != cell || h.z > h.limit + slack
        });
        hits.iter().all(|h| h.cell != cell)
    }
}
