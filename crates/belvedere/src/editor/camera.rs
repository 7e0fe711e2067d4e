//! Navigation with the camera of a document.

use crate::scene_file::{CameraDoc, Document, PointDoc, PresetsDoc, StageDoc};
use belvedere_core::presets::PresetDocument;
use belvedere_core::{Aabb, DVec3, Navigation, Pinhole, Projection, View};
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

/// Largest field of view of a picture on the screen that shows more than the document's frame, degrees.
const WIDEST_DEG: f64 = 80.0;

/// Height of a picture of the size `image` (pixels) in heights of the document's frame, >= 1: a picture that is narrower than the frame
/// shows more above and below, so that it holds the whole frame. In perspective its field of view ends at 80 degrees; then the sides of
/// the frame are cut off. 1 where a preset states a field of view, since that fixes the eye.
pub fn frame_factor(document: &Document, image: [u32; 2]) -> f64 {
    let shape = |[w, h]: [u32; 2]| f64::from(w.max(1)) / f64::from(h.max(1));
    let factor = (shape(document.camera.image) / shape(image)).max(1.0);
    if document.stage.iter().any(states_field_of_view) {
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

/// Fits the camera of a document to a picture on the screen: see [`frame_factor`].
pub(super) fn fit(document: &mut Document, image: [u32; 2]) {
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

/// The view of a picture on the screen, cut to the document's frame; as it is if the frame has another field of view than the document.
///
/// * `image`: size of the picture on the screen, pixels.
pub(super) fn cut_to_frame(view: &View, document: &Document, image: [u32; 2]) -> View {
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

    #[test]
    fn a_picture_of_any_shape_holds_the_frame_and_gives_the_camera_back_unchanged() {
        let scene = |camera: &str| {
            let text = format!(
                "format = 1\n[camera]\neye = [0, -900, 4000]\nlook_at = [0, 0, 300]\nimage = [320, 180]\n{camera}\n"
            );
            parse(Path::new("s.toml"), &text).expect("scene").document
        };
        for camera in ["fov_y_deg = 30.0", "projection = 'orthographic'\northo_height_m = 900.0", "fov_y_deg = 120.0"] {
            let document = scene(camera);
            for image in [[390, 844], [640, 640], [320, 180], [1920, 500]] {
                let mut shown = document.clone();
                fit(&mut shown, image);
                let session =
                    Session::from_document(crate::scene_file::SourceDocument::new(shown), &OpenOptions::default());
                let session = session.expect("session");
                let factor = frame_factor(&document, image);
                let on_screen =
                    navigation(&document.camera, &document.camera, session.view(), session.scene(), (image, factor));
                assert_eq!(on_screen.pinhole.projection, session.view().pinhole().projection, "{camera} {image:?}");
                let mut back = document.clone();
                set_camera(&mut back, &on_screen);
                assert_eq!(back.camera.fov_y_deg, document.camera.fov_y_deg, "{image:?}");
                let height = |camera: &CameraDoc| camera.ortho_height_m.unwrap_or(0.0);
                assert!((height(&back.camera) - height(&document.camera)).abs() < 1e-9);
                // A corner of the frame lies in the picture, unless its field of view is at its limit.
                let framed = cut_to_frame(session.view(), &document, image);
                assert_eq!(framed.pinhole().image, [320, 180], "{camera} {image:?}");
                let corner = framed.ray(belvedere_core::DVec2::ZERO).at(1000.0).expect("a point").point;
                let at = session.view().project(corner).expect("seen").pixel;
                let limit = factor * 180.0 / 320.0 < f64::from(image[1]) / f64::from(image[0]) - 1e-9;
                assert!(limit || (at.x > -1e-6 && at.y > -1e-6), "{camera} {image:?}: {at}");
            }
        }
    }
}
