//! Lines of sight to points of lines and point layers, through the exact tracer.

use crate::marks::path::LinePoint;
use crate::screen::Screen;
use crate::sections::{Exposure, Sections};
use crate::trace::Tracer;
use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{LayerKind, Scene};
use std::sync::OnceLock;

/// Terrain with more nodes is not prepared for lines of sight in every frame.
const MAX_NODES: usize = 64 << 20;
/// A surface nearer than a point by less than this share of its depth, or of a pixel's width there, does not hide it: rounding.
const SLACK: f64 = 1e-6;
const SLACK_PX: f64 = 0.05;

/// Tests lines of sight against the surfaces themselves; the tracer is prepared on first use.
pub(crate) struct LineOfSight<'a> {
    scene: &'a Scene,
    view: &'a View,
    sections: Option<&'a Sections<'a>>,
    tracer: OnceLock<Option<Tracer<'a>>>,
}

impl<'a> LineOfSight<'a> {
    pub(crate) fn new(scene: &'a Scene, view: &'a View, sections: Option<&'a Sections<'a>>) -> Self {
        Self { scene, view, sections, tracer: OnceLock::new() }
    }

    /// The point itself, moved exactly onto the drawn surface if its line lies on the ground.
    pub(crate) fn on_surface(&self, on_line: &LinePoint, lift_m: f64) -> DVec3 {
        let p = on_line.p;
        let height =
            if on_line.on_ground { self.scene.terrain().and_then(|hf| hf.surface_at(p.truncate())) } else { None };
        height.map_or(p, |z| p.with_z(z + lift_m))
    }

    /// Whether no surface lies before `depth` on the ray of `pixel`; `None` if that cannot be decided.
    pub(crate) fn sees(&self, screen: &Screen, pixel: DVec2, depth: f64) -> Option<bool> {
        let tracer = self.tracer.get_or_init(|| self.prepare()).as_ref()?;
        let slack = SLACK * depth + SLACK_PX * screen.footprint(depth);
        Some(tracer.first_hit(pixel).is_none_or(|hit| hit.depth >= depth - slack))
    }

    fn prepare(&self) -> Option<Tracer<'a>> {
        let nodes: usize = self
            .scene
            .layers
            .iter()
            .map(|l| match &l.kind {
                LayerKind::Terrain(t) => t.heightfield.cols() * t.heightfield.rows(),
                _ => 0,
            })
            .sum();
        (nodes <= MAX_NODES).then(|| Tracer::exposed(self.scene, self.view, self.sections.cloned(), Exposure::even()))
    }
}
