//! Memory of constructors and of the terrain solver.

use super::wall::WallReport;
use crate::scene_file::ConstructorDoc;
use belvedere_construct::centreline::CentrelineReport;
use belvedere_construct::rays::{PathPreview, ProbeMemory, TrackingMemory};
use belvedere_core::Warning;
use belvedere_disocclusion::TerrainMemory;
use belvedere_io::InputFile;
use belvedere_scene::Progress;

/// Memory of constructors and solvers between the frames of a film.
#[derive(Debug, Clone, Default)]
pub(crate) struct Memory {
    pub(crate) terrain: TerrainMemory,
    pub(crate) tracking: TrackingMemory,
    pub(crate) probe: ProbeMemory,
    /// The preview of the frame before.
    pub(crate) preview: Option<Prepared>,
}

impl Memory {
    /// The memory of a preview's path alone, which depends on the scene and the document.
    pub(crate) fn of_path(&self) -> Self {
        Self { preview: self.preview.clone(), ..Self::default() }
    }

    /// The same for a picture of another size: the preview keeps the camera that was fitted to the former size.
    pub(crate) fn of_path_sized(&self, image: [u32; 2]) -> Self {
        let mut memory = self.of_path();
        if let Some(prepared) = &mut memory.preview {
            prepared.made_from.1 = image;
        }
        memory
    }
}

/// A preview of the path of a document, with its inputs.
#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    pub(super) made_from: (ConstructorDoc, [u32; 2]),
    pub(super) file: Option<InputFile>,
    pub(super) centreline: Option<CentrelineReport>,
    pub(super) walls: Vec<WallReport>,
    pub(super) warnings: Vec<Warning>,
    pub(super) preview: PathPreview,
}

/// Inputs of solvers, besides the document.
pub(crate) struct Solving<'a> {
    pub(crate) memory: &'a mut Memory,
    /// Time between frames of a film, seconds.
    pub(crate) time_step_s: Option<f64>,
    pub(crate) progress: &'a Progress,
}
