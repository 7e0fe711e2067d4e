//! Sky and haze.

use super::color::{Rgb, linear, smoothstep};
use crate::lens::Lens;
use belvedere_core::{Aabb, DVec2};

/// Colours of the air.
#[derive(Debug)]
pub(crate) struct Sky {
    zenith: Rgb,
    middle: Rgb,
    horizon: Rgb,
    below: Rgb,
    haze: Rgb,
    /// Depth at which haze has taken 63 %, scene units.
    haze_length: f32,
}

impl Sky {
    pub(crate) fn new(bounds: &Aabb) -> Self {
        let diagonal = if bounds.is_empty() { 1.0 } else { (bounds.max - bounds.min).truncate().length() };
        Self {
            zenith: linear([92, 138, 186]),
            middle: linear([142, 182, 215]),
            horizon: linear([222, 231, 236]),
            below: linear([203, 213, 220]),
            haze: linear([190, 208, 226]),
            haze_length: (0.42 * diagonal).max(1e-6) as f32,
        }
    }

    /// Sky in the direction of a pixel.
    pub(crate) fn at(&self, lens: &Lens, pixel: DVec2) -> Rgb {
        self.towards(lens.direction(pixel).z as f32)
    }

    /// Sky at an elevation, given its sine.
    pub(crate) fn towards(&self, sine: f32) -> Rgb {
        if sine < 0.0 {
            return self.horizon.lerp(self.below, smoothstep(0.0, 0.25, -sine));
        }
        let low = 1.0 - (-sine / 0.085).exp();
        let high = smoothstep(0.02, 0.75, sine);
        self.horizon.lerp(self.middle, low).lerp(self.zenith, high)
    }

    /// `color` seen through the air at `depth`.
    pub(crate) fn through_air(&self, color: Rgb, depth: f32) -> Rgb {
        let d = depth.max(0.0) / self.haze_length;
        // Slow at first, so that the foreground keeps its contrast.
        let share = 1.0 - (-(d * d) / (0.25 + d)).exp();
        color.lerp(self.haze, 0.88 * share)
    }
}
