//! Subtle textures that are fixed to the map, at the finest scale that does not shimmer.

use belvedere_core::DVec2;

/// Size of the grain, pixels: much finer would shimmer.
const GRAIN_PX: f64 = 6.0;

/// A stipple in -1..=1 at a point of the map.
/// * `px`: longest extent on the map of a pixel there, scene units.
///
/// Two grains whose sizes differ by a factor of two are cross-faded, so that the grain neither grows nor jumps as the eye
/// approaches.
pub(crate) fn stipple(xy: DVec2, px: f64) -> f32 {
    let octave = (GRAIN_PX * px).max(1e-9).log2();
    let (fine, share) = (octave.floor(), octave.fract().rem_euclid(1.0) as f32);
    let grain = |size: f64| noise(xy / size.exp2());
    let spread = ((1.0 - share) * (1.0 - share) + share * share).sqrt();
    ((1.0 - share) * grain(fine) + share * grain(fine + 1.0)) / spread
}

/// Smooth noise between random values on whole numbers, -1..=1.
fn noise(p: DVec2) -> f32 {
    let cell = p.floor();
    let t = (p - cell).as_vec2();
    let s = t * t * (3.0 - 2.0 * t);
    let (x, y) = (cell.x as i64, cell.y as i64);
    let at = |i: i64, j: i64| value(x.wrapping_add(i), y.wrapping_add(j));
    let (a, b) = (at(0, 0) + s.x * (at(1, 0) - at(0, 0)), at(0, 1) + s.x * (at(1, 1) - at(0, 1)));
    a + s.y * (b - a)
}

/// A pseudo-random value in -1..=1 of two whole numbers.
fn value(x: i64, y: i64) -> f32 {
    // The steps of splitmix64 (Steele, Lea, Flood 2014).
    let mut h = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (y as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (((h ^ (h >> 31)) >> 40) as f32) / 8_388_608.0 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grain_is_even_fixed_to_the_map_and_changes_slowly() {
        let (mut sum, mut n) = (0.0, 0.0);
        for i in 0..20_000 {
            let p = DVec2::new(f64::from(i) * 13.37 - 9e4, f64::from(i % 173) * 7.1);
            let px = 0.3 * 1.0003f64.powi(i);
            let here = stipple(p, px);
            assert!(here.abs() <= 1.42);
            // A step of a tenth of a pixel, or a slightly nearer eye, hardly changes it.
            assert!((stipple(p + DVec2::X * 0.1 * px, px) - here).abs() < 0.2, "{p} {px}");
            assert!((stipple(p, 1.01 * px) - here).abs() < 0.1, "{p} {px}");
            (sum, n) = (sum + here, n + 1.0f32);
        }
        assert!((sum / n).abs() < 0.03, "mean {}", sum / n);
    }
}
