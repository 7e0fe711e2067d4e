//! Constructors of curved rays: from `[constructor]` to a view with turns.

use super::terrain::Solving;
use crate::BelvedereError;
use crate::scene_file::{self, ConstructorDoc, ConstructorKind, SourceDocument, StageDoc};
use belvedere_construct::rays::{Target, TrackingMemory, TrackingOptions, TrackingReport, track_target};
use belvedere_core::View;
use belvedere_disocclusion::TerrainMemory;
use belvedere_scene::Scene;
use serde::{Deserialize, Serialize};

/// What constructors remember between the frames of a film.
#[derive(Debug, Clone, Default)]
pub(crate) struct Memory {
    pub(crate) terrain: TerrainMemory,
    pub(crate) tracking: TrackingMemory,
}

/// What a constructor of curved rays came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ConstructorReport {
    /// Target tracking.
    TargetTracking(TrackingReport),
}

/// The constructor of a document, unless it is `manual`.
pub(crate) fn stated(source: &SourceDocument) -> Option<&ConstructorDoc> {
    source.document.constructor.as_ref().filter(|doc| doc.kind != ConstructorKind::Manual)
}

/// Stages that a constructor cannot follow.
pub(super) fn check_stages(source: &SourceDocument) -> Result<(), BelvedereError> {
    let Some(doc) = stated(source) else { return Ok(()) };
    let reason = source.document.stage.iter().find_map(|stage| match stage {
        StageDoc::CurvedRays(_) => Some("it builds the curved rays itself; remove the curved_rays stage, or set kind = \"manual\""),
        stage if stage.is_terrain_intent() => {
            Some("it cannot follow ground that is still to be solved; give the solved delta, or remove the terrain_disocclusion stage")
        }
        _ => None,
    });
    match (reason, doc.kind) {
        (Some(reason), _) => Err(source.error(&["constructor", "kind"], format!("constructor: {reason}"))),
        (None, ConstructorKind::AutoProbe) => Err(source.error(
            &["constructor", "kind"],
            "constructor: auto_probe is not built yet; use target_tracking, or give the stages themselves with kind = \"manual\"",
        )),
        (None, ConstructorKind::PathPreview) => Err(source.error(
            &["constructor", "kind"],
            "constructor: path_preview is not built yet; use target_tracking, or give the stages themselves with kind = \"manual\"",
        )),
        (None, _) => Ok(()),
    }
}

/// The view of a document with the turns that its constructor adds to `base`.
pub(super) fn construct(
    source: &SourceDocument,
    scene: &Scene,
    base: View,
    solving: &mut Solving<'_>,
) -> Result<(View, Option<ConstructorReport>), BelvedereError> {
    let Some(doc) = stated(source) else { return Ok((base, None)) };
    let fail = |e: belvedere_construct::ConstructError| match e {
        belvedere_construct::ConstructError::Cancelled(c) => c.into(),
        e => source.error(&["constructor", "kind"], format!("constructor: {e}")),
    };
    let usual = TrackingOptions::default();
    let options = TrackingOptions {
        z0: doc.z0,
        a: doc.a,
        f_step: doc.f_step.unwrap_or(usual.f_step),
        cap_per_s: doc.cap_per_s.unwrap_or(usual.cap_per_s),
        grow_px: doc.grow_px.unwrap_or(usual.grow_px * f64::from(base.pinhole().image[1]) / 720.0),
    };
    let target = target(source, scene, doc.target.as_deref().unwrap_or_default())?;
    let memory = &mut solving.memory.tracking;
    let tracked = track_target(scene, &base, &target, &options, solving.time_step_s, memory).map_err(fail)?;
    Ok((tracked.view, Some(ConstructorReport::TargetTracking(tracked.report))))
}

/// The layer to be kept in view.
fn target(source: &SourceDocument, scene: &Scene, id: &str) -> Result<Target, BelvedereError> {
    let fail = |reason: String| source.error(&["constructor", "target"], format!("constructor: {reason}"));
    let ids: Vec<&str> = scene.layers.iter().map(|l| l.id.as_str()).collect();
    let Some(index) = ids.iter().position(|other| *other == id) else {
        return Err(fail(format!("target \"{id}\" is no layer of the scene; {}", scene_file::suggestion(id, &ids))));
    };
    Target::layer(scene, index).ok_or_else(|| {
        fail(format!("layer \"{id}\" cannot be tracked: it is ground, an area, or holds nothing; name something that stands on it"))
    })
}
