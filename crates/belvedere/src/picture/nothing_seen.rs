//! The warning about a picture that shows nothing of any layer, as of an eye whose position is given in degrees.

use crate::fallback::has_volumes;
use belvedere_core::{DVec3, View, Warning, WarningKind};
use belvedere_overlay::length;
use belvedere_scene::{Crs, Frame, Scene, Unit};

/// The warning; `None` where the picture shows something, and for volumes, through which one may see.
///
/// * `frame`: the picture, with the ids of its layers.
pub(super) fn warning(scene: &Scene, view: &View, frame: &Frame) -> Option<Warning> {
    let bounds = scene.bounds();
    if bounds.is_empty() || has_volumes(scene) || frame.id.iter().any(|id| *id != 0) {
        return None;
    }
    let eye = view.pinhole().eye;
    let away = eye.distance(eye.clamp(bounds.min, bounds.max));
    let remedy = match scene.crs {
        Crs::Epsg(code) if is_in_degrees(eye) => format!(
            "its x and y are read in the system of the scene, EPSG:{code}; give them in that, or degrees as texts such as \"46.0N,8.1E,3500\""
        ),
        _ => "give another eye or look_at; `info` tells where the layers lie".to_owned(),
    };
    let [x, y, z] = eye.to_array();
    let text = format!(
        "nothing of any layer is in the picture: the eye {x}, {y}, {z} stands {} from the nearest; {remedy}",
        distance(away, scene.unit)
    );
    Some(Warning::new(WarningKind::Suspect, text).about("camera").with("distance", away))
}

fn is_in_degrees(eye: DVec3) -> bool {
    eye.x.abs() <= 180.0 && eye.y.abs() <= 90.0
}

fn distance(value: f64, unit: Unit) -> String {
    match unit {
        Unit::Metre => length(value),
        Unit::Angstrom => format!("{value:.1} angstrom"),
        Unit::Voxel => format!("{value:.1} voxels"),
    }
}
