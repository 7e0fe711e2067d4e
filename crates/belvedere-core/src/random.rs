//! Seeded random numbers: the same seed gives the same numbers on every machine.

use crate::{Aabb, DMat3, DVec3};

/// SplitMix64 (Steele, Lea, Flood 2014): small, seedable, good enough to scatter points.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Generator for `seed`; every seed is valid.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// Uniform number in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform number in `[low, high)`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform integer in `0..n` (`n` > 0; the bias is below 1e-9 for n below a million).
    pub fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    /// Uniform point of a box.
    pub fn point(&mut self, bounds: &Aabb) -> DVec3 {
        let t = DVec3::new(self.unit(), self.unit(), self.unit());
        bounds.min + t * (bounds.max - bounds.min)
    }

    /// Uniform unit vector.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.range(-1.0, 1.0);
        let turn = self.range(0.0, std::f64::consts::TAU);
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * turn.cos(), r * turn.sin(), z)
    }

    /// Rotation by a random angle about a random axis.
    pub fn rotation(&mut self) -> DMat3 {
        let axis = self.direction();
        DMat3::from_axis_angle(axis, self.range(-3.0, 3.0))
    }
}

/// The finalizer of SplitMix64: bits that look random, the same for the same input.
pub fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_published_generator() {
        let mut r = Random::new(1_234_567);
        assert_eq!([r.bits(), r.bits()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn unit_numbers_stay_below_one_and_average_a_half() {
        let mut r = Random::new(7);
        let numbers: Vec<f64> = (0..10_000).map(|_| r.unit()).collect();
        assert!(numbers.iter().all(|x| (0.0..1.0).contains(x)));
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        assert!((mean - 0.5).abs() < 0.02, "mean {mean}");
    }
}
