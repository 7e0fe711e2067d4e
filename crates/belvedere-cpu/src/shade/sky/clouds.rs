//! Quiet clouds: noise on a level far above, so that they are large overhead and lie in bands near the skyline.

use belvedere_composite::color::{Rgb, smoothstep};
use belvedere_composite::noise;

/// Height of the level over the skyline, in units of the elevation at which clouds begin, and clouds in such a unit.
const LEVEL: f32 = 0.14;
const PER_UNIT: f32 = 1.1;
/// How much longer clouds are from west to east.
const LONG: f32 = 1.7;
/// Sizes of the noise, each half of the one before and so much weaker.
const SIZES: u32 = 5;
const WEAKER: f32 = 0.52;
/// Spread of the noise, whose values are about those of a logistic distribution; and the width of the edges of clouds.
const SPREAD: f64 = 0.256;
const EDGE: f32 = 0.5;
/// Least and largest share for which that distribution holds.
const SHARES: [f64; 2] = [0.003, 0.985];
/// Elevations between which clouds appear over the skyline, and the most that they hide of the sky.
const RISEN: [f32; 2] = [0.015, 0.13];
const THICKEST: f32 = 0.86;
const SEED: u32 = 911;

/// Clouds of a sky.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clouds {
    from: f32,
    /// Square roots of their linear colour.
    root: Rgb,
}

impl Clouds {
    /// * `share`: part of the sky that they cover, about, 0..=1; `None` for 0;
    /// * `horizon`: linear colour of the sky at the horizon, which they have.
    pub(super) fn new(share: f64, horizon: Rgb) -> Option<Self> {
        let [least, most] = SHARES;
        let shown = share.clamp(least, most);
        let from = (SPREAD * ((1.0 - shown) / shown).ln()) as f32 - 0.43 * EDGE;
        let root = horizon.to_array().map(f32::sqrt);
        (share > 0.0).then(|| Self { from, root: Rgb::from_array(root) })
    }

    /// Square root of the colour of a sky with its clouds.
    /// * `root`: without them; `ahead`: direction on the map, east and north, of any length; `risen`: elevation over the skyline.
    #[inline]
    pub(super) fn over(&self, root: Rgb, ahead: [f32; 2], risen: f32) -> Rgb {
        let shown = THICKEST * smoothstep(RISEN[0], RISEN[1], risen);
        if shown <= 0.0 {
            return root;
        }
        let length = ahead[0].hypot(ahead[1]).max(1e-6);
        let far = PER_UNIT / (risen + LEVEL) / length;
        let [mut x, mut y] = [far * ahead[0] / LONG, far * ahead[1]];
        let (mut sum, mut strength) = (0.0, 1.0 - WEAKER);
        for k in 0..SIZES {
            let ([value], _) = noise::value([&[x], &[y]], SEED + k);
            sum += strength * value;
            strength *= WEAKER;
            // Turned from size to size, so that no lattice shows.
            [x, y] = [1.6 * x - 1.2 * y + 7.3, 1.2 * x + 1.6 * y - 3.1];
        }
        let thick = smoothstep(self.from, self.from + EDGE, 1.6 * sum);
        root.lerp(self.root, shown * thick)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of the sky that is hidden by more than a third.
    fn covered(share: f64) -> f64 {
        let Some(clouds) = Clouds::new(share, Rgb::ONE) else { return 0.0 };
        let mut hidden = 0;
        for i in 0..200 {
            let azimuth = i as f32 * 0.0314;
            for j in 0..50 {
                let root = clouds.over(Rgb::ZERO, [azimuth.sin(), azimuth.cos()], 0.15 + 0.01 * j as f32);
                assert!((0.0..=1.0).contains(&root.x) && root.x == root.z);
                hidden += usize::from(root.x > 0.33);
            }
        }
        hidden as f64 / 10_000.0
    }

    #[test]
    fn clouds_cover_about_the_share_that_is_asked_for_and_leave_the_skyline_clear() {
        for share in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
            let covered = covered(share);
            assert!((covered - share).abs() < 0.13, "{share} asked for, {covered} covered");
        }
        let clouds = Clouds::new(1.0, Rgb::ONE).expect("clouds");
        assert_eq!(clouds.over(Rgb::ZERO, [0.3, 0.8], 0.01), Rgb::ZERO);
        assert_eq!(clouds.over(Rgb::ZERO, [0.3, 0.8], -0.2), Rgb::ZERO);
    }
}
