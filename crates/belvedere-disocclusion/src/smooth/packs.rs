//! Solves on large grids: sixteen rows or columns at a time, one per lane of two registers.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::lanes::Plan;
use super::smoother::eigenvalue;

/// Sequences per task are a multiple of this, the most that two registers hold: who rides with whom never depends on the
/// number of cores.
const MOST: usize = 16;

/// `H^-1` of a grid whose sides have no large prime factors; keeps its plans and buffers. Works on all cores.
#[derive(Debug, Clone)]
pub(super) struct Packs {
    across: Plan,
    down: Plan,
    ex: Vec<f64>,
    ey: Vec<f64>,
    turned: Vec<f64>,
    slots: Vec<Slot>,
}

/// Buffers of one task.
#[derive(Debug, Clone)]
struct Slot {
    z: Vec<f64>,
    spare: Vec<f64>,
    scratch: Vec<f64>,
}

/// Where a task's sequences come from.
#[derive(Clone, Copy)]
enum From<'a> {
    /// The rows of the chunk itself.
    Rows,
    /// Columns `first..` of a grid of so many columns.
    Columns(&'a [f64], usize, usize),
}

/// What happens to them.
#[derive(Clone, Copy)]
enum Step<'a> {
    Forward,
    Inverse,
    /// Forward, division by `(ex + ey)^2 + shift` with ex by sequence and ey by frequency, inverse.
    Divide {
        ex: &'a [f64],
        ey: &'a [f64],
        shift: f64,
    },
}

impl Packs {
    /// `None` if a side has too large a prime factor.
    pub(super) fn new(cols: usize, rows: usize) -> Option<Self> {
        let (across, down) = (Plan::new(cols)?, Plan::new(rows)?);
        let n = cols.max(rows);
        let slot =
            Slot { z: vec![0.0; MOST * n], spare: vec![0.0; MOST * n], scratch: vec![0.0; Plan::scratch() * MOST / 2] };
        let tasks = (4 * rayon::current_num_threads()).clamp(1, n.div_ceil(MOST));
        let eigenvalues = |n: usize| (0..n).map(|k| eigenvalue(k, n)).collect();
        Some(Self {
            ex: eigenvalues(cols),
            ey: eigenvalues(rows),
            across,
            down,
            turned: vec![0.0; cols * rows],
            slots: vec![slot; tasks],
        })
    }

    /// `data` (row-major) becomes `((e_x + e_y)^2 + shift)^-1 data` in the domain of the transform.
    pub(super) fn solve(&mut self, data: &mut [f64], shift: f64) {
        let Self { across, down, ex, ey, turned, slots } = self;
        run(across, From::Rows, Step::Forward, data, slots);
        run(down, From::Columns(data, across.len(), 0), Step::Divide { ex, ey, shift }, turned, slots);
        run(across, From::Columns(turned, down.len(), 0), Step::Inverse, data, slots);
    }
}

/// One step on every row of `data`, or on every column of another grid, which becomes a row of `data`.
fn run(plan: &Plan, from: From, step: Step, data: &mut [f64], slots: &mut [Slot]) {
    let n = plan.len();
    let share = (data.len() / n).div_ceil(slots.len()).next_multiple_of(MOST);
    data.par_chunks_mut(share * n).zip(slots).enumerate().for_each(|(task, (rows, slot))| {
        let first = task * share;
        let from = match from {
            From::Rows => From::Rows,
            From::Columns(grid, width, _) => From::Columns(grid, width, first),
        };
        let step = match step {
            Step::Divide { ex, ey, shift } => Step::Divide { ex: &ex[first..], ey, shift },
            other => other,
        };
        Arch::new().dispatch(Task { plan, from, step, rows, slot });
    });
}

struct Task<'a> {
    plan: &'a Plan,
    from: From<'a>,
    step: Step<'a>,
    rows: &'a mut [f64],
    slot: &'a mut Slot,
}

impl WithSimd for Task<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { plan, from, step, rows, slot } = self;
        let (n, pack) = (plan.len(), 2 * S::F64_LANES);
        let Slot { z, spare, scratch } = slot;
        let (z, spare) = (&mut z[..pack * n], S::as_mut_simd_f64s(&mut spare[..pack * n]).0);
        let scratch = S::as_mut_simd_f64s(scratch).0;
        for (k, out) in rows.chunks_mut(pack * n).enumerate() {
            let count = out.len() / n;
            let samples = !matches!(step, Step::Inverse);
            if count < pack {
                // Two sequences ride together: what is not there must not leave a trace in the last bits.
                z.fill(0.0);
            }
            match from {
                From::Rows => load_rows(n, out, z, pack),
                From::Columns(grid, width, first) => {
                    for (j, row) in grid.chunks_exact(width).enumerate() {
                        let at = pack * if samples { plan.place(j) } else { j };
                        let values = &row[first + k * pack..];
                        match (values.first_chunk::<16>(), pack) {
                            (Some(values), 16) => z[at..at + 16].copy_from_slice(values),
                            _ => z[at..at + count].copy_from_slice(&values[..count]),
                        }
                    }
                }
            }
            let lanes = S::as_mut_simd_f64s(z).0;
            if samples {
                plan.forward(simd, lanes, spare, scratch);
            }
            if let Step::Divide { ex, ey, shift } = step {
                divide(simd, lanes, [&ex[k * pack..], ey], count, shift);
            }
            if matches!(step, Step::Forward) {
                store_spectra(z, out, n, pack);
            } else {
                plan.inverse(simd, lanes, spare, scratch);
                store_samples(z, out, n, pack);
            }
        }
    }
}

/// Instants that are moved at a time, even: their registers and a line of the cache of every row stay near.
const NEAR: usize = 16;

/// Row r of `rows` into lane r, in the order of Makhoul: even samples ascending, then odd ones descending.
#[inline(always)]
fn load_rows(n: usize, rows: &[f64], z: &mut [f64], pack: usize) {
    let (even, odd) = z.split_at_mut(n.div_ceil(2) * pack);
    for start in (0..n).step_by(NEAR) {
        let end = (start + NEAR).min(n);
        let even = &mut even[start / 2 * pack..end.div_ceil(2) * pack];
        let odd = &mut odd[(n / 2 - end / 2) * pack..(n / 2 - start / 2) * pack];
        for (r, row) in rows.chunks_exact(n).enumerate() {
            let row = &row[start..end];
            for (to, x) in even.chunks_exact_mut(pack).zip(row.iter().step_by(2)) {
                to[r] = *x;
            }
            for (to, x) in odd.chunks_exact_mut(pack).rev().zip(row.iter().skip(1).step_by(2)) {
                to[r] = *x;
            }
        }
    }
}

/// The inverse of [`load_rows`], with the registers of each pair exchanged.
#[inline(always)]
fn store_samples(z: &[f64], rows: &mut [f64], n: usize, pack: usize) {
    let (even, odd) = z.split_at(n.div_ceil(2) * pack);
    for start in (0..n).step_by(NEAR) {
        let end = (start + NEAR).min(n);
        let even = &even[start / 2 * pack..end.div_ceil(2) * pack];
        let odd = &odd[(n / 2 - end / 2) * pack..(n / 2 - start / 2) * pack];
        for (r, row) in rows.chunks_exact_mut(n).enumerate() {
            let lane = if r < pack / 2 { r + pack / 2 } else { r - pack / 2 };
            let row = &mut row[start..end];
            for (from, x) in even.chunks_exact(pack).zip(row.iter_mut().step_by(2)) {
                *x = from[lane];
            }
            for (from, x) in odd.chunks_exact(pack).rev().zip(row.iter_mut().skip(1).step_by(2)) {
                *x = from[lane];
            }
        }
    }
}

/// Lane r into row r.
#[inline(always)]
fn store_spectra(z: &[f64], rows: &mut [f64], n: usize, pack: usize) {
    for start in (0..n).step_by(NEAR) {
        let end = (start + NEAR).min(n);
        let near = &z[start * pack..end * pack];
        for (r, row) in rows.chunks_exact_mut(n).enumerate() {
            for (from, x) in near.chunks_exact(pack).zip(&mut row[start..end]) {
                *x = from[r];
            }
        }
    }
}

#[inline(always)]
fn divide<S: Simd>(simd: S, lanes: &mut [S::f64s], [ex, ey]: [&[f64]; 2], count: usize, shift: f64) {
    let width = S::F64_LANES;
    let first = simd.partial_load_f64s(&ex[..width.min(count)]);
    let second = simd.partial_load_f64s(&ex[width.min(count)..count.min(2 * width)]);
    let shift = simd.splat_f64s(shift);
    for (pair, ey) in lanes.chunks_exact_mut(2).zip(ey) {
        let ey = simd.splat_f64s(*ey);
        for (value, ex) in pair.iter_mut().zip([first, second]) {
            let e = simd.add_f64s(ex, ey);
            *value = simd.div_f64s(*value, simd.mul_add_e_f64s(e, e, shift));
        }
    }
}
