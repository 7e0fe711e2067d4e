//! Smooth noise that is fixed to the map: detail made where data have none.

/// Value noise at places, about -1..=1, and its slope along both axes (quintic interpolation between pseudo-random values on whole numbers).
///
/// * `at`: places, in steps of the noise; `seed`: another seed gives other noise.
#[inline(always)]
pub fn value<const N: usize>([x, y]: [&[f32; N]; 2], seed: u32) -> ([f32; N], [[f32; N]; 2]) {
    let (mut out, mut east, mut south) = ([0.0; N], [0.0; N], [0.0; N]);
    for i in 0..N {
        let (x0, y0) = (floor(x[i]), floor(y[i]));
        let (s, t) = (x[i] - x0 as f32, y[i] - y0 as f32);
        let (x1, y1) = (x0.wrapping_add(1), y0.wrapping_add(1));
        let (a, b) = (hash(x0, y0, seed), hash(x1, y0, seed));
        let (c, d) = (hash(x0, y1, seed), hash(x1, y1, seed));
        let (p, q) = (s * s * s * (s * (s * 6.0 - 15.0) + 10.0), t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
        let (dp, dq) = (30.0 * s * s * (1.0 - s) * (1.0 - s), 30.0 * t * t * (1.0 - t) * (1.0 - t));
        let both = a - b - c + d;
        out[i] = a + p * (b - a) + q * (c - a) + p * q * both;
        east[i] = dp * (b - a + q * both);
        south[i] = dq * (c - a + p * both);
    }
    (out, [east, south])
}

/// Domes side by side, as crowns of trees from above: one around a place in each square of side 1, where the nearest is shown.
#[derive(Debug, Clone, Copy)]
pub struct Domes<const N: usize> {
    /// Height, 1 in the middle of a dome, less down to 0 between domes.
    pub height: [f32; N],
    /// Its slope along both axes.
    pub slope: [[f32; N]; 2],
    /// A pseudo-random value of the dome, -1..=1.
    pub own: [f32; N],
}

/// A square and those around it.
const AROUND: [[i32; 2]; 9] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// The domes at places (cellular noise, Worley 1996).
///
/// * `at`, `seed`: see [`value`].
#[inline(always)]
pub fn domes<const N: usize>([x, y]: [&[f32; N]; 2], seed: u32) -> Domes<N> {
    let (mut square, mut dx, mut dy, mut own) = ([4.0f32; N], [0.0; N], [0.0; N], [0.0; N]);
    // Lanes inside, so that they become vector instructions.
    for [j, k] in AROUND {
        for i in 0..N {
            let (x0, y0) = (floor(x[i]), floor(y[i]));
            let random = bits(x0.wrapping_add(j), y0.wrapping_add(k), seed);
            let part = |shift: u32| ((random >> shift) & 255) as i32 as f32 * (1.0 / 255.0);
            // Places keep off the sides of their squares, so that no two are close.
            let (s, t) = (x[i] - x0 as f32 - j as f32, y[i] - y0 as f32 - k as f32);
            let (s, t) = (s - 0.15 - 0.7 * part(0), t - 0.15 - 0.7 * part(8));
            let far = s * s + t * t;
            let nearer = far < square[i];
            square[i] = if nearer { far } else { square[i] };
            dx[i] = if nearer { s } else { dx[i] };
            dy[i] = if nearer { t } else { dy[i] };
            own[i] = if nearer { 2.0 * part(16) - 1.0 } else { own[i] };
        }
    }
    let mut out = Domes { height: [0.0; N], slope: [[0.0; N]; 2], own };
    for i in 0..N {
        let inside = square[i] < 1.0;
        out.height[i] = if inside { 1.0 - square[i] } else { 0.0 };
        out.slope[0][i] = if inside { -2.0 * dx[i] } else { 0.0 };
        out.slope[1][i] = if inside { -2.0 * dy[i] } else { 0.0 };
    }
    out
}

/// A number that leaves no room for fractions in an `f32` to which it is added.
const WHOLE: f32 = 12_582_912.0;

/// The largest whole number that is not larger, of values between -4,000,000 and 4,000,000; of others an arbitrary one.
///
/// A conversion that saturates would keep loops from becoming vector instructions.
#[inline(always)]
pub fn floor(v: f32) -> i32 {
    let nearest = v + WHOLE;
    let whole = nearest.to_bits().wrapping_sub(WHOLE.to_bits()) as i32;
    whole.wrapping_sub(i32::from(nearest - WHOLE > v))
}

/// A pseudo-random value in -1..=1 of two whole numbers and a seed.
#[inline(always)]
pub fn hash(x: i32, y: i32, seed: u32) -> f32 {
    (bits(x, y, seed) >> 16) as i32 as f32 * (1.0 / 32_768.0) - 1.0
}

/// Pseudo-random bits of two whole numbers and a seed.
#[inline(always)]
pub fn bits(x: i32, y: i32, seed: u32) -> u32 {
    let mut h =
        (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_those_below() {
        for i in -4_000..4_000 {
            for v in [i as f32 * 0.0371, i as f32 * 999.7, i as f32, i as f32 + 0.5] {
                assert_eq!(floor(v), v.floor() as i32, "{v}");
            }
        }
    }

    #[test]
    fn noise_is_even_continuous_and_its_slope_is_its_change() {
        let (mut sum, mut square, n) = (0.0, 0.0, 20_000);
        for i in 0..n {
            let (x, y) = (i as f32 * 0.0173 - 90.0, 400.0 - i as f32 * 0.0311);
            let at = |x: f32, y: f32| value([&[x], &[y]], 7);
            let (here, [east, south]) = at(x, y);
            let h = 1e-2;
            assert!((at(x + h, y).0[0] - at(x - h, y).0[0] - 2.0 * h * east[0]).abs() < 4e-3, "{x} {y}");
            assert!((at(x, y + h).0[0] - at(x, y - h).0[0] - 2.0 * h * south[0]).abs() < 4e-3, "{x} {y}");
            (sum, square) = (sum + here[0], square + here[0] * here[0]);
        }
        let (mean, spread) = (sum / n as f32, (square / n as f32).sqrt());
        assert!(mean.abs() < 0.03 && (0.25..0.6).contains(&spread), "mean {mean}, spread {spread}");
    }

    #[test]
    fn domes_stand_apart_and_their_slope_is_their_change() {
        let (mut tops, mut inside) = (0, 0);
        for i in 0..20_000 {
            let (x, y) = (i as f32 * 0.0173 - 90.0, 400.0 - i as f32 * 0.0311);
            let at = |x: f32, y: f32| domes([&[x], &[y]], 5);
            let (here, h) = (at(x, y), 1e-2);
            assert!((0.0..=1.0).contains(&here.height[0]) && here.own[0].abs() <= 1.0);
            let (east, west) = (at(x + h, y), at(x - h, y));
            // Within a dome the slope changes evenly.
            let change = east.slope[0][0] - west.slope[0][0] + 4.0 * h;
            if change.abs() < 1e-4 && east.height[0] > 0.0 && west.height[0] > 0.0 {
                inside += 1;
                assert!((east.height[0] - west.height[0] - 2.0 * h * here.slope[0][0]).abs() < 2e-3, "{x} {y}");
            }
            tops += usize::from(here.height[0] > 0.9);
        }
        // Discs of a radius of 0.32, one in each square.
        assert!((5_000..7_500).contains(&tops), "{tops} of 20000 places on tops");
        assert!(inside > 15_000, "{inside} of 20000 places inside a dome");
    }

    #[test]
    fn whole_numbers_are_rounded_down() {
        assert_eq!([floor(-0.1), floor(-1.0), floor(0.0), floor(2.9), floor(-7.5)], [-1, -1, 0, 2, -8]);
    }
}
