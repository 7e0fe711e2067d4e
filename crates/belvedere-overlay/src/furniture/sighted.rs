//! Places that the picture shows: what a pixel sees, and where a place lies on the picture.

use belvedere_core::{DVec2, DVec3, View};
use belvedere_scene::{LayerKind, Scene};
use belvedere_sight::trace::Tracer;

/// Largest relative depth by which a seen place may lie behind what its pixel shows.
const NO_DEEPER: f64 = 0.02;
/// Most points of lines and points that furniture keeps away from.
const MOST_POINTS: usize = 4000;

/// A scene in a view, prepared for rays.
pub(super) struct Sighted<'a> {
    scene: &'a Scene,
    pub(super) view: &'a View,
    tracer: Tracer<'a>,
    /// Pixels of the lines and points of the scene.
    features: Vec<DVec2>,
}

impl<'a> Sighted<'a> {
    pub(super) fn new(scene: &'a Scene, view: &'a View) -> Self {
        let mut points: Vec<DVec3> = Vec::new();
        for layer in &scene.layers {
            match &layer.kind {
                LayerKind::Line(line) => points.extend(line.features.iter().flat_map(|f| &f.points)),
                LayerKind::Point(point) => points.extend(point.features.iter().map(|f| f.position)),
                _ => {}
            }
        }
        let every = points.len().div_ceil(MOST_POINTS).max(1);
        let image = |p: &DVec3| view.project(*p).ok().map(|image| image.pixel);
        let features = points.iter().step_by(every).filter_map(image).collect();
        Self { scene, view, tracer: Tracer::new(scene, view), features }
    }

    /// Size of the picture, pixels.
    pub(super) fn size(&self) -> DVec2 {
        2.0 * self.view.pinhole().center_px()
    }

    /// Whether the scene has ground, on which things lie; else they are flat.
    pub(super) fn has_ground(&self) -> bool {
        self.scene.terrain().is_some()
    }

    /// The place that a pixel shows, on the ground where there is ground.
    pub(super) fn place(&self, pixel: DVec2) -> Option<DVec3> {
        let hit = self.tracer.first_hit(pixel)?;
        let is_ground = matches!(self.scene.layers.get(hit.layer)?.kind, LayerKind::Terrain(_));
        (is_ground || !self.has_ground()).then_some(hit.point)
    }

    /// A place on the drawn ground; at the height of `near` where there is no ground in the scene, `None` beside the ground.
    pub(super) fn laid(&self, xy: DVec2, near: DVec3) -> Option<DVec3> {
        match self.scene.terrain() {
            Some(ground) => ground.surface_at(xy).map(|z| xy.extend(z)),
            None => Some(xy.extend(near.z)),
        }
    }

    /// Pixel and depth of a place.
    pub(super) fn image(&self, p: DVec3) -> Option<(DVec2, f64)> {
        self.view.project(p).ok().filter(|image| !image.folded).map(|image| (image.pixel, image.depth))
    }

    /// Whether the picture shows a place, by its image.
    pub(super) fn shows(&self, (pixel, depth): (DVec2, f64)) -> bool {
        self.view.pinhole().contains(pixel)
            && self.tracer.first_hit(pixel).is_some_and(|hit| hit.depth >= depth * (1.0 - NO_DEEPER))
    }

    /// Pixels per scene unit to the east and to the north at a place, along a level plane.
    pub(super) fn per_unit(&self, p: DVec3) -> Option<[DVec2; 2]> {
        let (_, depth) = self.image(p)?;
        let step = 1e-3 * depth.max(1e-9);
        let along = |axis: DVec3| {
            let [a, b] = [self.image(p - step * axis)?.0, self.image(p + step * axis)?.0];
            Some((b - a) / (2.0 * step)).filter(|v| v.is_finite())
        };
        Some([along(DVec3::X)?, along(DVec3::Y)?])
    }

    /// Whether a line or point of the scene lies within a rectangle, pixels.
    pub(super) fn has_feature_in(&self, [lo, hi]: [DVec2; 2]) -> bool {
        self.features.iter().any(|p| p.cmpge(lo).all() && p.cmple(hi).all())
    }
}

/// Whether two rectangles overlap.
pub(super) fn overlap(a: &[DVec2; 2], b: &[DVec2; 2]) -> bool {
    a[0].cmplt(b[1]).all() && b[0].cmplt(a[1]).all()
}

/// The rectangle around points, grown by `by`; `None` without points.
pub(super) fn around(points: impl IntoIterator<Item = DVec2>, by: f64) -> Option<[DVec2; 2]> {
    let both = points.into_iter().map(|p| [p, p]).reduce(|[lo, hi], [a, b]| [lo.min(a), hi.max(b)])?;
    Some([both[0] - by, both[1] + by])
}
