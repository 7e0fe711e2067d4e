//! Navigation with the camera of a document.

use crate::{CameraDoc, Document, PointDoc, PresetsDoc, StageDoc};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{DVec3, Navigation, Pinhole, Projection, View};
use belvedere_scene::Scene;

/// The camera of a document and the point that it looks at; if it names none, the point on the optical axis nearest to the scene's middle.
///
/// * `written`: the camera as the document has it. `resolved`: the same with every rule replaced by its value, as last shown in
///   `view`; it is used where `written` has rules.
/// * `image`: size of the picture on the screen, pixels. `factor`: its height in heights of the document's frame, see [`frame_factor`].
pub fn navigation(
    written: &CameraDoc,
    resolved: &CameraDoc,
    view: &View,
    scene: &Scene,
    (image, factor): ([u32; 2], f64),
) -> Navigation {
    let fixed = matches!((written.eye, written.look_at), (PointDoc::Scene(_), Some(PointDoc::Scene(_))));
    let camera = if fixed { written } else { resolved };
    let shown = view.pinhole();
    let eye = position(&camera.eye).unwrap_or(shown.eye);
    let target = camera.look_at.as_ref().and_then(position).unwrap_or_else(|| ahead(shown, scene));
    // A preset may change the field of view of the picture; navigation uses that of the document.
    let projection = scaled(projection_of(written), factor);
    let up = DVec3::from_array(camera.up);
    let pinhole = Pinhole::look_at(eye, target, up, projection, image, camera.near, camera.far);
    Navigation { pinhole: pinhole.unwrap_or_else(|_| Pinhole { image, ..shown.clone() }), target }
}

/// Largest field of view of a picture that shows more than the document's frame, degrees: that of an upright sheet for a frame of 16:9 and 45
/// degrees.
const WIDEST_DEG: f64 = 100.0;

/// Height of a picture of the size `image` (pixels) in heights of the document's frame, >= 1: a picture that is narrower than the frame
/// shows more above and below, so that it holds the whole frame. In perspective its field of view ends at 100 degrees; then the sides of
/// the frame are cut off. 1 where the shapes are alike but for rounding, and where a preset states a field of view, since that fixes the eye.
pub fn frame_factor(document: &Document, image: [u32; 2]) -> f64 {
    let shape = |[w, h]: [u32; 2]| f64::from(w.max(1)) / f64::from(h.max(1));
    let wanted = shape(document.camera.image);
    let is_alike = (f64::from(image[0]) - wanted * f64::from(image[1])).abs() < 1.0;
    let factor = (wanted / shape(image)).max(1.0);
    if is_alike || document.stage.iter().any(states_field_of_view) {
        return 1.0;
    }
    match projection_of(&document.camera) {
        Projection::Orthographic { .. } => factor,
        Projection::Perspective { fov_y } => {
            let most = (0.5 * WIDEST_DEG.to_radians()).tan() / (0.5 * fov_y).tan();
            if most.is_finite() { factor.min(most.max(1.0)) } else { factor }
        }
    }
}

fn states_field_of_view(stage: &StageDoc) -> bool {
    let StageDoc::SplineBend(stage) = stage else { return false };
    let states = |document: &PresetDocument| document.presets.iter().any(|preset| preset.fov_y_deg.is_some());
    match &stage.presets {
        PresetsDoc::Inline(document) => states(document),
        // A file of presets may state one.
        PresetsDoc::Named(name) => PresetDocument::builtin(name).map_or(true, |document| states(&document)),
    }
}

/// Fits the camera of a document to a picture of another size: see [`frame_factor`].
pub fn fit(document: &mut Document, image: [u32; 2]) {
    let factor = frame_factor(document, image);
    let camera = &mut document.camera;
    camera.image = image;
    if factor > 1.0 {
        match scaled(projection_of(camera), factor) {
            Projection::Orthographic { height } => camera.ortho_height_m = Some(height),
            Projection::Perspective { fov_y } => camera.fov_y_deg = fov_y.to_degrees(),
        }
    }
}

/// The same for a picture that is written: curved rays keep the field of view, since their turns are those of the stated frame.
pub fn resize(document: &mut Document, image: [u32; 2]) {
    let has_turns = document.stage.iter().any(|stage| matches!(stage, StageDoc::CurvedRays(_)));
    if has_turns || document.constructor.is_some() {
        document.camera.image = image;
    } else {
        fit(document, image);
    }
}

/// The view of a picture on the screen, cut to the document's frame; as it is if the frame has another field of view than the document.
///
/// * `image`: size of the picture on the screen, pixels.
pub fn cut_to_frame(view: &View, document: &Document, image: [u32; 2]) -> View {
    let (shown, stated) = (view.pinhole(), projection_of(&document.camera));
    let fitted = scaled(stated, frame_factor(document, image));
    let alike = match (fitted, shown.projection) {
        (Projection::Perspective { fov_y: a }, Projection::Perspective { fov_y: b }) => (a - b).abs() < 1e-9,
        (Projection::Orthographic { height: a }, Projection::Orthographic { height: b }) => (a - b).abs() < 1e-9 * b,
        _ => false,
    };
    let pinhole = Pinhole { image: document.camera.image, projection: stated, ..shown.clone() };
    let cut = if alike { View::new(pinhole, view.stages().to_vec()).ok() } else { None };
    cut.unwrap_or_else(|| view.clone())
}

fn projection_of(camera: &CameraDoc) -> Projection {
    match camera.ortho_height_m {
        Some(height) => Projection::Orthographic { height },
        None => Projection::Perspective { fov_y: camera.fov_y_deg.to_radians() },
    }
}

/// The projection of a picture `factor` times as high.
fn scaled(projection: Projection, factor: f64) -> Projection {
    match projection {
        _ if factor == 1.0 => projection,
        Projection::Orthographic { height } => Projection::Orthographic { height: factor * height },
        Projection::Perspective { fov_y } => {
            Projection::Perspective { fov_y: 2.0 * (factor * (0.5 * fov_y).tan()).atan() }
        }
    }
}

/// Writes a camera of the picture on the screen into the document in place of its rules; the size in pixels is kept, and a field of view
/// that was not changed.
pub fn set_camera(document: &mut Document, camera: &Navigation) {
    let factor = frame_factor(document, camera.pinhole.image);
    let before = document.camera.fov_y_deg;
    let pinhole = Pinhole { projection: scaled(camera.pinhole.projection, 1.0 / factor), ..camera.pinhole.clone() };
    let of = CameraDoc::of(&pinhole, camera.target);
    let old = &mut document.camera;
    (old.eye, old.look_at, old.up) = (of.eye, of.look_at, of.up);
    (old.heading_deg, old.pitch_deg) = (None, None);
    (old.projection, old.ortho_height_m) = (of.projection, of.ortho_height_m);
    if matches!(camera.pinhole.projection, Projection::Perspective { .. }) {
        old.fov_y_deg = if (of.fov_y_deg - before).abs() < 1e-9 { before } else { of.fov_y_deg };
    }
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
