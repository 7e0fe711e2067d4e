//! Lines of sight to points of lines and point layers.

use crate::drawn::Sight;
use crate::marks::path::LinePoint;
use belvedere_core::{DVec2, DVec3};
use belvedere_scene::Scene;
use belvedere_sight::screen::Screen;

/// A surface nearer than a point by less than this share of its depth, or of a pixel's width there, does not hide it: rounding.
const SLACK: f64 = 1e-6;
const SLACK_PX: f64 = 0.05;

/// Tests lines of sight against the surfaces themselves.
pub(crate) struct LineOfSight<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) sight: &'a dyn Sight,
}

impl LineOfSight<'_> {
    /// The point itself, moved exactly onto the drawn surface if its line lies on the ground.
    pub(crate) fn on_surface(&self, on_line: &LinePoint, lift_m: f64) -> DVec3 {
        let p = on_line.p;
        let height =
            if on_line.on_ground { self.scene.terrain().and_then(|hf| hf.surface_at(p.truncate())) } else { None };
        height.map_or(p, |z| p.with_z(z + lift_m))
    }

    /// Whether no surface lies before `depth` on the ray of `pixel`; `None` if that cannot be decided.
    pub(crate) fn sees(&self, screen: &Screen, pixel: DVec2, depth: f64) -> Option<bool> {
        let first = self.sight.first_depth(pixel)?;
        Some(first >= depth - (SLACK * depth + SLACK_PX * screen.footprint(depth)))
    }
}
