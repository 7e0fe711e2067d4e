//! Erosion of a square grid of heights by rivers, rock falls, creep and ice; f64, deterministic.

/// A square grid of heights that drains through some nodes of its border.
#[derive(Debug, Clone)]
pub(crate) struct Land {
    /// Nodes per side.
    pub(crate) n: usize,
    /// Metres between nodes.
    pub(crate) dx: f64,
    /// Heights, metres, row-major.
    pub(crate) z: Vec<f64>,
    /// Nodes through which water leaves; their height is kept.
    pub(crate) outlet: Vec<bool>,
}

/// The drainage network of a land.
#[derive(Debug, Clone)]
pub(crate) struct Drainage {
    /// Nodes from the outlets upstream: a node comes after the node it drains to.
    pub(crate) order: Vec<u32>,
    /// Node each node drains to; itself for outlets.
    pub(crate) receiver: Vec<u32>,
    /// Drained area, square metres.
    pub(crate) area: Vec<f64>,
}

/// Least drained area at which a stream erodes, square metres: slopes above springs stay smooth.
const SPRING_M2: f64 = 12_000.0;

/// Offsets of the eight neighbours, straight ones first.
const NEIGHBOURS: [(isize, isize); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

impl Land {
    /// Neighbours of a node and their distances in spacings.
    pub(crate) fn around(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + use<> {
        let n = self.n as isize;
        let (c, r) = (i as isize % n, i as isize / n);
        NEIGHBOURS.iter().enumerate().filter_map(move |(k, &(dc, dr))| {
            let (nc, nr) = (c + dc, r + dr);
            let distance = if k < 4 { 1.0 } else { std::f64::consts::SQRT_2 };
            (nc >= 0 && nr >= 0 && nc < n && nr < n).then_some(((nr * n + nc) as usize, distance))
        })
    }

    /// Priority flood from the outlets with a bucket queue; each node drains to its steepest neighbour already reached, and pits
    /// through the node that flooded them.
    ///
    /// Source: Barnes, Lehman and Mulla 2014 (priority flood); the bucket queue and the receivers in one pass are ours.
    pub(crate) fn drainage(&self) -> Drainage {
        const STEP_M: f64 = 0.5;
        let count = self.z.len();
        let (lo, hi) = self.z.iter().fold((f64::MAX, f64::MIN), |(l, h), &z| (l.min(z), h.max(z)));
        let bucket_of = |z: f64| ((z - lo) / STEP_M) as usize;
        let mut buckets: Vec<Vec<u32>> = vec![Vec::new(); bucket_of(hi) + 2];
        let (mut receiver, mut order) = (vec![u32::MAX; count], Vec::with_capacity(count));
        let (mut queued, mut done) = (vec![false; count], vec![false; count]);
        for i in (0..count).filter(|&i| self.outlet[i]) {
            queued[i] = true;
            receiver[i] = i as u32;
            buckets[bucket_of(self.z[i])].push(i as u32);
        }
        for level in 0..buckets.len() {
            let mut next = 0;
            while let Some(&i) = buckets[level].get(next) {
                next += 1;
                let i = i as usize;
                let (mut steepest, mut to) = (0.0, receiver[i]);
                for (j, distance) in self.around(i) {
                    if done[j] {
                        let slope = (self.z[i] - self.z[j]) / distance;
                        if slope > steepest && !self.outlet[i] {
                            (steepest, to) = (slope, j as u32);
                        }
                    } else if !queued[j] {
                        queued[j] = true;
                        receiver[j] = i as u32;
                        buckets[bucket_of(self.z[j]).max(level)].push(j as u32);
                    }
                }
                receiver[i] = to;
                done[i] = true;
                order.push(i as u32);
            }
            buckets[level] = Vec::new();
        }
        let mut area = vec![self.dx * self.dx; count];
        for &i in order.iter().rev() {
            let (i, to) = (i as usize, receiver[i as usize] as usize);
            if to != i {
                area[to] += area[i];
            }
        }
        Drainage { order, receiver, area }
    }

    /// One implicit step of stream-power incision `dz/dt = uplift - k sqrt(area) slope`; pits are filled with sediment.
    ///
    /// * `lift`: uplift of the step per node, metres; `k`: erodibility times duration, 1 (area exponent 1/2, slope exponent 1), per node.
    ///
    /// Source: Braun and Willett 2013, eq. 22 with m = 1/2, n = 1.
    pub(crate) fn incise(&mut self, lift: &[f64], k: &[f64], talus: &[f64]) -> Drainage {
        let water = self.drainage();
        for &i in &water.order {
            let (i, to) = (i as usize, water.receiver[i as usize] as usize);
            if to == i {
                continue;
            }
            let straight = i % self.n == to % self.n || i / self.n == to / self.n;
            let run = if straight { self.dx } else { self.dx * std::f64::consts::SQRT_2 };
            let f = k[i] * (water.area[i] - SPRING_M2).max(0.0).sqrt() / run;
            let z = (self.z[i] + lift[i] + f * self.z[to]) / (1.0 + f);
            self.z[i] = z.clamp(self.z[to] + 1e-3 * run, self.z[to] + talus[i] * run);
        }
        water
    }

    /// Rock falls: wherever the drop to a neighbour exceeds `talus` (rise over run, per node), part of the excess moves down.
    pub(crate) fn slide(&mut self, talus: &[f64], passes: usize) {
        for _ in 0..passes {
            let old = self.z.clone();
            for i in 0..old.len() {
                for (j, distance) in self.around(i) {
                    let excess = old[i] - old[j] - talus[i] * distance * self.dx;
                    if excess > 0.0 {
                        let moved = 0.12 * excess;
                        if !self.outlet[i] {
                            self.z[i] -= moved;
                        }
                        if !self.outlet[j] {
                            self.z[j] += moved;
                        }
                    }
                }
            }
        }
    }

    /// Creep: moves every node the share `rate(node)` (0..=1) towards the mean of its straight neighbours.
    pub(crate) fn creep(&mut self, rate: impl Fn(usize) -> f64) {
        let old = self.z.clone();
        for i in (0..old.len()).filter(|&i| !self.outlet[i]) {
            let (mut sum, mut count) = (0.0, 0.0);
            for (j, _) in self.around(i).filter(|(_, d)| *d == 1.0) {
                sum += old[j];
                count += 1.0;
            }
            self.z[i] += rate(i) * (sum / count - old[i]);
        }
    }

    /// Bilinear height at fractional column and row, clamped to the grid.
    pub(crate) fn sample(&self, col: f64, row: f64) -> f64 {
        let last = (self.n - 1) as f64;
        let (x, y) = (col.clamp(0.0, last), row.clamp(0.0, last));
        let (c, r) = ((x as usize).min(self.n - 2), (y as usize).min(self.n - 2));
        let (u, v) = (x - c as f64, y - r as f64);
        let i = r * self.n + c;
        let north = self.z[i] + u * (self.z[i + 1] - self.z[i]);
        let south = self.z[i + self.n] + u * (self.z[i + self.n + 1] - self.z[i + self.n]);
        north + v * (south - north)
    }

    /// Glacial erosion: widens valleys into troughs with flat floors and steep walls, which end in cirques; returns the carved nodes.
    ///
    /// * `ice_m2(z)`: drained area from which a valley at height z held ice, square metres;
    /// * `half_width(area)`: half the width of the floor, metres.
    ///
    /// Source: ours (parabolic cross profile as in Svensson 1959).
    pub(crate) fn carve_troughs(
        &mut self,
        water: &Drainage,
        ice_m2: impl Fn(f64) -> f64,
        half_width: impl Fn(f64) -> f64,
    ) -> Vec<bool> {
        let trunk: Vec<usize> = (0..self.z.len()).filter(|&i| water.area[i] >= ice_m2(self.z[i])).collect();
        let old = self.z.clone();
        let mut carved = vec![false; old.len()];
        for &t in &trunk {
            let flat = half_width(water.area[t]);
            let reach = ((flat + 330.0) / self.dx) as isize;
            let (c, r) = ((t % self.n) as isize, (t / self.n) as isize);
            for dr in -reach..=reach {
                for dc in -reach..=reach {
                    let (nc, nr) = (c + dc, r + dr);
                    if nc < 0 || nr < 0 || nc >= self.n as isize || nr >= self.n as isize {
                        continue;
                    }
                    let i = nr as usize * self.n + nc as usize;
                    let beyond = (((dc * dc + dr * dr) as f64).sqrt() * self.dx - flat).max(0.0);
                    let wall = old[t] + beyond * beyond / 230.0;
                    if wall < self.z[i] && !self.outlet[i] {
                        self.z[i] = wall;
                        carved[i] = true;
                    }
                }
            }
        }
        carved
    }
}
