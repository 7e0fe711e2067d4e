//! The order in which points are followed, and what each of them does to the ground.

use super::super::{Cells, Field, ReferencePoint, TerrainSettings};
use super::blocks::by_cell;
use super::equations::{Affine, Price, blended, scale_to_clear, shift_to_clear};
use super::hits::{Hit, Hits};
use super::trace::{Lowered, Room, Sampler, Target};
use super::{BACKWARD, Blocks, CLEARANCE, GreedyCounters, NEAR, Naive};
use belvedere_core::{DVec2, DVec3};
use belvedere_sight::SightLine;
use std::collections::BinaryHeap;

/// Heights that differ by less than this share of the relief are equal.
const EQUAL: f64 = 1e-12;

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

/// What is to follow, the farthest first. Nearly all of it is known from the beginning.
#[derive(Default)]
struct Queue {
    /// The last one first.
    sorted: Vec<Entry>,
    added: BinaryHeap<Entry>,
}

impl Queue {
    fn new(mut entries: Vec<Entry>) -> Self {
        entries.sort_unstable();
        Self { sorted: entries, added: BinaryHeap::new() }
    }

    fn push(&mut self, entry: Entry) {
        self.added.push(entry);
    }

    fn pop(&mut self) -> Option<Entry> {
        if self.added.peek() > self.sorted.last() { self.added.pop() } else { self.sorted.pop() }
    }
}

/// Traces after which the bounds of the ground are set anew: sooner costs more than it saves.
const SETTLE: usize = 12;

pub(super) struct Pass<'a> {
    field: &'a Field,
    cells: &'a Cells,
    blocks: &'a Blocks,
    settings: &'a TerrainSettings,
    eye: (DVec2, f64),
    /// Smallest height difference that counts.
    slack: f64,
    targets: Vec<Target>,
    /// Points of each cell, and where each cell's begin.
    of_cell: Vec<u32>,
    first: Vec<u32>,
    ground: Lowered,
    /// Whether the whole line of a point waits in the queue.
    waiting: Vec<bool>,
    unresolved: Vec<bool>,
    /// Backward events of each cell.
    backward: Vec<u32>,
    queue: Queue,
    /// Room for what is done to neighbours.
    neighbours: Vec<(f64, Affine)>,
    pub(super) counters: GreedyCounters,
}

impl<'a> Pass<'a> {
    pub(super) fn new(
        field: &'a Field,
        cells: &'a Cells,
        blocks: &'a Blocks,
        settings: &'a TerrainSettings,
        eye: DVec3,
        points: &[ReferencePoint],
    ) -> Self {
        let (grid, z) = (field.grid_from_scene(eye.truncate()), eye.z - field.datum());
        let targets: Vec<Target> = points.iter().map(|p| Target::new(field, cells, p, grid, settings.guard)).collect();
        let (first, of_cell) = by_cell(targets.iter().map(|t| t.cell), cells.len());
        Self {
            field,
            cells,
            blocks,
            settings,
            eye: (grid, z),
            slack: EQUAL * (field.relief() + z.abs()),
            of_cell,
            first,
            ground: Lowered::new(field, blocks, cells.len(), grid),
            waiting: vec![false; targets.len()],
            unresolved: vec![false; targets.len()],
            backward: vec![0; cells.len()],
            queue: Queue::default(),
            neighbours: Vec::new(),
            counters: GreedyCounters::default(),
            targets,
        }
    }

    pub(super) fn run(&mut self, sampler: &dyn Sampler) {
        self.waiting.fill(true);
        self.queue = Queue::new((0..self.targets.len()).map(|point| self.whole(point)).collect());
        let (mut room, mut samples, mut found) = (Room::default(), Vec::new(), Vec::new());
        while let Some(entry) = self.queue.pop() {
            if self.counters.traces.is_multiple_of(SETTLE) {
                self.ground.settle(self.blocks);
            }
            self.counters.traces += 1;
            let target = &self.targets[entry.point];
            let sight = target.sight(self.field, &self.ground.pieces, self.eye, entry.below);
            samples.clear();
            found.clear();
            if let Some(line) = &SightLine::new(self.field, sight.from, sight.eye) {
                sampler.samples(line, &sight, &self.ground, &mut room, &mut samples);
                let (field, cells, pieces) = (self.field, self.cells, &self.ground.pieces);
                Hits { field, cells, pieces, line, sight: &sight, below: entry.below, slack: self.slack }
                    .find(&samples, &mut found);
            }
            self.clear_line(entry, &mut found);
        }
    }

    pub(super) fn finish(mut self) -> Naive {
        let unresolved: Vec<usize> = (0..self.targets.len()).filter(|&i| self.unresolved[i]).collect();
        self.counters.unresolved = unresolved.len();
        self.counters.cells_changed = self.ground.pieces.iter().filter(|p| p.changed()).count();
        Naive { eye: self.eye.0, pieces: self.ground.pieces, unresolved, counters: self.counters }
    }

    fn points_of(&self, cell: usize) -> &[u32] {
        &self.of_cell[self.first[cell] as usize..self.first[cell + 1] as usize]
    }

    fn enqueue(&mut self, point: usize) {
        if !std::mem::replace(&mut self.waiting[point], true) {
            self.queue.push(self.whole(point));
        }
    }

    /// Clears a line of sight of what was found on it, cell by cell.
    fn clear_line(&mut self, entry: Entry, found: &mut Vec<Hit>) {
        let target = self.targets[entry.point];
        if entry.whole {
            self.waiting[entry.point] = false;
            self.unresolved[entry.point] = false;
        }
        // Clearing a cell changes nothing in the others.
        while let Some(&first) = found.first() {
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
            self.clear(first.cell, below, found);
            self.put_back(&entry, first.cell, below);
            if !self.cleared(first.cell, found) {
                self.unresolved[entry.point] = true;
                return;
            }
        }
    }

    /// How far from the eye another point's cell may be changed: without bounds, unless that lowers points farther away
    /// that were finished, and did so before.
    fn reach(&mut self, entry: &Entry, cell: usize) -> f64 {
        let mut points = self.points_of(cell).iter().map(|&i| i as usize);
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

    /// The entry that a point has if all of its line is to be followed.
    fn whole(&self, point: usize) -> Entry {
        let target = &self.targets[point];
        Entry { rho: target.rho, point, below: target.below(), whole: true }
    }

    /// Lowers a cell, nearer to the eye than `below`, so far that none of its hits is left.
    fn clear(&mut self, cell: usize, below: f64, found: &[Hit]) {
        let mine = || found.iter().filter(|h| h.cell == cell);
        let shift = mine().map(|h| shift_to_clear(h.limit, h.z)).fold(f64::INFINITY, f64::min);
        let Some(worst) = mine().max_by(|a, b| (a.z - a.limit).total_cmp(&(b.z - b.limit))) else { return };
        // Scaling means nothing below the datum.
        let low = mine().any(|h| h.z <= CLEARANCE * self.field.relief() || h.limit <= 0.0);
        let scale = mine().map(|h| scale_to_clear(h.limit, h.z)).fold(1.0, f64::min);
        let (scale, lambda) = if low { (1.0, 0.0) } else { (scale, self.best_lambda(cell, worst, scale, shift)) };
        let deepest = -self.field.relief();
        let divided = self.ground.change(cell, below, |now| {
            let new = blended(now, scale, shift, lambda);
            Affine { shift: new.shift.max(deepest), ..new }
        });
        self.counters.splits += usize::from(divided);
    }

    fn best_lambda(&mut self, cell: usize, worst: &Hit, scale: f64, shift: f64) -> f64 {
        let now = self.ground.pieces[cell].at(worst.rho);
        let (higher_share, higher_mean) = self.cells.higher(cell, (worst.limit - now.shift) / now.scale);
        let (ids, shares) = self.cells.neighbours(cell);
        self.neighbours.clear();
        self.neighbours
            .extend(ids.iter().zip(shares).map(|(&n, &w)| (w, self.ground.pieces[n as usize].at(worst.rho))));
        let &TerrainSettings { eta, mu, mu_dev, .. } = self.settings;
        let mean = self.cells.mean_height(cell);
        Price { now, scale, shift, higher_share, higher_mean, mean, neighbours: &self.neighbours, eta, mu, mu_dev }
            .best_lambda()
    }

    /// Points on the lowered ground that were followed before are followed again.
    fn put_back(&mut self, entry: &Entry, cell: usize, below: f64) {
        for k in self.first[cell]..self.first[cell + 1] {
            let i = self.of_cell[k as usize] as usize;
            if i != entry.point && self.targets[i].rho < below {
                self.enqueue(i);
            }
        }
    }

    /// Drops the hits of a cell that are hits no more; whether all of them are.
    fn cleared(&self, cell: usize, found: &mut Vec<Hit>) -> bool {
        let slack = 2.0 * self.slack;
        found.retain_mut(|h| {
            if h.cell == cell {
                h.z = self.ground.pieces[cell].at(h.rho).of(h.original);
            }
            h.cell != cell || h.z > h.limit + slack
        });
        found.iter().all(|h| h.cell != cell)
    }
}
