//! How a scene is opened.

use crate::scene_file::{PaletteDoc, SurfaceDoc};
use belvedere_io::Limits;
use belvedere_scene::Progress;
use std::path::PathBuf;

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
    /// Whether the sea is drawn as such, whatever the scene says.
    pub sea: Option<bool>,
    /// What the areas of all layers are drawn as, whatever scene and files say; `Some(Auto)` = what the files say.
    pub area_style: Option<SurfaceDoc>,
    /// Leaves stages that a solver would have to make out of the view: for callers that need the document alone.
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
