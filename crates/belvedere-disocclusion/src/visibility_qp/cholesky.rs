//! Cholesky factor of a growing and shrinking set of rows.

/// Lower factor of a symmetric positive definite matrix, packed by rows: row i holds i + 1 entries.
#[derive(Debug, Clone, Default)]
pub(super) struct Cholesky {
    packed: Vec<f64>,
    size: usize,
}

/// Sum of products in eight lanes, always in the same order.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0f64; 8];
    let (wide_a, rest_a) = a.as_chunks::<8>();
    let (wide_b, rest_b) = b[..a.len()].as_chunks::<8>();
    for (x, y) in wide_a.iter().zip(wide_b) {
        for k in 0..8 {
            lanes[k] += x[k] * y[k];
        }
    }
    for half in [4, 2, 1] {
        for k in 0..half {
            lanes[k] += lanes[k + half];
        }
    }
    lanes[0] + rest_a.iter().zip(rest_b).map(|(x, y)| x * y).sum::<f64>()
}

fn start(row: usize) -> usize {
    row * (row + 1) / 2
}

impl Cholesky {
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Keeps the factor of the first `size` rows.
    pub(super) fn truncate(&mut self, size: usize) {
        if size < self.size {
            self.size = size;
            self.packed.truncate(start(size));
        }
    }

    /// Drops row `k`: its column is turned into the ones behind it, by one plane rotation each. O((size - k)^2).
    pub(super) fn remove(&mut self, k: usize) {
        let mut rotations: Vec<(f64, f64)> = Vec::with_capacity(self.size - k);
        for i in k + 1..self.size {
            let (from, to) = (start(i), start(i - 1));
            let mut x = self.packed[from + k];
            self.packed.copy_within(from..from + k, to);
            self.packed.copy_within(from + k + 1..from + i + 1, to + k);
            let rest = &mut self.packed[to + k..to + i];
            for (l, (c, s)) in rest.iter_mut().zip(&rotations) {
                (*l, x) = (c * *l + s * x, c * x - s * *l);
            }
            let diagonal = &mut rest[i - k - 1];
            let length = diagonal.hypot(x);
            rotations.push((*diagonal / length, x / length));
            *diagonal = length;
        }
        self.size -= 1;
        self.packed.truncate(start(self.size));
    }

    /// Appends a row: its products with the rows already there, then its own square. A pivot at or below `floor` times
    /// that square (the row depends on the others) is set to it.
    #[inline(always)]
    pub(super) fn push(&mut self, products: impl Iterator<Item = f64>, square: f64, floor: f64) {
        let (n, first) = (self.size, self.packed.len());
        self.packed.extend(products);
        self.packed.push(square);
        let (done, row) = self.packed.split_at_mut(first);
        for j in 0..n {
            let above = &done[start(j)..start(j + 1)];
            row[j] = (row[j] - dot(&above[..j], &row[..j])) / above[j];
        }
        let pivot = square - dot(&row[..n], &row[..n]);
        row[n] = pivot.max(floor * square).sqrt();
        self.size += 1;
    }

    /// Solves `L x = b` in place.
    #[inline(always)]
    pub(super) fn forward(&self, b: &mut [f64]) {
        for i in 0..self.size {
            let row = &self.packed[start(i)..start(i + 1)];
            b[i] = (b[i] - dot(&row[..i], &b[..i])) / row[i];
        }
    }

    /// Solves `L L^T x = b` in place.
    #[inline(always)]
    pub(super) fn solve(&self, b: &mut [f64]) {
        self.forward(b);
        for i in (0..self.size).rev() {
            let row = &self.packed[start(i)..start(i + 1)];
            let x = b[i] / row[i];
            b[i] = x;
            for (b, l) in b[..i].iter_mut().zip(row) {
                *b -= l * x;
            }
        }
    }
}

#[cfg(test)]
mod tests;
