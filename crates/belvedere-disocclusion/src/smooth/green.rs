//! Entries of H^-1 from one table.

use super::smoother::Smoother;

/// Green's function of H on the mirrored grid. The grid and its mirror images make a periodic plane on which H^-1 is a
/// convolution; an entry is the sum of one kernel over the four images of a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Green {
    cols: usize,
    rows: usize,
    /// For x in 0..=cols a line over y from -rows to 2 rows (the kernel is even and has the period 2 rows), and two more.
    kernel: Vec<f64>,
}

/// A point between nodes: the first node of its cell, and how far into the cell it lies along x and y, 0..=1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Between {
    /// Column of the cell, <= columns - 2 if there are two columns or more.
    pub col: u32,
    /// Row of the cell.
    pub row: u32,
    /// Part of the cell to the west of the point.
    pub x: f64,
    /// Part of the cell to the north of the point.
    pub y: f64,
}

impl Between {
    /// A node of a grid of `cols` x `rows`.
    pub fn node(node: u32, cols: usize, rows: usize) -> Self {
        let (col, row) = (node as usize % cols, node as usize / cols);
        let inside = |i: usize, n: usize| if n > 1 && i + 1 == n { (i - 1, 1.0) } else { (i, 0.0) };
        let ((col, x), (row, y)) = (inside(col, cols), inside(row, rows));
        Self { col: col as u32, row: row as u32, x, y }
    }
}

impl Green {
    /// Tabulates the kernel: `(cols + 1) (3 rows + 3)` values, O(n^3) work; meant for the solver's coarse grid.
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
        let folded = |y: usize| y.abs_diff(rows).min((3 * rows).abs_diff(y)).min(rows);
        let kernel = kernel.chunks_exact(rows + 1).flat_map(|k| (0..3 * rows + 3).map(move |y| k[folded(y)])).collect();
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
        let k = |x: usize, y: usize| self.kernel[x * (3 * rows + 3) + rows + y];
        k(x0, y0) + k(x0, y1) + k(x1, y0) + k(x1, y1)
    }

    /// H^-1 between the bilinear values at two points: sixteen entries, gathered by distance into 36 look-ups.
    #[inline(always)]
    pub fn between(&self, a: Between, b: Between) -> f64 {
        let (across, wx) = images([a.col, b.col], [a.x, b.x], self.cols);
        let hats = hats(a.y, b.y);
        // Lines are read in fours; the fourth counts nothing.
        let length = 3 * self.rows + 3;
        let (direct, mirrored) =
            ((self.rows + a.row as usize) - b.row as usize - 1, self.rows + (a.row + b.row + 1) as usize);
        let (mut near, mut far) = ([0.0; 4], [0.0; 4]);
        for (x, wx) in across.into_iter().zip(wx) {
            let line = &self.kernel[x * length..(x + 1) * length];
            let (n, f) = (&line[direct..direct + 4], &line[mirrored..mirrored + 4]);
            for k in 0..4 {
                near[k] += wx * n[k];
                far[k] += wx * f[k];
            }
        }
        (0..3).map(|k| hats[k] * near[k] + hats[k + 3] * far[k]).sum()
    }
}

/// Distances between two points along an axis of `n` nodes, direct and mirrored, with the weights of two linear hats.
#[inline(always)]
fn images([c, d]: [u32; 2], [a, b]: [f64; 2], n: usize) -> ([usize; 6], [f64; 6]) {
    let (c, d, n) = (i64::from(c), i64::from(d), n as i64);
    let fold = |s: i64| s.min(2 * n - s).max(0) as usize;
    let away = |s: i64| s.unsigned_abs() as usize;
    let (apart, sum) = (c - d, c + d + 1);
    ([away(apart - 1), away(apart), away(apart + 1), fold(sum), fold(sum + 1), fold(sum + 2)], hats(a, b))
}

/// Weights of two linear hats by the distance of their nodes, direct and mirrored.
#[inline(always)]
fn hats(a: f64, b: f64) -> [f64; 6] {
    [
        (1.0 - a) * b,
        (1.0 - a) * (1.0 - b) + a * b,
        a * (1.0 - b),
        (1.0 - a) * (1.0 - b),
        (1.0 - a) * b + a * (1.0 - b),
        a * b,
    ]
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
