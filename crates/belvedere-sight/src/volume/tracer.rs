//! The point at which a pixel shows a volume rather than the surface behind.

use super::absorb;
use crate::trace::{Part, RayHit, deepest};
use belvedere_core::{DVec2, View};
use belvedere_scene::{LayerKind, Scene};

/// The volumes of a scene, prepared for rays of one view.
pub struct VolumeTracer<'a> {
    scene: &'a Scene,
    view: &'a View,
    range: [f64; 2],
}

impl<'a> VolumeTracer<'a> {
    /// Prepares the volumes of `scene`.
    pub fn new(scene: &'a Scene, view: &'a View) -> Self {
        let far = view.pinhole().far.unwrap_or(f64::INFINITY);
        Self { scene, view, range: [view.pinhole().near, deepest(scene, view).min(far)] }
    }

    /// The point where a volume has absorbed half of the light along the ray of `pixel`, nearer than `before` (scene units of depth), sampled
    /// as by the exact renderer; `None` if no volume absorbs half.
    pub fn first_hit(&self, pixel: DVec2, before: f64) -> Option<RayHit> {
        let range = [self.range[0], self.range[1].min(before)];
        let hits = self.scene.layers.iter().enumerate().filter_map(|(layer, l)| match &l.kind {
            LayerKind::Volume(volume) => {
                let (depth, point) = absorb(self.view, volume, pixel, range, |_| {}).half?;
                let segment = self.view.ray(pixel).at(depth).map_or(0, |p| p.segment);
                Some(RayHit { layer, depth, point, segment, part: Part::Voxels })
            }
            _ => None,
        });
        hits.min_by(|a, b| a.depth.total_cmp(&b.depth))
    }
}
