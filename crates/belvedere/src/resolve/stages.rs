//! From the stages of a document to displacements.

use super::camera::ResolvedCamera;
use super::ground::Ground;
use super::strip::StripReport;
use super::terrain::{self, Solving};
use crate::BelvedereError;
use crate::scene_file::paths::Roots;
use crate::scene_file::{
    self, Document, PlaneDoc, PresetsDoc, SourceDocument, SplineStageDoc, StageDoc, Table, TerrainStageDoc,
};
use belvedere_core::map::spline::{ReferencePlane, default_pivot};
use belvedere_core::presets::{BUILTIN_NAMES, PresetDocument};
use belvedere_core::{DVec3, Pinhole, SplineBend, Stage, TerrainDisocclusion, View};
use belvedere_disocclusion::TerrainReport;
use belvedere_io::InputFile;
use belvedere_scene::{Heightfield, Layer, LayerKind, RigidParts, Scene};

/// Normal of the reference plane of the first spline stage.
pub(crate) fn plane_normal(document: &Document) -> Option<DVec3> {
    document.stage.iter().find_map(|stage| match stage {
        StageDoc::SplineBend(spline) => Some(spline.plane.as_ref().map_or(DVec3::Z, |p| DVec3::from_array(p.normal))),
        _ => None,
    })
}

/// The resolved stages and their reports.
pub(super) struct ResolvedStages {
    /// In order of application.
    pub(super) stages: Vec<Stage>,
    /// The camera behind them: a preset may ask for another field of view.
    pub(super) pinhole: Pinhole,
    /// The documents with every rule replaced by its value.
    pub(super) documents: Vec<StageDoc>,
    /// Report of the terrain solver, if it ran.
    pub(super) terrain: Option<TerrainReport>,
    /// Report of the strip, if there is one.
    pub(super) strip: Option<StripReport>,
}

/// What stages are resolved with.
pub(super) struct StageContext<'a> {
    pub(super) source: &'a SourceDocument,
    pub(super) roots: &'a Roots,
    pub(super) scene: &'a Scene,
    pub(super) ground: &'a Ground<'a>,
    pub(super) camera: &'a ResolvedCamera,
    /// Stages before those of the document.
    pub(super) earth: &'a [Stage],
}

/// The stages and their documents. Without `solving` an intent of terrain disocclusion gives no stage.
pub(super) fn resolve(
    context: &StageContext<'_>,
    solving: Option<&mut Solving<'_>>,
    inputs: &mut Vec<InputFile>,
    warnings: &mut Vec<String>,
) -> Result<ResolvedStages, BelvedereError> {
    let pinhole = context.camera.pinhole.clone();
    let mut out = ResolvedStages { stages: Vec::new(), pinhole, documents: Vec::new(), terrain: None, strip: None };
    let mut intent = None;
    for (i, stage) in context.source.document.stage.iter().enumerate() {
        let at = context.at(i);
        let (stage, document) = match stage {
            StageDoc::TerrainDisocclusion(doc) if doc.delta.is_none() => {
                let settings = terrain::settings(doc).map_err(|(key, reason)| at.error(&[key], reason))?;
                out.documents.push(StageDoc::TerrainDisocclusion(terrain::document(&settings, context.scene)));
                intent = Some((i, settings));
                continue;
            }
            StageDoc::TerrainDisocclusion(doc) => solved_terrain(context, doc, inputs, at)?,
            StageDoc::Strip(doc) => {
                let (stage, document, report) = super::strip::resolve(context, doc, warnings, at)?;
                out.strip = Some(report);
                (stage, document)
            }
            StageDoc::Relief(doc) => super::relief::resolve(context, doc, at)?,
            StageDoc::SplineBend(doc) => {
                let (bend, document) = spline(context, doc, inputs, warnings, at)?;
                out.pinhole = bend.adapted_pinhole(&out.pinhole);
                (Stage::SplineBend(bend), document)
            }
            StageDoc::CurvedRays(doc) => super::rays::resolve(&out.pinhole, doc, at)?,
        };
        out.stages.push(stage);
        out.documents.push(document);
    }
    // The terrain comes first and is solved last: what it promises has to hold behind the stages that follow it.
    if let (Some((i, settings)), Some(solving)) = (intent, solving) {
        let chain = context.earth.iter().chain(&out.stages).cloned().collect();
        let base = View::new(out.pinhole.clone(), chain).map_err(|e| context.source.error(&["stage"], e))?;
        let solved = terrain::solve(settings, context.scene, &base, solving, context.at(i))?;
        warnings.extend(terrain::remarks(&solved, context.scene));
        out.stages.insert(0, Stage::TerrainDisocclusion(solved.stage));
        out.terrain = Some(solved.report);
    }
    Ok(out)
}

impl StageContext<'_> {
    fn at(&self, index: usize) -> Table<'_> {
        Table { origin: &self.source.origin, list: "stage", index }
    }
}

/// A solved grid.
fn solved_terrain(
    context: &StageContext<'_>,
    doc: &TerrainStageDoc,
    inputs: &mut Vec<InputFile>,
    at: Table<'_>,
) -> Result<(Stage, StageDoc), BelvedereError> {
    let name = doc.delta.as_deref().unwrap_or_default();
    let path = context.roots.resolve(name).map_err(|e| at.refusal(&["delta"], e))?;
    let (bytes, file) = InputFile::read(&path)?;
    if let Some(expected) = &doc.delta_sha256 {
        let found = &file.sha256;
        if !found.eq_ignore_ascii_case(expected) {
            return Err(at.error(
                &["delta_sha256"],
                format!(
                    "delta {name} has sha256 {found}, the scene says {expected}; solve it again, or correct the scene"
                ),
            ));
        }
    }
    let grid = super::delta::read(&path, bytes, context.ground.crs).map_err(|reason| at.error(&["delta"], reason))?;
    inputs.push(file);
    Ok((Stage::TerrainDisocclusion(TerrainDisocclusion::new(grid)), StageDoc::TerrainDisocclusion(doc.clone())))
}

/// The bend of the first spline stage.
pub(super) fn first_spline(context: &StageContext<'_>) -> Result<Option<SplineBend>, BelvedereError> {
    for (i, stage) in context.source.document.stage.iter().enumerate() {
        if let StageDoc::SplineBend(doc) = stage {
            let (bend, _) = spline(context, doc, &mut Vec::new(), &mut Vec::new(), context.at(i))?;
            return Ok(Some(bend));
        }
    }
    Ok(None)
}

fn spline(
    context: &StageContext<'_>,
    doc: &SplineStageDoc,
    inputs: &mut Vec<InputFile>,
    warnings: &mut Vec<String>,
    at: Table<'_>,
) -> Result<(SplineBend, StageDoc), BelvedereError> {
    let presets = presets(context.roots, &doc.presets, inputs, at)?;
    let pinhole = &context.camera.pinhole;
    let (plane, height) = plane(context, doc.plane.as_ref(), at)?;
    let pivot = doc.pivot.map_or_else(|| default_pivot(pinhole, &plane), DVec3::from_array);
    let bend = SplineBend::new(pinhole, &presets, &plane, pivot).map_err(|e| at.error(&["presets"], e))?;
    let heights = heights(context).map(|range| range.map(|z| z - height)).filter(|_| plane.normal() == DVec3::Z);
    let distance = bend.resolved().distance;
    warnings
        .extend(belvedere_core::map::spline::check_presets(&presets, distance, heights).iter().map(|w| w.to_string()));
    let document = StageDoc::SplineBend(SplineStageDoc {
        presets: PresetsDoc::Inline(Box::new(presets)),
        pivot: Some(pivot.to_array()),
        plane: Some(PlaneDoc {
            normal: doc.plane.as_ref().map_or([0.0, 0.0, 1.0], |p| p.normal),
            height_m: Some(height),
        }),
    });
    Ok((bend, document))
}

/// Lowest and highest height of what the bend may fold: the terrain, and buildings that are no rigid bodies.
fn heights(context: &StageContext<'_>) -> Option<[f64; 2]> {
    let terrain = context.ground.terrain.map(Heightfield::z_range);
    let solid = |layer: &Layer| match &layer.kind {
        LayerKind::Boxes(boxes) => !boxes.rigid,
        LayerKind::Mesh(mesh) => mesh.rigid == RigidParts::None,
        _ => false,
    };
    let bounds = context.scene.layers.iter().filter(|l| solid(l)).map(Layer::bounds);
    let solid = bounds.filter(|b| !b.is_empty()).map(|b| [b.min.z, b.max.z]);
    terrain.into_iter().chain(solid).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
}

/// The reference plane and its height along the unit normal.
pub(super) fn plane(
    context: &StageContext<'_>,
    doc: Option<&PlaneDoc>,
    at: Table<'_>,
) -> Result<(ReferencePlane, f64), BelvedereError> {
    let normal = doc.map_or(DVec3::Z, |p| DVec3::from_array(p.normal));
    let unit = normal.try_normalize().ok_or_else(|| {
        at.error(&["plane", "normal"], "plane normal is [0, 0, 0], it needs a direction; [0, 0, 1] is level ground")
    })?;
    let height = match doc.and_then(|p| p.height_m) {
        Some(height) => height,
        None => plane_point(context, at)?.dot(unit),
    };
    let plane = ReferencePlane::new(normal, height)
        .ok_or_else(|| at.error(&["plane"], "the reference plane is not finite; give a normal and a height"))?;
    Ok((plane, height))
}

/// A point of the default plane: at the median height of the terrain, or at look_at.
fn plane_point(context: &StageContext<'_>, at: Table<'_>) -> Result<DVec3, BelvedereError> {
    let look_at = context.camera.look_at;
    if let Some(terrain) = context.ground.terrain {
        let over = look_at.unwrap_or(context.camera.pinhole.eye);
        return Ok(over.truncate().extend(terrain.median_height()));
    }
    look_at.ok_or_else(|| {
        at.error(&["plane"], "nothing says where the reference plane lies: there is no terrain and no look_at; give plane = { height_m = ... }")
    })
}

/// The document that a stage names.
pub(super) fn presets(
    roots: &Roots,
    doc: &PresetsDoc,
    inputs: &mut Vec<InputFile>,
    at: Table<'_>,
) -> Result<PresetDocument, BelvedereError> {
    let document = match doc {
        PresetsDoc::Inline(document) => (**document).clone(),
        PresetsDoc::Named(name) => {
            if !scene_file::names_a_preset_file(name) {
                return PresetDocument::builtin(name).map_err(|e| {
                    let hint = scene_file::suggestion(name, &BUILTIN_NAMES);
                    at.error(&["presets"], format!("{e} ({hint})"))
                });
            }
            let path = roots.resolve(name).map_err(|e| at.refusal(&["presets"], e))?;
            let (text, file) = scene_file::read_text(&path)?;
            let document = scene_file::parse_presets(&path, &text)?;
            inputs.push(file);
            document
        }
    };
    document.validate().map_err(|e| match doc {
        PresetsDoc::Named(name) => at.error(&["presets"], format!("{name}: {e}")),
        PresetsDoc::Inline(_) => at.error(&["presets"], e),
    })?;
    Ok(document)
}
