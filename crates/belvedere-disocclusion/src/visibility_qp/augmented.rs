//! A step of the method of multipliers with a sparse factor, for thousands of rows.
//!
//! The proximal step of the dual, `min 1/2 m^T (K + D) m - wanted^T m` over `m >= 0`, is the minimum over displacements v of
//! `1/2 v^T H v + sum max(0, a v + wanted)^2 / (2 D)`, with `m = max(0, a v + wanted) / D` (Rockafellar 1976). That is smooth, and
//! rows that are nearly the same do no harm: a semismooth Newton method with an exact line search ends after few steps (Hermans, Themelis,
//! Patrinos 2019). The Newton matrix `H + A^T D^-1 A` over the rows in force is sparse and of the size of the grid however many rows
//! there are.

use super::cholesky::dot;
use super::dissection::{Dissection, Pair};
use super::fronts::{Factor, Squares};
use super::metric::Metric;
use super::row::Row;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Rows that come into force or go out of it, up to which a factor is used again, as a preconditioner.
const STALE: usize = 12;
/// Conjugate gradient steps at most, and decrease of their residual at which they end.
const CG_STEPS: usize = 20;
const ENOUGH: f64 = 1e-8;
/// The method ends with a step that, taken whole, moves no row by more than this share of what the row may be missed by.
const STILL: f64 = 0.05;

/// Rows over the unknowns of the grid: nodes that move together are one.
pub(super) struct Augmented<'a> {
    rows: &'a [Row],
    sides: [usize; 2],
    stands_for: Vec<u32>,
    metric: Squares,
}

/// What is minimised, by row.
pub(super) struct Terms {
    /// Excess at rest, plus the multiplier before times its proximal weight.
    pub(super) wanted: Vec<f64>,
    /// Diagonal D > 0: inverse price of slack, plus the proximal weight.
    pub(super) diagonal: Vec<f64>,
    /// Height by which the row may be missed, metres.
    pub(super) allowed: Vec<f64>,
}

/// The Newton matrix with the rows that were in force when it was factored.
struct Factored {
    force: Vec<bool>,
    factor: Factor,
}

impl<'a> Augmented<'a> {
    pub(super) fn new(metric: &Metric, rows: &'a [Row]) -> Self {
        let stands_for = metric.stands_for();
        let mut squares = Squares::default();
        metric.squares(|entries, scale| {
            squares.push(entries.iter().map(|(node, w)| (stands_for[*node as usize], *w)), scale);
        });
        Self { rows, sides: metric.sides(), stands_for, metric: squares }
    }

    /// Finds the multipliers of one step. Returns them and whether the minimum was reached.
    ///
    /// * `m`, `product`: multipliers to begin with, and K m;
    /// * `steps`: Newton steps at most;
    /// * `go_on`: asked between steps.
    pub(super) fn minimum(
        &self,
        terms: &Terms,
        (m, product): (&[f64], &[f64]),
        steps: usize,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> (Vec<f64>, bool) {
        // H v and A v of the displacement that belongs to the multipliers.
        let mut pull: Vec<f64> = self.spread(m).into_iter().map(|v| -v).collect();
        let mut over: Vec<f64> = terms.wanted.iter().zip(product).map(|(wanted, product)| wanted - product).collect();
        let mut factored: Option<Factored> = None;
        for _ in 0..steps {
            if !go_on() {
                break;
            }
            let force: Vec<bool> = over.iter().map(|over| *over > 0.0).collect();
            let mut gradient = self.spread(&terms.multipliers(&over));
            gradient.iter_mut().zip(&pull).for_each(|(g, pull)| *g += pull);
            let changed = |f: &Factored| f.force.iter().zip(&force).filter(|(a, b)| a != b).count();
            let factored = match factored.take().filter(|f| changed(f) <= STALE) {
                Some(same) => factored.insert(same),
                None => factored.insert(self.factored(terms, &force)),
            };
            if gradient.iter().all(|g| *g == 0.0) {
                return (terms.multipliers(&over), true);
            }
            let Some(way) = self.newton(terms, &force, &factored.factor, &gradient) else { break };
            let (rise, lift) = (self.rise(&way), self.metric.times(&way));
            let far = terms.line_search(&over, &rise, dot(&pull, &way), dot(&lift, &way));
            pull.iter_mut().zip(&lift).for_each(|(pull, lift)| *pull += far * lift);
            over.iter_mut().zip(&rise).for_each(|(over, rise)| *over += far * rise);
            if rise.iter().zip(&terms.allowed).all(|(rise, allowed)| rise.abs() <= STILL * allowed) {
                return (terms.multipliers(&over), true);
            }
        }
        (terms.multipliers(&over), false)
    }

    fn factored(&self, terms: &Terms, force: &[bool]) -> Factored {
        let own = |node: u32| self.stands_for[node as usize];
        let mut squares = self.metric.clone();
        let mut pairs = BTreeSet::<Pair>::new();
        for ((row, diagonal), _) in self.rows.iter().zip(&terms.diagonal).zip(force).filter(|(_, force)| **force) {
            squares.push(row.entries().map(|(node, w)| (own(node), w)), 1.0 / diagonal);
            let groups: Vec<[u32; 4]> =
                row.groups().map(|group| [0, 1, 2, 3].map(|j: usize| own(group[j.min(group.len() - 1)]))).collect();
            for (k, group) in groups.iter().enumerate() {
                pairs.extend(groups[..k].iter().map(|before| [*before, *group]));
            }
        }
        let factor = Factor::new(&Dissection::new(self.sides, &self.stands_for, &pairs), &squares);
        Factored { force: force.to_vec(), factor }
    }

    /// The Newton step, by conjugate gradients; `None` where rounding leaves no direction of descent.
    fn newton(&self, terms: &Terms, force: &[bool], factor: &Factor, gradient: &[f64]) -> Option<Vec<f64>> {
        let mut residual: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut x = vec![0.0; residual.len()];
        let apply = |residual: &[f64]| {
            let mut z = residual.to_vec();
            factor.solve(&mut z);
            z
        };
        let mut p = apply(&residual);
        let mut square = dot(&residual, &p);
        let first = square;
        if !(first > 0.0) {
            return None;
        }
        for _ in 0..CG_STEPS {
            let mut product = self.metric.times(&p);
            let weights = self.rise(&p).into_iter().zip(&terms.diagonal).zip(force);
            let weights: Vec<f64> = weights.map(|((rise, d), force)| if *force { rise / d } else { 0.0 }).collect();
            product.iter_mut().zip(self.spread(&weights)).for_each(|(out, add)| *out += add);
            let curvature = dot(&p, &product);
            if !(curvature > 0.0) {
                return None;
            }
            let rate = square / curvature;
            x.iter_mut().zip(&p).for_each(|(x, p)| *x += rate * p);
            residual.iter_mut().zip(&product).for_each(|(r, product)| *r -= rate * product);
            let z = apply(&residual);
            let next = dot(&residual, &z);
            if !(next > ENOUGH * ENOUGH * first) {
                break;
            }
            let share = next / square;
            square = next;
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + share * *p);
        }
        Some(x)
    }

    /// `A^T m` at the unknowns.
    fn spread(&self, m: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.stands_for.len()];
        for (row, m) in self.rows.iter().zip(m).filter(|(_, m)| **m != 0.0) {
            for (node, w) in row.entries() {
                out[self.stands_for[node as usize] as usize] += w * m;
            }
        }
        out
    }

    /// `A v`.
    fn rise(&self, v: &[f64]) -> Vec<f64> {
        let value = |row: &Row| row.entries().map(|(node, w)| w * v[self.stands_for[node as usize] as usize]).sum();
        self.rows.par_iter().with_min_len(2048).map(value).collect()
    }
}

impl Terms {
    /// `1/2 m^T (K + D) m - wanted^T m`.
    ///
    /// * `product`: K m.
    pub(super) fn value(&self, m: &[f64], product: &[f64]) -> f64 {
        let of = |i: usize| m[i] * (0.5 * (product[i] + self.diagonal[i] * m[i]) - self.wanted[i]);
        (0..m.len()).map(of).sum()
    }

    /// Multipliers where rows exceed their bounds by `over`.
    fn multipliers(&self, over: &[f64]) -> Vec<f64> {
        over.iter().zip(&self.diagonal).map(|(over, d)| over.max(0.0) / d).collect()
    }

    /// Step length of the least value along a direction of descent (exact line search).
    ///
    /// * `rise`: how the rows rise along it;
    /// * `slope`, `curvature`: those of `1/2 v^T H v` along it.
    fn line_search(&self, over: &[f64], rise: &[f64], slope: f64, curvature: f64) -> f64 {
        // First and second derivative at a step length.
        let at = |far: f64| {
            let (mut sum, mut bend) = (slope + far * curvature, curvature);
            for ((over, rise), d) in over.iter().zip(rise).zip(&self.diagonal) {
                let there = over + far * rise;
                if there > 0.0 {
                    sum += there * rise / d;
                    bend += rise * rise / d;
                }
            }
            (sum, bend)
        };
        let (mut low, mut high, mut far) = (0.0, f64::INFINITY, 1.0);
        for _ in 0..60 {
            let (sum, bend) = at(far);
            if sum < 0.0 {
                low = far;
            } else {
                high = far;
            }
            let newton = far - sum / bend;
            let inside = newton > low && newton < high;
            let next = match (inside, high.is_finite()) {
                (true, _) => newton,
                (false, true) => 0.5 * (low + high),
                (false, false) => 2.0 * far,
            };
            if (next - far).abs() <= 1e-12 * far || sum == 0.0 {
                break;
            }
            far = next;
        }
        far
    }
}

#[cfg(test)]
mod tests;
