//! The camera of a document in the hand.

use crate::scene_file::{CameraDoc, Document, PointDoc};
use belvedere_core::{Aabb, DVec3, Navigation, Pinhole, Projection, View};
use belvedere_scene::Scene;

/// The camera of a document and the point that it looks at; a point of the scene straight ahead if it names none.
///
/// * `written`: the camera as the document has it. `resolved`: the same with every rule replaced by its value, as it was shown last in
///   `view`; it counts where `written` has rules.
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
    // A preset may have changed the field of view of the picture; the hand holds the camera of the document.
    let projection = match camera.ortho_height_m {
        Some(height) => Projection::Orthographic { height },
        None => Projection::Perspective { fov_y: camera.fov_y_deg.to_radians() },
    };
    let up = DVec3::from_array(camera.up);
    let pinhole = Pinhole::look_at(eye, target, up, projection, image, camera.near, camera.far);
    Navigation { pinhole: pinhole.unwrap_or_else(|_| Pinhole { image, ..shown.clone() }), target }
}

/// The document's camera is that one, whatever rules placed it before; its size in pixels stays.
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

/// Where the optical axis comes nearest to the middle of the scene.
fn ahead(pinhole: &Pinhole, scene: &Scene) -> DVec3 {
    let bounds = scene.bounds();
    let middle = if bounds.is_empty() { pinhole.eye + pinhole.forward } else { 0.5 * (bounds.min + bounds.max) };
    let along = (middle - pinhole.eye).dot(pinhole.forward);
    pinhole.eye + along.max(10.0 * pinhole.near) * pinhole.forward
}
