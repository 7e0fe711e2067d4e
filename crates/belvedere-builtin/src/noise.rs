//! Seeded random numbers and gradient noise that give the same bits on every platform: integer hashes and + - * / only.

use belvedere_core::DVec2;
pub(crate) use belvedere_core::random::Random;
use belvedere_core::random::mix;

/// The generator of a built-in scene.
pub(crate) fn seeded(seed: u64) -> Random {
    Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bf0_3635)
}

/// Hash in [0, 1) of seed, place and stream.
pub(crate) fn hash_unit(seed: u64, place: u64, stream: u64) -> f64 {
    let bits = mix(mix(seed ^ stream.wrapping_mul(0x9e37_79b9_7f4a_7c15)).wrapping_add(place));
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Unit vectors 22.5 degrees apart, written out because sine and cosine differ between platforms in the last bit.
pub(crate) const DIRECTIONS: [DVec2; 16] = {
    const A: f64 = 0.923_879_532_511_286_7;
    const B: f64 = 0.382_683_432_365_089_8;
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        DVec2::new(1.0, 0.0),
        DVec2::new(A, B),
        DVec2::new(D, D),
        DVec2::new(B, A),
        DVec2::new(0.0, 1.0),
        DVec2::new(-B, A),
        DVec2::new(-D, D),
        DVec2::new(-A, B),
        DVec2::new(-1.0, 0.0),
        DVec2::new(-A, -B),
        DVec2::new(-D, -D),
        DVec2::new(-B, -A),
        DVec2::new(0.0, -1.0),
        DVec2::new(B, -A),
        DVec2::new(D, -D),
        DVec2::new(A, -B),
    ]
};

/// Gradient noise over the plane, about -1..1, without a period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise {
    seed: u64,
}

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self { seed: mix(seed ^ 0x006e_6f69_7365) }
    }

    fn gradient(&self, cx: i64, cy: i64) -> DVec2 {
        let h = mix(self.seed
            ^ (cx as u64).wrapping_mul(0x8da6_b343_d8f1_a8c5)
            ^ (cy as u64).wrapping_mul(0xd816_3841_ca72_3f1d));
        DIRECTIONS[(h >> 60) as usize]
    }

    /// Noise of unit wavelength (Perlin 2002 fade), about -1..1.
    pub(crate) fn at(&self, p: DVec2) -> f64 {
        let cell = p.floor();
        let (cx, cy, f) = (cell.x as i64, cell.y as i64, p - cell);
        let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        let corner = |dx: i64, dy: i64| self.gradient(cx + dx, cy + dy).dot(f - DVec2::new(dx as f64, dy as f64));
        let (u, v) = (fade(f.x), fade(f.y));
        let north = corner(0, 0) + u * (corner(1, 0) - corner(0, 0));
        let south = corner(0, 1) + u * (corner(1, 1) - corner(0, 1));
        1.5 * (north + v * (south - north))
    }

    /// Sum of octaves, each half as long and half as strong, about -1..1.
    pub(crate) fn fbm(&self, p: DVec2, octaves: u32) -> f64 {
        let (mut sum, mut weight, mut scale) = (0.0, 0.5, 1.0);
        for k in 0..octaves {
            sum += weight * self.at(p * scale + DVec2::splat(17.3 * f64::from(k)));
            weight *= 0.5;
            scale *= 2.0;
        }
        sum
    }

    /// Ridged multifractal (Musgrave 1994), 0..1: crests where the noise changes sign, rougher where it is high.
    pub(crate) fn ridged(&self, p: DVec2, octaves: u32) -> f64 {
        let (mut sum, mut amplitude, mut scale, mut weight, mut total) = (0.0, 1.0, 1.0, 1.0f64, 0.0);
        for k in 0..octaves {
            let crest = 1.0 - self.at(p * scale + DVec2::splat(31.7 * f64::from(k))).abs().min(1.0);
            let signal = crest * crest * weight;
            sum += amplitude * signal;
            total += amplitude;
            weight = (2.0 * signal).clamp(0.0, 1.0);
            amplitude *= 0.5;
            scale *= 2.1;
        }
        sum / total
    }
}
