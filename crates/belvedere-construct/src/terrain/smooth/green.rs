//! Entries of H^-1 from one table.

use super::smoother::Smoother;

/// Green's function of H on the mirrored grid. The grid and its mirror images make a periodic plane on which H^-1 is a
/// convolution; an entry is the sum of one kernel over the four images of a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Green {
    cols: usize,
    rows: usize,
    kernel: Vec<f64>,
}

impl Green {
    /// Tabulates the kernel: `(cols + 1) (rows + 1)` values, O(n^3) work; meant for the solver's coarse grid.
    pub fn new(smoother: &Smoother) -> Self {
        let (cols, rows) = (smoother.cols(), smoother.rows());
        let (ex, ey) = smoother.eigenvalues();
        let shift = smoother.shift();
        let (cx, cy) = (cosines(cols), cosines(rows));
        // Over y for every column frequency p, then over x.
        let mut half = vec![0.0; cols * (rows + 1)];
        for (p, line) in half.chunks_exact_mut(rows + 1).enumerate() {
            for (q, cosine) in cy.chunks_exact(rows + 1).enumerate() {
                let e = ex[p] + ey[q];
                let gain = 1.0 / (e * e + shift);
                line.iter_mut().zip(cosine).for_each(|(o, c)| *o += gain * c);
            }
        }
        let mut kernel = vec![0.0; (cols + 1) * (rows + 1)];
        for (p, line) in half.chunks_exact(rows + 1).enumerate() {
            for (a, out) in kernel.chunks_exact_mut(rows + 1).enumerate() {
                let c = cx[p * (cols + 1) + a];
                out.iter_mut().zip(line).for_each(|(o, x)| *o += c * x);
            }
        }
        Self { cols, rows, kernel }
    }

    /// H^-1 between nodes `a` and `b` (row-major indices).
    #[inline]
    pub fn entry(&self, a: u32, b: u32) -> f64 {
        let (cols, rows) = (self.cols, self.rows);
        let (xa, ya) = (a as usize % cols, a as usize / cols);
        let (xb, yb) = (b as usize % cols, b as usize / cols);
        let mirrored = |a: usize, b: usize, n: usize| [a.abs_diff(b), (a + b + 1).min(2 * n - a - b - 1)];
        let [x0, x1] = mirrored(xa, xb, cols);
        let [y0, y1] = mirrored(ya, yb, rows);
        let k = |x: usize, y: usize| self.kernel[x * (rows + 1) + y];
        k(x0, y0) + k(x0, y1) + k(x1, y0) + k(x1, y1)
    }
}

/// `s_p^2 / 2 cos(pi p a / n)` for p in 0..n (slow) and a in 0..=n; s_0^2 = 1/n, else 2/n.
fn cosines(n: usize) -> Vec<f64> {
    let cosine = |p: usize, a: usize| {
        let phase = (p * a) % (2 * n);
        (std::f64::consts::PI * phase as f64 / n as f64).cos()
    };
    let scale = |p: usize| if p == 0 { 0.5 } else { 1.0 } / n as f64;
    (0..n).flat_map(|p| (0..=n).map(move |a| scale(p) * cosine(p, a))).collect()
}
