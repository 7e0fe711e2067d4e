//! Navigation with the camera of a document.

use crate::scene_file::{CameraDoc, Document, PointDoc};
use belvedere_core::{Aabb, DVec3, Navigation, Pinhole, Projection, View};
use belvedere_scene::Scene;

/// The camera of a document and the point that it looks at; if it names none, the point on the optical axis nearest to the scene's middle.
///
/// * `written`: the camera as the document has it. `resolved`: the same with every rule replaced by its value, as last shown in
///   `view`; it is used where `written` has rules.
/// * `image`: size of the picture on the screen, pixels.
pub fn navigation(
    written: &CameraDoc,
    resolved: &CameraDoc,
    view: &View,
    scene: &Scene,
    image: [u32; 2],
) -> Navigation {
    let fixed = matches!((written.eye, written.look_at), (PointDoc::Scene(_), Some(PointDoc::Scene(_))));
    let camera = if fixed { written } else { resolved };
    let shown = view.pinhole();
    let eye = position(&camera.eye).unwrap_or(shown.eye);
    let target = camera.look_at.as_ref().and_then(position).unwrap_or_else(|| ahead(shown, scene));
    // A preset may change the field of view of the picture; navigation uses that of the document.
    let projection = match camera.ortho_height_m {
        Some(height) => Projection::Orthographic { height },
        None => Projection::Perspective { fov_y: camera.fov_y_deg.to_radians() },
    };
    let up = DVec3::from_array(camera.up);
    let pinhole = Pinhole::look_at(eye, target, up, projection, image, camera.near, camera.far);
    Navigation { pinhole: pinhole.unwrap_or_else(|_| Pinhole { image, ..shown.clone() }), target }
}

/// Writes a camera into the document in place of its rules; the size in pixels is kept.
pub fn set_camera(document: &mut Document, camera: &Navigation) {
    let of = CameraDoc::of(&camera.pinhole, camera.target);
    let old = &mut document.camera;
    (old.eye, old.look_at, old.up) = (of.eye, of.look_at, of.up);
    (old.heading_deg, old.pitch_deg) = (None, None);
    (old.projection, old.ortho_height_m) = (of.projection, of.ortho_height_m);
    if matches!(camera.pinhole.projection, Projection::Perspective { .. }) {
        old.fov_y_deg = of.fov_y_deg;
    }
}

/// Least height of an eye over the ground, metres.
const EYE_M: f64 = 2.0;

/// The camera raised together with its target if its eye would lie less than 2 m over the ground.
pub fn above_ground(camera: Navigation, scene: &Scene) -> Navigation {
    let eye = camera.pinhole.eye;
    let ground = scene.terrain().and_then(|terrain| terrain.surface_at(eye.truncate()));
    let missing = ground.map_or(0.0, |ground| ground + EYE_M - eye.z);
    let raised = camera.moved(missing.max(0.0) * DVec3::Z);
    if missing > 0.0 { raised.unwrap_or(camera) } else { camera }
}

/// A camera that shows a box from the south, `pitch_deg` over the horizon and turned by `heading_deg` clockwise from north; `None` for an
/// empty box.
pub fn framed(bounds: &Aabb, heading_deg: f64, pitch_deg: f64, image: [u32; 2]) -> Option<Navigation> {
    let (heading, pitch) = (heading_deg.to_radians(), pitch_deg.to_radians());
    let ahead = DVec3::new(heading.sin() * pitch.cos(), heading.cos() * pitch.cos(), -pitch.sin());
    let lens = Projection::Perspective { fov_y: 45f64.to_radians() };
    let size = (bounds.max - bounds.min).length();
    let near = (1e-4 * size).clamp(1e-6, 1.0);
    let pinhole = Pinhole::look_at(-ahead, DVec3::ZERO, DVec3::Z, lens, image, near, None).ok()?;
    Navigation { pinhole, target: DVec3::ZERO }.framing(bounds).ok().filter(|_| !bounds.is_empty())
}

fn position(doc: &PointDoc) -> Option<DVec3> {
    match doc {
        PointDoc::Scene(p) => Some(DVec3::from_array(*p)),
        PointDoc::Map(_) => None,
    }
}

/// Point of the optical axis nearest to the middle of the scene.
fn ahead(pinhole: &Pinhole, scene: &Scene) -> DVec3 {
    let bounds = scene.bounds();
    let middle = if bounds.is_empty() { pinhole.eye + pinhole.forward } else { 0.5 * (bounds.min + bounds.max) };
    let along = (middle - pinhole.eye).dot(pinhole.forward);
    pinhole.eye + along.max(10.0 * pinhole.near) * pinhole.forward
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_file::parse;
    use crate::{OpenOptions, Session};
    use std::path::Path;

    #[test]
    fn an_eye_under_the_ground_is_raised_with_what_it_looks_at() {
        let text = "format = 1\n[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 300]\n\
            [[layer]]\nkind = 'terrain'\nid = 'ground'\nsource = 'builtin:massif?seed=7&size=65'\n";
        let source = parse(Path::new("s.toml"), text).expect("scene");
        let session = Session::from_document(source, &OpenOptions::default()).expect("session");
        let (pinhole, target) = (session.view().pinhole().clone(), DVec3::new(0.0, 0.0, 300.0));
        let camera = Navigation { pinhole, target };
        assert_eq!(above_ground(camera.clone(), session.scene()).pinhole.eye, camera.pinhole.eye);
        let under = camera.moved(DVec3::new(0.0, 0.0, -4500.0)).expect("a camera");
        let raised = above_ground(under.clone(), session.scene());
        let ground =
            session.scene().terrain().and_then(|t| t.surface_at(raised.pinhole.eye.truncate())).expect("ground");
        assert!((raised.pinhole.eye.z - ground - EYE_M).abs() < 1e-9, "{} over {ground}", raised.pinhole.eye.z);
        let by = |a: DVec3, b: DVec3| (a - b).truncate().length();
        assert!(by(raised.pinhole.eye, under.pinhole.eye) == 0.0 && raised.target.z > under.target.z);
    }
}
