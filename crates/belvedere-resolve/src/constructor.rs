//! Constructors of curved rays: from `[constructor]` to a view with turns.

use super::solving::{Prepared, Solving};
use super::wall::{self, WallReport};
use super::{centreline, path};
use crate::BelvedereError;
use crate::targets;
use belvedere_construct::ConstructError;
use belvedere_construct::centreline::CentrelineReport;
use belvedere_construct::measure::length_seen;
use belvedere_construct::rays::{
    FilmPlanner, Lens, PathPreview, PreviewReport, ProbeOptions, ProbeReport, Target, TrackingOptions, TrackingReport,
    auto_probe, track_target,
};
use belvedere_core::{EarthCurvature, Stage, View};
use belvedere_core::{Warning, WarningKind};
use belvedere_document::paths::Roots;
use belvedere_document::{ConstructorDoc, ConstructorKind, DocumentError, SourceDocument, StageDoc};
use belvedere_io::InputFile;
use belvedere_scene::{LayerKind, Scene};
use belvedere_sight::refusal;
use serde::{Deserialize, Serialize};

/// Time for which a film shows a probe after all of its turns are complete, seconds.
const LOOKED_AT_S: f64 = 2.0;

/// Report of a constructor of curved rays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ConstructorReport {
    /// Target tracking.
    TargetTracking(TrackingReport),
    /// Path preview.
    PathPreview(PathReport),
    /// Auto-probing.
    AutoProbe(ProbeReport),
}

/// Share of the length asked for below which a preview gets a warning.
const SHORT: f64 = 0.95;

/// Warning about a preview that shows or follows less of the path than asked for.
pub(super) fn remark(report: Option<&ConstructorReport>) -> Option<Warning> {
    let Some(ConstructorReport::PathPreview(PathReport { preview, followed_m, .. })) = report else { return None };
    let PreviewReport { position_m, reach_m, wanted_m, turns, .. } = *preview;
    let followed_m = followed_m.unwrap_or(reach_m);
    let turns = if turns == 1 { "1 turn".to_owned() } else { format!("{turns} turns") };
    (reach_m < SHORT * wanted_m).then(|| {
        let why = if followed_m < SHORT * wanted_m {
            format!("rays follow {followed_m:.1} of it round {turns}, for no more fit into the picture")
        } else {
            format!("rays follow all of it round {turns}, but ground or what stands on it hides the rest, or it lies beside the picture")
        };
        let text = format!(
            "constructor: from {position_m:.1} the preview shows {reach_m:.1} of the {wanted_m:.1} asked for: {why}; give a shorter \
             preview_m or a narrower lens"
        );
        let warning = Warning::new(WarningKind::Limited, text).about("constructor").with("position_m", position_m);
        warning.with("reach_m", reach_m).with("wanted_m", wanted_m).with("followed_m", followed_m)
    })
}

/// Measures how much of the path the picture shows over terrain: the record says what is seen.
fn judge(report: &mut PathReport, scene: &Scene, view: &View, (preview, layer): (&PathPreview, Option<&str>)) {
    if scene.terrain().is_none() {
        return;
    }
    let lift = scene
        .layers
        .iter()
        .find(|l| Some(l.id.as_str()) == layer)
        .map_or(0.0, |l| l.kind.lines().map_or(0.0, |line| line.lift_m));
    let PreviewReport { position_m, wanted_m, reach_m, .. } = report.preview;
    let path: (&dyn Fn(f64) -> _, f64) = (&|s| preview.point_at(s), preview.length());
    let [ahead, all] = length_seen(scene, view, path, [position_m, position_m + wanted_m], lift);
    (report.preview.reach_m, report.followed_m, report.seen_m) = (ahead, Some(reach_m), Some(all));
}

/// Report of a path preview, and the path that was traced for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PathReport {
    /// The preview. `reach_m` is the length ahead that the picture shows, by lines of sight over the drawn ground; in scenes without
    /// terrain the length that rays follow.
    #[serde(flatten)]
    pub preview: PreviewReport,
    /// Length ahead that rays follow round the turns, whether or not something hides it, scene units; `None` where `reach_m` is that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub followed_m: Option<f64>,
    /// Length of the whole path that the picture shows, before and beyond the preview too, as `measure` finds it, scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seen_m: Option<f64>,
    /// The centreline, if one was traced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centreline: Option<CentrelineReport>,
    /// Volumes that are drawn as the wall around the path.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub walls: Vec<WallReport>,
}

/// The constructor of a document, unless it is `manual`.
pub fn stated(source: &SourceDocument) -> Option<&ConstructorDoc> {
    source.document.constructor.as_ref().filter(|doc| doc.kind != ConstructorKind::Manual)
}

/// Whether a document previews a path.
pub(super) fn previews(source: &SourceDocument) -> bool {
    stated(source).is_some_and(|doc| doc.kind == ConstructorKind::PathPreview)
}

/// Volumes that are drawn as walls in the view of a constructor.
pub fn walls(report: Option<&ConstructorReport>) -> &[WallReport] {
    match report {
        Some(ConstructorReport::PathPreview(report)) => &report.walls,
        _ => &[],
    }
}

/// Whether the view of a frame depends on the frames before.
pub fn tracks(source: &SourceDocument) -> bool {
    stated(source).is_some_and(|doc| doc.kind != ConstructorKind::PathPreview)
}

/// Number of frames in which a probe under a resting camera completes its turns and is shown for a while; `None` without a probe.
pub fn frames_of_probe(source: &SourceDocument, fps: f64) -> Option<f64> {
    let doc = stated(source).filter(|doc| doc.kind == ConstructorKind::AutoProbe)?;
    let options = probe_options(doc);
    Some((options.turns as f64 / options.cap_per_s + LOOKED_AT_S) * fps)
}

fn probe_options(doc: &ConstructorDoc) -> ProbeOptions {
    let usual = ProbeOptions::default();
    ProbeOptions {
        turns: doc.turns.map_or(usual.turns, |n| n as usize),
        reach: doc.reach_m,
        cap_per_s: doc.cap_per_s.unwrap_or(usual.cap_per_s),
    }
}

/// Refuses stages that do not combine with a constructor.
pub(super) fn check_stages(source: &SourceDocument) -> Result<(), BelvedereError> {
    let Some(doc) = stated(source) else { return Ok(()) };
    let previews = doc.kind == ConstructorKind::PathPreview;
    let probes = doc.kind == ConstructorKind::AutoProbe;
    let reason = source.document.stage.iter().find_map(|stage| match stage {
        StageDoc::SplineBend(_) if previews => {
            Some("path_preview has a camera of its own, which a spline bend cannot follow; remove the spline_bend stage")
        }
        StageDoc::SplineBend(_) if probes => {
            Some("auto_probe looks for free space where things stand, not where a spline bend carries them; remove the spline_bend stage")
        }
        StageDoc::GroundMoves(_) if previews || probes => {
            Some("it works in space as it is, not as an author moved it; remove the ground_moves stage")
        }
        StageDoc::Strip(_) if previews || probes => {
            Some("it works in space as it is, not as a strip unrolls it; remove the strip stage")
        }
        StageDoc::Tube(_) => Some("it works in space as it is, not as a tube straightens it; remove the tube stage"),
        StageDoc::Unroll(_) => Some("it works in the picture of one direction; remove the unroll stage"),
        StageDoc::Relief(_) if previews || probes => {
            Some("it works in space as it is, not as a relief stage changes it; remove the relief stage")
        }
        StageDoc::CurvedRays(_) => Some("it builds the curved rays itself; remove the curved_rays stage, or set kind = \"manual\""),
        stage if stage.is_terrain_intent() => {
            Some("it cannot follow ground that is still to be solved; give the solved delta, or remove the terrain_disocclusion stage")
        }
        _ => None,
    });
    match reason {
        Some(reason) => Err(source.error(&["constructor", "kind"], format!("constructor: {reason}")).into()),
        None => Ok(()),
    }
}

/// Reads the path of a preview, without previewing it.
///
/// # Errors
/// Those of [`path::read`].
pub(super) fn check_path(source: &SourceDocument, roots: &Roots, scene: &Scene) -> Result<(), BelvedereError> {
    let doc = stated(source).filter(|doc| doc.kind == ConstructorKind::PathPreview);
    let Some(name) = doc.and_then(|doc| doc.path.as_deref()) else { return Ok(()) };
    path::read(source, roots, scene, name, &|reason| of_path(source, reason)).map(drop)
}

/// An error of the path of a preview.
fn of_path(source: &SourceDocument, reason: String) -> DocumentError {
    source.error(&["constructor", "path"], format!("constructor: {reason}"))
}

/// The view `base` with the turns of the document's constructor.
pub(super) fn construct(
    source: &SourceDocument,
    roots: &Roots,
    scene: &Scene,
    base: View,
    solving: &mut Solving<'_>,
    (inputs, warnings): (&mut Vec<InputFile>, &mut Vec<Warning>),
) -> Result<(View, Option<ConstructorReport>), BelvedereError> {
    let Some(doc) = stated(source) else { return Ok((base, None)) };
    if doc.kind == ConstructorKind::PathPreview {
        let prepared = prepared(source, roots, scene, base.pinhole().image, &mut solving.memory.preview)?;
        inputs.extend(prepared.file.clone());
        warnings.extend(prepared.warnings.iter().cloned());
        let (view, mut report) = preview(source, &base, prepared)?;
        judge(&mut report, scene, &view, (&prepared.preview, doc.path.as_deref()));
        return Ok((view, Some(ConstructorReport::PathPreview(report))));
    }
    if let Some(reason) = refusal("the constructor", scene, &base) {
        return Err(source.error(&["constructor", "kind"], format!("constructor: {reason}")).into());
    }
    if doc.kind == ConstructorKind::AutoProbe {
        let memory = &mut solving.memory.probe;
        let options = probe_options(doc);
        let probed = auto_probe(scene, &base, &options, solving.time_step_s, memory, solving.progress);
        let probed = probed.map_err(|e| fail(source, e))?;
        return Ok((probed.view, Some(ConstructorReport::AutoProbe(probed.report))));
    }
    let (options, target) = tracking(source, doc, scene, &base)?;
    let memory = &mut solving.memory.tracking;
    let tracked = track_target(scene, &base, &target, &options, solving.time_step_s, memory);
    let tracked = tracked.map_err(|e| fail(source, e))?;
    Ok((tracked.view, Some(ConstructorReport::TargetTracking(tracked.report))))
}

/// Options of the document's target tracking, and the target.
fn tracking(
    source: &SourceDocument,
    doc: &ConstructorDoc,
    scene: &Scene,
    base: &View,
) -> Result<(TrackingOptions, Target), BelvedereError> {
    let usual = TrackingOptions::default();
    let options = TrackingOptions {
        z0: doc.z0,
        a: doc.a,
        f_step: doc.f_step.unwrap_or(usual.f_step),
        cap_per_s: doc.cap_per_s.unwrap_or(usual.cap_per_s),
        grow_px: doc.grow_px.unwrap_or(usual.grow_px * f64::from(base.pinhole().image[1]) / 720.0),
    };
    Ok((options, target(source, scene, doc.target.as_deref().unwrap_or_default())?))
}

/// Adds a frame of a film to the plan of its target tracking; `base` is the view without the turns of the tracking. Does nothing for
/// other constructors, and for views that the constructor refuses.
pub fn plan_frame(
    source: &SourceDocument,
    scene: &Scene,
    base: &View,
    time_step_s: f64,
    planner: &mut Option<FilmPlanner>,
) -> Result<(), BelvedereError> {
    let Some(doc) = stated(source).filter(|doc| doc.kind == ConstructorKind::TargetTracking) else { return Ok(()) };
    if refusal("the constructor", scene, base).is_some() {
        return Ok(());
    }
    let (options, target) = tracking(source, doc, scene, base)?;
    if planner.is_none() {
        *planner = Some(FilmPlanner::new(options, time_step_s).map_err(|e| fail(source, e))?);
    }
    if let Some(planner) = planner {
        planner.add(scene, base, &target);
    }
    Ok(())
}

/// Whether a document tracks a target.
pub fn tracks_target(source: &SourceDocument) -> bool {
    stated(source).is_some_and(|doc| doc.kind == ConstructorKind::TargetTracking)
}

fn fail(source: &SourceDocument, e: ConstructError) -> BelvedereError {
    match e {
        ConstructError::Cancelled(c) => c.into(),
        e => source.error(&["constructor", "kind"], format!("constructor: {e}")).into(),
    }
}

/// The view of a path preview at the position given by the document.
fn preview(source: &SourceDocument, base: &View, prepared: &Prepared) -> Result<(View, PathReport), BelvedereError> {
    let (pinhole, doc) = (base.pinhole(), stated(source));
    let position = doc.and_then(|d| d.position_m).unwrap_or(0.0);
    let seen = prepared.preview.at(position, pinhole.image, pinhole.far).map_err(|e| fail(source, e))?;
    let root = seen.view.pinhole().clone();
    // The preview has a camera of its own; stages fixed to the world stay.
    let earlier = base.stages().iter().filter_map(|stage| match stage {
        Stage::EarthCurvature(earth) => Some(Stage::EarthCurvature(EarthCurvature { eye: root.eye, ..*earth })),
        stage => stage.moves_ground().then(|| stage.clone()),
    });
    let stages = earlier.chain(seen.view.stages().iter().cloned()).collect();
    let view = View::new(root, stages).map_err(|e| source.error(&["constructor", "kind"], e))?;
    let Prepared { centreline, walls, .. } = prepared;
    let (centreline, walls) = (*centreline, walls.clone());
    Ok((view, PathReport { preview: seen.report, followed_m: None, seen_m: None, centreline, walls }))
}

/// Width of the picture at the position in a channel, in clearances of the path.
const CLEARANCES: f64 = 6.0;

/// The preview of the document, reused from the frame before if it is the same.
fn prepared<'m>(
    source: &SourceDocument,
    roots: &Roots,
    scene: &Scene,
    image: [u32; 2],
    memory: &'m mut Option<Prepared>,
) -> Result<&'m Prepared, BelvedereError> {
    let usual = || ConstructorDoc::of(ConstructorKind::PathPreview);
    let doc = ConstructorDoc { position_m: None, ..stated(source).cloned().unwrap_or_else(usual) };
    let made_from = (doc, image);
    if memory.as_ref().is_none_or(|known| known.made_from != made_from) {
        let doc = &made_from.0;
        let of_centreline = |key: &str, reason: String| {
            source.error(&["constructor", "centreline", key], format!("constructor: centreline: {reason}"))
        };
        let traced = doc.centreline.as_ref().map(|doc| centreline::read(scene, doc, &of_centreline)).transpose()?;
        let (points, file) = match &traced {
            Some(traced) => (traced.points.clone(), None),
            None => path::read(source, roots, scene, doc.path.as_deref().unwrap_or_default(), &|r| of_path(source, r))?,
        };
        let centreline = traced.map(|t| t.report);
        let (walls, warnings) = wall::around(source, scene, &points)?;
        let with_walls = wall::drawn(scene, &walls);
        let scene = with_walls.as_ref().unwrap_or(scene);
        let length: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
        let preview_m = doc.preview_m.unwrap_or(0.25 * length);
        let stands = |kind: &LayerKind| matches!(kind, LayerKind::Terrain(_) | LayerKind::Boxes(_));
        let level = centreline.is_none() && scene.layers.iter().any(|layer| stands(&layer.kind));
        let mut usual = Lens::for_preview(preview_m, level);
        if let Some(report) = centreline {
            usual.width_m = usual.width_m.min(CLEARANCES * report.median_clearance);
        }
        let preview = match doc.lens {
            Some(lens) => {
                let lens = Lens {
                    behind_m: lens.behind_m.unwrap_or(usual.behind_m),
                    width_m: lens.width_m.unwrap_or(usual.width_m),
                    rise_m: lens.rise_m.unwrap_or(usual.rise_m),
                };
                let preview = PathPreview::new(&points, preview_m, lens, level, image);
                preview.and_then(|preview| preview.standing_in(scene, image))
            }
            None => PathPreview::fitted(scene, &points, preview_m, usual, level, image),
        };
        let preview = preview.map_err(|e| fail(source, e))?;
        *memory = Some(Prepared { made_from, file, centreline, walls, warnings, preview });
    }
    Ok(memory.as_ref().ok_or_else(|| source.error(&["constructor"], "there is no path"))?)
}

/// Length of the path of a document's preview, scene units; `None` if it has none.
pub fn path_length(
    source: &SourceDocument,
    roots: &Roots,
    scene: &Scene,
    image: [u32; 2],
) -> Result<Option<f64>, BelvedereError> {
    match stated(source) {
        Some(doc) if doc.kind == ConstructorKind::PathPreview => {
            prepared(source, roots, scene, image, &mut None).map(|p| Some(p.preview.length()))
        }
        _ => Ok(None),
    }
}

/// The target to keep in view: a layer, a part or box of one, atoms, or a point.
fn target(source: &SourceDocument, scene: &Scene, id: &str) -> Result<Target, BelvedereError> {
    Ok(targets::target(scene, id).map_err(|e| {
        let hint = if scene.layers.iter().any(|l| l.id == id) { "; name something that stands on it" } else { "" };
        source.error(&["constructor", "target"], format!("constructor: target: {e}{hint}"))
    })?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn previews_shorter_than_asked_are_said() {
        let report = |reach_m: f64| {
            let preview = PreviewReport { position_m: 10.0, reach_m, wanted_m: 200.0, turns: 1, tolerance_m: 1.0 };
            let (followed_m, seen_m, centreline, walls) = (None, None, None, Vec::new());
            ConstructorReport::PathPreview(PathReport { preview, followed_m, seen_m, centreline, walls })
        };
        let said = remark(Some(&report(120.0))).expect("a warning");
        assert!(said.text().contains("120.0 of the 200.0"), "{said}");
        assert!(remark(Some(&report(200.0))).is_none() && remark(None).is_none());
    }
}
