//! Resolves the stages of a document.

use super::context::StageContext;
use super::solving::Solving;
use super::spline::spline;
use super::strip::StripReport;
use super::terrain;
use super::tube::TubeReport;
use crate::BelvedereError;
use belvedere_construct::ground_moves::GroundMovesReport;
use belvedere_core::Warning;
use belvedere_core::{DVec3, Pinhole, Stage, TerrainDisocclusion, View};
use belvedere_disocclusion::TerrainReport;
use belvedere_document::{Document, StageDoc, Table, TerrainStageDoc};
use belvedere_io::InputFile;

/// Normal of the reference plane of the first spline stage.
pub fn plane_normal(document: &Document) -> Option<DVec3> {
    document.stage.iter().find_map(|stage| match stage {
        StageDoc::SplineBend(spline) => Some(spline.plane.as_ref().map_or(DVec3::Z, |p| DVec3::from_array(p.normal))),
        _ => None,
    })
}

/// The resolved stages and their reports.
pub(super) struct ResolvedStages {
    /// In order of application.
    pub(super) stages: Vec<Stage>,
    /// The camera behind them: a preset may set another field of view.
    pub(super) pinhole: Pinhole,
    /// The documents with every rule replaced by its value.
    pub(super) documents: Vec<StageDoc>,
    /// Report of the terrain solver, if it ran.
    pub(super) terrain: Option<TerrainReport>,
    /// Report of moved ground, if an author moves it.
    pub(super) moved: Option<GroundMovesReport>,
    /// Report of the strip, if there is one.
    pub(super) strip: Option<StripReport>,
    /// Report of the tube, if there is one.
    pub(super) tube: Option<TubeReport>,
}

/// Resolves the stages. Without `solving` an intent of terrain disocclusion gives no stage.
pub(super) fn resolve(
    context: &StageContext<'_>,
    solving: Option<&mut Solving<'_>>,
    inputs: &mut Vec<InputFile>,
    warnings: &mut Vec<Warning>,
) -> Result<ResolvedStages, BelvedereError> {
    let pinhole = context.camera.pinhole.clone();
    let mut out = ResolvedStages {
        stages: Vec::new(),
        pinhole,
        documents: Vec::new(),
        terrain: None,
        moved: None,
        strip: None,
        tube: None,
    };
    let mut intent = None;
    for (i, stage) in context.source.document.stage.iter().enumerate() {
        let at = context.at(i);
        if let StageDoc::TerrainDisocclusion(doc) = stage
            && stage.is_terrain_intent()
        {
            let settings = terrain::settings(doc).map_err(|(key, reason)| at.error(&[key], reason))?;
            out.documents.push(StageDoc::TerrainDisocclusion(terrain::document(&settings, context.scene)));
            intent = Some((i, settings));
            continue;
        }
        let (stage, document) = one(context, stage, &mut out, (&mut *inputs, &mut *warnings), at)?;
        out.stages.push(stage);
        out.documents.push(document);
    }
    // The terrain stage comes first in the chain but is solved last, so that its guarantee holds behind the later stages.
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

/// A stage that needs no solver, and its document.
///
/// * `out`: takes its report, and the camera that it chooses.
fn one(
    context: &StageContext<'_>,
    stage: &StageDoc,
    out: &mut ResolvedStages,
    (inputs, warnings): (&mut Vec<InputFile>, &mut Vec<Warning>),
    at: Table<'_>,
) -> Result<(Stage, StageDoc), BelvedereError> {
    Ok(match stage {
        StageDoc::TerrainDisocclusion(doc) => solved_terrain(context, doc, inputs, at)?,
        StageDoc::GroundMoves(doc) => {
            let (stage, document, report) = super::ground_moves::resolve(context, doc, warnings, at)?;
            out.moved = Some(report);
            (stage, document)
        }
        StageDoc::Strip(doc) => {
            let (stage, document, report) = super::strip::resolve(context, doc, warnings, at)?;
            out.strip = Some(report);
            (stage, document)
        }
        StageDoc::Tube(doc) => {
            let (stage, document, report) = super::tube::resolve(context, doc, (inputs, warnings), at)?;
            out.tube = Some(report);
            (stage, document)
        }
        StageDoc::Unroll(doc) => {
            let (stage, document, pinhole) = super::unroll::resolve(context, doc, at)?;
            out.pinhole = pinhole;
            (stage, document)
        }
        StageDoc::Relief(doc) => super::relief::resolve(context, doc, at)?,
        StageDoc::SplineBend(doc) => {
            let (bend, document) = spline(context, doc, inputs, warnings, at)?;
            out.pinhole = bend.adapted_pinhole(&out.pinhole);
            (Stage::SplineBend(bend), document)
        }
        StageDoc::CurvedRays(doc) => super::rays::resolve(&out.pinhole, doc, at)?,
    })
}

/// The stage of a solved grid.
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
            ).into());
        }
    }
    let grid = super::delta::read(&path, bytes, context.ground.crs).map_err(|reason| at.error(&["delta"], reason))?;
    inputs.push(file);
    let grid = match context.ground.terrain {
        Some(terrain) => grid.on_facets(terrain.nodes()),
        None => grid,
    };
    Ok((Stage::TerrainDisocclusion(TerrainDisocclusion::new(grid)), StageDoc::TerrainDisocclusion(doc.clone())))
}
