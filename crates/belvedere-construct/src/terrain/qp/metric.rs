//! The norm in which displacements are measured, and its Green's function.

use std::f64::consts::PI;

/// `H = L^2 + weight I` on a grid of nodes, L the five-point Laplacian with mirrored border.
///
/// H is diagonal under the orthonormal DCT-II. Its inverse is a sum of four mirror images of the Green's function of the
/// periodic grid of twice the size, so an entry costs four look-ups and no solve.
#[derive(Debug, Clone)]
pub(super) struct Metric {
    cols: usize,
    rows: usize,
    basis: [Cosines; 2],
    inverse: Vec<f64>,
    green: Vec<f64>,
    scratch: Vec<f64>,
}

impl Metric {
    /// * `weight`: w^2 + g^2 > 0.
    pub(super) fn new(cols: usize, rows: usize, weight: f64) -> Self {
        let basis = [Cosines::new(cols), Cosines::new(rows)];
        // Even frequencies first, as the transforms leave them; columns slow.
        let eigen = |n: usize| -> Vec<f64> {
            let order = (0..n).step_by(2).chain((1..n).step_by(2));
            order.map(|k| 2.0 * (PI * k as f64 / n as f64).cos() - 2.0).collect()
        };
        let (ex, ey) = (eigen(cols), eigen(rows));
        let inverse =
            ex.iter().flat_map(|x| ey.iter().map(move |y| 1.0 / ((x + y) * (x + y) + weight))).collect::<Vec<_>>();
        let green = green(cols, rows, weight);
        Self { cols, rows, basis, inverse, green, scratch: vec![0.0; cols * rows] }
    }

    /// `H^-1 v` in place.
    pub(super) fn solve(&mut self, v: &mut [f64]) {
        let [across, down] = &self.basis;
        let (c, r) = (self.cols, self.rows);
        down.forward(v, &mut self.scratch, c);
        transpose(&self.scratch, v, [r, c]);
        across.forward(v, &mut self.scratch, r);
        for (v, g) in self.scratch.iter_mut().zip(&self.inverse) {
            *v *= g;
        }
        across.back(&mut self.scratch, v, r);
        transpose(v, &mut self.scratch, [c, r]);
        down.back(&mut self.scratch, v, c);
    }

    /// Entry (a, b) of the inverse of H; `a` and `b` are node indices.
    pub(super) fn inverse_entry(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (a as usize, b as usize);
        let (xa, ya, xb, yb) = (a % self.cols, a / self.cols, b % self.cols, b / self.cols);
        let (dx, dy) = (xa.abs_diff(xb), ya.abs_diff(yb));
        let fold = |s: usize, n: usize| if s > n { 2 * n - s } else { s };
        let (sx, sy) = (fold(xa + xb + 1, self.cols), fold(ya + yb + 1, self.rows));
        let width = self.cols + 1;
        let at = |x: usize, y: usize| self.green[y * width + x];
        at(dx, dy) + at(sx, dy) + at(dx, sy) + at(sx, sy)
    }
}

/// Orthonormal DCT-II of the columns of n x p matrices. Even frequencies see the sum of mirrored rows, odd ones the
/// difference: two products of half the size.
#[derive(Debug, Clone)]
struct Cosines {
    n: usize,
    /// Even, odd: frequencies x rows, and its transpose.
    parts: [Vec<f64>; 2],
    back: [Vec<f64>; 2],
}

impl Cosines {
    fn new(n: usize) -> Self {
        let half = n.div_ceil(2);
        let entry = |k: usize, i: usize| {
            let scale = if k == 0 { (1.0 / n as f64).sqrt() } else { (2.0 / n as f64).sqrt() };
            scale * (PI * k as f64 * (i as f64 + 0.5) / n as f64).cos()
        };
        let count = [half, n / 2];
        let parts = [0, 1].map(|odd| {
            (0..count[odd]).flat_map(|k| (0..half).map(move |i| entry(2 * k + odd, i))).collect::<Vec<f64>>()
        });
        let back = [0, 1].map(|odd| {
            (0..half).flat_map(|i| (0..count[odd]).map(move |k| entry(2 * k + odd, i))).collect::<Vec<f64>>()
        });
        Self { n, parts, back }
    }

    /// Spectrum of `v` into `out`, even frequencies first; `v` is used up.
    fn forward(&self, v: &mut [f64], out: &mut [f64], p: usize) {
        let (n, half, pairs) = (self.n, self.n.div_ceil(2), self.n / 2);
        let (top, bottom) = v.split_at_mut(half * p);
        let even = &mut out[..half * p];
        // The sums replace the upper rows, the differences the lower ones, nearest pair last.
        for i in 0..pairs {
            let a = &mut top[i * p..(i + 1) * p];
            let b = &mut bottom[(pairs - 1 - i) * p..(pairs - i) * p];
            for (a, b) in a.iter_mut().zip(b) {
                (*a, *b) = (*a + *b, *a - *b);
            }
        }
        multiply(&self.parts[0], top, even, [half, half, p]);
        let differences = &bottom[..pairs * p];
        for k in 0..pairs {
            let weights: Vec<f64> = (0..pairs).rev().map(|i| self.parts[1][k * half + i]).collect();
            combine(&weights, differences, &mut out[(half + k) * p..(half + k + 1) * p], [pairs, p]);
        }
        debug_assert_eq!(half + pairs, n);
    }

    /// Inverse of [`Self::forward`]; `spectrum` is used up.
    fn back(&self, spectrum: &mut [f64], out: &mut [f64], p: usize) {
        let (half, pairs) = (self.n.div_ceil(2), self.n / 2);
        let (even, odd) = spectrum.split_at(half * p);
        let (top, bottom) = out.split_at_mut(half * p);
        multiply(&self.back[0], even, top, [half, half, p]);
        for i in 0..pairs {
            let b = &mut bottom[(pairs - 1 - i) * p..(pairs - i) * p];
            combine(&self.back[1][i * pairs..(i + 1) * pairs], odd, b, [pairs, p]);
            for (a, b) in top[i * p..(i + 1) * p].iter_mut().zip(b) {
                (*a, *b) = (*a + *b, *a - *b);
            }
        }
    }
}

/// `out = a^T` with a: n x m.
fn transpose(a: &[f64], out: &mut [f64], [n, m]: [usize; 2]) {
    for i in 0..n {
        for j in 0..m {
            out[j * n + i] = a[i * m + j];
        }
    }
}

/// Green's function of the periodic grid of 2 cols x 2 rows nodes at offsets 0..=cols, 0..=rows.
fn green(cols: usize, rows: usize, weight: f64) -> Vec<f64> {
    let axis = |n: usize| -> Vec<f64> {
        let entry = |d: usize, k: usize| {
            let times = if k == 0 || k == n { 1.0 } else { 2.0 };
            times * (PI * ((k * d) % (2 * n)) as f64 / n as f64).cos() / (2 * n) as f64
        };
        (0..=n).flat_map(|d| (0..=n).map(move |k| entry(d, k))).collect()
    };
    let eigen = |k: usize, n: usize| 2.0 * (PI * k as f64 / n as f64).cos() - 2.0;
    let (nx, ny) = (cols + 1, rows + 1);
    let spectrum: Vec<f64> = (0..ny)
        .flat_map(|l| (0..nx).map(move |k| (eigen(k, cols) + eigen(l, rows)).powi(2)))
        .map(|e| 1.0 / (e + weight))
        .collect();
    let (mut half, mut out) = (vec![0.0; nx * ny], vec![0.0; nx * ny]);
    multiply(&axis(rows), &spectrum, &mut half, [ny, ny, nx]);
    multiply_transposed(&half, &axis(cols), &mut out, [ny, nx, nx]);
    out
}

/// `out = a b` with a: n x m, b: m x p.
fn multiply(a: &[f64], b: &[f64], out: &mut [f64], [n, m, p]: [usize; 3]) {
    for i in 0..n {
        combine(&a[i * m..(i + 1) * m], b, &mut out[i * p..(i + 1) * p], [m, p]);
    }
}

/// `out = sum over k of weights[k] b[k]` with b: m x p, four rows at a time.
#[inline]
fn combine(weights: &[f64], b: &[f64], out: &mut [f64], [m, p]: [usize; 2]) {
    out.fill(0.0);
    let fours = m / 4 * 4;
    for k in (0..fours).step_by(4) {
        let [w0, w1, w2, w3] = [weights[k], weights[k + 1], weights[k + 2], weights[k + 3]];
        let (b0, rest) = b[k * p..(k + 4) * p].split_at(p);
        let (b1, rest) = rest.split_at(p);
        let (b2, b3) = rest.split_at(p);
        for ((((o, x0), x1), x2), x3) in out.iter_mut().zip(b0).zip(b1).zip(b2).zip(b3) {
            *o += (w0 * x0 + w1 * x1) + (w2 * x2 + w3 * x3);
        }
    }
    for k in fours..m {
        for (o, x) in out.iter_mut().zip(&b[k * p..(k + 1) * p]) {
            *o += weights[k] * x;
        }
    }
}

/// `out = a b^T` with a: n x m, b: p x m.
fn multiply_transposed(a: &[f64], b: &[f64], out: &mut [f64], [n, m, p]: [usize; 3]) {
    for i in 0..n {
        for j in 0..p {
            out[i * p + j] = super::cholesky::dot(&a[i * m..(i + 1) * m], &b[j * m..(j + 1) * m]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_the_inverse_are_solutions_for_unit_loads() {
        let (cols, rows, weight) = (11, 7, 0.09);
        let mut metric = Metric::new(cols, rows, weight);
        for load in [0, 10, 38, 76, 33] {
            let mut v = vec![0.0; cols * rows];
            v[load] = 1.0;
            metric.solve(&mut v);
            for (i, x) in v.iter().enumerate() {
                let entry = metric.inverse_entry(load as u32, i as u32);
                assert!((entry - x).abs() < 1e-12, "({load}, {i}): {entry} and {x}");
            }
            let back = applied(&v, cols, rows, weight);
            for (i, b) in back.iter().enumerate() {
                assert!((b - f64::from(u8::from(i == load))).abs() < 1e-11, "load {load} at {i}: {b}");
            }
        }
    }

    /// `H v` by the stencil itself.
    fn applied(v: &[f64], cols: usize, rows: usize, weight: f64) -> Vec<f64> {
        let laplacian = |v: &[f64]| -> Vec<f64> {
            let at = |x: usize, y: usize| v[y * cols + x];
            let mut out = vec![0.0; v.len()];
            for y in 0..rows {
                for x in 0..cols {
                    let mut sum = 0.0;
                    for (dx, dy) in [(-1i32, 0i32), (1, 0), (0, -1), (0, 1)] {
                        let (nx, ny) = (x as i32 + dx, y as i32 + dy);
                        if nx >= 0 && ny >= 0 && nx < cols as i32 && ny < rows as i32 {
                            sum += at(nx as usize, ny as usize) - at(x, y);
                        }
                    }
                    out[y * cols + x] = sum;
                }
            }
            out
        };
        laplacian(&laplacian(v)).iter().zip(v).map(|(l, v)| l + weight * v).collect()
    }
}
