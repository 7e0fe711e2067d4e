//! Conjugate gradients on H + W^T W, preconditioned by H.

use super::elevation::ElevationRows;
use super::smoother::Smoother;

/// Iterations and residual of a solution.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Convergence {
    /// Iterations, each with one solve with H.
    pub iterations: usize,
    /// Norm of the residual over that of the right-hand side.
    pub residual: f64,
}

/// Conjugate gradients for `(H + W^T W) x = b`. H^-1 is the preconditioner, so that H times a search direction is known
/// without the stencil: H H^-1 r = r. Keeps its buffers.
#[derive(Debug, Clone, Default)]
pub struct ConjugateGradients {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    hp: Vec<f64>,
    ap: Vec<f64>,
}

impl ConjugateGradients {
    /// * `x`: first guess in, solution out.
    ///
    /// Stops at a residual of `tolerance` times the norm of `b`, or after `limit` iterations.
    ///
    /// # Panics
    /// If `b` or `x` has another size than the grid.
    pub fn solve(
        &mut self,
        smoother: &mut Smoother,
        rows: &ElevationRows,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        limit: usize,
    ) -> Convergence {
        let n = b.len();
        for buffer in [&mut self.r, &mut self.z, &mut self.p, &mut self.hp, &mut self.ap] {
            buffer.resize(n, 0.0);
        }
        let goal = tolerance * dot(b, b).sqrt();
        if goal == 0.0 {
            x.fill(0.0);
            return Convergence { iterations: 0, residual: 0.0 };
        }
        if x.iter().any(|v| *v != 0.0) {
            smoother.apply(x, &mut self.z, &mut self.ap);
            rows.add_normal(x, &mut self.ap);
            self.r.iter_mut().zip(b).zip(&self.ap).for_each(|((r, b), a)| *r = b - a);
        } else {
            self.r.copy_from_slice(b);
        }
        let mut size = dot(&self.r, &self.r).sqrt();
        let mut energy = 0.0;
        let mut iterations = 0;
        while size > goal && iterations < limit {
            self.z.copy_from_slice(&self.r);
            smoother.solve(&mut self.z);
            let next = dot(&self.r, &self.z);
            let beta = if iterations == 0 { 0.0 } else { next / energy };
            energy = next;
            for (((p, hp), z), r) in self.p.iter_mut().zip(&mut self.hp).zip(&self.z).zip(&self.r) {
                (*p, *hp) = (z + beta * *p, r + beta * *hp);
            }
            self.ap.copy_from_slice(&self.hp);
            rows.add_normal(&self.p, &mut self.ap);
            let alpha = energy / dot(&self.p, &self.ap);
            for (((x, r), p), ap) in x.iter_mut().zip(&mut self.r).zip(&self.p).zip(&self.ap) {
                *x += alpha * p;
                *r -= alpha * ap;
            }
            size = dot(&self.r, &self.r).sqrt();
            iterations += 1;
        }
        Convergence { iterations, residual: size * tolerance / goal }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Eight sums, so that the additions need not wait for each other.
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a8.zip(b8) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}
