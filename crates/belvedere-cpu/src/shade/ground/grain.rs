//! Texture of ground that is nearer than its cells are fine: noise that lies on the map, in steps of a cell and finer down to the pixel,
//! so that meadows, forest, scree and rock in the foreground do not look like a smooth sheet. It shows no data: it only tells kinds of
//! ground apart.

/// Number of sizes of grain, each half of the one before; the first is a cell of the ground.
const SIZES: usize = 7;
/// Pixels along a grain below which it is left out, and from which on it is drawn in full: finer grain would shimmer.
const PIXELS: [f32; 2] = [1.4, 3.0];
/// Change from one size to the next.
const FALL: f32 = 0.86;
/// Parts of brightness by the grain itself and by its slope to the light.
const BY_VALUE: f32 = 0.35;
const BY_SLOPE: f32 = 0.30;
/// Largest change of a square root of light by the roughest ground.
const STRONGEST: f32 = 0.15;

/// Factors of the square roots of lit colours at points of the ground, for a roughness of 1, less 1.
/// * `node`: column and row of a node;
/// * `at`: columns and rows from it;
/// * `px`: longest extent of a pixel on the ground, cells;
/// * `to_light`: unit vector towards the light, in columns and rows.
#[inline(always)]
pub(crate) fn grain<const N: usize>(
    node: [&[i32; N]; 2],
    at: [&[f32; N]; 2],
    px: &[f32; N],
    to_light: [f32; 2],
) -> [f32; N] {
    let mut out = [0.0; N];
    let mut least = f32::MAX;
    for px in px {
        let here = if *px > 0.0 { *px } else { f32::MAX };
        least = if here < least { here } else { least };
    }
    let (mut size, mut strength) = (1.0f32, 1.0f32);
    for k in 0..SIZES {
        if size < PIXELS[0] * least {
            break;
        }
        add(k as u32, size, strength, (node, at, px), to_light, &mut out);
        (size, strength) = (0.5 * size, FALL * strength);
    }
    for v in &mut out {
        let t = if *v > -2.0 { *v } else { -2.0 };
        *v = STRONGEST * if t < 2.0 { t } else { 2.0 };
    }
    out
}

type Points<'a, const N: usize> = ([&'a [i32; N]; 2], [&'a [f32; N]; 2], &'a [f32; N]);

/// Adds grain of one size.
#[inline(always)]
fn add<const N: usize>(
    k: u32,
    size: f32,
    strength: f32,
    (node, at, px): Points<'_, N>,
    to_light: [f32; 2],
    out: &mut [f32; N],
) {
    let per_cell = (1u32 << k) as f32;
    for i in 0..N {
        // Whole parts are kept apart, since columns of large grounds would take the precision.
        let (u, v) = (at[0][i] * per_cell, at[1][i] * per_cell);
        let (u0, v0) = (u.floor(), v.floor());
        let (s, t) = (u - u0, v - v0);
        let x = ((node[0][i] as u32) << k).wrapping_add(u0 as i32 as u32);
        let y = ((node[1][i] as u32) << k).wrapping_add(v0 as i32 as u32);
        let (a, b) = (value(x, y, k), value(x.wrapping_add(1), y, k));
        let (c, d) = (value(x, y.wrapping_add(1), k), value(x.wrapping_add(1), y.wrapping_add(1), k));
        let (p, q) = (s * s * (3.0 - 2.0 * s), t * t * (3.0 - 2.0 * t));
        let (dp, dq) = (6.0 * s * (1.0 - s), 6.0 * t * (1.0 - t));
        let both = a - b - c + d;
        let height = a + p * (b - a) + q * (c - a) + p * q * both;
        let slope = dp * (b - a + q * both) * to_light[0] + dq * (c - a + p * both) * to_light[1];
        let weight = (size / px[i] - PIXELS[0]) * (1.0 / (PIXELS[1] - PIXELS[0]));
        let weight = if weight > 0.0 { weight } else { 0.0 };
        let weight = strength * if weight < 1.0 { weight } else { 1.0 };
        out[i] += weight * (BY_VALUE * height - BY_SLOPE * slope);
    }
}

/// A pseudo-random value in -1..=1.
#[inline(always)]
fn value(x: u32, y: u32, k: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ k.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 13)).wrapping_mul(0x297a_2d39);
    ((h >> 16) as i32 - 0x8000) as f32 * (1.0 / 32_768.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(col: f32, row: f32, px: f32) -> f32 {
        let (c, r) = (col.floor(), row.floor());
        grain([&[c as i32], &[r as i32]], [&[col - c], &[row - r]], &[px], [-0.7, -0.7])[0]
    }

    #[test]
    fn grain_is_fixed_to_the_map_continuous_and_even() {
        let (mut sum, mut square, n) = (0.0, 0.0, 20_000);
        for i in 0..n {
            let (col, row, px) = (3.0 + i as f32 * 0.0173, 900.0 - i as f32 * 0.0311, 0.02);
            let here = at(col, row, px);
            assert!(here.is_finite() && here.abs() <= 2.0 * STRONGEST);
            // A tenth of a pixel further, across borders of cells too, hardly anything changes.
            assert!((at(col + 0.1 * px, row, px) - here).abs() < 0.06, "{col} {row}");
            // A slightly nearer eye neither.
            assert!((at(col, row, 1.01 * px) - here).abs() < 0.02, "{col} {row}");
            (sum, square) = (sum + here, square + here * here);
        }
        let (mean, spread) = (sum / n as f32, (square / n as f32).sqrt());
        assert!(mean.abs() < 0.01 && spread > 0.03, "mean {mean}, spread {spread}");
    }

    #[test]
    fn one_point_is_the_same_from_either_node_beside_it() {
        for (col, row) in [(12.0, 7.25), (12.5, 7.0), (100.0, 3.0)] {
            let (c, r) = (col as i32, row as i32);
            let near = grain([&[c], &[r]], [&[col - c as f32], &[row - r as f32]], &[0.01], [0.6, 0.8])[0];
            let west = grain([&[c - 1], &[r]], [&[col - c as f32 + 1.0], &[row - r as f32]], &[0.01], [0.6, 0.8])[0];
            assert!((near - west).abs() < 1e-4, "{near} {west}");
        }
    }

    #[test]
    fn far_ground_has_none() {
        assert!((0..200).all(|i| at(0.37 * i as f32, 5.0, 0.8) == 0.0));
    }
}
