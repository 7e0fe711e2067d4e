//! The rows in play with their multipliers.

use super::dual::Dual;
use super::metric::Metric;
use super::problem::{Certificate, SolvedRow};
use super::row::{Constraint, Row};
use belvedere_core::DVec2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// A row remembered between frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct RememberedRow {
    pub(super) key: RowKey,
    pub(super) multiplier: f64,
    /// Frames without a multiplier.
    pub(super) idle: u32,
}

/// Where to find a row again.
#[derive(Debug, Clone, Copy)]
pub(super) enum RowKey {
    Ceiling(u32),
    Sight { id: u32, at: DVec2 },
}

/// A row without a multiplier is forgotten after so many frames; at once if it never had one at the end of a frame.
pub(super) const IDLE: u32 = 3;

/// A row to be added.
#[derive(Debug, Clone, Copy)]
pub(super) struct NewRow {
    pub(super) row: Row,
    /// By how much the target exceeds it.
    pub(super) excess: f64,
    /// Inverse price of its slack, 0 = none.
    pub(super) soft: f64,
    /// Multiplier to begin with.
    pub(super) multiplier: f64,
    /// Frames without one.
    pub(super) idle: u32,
}

#[derive(Debug, Default)]
pub(super) struct RowsInPlay {
    pub(super) rows: Vec<Row>,
    dual: Dual,
    idle: Vec<u32>,
}

impl RowsInPlay {
    /// Adds rows.
    pub(super) fn extend(&mut self, new: Vec<NewRow>, metric: &Metric) {
        let known = self.rows.len();
        self.rows.extend(new.iter().map(|n| n.row));
        let rows = &self.rows;
        let products = |k: usize| {
            let mut out = Vec::with_capacity(known + k + 1);
            Arch::new().dispatch(Products { row: &rows[known + k], rows: &rows[..=known + k], metric, out: &mut out });
            out
        };
        let products: Vec<Vec<f64>> = (0..new.len()).into_par_iter().with_min_len(4).map(products).collect();
        for (new, products) in new.into_iter().zip(products) {
            self.dual.push(&products, new.soft, new.excess, new.multiplier);
            self.idle.push(new.idle);
        }
    }

    pub(super) fn solve(&mut self, tolerance: f64) {
        self.dual.solve(tolerance);
    }

    /// `u = target - H^-1 A^T m`.
    pub(super) fn displacement(&self, metric: &mut Metric, target: &[f64], u: &mut [f64]) {
        u.fill(0.0);
        for (i, row) in self.rows.iter().enumerate() {
            let m = self.dual.multiplier(i);
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
        self.dual.energy()
    }

    pub(super) fn slack(&self, row: usize) -> f64 {
        self.dual.slack(row)
    }

    /// What to remember for the next frame.
    pub(super) fn kept(&self, id: impl Fn(usize) -> u32) -> Vec<RememberedRow> {
        let mut out = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let multiplier = self.dual.multiplier(i);
            let idle = if multiplier > 0.0 { 0 } else { self.idle[i] + 1 };
            if idle < IDLE {
                let key = match row.constraint {
                    Constraint::Ceiling(node) => RowKey::Ceiling(node),
                    Constraint::Sight { candidate, at, .. } => RowKey::Sight { id: id(candidate), at },
                };
                out.push(RememberedRow { key, multiplier, idle });
            }
        }
        // What leaves first comes last, so that most of the factor stays.
        out.sort_by(|a, b| b.multiplier.total_cmp(&a.multiplier));
        out
    }

    /// Rows with a multiplier.
    pub(super) fn active(&self, id: impl Fn(usize) -> u32) -> Vec<SolvedRow> {
        let held = (0..self.rows.len()).filter(|&i| self.dual.multiplier(i) > 0.0);
        held.map(|i| {
            let Row { nodes, weights, bound, constraint, .. } = self.rows[i];
            let (candidate, at, tau) = match constraint {
                Constraint::Ceiling(_) => (None, DVec2::ZERO, 0.0),
                Constraint::Sight { candidate, at, tau } => (Some(id(candidate)), at, tau),
            };
            let (multiplier, slack) = (self.dual.multiplier(i), self.dual.slack(i));
            SolvedRow { candidate, at, tau, nodes, weights, bound, multiplier, slack }
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
        let mut sum = std::collections::BTreeMap::<u32, f64>::new();
        let (mut bound, mut total, mut rows) = (0.0, 0.0, Vec::new());
        for (i, row) in self.rows.iter().enumerate() {
            let m = self.dual.multiplier(i);
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

/// `a H^-1 b` of a row with others, with the widest registers at hand.
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
