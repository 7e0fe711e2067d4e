//! Made relief: gullies that run down steep slopes, roughness, the crowns of trees of a cover, where the ground is drawn finer than its cells.
//!
//! It shows no data. It bends the normals of the ground, follows its fall line and its materials, is fixed to the map, and has nothing
//! smaller than two nodes of the level that is drawn. Gullies are waves across the fall line around the corners of a lattice, each with its
//! own phase, mixed by their distances, in sizes that halve.

use crate::simd::{LANES, Lanes};
use belvedere_composite::noise;
use belvedere_composite::tint::{GroundCover, GroundNodes};

/// Largest gullies, cells of the ground: larger ones are in the data; and limits, metres.
const GULLY_CELLS: f32 = 2.4;
const GULLY_M: [f32; 2] = [24.0, 260.0];
const GULLIES: u32 = 6;
/// Slope of the sides of gullies on the steepest ground, from size to size times `FALL`.
const GULLY_SLOPE: f32 = 0.30;
const FALL: f32 = 0.70;
/// Tangents of slopes where gullies begin and where they are deepest.
const STEEP: [f32; 2] = [0.22, 0.85];
/// Roughness of ground: sizes from this on, metres, slopes on level and on the steepest ground, and the tangent of its slope.
const ROUGH_M: f32 = 64.0;
const ROUGHS: u32 = 5;
const ROUGH_SLOPE: [f32; 2] = [0.08, 0.11];
const ROUGHEST: f32 = 0.8;

/// Made relief at nodes.
pub(crate) struct Made {
    /// Slopes to the east and to the north.
    pub(crate) slope: [Lanes; 2],
    /// Height of gullies in parts of their depth, about -1..=1, times their share.
    pub(crate) gully: Lanes,
}

/// The relief made at nodes.
/// * `cell_m`: spacing of the data, metres.
#[inline(always)]
pub(crate) fn relief(nodes: &GroundNodes<'_, LANES>, cover: &GroundCover<LANES>, cell_m: f32) -> Made {
    let mut made = Made { slope: cover.crowns, gully: [0.0; LANES] };
    if shown(GULLY_M[1], nodes.spacing_m) == 0.0 {
        return made;
    }
    gullies(nodes, cover, cell_m, &mut made);
    let mut rough = [0.0; LANES];
    for i in 0..LANES {
        let [x, y] = nodes.slope.map(|s| s[i]);
        let steep = ((x * x + y * y).sqrt() * (1.0 / ROUGHEST)).min(1.0);
        let slope = ROUGH_SLOPE[0] + steep * (ROUGH_SLOPE[1] - ROUGH_SLOPE[0]);
        let firm = (1.0 - cover.forest[i]) * (1.0 - cover.water[i]);
        rough[i] = slope * firm * (1.0 - 0.6 * cover.snow[i]);
    }
    let (mut size, mut fall) = (ROUGH_M, 1.0);
    for k in 0..ROUGHS {
        let strength = |i: usize| fall * rough[i];
        bumps(nodes, size, 31 + k, &strength, &mut made);
        (size, fall) = (0.5 * size, 0.8 * fall);
    }
    made
}

/// Share of a size that is drawn: all from three nodes on, none below one and a half.
#[inline(always)]
fn shown(size_m: f32, spacing_m: f32) -> f32 {
    (size_m / (1.5 * spacing_m) - 1.0).clamp(0.0, 1.0)
}

/// Adds smooth bumps.
#[inline(always)]
fn bumps(nodes: &GroundNodes<'_, LANES>, size: f32, seed: u32, slope: &impl Fn(usize) -> f32, made: &mut Made) {
    let shown = shown(size, nodes.spacing_m);
    if shown == 0.0 {
        return;
    }
    let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        (x[i], y[i]) = (nodes.at_m[0][i] / size, nodes.at_m[1][i] / size);
    }
    let (_, [east, south]) = noise::value([&x, &y], seed);
    for i in 0..LANES {
        let by = shown * slope(i);
        made.slope[0][i] += by * east[i];
        made.slope[1][i] -= by * south[i];
    }
}

/// Adds gullies of all sizes.
#[inline(always)]
fn gullies(nodes: &GroundNodes<'_, LANES>, cover: &GroundCover<LANES>, cell_m: f32, made: &mut Made) {
    let (mut depth, mut across) = ([0.0; LANES], [[0.0; LANES]; 2]);
    let mut deepest = 0.0f32;
    for i in 0..LANES {
        let [x, y] = nodes.slope.map(|s| s[i]);
        let steep = (x * x + y * y).sqrt();
        let t = ((steep - STEEP[0]) * (1.0 / (STEEP[1] - STEEP[0]))).clamp(0.0, 1.0);
        depth[i] = t
            * (0.4 + 0.6 * cover.bare[i])
            * (1.0 - 0.55 * cover.forest[i])
            * (1.0 - cover.water[i])
            * (1.0 - 0.5 * cover.snow[i]);
        deepest = if depth[i] > deepest { depth[i] } else { deepest };
        let per = 1.0 / (steep + 1e-6);
        // East and south, across the fall line.
        (across[0][i], across[1][i]) = (y * per, x * per);
    }
    if deepest <= 0.0 {
        return;
    }
    let (mut size, mut slope) = ((GULLY_CELLS * cell_m).clamp(GULLY_M[0], GULLY_M[1]), GULLY_SLOPE);
    for k in 0..GULLIES {
        let shown = shown(size, nodes.spacing_m);
        if shown == 0.0 {
            break;
        }
        wave(nodes, (size, 7 + k), [&across[0], &across[1]], &depth, shown * slope, made);
        (size, slope) = (0.5 * size, FALL * slope);
    }
}

/// Adds gullies of one size.
#[inline(always)]
fn wave(
    nodes: &GroundNodes<'_, LANES>,
    (size, seed): (f32, u32),
    across: [&Lanes; 2],
    depth: &Lanes,
    slope: f32,
    made: &mut Made,
) {
    for i in 0..LANES {
        // Turned against the axes, so that no lattice shows.
        let [a, b] = [nodes.at_m[0][i] / size, nodes.at_m[1][i] / size];
        let (x, y) = (0.8 * a - 0.6 * b, 0.6 * a + 0.8 * b);
        let (cx, cy) = (0.8 * across[0][i] - 0.6 * across[1][i], 0.6 * across[0][i] + 0.8 * across[1][i]);
        let (x0, y0) = (noise::floor(x), noise::floor(y));
        let (s, t) = (x - x0 as f32, y - y0 as f32);
        let (p, q) = (s * s * (3.0 - 2.0 * s), t * t * (3.0 - 2.0 * t));
        let (mut height, mut rise) = (0.0, 0.0);
        for (j, k, weight) in
            [(0, 0, (1.0 - p) * (1.0 - q)), (1, 0, p * (1.0 - q)), (0, 1, (1.0 - p) * q), (1, 1, p * q)]
        {
            let phase = noise::hash(x0.wrapping_add(j), y0.wrapping_add(k), seed);
            let along = (s - j as f32) * cx + (t - k as f32) * cy + phase;
            let (sin, cos) = wave_of(along);
            height += weight * cos;
            rise -= weight * sin;
        }
        let by = slope * depth[i] * rise;
        made.slope[0][i] += by * across[0][i];
        made.slope[1][i] -= by * across[1][i];
        made.gully[i] += depth[i] * slope * height;
    }
}

/// Sine and cosine of an angle in turns, within 0.2 %.
#[inline(always)]
fn wave_of(turns: f32) -> (f32, f32) {
    let sine = |t: f32| {
        let f = t - noise::floor(t + 0.5) as f32;
        let y = 2.0 * f;
        let wave = 4.0 * y * (1.0 - y.abs());
        wave * (0.775 + 0.225 * wave.abs())
    };
    (sine(turns), sine(turns + 0.25))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_sines() {
        for i in -400..400 {
            let turns = i as f32 * 0.0137;
            let (sin, cos) = wave_of(turns);
            let (s, c) = (turns * std::f32::consts::TAU).sin_cos();
            assert!((sin - s).abs() < 2e-3 && (cos - c).abs() < 2e-3, "{turns}: {sin} {s}, {cos} {c}");
        }
    }

    #[test]
    fn gullies_run_down_the_slope_and_only_on_steep_ground() {
        let cover = GroundCover { bare: [1.0; LANES], ..GroundCover::of_color([[0.5; LANES]; 3]) };
        for (x, y, steep) in [(0.9f32, 0.0f32, true), (-0.5, 0.6, true), (0.05, 0.05, false)] {
            let (mut along, mut across) = (0.0, 0.0);
            for n in 0..60 {
                let at: [Lanes; 2] =
                    [0, 1].map(|a| std::array::from_fn(|i| ((i * 37 + n * 211) * (a + 2)) as f32 * 3.3));
                let (slope, flat) = ([[x; LANES], [y; LANES]], [0.0; LANES]);
                let nodes = GroundNodes {
                    height_m: &flat,
                    slope: [&slope[0], &slope[1]],
                    broad: [&slope[0], &slope[1]],
                    above_m: &flat,
                    at_m: [&at[0], &at[1]],
                    spacing_m: 5.0,
                };
                let made = relief(&nodes, &cover, 60.0);
                let steep = x.hypot(y);
                for i in 0..LANES {
                    let [a, b] = made.slope.map(|s| s[i]);
                    along += ((a * x + b * y) / steep).powi(2);
                    across += ((a * y - b * x) / steep).powi(2);
                }
                // Coarse nodes have none.
                assert!(relief(&GroundNodes { spacing_m: 400.0, ..nodes }, &cover, 60.0).slope == [[0.0; LANES]; 2]);
            }
            assert_eq!(steep, across > 1.4 * along, "{x} {y}: {across} across, {along} along the fall line");
        }
    }
}
