//! A session: a scene with a view and a light, ready to be drawn.

use crate::guard::guarded;
use crate::kept::Kept;
use crate::names::PublicNames;
use crate::record::{AreaRecord, InputFile};
use crate::renderers::{self, Renderers, SharedRenderer};
use crate::scene_file::camera;
use crate::scene_file::paths::{Roots, folder_of, stays_below};
use crate::scene_file::request::RendererName;
use crate::scene_file::{CameraDoc, Document, FurnitureDoc, FurnitureWish, OverlayDoc, SourceDocument, StageDoc};
use crate::{BelvedereError, OpenOptions};
use belvedere_core::Warning;
use belvedere_core::{Pinhole, SpaceMap, View};
use belvedere_disocclusion::{TerrainReport, TerrainSettings};
use belvedere_io::{Arrays, arrays, budget, split_table};
use belvedere_overlay::notes::LayerNotes;
use belvedere_resolve::constructor::{self, ConstructorReport};
use belvedere_resolve::motion::Motions;
use belvedere_resolve::solving::{Memory, Solving};
use belvedere_resolve::terrain;
use belvedere_resolve::{GroundMovesReport, StripReport, TubeReport};
use belvedere_resolve::{validate, view, wall};
use belvedere_scene::{Light, Progress, Scene, Stylisation};
use std::path::{MAIN_SEPARATOR, Path, PathBuf};
use std::sync::Arc;

/// Scene, view and light, from memory ([`Session::from_parts`]) or from a scene file ([`Session::open`]).
///
/// Clones share the scene and the renderer, with its caches.
#[derive(Clone)]
pub struct Session {
    pub(crate) loaded: Loaded,
    pub(crate) resolved: Resolved,
    pub(crate) renderers: Renderers,
    /// Memory that its pictures keep.
    pub(crate) kept: Arc<Kept>,
}

/// Data read from files; they stay while the view changes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Loaded {
    pub(crate) scene: Arc<Scene>,
    pub(crate) motions: Option<Arc<Motions>>,
    pub(crate) areas: Vec<AreaRecord>,
    /// What furniture tells of the layers.
    pub(crate) notes: LayerNotes,
    pub(crate) inputs: Vec<InputFile>,
    /// Arrays in memory that the document may name.
    pub(crate) arrays: Arrays,
    pub(crate) warnings: Vec<Warning>,
}

/// Results of resolving a document over the loaded data.
#[derive(Debug, Clone)]
pub(crate) struct Resolved {
    pub(crate) view: View,
    pub(crate) light: Light,
    pub(crate) overlay: OverlayDoc,
    pub(crate) furniture: FurnitureDoc,
    pub(crate) stylisation: Stylisation,
    pub(crate) terrain: Option<TerrainReport>,
    pub(crate) moved: Option<GroundMovesReport>,
    pub(crate) strip: Option<StripReport>,
    pub(crate) tube: Option<TubeReport>,
    pub(crate) constructor: Option<ConstructorReport>,
    pub(crate) inputs: Vec<InputFile>,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) description: Option<Description>,
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

impl std::fmt::Debug for Session {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { loaded, resolved, renderers: _, kept: _ } = self;
        f.debug_struct("Session").field("loaded", loaded).field("resolved", resolved).finish_non_exhaustive()
    }
}

impl Loaded {
    /// The same with volumes drawn as the constructor of a view requires.
    fn drawn_for(self, resolved: &Resolved) -> Self {
        let drawn = wall::drawn(&self.scene, constructor::walls(resolved.constructor.as_ref()));
        Self { scene: drawn.map_or(self.scene, Arc::new), ..self }
    }
}

impl Resolved {
    /// A view under the default light (north-west, 45 degrees high), without a document.
    fn of_view(view: View) -> Self {
        Self {
            view,
            light: Light::default(),
            overlay: OverlayDoc::default(),
            furniture: FurnitureDoc::default(),
            stylisation: Stylisation::default(),
            terrain: None,
            moved: None,
            strip: None,
            tube: None,
            constructor: None,
            inputs: Vec::new(),
            warnings: Vec::new(),
            description: None,
        }
    }

    /// Resolves a document over the loaded data. Without `solving` an intent of terrain disocclusion is left out.
    fn of(
        source: SourceDocument,
        roots: Roots,
        scene: &Scene,
        solving: Option<&mut Solving<'_>>,
        checks: bool,
    ) -> Result<Self, BelvedereError> {
        let made = view::resolve(&source, &roots, scene, solving, checks)?;
        Ok(Self {
            light: made.light,
            overlay: source.document.overlay.clone().unwrap_or_default(),
            furniture: source.document.furniture.clone().unwrap_or_default(),
            stylisation: source.document.stylisation.unwrap_or_default().strengths().unwrap_or_default(),
            terrain: made.terrain,
            moved: made.moved,
            strip: made.strip,
            tube: made.tube,
            constructor: made.constructor,
            inputs: made.inputs,
            warnings: made.warnings,
            description: Some(Description { source, resolved: made.document, roots }),
            ..Self::of_view(made.view)
        })
    }
}

impl Session {
    /// A session of layers and a view made in memory, under the default light (north-west, 45 degrees high).
    pub fn from_parts(scene: impl Into<Arc<Scene>>, view: View) -> Self {
        let loaded = Loaded { scene: scene.into(), ..Loaded::default() };
        Self::together(loaded, Resolved::of_view(view))
    }

    /// A session of loaded data and a document: all sessions of documents are made here.
    pub(crate) fn of_document(
        loaded: Loaded,
        source: SourceDocument,
        roots: Roots,
        solving: Option<&mut Solving<'_>>,
    ) -> Result<Self, BelvedereError> {
        if let Some(unknown) = source.document.renderer.as_ref().and_then(|name| renderers::check(name).err()) {
            return Err(source.error(&["renderer"], unknown).into());
        }
        let resolved = Resolved::of(source, roots, &loaded.scene, solving, true)?;
        Ok(Self::together(loaded.drawn_for(&resolved), resolved))
    }

    /// A session of loaded data in a view that a verb has found, with its description.
    pub(crate) fn of_view(loaded: Loaded, view: View, description: Description) -> Self {
        Self::together(loaded, Resolved { description: Some(description), ..Resolved::of_view(view) })
    }

    fn together(loaded: Loaded, resolved: Resolved) -> Self {
        let description = resolved.description.as_ref();
        let usual = description.and_then(|d| d.source.document.renderer.clone()).unwrap_or_default();
        Self { loaded, resolved, renderers: Renderers::new(usual), kept: Arc::default() }
    }

    /// Bytes of a budget that a picture may take. What the renderer keeps of the last picture is in its estimate and counts once.
    pub(crate) fn bytes_for_picture(&self, budget: u64) -> u64 {
        budget::left_beside(budget, self.kept.others(budget::held()))
    }

    /// The same with another renderer, which `auto` then is.
    pub fn with_renderer(self, renderer: SharedRenderer) -> Self {
        Self { renderers: Renderers::of(renderer), ..self }
    }

    /// The renderer of a name, with the caches of the session.
    ///
    /// # Errors
    /// [`BelvedereError::NoRenderer`].
    pub fn renderer(&self, name: &RendererName) -> Result<SharedRenderer, BelvedereError> {
        self.renderers.get(name)
    }

    /// The same under another light.
    pub fn with_light(self, light: Light) -> Self {
        Self { resolved: Resolved { light, ..self.resolved }, ..self }
    }

    /// The same with other marks over the picture.
    pub fn with_overlay(self, overlay: OverlayDoc) -> Self {
        Self { resolved: Resolved { overlay, ..self.resolved }, ..self }
    }

    /// The same with other furniture: title, legend, attribution, compass, scale.
    pub fn with_furniture(self, furniture: FurnitureDoc) -> Self {
        Self { resolved: Resolved { furniture, ..self.resolved }, ..self }
    }

    /// The same with the furniture that is asked for, in pictures and in the documents.
    pub fn furnished(mut self, wish: &FurnitureWish) -> Self {
        let mut furniture = Some(std::mem::take(&mut self.resolved.furniture));
        wish.put_into(&mut furniture);
        self.resolved.furniture = furniture.unwrap_or_default();
        if let Some(description) = &mut self.resolved.description {
            for document in [&mut description.source.document, &mut description.resolved] {
                wish.put_into(&mut document.furniture);
            }
        }
        self
    }

    /// The same with another stylisation of its surfaces.
    pub fn with_stylisation(self, stylisation: Stylisation) -> Self {
        Self { resolved: Resolved { stylisation, ..self.resolved }, ..self }
    }

    /// The same scene in another view. A document that described the former view is dropped.
    pub fn with_view(self, view: View) -> Self {
        let Resolved { light, overlay, furniture, stylisation, .. } = self.resolved;
        Self { resolved: Resolved { light, overlay, furniture, stylisation, ..Resolved::of_view(view) }, ..self }
    }

    /// The same scene, stages and all, seen by another camera.
    pub(crate) fn seen_by(mut self, pinhole: Pinhole, camera: CameraDoc) -> Result<Self, BelvedereError> {
        self.resolved.view = View::new(pinhole, self.view().stages().to_vec())?;
        if let Some(description) = &mut self.resolved.description {
            description.source.document.camera = camera.clone();
            description.resolved.camera = camera;
        }
        Ok(self)
    }

    /// The same scene by another document of the same layers: everything that depends on camera and stages is resolved again, marks and
    /// stylisation stay. Without `solving` an intent of terrain disocclusion is left out.
    pub(crate) fn with_document(
        &self,
        document: Document,
        solving: Option<&mut Solving<'_>>,
    ) -> Result<Self, BelvedereError> {
        let (origin, roots) = match &self.resolved.description {
            Some(d) => (d.source.origin.clone(), d.roots.clone()),
            None => Default::default(),
        };
        let source = SourceDocument { origin, ..SourceDocument::new(document) };
        let resolved = Resolved::of(source, roots, &self.loaded.scene, solving, true)?;
        let Resolved { overlay, furniture, stylisation, .. } = self.resolved.clone();
        let resolved = Resolved { overlay, furniture, stylisation, ..resolved };
        Ok(Self { loaded: self.loaded.clone().drawn_for(&resolved), resolved, ..self.clone() })
    }

    /// The same scene by an edited document, resolved with `options`: equal to [`Session::from_document`] of that document, without
    /// reading the layers again.
    ///
    /// * `memory`: memory of the constructors from the former document.
    pub(crate) fn edited(
        &self,
        document: Document,
        options: &OpenOptions,
        memory: &mut Memory,
    ) -> Result<Self, BelvedereError> {
        let source = SourceDocument::new(document);
        validate::document(&source)?;
        let (allowed, files) = (options.allow_roots.clone(), options.allow_files.clone());
        let roots = Roots { allowed, files, ..Roots::default() };
        let mut solving = Solving { memory, time_step_s: None, progress: &options.progress };
        let solving = (!options.unsolved).then_some(&mut solving);
        let resolved = Resolved::of(source, roots, &self.loaded.scene, solving, !options.unchecked)?;
        Ok(Self { loaded: self.loaded.clone().drawn_for(&resolved), resolved, ..self.clone() })
    }

    /// The same scene in a picture of another size, pixels, which shows more above and below where it is narrower: everything that depends on
    /// camera and stages is resolved again, layers are not read again. A session from parts keeps its view but for the size.
    ///
    /// # Errors
    /// Those of [`Session::from_document`] but for layers.
    pub fn resized(&self, image: [u32; 2], progress: &Progress) -> Result<Self, BelvedereError> {
        let Some(description) = &self.resolved.description else {
            let pinhole = Pinhole { image, ..self.view().pinhole().clone() };
            return Ok(self.clone().with_view(View::new(pinhole, self.view().stages().to_vec())?));
        };
        let mut document = description.source.document.clone();
        camera::resize(&mut document, image);
        let mut memory = Memory::default();
        let mut solving = Solving { memory: &mut memory, time_step_s: None, progress };
        guarded(|| self.with_document(document, Some(&mut solving)))
    }

    /// Layers, unit and coordinate system.
    pub fn scene(&self) -> &Scene {
        &self.loaded.scene
    }

    /// The view.
    pub fn view(&self) -> &View {
        &self.resolved.view
    }

    /// The light.
    pub fn light(&self) -> &Light {
        &self.resolved.light
    }

    /// Report of ground that an author moved; `None` if the scene has no stage of that kind.
    pub fn moves_report(&self) -> Option<&GroundMovesReport> {
        self.resolved.moved.as_ref()
    }

    /// Report of the tube along a centreline; `None` if the scene has no tube.
    pub fn tube_report(&self) -> Option<&TubeReport> {
        self.resolved.tube.as_ref()
    }

    /// Report of the strip along a route; `None` if the scene has no strip.
    pub fn strip_report(&self) -> Option<&StripReport> {
        self.resolved.strip.as_ref()
    }

    /// Report of the solver of terrain disocclusion; `None` if it did not run.
    pub fn terrain_report(&self) -> Option<&TerrainReport> {
        self.resolved.terrain.as_ref()
    }

    /// Report of the constructor of curved rays; `None` if the scene has no constructor.
    pub fn constructor_report(&self) -> Option<&ConstructorReport> {
        self.resolved.constructor.as_ref()
    }

    /// The same with every layer moved to its position at a time, seconds; the view is unchanged.
    pub(crate) fn at_time(&self, t: f64) -> Self {
        match &self.loaded.motions {
            Some(motions) => {
                let loaded = Loaded { scene: Arc::new(motions.at(t)), ..self.loaded.clone() };
                Self { loaded, ..self.clone() }
            }
            None => self.clone(),
        }
    }

    /// Whether the view of a frame depends on the frames before.
    pub(crate) fn tracks(&self) -> bool {
        self.resolved.description.as_ref().is_some_and(|d| constructor::tracks(&d.source))
    }

    /// Warnings of loading and then of resolving, each text once, with the names of files that outputs give them.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut all = self.loaded.warnings.clone();
        let known = |text: &str| self.loaded.warnings.iter().any(|w| w.text() == text);
        all.extend(self.resolved.warnings.iter().filter(|w| !known(w.text())).cloned());
        // Names cost a look at every file, and the window asks in every frame.
        let paths =
            |w: &Warning| w.text().contains(MAIN_SEPARATOR) || w.subject().is_some_and(|s| s.contains(MAIN_SEPARATOR));
        if all.iter().any(paths) { self.public_names().warnings(&all) } else { all }
    }

    /// Surfaces that the areas of each layer are drawn as, and their sources; empty for a session from parts.
    pub fn areas(&self) -> &[AreaRecord] {
        &self.loaded.areas
    }

    /// Files that were read, the scene file first, and arrays under their names `array:NAME`.
    pub fn inputs(&self) -> Vec<InputFile> {
        self.loaded.inputs.iter().chain(&self.resolved.inputs).cloned().collect()
    }

    /// Paths of the input files.
    pub fn input_paths(&self) -> Vec<PathBuf> {
        let is_file = |path: &PathBuf| !path.to_str().is_some_and(arrays::is_name);
        self.inputs().into_iter().map(|file| file.path).filter(is_file).collect()
    }

    /// Arrays in memory that its document may name.
    pub fn arrays(&self) -> &Arrays {
        &self.loaded.arrays
    }

    /// The scene file; `None` for a session from memory.
    pub fn path(&self) -> Option<&Path> {
        self.resolved.description.as_ref().and_then(|d| d.source.path())
    }

    /// The document with every default filled in and every position, name and rule replaced by its value; it opens to the same
    /// view. `None` for a session from parts.
    pub fn resolved(&self) -> Option<&Document> {
        self.resolved.description.as_ref().map(|d| &d.resolved)
    }

    /// Whether the camera was found when the files were read, to show all of them: it fits this size of the picture alone.
    pub fn is_framed(&self) -> bool {
        self.resolved.description.as_ref().is_some_and(|d| d.source.of_files.is_some())
    }

    /// The document as it was given. `None` for a session from parts.
    pub(crate) fn stated(&self) -> Option<&Document> {
        self.resolved.description.as_ref().map(|d| &d.source.document)
    }

    /// The intent of terrain disocclusion in the document, which a solver has to solve.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn stated_terrain(&self) -> Option<crate::scene_file::TerrainStageDoc> {
        let mut stages = self.resolved.description.iter().flat_map(|d| &d.source.document.stage);
        stages.find_map(|stage| match stage {
            StageDoc::TerrainDisocclusion(doc) if doc.delta.is_none() => Some(doc.clone()),
            _ => None,
        })
    }

    /// Parameters of terrain disocclusion given by the document, else the default ones.
    ///
    /// # Errors
    /// [`BelvedereError::Setting`] with the parameter that is out of range.
    pub fn terrain_settings(&self) -> Result<TerrainSettings, BelvedereError> {
        let mut stages = self.resolved.description.iter().flat_map(|d| &d.source.document.stage);
        let stated = stages.find_map(|stage| match stage {
            StageDoc::TerrainDisocclusion(doc) => Some(doc.clone()),
            _ => None,
        });
        let settings = terrain::settings(&stated.unwrap_or_default());
        settings.map_err(|(_, reason)| BelvedereError::Setting(reason))
    }

    /// The document for a scene file at `path`: files are named relative to its folder wherever that is possible. `None` for a session
    /// from parts.
    pub fn resolved_for(&self, path: &Path) -> Option<Document> {
        let description = self.resolved.description.as_ref()?;
        Some(description.resolved.seen_from(&folder_of(path), &description.roots))
    }

    /// As [`Session::resolved_for`], with the arrays of the document as files beside `path`, which are written; and the paths of these.
    ///
    /// # Errors
    /// [`BelvedereError::Io`] for a file that cannot be written, or exists without `overwrite`.
    pub fn resolved_with_arrays(
        &self,
        path: &Path,
        overwrite: bool,
    ) -> Result<Option<(Document, Vec<PathBuf>)>, BelvedereError> {
        let (Some(mut document), arrays) = (self.resolved_for(path), self.arrays()) else { return Ok(None) };
        let mut named = Vec::new();
        document.for_each_array(&mut |source| {
            let name = source.strip_prefix(arrays::SCHEME).unwrap_or_default().to_owned();
            if let Some(file) = arrays.file_name(&name) {
                *source = file;
                named.push(name);
            }
        });
        named.sort();
        named.dedup();
        let named: Vec<&str> = named.iter().map(String::as_str).collect();
        Ok(Some((document, arrays.write(&named, &folder_of(path), overwrite)?)))
    }

    /// Files that this session may read and that lie outside the folder of a scene file at `path`, canonical paths: a copy of the scene there
    /// needs consent for them.
    pub fn outside(&self, path: &Path) -> Vec<PathBuf> {
        let Some(Description { resolved, roots, .. }) = &self.resolved.description else { return Vec::new() };
        let there = Roots { scene_dir: folder_of(path), ..Roots::default() };
        let mut files = Vec::new();
        resolved.clone().for_each_path(&mut |name| {
            let allowed = roots.resolve(name).ok().map(|file| split_table(&file).0.to_owned());
            files.extend(allowed.filter(|file| !there.is_beside(file)));
        });
        files.sort();
        files.dedup();
        files
    }

    /// Name of the scene file, or the title of the scene, for reports.
    pub(crate) fn name(&self) -> String {
        let name = self.path().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        name.unwrap_or_else(|| self.loaded.scene.title.clone())
    }

    /// Names of its files in outputs.
    pub(crate) fn public_names(&self) -> PublicNames {
        let Some(Description { source, resolved, roots }) = &self.resolved.description else {
            return PublicNames::new(None, Vec::new(), &self.input_paths());
        };
        let mut named = Vec::new();
        resolved.clone().for_each_path(&mut |name| {
            if stays_below(name)
                && let Ok(file) = roots.resolve(name)
            {
                let [file, name] = [&file, Path::new(name.as_str())].map(|path| split_table(path).0.to_owned());
                named.push((file, name.to_string_lossy().into_owned()));
            }
        });
        PublicNames::new(source.path().map(folder_of).as_deref(), named, &self.input_paths())
    }

    /// The document with the names of its files in outputs.
    pub(crate) fn public_document(&self, names: &PublicNames) -> Option<Document> {
        self.resolved.description.as_ref().map(|d| names.document(&d.resolved, &d.roots))
    }

    /// Names of the stages of the view, in order of application.
    pub(crate) fn stage_names(&self) -> Vec<&'static str> {
        self.resolved.view.stages().iter().map(|s| s.name()).collect()
    }

    /// Depth at which rays end: `far` if given, else the camera's, else the largest depth of the scene.
    ///
    /// # Errors
    /// [`BelvedereError::NoRayEnd`] if all three are missing.
    pub fn ray_end(&self, far: Option<f64>) -> Result<f64, BelvedereError> {
        let view = &self.resolved.view;
        if let Some(far) = far.or(view.pinhole().far) {
            return Ok(far);
        }
        let bounds = self.loaded.scene.bounds();
        let corners = bounds.corners();
        let straight = corners.iter().map(|&c| (c - view.pinhole().eye).dot(view.pinhole().forward));
        let bent = corners.iter().filter_map(|&c| view.project(c).ok()).map(|image| image.depth);
        let deepest = straight.chain(bent).fold(0.0, f64::max);
        if bounds.is_empty() || !(deepest > view.pinhole().near) {
            return Err(BelvedereError::NoRayEnd);
        }
        Ok(deepest)
    }

    /// Refuses views whose eye lies under the ground.
    ///
    /// # Errors
    /// [`BelvedereError::UnderGround`].
    pub fn check_drawable(&self) -> Result<(), BelvedereError> {
        if matches!(self.resolved.constructor, Some(ConstructorReport::PathPreview(_))) {
            // The eye of a path preview is fitted to the space around the path.
            return Ok(());
        }
        let eye = self.resolved.view.pinhole().eye;
        let moved = self.resolved.view.stages().iter().any(|s| s.moves_ground());
        // The ground that a strip carries under the eye; beside the strip there is no ground.
        let over = self.resolved.view.strip().map_or(Some(eye), |strip| strip.invert(eye).ok());
        let ground = over.and_then(|p| self.loaded.scene.terrain().and_then(|t| t.surface_at(p.truncate())));
        match ground {
            Some(ground_m) if eye.z < ground_m && !moved => Err(BelvedereError::UnderGround { eye_m: eye.z, ground_m }),
            _ => Ok(()),
        }
    }
}
