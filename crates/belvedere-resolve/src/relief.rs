//! Relief stages.

use super::context::{StageContext, plane};
use super::spline::first_spline;
use crate::BelvedereError;
use belvedere_construct::large_forms;
use belvedere_core::Stage;
use belvedere_core::map::relief::{Relief, ReliefError, ReliefShape};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_document::{OneOrTwo, PlaneDoc, ReliefStageDoc, StageDoc, Table};
use std::sync::Arc;

/// Foreground and background as shares of the distance of the pivot: those of the built-in presets.
const RANGE: [f64; 2] = [0.5, 1.9];
/// Standard extent of the large forms, as a share of the range.
const LARGE: f64 = 0.2;

/// The stage and its document.
pub(super) fn resolve(
    context: &StageContext<'_>,
    doc: &ReliefStageDoc,
    at: Table<'_>,
) -> Result<(Stage, StageDoc), BelvedereError> {
    let pinhole = &context.camera.pinhole;
    let (plane, height) = plane(context, doc.plane.as_ref(), at)?;
    let range = match (doc.range_m, doc.range_tag) {
        (Some(_), Some(_)) => {
            return Err(at
                .error(&["range_tag"], "range_m and range_tag both say where the background begins; leave one out")
                .into());
        }
        (Some(range), None) => range,
        (None, Some(tag)) => transition(context, &plane, tag).map_err(|reason| at.error(&["range_tag"], reason))?,
        (None, None) => {
            let distance = default_pivot(pinhole, &plane).distance(plane.foot(pinhole.eye));
            RANGE.map(|share| share * distance.max(1.0))
        }
    };
    let shape = ReliefShape {
        exaggeration: doc.exaggeration.map_or([1.0; 2], OneOrTwo::pair),
        oblique: doc.oblique.unwrap_or(0.0),
        horizon_radius: doc.horizon_radius_m.unwrap_or(f64::INFINITY),
        levelling: doc.levelling.unwrap_or(0.0),
        range,
    };
    let scale = doc.levelling_scale_m.unwrap_or(LARGE * (range[1] - range[0]));
    if shape.levelling > 0.0 && !(scale > 0.0 && scale.is_finite()) {
        return Err(at
            .error(&["levelling_scale_m"], format!("levelling_scale_m is {scale}, it must be greater than 0"))
            .into());
    }
    let terrain = context.ground.terrain.filter(|_| shape.levelling > 0.0);
    let base = terrain.and_then(|terrain| large_forms(terrain, scale)).map(Arc::new);
    let relief = Relief::new(pinhole, &plane, shape.clone(), base).map_err(|e| at.error(&[key(&e)], words(&e)))?;
    let document = ReliefStageDoc {
        exaggeration: Some(OneOrTwo::Two(shape.exaggeration)),
        oblique: Some(shape.oblique),
        horizon_radius_m: doc.horizon_radius_m,
        levelling: Some(shape.levelling),
        levelling_scale_m: (shape.levelling > 0.0).then_some(scale),
        range_m: Some(range),
        range_tag: None,
        plane: Some(PlaneDoc { normal: plane.normal().to_array(), height_m: Some(height) }),
    };
    Ok((Stage::Relief(relief), StageDoc::Relief(document)))
}

/// Distances from the eye, in plan along the heading, between which the transition at a tag point of the spline stage lies.
fn transition(context: &StageContext<'_>, plane: &ReferencePlane, number: usize) -> Result<[f64; 2], String> {
    let Some(bend) = first_spline(context).map_err(|e| e.to_string())? else {
        return Err("range_tag needs a stage spline_bend after the relief; add one, or give range_m".into());
    };
    let tags = bend.sections().tags();
    let Some(tag) = number.checked_sub(1).and_then(|i| tags.get(i)) else {
        return Err(format!(
            "range_tag is {number}, the presets of the spline stage have {} tag points at this viewing angle; give one of them, or range_m",
            tags.len()
        ));
    };
    if !(tag.delta > 0.0) {
        return Err(format!(
            "tag point {number} has no transition, ground cannot pass over it; give it a delta above 0"
        ));
    }
    let eye = plane.foot(context.camera.pinhole.eye);
    let [_, heading, _] = bend.axes();
    Ok([tag.u - tag.delta, tag.u + tag.delta]
        .map(|t| (bend.unbent(t * bend.curve().length(), 0.0, 0.0) - eye).dot(heading)))
}

/// The error with the keys of the document.
fn words(error: &ReliefError) -> String {
    let text = error.to_string();
    match error {
        ReliefError::Range { key: short, .. } if key(error) != *short => text.replacen(short, key(error), 1),
        ReliefError::Order { .. } => text.replacen("range", "range_m", 1),
        _ => text,
    }
}

/// Key of the document to which an error refers.
fn key(error: &ReliefError) -> &'static str {
    match error {
        ReliefError::Range { key: "horizon_radius", .. } => "horizon_radius_m",
        ReliefError::Range { key: "range", .. } | ReliefError::Order { .. } => "range_m",
        ReliefError::Range { key, .. } => key,
        _ => "levelling",
    }
}
