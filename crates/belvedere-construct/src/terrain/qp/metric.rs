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
    basis: [Vec<f64>; 2],
    inverse: Vec<f64>,
    green: Vec<f64>,
    scratch: Vec<f64>,
}

impl Metric {
    /// * `weight`: w^2 + g^2 > 0.
    pub(super) fn new(cols: usize, rows: usize, weight: f64) -> Self {
        let basis = [cosines(cols), cosines(rows)];
        let eigen = |n: usize| -> Vec<f64> { (0..n).map(|k| 2.0 * (PI * k as f64 / n as f64).cos() - 2.0).collect() };
        let (ex, ey) = (eigen(cols), eigen(rows));
        let inverse =
            ey.iter().flat_map(|y| ex.iter().map(move |x| 1.0 / ((x + y) * (x + y) + weight))).collect::<Vec<_>>();
        let green = green(cols, rows, weight);
        Self { cols, rows, basis, inverse, green, scratch: vec![0.0; cols * rows] }
    }

    /// `H^-1 v` in place.
    pub(super) fn solve(&mut self, v: &mut [f64]) {
        let [bx, by] = &self.basis;
        let (c, r) = (self.cols, self.rows);
        multiply(by, v, &mut self.scratch, [r, r, c]);
        multiply_transposed(&self.scratch, bx, v, [r, c, c]);
        for (v, g) in v.iter_mut().zip(&self.inverse) {
            *v *= g;
        }
        multiply_left_transposed(by, v, &mut self.scratch, [r, r, c]);
        multiply(&self.scratch, bx, v, [r, c, c]);
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

/// Orthonormal DCT-II, row-major: row = frequency.
fn cosines(n: usize) -> Vec<f64> {
    let entry = |k: usize, i: usize| {
        let scale = if k == 0 { (1.0 / n as f64).sqrt() } else { (2.0 / n as f64).sqrt() };
        scale * (PI * k as f64 * (i as f64 + 0.5) / n as f64).cos()
    };
    (0..n).flat_map(|k| (0..n).map(move |i| entry(k, i))).collect()
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
        let row = &mut out[i * p..(i + 1) * p];
        row.fill(0.0);
        for (k, &f) in a[i * m..(i + 1) * m].iter().enumerate() {
            for (o, v) in row.iter_mut().zip(&b[k * p..(k + 1) * p]) {
                *o += f * v;
            }
        }
    }
}

/// `out = a^T b` with a: m x n, b: m x p.
fn multiply_left_transposed(a: &[f64], b: &[f64], out: &mut [f64], [n, m, p]: [usize; 3]) {
    for i in 0..n {
        let row = &mut out[i * p..(i + 1) * p];
        row.fill(0.0);
        for k in 0..m {
            let f = a[k * n + i];
            for (o, v) in row.iter_mut().zip(&b[k * p..(k + 1) * p]) {
                *o += f * v;
            }
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
