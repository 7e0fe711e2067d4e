//! A scene with a view and a light: everything that a picture needs, nothing left to look up.

use crate::record::{AreaRecord, InputFile};
use crate::resolve::StripReport;
use crate::resolve::constructor::{self, ConstructorReport, Memory};
use crate::resolve::motion::Motions;
use crate::resolve::terrain::{self, Solving};
use crate::resolve::{validate, view};
use crate::scene_file::paths::Roots;
use crate::scene_file::{Document, OverlayDoc, SourceDocument, StageDoc};
use crate::{BelvedereError, OpenOptions};
use belvedere_core::{SpaceMap, Stage, View};
use belvedere_cpu::CpuRenderer;
use belvedere_disocclusion::{TerrainReport, TerrainSettings};
use belvedere_scene::{Light, Scene, Stylisation};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Scene, view and light, from memory ([`Session::from_parts`]) or from a scene file ([`Session::open`]).
///
/// Clones share the scene and the renderer, with what that remembers from picture to picture.
#[derive(Debug, Clone)]
pub struct Session {
    pub(crate) scene: Arc<Scene>,
    pub(crate) view: View,
    pub(crate) light: Light,
    pub(crate) overlay: OverlayDoc,
    pub(crate) stylisation: Stylisation,
    pub(crate) terrain: Option<TerrainReport>,
    pub(crate) strip: Option<StripReport>,
    pub(crate) constructor: Option<ConstructorReport>,
    pub(crate) motions: Option<Arc<Motions>>,
    pub(crate) warnings: Vec<String>,
    pub(crate) areas: Vec<AreaRecord>,
    pub(crate) inputs: Vec<InputFile>,
    pub(crate) description: Option<Description>,
    pub(crate) renderer: Arc<CpuRenderer>,
}

/// The document that a session was made from.
#[derive(Debug, Clone)]
pub(crate) struct Description {
    /// As written.
    pub(crate) source: SourceDocument,
    /// With every default filled in and every rule replaced by its value.
    pub(crate) resolved: Document,
    /// Where its files may lie.
    pub(crate) roots: Roots,
}

impl Session {
    /// A session of layers and a view made in memory, under the default light (north-west, 45 degrees high).
    pub fn from_parts(scene: impl Into<Arc<Scene>>, view: View) -> Self {
        Self {
            scene: scene.into(),
            view,
            light: Light::default(),
            overlay: OverlayDoc::default(),
            stylisation: Stylisation::default(),
            terrain: None,
            strip: None,
            constructor: None,
            motions: None,
            warnings: Vec::new(),
            areas: Vec::new(),
            inputs: Vec::new(),
            description: None,
            renderer: Arc::default(),
        }
    }

    /// The same under another light.
    pub fn with_light(self, light: Light) -> Self {
        Self { light, ..self }
    }

    /// The same with other marks over the picture.
    pub fn with_overlay(self, overlay: OverlayDoc) -> Self {
        Self { overlay, ..self }
    }

    /// The same with its surfaces drawn over.
    pub fn with_stylisation(self, stylisation: Stylisation) -> Self {
        Self { stylisation, ..self }
    }

    /// The same scene in another view. A document that described the view before is left behind.
    pub fn with_view(self, view: View) -> Self {
        Self { view, terrain: None, strip: None, constructor: None, description: None, ..self }
    }

    /// The same scene by another document of the same layers: everything that depends on camera and stages is resolved again.
    /// Without `solving` an intent of terrain disocclusion is left out.
    pub(crate) fn with_document(
        &self,
        document: Document,
        solving: Option<&mut Solving<'_>>,
    ) -> Result<Self, BelvedereError> {
        let (origin, roots) = match &self.description {
            Some(d) => (d.source.origin.clone(), d.roots.clone()),
            None => Default::default(),
        };
        let source = SourceDocument { origin, document };
        let resolved = view::resolve(&source, &roots, &self.scene, solving)?;
        let mut warnings = self.warnings.clone();
        warnings.extend(resolved.warnings.into_iter().filter(|w| !self.warnings.contains(w)));
        Ok(Self {
            view: resolved.view,
            light: resolved.light,
            terrain: resolved.terrain,
            strip: resolved.strip,
            constructor: resolved.constructor,
            warnings,
            description: Some(Description { source, resolved: resolved.document, roots }),
            ..self.clone()
        })
    }

    /// The same scene by a document that was edited, opened as by `options`: as [`Session::from_document`] of that document, without
    /// reading the layers again.
    ///
    /// * `about_layers`: warnings that stay. `memory`: what constructors remember of the document before.
    pub(crate) fn edited(
        &self,
        document: Document,
        options: &OpenOptions,
        about_layers: &[String],
        memory: &mut Memory,
    ) -> Result<Self, BelvedereError> {
        let source = SourceDocument::new(document);
        validate::document(&source)?;
        let roots = Roots { allowed: options.allow_roots.clone(), ..Roots::default() };
        let mut solving = Solving { memory, time_step_s: None, progress: &options.progress };
        let resolved = view::resolve(&source, &roots, &self.scene, (!options.unsolved).then_some(&mut solving))?;
        Ok(Self {
            view: resolved.view,
            light: resolved.light,
            overlay: source.document.overlay.clone().unwrap_or_default(),
            stylisation: source.document.stylisation.unwrap_or_default().strengths().unwrap_or_default(),
            terrain: resolved.terrain,
            strip: resolved.strip,
            constructor: resolved.constructor,
            warnings: about_layers.iter().cloned().chain(resolved.warnings).collect(),
            description: Some(Description { source, resolved: resolved.document, roots }),
            ..self.clone()
        })
    }

    /// Layers, unit and coordinate system.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The view.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The light.
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// What the strip along a route came to; `None` if the scene has none.
    pub fn strip_report(&self) -> Option<&StripReport> {
        self.strip.as_ref()
    }

    /// What the solver of terrain disocclusion came to; `None` if none ran.
    pub fn terrain_report(&self) -> Option<&TerrainReport> {
        self.terrain.as_ref()
    }

    /// What the constructor of curved rays came to; `None` if the scene has none.
    pub fn constructor_report(&self) -> Option<&ConstructorReport> {
        self.constructor.as_ref()
    }

    /// The same with every layer where its motion has brought it at a time, seconds; the view stays as it is.
    pub(crate) fn at_time(&self, t: f64) -> Self {
        match &self.motions {
            Some(motions) => Self { scene: Arc::new(motions.at(t)), ..self.clone() },
            None => self.clone(),
        }
    }

    /// Whether the view of a frame depends on the frames before.
    pub(crate) fn tracks(&self) -> bool {
        self.description.as_ref().is_some_and(|d| constructor::tracks(&d.source))
    }

    /// What was odd: one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What the areas of each layer are drawn as, and why; nothing for a session from parts.
    pub fn areas(&self) -> &[AreaRecord] {
        &self.areas
    }

    /// Files that were read, the scene file first.
    pub fn inputs(&self) -> &[InputFile] {
        &self.inputs
    }

    /// Their paths.
    pub fn input_paths(&self) -> Vec<PathBuf> {
        self.inputs.iter().map(|file| file.path.clone()).collect()
    }

    /// The scene file; `None` for a session from memory.
    pub fn path(&self) -> Option<&Path> {
        self.description.as_ref().and_then(|d| d.source.path())
    }

    /// The document with every default filled in and every position, name and rule replaced by its value; it opens to the same
    /// view. `None` for a session from parts.
    pub fn resolved(&self) -> Option<&Document> {
        self.description.as_ref().map(|d| &d.resolved)
    }

    /// Terrain disocclusion that the document asks for and a solver has to find.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn stated_terrain(&self) -> Option<crate::scene_file::TerrainStageDoc> {
        let mut stages = self.description.iter().flat_map(|d| &d.source.document.stage);
        stages.find_map(|stage| match stage {
            StageDoc::TerrainDisocclusion(doc) if doc.delta.is_none() => Some(doc.clone()),
            _ => None,
        })
    }

    /// Parameters of terrain disocclusion as the document states them, else the usual ones.
    ///
    /// # Errors
    /// [`BelvedereError::Setting`] with the parameter that is out of range.
    pub fn terrain_settings(&self) -> Result<TerrainSettings, BelvedereError> {
        let mut stages = self.description.iter().flat_map(|d| &d.source.document.stage);
        let stated = stages.find_map(|stage| match stage {
            StageDoc::TerrainDisocclusion(doc) => Some(doc.clone()),
            _ => None,
        });
        let settings = terrain::settings(&stated.unwrap_or_default());
        settings.map_err(|(_, reason)| BelvedereError::Setting(reason))
    }

    /// The scene file, or the title of the scene, for reports.
    pub(crate) fn name(&self) -> String {
        self.path().map_or_else(|| self.scene.title.clone(), |path| path.display().to_string())
    }

    /// Names of the stages of the view, in order of application.
    pub(crate) fn stage_names(&self) -> Vec<&'static str> {
        self.view.stages().iter().map(|s| s.name()).collect()
    }

    /// Depth at which rays end: `far` if given, else the camera's, else the largest depth of the scene.
    ///
    /// # Errors
    /// [`BelvedereError::NoRayEnd`] if there is none of them.
    pub fn ray_end(&self, far: Option<f64>) -> Result<f64, BelvedereError> {
        let view = &self.view;
        if let Some(far) = far.or(view.pinhole().far) {
            return Ok(far);
        }
        let bounds = self.scene.bounds();
        let corners = bounds.corners();
        let straight = corners.iter().map(|&c| (c - view.pinhole().eye).dot(view.pinhole().forward));
        let bent = corners.iter().filter_map(|&c| view.project(c).ok()).map(|image| image.depth);
        let deepest = straight.chain(bent).fold(0.0, f64::max);
        if bounds.is_empty() || !(deepest > view.pinhole().near) {
            return Err(BelvedereError::NoRayEnd);
        }
        Ok(deepest)
    }

    /// Refuses views that cannot be drawn.
    ///
    /// # Errors
    /// [`BelvedereError::UnderGround`].
    pub fn check_drawable(&self) -> Result<(), BelvedereError> {
        if matches!(self.constructor, Some(ConstructorReport::PathPreview(_))) {
            // Its eye is put where there is room, as far as there is.
            return Ok(());
        }
        let eye = self.view.pinhole().eye;
        let moved = self.view.stages().iter().any(|s| matches!(s, Stage::TerrainDisocclusion(_)));
        // The ground that a strip carries under the eye; beside the strip there is none.
        let strip =
            self.view.stages().iter().find_map(|s| if let Stage::Strip(strip) = s { Some(strip) } else { None });
        let over = strip.map_or(Some(eye), |strip| strip.invert(eye).ok());
        let ground = over.and_then(|p| self.scene.terrain().and_then(|t| t.surface_at(p.truncate())));
        match ground {
            Some(ground_m) if eye.z < ground_m && !moved => Err(BelvedereError::UnderGround { eye_m: eye.z, ground_m }),
            _ => Ok(()),
        }
    }
}
