//! The rows in play with their multipliers.

use super::dual::Dual;
use super::matrix_free::{Effort, MatrixFree};
use super::metric::Metric;
use super::problem::{Certificate, SolvedRow};
use super::row::{Constraint, Row, Stretch};
use super::ties;
use belvedere_core::DVec2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// A row remembered between frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct RememberedRow {
    pub(super) key: RowKey,
    pub(super) multiplier: f64,
    /// Frames without a multiplier.
    pub(super) idle: u32,
}

/// Key by which a row is found again in the next frame.
#[derive(Debug, Clone, Copy)]
pub(super) enum RowKey {
    Ceiling(u32),
    River(Stretch),
    Sight { id: u32, at: DVec2 },
    Given(u32),
}

/// Frames after which a row without a multiplier is forgotten; at once if it never had one at the end of a frame.
pub(super) const IDLE: u32 = 3;

/// A row to be added.
#[derive(Debug, Clone, Copy)]
pub(super) struct NewRow {
    pub(super) row: Row,
    /// Height by which the target displacement exceeds the bound, metres.
    pub(super) excess: f64,
    /// Inverse price of its slack, 0 = none.
    pub(super) soft: f64,
    /// Height by which it may be missed where there are too many rows for an exact solution, metres.
    pub(super) allowed: f64,
    /// Multiplier to begin with.
    pub(super) multiplier: f64,
    /// Frames without one.
    pub(super) idle: u32,
}

/// Most rows for which a matrix over all of them is made. Up to it the active set is quicker, and exact.
const MOST_EXACT: usize = 2000;
/// Rows that are met with less room than this are kept for the next solution too, where there are too many for an exact one, metres.
const NEAR: f64 = 5.0;

#[derive(Debug)]
enum Multipliers {
    ActiveSet(Dual),
    MatrixFree(Box<MatrixFree>),
}

impl Default for Multipliers {
    fn default() -> Self {
        Self::ActiveSet(Dual::default())
    }
}

#[derive(Debug, Default)]
pub(super) struct RowsInPlay {
    pub(super) rows: Vec<Row>,
    allowed: Vec<f64>,
    multipliers: Multipliers,
    idle: Vec<u32>,
    /// Parts of the rows that ties subtract from products of rows; empty without ties and without a matrix.
    shared: Vec<Vec<f64>>,
}

/// Tolerances within which rows are to be met.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accuracy {
    /// Tolerance of the active set, metres.
    pub(super) exact: f64,
    /// How well rows are to be met in this round where there is no matrix.
    pub(super) effort: Effort,
}

impl RowsInPlay {
    /// Adds rows.
    pub(super) fn extend(&mut self, new: Vec<NewRow>, metric: &Metric) {
        if self.rows.len() + new.len() > MOST_EXACT {
            self.drop_matrix(metric);
        }
        let known = self.rows.len();
        self.rows.extend(new.iter().map(|n| n.row));
        self.allowed.extend(new.iter().map(|n| n.allowed));
        self.idle.extend(new.iter().map(|n| n.idle));
        match &mut self.multipliers {
            Multipliers::ActiveSet(dual) => {
                self.shared.par_extend(new.par_iter().filter_map(|n| metric.shared(&n.row.points)));
                extend(dual, (&self.rows, &self.shared), known, &new, metric);
            }
            Multipliers::MatrixFree(free) => {
                for NewRow { row, excess, soft, allowed, multiplier, .. } in new {
                    free.push(&row, row.product(&row, metric), allowed, [soft, excess, multiplier]);
                }
            }
        }
    }

    /// Nodes that have a ceiling.
    pub(super) fn ceilings(&self) -> BTreeSet<u32> {
        let node = |row: &Row| match row.constraint {
            Constraint::Ceiling(node) => Some(node),
            Constraint::River(_) | Constraint::Sight { .. } | Constraint::Given(_) => None,
        };
        self.rows.iter().filter_map(node).collect()
    }

    /// Stretches of rivers that have a row.
    pub(super) fn stretches(&self) -> BTreeSet<Stretch> {
        let stretch = |row: &Row| match row.constraint {
            Constraint::River(stretch) => Some(stretch),
            Constraint::Ceiling(_) | Constraint::Sight { .. } | Constraint::Given(_) => None,
        };
        self.rows.iter().filter_map(stretch).collect()
    }

    /// Goes on without a matrix.
    fn drop_matrix(&mut self, metric: &Metric) {
        let Multipliers::ActiveSet(dual) = &self.multipliers else { return };
        let mut free = MatrixFree::default();
        for (i, row) in self.rows.iter().enumerate() {
            let [soft, excess] = dual.terms(i);
            free.push(row, row.product(row, metric), self.allowed[i], [soft, excess, dual.multiplier(i)]);
        }
        self.multipliers = Multipliers::MatrixFree(Box::new(free));
        self.shared.clear();
    }

    /// Whether there are too many rows for a matrix over all of them.
    pub(super) fn is_matrix_free(&self) -> bool {
        matches!(self.multipliers, Multipliers::MatrixFree(_))
    }

    /// Whether there are so many rows, on a grid that is not too fine, that equations are solved by a sparse factor.
    pub(super) fn is_large(&self, metric: &Metric) -> bool {
        matches!(&self.multipliers, Multipliers::MatrixFree(free) if free.is_direct(metric))
    }

    /// Finds the multipliers. Returns whether all rows are met within their tolerances.
    ///
    /// * `go_on`: asked between steps; false stops with the best so far.
    pub(super) fn solve(
        &mut self,
        metric: &mut Metric,
        Accuracy { exact, effort }: Accuracy,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> bool {
        match &mut self.multipliers {
            Multipliers::ActiveSet(dual) => dual.solve(exact, go_on),
            Multipliers::MatrixFree(free) => free.solve(metric, effort, go_on),
        }
    }

    /// Whether a row that is not active may become so.
    fn is_near(&self, row: usize) -> bool {
        match &self.multipliers {
            Multipliers::ActiveSet(_) => false,
            Multipliers::MatrixFree(free) => free.keeps_near() && free.missed(row) > -NEAR,
        }
    }

    fn multiplier(&self, row: usize) -> f64 {
        match &self.multipliers {
            Multipliers::ActiveSet(dual) => dual.multiplier(row),
            Multipliers::MatrixFree(free) => free.multiplier(row),
        }
    }

    /// Height by which the solution misses a row, metres; 0 where it is exact.
    pub(super) fn missed(&self, row: usize) -> f64 {
        match &self.multipliers {
            Multipliers::ActiveSet(_) => 0.0,
            Multipliers::MatrixFree(free) => free.missed(row),
        }
    }

    /// `u = target - H^-1 A^T m`.
    pub(super) fn displacement(&self, metric: &mut Metric, target: &[f64], u: &mut [f64]) {
        u.fill(0.0);
        for (i, row) in self.rows.iter().enumerate() {
            let m = self.multiplier(i);
            if m > 0.0 {
                for (node, w) in row.entries() {
                    u[node as usize] -= w * m;
                }
            }
        }
        metric.solve(u);
        for (u, t) in u.iter_mut().zip(target) {
            *u += t;
        }
    }

    pub(super) fn energy(&self) -> f64 {
        match &self.multipliers {
            Multipliers::ActiveSet(dual) => dual.energy(),
            Multipliers::MatrixFree(free) => free.energy(),
        }
    }

    pub(super) fn slack(&self, row: usize) -> f64 {
        match &self.multipliers {
            Multipliers::ActiveSet(dual) => dual.slack(row),
            Multipliers::MatrixFree(free) => free.slack(row),
        }
    }

    /// Rows to remember for the next frame.
    pub(super) fn kept(&self, id: impl Fn(usize) -> u32) -> Vec<RememberedRow> {
        let mut out = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let multiplier = self.multiplier(i);
            let idle = if multiplier > 0.0 || self.is_near(i) { 0 } else { self.idle[i] + 1 };
            if idle < IDLE {
                let key = match row.constraint {
                    Constraint::Ceiling(node) => RowKey::Ceiling(node),
                    Constraint::River(stretch) => RowKey::River(stretch),
                    Constraint::Sight { candidate, at, .. } => RowKey::Sight { id: id(candidate), at },
                    Constraint::Given(index) => RowKey::Given(index),
                };
                out.push(RememberedRow { key, multiplier, idle });
            }
        }
        // Rows that leave first come last, so that most of the factor stays.
        out.sort_by(|a, b| b.multiplier.total_cmp(&a.multiplier));
        out
    }

    /// Rows with a multiplier.
    pub(super) fn active(&self, id: impl Fn(usize) -> u32) -> Vec<SolvedRow> {
        let held = (0..self.rows.len()).filter(|&i| self.multiplier(i) > 0.0);
        held.map(|i| {
            let Row { bound, constraint, .. } = self.rows[i];
            let weights = self.rows[i].entries().collect();
            let (candidate, given, at, tau) = match constraint {
                Constraint::Ceiling(_) | Constraint::River(_) => (None, None, DVec2::ZERO, 0.0),
                Constraint::Given(index) => (None, Some(index), DVec2::ZERO, 0.0),
                Constraint::Sight { candidate, at, tau } => (Some(id(candidate)), None, at, tau),
            };
            let (multiplier, slack) = (self.multiplier(i), self.slack(i));
            SolvedRow { candidate, given, at, tau, weights, bound, multiplier, slack }
        })
        .collect()
    }

    /// Whether the multipliers prove that no displacement between `-depth` and `ceilings` meets the rows.
    pub(super) fn certificate(
        &self,
        depth: f64,
        ceiling: impl Fn(usize) -> f64,
        id: impl Fn(usize) -> u32,
    ) -> Option<Certificate> {
        let mut sum = BTreeMap::<u32, f64>::new();
        let (mut bound, mut total, mut rows) = (0.0, 0.0, Vec::new());
        for (i, row) in self.rows.iter().enumerate() {
            let m = self.multiplier(i);
            if m > 0.0 {
                for (node, w) in row.entries() {
                    *sum.entry(node).or_default() += m * w;
                }
                bound += m * row.bound;
                total += m;
                if let Constraint::Sight { candidate, .. } = row.constraint {
                    rows.push((id(candidate), m));
                }
            }
        }
        let least: f64 =
            sum.iter().map(|(&node, &g)| if g > 0.0 { -g * depth } else { g * ceiling(node as usize) }).sum();
        let gap = (least - bound) / total;
        (gap > 0.0).then(|| Certificate { depth, gap, rows: rows.iter().map(|(i, m)| (*i, m / total)).collect() })
    }
}

/// Adds the rows from `known` on to the dual with their products with all rows before them.
///
/// * `shared`: what ties take of the products; empty without ties.
fn extend(dual: &mut Dual, (rows, shared): (&[Row], &[Vec<f64>]), known: usize, new: &[NewRow], metric: &Metric) {
    let products = |k: usize| {
        let mut out = Vec::with_capacity(known + k + 1);
        Arch::new().dispatch(Products { row: &rows[known + k], rows: &rows[..=known + k], metric, out: &mut out });
        if let Some(own) = shared.get(known + k) {
            out.iter_mut().zip(shared).for_each(|(out, other)| *out -= ties::product(own, other));
        }
        out
    };
    let products: Vec<Vec<f64>> = (0..new.len()).into_par_iter().with_min_len(4).map(products).collect();
    for (new, products) in new.iter().zip(products) {
        dual.push(&products, new.soft, new.excess, new.multiplier);
    }
}

/// Task for `a H^-1 b` of a row with others, with the widest available SIMD registers.
struct Products<'a> {
    row: &'a Row,
    rows: &'a [Row],
    metric: &'a Metric,
    out: &'a mut Vec<f64>,
}

impl WithSimd for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for other in self.rows {
            self.out.push(self.row.product(other, self.metric));
        }
    }
}
