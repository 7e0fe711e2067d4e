//! The dual program: `min 1/2 m^T K m - c^T m` over `m >= 0`.

use super::cholesky::{Cholesky, dot};
use pulp::{Arch, Simd, WithSimd};

/// A pivot below this share of its diagonal counts as dependent.
const DEPENDENT: f64 = 1e-10;
/// Added to the diagonal, relative to it: near-duplicate rows share their multiplier.
const RIDGE: f64 = 1e-9;

/// Rows of the dual with their multipliers. Rows are scaled to unit diagonal inside.
#[derive(Debug, Clone, Default)]
pub(super) struct Dual {
    packed: Vec<f64>,
    scale: Vec<f64>,
    soft: Vec<f64>,
    excess: Vec<f64>,
    m: Vec<f64>,
    order: Vec<usize>,
    active: Vec<bool>,
    factor: Cholesky,
    /// Rows of the last solution.
    solved: usize,
}

fn start(row: usize) -> usize {
    row * (row + 1) / 2
}

impl Dual {
    fn len(&self) -> usize {
        self.m.len()
    }

    /// Adds a row: its products with the rows already there and itself, its diagonal addition (inverse weight of its
    /// slack, 0 = hard), its excess at zero multipliers, and the multiplier to begin with.
    pub(super) fn push(&mut self, products: &[f64], soft: f64, excess: f64, begin: f64) {
        let scale = 1.0 / products[self.len()].max(f64::MIN_POSITIVE).sqrt();
        self.packed.extend(products.iter().zip(&self.scale).map(|(k, s)| k * s * scale));
        self.packed.push(1.0);
        self.scale.push(scale);
        self.soft.push(soft * scale * scale);
        self.excess.push(excess * scale);
        self.m.push(begin / scale);
        self.active.push(false);
        if begin > 0.0 {
            self.set_active(self.m.len() - 1);
        }
    }

    fn set_active(&mut self, row: usize) {
        self.active[row] = true;
        self.order.push(row);
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.packed[start(i.max(j)) + i.min(j)]
    }

    /// Multiplier of a row, per unit of the row as it was given.
    pub(super) fn multiplier(&self, row: usize) -> f64 {
        self.m[row] * self.scale[row]
    }

    /// Terms of a row as they were given: inverse weight of its slack, and its excess.
    pub(super) fn terms(&self, row: usize) -> [f64; 2] {
        let scale = self.scale[row];
        [self.soft[row] / (scale * scale), self.excess[row] / scale]
    }

    /// Slack of a soft row, >= 0, in units of the row.
    pub(super) fn slack(&self, row: usize) -> f64 {
        self.m[row] * self.soft[row] / self.scale[row]
    }

    /// Block principal pivoting while it makes progress, which it mostly does; else the primal active-set method, which
    /// never leaves the feasible multipliers and ends.
    ///
    /// Rows are met to within `tolerance`, in units of the rows. When only a few rows joined a solution, descending keeps
    /// most of the factor.
    ///
    /// * `go_on`: asked between steps; false stops with the feasible multipliers so far.
    pub(super) fn solve(&mut self, tolerance: f64, go_on: &(dyn Fn() -> bool + Sync)) -> bool {
        let begin: Vec<f64> = self.m.iter().map(|m| m.max(0.0)).collect();
        let few = self.solved > 0 && 4 * (self.len() - self.solved) < self.order.len();
        let met = (!few && self.pivot_blocks(tolerance, go_on)) || self.descend(begin, tolerance, go_on);
        self.solved = self.len();
        met
    }

    fn pivot_blocks(&mut self, tolerance: f64, go_on: &(dyn Fn() -> bool + Sync)) -> bool {
        let (mut fewest, mut patience) = (usize::MAX, 4);
        let mut gradient = Vec::new();
        while patience > 0 && go_on() {
            self.m = self.solution();
            self.gradient(&mut gradient);
            let wrong: Vec<usize> = (0..self.len())
                .filter(|&i| match self.active[i] {
                    true => self.m[i] < 0.0,
                    false => gradient[i] < -tolerance * self.scale[i],
                })
                .collect();
            if wrong.is_empty() {
                return true;
            }
            if wrong.len() < fewest {
                (fewest, patience) = (wrong.len(), 4);
            } else {
                patience -= 1;
            }
            self.exchange(&wrong);
        }
        false
    }

    /// From the feasible multipliers `m`: adds rows that are missed, moves to the solution on the active rows, and drops rows whose
    /// multiplier reaches zero on the way. The objective never rises.
    fn descend(&mut self, m: Vec<f64>, tolerance: f64, go_on: &(dyn Fn() -> bool + Sync)) -> bool {
        let now: Vec<usize> = (0..self.len()).filter(|&i| self.active[i] != (m[i] > 0.0)).collect();
        self.exchange(&now);
        self.m = m;
        let mut gradient = Vec::new();
        let mut block = 16usize;
        for _ in 0..40 * (self.len() + 10) {
            if !go_on() {
                break;
            }
            let target = self.solution();
            let mut step = 1.0f64;
            for &i in &self.order {
                if target[i] < 0.0 {
                    step = step.min(self.m[i] / (self.m[i] - target[i]));
                }
            }
            for &i in &self.order {
                self.m[i] += step * (target[i] - self.m[i]);
            }
            if step < 1.0 {
                let gone: Vec<usize> = self
                    .order
                    .iter()
                    .copied()
                    .filter(|&i| target[i] < 0.0 && self.m[i] <= 1e-14 * target[i].abs())
                    .collect();
                for &i in &gone {
                    self.m[i] = 0.0;
                }
                self.exchange(&gone);
                if step == 0.0 {
                    block = 1;
                }
                continue;
            }
            self.gradient(&mut gradient);
            let mut wrong: Vec<usize> =
                (0..self.len()).filter(|&i| !self.active[i] && gradient[i] < -tolerance * self.scale[i]).collect();
            if wrong.is_empty() {
                return true;
            }
            wrong.sort_by(|&a, &b| gradient[a].total_cmp(&gradient[b]));
            wrong.truncate(block);
            wrong.sort_unstable();
            self.exchange(&wrong);
        }
        false
    }

    fn exchange(&mut self, rows: &[usize]) {
        for &i in rows {
            self.active[i] = !self.active[i];
        }
        let gone: Vec<usize> = (0..self.order.len()).filter(|&k| !self.active[self.order[k]]).collect();
        let (n, known) = (self.order.len(), self.factor.size());
        // A rotation takes about eight times the time of a product.
        let rotated: usize = gone.iter().map(|k| 8 * known.saturating_sub(*k).pow(2) / 2).sum();
        let renewed: usize = gone.first().map_or(0, |first| (n.pow(3) - first.pow(3)) / 6);
        if rotated < renewed {
            gone.iter().rev().filter(|k| **k < known).for_each(|k| self.factor.remove(*k));
        } else if let Some(first) = gone.first() {
            self.factor.truncate(*first);
        }
        self.order.retain(|&i| self.active[i]);
        self.order.extend(rows.iter().filter(|&&i| self.active[i]));
    }

    /// Multipliers that meet the active rows exactly.
    fn solution(&mut self) -> Vec<f64> {
        Arch::new().dispatch(Solution(self))
    }

    #[inline(always)]
    fn find_solution(&mut self) -> Vec<f64> {
        let mut factor = std::mem::take(&mut self.factor);
        for k in factor.size()..self.order.len() {
            let row = self.order[k];
            let square = 1.0 + RIDGE + self.soft[row];
            factor.push(self.order[..k].iter().map(|&j| self.entry(row, j)), square, DEPENDENT);
        }
        let mut x: Vec<f64> = self.order.iter().map(|&i| self.excess[i]).collect();
        factor.solve(&mut x);
        self.factor = factor;
        let mut m = vec![0.0; self.len()];
        for (&i, x) in self.order.iter().zip(&x) {
            m[i] = *x;
        }
        m
    }

    /// `K m - c`.
    fn gradient(&self, out: &mut Vec<f64>) {
        Arch::new().dispatch(Gradient(self, out));
    }

    #[inline(always)]
    fn find_gradient(&self, out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.excess.iter().map(|c| -c));
        for i in 0..self.len() {
            let row = &self.packed[start(i)..start(i + 1)];
            let m = self.m[i];
            out[i] += dot(&row[..i], &self.m[..i]) + m * (1.0 + self.soft[i]);
            if m != 0.0 {
                for (o, k) in out[..i].iter_mut().zip(row) {
                    *o += k * m;
                }
            }
        }
    }

    /// `1/2 m^T K m`, slack included.
    pub(super) fn energy(&self) -> f64 {
        let mut g = Vec::new();
        self.gradient(&mut g);
        0.5 * self.m.iter().zip(g.iter().zip(&self.excess)).map(|(m, (g, c))| m * (g + c)).sum::<f64>()
    }
}

/// Task of `solution` for the widest available SIMD registers.
struct Solution<'a>(&'a mut Dual);

impl WithSimd for Solution<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        self.0.find_solution()
    }
}

/// Task of `gradient` for the widest available SIMD registers.
struct Gradient<'a>(&'a Dual, &'a mut Vec<f64>);

impl WithSimd for Gradient<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.0.find_gradient(self.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multipliers_and_gradients_are_complementary() {
        let n = 30;
        let k = |i: usize, j: usize| (-(i.abs_diff(j) as f64) * 0.05).exp() * (1.0 + 0.1 * (i * j % 3) as f64).sqrt();
        let k = |i: usize, j: usize| if i == j { 1.2 } else { k(i.min(j), i.max(j)) * 0.9 };
        let c = |i: usize| ((i * 7919) % 13) as f64 - 6.0;
        let mut dual = Dual::default();
        for i in 0..n {
            dual.push(&(0..=i).map(|j| k(i, j)).collect::<Vec<_>>(), 0.0, c(i), 0.0);
        }
        assert!(dual.solve(1e-9, &|| true));
        let mut active = 0;
        for i in 0..n {
            let m = dual.multiplier(i);
            let g: f64 = (0..n).map(|j| k(i, j) * dual.multiplier(j)).sum::<f64>() - c(i);
            active += usize::from(m > 0.0);
            assert!(m >= 0.0 && g > -1e-6 && (m * g).abs() < 1e-6, "row {i}: m {m}, gradient {g}");
        }
        assert!(active > 2 && active < n, "{active}");
    }
}
