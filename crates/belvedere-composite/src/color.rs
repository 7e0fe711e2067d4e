//! Linear light, and its storage as sRGB or 16-bit square roots.

use std::sync::LazyLock;

/// Linear red, green, blue; 1 = white.
pub type Rgb = glam::Vec3A;

/// Linear value of every 8-bit sRGB value.
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let s = i as f32 / 255.0;
        if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
    })
});

/// sRGB values by the square root of linear light.
pub type Encoding = [u8; 4096];

/// sRGB value of the square of `(i + 0.5) / 4096`.
static ENCODED: LazyLock<Encoding> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let l = ((i as f32 + 0.5) / 4096.0).powi(2);
        let s = if l <= 0.003_130_8 { 12.92 * l } else { 1.055 * l.powf(1.0 / 2.4) - 0.055 };
        (s * 255.0 + 0.5) as u8
    })
});

/// First index in [`ENCODED`] of every value 0..=255; the entries after these are its length.
static FIRST: LazyLock<[i32; 260]> =
    LazyLock::new(|| std::array::from_fn(|v| ENCODED.partition_point(|e| usize::from(*e) < v) as i32));

/// Encodes square roots of linear light as sRGB by tables.
#[derive(Debug, Clone, Copy)]
pub struct Encoder {
    encoded: &'static Encoding,
    first: &'static [i32; 260],
}

/// Values that are stored together.
pub const LANES: usize = 32;
/// Pixels that are written together.
pub const PIXELS: usize = 8 * LANES;

impl Default for Encoder {
    fn default() -> Self {
        Self { encoded: &ENCODED, first: &FIRST }
    }
}

impl Encoder {
    /// sRGB values by square roots of linear light.
    #[inline(always)]
    pub fn encode(self, roots: &[f32; LANES]) -> [u8; LANES] {
        let mut out = [0; LANES];
        for i in 0..LANES {
            out[i] = self.encoded[place(roots[i]) as usize & (self.encoded.len() - 1)];
        }
        out
    }

    /// The same for values between `least` and `most`, fast where these differ by few steps.
    #[inline(always)]
    pub fn encode_between(self, roots: &[f32; LANES], [least, most]: [f32; 2]) -> [u8; LANES] {
        let mask = self.encoded.len() - 1;
        let (least, most) = (self.encoded[place(least) as usize & mask], self.encoded[place(most) as usize & mask]);
        if most.wrapping_sub(least) > 3 {
            return self.encode(roots);
        }
        let [_, a, b, c] = self.first[usize::from(least)..].first_chunk().copied().unwrap_or_default();
        let mut out = [0; LANES];
        for i in 0..LANES {
            let at = place(roots[i]);
            let steps = i32::from(at >= a) + i32::from(at >= b) + i32::from(at >= c);
            out[i] = (i32::from(least) + steps) as u8;
        }
        out
    }
}

/// Index in [`Encoding`].
#[inline(always)]
fn place(root: f32) -> i32 {
    i32::from(sixteen_bits(root) >> 4)
}

/// sRGB values by the upper 12 of the 16 bits of a square root.
pub fn encoding() -> &'static Encoding {
    &ENCODED
}

/// sRGB to linear light.
#[inline]
pub fn linear(rgb: [u8; 3]) -> Rgb {
    let t = &*LINEAR;
    Rgb::new(t[rgb[0] as usize], t[rgb[1] as usize], t[rgb[2] as usize])
}

/// sRGB in 0..=1 to linear light.
pub fn linear_of(rgb: [f32; 3]) -> Rgb {
    let of = |s: f32| if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
    Rgb::from_array(rgb.map(of))
}

/// Linear light to sRGB.
#[inline]
pub fn encode(c: Rgb) -> [u8; 3] {
    Packed::new(c).encode(encoding())
}

/// The nearest of the whole numbers to 65535 times a value in 0..=1.
#[inline(always)]
pub fn sixteen_bits(v: f32) -> u16 {
    let v = v * 65535.0;
    // In this order NaN becomes 0.
    let v = if v > 0.0 { v } else { 0.0 };
    let v = if v < 65535.0 { v } else { 65535.0 };
    // Adding 2^23 leaves the rounded integer in the low bits of the mantissa.
    (v + 8_388_608.0).to_bits() as u16
}

/// Adding it leaves the rounded integer in the low bits of the mantissa.
const ROUND: f32 = 12_582_912.0;

/// The nearest integer of a value between -2^22 and 2^22, arbitrary beyond. It takes one addition, unlike `as`, which handles all
/// values.
#[inline(always)]
pub fn nearest(v: f32) -> i32 {
    ((v + ROUND).to_bits() as i32).wrapping_sub(ROUND.to_bits() as i32)
}

/// Linear light kept in 16 bits per channel, by square root so that dark tones keep their steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Packed([u16; 3]);

impl Packed {
    /// Keeps linear light; negative light counts as none, more than 1 as 1.
    #[inline]
    pub fn new(c: Rgb) -> Self {
        Self(c.to_array().map(|v| sixteen_bits(v.max(0.0).sqrt())))
    }

    /// From square roots of linear light.
    #[inline(always)]
    pub fn of_roots(root: [u16; 3]) -> Self {
        Self(root)
    }

    /// The square roots of linear light, 65535 for 1.
    #[inline(always)]
    pub fn roots(self) -> [u16; 3] {
        self.0
    }

    /// sRGB, as [`encode`] gives it.
    #[inline(always)]
    pub fn encode(self, encoding: &Encoding) -> [u8; 3] {
        self.0.map(|v| encoding[usize::from(v >> 4)])
    }

    /// Linear light.
    #[inline]
    pub fn rgb(self) -> Rgb {
        let [r, g, b] = self.0.map(|v| f32::from(v) / 65535.0);
        Rgb::new(r * r, g * g, b * b)
    }
}

/// 0 below `a`, 1 above `b`, smooth between; a step where they coincide.
#[inline]
pub fn smoothstep(a: f32, b: f32, x: f32) -> f32 {
    let t = if b > a { ((x - a) / (b - a)).clamp(0.0, 1.0) } else { f32::from(u8::from(x >= a)) };
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stored_together_are_those_stored_alone() {
        let encoder = Encoder::default();
        for from in (-20..1300).map(|k| k as f32 / 1255.0) {
            for step in [0.0, 1e-5, 2e-4, 3e-4, -4e-4, 2e-3, -0.02, f32::NAN] {
                let roots: [f32; LANES] = std::array::from_fn(|i| from + step * i as f32);
                let want = roots.map(|root| Packed::of_roots([sixteen_bits(root); 3]).encode(encoding())[0]);
                let ends = [0, 1].map(|k| if (step < 0.0) == (k == 0) { roots[LANES - 1] } else { roots[0] });
                assert_eq!(encoder.encode(&roots), want);
                assert_eq!(encoder.encode_between(&roots, ends), want, "{from} {step}");
            }
        }
    }

    #[test]
    fn every_srgb_value_survives_linear_light_and_packing() {
        for v in 0..=255u8 {
            assert_eq!(encode(linear([v; 3])), [v; 3]);
            assert_eq!(encode(Packed::new(linear([v; 3])).rgb()), [v; 3]);
            assert_eq!(Packed::new(linear([v; 3])).encode(encoding()), [v; 3]);
        }
    }
}
