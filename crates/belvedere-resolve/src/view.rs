//! Resolves camera and stages: the view, the light, and the document with every rule replaced by its value.

use super::constructor::{self, ConstructorReport};
use super::ground::{Ground, earth};
use super::solving::Solving;
use super::strip::StripReport;
use super::tube::TubeReport;
use super::{camera, context, light, stages, terrain};
use crate::BelvedereError;
use belvedere_construct::ground_moves::GroundMovesReport;
use belvedere_core::View;
use belvedere_core::Warning;
use belvedere_disocclusion::TerrainReport;
use belvedere_document::paths::Roots;
use belvedere_document::{Document, SourceDocument};
use belvedere_io::InputFile;
use belvedere_scene::{Light, Scene};

/// Results that depend on camera and stages.
pub struct ResolvedView {
    /// The document with every default filled in and every rule replaced by its value.
    pub document: Document,
    /// The view.
    pub view: View,
    /// The light.
    pub light: Light,
    /// Report of the terrain solver, if it ran.
    pub terrain: Option<TerrainReport>,
    /// Report of moved ground, if an author moves it.
    pub moved: Option<GroundMovesReport>,
    /// Report of the strip, if there is one.
    pub strip: Option<StripReport>,
    /// Report of the tube, if there is one.
    pub tube: Option<TubeReport>,
    /// Report of the constructor of curved rays, if there is one.
    pub constructor: Option<ConstructorReport>,
    /// Files that were read.
    pub inputs: Vec<InputFile>,
    /// Oddities.
    pub warnings: Vec<Warning>,
}

/// Resolves camera, stages and light over a scene. Without `solving` an intent of terrain disocclusion is left out.
///
/// * `checks`: whether presets are checked at viewing angles that the picture does not show.
pub fn resolve(
    source: &SourceDocument,
    roots: &Roots,
    scene: &Scene,
    mut solving: Option<&mut Solving<'_>>,
    checks: bool,
) -> Result<ResolvedView, BelvedereError> {
    let (mut inputs, mut warnings) = (Vec::new(), Vec::new());
    let ground = Ground::of(scene);
    let shape = source.document.earth;
    let mut camera = camera::resolve(source, &ground, stages::plane_normal(&source.document))?;
    if let Some(solving) = solving.as_deref_mut() {
        let before = earth(shape, &ground, camera.pinhole.eye, &mut Vec::new()).into_iter().collect();
        terrain::adjust(source, scene, &mut camera, before, solving, &mut warnings)?;
    }
    let mut chain: Vec<_> = earth(shape, &ground, camera.pinhole.eye, &mut warnings).into_iter().collect();
    let context =
        context::StageContext { source, roots, scene, ground: &ground, camera: &camera, earth: &chain, checks };
    let resolved = stages::resolve(&context, solving.as_deref_mut(), &mut inputs, &mut warnings)?;
    chain.extend(resolved.stages);
    let view = View::new(resolved.pinhole, chain).map_err(|e| source.error(&["stage"], e))?;
    let (view, constructor) = match solving {
        Some(solving) => constructor::construct(source, roots, scene, view, solving, (&mut inputs, &mut warnings))?,
        None => {
            constructor::check_path(source, roots, scene)?;
            (view, None)
        }
    };
    warnings.extend(constructor::remark(constructor.as_ref()));
    let light = light::resolve(source, &ground, view.pinhole().eye, &mut warnings)?;
    let mut document = source.document.clone();
    document.crs = scene.crs.to_string();
    document.camera = camera.document;
    document.stage = resolved.documents;
    let (terrain, moved, strip, tube) = (resolved.terrain, resolved.moved, resolved.strip, resolved.tube);
    Ok(ResolvedView { document, view, light, terrain, moved, strip, tube, constructor, inputs, warnings })
}
