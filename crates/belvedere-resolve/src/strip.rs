//! Stages that unroll a strip along a route.

use super::context::{StageContext, plane};
use super::line_of_stage::LineOfStage;
use crate::BelvedereError;
use belvedere_core::map::spline::default_pivot;
use belvedere_core::map::straighten::{SmoothedRoute, StraightenError, Strip};
use belvedere_core::{DVec2, Stage};
use belvedere_core::{Warning, WarningKind};
use belvedere_document::{StageDoc, StripStageDoc, Table};
use serde::Serialize;

/// Default half width as a share of the route's length in plan.
const WIDTH: f64 = 0.1;

/// Report of a strip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StripReport {
    /// Length of the smoothed route, scene units.
    pub length_m: f64,
    /// Largest distance from it that is drawn, scene units.
    pub half_width_m: f64,
    /// Its least radius of curvature, scene units; `None` if it is straight.
    pub least_radius_m: Option<f64>,
    /// Standard deviation of the average that smoothed it, scene units.
    pub smoothing_m: f64,
    /// Largest distance of the route from the smoothed one, scene units.
    pub smoothed_off_m: f64,
    /// Position in plan of that largest distance, scene units.
    pub smoothed_off_at: [f64; 2],
}

/// The stage, its document and its report.
pub(super) fn resolve(
    context: &StageContext<'_>,
    doc: &StripStageDoc,
    warnings: &mut Vec<Warning>,
    at: Table<'_>,
) -> Result<(Stage, StageDoc, StripReport), BelvedereError> {
    let line = LineOfStage { along: doc.along.as_deref(), path: doc.path.as_deref(), within: &[], what: "a strip" };
    let (points, named) = line.find(context, at)?;
    let length: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let half_width = doc.half_width_m.unwrap_or(WIDTH * length);
    let fail = |e: StraightenError| at.error(&[key(&e, named)], words(&e));
    let route = SmoothedRoute::new(&points, half_width, doc.smoothing_m).map_err(fail)?;
    let anchor = match doc.anchor {
        Some(anchor) => DVec2::from_array(anchor),
        None => looked_at(context),
    };
    let report = StripReport {
        length_m: route.curve.length(),
        half_width_m: half_width,
        least_radius_m: Some(1.0 / route.curve.largest_curvature()).filter(|r| r.is_finite()),
        smoothing_m: route.smoothing,
        smoothed_off_m: route.off,
        smoothed_off_at: route.off_at.to_array(),
    };
    if route.off > half_width {
        let text = format!(
            "stage strip: the route itself leaves the strip: at ({:.1}, {:.1}) it is {:.1} from the smoothed route, the half width is {half_width:.1}; \
             what lies outside is not drawn: take a narrower strip, which needs less smoothing, or a route with fewer turns",
            route.off_at.x, route.off_at.y, route.off
        );
        let warning = Warning::new(WarningKind::Hidden, text).about("strip").with("off_m", route.off);
        warnings.push(warning.with("half_width_m", half_width));
    }
    let share = doc.share.unwrap_or(1.0);
    let strip = Strip::new(route.curve, half_width, share, anchor).map_err(fail)?;
    let document = StripStageDoc {
        half_width_m: Some(half_width),
        share: Some(share),
        anchor: Some(strip.anchor().to_array()),
        smoothing_m: Some(route.smoothing),
        ..doc.clone()
    };
    Ok((Stage::Strip(strip), StageDoc::Strip(document), report))
}

/// Point that the camera looks at, in plan.
fn looked_at(context: &StageContext<'_>) -> DVec2 {
    let pinhole = &context.camera.pinhole;
    let met = || {
        let at = Table { origin: &context.source.origin, list: "stage", index: 0 };
        plane(context, None, at).map_or(pinhole.eye, |(plane, _)| default_pivot(pinhole, &plane))
    };
    context.camera.look_at.unwrap_or_else(met).truncate()
}

/// The error with the keys of the document.
fn words(error: &StraightenError) -> String {
    let text = error.to_string();
    match error {
        StraightenError::Range { key: short, .. } => text.replacen(short, key(error, short), 1),
        _ => text,
    }
}

/// Key of the document to which an error refers.
fn key(error: &StraightenError, route: &'static str) -> &'static str {
    match error {
        StraightenError::Range { key: "half_width", .. }
        | StraightenError::Radius { .. }
        | StraightenError::Overlap { .. } => "half_width_m",
        StraightenError::Range { key: "smoothing", .. } => "smoothing_m",
        StraightenError::Range { key, .. } => key,
        StraightenError::TooFine { .. } => "half_width_m",
        _ => route,
    }
}
