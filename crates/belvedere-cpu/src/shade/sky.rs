//! Sky and haze.

use super::color::{Rgb, linear, smoothstep};
use crate::lens::Lens;
use belvedere_core::{Aabb, DVec2, DVec3, Pinhole};

/// Thresholds of ordered dithering, 8 x 8 (Bayer 1973), each 0..64 once.
const BAYER: [[u8; 8]; 8] = [
    [0, 32, 8, 40, 2, 34, 10, 42],
    [48, 16, 56, 24, 50, 18, 58, 26],
    [12, 44, 4, 36, 14, 46, 6, 38],
    [60, 28, 52, 20, 62, 30, 54, 22],
    [3, 35, 11, 43, 1, 33, 9, 41],
    [51, 19, 59, 27, 49, 17, 57, 25],
    [15, 47, 7, 39, 13, 45, 5, 37],
    [63, 31, 55, 23, 61, 29, 53, 21],
];

/// Largest share of a colour that haze takes.
const THICKEST: f32 = 0.62;

/// Colours of the air.
#[derive(Debug)]
pub(crate) struct Sky {
    zenith: Rgb,
    middle: Rgb,
    horizon: Rgb,
    below: Rgb,
    haze: Rgb,
    /// Depths of the nearest and the farthest point that the scene can have, scene units.
    depths: [f32; 2],
}

impl Sky {
    /// * `bounds`: of everything in the scene.
    pub(crate) fn new(bounds: &Aabb, pinhole: &Pinhole) -> Self {
        let depths = if bounds.is_empty() {
            [0.0, 1.0]
        } else {
            let depth = |p: DVec3| (p - pinhole.eye).dot(pinhole.forward);
            let near = depth(pinhole.eye.clamp(bounds.min, bounds.max)).max(0.0);
            let far = bounds.corners().into_iter().map(depth).fold(near, f64::max);
            [near as f32, far as f32]
        };
        Self {
            zenith: linear([88, 136, 188]),
            middle: linear([140, 181, 216]),
            horizon: linear([224, 232, 236]),
            below: linear([203, 213, 220]),
            haze: linear([186, 205, 224]),
            depths,
        }
    }

    /// Sky in the direction of a pixel, dithered by one step of an 8-bit picture so that its slow changes show no bands.
    pub(crate) fn at(&self, lens: &Lens, pixel: DVec2) -> Rgb {
        let [x, y] = [pixel.x, pixel.y].map(|v| v.max(0.0) as usize % 8);
        let threshold = (f32::from(BAYER[y][x]) + 0.5) / 64.0 - 0.5;
        // Square roots of linear light are nearly even in 8-bit steps.
        let root = self.towards(lens.direction(pixel).z as f32).to_array().map(|v| v.sqrt() + threshold / 255.0);
        Rgb::from_array(root.map(|v| v * v))
    }

    /// Sky at an elevation, given its sine.
    pub(crate) fn towards(&self, sine: f32) -> Rgb {
        if sine < 0.0 {
            return self.horizon.lerp(self.below, smoothstep(0.0, 0.25, -sine));
        }
        let low = 1.0 - (-sine / 0.10).exp();
        let high = smoothstep(0.0, 0.7, sine);
        self.horizon.lerp(self.middle, low).lerp(self.zenith, high)
    }

    /// `color` seen through the air at `depth`: full contrast over the nearer part of the scene, then slowly paler.
    pub(crate) fn through_air(&self, color: Rgb, depth: f32) -> Rgb {
        let [near, far] = self.depths;
        let t = (depth - near) / (far - near).max(1e-6);
        color.lerp(self.haze, THICKEST * smoothstep(0.22, 1.15, t))
    }
}
