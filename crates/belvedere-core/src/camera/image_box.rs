//! Images of boxes.

use glam::DVec2;

/// Conservative image of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageBox {
    /// Smallest pixel coordinates.
    pub min: DVec2,
    /// Largest pixel coordinates.
    pub max: DVec2,
    /// Smallest depth, scene units.
    pub depth_min: f64,
    /// Largest depth, scene units.
    pub depth_max: f64,
}

impl ImageBox {
    /// The box that contains nothing.
    pub const EMPTY: Self =
        Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY, depth_min: f64::INFINITY, depth_max: 0.0 };

    /// This box grown to contain `pixel` at `depth`.
    pub fn including(self, pixel: DVec2, depth: f64) -> Self {
        Self {
            min: self.min.min(pixel),
            max: self.max.max(pixel),
            depth_min: self.depth_min.min(depth),
            depth_max: self.depth_max.max(depth),
        }
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        self.including(other.min, other.depth_min).including(other.max, other.depth_max)
    }
}
