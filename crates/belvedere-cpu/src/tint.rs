//! Tints of the ground without light, for programs that light it themselves.

use crate::shade::ground::palette::Tint;
use belvedere_core::DVec2;
use belvedere_scene::Palette;

/// Colours of ground by height and slope, as pictures show them before they are lit.
#[derive(Debug, Clone)]
pub struct GroundTint(Box<Tint>);

impl GroundTint {
    /// * `z_range_m`: heights that the ramp of the palette spans.
    pub fn new(palette: &Palette, z_range_m: [f64; 2]) -> Self {
        Self(Box::new(Tint::new(palette, z_range_m)))
    }

    /// Linear red, green and blue, 0..=1.
    ///
    /// * `height_m`: true height;
    /// * `slope`: rise to the east and to the north, metres per metre.
    pub fn color(&self, height_m: f64, slope: DVec2) -> [f32; 3] {
        let [r, g, b, _] = self.0.colors(&[height_m as f32], &[slope.length() as f32], &[-slope.y as f32]);
        [r, g, b].map(|[v]| v.clamp(0.0, 1.0))
    }
}
