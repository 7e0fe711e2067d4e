//! The dual program without its matrix, for thousands of rows.
//!
//! `min 1/2 m^T (K + S) m - c^T m` over `m >= 0` by the proximal method of multipliers (Rockafellar 1976): each cycle adds
//! `near (m - m_before)^2 / 2` per row and solves what is then well conditioned. With very many rows on a grid that is not too fine this is
//! done over displacements, see [`super::augmented`]; else by a primal-dual active set (Hintermueller, Ito, Kunisch 2002), whose equations
//! on a face are solved by conjugate gradients: a product with K is one solve of the smoother, and factors of crowds of neighbouring rows
//! precondition.

use super::augmented::{Augmented, Terms};
use super::cholesky::dot;
use super::metric::Metric;
use super::preconditioner::Preconditioner;
use super::row::Row;
use rayon::prelude::*;

/// First proximal weight of a cycle, share of a row's own square, by crowds and by a sparse factor; it falls and rises within limits.
const NEARNESS: f64 = 1e-2;
const NEARNESS_BY_FACTOR: f64 = 1e-3;
const NEARNESS_RANGE: [f64; 2] = [1e-5, 1.0];
const NEARER: f64 = 8.0;
/// By crowds, and by a sparse factor, to which a small weight does no harm.
const FARTHER: [f64; 2] = [0.25, 0.1];
/// With a sparse factor the weight begins with this multiple of the last, where less than this share of the rows is new.
const AGAIN: f64 = 4.0;
const FEW: f64 = 0.02;
/// Share by which the value of a step may rise by rounding.
const ROUNDING: f64 = 1e-12;
/// Newton steps, each a change of the face (the active set), per cycle at most, and changes in succession without fewer rows changing at most.
const NEWTON_STEPS: usize = 40;
const PATIENCE: usize = 5;
/// Conjugate gradient steps on a face while many rows change, and afterwards.
const CONJUGATE_STEPS: [usize; 2] = [25, 60];
/// Tolerance of the equations on a face, share of the allowed miss of each row.
const EXACT: f64 = 0.2;
/// Number of neighbouring rows of which only the most missed one joins a face at a time: the others are mostly met with it.
const GROUP: usize = 8;
/// Most nodes of a grid for which a sparse factor is made, and rows up to which none is made: with fewer, crowds are quicker.
const MOST_NODES: usize = 40_000;
const MOST_CROWDED: usize = 4000;
/// Cycles at most of rough solutions, of those within a height, by crowds and by a sparse factor, and of exact ones.
const CYCLES: [usize; 4] = [1, 2, 4, 10];
/// Changes of the face at most in rough solutions.
const ROUGH_STEPS: usize = 8;

/// How well rows are to be met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Effort {
    /// Within this height if that takes little time, metres.
    Rough(f64),
    /// Within this height, metres.
    Within(f64),
    /// As each row may be missed.
    Exact,
}

impl Effort {
    fn enough(self) -> f64 {
        match self {
            Self::Rough(enough) | Self::Within(enough) => enough,
            Self::Exact => 0.0,
        }
    }

    /// Cycles at most, and changes of the face in each.
    fn limits(self, direct: bool) -> [usize; 2] {
        match self {
            Self::Rough(_) => [CYCLES[0], ROUGH_STEPS],
            Self::Within(_) => [CYCLES[1 + usize::from(direct)], NEWTON_STEPS],
            Self::Exact => [CYCLES[3], NEWTON_STEPS],
        }
    }
}

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
    /// 0 before the first solution.
    nearness: f64,
    /// Whether a sparse factor served the last solution.
    direct: bool,
    /// Limit in place of [`MOST_CROWDED`].
    many: Option<usize>,
    /// Order of the rows in which neighbours follow each other.
    order: Vec<usize>,
    /// Values at the nodes of the solver's grid.
    nodes: Vec<f64>,
}

/// Equations of one cycle: `(K + D) m = wanted` on the face, m = 0 off it.
struct Equations {
    terms: Terms,
    /// Diagonal of `K + D`.
    whole: Vec<f64>,
    face: Vec<bool>,
    preconditioner: Option<Preconditioner>,
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

    /// Whether rows that are nearly met are worth keeping: the last solution was quick however many rows there were.
    pub(super) fn keeps_near(&self) -> bool {
        self.direct
    }

    /// Whether steps are solved over displacements, by a sparse factor.
    pub(super) fn is_direct(&self, metric: &Metric) -> bool {
        self.rows.len() > self.many.unwrap_or(MOST_CROWDED) && metric.nodes() <= MOST_NODES
    }

    /// Runs cycles until no row is missed by more than it may be, or by more than the effort asks for. Returns whether that was reached.
    ///
    /// * `go_on`: asked between steps; false stops with the best so far.
    pub(super) fn solve(&mut self, metric: &mut Metric, effort: Effort, go_on: &(dyn Fn() -> bool + Sync)) -> bool {
        let direct = self.is_direct(metric);
        self.direct = direct;
        let new = self.m.len() - self.product.len();
        let few = (new as f64) < FEW * self.m.len() as f64;
        let begin = match effort {
            Effort::Rough(_) => self.nearness.max(NEARNESS),
            _ if direct && self.nearness > 0.0 && few => (AGAIN * self.nearness).min(NEARNESS_BY_FACTOR),
            _ if direct => NEARNESS_BY_FACTOR,
            _ => NEARNESS,
        };
        self.cycles(metric, effort.enough(), effort.limits(direct), begin, go_on)
    }

    /// * `enough`: height by which rows may be missed if that is more than what each is allowed, metres;
    /// * `cycles`, `newton_steps`: at most, and changes of the face in each;
    /// * `nearness`: the first proximal weight.
    fn cycles(
        &mut self,
        metric: &mut Metric,
        enough: f64,
        [cycles, newton_steps]: [usize; 2],
        nearness: f64,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> bool {
        if self.product.len() < self.m.len() {
            self.product = self.times(metric, &self.m.clone());
        }
        self.nearness = nearness;
        self.order = (0..self.rows.len()).collect();
        self.order.sort_by_cached_key(|&i| crowd_key(&self.rows[i]));
        let direct = self.is_direct(metric);
        for _ in 0..cycles {
            if self.met(enough) || !go_on() {
                break;
            }
            if direct {
                self.step(metric, enough, newton_steps, go_on);
            } else {
                self.cycle(metric, newton_steps, go_on);
            }
        }
        self.met(enough)
    }

    fn met(&self, enough: f64) -> bool {
        (0..self.m.len()).all(|i| self.missed(i) <= self.allowed[i].max(enough))
    }

    /// The proximal step from the multipliers as they are.
    fn terms(&self, enough: f64) -> Terms {
        let near: Vec<f64> = self.square.iter().map(|square| self.nearness * square).collect();
        Terms {
            wanted: (0..near.len()).map(|i| self.excess[i] + near[i] * self.m[i]).collect(),
            diagonal: near.iter().zip(&self.soft).map(|(near, soft)| near + soft).collect(),
            allowed: self.allowed.iter().map(|allowed| allowed.max(enough)).collect(),
        }
    }

    /// One proximal step by a sparse factor; one that does not gain is not taken. The next one is longer if this one reached its
    /// minimum, else shorter.
    fn step(&mut self, metric: &mut Metric, enough: f64, newton_steps: usize, go_on: &(dyn Fn() -> bool + Sync)) {
        let terms = self.terms(enough);
        let (m, done) =
            Augmented::new(metric, &self.rows).minimum(&terms, (&self.m, &self.product), newton_steps, go_on);
        let product = self.times(metric, &m);
        let (before, after) = (terms.value(&self.m, &self.product), terms.value(&m, &product));
        let gains = after <= before + ROUNDING * before.abs();
        if gains {
            (self.m, self.product) = (m, product);
        }
        let change = if done && gains { FARTHER[1] } else { NEARER };
        self.nearness = (change * self.nearness).clamp(NEARNESS_RANGE[0], NEARNESS_RANGE[1]);
    }

    /// One proximal step; without progress the multipliers stay and the proximal weight of the next step is greater.
    fn cycle(&mut self, metric: &mut Metric, newton_steps: usize, go_on: &(dyn Fn() -> bool + Sync)) {
        let terms = self.terms(0.0);
        let mut equations = Equations {
            whole: self.square.iter().zip(&terms.diagonal).map(|(square, d)| square + d).collect(),
            terms,
            face: self.m.iter().map(|m| *m > 0.0).collect(),
            preconditioner: None,
        };
        let mut changed = self.turn(&mut equations);
        let mut best = (equations.terms.value(&self.m, &self.product), self.m.clone(), self.product.clone());
        let (mut improved, mut fewest, mut patience) = (false, usize::MAX, PATIENCE);
        for _ in 0..newton_steps {
            let held: Vec<usize> = self.order.iter().copied().filter(|&i| equations.face[i]).collect();
            let many = 20 * changed > held.len();
            if many || equations.preconditioner.is_none() {
                equations.preconditioner = Some(Preconditioner::new(metric, &self.rows, &held, &equations.whole));
            }
            self.on_the_face(metric, &equations, &held, CONJUGATE_STEPS[usize::from(!many)]);
            changed = self.turn(&mut equations);
            if self.m.iter().any(|m| *m < 0.0) {
                self.m.iter_mut().for_each(|m| *m = m.max(0.0));
                self.product = self.times(metric, &self.m.clone());
            }
            let objective = equations.terms.value(&self.m, &self.product);
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
        let change = if improved && patience > 0 { FARTHER[0] } else { NEARER };
        self.nearness = (change * self.nearness).clamp(NEARNESS_RANGE[0], NEARNESS_RANGE[1]);
        (_, self.m, self.product) = best;
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
                let over = e.terms.wanted[i] - self.product[i] - e.terms.diagonal[i] * self.m[i];
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
    ///
    /// * `held`: all rows of the face, neighbours following each other.
    fn on_the_face(&mut self, metric: &mut Metric, e: &Equations, held: &[usize], steps: usize) {
        let left = (0..self.m.len()).filter(|&i| !e.face[i] && self.m[i] != 0.0).count();
        if left > 0 {
            self.m.iter_mut().zip(&e.face).filter(|(_, face)| !**face).for_each(|(m, _)| *m = 0.0);
            self.product = self.times(metric, &self.m.clone());
        }
        let mut residual: Vec<f64> =
            held.iter().map(|&i| e.terms.wanted[i] - self.product[i] - e.terms.diagonal[i] * self.m[i]).collect();
        let Some(preconditioner) = &e.preconditioner else { return };
        let apply = |residual: &[f64]| preconditioner.apply(held, residual, &e.whole);
        let mut z = apply(&residual);
        let mut p = z.clone();
        let mut square = dot(&residual, &z);
        for _ in 0..steps {
            let done = held.iter().zip(&residual).all(|(&i, r)| r.abs() <= EXACT * self.allowed[i]);
            if !(square > 0.0) || done {
                break;
            }
            let mut kp = self.times_on(metric, held, &p);
            for ((kp, p), &i) in kp.iter_mut().zip(&p).zip(held) {
                *kp += e.terms.diagonal[i] * p;
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
            z = apply(&residual);
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
}

/// Orders rows so that neighbours, in point and ground, mostly follow each other.
fn crowd_key(row: &Row) -> u64 {
    let [(_, ground), _, (_, point), _] = row.points;
    let parts = [point.col, point.row, ground.col, ground.row];
    (0..13).rev().fold(0, |key, bit| parts.iter().fold(key, |key, v| (key << 1) | u64::from((v >> bit) & 1)))
}

#[cfg(test)]
mod tests;
