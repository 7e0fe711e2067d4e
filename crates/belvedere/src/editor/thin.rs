//! Widths of lines and letters in coarse pictures, so that they look as wide on the screen as those of the picture at rest.

use belvedere_scene::{LayerKind, OverlayLine, Scene};
use std::sync::Arc;

/// Letters smaller than this cannot be read, pixels.
const LEGIBLE_PX: f64 = 7.0;
/// Height of the letters of a grid, pixels, about.
const GRID_PX: f64 = 14.0;

/// The scene of the last coarse picture.
#[derive(Debug, Default)]
pub(super) struct Thin {
    of: Option<(Arc<Scene>, f64, Arc<Scene>)>,
}

impl Thin {
    /// The scene with line widths for a coarse picture.
    ///
    /// * `scale`: width of the coarse picture as a share of the full width, 0..=1.
    pub(super) fn scene(&mut self, scene: Arc<Scene>, scale: f64) -> Arc<Scene> {
        let has_marks =
            |kind: &LayerKind| matches!(kind, LayerKind::Line(_) | LayerKind::Area(_) | LayerKind::Point(_));
        if scale >= 1.0 || !scene.layers.iter().any(|layer| has_marks(&layer.kind)) {
            return scene;
        }
        match &self.of {
            Some((of, at, thin)) if Arc::ptr_eq(of, &scene) && *at == scale => thin.clone(),
            _ => {
                let thin = Arc::new(thinned(&scene, scale));
                self.of = Some((scene, scale, thin.clone()));
                thin
            }
        }
    }
}

fn thinned(scene: &Scene, scale: f64) -> Scene {
    let mut scene = scene.clone();
    let letters = |px: Option<f64>| px.map(|px| px * scale).filter(|px| *px >= LEGIBLE_PX);
    for layer in &mut scene.layers {
        match &mut layer.kind {
            LayerKind::Line(line) => {
                (line.width_px, line.label_px) = (line.width_px * scale, letters(line.label_px));
                // Distances are written as large as the letters of a grid.
                line.markers = line.markers.filter(|_| GRID_PX * scale >= LEGIBLE_PX);
            }
            LayerKind::Area(area) => area.width_px *= scale,
            LayerKind::Point(point) => {
                (point.size_px, point.style.label_px) = (point.size_px * scale, letters(point.style.label_px));
            }
            _ => {}
        }
    }
    scene
}

/// A line of the grid with the same scaling.
pub(super) fn line(line: OverlayLine, scale: f64) -> OverlayLine {
    let label = if GRID_PX * scale >= LEGIBLE_PX { line.label } else { String::new() };
    OverlayLine { width_px: line.width_px * scale.min(1.0), label, ..line }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::{Color, Layer, LineLayer};

    #[test]
    fn lines_are_as_thin_as_the_picture_is_coarse_and_made_once() {
        let layer = Layer {
            id: "way".into(),
            must_see: true,
            kind: LayerKind::Line(LineLayer::new(Vec::new(), Color::rgb(1, 2, 3))),
        };
        let scene = Arc::new(Scene { layers: vec![layer], ..Scene::default() });
        let mut thin = Thin::default();
        assert!(Arc::ptr_eq(&thin.scene(scene.clone(), 1.0), &scene), "nothing to do");
        let half = thin.scene(scene.clone(), 0.5);
        let LayerKind::Line(line) = &half.layers[0].kind else { panic!("no line") };
        assert_eq!((line.width_px, half.layers[0].must_see), (1.5, true));
        assert!(Arc::ptr_eq(&thin.scene(scene, 0.5), &half), "made twice");
    }
}
