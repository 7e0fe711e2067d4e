//! Stages that unroll the circle around the eye.

use super::context::StageContext;
use crate::BelvedereError;
use belvedere_core::map::unroll::Unroll;
use belvedere_core::{DVec3, Pinhole, Projection, Stage};
use belvedere_document::{StageDoc, Table, UnrollStageDoc};

/// Steepest direction of the middle row, degrees over or below the horizon.
const STEEPEST_DEG: f64 = 60.0;

/// The stage, its document, and the level camera that looks at what is unrolled.
pub(super) fn resolve(
    context: &StageContext<'_>,
    doc: &UnrollStageDoc,
    at: Table<'_>,
) -> Result<(Stage, StageDoc, Pinhole), BelvedereError> {
    let span_deg = doc.span_deg.unwrap_or(360.0);
    if !(span_deg > 0.0 && span_deg <= 360.0) {
        let text = format!("span_deg is {span_deg}, it must be greater than 0 and at most 360");
        return Err(at.error(&["span_deg"], text).into());
    }
    let root = &context.camera.pinhole;
    if matches!(root.projection, Projection::Orthographic { .. }) {
        return Err(at.error(&["kind"], "an unrolled circle needs an eye; set projection = \"perspective\"").into());
    }
    let (heading, pitch) = (root.forward.truncate(), root.forward.z.clamp(-1.0, 1.0).asin());
    if !(pitch.to_degrees().abs() <= STEEPEST_DEG) {
        let text = format!(
            "the camera looks {:.0} degrees {} the horizon; an unrolled circle needs at most {STEEPEST_DEG}: raise or lower look_at",
            pitch.to_degrees().abs(),
            if pitch < 0.0 { "below" } else { "over" }
        );
        return Err(at.error(&["kind"], text).into());
    }
    let from = doc.from.unwrap_or_default();
    let stage = Unroll::new(root.eye, heading, span_deg.to_radians(), pitch.tan(), from)
        .ok_or_else(|| at.error(&["kind"], "the camera has no heading; give heading_deg or look_at"))?;
    let pinhole = level(root, &stage).map_err(|e| at.error(&["kind"], e))?;
    let document = UnrollStageDoc { span_deg: Some(span_deg), from: Some(from) };
    Ok((Stage::Unroll(stage), StageDoc::Unroll(document), pinhole))
}

/// The level camera whose picture is as wide as the span.
fn level(root: &Pinhole, stage: &Unroll) -> Result<Pinhole, belvedere_core::PinholeError> {
    let [width, height] = root.image.map(f64::from);
    let lens = Projection::Perspective { fov_y: 2.0 * (0.5 * height * stage.span() / width).atan() };
    let ahead = root.eye + stage.heading().extend(0.0);
    Pinhole::look_at(root.eye, ahead, DVec3::Z, lens, root.image, root.near, root.far)
}
