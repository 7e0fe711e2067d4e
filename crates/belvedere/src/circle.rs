//! The whole circle around a place.

use crate::scene_file::place::PlaceHeight;
use crate::scene_file::request::Panorama;
use crate::scene_file::{CameraDoc, PointDoc, ProjectionDoc, StageDoc, UnrollStageDoc};
use crate::{Advice, BelvedereError, OpenOptions, Session};
use belvedere_core::map::unroll::Roll;
use belvedere_resolve::solving::{Memory, Solving};

/// Height of the eye over the ground where none is asked for, metres.
const EYE_M: f64 = 2.0;
/// Size of the picture where none is asked for, pixels of the whole circle.
const SIZE: [f64; 2] = [3600.0, 600.0];

/// The session, seen from the place that is asked for, all around.
pub(crate) fn aimed(session: Session, options: &OpenOptions) -> Result<Session, BelvedereError> {
    let Panorama { panorama, heading, span, pitch, sphere } = options.panorama;
    let (Some(mut place), Some(stated)) = (panorama, session.stated()) else { return Ok(session) };
    let mut document = stated.clone();
    if document.constructor.is_some() || document.stage.iter().any(|stage| !matches!(stage, StageDoc::GroundMoves(_))) {
        let text = "{} chooses a camera, which bends of the scene cannot follow; leave one of them out";
        return Err(BelvedereError::Argument(Advice::new(text, &["panorama"])));
    }
    if place.height == PlaceHeight::OnGround {
        place.height = PlaceHeight::AboveGround(EYE_M);
    }
    let (eye, said) = session.find_place(&place, "eye")?;
    let span = span.unwrap_or(360.0);
    let usual = || SIZE.map(|side| side.min(SIZE[0] * span / 360.0).max(SIZE[1]) as u32);
    document.camera = CameraDoc {
        eye: PointDoc::Scene(eye.to_array()),
        look_at: None,
        heading_deg: Some(heading.unwrap_or(0.0)),
        pitch_deg: Some(pitch.unwrap_or(0.0)),
        up: [0.0, 0.0, 1.0],
        projection: ProjectionDoc::Perspective,
        ortho_height_m: None,
        image: options.image.unwrap_or_else(usual),
        near: 1.0,
        far: None,
        ..document.camera
    };
    let from = sphere.then_some(Roll::Sphere);
    document.stage.push(StageDoc::Unroll(UnrollStageDoc { span_deg: Some(span), from }));
    let mut memory = Memory::default();
    let mut solving = Solving { memory: &mut memory, time_step_s: None, progress: &options.progress };
    let mut seen = session.with_document(document, Some(&mut solving))?;
    seen.loaded.warnings.extend(said);
    Ok(seen)
}
