//! Widths of lines and letters in coarse pictures, so that they look as wide on the screen as those of the picture at rest.

use crate::overlays::widths;
use belvedere_scene::{OverlayLine, Scene};
use std::sync::Arc;

/// The scene of the last coarse picture.
#[derive(Debug, Default)]
pub(super) struct Thin {
    of: Option<(Arc<Scene>, f64, Arc<Scene>)>,
}

impl Thin {
    /// The scene with line widths for a coarse picture.
    ///
    /// * `scale`: width of the coarse picture as a share of the full width, times the pixels per point of the screen.
    pub(super) fn scene(&mut self, scene: Arc<Scene>, scale: f64) -> Arc<Scene> {
        if scale == 1.0 || !widths::has_any(&scene) {
            return scene;
        }
        match &self.of {
            Some((of, at, thin)) if Arc::ptr_eq(of, &scene) && *at == scale => thin.clone(),
            _ => {
                let thin = Arc::new(widths::scaled(&scene, scale).into_owned());
                self.of = Some((scene, scale, thin.clone()));
                thin
            }
        }
    }
}

/// A line of the grid with the same scaling.
pub(super) fn line(line: OverlayLine, scale: f64) -> OverlayLine {
    widths::line(line, scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::{Color, Layer, LayerKind, LineLayer};

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
