//! Stages that straighten a tube along a centreline.

use super::context::StageContext;
use super::{centreline, path};
use crate::BelvedereError;
use belvedere_construct::centreline::CentrelineReport;
use belvedere_core::map::straighten::{SmoothedCentreline, StraightenError, Tube};
use belvedere_core::{DVec3, Stage, Warning, WarningKind};
use belvedere_document::{StageDoc, Table, TubeStageDoc};
use belvedere_io::InputFile;
use serde::Serialize;

/// Default radius: share of the line's length, and clearances of a traced centreline.
const RADIUS: f64 = 0.1;
const CLEARANCES: f64 = 4.0;
/// Least radius of the smoothed line's bends: share of the tube's radius, and of the clearance.
const SHARPEST: f64 = 0.1;
const SHARPEST_TRACED: f64 = 0.5;

/// Report of a tube.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TubeReport {
    /// Length of the line as it was given or traced, scene units.
    pub line_m: f64,
    /// Length of the smoothed line, that of the straightened one, scene units.
    pub length_m: f64,
    /// Largest distance from it that is drawn, scene units.
    pub radius_m: f64,
    /// Its least radius of curvature, scene units; `None` if it is straight.
    pub least_radius_m: Option<f64>,
    /// Standard deviation of the average that smoothed it, scene units.
    pub smoothing_m: f64,
    /// Largest distance of the line from the smoothed one, scene units.
    pub smoothed_off_m: f64,
    /// Position of that largest distance, scene units.
    pub smoothed_off_at: [f64; 3],
    /// Whether all within the radius is drawn. Else parts of the line come nearer to each other, or it bends more sharply; what lies between
    /// them is drawn beside the nearest part alone, and empty beside the others.
    pub whole: bool,
    /// Both ends of the straightened line, scene units.
    pub ends: [[f64; 3]; 2],
    /// The centreline, if one was traced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centreline: Option<CentrelineReport>,
}

/// The line of a tube, and what is known about it.
struct Line {
    points: Vec<DVec3>,
    /// Key that states it.
    key: &'static str,
    file: Option<InputFile>,
    traced: Option<CentrelineReport>,
}

/// The stage, its document and its report.
pub(super) fn resolve(
    context: &StageContext<'_>,
    doc: &TubeStageDoc,
    (inputs, warnings): (&mut Vec<InputFile>, &mut Vec<Warning>),
    at: Table<'_>,
) -> Result<(Stage, StageDoc, TubeReport), BelvedereError> {
    let line = find(context, doc, at)?;
    inputs.extend(line.file);
    let length: f64 = line.points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let clearance = line.traced.as_ref().map(|traced| traced.median_clearance);
    let radius = doc.radius_m.unwrap_or_else(|| clearance.map_or(RADIUS * length, |c| CLEARANCES * c));
    let fail = |e: StraightenError| at.error(&[key(&e, line.key)], words(&e));
    let sharpest = clearance.map_or(SHARPEST * radius, |c| SHARPEST_TRACED * c);
    let smoothed = SmoothedCentreline::new(&line.points, sharpest, doc.smoothing_m).map_err(fail)?;
    let middle = || smoothed.curve.at(0.5 * smoothed.curve.length()).p;
    let anchor = doc.anchor.map_or_else(middle, DVec3::from_array);
    let share = doc.share.unwrap_or(1.0);
    let tube = Tube::parted(smoothed.curve, radius, share, anchor).map_err(fail)?;
    let report = TubeReport {
        line_m: length,
        length_m: tube.line().length(),
        radius_m: radius,
        least_radius_m: Some(1.0 / tube.line().largest_curvature()).filter(|r| r.is_finite()),
        smoothing_m: smoothed.smoothing,
        smoothed_off_m: smoothed.off,
        smoothed_off_at: smoothed.off_at.to_array(),
        whole: tube.is_whole(),
        ends: [0.0, tube.line().length()].map(|g| tube.unrolled().at(g).p.to_array()),
        centreline: line.traced,
    };
    let lumen = clearance.unwrap_or(radius);
    if report.smoothed_off_m > lumen {
        let text = format!(
            "stage tube: the line leaves what is straightened around the smoothed one: at {:?} it is {:.2} from it; smooth less, with a smaller smoothing_m",
            report.smoothed_off_at, report.smoothed_off_m
        );
        warnings.push(Warning::new(WarningKind::Hidden, text).about("tube").with("off_m", report.smoothed_off_m));
    }
    let document = TubeStageDoc {
        radius_m: Some(radius),
        share: Some(share),
        anchor: Some(tube.anchor().to_array()),
        smoothing_m: Some(report.smoothing_m),
        ..doc.clone()
    };
    Ok((Stage::Tube(tube), StageDoc::Tube(document), report))
}

/// The line that a document states.
fn find(context: &StageContext<'_>, doc: &TubeStageDoc, at: Table<'_>) -> Result<Line, BelvedereError> {
    let (source, scene) = (context.source, context.scene);
    match (&doc.path, &doc.points, &doc.centreline) {
        (Some(name), None, None) => {
            let fail = |reason: String| at.error(&["path"], format!("a tube: {reason}"));
            let (points, file) = path::read(source, context.roots, scene, name, &fail)?;
            Ok(Line { points, key: "path", file, traced: None })
        }
        (None, Some(points), None) => {
            let points = points.iter().copied().map(DVec3::from_array).collect();
            Ok(Line { points, key: "points", file: None, traced: None })
        }
        (None, None, Some(asked)) => {
            let fail =
                |key: &str, reason: String| at.error(&["centreline", key], format!("a tube: centreline: {reason}"));
            let traced = centreline::read(scene, asked, &fail)?;
            Ok(Line { points: traced.points, key: "centreline", file: None, traced: Some(traced.report) })
        }
        (path, points, centreline) => {
            let given = [path.is_some(), points.is_some(), centreline.is_some()].into_iter().filter(|g| *g).count();
            let text = format!("a tube needs path, points or centreline, {given} are given; give exactly one");
            Err(at.error(&["kind"], text).into())
        }
    }
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
fn key(error: &StraightenError, line: &'static str) -> &'static str {
    match error {
        StraightenError::Range { key: "half_width", .. } => "radius_m",
        StraightenError::Range { key: "smoothing", .. } | StraightenError::Radius { .. } => "smoothing_m",
        StraightenError::Range { key, .. } => key,
        _ => line,
    }
}
