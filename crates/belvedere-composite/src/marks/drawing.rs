//! Symbols of a scene's own, drawn over the finished picture.

use crate::canvas::Canvas;
use belvedere_core::DVec2;
use belvedere_scene::{Color, Drawing};
use std::sync::Arc;

/// A drawing at a point.
#[derive(Debug, Clone)]
pub(super) struct PlacedDrawing {
    pub(super) drawing: Arc<Drawing>,
    /// Pixels.
    pub(super) at: DVec2,
    /// Half its size, pixels.
    pub(super) half_px: f64,
    /// Colour of shapes that have none.
    pub(super) color: Color,
    /// 0..=1.
    pub(super) opacity: f32,
}

impl PlacedDrawing {
    pub(super) fn draw(&self, canvas: &mut Canvas<'_>) {
        for (rings, color) in &self.drawing.shapes {
            let color = color.unwrap_or(self.color);
            let alpha = (f32::from(color.a) * self.opacity).round() as u8;
            let rings: Vec<Vec<DVec2>> =
                rings.iter().map(|ring| ring.iter().map(|p| self.at + self.half_px * *p).collect()).collect();
            canvas.polygon(rings.iter().map(Vec::as_slice), color.with_alpha(alpha));
        }
    }
}
