//! An opened scene: everything resolved, nothing left to look up.

use crate::BelvedereError;
use crate::resolve;
use crate::scene_file::paths::Roots;
use crate::scene_file::{self, Document, LayerDoc, PaletteDoc, PaletteName, SourceDocument, StageDoc};
use belvedere_core::View;
use belvedere_cpu::CpuRenderer;
use belvedere_disocclusion::{TerrainReport, TerrainSettings};
use belvedere_io::Limits;
use belvedere_scene::{Light, Progress, Scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What of a scene is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Needs {
    /// The view alone: of the layers only the terrain is read, and only if the camera or a stage stands on it.
    View,
    /// The view and the terrain.
    Ground,
    /// Every layer.
    #[default]
    Everything,
}

/// How to open a scene.
#[derive(Debug, Clone, Default)]
pub struct OpenOptions {
    /// Folders beside that of the scene from which files may come.
    pub allow_roots: Vec<PathBuf>,
    /// What is wanted.
    pub needs: Needs,
    /// Another size of the picture than the scene's, pixels.
    pub image: Option<[u32; 2]>,
    /// Another seed than the scene's for whatever is generated.
    pub seed: Option<u64>,
    /// Another tint of terrain than the scene's.
    pub palette: Option<PaletteDoc>,
    /// Leaves stages that a solver would have to make out of the view: for those who want the document alone.
    pub unsolved: bool,
    /// Memory that the samples of one file may take, bytes; `None` = what [`Limits::default`] says.
    pub max_bytes: Option<u64>,
    /// Progress and cancellation.
    pub progress: Progress,
}

impl OpenOptions {
    /// Limits for reading files.
    pub(crate) fn limits(&self) -> Limits {
        self.max_bytes.map_or_else(Limits::default, |max_bytes| Limits { max_bytes })
    }
}

/// An opened scene: layers, view and light, and what was odd on the way.
#[derive(Debug, Clone)]
pub struct Session {
    pub(crate) document: Document,
    pub(crate) path: PathBuf,
    pub(crate) source: SourceDocument,
    pub(crate) roots: Roots,
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) light: Light,
    pub(crate) terrain: Option<TerrainReport>,
    pub(crate) warnings: Vec<String>,
    pub(crate) inputs: Vec<PathBuf>,
    /// One for all frames: it remembers what does not depend on the view.
    pub(crate) rasteriser: Arc<CpuRenderer>,
}

impl Session {
    /// Opens a scene file.
    ///
    /// # Errors
    /// Every [`BelvedereError`]; mistakes in the file come with their line.
    pub fn open(path: &Path, options: &OpenOptions) -> Result<Self, BelvedereError> {
        Self::from_document(scene_file::read(path)?, options)
    }

    /// Opens a scene from its text (TOML, or JSON if it starts with `{`); `path` says where its files are.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn from_text(path: &Path, text: &str, options: &OpenOptions) -> Result<Self, BelvedereError> {
        Self::from_document(scene_file::parse(path, text)?, options)
    }

    fn from_document(mut source: SourceDocument, options: &OpenOptions) -> Result<Self, BelvedereError> {
        if let Some(image) = options.image {
            source.document.camera.image = image;
        }
        let mut allowed = options.allow_roots.clone();
        if let Some(palette) = &options.palette {
            let palette = located(palette, &mut allowed)?;
            for layer in &mut source.document.layer {
                if let LayerDoc::Terrain(terrain) = layer {
                    terrain.style.palette = palette.clone();
                }
            }
        }
        let scene_dir = source.path().parent().map(Path::to_owned).unwrap_or_default();
        let roots = Roots { scene_dir, allowed };
        resolve::session(source, &roots, options)
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

    /// What the solver of terrain disocclusion came to; `None` if none ran.
    pub fn terrain_report(&self) -> Option<&TerrainReport> {
        self.terrain.as_ref()
    }

    /// Parameters of terrain disocclusion as the scene file states them, else the usual ones.
    ///
    /// # Errors
    /// [`BelvedereError::Usage`] with the parameter that is out of range.
    pub fn terrain_settings(&self) -> Result<TerrainSettings, BelvedereError> {
        let stated = self.source.document.stage.iter().find_map(|stage| match stage {
            StageDoc::TerrainDisocclusion(doc) => Some(doc.clone()),
            _ => None,
        });
        let settings = resolve::terrain::settings(&stated.unwrap_or_default());
        settings.map_err(|(_, reason)| BelvedereError::Usage(reason))
    }

    /// What was odd: one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Files that were read, the scene first.
    pub fn inputs(&self) -> &[PathBuf] {
        &self.inputs
    }

    /// The scene file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The document with every default filled in and every place, name and rule replaced by its value; it opens to the same view.
    pub fn resolved(&self) -> &Document {
        &self.document
    }
}

/// The palette with the full path of its file, whose folder is allowed from now on.
pub(crate) fn located(palette: &PaletteDoc, allowed: &mut Vec<PathBuf>) -> Result<PaletteDoc, BelvedereError> {
    let PaletteDoc::File(name) = palette else { return Ok(palette.clone()) };
    let names = PaletteName::ALL.map(|(name, _)| name).join(", ");
    let path = Path::new(name).canonicalize().map_err(|e| BelvedereError::Path {
        name: name.clone(),
        reason: format!("is no palette ({names}) and no file of colours by height: {e}"),
    })?;
    allowed.extend(path.parent().map(Path::to_owned));
    let text = path.to_str().map(str::to_owned);
    let reason = || "is not UTF-8; rename it".to_owned();
    text.map(PaletteDoc::File).ok_or_else(|| BelvedereError::Path { name: name.clone(), reason: reason() })
}
