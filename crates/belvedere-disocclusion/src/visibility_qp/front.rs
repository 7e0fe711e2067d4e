//! A dense symmetric matrix of which the first unknowns are eliminated.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Columns of a product that are summed together.
const LANES: usize = 8;
/// Columns that are eliminated at a time.
const BLOCK: usize = 16;
/// Rows of a product that are summed together.
const TILE: usize = 4;
/// Rows from which on they are shared among threads.
const SHARED_ROWS: usize = 192;
/// A pivot below this share of its diagonal counts as dependent.
const DEPENDENT: f64 = 1e-13;

/// Columns of the factor for the unknowns of a part, its rows being these unknowns and those of the border.
#[derive(Debug, Clone)]
pub(super) struct Front {
    own: usize,
    border: usize,
    columns: Vec<f64>,
    /// What is left for the border, lower triangle of a square.
    left: Vec<f64>,
}

impl Front {
    pub(super) fn new(own: usize, border: usize) -> Self {
        Self { own, border, columns: vec![0.0; (own + border) * own], left: vec![0.0; border * border] }
    }

    /// Adds to an entry, row >= column.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        if column < self.own {
            self.columns[row * self.own + column] += value;
        } else {
            self.left[(row - self.own) * self.border + column - self.own] += value;
        }
    }

    /// Adds what a part below leaves.
    ///
    /// * `places`: the rows and columns here of its border, ascending.
    pub(super) fn take_over(&mut self, left: &[f64], places: &[usize]) {
        for (i, row) in left.chunks_exact(places.len().max(1)).enumerate() {
            for (value, column) in row[..=i].iter().zip(places) {
                self.add(places[i], *column, *value);
            }
        }
    }

    /// Eliminates the own unknowns; returns what is left for the border.
    pub(super) fn eliminate(&mut self) -> Vec<f64> {
        let own = self.own;
        let diagonal: Vec<f64> = (0..own).map(|i| self.columns[i * own + i]).collect();
        for from in (0..own).step_by(BLOCK) {
            let to = (from + BLOCK).min(own);
            // The rows of the block itself come first, for all others need them.
            let (upper, lower) = self.columns.split_at_mut(to * own);
            let rows = &mut upper[from * own..];
            let mut block = Block::of(rows, own, [from, to]);
            Arch::new().dispatch(FactorBlock { block: &mut block, rows, diagonal: &diagonal });
            let work = |rows: &mut [f64]| Arch::new().dispatch(FollowBlock { block: &block, rows });
            if lower.len() / own >= SHARED_ROWS {
                lower.par_chunks_mut(16 * TILE * own).for_each(work);
            } else {
                work(lower);
            }
        }
        let mut left = std::mem::take(&mut self.left);
        let (below, border) = (&self.columns[own * own..], self.border);
        let packed = packed::<LANES>(below, own, own);
        let work = |(k, left): (usize, &mut [f64])| {
            Arch::new().dispatch(SubtractProducts { left, first: k * TILE, below, packed: &packed, own });
        };
        if border >= SHARED_ROWS {
            left.par_chunks_mut(TILE * border).enumerate().for_each(work);
        } else if border > 0 {
            left.chunks_mut(TILE * border).enumerate().for_each(work);
        }
        left
    }

    /// Forward substitution.
    pub(super) fn forward(&self, x: &mut [f64], first: usize, border: &[u32]) {
        for i in 0..self.own {
            let row = &self.columns[i * self.own..][..=i];
            let sum: f64 = row[..i].iter().zip(&x[first..]).map(|(l, x)| l * x).sum();
            x[first + i] = (x[first + i] - sum) / row[i];
        }
        let own = x[first..first + self.own].to_vec();
        for (i, place) in border.iter().enumerate() {
            let row = &self.columns[(self.own + i) * self.own..][..self.own];
            x[*place as usize] -= super::cholesky::dot(row, &own);
        }
    }

    /// Back substitution.
    pub(super) fn backward(&self, x: &mut [f64], first: usize, border: &[u32]) {
        let mut own = x[first..first + self.own].to_vec();
        for (i, place) in border.iter().enumerate() {
            let (row, value) = (&self.columns[(self.own + i) * self.own..][..self.own], x[*place as usize]);
            own.iter_mut().zip(row).for_each(|(own, l)| *own -= l * value);
        }
        for i in (0..self.own).rev() {
            let row = &self.columns[i * self.own..][..=i];
            own[i] /= row[i];
            let value = own[i];
            own[..i].iter_mut().zip(row).for_each(|(own, l)| *own -= l * value);
        }
        x[first..first + self.own].copy_from_slice(&own);
    }
}

/// The first `length` columns of rows, as lines of `N` rows side by side for each column; lines are padded with zeros.
fn packed<const N: usize>(rows: &[f64], stride: usize, length: usize) -> Vec<[f64; N]> {
    let count = rows.len() / stride.max(1);
    let mut out = vec![[0.0; N]; count.div_ceil(N) * length];
    for i in 0..count {
        for (column, value) in rows[i * stride..][..length].iter().enumerate() {
            out[i / N * length + column][i % N] = *value;
        }
    }
    out
}

/// Four rows from `first` on; the last one stands in for those beyond.
#[inline(always)]
fn rows_of(values: &[f64], stride: usize, first: usize) -> [&[f64]; TILE] {
    let count = values.len() / stride;
    let mut out = [&values[..0]; TILE];
    for k in 0..TILE {
        out[k] = &values[(first + k).min(count - 1) * stride..][..stride];
    }
    out
}

/// Sums of products of rows with packed lines, column by column.
#[inline(always)]
fn products<const N: usize>(rows: [&[f64]; TILE], lines: &[[f64; N]]) -> [[f64; N]; TILE] {
    let rows = rows.map(|row| &row[..lines.len()]);
    let mut sums = [[0.0; N]; TILE];
    for (column, line) in lines.iter().enumerate() {
        for i in 0..TILE {
            for lane in 0..N {
                sums[i][lane] += rows[i][column] * line[lane];
            }
        }
    }
    sums
}

/// Task that subtracts from rows of what is left, from `first` on, the products of the rows of the border.
struct SubtractProducts<'a> {
    left: &'a mut [f64],
    first: usize,
    below: &'a [f64],
    packed: &'a [[f64; LANES]],
    own: usize,
}

impl WithSimd for SubtractProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { left, first, below, packed, own } = self;
        if own == 0 {
            return;
        }
        let border = below.len() / own;
        let rows = rows_of(below, own, first);
        for (k, lines) in packed.chunks_exact(own).enumerate().take((first + TILE).div_ceil(LANES)) {
            let sums = products(rows, lines);
            for (row, sums) in left.chunks_exact_mut(border).zip(&sums) {
                row[k * LANES..].iter_mut().zip(sums).for_each(|(left, sum)| *left -= sum);
            }
        }
    }
}

/// Task that factors the rows of a block.
struct FactorBlock<'a> {
    block: &'a mut Block,
    rows: &'a mut [f64],
    diagonal: &'a [f64],
}

impl WithSimd for FactorBlock<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.block.factor(self.rows, self.diagonal);
    }
}

/// Task that eliminates the columns of a block from the rows below it.
struct FollowBlock<'a> {
    block: &'a Block,
    rows: &'a mut [f64],
}

impl WithSimd for FollowBlock<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.block.follow(self.rows);
    }
}

/// Some columns that are eliminated together.
struct Block {
    stride: usize,
    from: usize,
    to: usize,
    /// The rows of the block, over the columns before it.
    before: Vec<[f64; BLOCK]>,
    /// Its own triangle, column by column.
    triangle: [[f64; BLOCK]; BLOCK],
}

impl Block {
    fn of(rows: &[f64], stride: usize, [from, to]: [usize; 2]) -> Self {
        Self { stride, from, to, before: packed(rows, stride, from), triangle: [[0.0; BLOCK]; BLOCK] }
    }

    /// Four rows of the block's columns less the products of the columns before.
    #[inline(always)]
    fn reduced(&self, rows: &[f64], first: usize) -> [[f64; BLOCK]; TILE] {
        let rows = rows_of(rows, self.stride, first);
        let sums = products(rows, &self.before);
        let mut out = [[0.0; BLOCK]; TILE];
        for i in 0..TILE {
            for j in 0..self.to - self.from {
                out[i][j] = rows[i][self.from + j] - sums[i][j];
            }
        }
        out
    }

    /// Factors the rows of the block itself.
    #[inline(always)]
    fn factor(&mut self, rows: &mut [f64], diagonal: &[f64]) {
        let count = self.to - self.from;
        for first in (0..count).step_by(TILE) {
            let mut reduced = self.reduced(rows, first);
            for (i, row) in (first..count).zip(&mut reduced) {
                for j in 0..i {
                    row[j] /= self.triangle[j][j];
                    let value = row[j];
                    for (x, t) in row[j + 1..i].iter_mut().zip(&self.triangle[j][j + 1..i]) {
                        *x -= value * t;
                    }
                    row[i] -= value * value;
                }
                row[i] = row[i].max(DEPENDENT * diagonal[self.from + i]).sqrt();
                for j in 0..=i {
                    self.triangle[j][i] = row[j];
                    rows[i * self.stride + self.from + j] = row[j];
                }
            }
        }
    }

    /// The same for rows below it.
    #[inline(always)]
    fn follow(&self, rows: &mut [f64]) {
        let (count, width) = (rows.len() / self.stride, self.to - self.from);
        for first in (0..count).step_by(TILE) {
            let mut reduced = self.reduced(rows, first);
            for j in 0..width {
                for row in &mut reduced {
                    row[j] /= self.triangle[j][j];
                    let value = row[j];
                    // Columns up to j get nothing, for the triangle is 0 there.
                    let mut line = self.triangle[j];
                    line[j] = 0.0;
                    for k in 0..BLOCK {
                        row[k] -= value * line[k];
                    }
                }
            }
            for (row, reduced) in rows[first * self.stride..].chunks_exact_mut(self.stride).zip(&reduced) {
                row[self.from..self.to].copy_from_slice(&reduced[..width]);
            }
        }
    }
}
