//! Objects under the pointer.

use super::residues::residue_at;
use belvedere::Session;
use belvedere::core::{DVec2, DVec3};
use belvedere::pick::pick;
use belvedere::scene::{BoxShape, LayerKind, OwnLayer, Progress};

/// The object at a pixel of the picture, as a constructor's target: a part of a mesh by its name, a box as `LAYER/NUMBER`, a residue of a
/// molecule as a selection of atoms, else the whole layer; `None` if the pixel shows no object.
///
/// * `layer`: id of the layer that the picture shows there. `point`: world point that is seen, scene coordinates.
pub fn object_at(session: &Session, layer: &str, pixel: DVec2, point: Option<DVec3>) -> Option<String> {
    let found = session.scene().layers.iter().find(|other| other.id == layer)?;
    let part = match &found.kind {
        LayerKind::Boxes(boxes) => {
            let off = |shape: &BoxShape| point.map_or(f64::INFINITY, |point| distance(shape, point));
            let nearest = boxes.boxes.iter().enumerate().min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
            nearest.filter(|_| point.is_some()).map(|(k, _)| format!("{layer}/{}", k + 1))
        }
        LayerKind::Mesh(mesh) | LayerKind::Own(OwnLayer { surface: mesh, .. })
            if mesh.names.iter().any(|name| !name.is_empty()) =>
        {
            let picked = pick(session, &[pixel.to_array()], &Progress::silent()).ok()?.pixels.pop()??;
            picked.feature.filter(|_| picked.layer == layer)
        }
        LayerKind::Molecule(molecule) => residue_at(molecule, point?),
        _ => None,
    };
    Some(part.unwrap_or_else(|| layer.to_owned()))
}

/// Distance of a point from the surface of a box, inside or outside, scene units.
fn distance(shape: &BoxShape, point: DVec3) -> f64 {
    let (sin, cos) = shape.yaw.sin_cos();
    let d = point - shape.base;
    let own = DVec3::new(cos * d.x + sin * d.y, cos * d.y - sin * d.x, d.z - 0.5 * shape.size.z);
    let beyond = own.abs() - 0.5 * shape.size;
    let outside = beyond.max(DVec3::ZERO).length();
    if outside > 0.0 { outside } else { -beyond.max_element() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere::scene_file::parse;
    use belvedere::{OpenOptions, Session};
    use std::path::Path;

    #[test]
    fn the_box_that_is_clicked_is_meant_and_can_be_kept_in_view() {
        let text = r#"
format = 1
[camera]
eye = [0, -60, 6]
look_at = [0, 0, 6]
[[layer]]
kind = "boxes"
id = "towers"
boxes = [
  { base = [-12, 0, 0], size = [8, 8, 12] },
  { base = [12, 0, 0], size = [8, 8, 12], yaw_deg = 30 },
  { base = [12, 30, 0], size = [8, 8, 14] },
]
"#;
        let open = |text: &str| {
            let source = parse(Path::new("s.toml"), text).expect("scene");
            Session::from_document(source, &OpenOptions::default())
        };
        let session = open(text).expect("session");
        let at = |point: [f64; 3]| object_at(&session, "towers", DVec2::ZERO, Some(DVec3::from_array(point)));
        assert_eq!(at([-12.0, -4.0, 6.0]).as_deref(), Some("towers/1"));
        assert_eq!(at([12.0, 26.0, 13.0]).as_deref(), Some("towers/3"));
        assert_eq!(object_at(&session, "towers", DVec2::ZERO, None).as_deref(), Some("towers"));
        assert_eq!(object_at(&session, "nothing", DVec2::ZERO, None), None);
        let tracked = |target: &str| format!("{text}[constructor]\nkind = 'target_tracking'\ntarget = '{target}'\n");
        let session = open(&tracked("towers/3")).expect("tracked");
        assert!(session.view().is_bent(), "the third stands behind the second");
        let wrong = open(&tracked("towers/4")).expect_err("there are three").to_string();
        assert!(wrong.contains("towers/4"), "{wrong}");
    }
}
