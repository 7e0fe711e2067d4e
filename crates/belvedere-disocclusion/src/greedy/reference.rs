//! Plain reference of the greedy pass, for tests: everything is tested again after every change.

use super::super::{Cells, Field, ReferencePoint, TerrainSettings};
use super::GreedyCounters;
use super::equations::{Affine, BlendCost, blended};
use belvedere_core::{DVec2, DVec3};
use belvedere_sight::{SightSample, guard_tau, sight_samples};

/// One change of a cell, nearer to the eye than `below`.
struct Change {
    cell: usize,
    below: f64,
    scale: f64,
    shift: f64,
    lambda: f64,
}

pub(super) struct Reference<'a> {
    field: &'a Field,
    cells: &'a Cells,
    settings: &'a TerrainSettings,
    eye: DVec2,
    eye_z: f64,
    points: &'a [ReferencePoint],
    changes: Vec<Change>,
    pub(super) counters: GreedyCounters,
    pub(super) unresolved: Vec<bool>,
    /// (distance, point, below, whole)
    queue: Vec<(f64, usize, f64, bool)>,
    backward: Vec<u32>,
}

impl<'a> Reference<'a> {
    pub(super) fn run(
        field: &'a Field,
        cells: &'a Cells,
        settings: &'a TerrainSettings,
        eye: DVec3,
        points: &'a [ReferencePoint],
    ) -> Self {
        let mut out = Self {
            field,
            cells,
            settings,
            eye: field.grid_from_scene(eye.truncate()),
            eye_z: eye.z - field.datum(),
            points,
            changes: Vec::new(),
            counters: GreedyCounters::default(),
            unresolved: vec![false; points.len()],
            queue: Vec::new(),
            backward: vec![0; cells.len()],
        };
        (0..points.len()).for_each(|p| out.put(p));
        loop {
            let before = |a: &(f64, usize, f64, bool), b: &(f64, usize, f64, bool)| {
                a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)).then(a.3.cmp(&b.3))
            };
            let Some(next) = (0..out.queue.len()).max_by(|&a, &b| before(&out.queue[a], &out.queue[b])) else { break };
            let entry = out.queue.remove(next);
            out.counters.traces += 1;
            if entry.3 {
                out.unresolved[entry.1] = false;
            }
            while out.one_hit(entry) {}
        }
        let changed: std::collections::BTreeSet<usize> = out.changes.iter().map(|c| c.cell).collect();
        out.counters.cells_changed = changed.len();
        out.counters.unresolved = out.unresolved.iter().filter(|u| **u).count();
        out
    }

    fn metres(&self, g: DVec2) -> f64 {
        ((g - self.eye) * self.field.spacing()).length()
    }

    fn put(&mut self, point: usize) {
        let g = self.points[point].grid;
        let rho = self.metres(g);
        if !self.queue.iter().any(|q| q.1 == point && q.3) {
            self.queue.push((rho, point, (1.0 - guard_tau(g, self.eye, self.settings.guard)) * rho, true));
        }
    }

    /// All changes of a cell at a distance from the eye, one after the other.
    pub(super) fn at(&self, cell: usize, rho: f64) -> Affine {
        let mine = self.changes.iter().filter(|c| c.cell == cell && rho < c.below);
        mine.fold(Affine::IDENTITY, |now, c| {
            let new = blended(now, c.scale, c.shift, c.lambda);
            Affine { shift: new.shift.max(-self.field.relief()), ..new }
        })
    }

    fn height(&self, s: &SightSample) -> (usize, f64) {
        let nearest = s.nodes[usize::from(s.weight > 0.5)] as usize;
        let cell = self.cells.labels()[nearest] as usize;
        (cell, self.at(cell, s.rho).of(s.of(self.field.heights()) - self.field.datum()))
    }

    /// Samples over the line of sight: (cell, distance, limit, height).
    pub(super) fn over(&self, point: usize, below: f64) -> Vec<(usize, f64, f64, f64)> {
        let p = &self.points[point];
        let own = self.cells.cell_at(self.field, p.grid);
        let z = self.at(own, self.metres(p.grid)).of(p.ground - self.field.datum()) + p.lift;
        let samples = sight_samples(self.field, p.grid, self.eye, false);
        let slack = 1e-12 * (self.field.relief() + self.eye_z.abs());
        let nearer = samples.iter().filter(|s| s.rho < below);
        let all = nearer.map(|s| {
            let clearance = 1e-3 * self.field.relief() * (20.0 * s.tau).min(1.0);
            let (cell, height) = self.height(s);
            (cell, s.rho, (1.0 - s.tau) * z + s.tau * self.eye_z - clearance, height)
        });
        all.filter(|(_, _, limit, height)| *height > limit + 1.5 * slack).collect()
    }

    fn one_hit(&mut self, entry: (f64, usize, f64, bool)) -> bool {
        let (rho, point, below, _) = entry;
        let over = self.over(point, below);
        let Some(&(cell, at, ..)) = over.first() else { return false };
        let g = self.points[point].grid;
        let own = self.cells.cell_at(self.field, g);
        let per_cell = self.metres(g) / (g - self.eye).length();
        let mut reach = f64::INFINITY;
        if cell == own {
            if below - at > 2.0 * per_cell {
                self.counters.aux += 1;
                self.queue.push((at, point, at.next_up(), false));
                return false;
            }
            self.counters.backfacing += 1;
            reach = below;
        } else {
            self.counters.regular += 1;
            let on_it = |i: usize| self.cells.cell_at(self.field, self.points[i].grid) == cell;
            let finished = |i: usize| !self.queue.iter().any(|q| q.1 == i && q.3);
            let farther = |i: usize| {
                let d = self.metres(self.points[i].grid);
                d > rho || (d == rho && i < point)
            };
            if (0..self.points.len()).any(|i| i != point && on_it(i) && finished(i) && farther(i)) {
                if self.backward[cell] < 1 {
                    self.backward[cell] += 1;
                    self.counters.backward += 1;
                } else {
                    reach = below;
                }
            }
        }
        self.counters.hits += 1;
        self.change(cell, reach, &over.iter().copied().filter(|o| o.0 == cell).collect::<Vec<_>>());
        for i in 0..self.points.len() {
            let p = self.points[i].grid;
            if i != point && self.cells.cell_at(self.field, p) == cell && self.metres(p) < reach {
                self.put(i);
            }
        }
        if self.over(point, below).iter().any(|o| o.0 == cell) {
            self.unresolved[point] = true;
            return false;
        }
        true
    }

    fn change(&mut self, cell: usize, below: f64, over: &[(usize, f64, f64, f64)]) {
        let scale = over.iter().map(|o| o.2 / o.3).fold(f64::INFINITY, f64::min);
        let shift = over.iter().map(|o| o.2 - o.3).fold(f64::INFINITY, f64::min);
        let worst = over.iter().copied().max_by(|a, b| (a.3 - a.2).total_cmp(&(b.3 - b.2))).unwrap();
        let now = self.at(cell, worst.1);
        let (higher_share, higher_mean) = self.cells.higher(cell, (worst.2 - now.shift) / now.scale);
        let (ids, shares) = self.cells.neighbours(cell);
        let neighbours: Vec<(f64, Affine)> =
            ids.iter().zip(shares).map(|(&n, &w)| (w, self.at(n as usize, worst.1))).collect();
        let TerrainSettings { eta, mu, mu_dev, .. } = *self.settings;
        let mean = self.cells.mean_height(cell);
        let cost =
            BlendCost { now, scale, shift, higher_share, higher_mean, mean, neighbours: &neighbours, eta, mu, mu_dev };
        let low = over.iter().any(|o| o.3 <= 1e-3 * self.field.relief() || o.2 <= 0.0);
        let (scale, lambda) = if low { (1.0, 0.0) } else { (scale, cost.best_lambda()) };
        let new = below < f64::INFINITY && !self.changes.iter().any(|c| c.cell == cell && c.below == below);
        self.counters.splits += usize::from(new);
        self.changes.push(Change { cell, below, scale, shift, lambda });
    }
}
