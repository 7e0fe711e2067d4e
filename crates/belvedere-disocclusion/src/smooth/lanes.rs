//! Fourier transforms of many sequences at once, one per lane of a register.
//!
//! Nothing is shuffled: the samples of one instant of all sequences lie side by side, and every step of the transform is
//! an operation on whole registers. Mixed radix, self-sorting (Stockham).

use std::f64::consts::TAU;

use pulp::Simd;

/// Largest prime that is handled; a factor p costs p / 2 multiplications per value.
const LARGEST: usize = 61;

/// Plan of transforms of one length.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    n: usize,
    stages: Vec<Stage>,
    /// `c_k exp(-i pi k / 2n)`, c_0 = sqrt(1/n), else sqrt(2/n).
    turn: Vec<[f64; 2]>,
}

#[derive(Debug, Clone)]
struct Stage {
    radix: usize,
    /// Values per part of what is left to transform.
    part: usize,
    /// `exp(-i tau p k / (radix part))` for p in 0..part (slow) and k in 1..radix.
    twiddles: Vec<[f64; 2]>,
    /// Cosine and sine of `tau j k / radix` for j (slow) and k in 1..=(radix - 1) / 2.
    roots: Vec<[f64; 2]>,
}

/// Prime factors, the largest first; `None` if one is too large.
fn factors(mut n: usize) -> Option<Vec<usize>> {
    let mut out = Vec::new();
    for p in 2..=LARGEST {
        while n.is_multiple_of(p) {
            out.push(p);
            n /= p;
        }
    }
    out.reverse();
    (n == 1).then_some(out)
}

impl Plan {
    /// `None` if `n` has too large a prime factor.
    pub(super) fn new(n: usize) -> Option<Self> {
        let angle = |k: usize, n: usize| TAU * (k % n) as f64 / n as f64;
        let mut left = n;
        let stage = |radix: usize| {
            let (whole, part) = (left, left / radix);
            let twiddle = |(p, k): (usize, usize)| {
                let a = angle(p * k, whole);
                [a.cos(), -a.sin()]
            };
            let twiddles = (0..part).flat_map(|p| (1..radix).map(move |k| (p, k))).map(twiddle).collect();
            let half = (radix - 1) / 2;
            let root = |(j, k): (usize, usize)| [angle(j * k, radix).cos(), angle(j * k, radix).sin()];
            let roots = (1..=half).flat_map(|j| (1..=half).map(move |k| (j, k))).map(root).collect();
            left = part;
            Stage { radix, part, twiddles, roots }
        };
        let stages = factors(n)?.into_iter().map(stage).collect();
        let turn = |k: usize| {
            let c = (if k == 0 { 1.0 } else { 2.0 } / n as f64).sqrt();
            let a = std::f64::consts::FRAC_PI_2 * k as f64 / n as f64;
            [c * a.cos(), -c * a.sin()]
        };
        Some(Self { n, stages, turn: (0..n).map(turn).collect() })
    }

    pub(super) fn len(&self) -> usize {
        self.n
    }

    /// Where sample `j` stands in the order of Makhoul 1980.
    #[inline(always)]
    pub(super) fn place(&self, j: usize) -> usize {
        if j & 1 == 0 { j / 2 } else { self.n - j.div_ceil(2) }
    }

    /// Registers of scratch that a transform needs.
    pub(super) fn scratch() -> usize {
        4 * (LARGEST / 2)
    }

    /// Cosine spectra of the sequences in `z` (pairs of registers, reordered samples), in natural order. `spare` is as long.
    #[inline(always)]
    pub(super) fn forward<S: Simd>(&self, simd: S, z: &mut [S::f64s], spare: &mut [S::f64s], scratch: &mut [S::f64s]) {
        self.fourier(simd, z, spare, scratch);
        let n = self.n;
        let half = simd.splat_f64s(0.5);
        let alone = if n.is_multiple_of(2) { &[0, 1][..] } else { &[0] };
        for k in alone.iter().map(|half| half * n / 2) {
            let factor = simd.splat_f64s(self.turn[k][0]);
            (z[2 * k], z[2 * k + 1]) = (simd.mul_f64s(factor, z[2 * k]), simd.mul_f64s(factor, z[2 * k + 1]));
        }
        for k in 1..n.div_ceil(2) {
            let m = n - k;
            let [c, s] = self.turn[k].map(|t| simd.mul_f64s(simd.splat_f64s(t), half));
            let (p, q) = ([z[2 * k], z[2 * k + 1]], [z[2 * m], z[2 * m + 1]]);
            let (ar, ai) = (simd.add_f64s(p[0], q[0]), simd.sub_f64s(p[1], q[1]));
            let (br, bi) = (simd.add_f64s(p[1], q[1]), simd.sub_f64s(q[0], p[0]));
            let minus = simd.neg_f64s(s);
            z[2 * k] = simd.mul_add_e_f64s(minus, ai, simd.mul_f64s(c, ar));
            z[2 * k + 1] = simd.mul_add_e_f64s(minus, bi, simd.mul_f64s(c, br));
            // turn[n - k] is turn[k] mirrored on the diagonal.
            let c = simd.neg_f64s(c);
            z[2 * m] = simd.mul_add_e_f64s(c, ai, simd.mul_f64s(minus, ar));
            z[2 * m + 1] = simd.mul_add_e_f64s(c, bi, simd.mul_f64s(minus, br));
        }
    }

    /// Reordered samples of the cosine spectra in `z`; the registers of each pair come out exchanged.
    #[inline(always)]
    pub(super) fn inverse<S: Simd>(&self, simd: S, z: &mut [S::f64s], spare: &mut [S::f64s], scratch: &mut [S::f64s]) {
        let n = self.n;
        let first = simd.splat_f64s(self.turn[0][0]);
        (z[0], z[1]) = (simd.mul_f64s(z[1], first), simd.mul_f64s(z[0], first));
        for k in 1..n / 2 + 1 {
            let m = n - k;
            let (a, b) = ([z[2 * k], z[2 * m]], [z[2 * k + 1], z[2 * m + 1]]);
            let sum = [simd.add_f64s(a[0], b[1]), simd.sub_f64s(b[0], a[1])];
            [z[2 * k], z[2 * k + 1]] = exchanged(simd, sum, self.turn[k]);
            if m != k {
                let sum = [simd.add_f64s(a[1], b[0]), simd.sub_f64s(b[1], a[0])];
                [z[2 * m], z[2 * m + 1]] = exchanged(simd, sum, self.turn[m]);
            }
        }
        self.fourier(simd, z, spare, scratch);
    }

    /// Discrete Fourier transform in place.
    #[inline(always)]
    fn fourier<S: Simd>(&self, simd: S, z: &mut [S::f64s], spare: &mut [S::f64s], scratch: &mut [S::f64s]) {
        let (mut from, mut to) = (&mut *z, spare);
        let mut stride = 1;
        for stage in &self.stages {
            match stage.radix {
                2 => stage.twos(simd, from, to, stride),
                3 => stage.odd(simd, 3, from, to, stride, scratch),
                5 => stage.odd(simd, 5, from, to, stride, scratch),
                7 => stage.odd(simd, 7, from, to, stride, scratch),
                radix => stage.odd(simd, radix, from, to, stride, scratch),
            }
            stride *= stage.radix;
            std::mem::swap(&mut from, &mut to);
        }
        if self.stages.len() % 2 == 1 {
            to.copy_from_slice(from);
        }
    }
}

/// Half of `a` times the conjugate of `t`, its parts exchanged: that makes the forward transform the inverse one.
#[inline(always)]
fn exchanged<S: Simd>(simd: S, [re, im]: [S::f64s; 2], t: [f64; 2]) -> [S::f64s; 2] {
    let [c, s] = t.map(|t| 0.5 * t);
    let [re, im] = product(simd, [re, im], [c, -s]);
    [im, re]
}

/// `a t`.
#[inline(always)]
fn product<S: Simd>(simd: S, [re, im]: [S::f64s; 2], t: [f64; 2]) -> [S::f64s; 2] {
    let (c, s, minus) = (simd.splat_f64s(t[0]), simd.splat_f64s(t[1]), simd.splat_f64s(-t[1]));
    [simd.mul_add_e_f64s(minus, im, simd.mul_f64s(c, re)), simd.mul_add_e_f64s(s, re, simd.mul_f64s(c, im))]
}

impl Stage {
    #[inline(always)]
    fn twos<S: Simd>(&self, simd: S, from: &[S::f64s], to: &mut [S::f64s], stride: usize) {
        for p in 0..self.part {
            for q in 0..stride {
                let (i, j) = (2 * (q + stride * p), 2 * (q + stride * (p + self.part)));
                let (a, b) = ([from[i], from[i + 1]], [from[j], from[j + 1]]);
                let o = 2 * (q + stride * 2 * p);
                (to[o], to[o + 1]) = (simd.add_f64s(a[0], b[0]), simd.add_f64s(a[1], b[1]));
                let difference = [simd.sub_f64s(a[0], b[0]), simd.sub_f64s(a[1], b[1])];
                let o = o + 2 * stride;
                [to[o], to[o + 1]] = product(simd, difference, self.twiddles[p]);
            }
        }
    }

    /// An odd radix: sums and differences of mirrored terms, whose cosine and sine parts are found separately.
    #[inline(always)]
    fn odd<S: Simd>(
        &self,
        simd: S,
        radix: usize,
        from: &[S::f64s],
        to: &mut [S::f64s],
        stride: usize,
        scratch: &mut [S::f64s],
    ) {
        let half = radix / 2;
        let terms = &mut scratch[..4 * half];
        for p in 0..self.part {
            let twiddles = &self.twiddles[p * (radix - 1)..(p + 1) * (radix - 1)];
            for q in 0..stride {
                let (first, step) = (2 * (q + stride * p), 2 * stride * self.part);
                let zero = [from[first], from[first + 1]];
                let mut sum = zero;
                for (j, term) in terms.chunks_exact_mut(4).enumerate() {
                    let (a, b) = (first + (j + 1) * step, first + (radix - 1 - j) * step);
                    term[0] = simd.add_f64s(from[a], from[b]);
                    term[1] = simd.add_f64s(from[a + 1], from[b + 1]);
                    term[2] = simd.sub_f64s(from[a], from[b]);
                    term[3] = simd.sub_f64s(from[a + 1], from[b + 1]);
                    sum = [simd.add_f64s(sum[0], term[0]), simd.add_f64s(sum[1], term[1])];
                }
                let out = 2 * (q + stride * radix * p);
                (to[out], to[out + 1]) = (sum[0], sum[1]);
                let mut k = 0;
                while k < half {
                    let width = if half - k >= 2 { 2 } else { 1 };
                    let values = if width == 2 {
                        block::<S, 2>(simd, half, k, zero, terms, &self.roots)
                    } else {
                        let [one] = block::<S, 1>(simd, half, k, zero, terms, &self.roots);
                        [one, one]
                    };
                    for [here, mirrored] in values.into_iter().take(width) {
                        k += 1;
                        let o = out + 2 * stride * k;
                        [to[o], to[o + 1]] = product(simd, here, twiddles[k - 1]);
                        let o = out + 2 * stride * (radix - k);
                        [to[o], to[o + 1]] = product(simd, mirrored, twiddles[radix - k - 1]);
                    }
                }
            }
        }
    }
}

/// Frequencies `first + 1 ..= first + W` and their mirror images.
#[inline(always)]
fn block<S: Simd, const W: usize>(
    simd: S,
    half: usize,
    first: usize,
    zero: [S::f64s; 2],
    terms: &[S::f64s],
    roots: &[[f64; 2]],
) -> [[[S::f64s; 2]; 2]; W] {
    let nothing = simd.splat_f64s(0.0);
    let mut sums = [[zero[0], zero[1], nothing, nothing]; W];
    for (term, roots) in terms.chunks_exact(4).zip(roots.chunks_exact(half)) {
        let roots = &roots[first..first + W];
        for w in 0..W {
            let (c, s) = (simd.splat_f64s(roots[w][0]), simd.splat_f64s(roots[w][1]));
            sums[w] = [
                simd.mul_add_e_f64s(c, term[0], sums[w][0]),
                simd.mul_add_e_f64s(c, term[1], sums[w][1]),
                simd.mul_add_e_f64s(s, term[2], sums[w][2]),
                simd.mul_add_e_f64s(s, term[3], sums[w][3]),
            ];
        }
    }
    let mut out = [[[nothing; 2]; 2]; W];
    for w in 0..W {
        let [cr, ci, sr, si] = sums[w];
        out[w] = [[simd.add_f64s(cr, si), simd.sub_f64s(ci, sr)], [simd.sub_f64s(cr, si), simd.add_f64s(ci, sr)]];
    }
    out
}
