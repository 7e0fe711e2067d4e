//! Noise of many sizes at nodes, and steps between values.

use super::GroundNodes;
use crate::noise;

/// Noise of several sizes, each half of the one before and 0.62 as strong, about -1..=1; sizes below two nodes are left out.
#[inline(always)]
pub(super) fn fractal<const N: usize>(nodes: &GroundNodes<'_, N>, longest_m: f32, octaves: u32, seed: u32) -> [f32; N] {
    let (mut out, mut size, mut strength) = ([0.0; N], longest_m, 0.62);
    for k in 0..octaves {
        let shown = (size / (2.0 * nodes.spacing_m) - 0.5).clamp(0.0, 1.0);
        if shown == 0.0 {
            break;
        }
        let [x, y] = turned(nodes, size, k as usize);
        let (value, _) = noise::value([&x, &y], seed + k);
        for i in 0..N {
            out[i] += strength * shown * value[i];
        }
        (size, strength) = (0.5 * size, 0.62 * strength);
    }
    out
}

/// Places in steps of a noise whose lattice is turned the `k`-th time, so that no lattice shows.
#[inline(always)]
pub(super) fn turned<const N: usize>(nodes: &GroundNodes<'_, N>, size: f32, k: usize) -> [[f32; N]; 2] {
    let (mut x, mut y) = ([0.0; N], [0.0; N]);
    let [c, s] = TURNS[k % TURNS.len()];
    for i in 0..N {
        let [a, b] = [nodes.at_m[0][i] / size, nodes.at_m[1][i] / size];
        (x[i], y[i]) = (c * a - s * b, s * a + c * b);
    }
    [x, y]
}

/// Cosines and sines of turns of the lattices of noise.
const TURNS: [[f32; 2]; 4] = [[1.0, 0.0], [0.8, 0.6], [0.28, 0.96], [0.6, -0.8]];

/// 0 at one value, 1 at another, linear between.
#[inline(always)]
pub(super) fn ramp(x: f32, zero: f32, one: f32) -> f32 {
    ((x - zero) * (1.0 / (one - zero))).clamp(0.0, 1.0)
}

/// A rise from 0 to 1 that begins and ends level.
#[inline(always)]
pub(super) fn smooth(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}
