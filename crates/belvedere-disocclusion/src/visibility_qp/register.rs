//! SIMD registers that hold several grid positions.

use pulp::Simd;

/// The most numbers that a register holds.
pub(super) const LANES: usize = 8;

/// A number for each position; shorter registers take the first ones.
pub(super) type Lane = [f64; LANES];

/// The first register of a lane.
#[inline(always)]
pub(super) fn load<S: Simd>(lane: &Lane) -> S::f64s {
    S::as_simd_f64s(lane).0[0]
}

/// A register as numbers; the others are 0.
#[inline(always)]
pub(super) fn store<S: Simd>(register: S::f64s) -> Lane {
    let mut out = [0.0; LANES];
    S::as_mut_simd_f64s(&mut out).0[0] = register;
    out
}

/// Whole part (at most `last`) of coordinates and the rest, which is 1 where the whole part could be one more. Below 0
/// counts as 0, and so does NaN.
#[inline(always)]
pub(super) fn split<S: Simd>(simd: S, x: S::f64s, last: f64) -> (S::f64s, S::f64s) {
    // Adding this rounds to a whole number.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    let x = simd.max_f64s(x, simd.splat_f64s(0.0));
    let middle = simd.min_f64s(simd.sub_f64s(x, simd.splat_f64s(0.5)), simd.splat_f64s(last));
    let whole = simd.sub_f64s(simd.add_f64s(middle, simd.splat_f64s(WHOLE)), simd.splat_f64s(WHOLE));
    (whole, simd.sub_f64s(x, whole))
}

/// Added to a whole number below 2^32 it leaves that in the lowest bits.
pub(super) const UNITS: f64 = 4_503_599_627_370_496.0;

/// Whole numbers below 2^32 as indices.
#[inline(always)]
pub(super) fn indices<S: Simd>(simd: S, whole: S::f64s) -> [u32; LANES] {
    let units = store::<S>(simd.add_f64s(whole, simd.splat_f64s(UNITS)));
    // Not mapped: closures are not compiled for the registers.
    let mut out = [0; LANES];
    for (out, units) in out.iter_mut().zip(&units) {
        *out = units.to_bits() as u32;
    }
    out
}
