//! What all ways to reveal share: size of the picture, viewpoint, technique, and the stage of a spline.

use crate::places::Place;
pub use crate::scene_file::request::Technique;
use crate::scene_file::{CameraDoc, PlaneDoc, PointDoc, PresetsDoc, SplineStageDoc, StageDoc};
use belvedere_construct::Revealed;
use belvedere_core::{DVec3, Pinhole, Projection};

/// Size of the picture unless given, pixels.
pub const IMAGE: [u32; 2] = [1280, 720];

/// Full vertical field of view of pictures of models unless given, degrees.
pub(super) const MODELS_FOV_Y_DEG: f64 = 30.0;

/// An eye and its target: x, y as [`crate::places`] reads them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// x, y, and z in metres.
    pub eye: [f64; 3],
    /// x, y of the target.
    pub target: [f64; 2],
    /// Height of the target, metres; that of the ground if left out.
    pub target_height: Option<f64>,
}

impl From<Viewpoint> for [Place; 2] {
    fn from(Viewpoint { eye: [x, y, z], target, target_height }: Viewpoint) -> Self {
        [Place::of([x, y], Some(z)), Place::of(target, target_height)]
    }
}

/// The found spline as a stage of a document; `None` if the picture is straight.
pub(super) fn spline_stage(found: &Revealed) -> Option<StageDoc> {
    let bend = found.bend.as_ref()?;
    Some(StageDoc::SplineBend(SplineStageDoc {
        presets: PresetsDoc::Inline(Box::new(bend.document.clone())),
        pivot: Some(bend.pivot.to_array()),
        plane: Some(PlaneDoc { normal: [0.0, 0.0, 1.0], height_m: Some(found.plane_height) }),
    }))
}

/// A camera to the north, for documents whose camera is found later.
pub(super) fn provisional_camera() -> CameraDoc {
    let (eye, look_at) = (DVec3::NEG_Y, DVec3::ZERO);
    let (right, down, forward) = (DVec3::X, -DVec3::Z, DVec3::Y);
    let projection = Projection::Perspective { fov_y: MODELS_FOV_Y_DEG.to_radians() };
    let pinhole = Pinhole { eye, right, down, forward, projection, image: IMAGE, near: 1e-3, far: None };
    CameraDoc { look_at: Some(PointDoc::Scene(look_at.to_array())), ..CameraDoc::of(&pinhole, look_at) }
}
