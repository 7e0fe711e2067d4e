//! The dual program without its matrix, for thousands of rows.
//!
//! `min 1/2 m^T (K + S) m - c^T m` over `m >= 0` by the proximal method of multipliers (Rockafellar 1976): each cycle adds
//! `near (m - m_before)^2 / 2` per row and solves what is then well conditioned by a primal-dual active set (Hintermueller, Ito, Kunisch
//! 2002). Equations on a face are solved by conjugate gradients; a product with K is one solve of the smoother, and Cholesky
//! factors of crowds of neighbouring rows precondition.

use super::cholesky::{Cholesky, dot};
use super::metric::Metric;
use super::row::Row;
use pulp::Arch;
use rayon::prelude::*;

/// First proximal weight of a cycle, share of a row's own square; it falls and rises within limits.
const NEARNESS: f64 = 1e-2;
const NEARNESS_RANGE: [f64; 2] = [1e-5, 1.0];
const NEARER: f64 = 8.0;
const FARTHER: f64 = 0.25;
/// Changes of the face (the active set) per cycle at most, and changes in succession without fewer rows changing at most.
const NEWTON_STEPS: usize = 40;
const PATIENCE: usize = 5;
/// Conjugate gradient steps on a face while many rows change, and afterwards.
const CONJUGATE_STEPS: [usize; 2] = [25, 60];
/// Tolerance of the equations on a face, share of the allowed miss of each row.
const EXACT: f64 = 0.2;
/// Number of neighbouring rows that share one Cholesky factor.
const CROWD: usize = 96;
/// Number of neighbouring rows of which only the most missed one joins a face at a time: the others are mostly met with it.
const GROUP: usize = 8;
/// A pivot below this share of its diagonal counts as dependent.
const DEPENDENT: f64 = 1e-6;

/// Rows with their multipliers, per unit of the row.
#[derive(Debug, Clone, Default)]
pub(super) struct MatrixFree {
    rows: Vec<Row>,
    /// `a H^-1 a` of each row.
    square: Vec<f64>,
    /// Inverse price of slack, 0 = none.
    soft: Vec<f64>,
    excess: Vec<f64>,
    /// Height by which a row may be missed in the end, metres.
    allowed: Vec<f64>,
    m: Vec<f64>,
    /// `K m`, of the rows at the last solution.
    product: Vec<f64>,
    nearness: f64,
    /// Order of the rows in which neighbours follow each other.
    order: Vec<usize>,
    /// Values at the nodes of the solver's grid.
    nodes: Vec<f64>,
}

/// Equations of one cycle: `(K + diagonal) m = wanted` on the face, m = 0 off it.
struct Equations {
    wanted: Vec<f64>,
    diagonal: Vec<f64>,
    /// Diagonal of `K + diagonal`.
    whole: Vec<f64>,
    face: Vec<bool>,
    crowds: Vec<Crowd>,
}

/// Rows of a face with the factor of their block of the matrix.
struct Crowd {
    members: Vec<usize>,
    factor: Cholesky,
}

impl MatrixFree {
    /// Adds a row.
    ///
    /// * `square`: its product with itself;
    /// * `allowed`: what it may be missed by;
    /// * `soft`, `excess`, `begin`: inverse price of its slack, excess at zero multipliers, multiplier to begin with.
    pub(super) fn push(&mut self, row: &Row, square: f64, allowed: f64, [soft, excess, begin]: [f64; 3]) {
        self.rows.push(*row);
        self.square.push(square.max(f64::MIN_POSITIVE));
        self.soft.push(soft);
        self.excess.push(excess);
        self.allowed.push(allowed);
        self.m.push(begin);
    }

    pub(super) fn multiplier(&self, row: usize) -> f64 {
        self.m[row]
    }

    /// Slack of a soft row, >= 0, metres.
    pub(super) fn slack(&self, row: usize) -> f64 {
        self.m[row] * self.soft[row]
    }

    /// Height by which a row is missed beyond its slack, metres; negative where it is met with a margin, infinite before the first
    /// solution.
    pub(super) fn missed(&self, row: usize) -> f64 {
        self.product.get(row).map_or(f64::INFINITY, |product| self.excess[row] - product - self.slack(row))
    }

    /// `1/2 m^T (K + S) m`.
    pub(super) fn energy(&self) -> f64 {
        let of = |(i, product): (usize, &f64)| 0.5 * self.m[i] * (product + self.slack(i));
        self.product.iter().enumerate().map(of).sum()
    }

    /// Runs cycles until no row is missed by more than it may be, or by `enough` if that is more. Returns whether that was reached.
    ///
    /// * `cycles`: at most;
    /// * `go_on`: asked between steps; false stops with the best so far.
    pub(super) fn solve(
        &mut self,
        metric: &mut Metric,
        enough: f64,
        cycles: usize,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> bool {
        if self.product.len() < self.m.len() {
            self.product = self.times(metric, &self.m.clone());
        }
        self.nearness = NEARNESS;
        self.order = (0..self.rows.len()).collect();
        self.order.sort_by_cached_key(|&i| crowd_key(&self.rows[i]));
        for _ in 0..cycles {
            if self.met(enough) || !go_on() {
                break;
            }
            self.cycle(metric, go_on);
        }
        self.met(enough)
    }

    fn met(&self, enough: f64) -> bool {
        (0..self.m.len()).all(|i| self.missed(i) <= self.allowed[i].max(enough))
    }

    /// One proximal step; without progress the multipliers stay and the proximal weight of the next step is greater.
    fn cycle(&mut self, metric: &mut Metric, go_on: &(dyn Fn() -> bool + Sync)) {
        let n = self.m.len();
        let near: Vec<f64> = self.square.iter().map(|square| self.nearness * square).collect();
        let mut equations = Equations {
            wanted: (0..n).map(|i| self.excess[i] + near[i] * self.m[i]).collect(),
            diagonal: (0..n).map(|i| self.soft[i] + near[i]).collect(),
            whole: (0..n).map(|i| self.square[i] + self.soft[i] + near[i]).collect(),
            face: self.m.iter().map(|m| *m > 0.0).collect(),
            crowds: Vec::new(),
        };
        let mut changed = self.turn(&mut equations);
        let mut best = (self.objective(&equations), self.m.clone(), self.product.clone());
        let (mut improved, mut fewest, mut patience) = (false, usize::MAX, PATIENCE);
        for _ in 0..NEWTON_STEPS {
            let held = equations.face.iter().filter(|f| **f).count();
            let many = 20 * changed > held;
            if many || equations.crowds.is_empty() {
                equations.crowds = self.crowds(metric, &equations);
            }
            self.on_the_face(metric, &equations, CONJUGATE_STEPS[usize::from(!many)]);
            changed = self.turn(&mut equations);
            if self.m.iter().any(|m| *m < 0.0) {
                self.m.iter_mut().for_each(|m| *m = m.max(0.0));
                self.product = self.times(metric, &self.m.clone());
            }
            let objective = self.objective(&equations);
            if objective < best.0 {
                best = (objective, self.m.clone(), self.product.clone());
                improved = true;
            }
            if changed < fewest {
                (fewest, patience) = (changed, PATIENCE);
            } else {
                patience -= 1;
            }
            if changed == 0 || patience == 0 || !go_on() {
                break;
            }
        }
        let change = if improved && patience > 0 { FARTHER } else { NEARER };
        self.nearness = (change * self.nearness).clamp(NEARNESS_RANGE[0], NEARNESS_RANGE[1]);
        (_, self.m, self.product) = best;
    }

    fn objective(&self, e: &Equations) -> f64 {
        let of = |i: usize| self.m[i] * (0.5 * (self.product[i] + e.diagonal[i] * self.m[i]) - e.wanted[i]);
        (0..self.m.len()).map(of).sum()
    }

    /// Rows without a multiplier leave the face, and of each group the most missed row joins it. Returns the number of rows that changed.
    fn turn(&self, e: &mut Equations) -> usize {
        let mut changed = 0;
        for group in self.order.chunks(GROUP) {
            let mut worst = (0.0, None);
            for &i in group {
                if e.face[i] {
                    if self.m[i] <= 0.0 {
                        e.face[i] = false;
                        changed += 1;
                    }
                    continue;
                }
                let over = e.wanted[i] - self.product[i] - e.diagonal[i] * self.m[i];
                if over > (EXACT * self.allowed[i]).max(worst.0) {
                    worst = (over, Some(i));
                }
            }
            if let (_, Some(i)) = worst {
                e.face[i] = true;
                changed += 1;
            }
        }
        changed
    }

    /// Preconditioned conjugate gradients from the multipliers as they are. They may become negative.
    fn on_the_face(&mut self, metric: &mut Metric, e: &Equations, steps: usize) {
        let left = (0..self.m.len()).filter(|&i| !e.face[i] && self.m[i] != 0.0).count();
        if left > 0 {
            self.m.iter_mut().zip(&e.face).filter(|(_, face)| !**face).for_each(|(m, _)| *m = 0.0);
            self.product = self.times(metric, &self.m.clone());
        }
        // All rows of the face, neighbours following each other.
        let held: Vec<usize> = self.order.iter().copied().filter(|&i| e.face[i]).collect();
        let mut residual: Vec<f64> =
            held.iter().map(|&i| e.wanted[i] - self.product[i] - e.diagonal[i] * self.m[i]).collect();
        let preconditioner = Preconditioner::new(e, &held);
        let mut z = preconditioner.apply(&residual);
        let mut p = z.clone();
        let mut square = dot(&residual, &z);
        for _ in 0..steps {
            let done = held.iter().zip(&residual).all(|(&i, r)| r.abs() <= EXACT * self.allowed[i]);
            if !(square > 0.0) || done {
                break;
            }
            let mut kp = self.times_on(metric, &held, &p);
            for ((kp, p), &i) in kp.iter_mut().zip(&p).zip(&held) {
                *kp += e.diagonal[i] * p;
            }
            let curvature = dot(&p, &kp);
            if !(curvature > 0.0) {
                break;
            }
            let rate = square / curvature;
            for (k, &i) in held.iter().enumerate() {
                self.m[i] += rate * p[k];
                residual[k] -= rate * kp[k];
            }
            z = preconditioner.apply(&residual);
            let next = dot(&residual, &z);
            let share = next / square;
            square = next;
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + share * *p);
        }
        self.product = self.times(metric, &self.m.clone());
    }

    /// `K v`.
    fn times(&mut self, metric: &mut Metric, v: &[f64]) -> Vec<f64> {
        self.spread(metric, v.iter().copied().enumerate());
        let nodes = &self.nodes;
        self.rows.par_iter().with_min_len(2048).map(|row| row.at(nodes)).collect()
    }

    /// `K v` at the rows `held`, with `v` given at these rows alone.
    fn times_on(&mut self, metric: &mut Metric, held: &[usize], v: &[f64]) -> Vec<f64> {
        self.spread(metric, held.iter().copied().zip(v.iter().copied()));
        let (rows, nodes) = (&self.rows, &self.nodes);
        held.par_iter().with_min_len(2048).map(|&i| rows[i].at(nodes)).collect()
    }

    /// `H^-1 A^T v` at the nodes.
    fn spread(&mut self, metric: &mut Metric, v: impl Iterator<Item = (usize, f64)>) {
        self.nodes.clear();
        self.nodes.resize(metric.nodes(), 0.0);
        for (i, v) in v.filter(|(_, v)| *v != 0.0) {
            for (node, w) in self.rows[i].entries() {
                self.nodes[node as usize] += w * v;
            }
        }
        metric.solve(&mut self.nodes);
    }
    /// Factors of the rows of the face, neighbours together.
    fn crowds(&self, metric: &Metric, e: &Equations) -> Vec<Crowd> {
        let held: Vec<usize> = self.order.iter().copied().filter(|&i| e.face[i]).collect();
        let crowd = |members: &[usize]| {
            let mut factor = Cholesky::default();
            Arch::new().dispatch(
                #[inline(always)]
                || {
                    for (k, &i) in members.iter().enumerate() {
                        let products = members[..k].iter().map(|&j| self.rows[i].product(&self.rows[j], metric));
                        factor.push(products, e.whole[i], DEPENDENT);
                    }
                },
            );
            Crowd { members: members.to_vec(), factor }
        };
        held.par_chunks(CROWD).map(crowd).collect()
    }
}

/// Solves by crowds, for the rows of a face in their order.
struct Preconditioner<'e> {
    crowds: &'e [Crowd],
    /// For each row its position on the face, if it is there.
    position: Vec<Option<u32>>,
    /// Diagonal of the rows of the face.
    whole: Vec<f64>,
}

impl<'e> Preconditioner<'e> {
    fn new(e: &'e Equations, held: &[usize]) -> Self {
        let mut position = vec![None; e.face.len()];
        held.iter().enumerate().for_each(|(k, &i)| position[i] = Some(k as u32));
        Self { crowds: &e.crowds, position, whole: held.iter().map(|&i| e.whole[i]).collect() }
    }

    fn apply(&self, residual: &[f64]) -> Vec<f64> {
        let solved = |crowd: &Crowd| {
            let of = |&i: &usize| self.position[i].map_or(0.0, |k| residual[k as usize]);
            let mut x: Vec<f64> = crowd.members.iter().map(of).collect();
            Arch::new().dispatch(
                #[inline(always)]
                || crowd.factor.solve(&mut x),
            );
            x
        };
        let parts: Vec<Vec<f64>> = self.crowds.par_iter().with_min_len(16).map(solved).collect();
        // Rows that joined since the factors were made stand for themselves.
        let mut out: Vec<f64> = residual.iter().zip(&self.whole).map(|(r, whole)| r / whole).collect();
        for (crowd, x) in self.crowds.iter().zip(parts) {
            for (&i, x) in crowd.members.iter().zip(x) {
                if let Some(k) = self.position[i] {
                    out[k as usize] = x;
                }
            }
        }
        out
    }
}

/// Orders rows so that neighbours, in point and ground, mostly follow each other.
fn crowd_key(row: &Row) -> u64 {
    let [(_, ground), _, (_, point), _] = row.points;
    let parts = [point.col, point.row, ground.col, ground.row];
    (0..13).rev().fold(0, |key, bit| parts.iter().fold(key, |key, v| (key << 1) | u64::from((v >> bit) & 1)))
}

#[cfg(test)]
mod tests {
    use super::super::dual::Dual;
    use super::*;
    use crate::smooth::{Between, Smoother};

    /// A displacement of one node, or of one against another.
    fn row(k: usize, nodes: usize) -> Row {
        let node = |i: usize| Between::node((i % (nodes * nodes)) as u32, nodes, nodes);
        let (a, b) = (k * 37 + k / 7, k * 53 + 11);
        let mut row = Row::ceiling((a % (nodes * nodes)) as u32, node(a), 0.0);
        if !k.is_multiple_of(3) {
            let share = -0.1 * (k % 7) as f64;
            (row.nodes[1], row.weights[1], row.len) = ((b % (nodes * nodes)) as u32, share, 2);
            row.points[1] = (share, node(b));
        }
        row
    }

    #[test]
    fn multipliers_are_those_of_the_active_set() {
        let nodes = 25;
        let mut metric = Metric::new(Smoother::new(nodes, nodes, 0.4, 0.0).unwrap());
        for soft in [0.0, 0.05] {
            let (mut free, mut dual, mut rows) = (MatrixFree::default(), Dual::default(), Vec::<Row>::new());
            for k in 0..300 {
                let row = row(k, nodes);
                rows.push(row);
                let products: Vec<f64> = rows.iter().map(|other| row.product(other, &metric)).collect();
                let excess = ((k * 7919) % 13) as f64 - 6.0;
                free.push(&row, products[k], 1e-7, [soft, excess, 0.0]);
                dual.push(&products, soft, excess, 0.0);
            }
            assert!(free.solve(&mut metric, 0.0, 40, &|| true));
            assert!(dual.solve(1e-9, &|| true));
            let (mut held, mut largest) = (0, 0.0f64);
            for k in 0..rows.len() {
                held += usize::from(dual.multiplier(k) > 0.0);
                largest = largest.max(dual.multiplier(k));
            }
            let apart = (free.energy() - dual.energy()).abs() / dual.energy();
            assert!(apart < 1e-6, "energies {} and {}", free.energy(), dual.energy());
            let off = |k: usize| (free.multiplier(k) - dual.multiplier(k)).abs();
            let off = (0..rows.len()).map(off).fold(0.0, f64::max) / largest;
            assert!(off < 1e-3 && held > 30 && held < 250, "{held} held, multipliers {off} apart");
        }
    }

    #[test]
    fn it_stops_when_told_to() {
        let nodes = 25;
        let mut metric = Metric::new(Smoother::new(nodes, nodes, 0.4, 0.0).unwrap());
        let mut free = MatrixFree::default();
        for k in 0..200 {
            let row = row(k, nodes);
            let square = row.product(&row, &metric);
            free.push(&row, square, 1e-9, [0.0, 5.0, 0.0]);
        }
        assert!(!free.solve(&mut metric, 0.0, 40, &|| false));
        assert!(free.solve(&mut metric, 0.0, 40, &|| true));
    }
}
