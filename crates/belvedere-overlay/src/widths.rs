//! Widths of lines and marks, and heights of names, in a picture whose pixels are smaller or larger than those of the scene.

use belvedere_scene::{LayerKind, OverlayLine, Scene};
use std::borrow::Cow;

/// Letters smaller than this cannot be read, pixels.
const LEGIBLE_PX: f64 = 7.0;

/// Whether a scene has anything whose width is stated in pixels.
pub fn has_any(scene: &Scene) -> bool {
    let has = |kind: &LayerKind| match kind {
        LayerKind::Line(_) | LayerKind::Area(_) | LayerKind::Point(_) => true,
        LayerKind::Molecule(molecule) => molecule.label_px.is_some(),
        _ => false,
    };
    scene.layers.iter().any(|layer| has(&layer.kind))
}

/// The scene with all widths and heights times `scale`; itself where nothing changes. Letters that cannot be read are left out.
pub fn scaled(scene: &Scene, scale: f64) -> Cow<'_, Scene> {
    if scale == 1.0 || !has_any(scene) {
        return Cow::Borrowed(scene);
    }
    let mut scene = scene.clone();
    let letters = |px: Option<f64>| px.map(|px| px * scale).filter(|px| *px >= LEGIBLE_PX);
    for layer in &mut scene.layers {
        match &mut layer.kind {
            LayerKind::Line(line) => {
                (line.width_px, line.label_px) = (line.width_px * scale, letters(line.label_px));
                line.marker_px *= scale;
                line.markers = line.markers.filter(|_| line.marker_px >= LEGIBLE_PX);
            }
            LayerKind::Area(area) => {
                (area.width_px, area.label_px) = (area.width_px * scale, letters(area.label_px));
            }
            LayerKind::Point(point) => {
                (point.size_px, point.style.label_px) = (point.size_px * scale, letters(point.style.label_px));
            }
            LayerKind::Molecule(molecule) => molecule.label_px = letters(molecule.label_px),
            _ => {}
        }
    }
    Cow::Owned(scene)
}

/// A line of the grid with the same scaling.
pub fn line(line: OverlayLine, scale: f64) -> OverlayLine {
    let label_px = line.label_px * scale;
    let label = if label_px >= LEGIBLE_PX { line.label } else { String::new() };
    OverlayLine { width_px: line.width_px * scale, label, label_px, ..line }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_scene::{Color, Layer, LineLayer, SMALL_LETTERS_PX};

    #[test]
    fn twice_as_many_pixels_per_point_make_lines_and_names_twice_as_large() {
        let mut way = LineLayer::new(Vec::new(), Color::rgb(1, 2, 3));
        (way.width_px, way.label_px) = (3.0, Some(12.0));
        let layer = Layer { id: "way".into(), must_see: true, kind: way.into() };
        let scene = Scene { layers: vec![layer], ..Scene::default() };
        assert!(matches!(scaled(&scene, 1.0), Cow::Borrowed(_)));
        for (scale, width, letters) in [(2.0, 6.0, Some(24.0)), (0.5, 1.5, None)] {
            let other = scaled(&scene, scale);
            let Some(line) = other.layers[0].kind.lines() else { panic!("no line") };
            assert_eq!((line.width_px, line.label_px), (width, letters), "letters of 6 pixels cannot be read");
        }
    }

    #[test]
    fn letters_of_grids_and_distances_are_scaled_and_left_out_where_they_cannot_be_read() {
        let grid = OverlayLine {
            points: Vec::new(),
            on_ground: true,
            color: Color::rgb(1, 2, 3),
            width_px: 1.0,
            casing: None,
            hidden: belvedere_scene::Hidden::Cut,
            label: "E 500".into(),
            label_px: SMALL_LETTERS_PX,
        };
        let mut way = LineLayer::new(Vec::new(), Color::rgb(1, 2, 3));
        way.markers = Some(belvedere_scene::DistanceMarkers::Auto);
        let layer = Layer { id: "way".into(), must_see: true, kind: way.into() };
        let scene = Scene { layers: vec![layer], ..Scene::default() };
        for (scale, letters) in [(2.0, Some(22.0)), (0.75, Some(8.25)), (0.5, None)] {
            let other = line(grid.clone(), scale);
            assert_eq!((!other.label.is_empty()).then_some(other.label_px), letters);
            let scene = scaled(&scene, scale);
            let Some(way) = scene.layers[0].kind.lines() else { panic!("no line") };
            assert_eq!(way.markers.map(|_| way.marker_px), letters);
        }
    }
}
