//! Orthonormal cosine transforms of two real sequences at once, by one complex Fourier transform of the same length.
//!
//! DCT-II by the reordering of Makhoul 1980: even samples ascending, then odd samples descending; two sequences ride
//! as real and imaginary part and come apart by symmetry. Any length.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::num_traits::Float;
use rustfft::{Fft, FftNum, FftPlanner};

/// Number type of a transform: f64 or f32.
pub trait Real: FftNum + Float {
    /// Nearest value.
    fn of(x: f64) -> Self;

    /// The values themselves if they are f64.
    fn doubles(_: &mut [Self]) -> Option<&mut [f64]> {
        None
    }
}

impl Real for f64 {
    fn of(x: f64) -> Self {
        x
    }

    fn doubles(values: &mut [Self]) -> Option<&mut [f64]> {
        Some(values)
    }
}

impl Real for f32 {
    fn of(x: f64) -> Self {
        x as Self
    }
}

/// Plans and factors for sequences of one length.
#[derive(Clone)]
pub(super) struct Line<T: Real> {
    n: usize,
    forward: Arc<dyn Fft<T>>,
    inverse: Arc<dyn Fft<T>>,
    /// `c_k exp(-i pi k / 2n)`, c_0 = sqrt(1/n), else sqrt(2/n).
    turn: Vec<Complex<T>>,
}

impl<T: Real> Line<T> {
    pub(super) fn new(n: usize) -> Self {
        let mut planner = FftPlanner::new();
        let turn = (0..n)
            .map(|k| {
                let c = (if k == 0 { 1.0 } else { 2.0 } / n as f64).sqrt();
                let angle = -std::f64::consts::FRAC_PI_2 * k as f64 / n as f64;
                Complex::new(T::of(c * angle.cos()), T::of(c * angle.sin()))
            })
            .collect();
        Self { n, forward: planner.plan_fft_forward(n), inverse: planner.plan_fft_inverse(n), turn }
    }

    pub(super) fn len(&self) -> usize {
        self.n
    }

    pub(super) fn scratch_len(&self) -> usize {
        self.forward.get_inplace_scratch_len().max(self.inverse.get_inplace_scratch_len())
    }

    /// Where sample `j` stands in the reordered sequence.
    #[inline]
    pub(super) fn place(&self, j: usize) -> usize {
        if j & 1 == 0 { j / 2 } else { self.n - j.div_ceil(2) }
    }

    /// Two sequences into reordered pairs.
    pub(super) fn load(&self, a: &[T], b: &[T], z: &mut [Complex<T>]) {
        let n = self.n;
        let (even, odd) = z[..n].split_at_mut(n.div_ceil(2));
        for ((z, a), b) in even.iter_mut().zip(a.iter().step_by(2)).zip(b.iter().step_by(2)) {
            *z = Complex::new(*a, *b);
        }
        for ((z, a), b) in odd.iter_mut().rev().zip(a[1..].iter().step_by(2)).zip(b[1..].iter().step_by(2)) {
            *z = Complex::new(*a, *b);
        }
    }

    /// Reordered pairs back into two sequences.
    pub(super) fn unload(&self, z: &[Complex<T>], a: &mut [T], b: &mut [T]) {
        let n = self.n;
        let (even, odd) = z[..n].split_at(n.div_ceil(2));
        for ((z, a), b) in even.iter().zip(a.iter_mut().step_by(2)).zip(b.iter_mut().step_by(2)) {
            (*a, *b) = (z.re, z.im);
        }
        for ((z, a), b) in odd.iter().rev().zip(a[1..].iter_mut().step_by(2)).zip(b[1..].iter_mut().step_by(2)) {
            (*a, *b) = (z.re, z.im);
        }
    }

    /// Reordered samples of two sequences -> their spectra. `z` is used up.
    pub(super) fn forward(&self, z: &mut [Complex<T>], scratch: &mut [Complex<T>], a: &mut [T], b: &mut [T]) {
        let n = self.n;
        self.forward.process_with_scratch(z, scratch);
        let half = T::of(0.5);
        let (z, a, b, turn) = (&z[..n], &mut a[..n], &mut b[..n], &self.turn[..n]);
        a[0] = turn[0].re * z[0].re;
        b[0] = turn[0].re * z[0].im;
        for k in 1..n.div_ceil(2) {
            let m = n - k;
            let (p, q, t) = (z[k], z[m], turn[k]);
            let va = Complex::new((p.re + q.re) * half, (p.im - q.im) * half);
            let vb = Complex::new((p.im + q.im) * half, (q.re - p.re) * half);
            a[k] = t.re * va.re - t.im * va.im;
            b[k] = t.re * vb.re - t.im * vb.im;
            // turn[n - k] is turn[k] mirrored on the diagonal.
            a[m] = -t.im * va.re - t.re * va.im;
            b[m] = -t.im * vb.re - t.re * vb.im;
        }
        if n.is_multiple_of(2) {
            let m = n / 2;
            a[m] = turn[m].re * z[m].re;
            b[m] = turn[m].re * z[m].im;
        }
    }

    /// Spectra of two sequences -> their reordered samples.
    pub(super) fn inverse(&self, a: &[T], b: &[T], z: &mut [Complex<T>], scratch: &mut [Complex<T>]) {
        let n = self.n;
        let half = T::of(0.5);
        let (out, a, b, turn) = (&mut z[..n], &a[..n], &b[..n], &self.turn[..n]);
        out[0] = Complex::new(a[0] * turn[0].re, b[0] * turn[0].re);
        for k in 1..n {
            let (t, m) = (turn[k], n - k);
            let y = Complex::new(a[k] + b[m], b[k] - a[m]);
            out[k] = Complex::new((t.re * y.re + t.im * y.im) * half, (t.re * y.im - t.im * y.re) * half);
        }
        self.inverse.process_with_scratch(z, scratch);
    }
}
