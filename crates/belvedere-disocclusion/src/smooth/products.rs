//! Solves on small grids by matrix products.
//!
//! A cosine transform of 129 values costs a Fourier transform more than twice what 128 would cost. As a product with a
//! matrix of cosines, halved by symmetry, it runs at the speed of the multipliers, and nothing is reordered or turned.

use std::f64::consts::PI;

use pulp::{Arch, Simd, WithSimd};

use super::cosine::eigenvalue;

/// Rows are padded to this many values, a multiple of every machine's registers.
const PAD: usize = 8;
/// Beyond this many nodes along a side, Fourier transforms are faster.
pub(super) const MOST: usize = 192;

/// `H^-1` of a grid of at most [`MOST`] nodes along each side; keeps its buffers.
///
/// A grid is held as sums and differences of mirrored values, along both axes: even frequencies see only sums, odd ones
/// only differences.
#[derive(Debug, Clone)]
pub(super) struct Products {
    across: Axis,
    down: Axis,
    a: Vec<f64>,
    b: Vec<f64>,
}

/// Orthonormal DCT-II of n values in two halves, 0 = even frequencies, 1 = odd ones.
#[derive(Debug, Clone)]
struct Axis {
    n: usize,
    count: [usize; 2],
    /// `count` padded: the width of the halves of a row.
    room: [usize; 2],
    /// Frequencies x samples.
    cosines: [Vec<f64>; 2],
    /// Samples x frequencies.
    turned: [Vec<f64>; 2],
    /// Eigenvalues of the Laplacian; 0 in the padding.
    eigenvalues: [Vec<f64>; 2],
}

impl Axis {
    fn new(n: usize) -> Self {
        let count = [n.div_ceil(2), n / 2];
        let room = count.map(|c| c.next_multiple_of(PAD));
        let entry = |k: usize, i: usize| {
            let scale = (if k == 0 { 1.0 } else { 2.0 } / n as f64).sqrt();
            scale * (PI * ((k * (2 * i + 1)) % (4 * n)) as f64 / (2 * n) as f64).cos()
        };
        let table = |odd: usize, at: &dyn Fn(usize, usize) -> f64| {
            let (count, room) = (count[odd], room[odd]);
            let cell = |p: usize| if p % room < count { at(p / room, p % room) } else { 0.0 };
            (0..count * room).map(cell).collect::<Vec<f64>>()
        };
        Self {
            n,
            count,
            room,
            cosines: [0, 1].map(|odd| table(odd, &|k, i| entry(2 * k + odd, i))),
            turned: [0, 1].map(|odd| table(odd, &|i, k| entry(2 * k + odd, i))),
            eigenvalues: [0, 1].map(|odd| {
                let e = |k| if k < count[odd] { eigenvalue(2 * k + odd, n) } else { 0.0 };
                (0..room[odd]).map(e).collect()
            }),
        }
    }

    fn width(&self) -> usize {
        self.room[0] + self.room[1]
    }
}

impl Products {
    pub(super) fn new(cols: usize, rows: usize) -> Self {
        let (across, down) = (Axis::new(cols), Axis::new(rows));
        let size = across.width() * rows;
        Self { across, down, a: vec![0.0; size], b: vec![0.0; size] }
    }

    /// `data` (row-major) becomes `((e_x + e_y)^2 + shift)^-1 data` in the domain of the transform.
    pub(super) fn solve(&mut self, data: &mut [f64], shift: f64) {
        self.fold(data);
        self.transform(|a| &a.cosines, |a| &a.turned);
        self.divide(shift);
        self.transform(|a| &a.turned, |a| &a.cosines);
        self.unfold(data);
    }

    /// Sums and differences of mirrored values of the mirrored rows' sums and differences.
    fn fold(&mut self, data: &[f64]) {
        let (cols, rows) = (self.across.n, self.down.n);
        let (width, room) = (self.across.width(), self.across.room[0]);
        let line = |r: usize| &data[r * cols..(r + 1) * cols];
        for r in 0..rows.div_ceil(2) {
            let (upper, lower) = (line(r), line(rows - 1 - r));
            let (sums, differences) = self.a.split_at_mut(self.down.count[0] * width);
            let middle = rows - 1 - r == r;
            mirror(
                &mut sums[r * width..(r + 1) * width],
                room,
                upper,
                lower,
                if middle { [1.0, 0.0] } else { [1.0; 2] },
            );
            if !middle {
                mirror(&mut differences[r * width..(r + 1) * width], room, upper, lower, [1.0, -1.0]);
            }
        }
    }

    /// The inverse of [`Self::fold`].
    fn unfold(&self, data: &mut [f64]) {
        let (cols, rows) = (self.across.n, self.down.n);
        let (width, room) = (self.across.width(), self.across.room[0]);
        let (sums, differences) = self.a.split_at(self.down.count[0] * width);
        for r in 0..rows.div_ceil(2) {
            let sum = &sums[r * width..(r + 1) * width];
            let pair = [(r, 1.0), (rows - 1 - r, -1.0)];
            let alone = rows - 1 - r == r;
            let difference = if alone { sum } else { &differences[r * width..(r + 1) * width] };
            for (row, sign) in pair.into_iter().take(if alone { 1 } else { 2 }) {
                let sign = if alone { 0.0 } else { sign };
                let out = &mut data[row * cols..(row + 1) * cols];
                let (left, right) = out.split_at_mut(cols / 2);
                let of = |from: usize| sum[from..].iter().zip(&difference[from..]).map(move |(s, d)| s + sign * d);
                let mirrored = right.iter_mut().rev();
                for (((l, r), s), d) in left.iter_mut().zip(mirrored).zip(of(0)).zip(of(room)) {
                    (*l, *r) = (s + d, s - d);
                }
                if cols % 2 == 1 {
                    right[0] = sum[cols / 2] + sign * difference[cols / 2];
                }
            }
        }
    }

    /// From `a` over `b` back to `a`: along columns with the tables `down`, along rows with the tables `across`.
    fn transform(&mut self, down: fn(&Axis) -> &[Vec<f64>; 2], across: fn(&Axis) -> &[Vec<f64>; 2]) {
        let width = self.across.width();
        let split = self.down.count[0] * width;
        let (tables, axis) = (down(&self.down), &self.down);
        let half = |half: usize, from: &[f64], out: &mut [f64]| {
            let n = axis.count[half];
            let left = Matrix { values: &tables[half], stride: axis.room[half] };
            multiply(left, Matrix { values: from, stride: width }, out, width, [n, n, width]);
        };
        let (even, odd) = self.b.split_at_mut(split);
        rayon::join(|| half(0, &self.a[..split], even), || half(1, &self.a[split..], odd));
        let (tables, axis) = (across(&self.across), &self.across);
        let rows = |from: &[f64], out: &mut [f64]| {
            let mut first = 0;
            for (half, table) in tables.iter().enumerate() {
                let (n, room) = (axis.count[half], axis.room[half]);
                let right = Matrix { values: table, stride: room };
                if n > 0 && !from.is_empty() {
                    let left = Matrix { values: &from[first..], stride: width };
                    multiply(left, right, &mut out[first..], width, [from.len() / width, n, room]);
                }
                first += room;
            }
        };
        let (upper, lower) = self.a.split_at_mut(split);
        rayon::join(|| rows(&self.b[..split], upper), || rows(&self.b[split..], lower));
    }

    fn divide(&mut self, shift: f64) {
        let ey = self.down.eigenvalues.iter().zip(self.down.count).flat_map(|(e, n)| &e[..n]);
        for (row, ey) in self.a.chunks_exact_mut(self.across.width()).zip(ey) {
            let ex = self.across.eigenvalues.iter().flatten();
            for (value, ex) in row.iter_mut().zip(ex) {
                let e = ex + ey;
                *value /= e * e + shift;
            }
        }
    }
}

/// `out` = sums, then differences, of the mirrored values of `a * upper + b * lower`.
#[inline(always)]
fn mirror(out: &mut [f64], room: usize, upper: &[f64], lower: &[f64], [a, b]: [f64; 2]) {
    let n = upper.len();
    let (even, odd) = out.split_at_mut(room);
    let value = |i: usize| a * upper[i] + b * lower[i];
    for i in 0..n / 2 {
        let (left, right) = (value(i), value(n - 1 - i));
        (even[i], odd[i]) = (left + right, left - right);
    }
    if n % 2 == 1 {
        even[n / 2] = value(n / 2);
    }
}

/// Rows of values, `stride` apart.
#[derive(Clone, Copy)]
struct Matrix<'a> {
    values: &'a [f64],
    stride: usize,
}

/// `out = a b` with a: n x m and b: m x p, p a multiple of [`PAD`]; rows of `out` are `stride` apart.
fn multiply(a: Matrix, b: Matrix, out: &mut [f64], stride: usize, size: [usize; 3]) {
    Arch::new().dispatch(Product { a, b, out, stride, size });
}

struct Product<'a> {
    a: Matrix<'a>,
    b: Matrix<'a>,
    out: &'a mut [f64],
    stride: usize,
    size: [usize; 3],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        // Sums take as many registers as leave room for a row of b and a factor.
        if S::REGISTER_COUNT >= 32 { self.tiles::<S, 8, 3>(simd) } else { self.tiles::<S, 6, 2>(simd) }
    }
}

impl Product<'_> {
    #[inline(always)]
    fn tiles<S: Simd, const H: usize, const W: usize>(self, simd: S) {
        let Self { a, b, out, stride, size: [n, m, p] } = self;
        if n == 0 {
            return;
        }
        let lanes = S::F64_LANES;
        let mut col = 0;
        while col < p {
            let wide = col + W * lanes <= p;
            let b = Matrix { values: &b.values[col..], ..b };
            let mut row = 0;
            while row < n {
                // The last tile of a column overlaps the one above it.
                let high = n >= H;
                let first = if high { row.min(n - H) } else { row };
                let a = Matrix { values: &a.values[first * a.stride..], ..a };
                let out = &mut out[first * stride + col..];
                match (high, wide) {
                    (true, true) => tile::<S, H, W>(simd, a, b, out, stride, m),
                    (true, false) => tile::<S, H, 1>(simd, a, b, out, stride, m),
                    (false, true) => tile::<S, 1, W>(simd, a, b, out, stride, m),
                    (false, false) => tile::<S, 1, 1>(simd, a, b, out, stride, m),
                }
                row = first + if high { H } else { 1 };
            }
            col += if wide { W * lanes } else { lanes };
        }
    }
}

/// `H` rows by `W` registers of the product.
#[inline(always)]
fn tile<S: Simd, const H: usize, const W: usize>(
    simd: S,
    a: Matrix,
    b: Matrix,
    out: &mut [f64],
    stride: usize,
    m: usize,
) {
    let mut sums = [[simd.splat_f64s(0.0); W]; H];
    let rows: [&[f64]; H] = std::array::from_fn(|h| &a.values[h * a.stride..h * a.stride + m]);
    for (k, line) in b.values.chunks(b.stride).take(m).enumerate() {
        let line = &S::as_simd_f64s(&line[..W * S::F64_LANES]).0[..W];
        for h in 0..H {
            let factor = simd.splat_f64s(rows[h][k]);
            for w in 0..W {
                sums[h][w] = simd.mul_add_e_f64s(factor, line[w], sums[h][w]);
            }
        }
    }
    for (h, sums) in sums.iter().enumerate() {
        let line = &mut out[h * stride..h * stride + W * S::F64_LANES];
        S::as_mut_simd_f64s(line).0.copy_from_slice(sums);
    }
}
