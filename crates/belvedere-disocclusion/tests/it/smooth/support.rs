//! Dense references and reproducible numbers.

/// Symmetric positive definite matrix, row-major.
pub(super) struct Dense {
    pub(super) n: usize,
    pub(super) a: Vec<f64>,
}

impl Dense {
    pub(super) fn identity(n: usize, scale: f64) -> Self {
        let mut a = vec![0.0; n * n];
        (0..n).for_each(|i| a[i * n + i] = scale);
        Self { n, a }
    }

    /// Adds `weight` v v^T.
    pub(super) fn add_outer(&mut self, v: &[f64], weight: f64) {
        let used: Vec<usize> = (0..self.n).filter(|i| v[*i] != 0.0).collect();
        for &i in &used {
            for &j in &used {
                self.a[i * self.n + j] += weight * v[i] * v[j];
            }
        }
    }

    /// Solution by Cholesky factorisation.
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut l = self.a.clone();
        for j in 0..n {
            for i in j..n {
                let s: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
                let v = self.a[i * n + j] - s;
                l[i * n + j] = if i == j { v.sqrt() } else { v / l[j * n + j] };
            }
        }
        let mut x = b.to_vec();
        for i in 0..n {
            let s: f64 = (0..i).map(|k| l[i * n + k] * x[k]).sum();
            x[i] = (x[i] - s) / l[i * n + i];
        }
        for i in (0..n).rev() {
            let s: f64 = (i + 1..n).map(|k| l[k * n + i] * x[k]).sum();
            x[i] = (x[i] - s) / l[i * n + i];
        }
        x
    }
}

/// Rows of the five-point Laplacian with mirrored borders, written down from its definition.
pub(super) fn laplacian_rows(cols: usize, rows: usize) -> Vec<Vec<f64>> {
    let n = cols * rows;
    (0..n)
        .map(|i| {
            let (x, y) = ((i % cols) as i64, (i / cols) as i64);
            let mut row = vec![0.0; n];
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let (u, v) = (x + dx, y + dy);
                if (0..cols as i64).contains(&u) && (0..rows as i64).contains(&v) {
                    row[(v * cols as i64 + u) as usize] += 1.0;
                    row[i] -= 1.0;
                }
            }
            row
        })
        .collect()
}

/// H written down from its definition.
pub(super) fn dense_h(cols: usize, rows: usize, shift: f64) -> Dense {
    let mut h = Dense::identity(cols * rows, shift);
    laplacian_rows(cols, rows).iter().for_each(|row| h.add_outer(row, 1.0));
    h
}

/// `n` numbers in -1..1.
pub(super) fn numbers(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
    (0..n)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}

/// Largest absolute difference.
pub(super) fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
