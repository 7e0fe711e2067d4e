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
mod tests;
