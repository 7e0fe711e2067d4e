//! Tints of the ground without light, for programs that light it themselves.

use crate::shade::ground::palette::Tint;
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
    /// * `steep`: tangent of the slope, >= 0.
    pub fn color(&self, height_m: f64, steep: f64) -> [f32; 3] {
        self.0.colors(&[height_m as f32], &[steep as f32]).map(|[v]| v.clamp(0.0, 1.0))
    }
}
