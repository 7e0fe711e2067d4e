//! Spline stages.

use super::context::{StageContext, plane};
use crate::BelvedereError;
use belvedere_core::Warning;
use belvedere_core::map::spline::default_pivot;
use belvedere_core::presets::{PresetDocument, PresetError};
use belvedere_core::{DVec3, SplineBend};
use belvedere_document::paths::Roots;
use belvedere_document::{PlaneDoc, PresetsDoc, SplineStageDoc, StageDoc, Table};
use belvedere_io::InputFile;
use belvedere_scene::{Heightfield, Layer, LayerKind, OwnLayer, RigidParts};

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

/// The bend of a spline stage, and its document with every rule replaced by its value.
pub(super) fn spline(
    context: &StageContext<'_>,
    doc: &SplineStageDoc,
    inputs: &mut Vec<InputFile>,
    warnings: &mut Vec<Warning>,
    at: Table<'_>,
) -> Result<(SplineBend, StageDoc), BelvedereError> {
    let presets = presets(context.roots, &doc.presets, inputs, at)?;
    let pinhole = &context.camera.pinhole;
    let (plane, height) = plane(context, doc.plane.as_ref(), at)?;
    let pivot = doc.pivot.map_or_else(|| default_pivot(pinhole, &plane), DVec3::from_array);
    let bend = SplineBend::new(pinhole, &presets, &plane, pivot).map_err(|e| at.error(&["presets"], e))?;
    if context.checks {
        let heights = heights(context).map(|range| range.map(|z| z - height)).filter(|_| plane.normal() == DVec3::Z);
        let found = belvedere_core::map::spline::check_presets(&presets, bend.resolved().distance, heights);
        warnings.extend(found.iter().map(Warning::from));
    }
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

/// Least and largest height of layers that the bend may fold: the terrain, and buildings that are not rigid bodies.
fn heights(context: &StageContext<'_>) -> Option<[f64; 2]> {
    let terrain = context.ground.terrain.map(Heightfield::z_range);
    let solid = |layer: &Layer| match &layer.kind {
        LayerKind::Boxes(boxes) => !boxes.rigid,
        LayerKind::Mesh(mesh) | LayerKind::Own(OwnLayer { surface: mesh, .. }) => mesh.rigid == RigidParts::None,
        _ => false,
    };
    let bounds = context.scene.layers.iter().filter(|l| solid(l)).map(Layer::bounds);
    let solid = bounds.filter(|b| !b.is_empty()).map(|b| [b.min.z, b.max.z]);
    terrain.into_iter().chain(solid).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
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
            if !belvedere_document::names_a_preset_file(name) {
                return Ok(PresetDocument::builtin(name).map_err(|e| match e {
                    PresetError::UnknownName { name } => at.error(&["presets"], belvedere_document::no_preset(&name)),
                    e => at.error(&["presets"], e),
                })?);
            }
            let path = roots.resolve(name).map_err(|e| at.refusal(&["presets"], e))?;
            let (text, file) = belvedere_document::read_text(&path)?;
            let document = belvedere_document::parse_presets(&path, &text)?;
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
