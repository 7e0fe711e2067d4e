//! Memory of constructors and of the terrain solver.

use super::wall::WallReport;
use belvedere_construct::centreline::CentrelineReport;
use belvedere_construct::rays::{PathPreview, ProbeMemory, TrackingMemory};
use belvedere_core::Warning;
use belvedere_disocclusion::TerrainMemory;
use belvedere_document::ConstructorDoc;
use belvedere_io::InputFile;
use belvedere_scene::Progress;

/// Memory of constructors and solvers between the frames of a film.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    /// Of terrain disocclusion.
    pub terrain: TerrainMemory,
    /// Of target tracking.
    pub tracking: TrackingMemory,
    /// Of probes.
    pub probe: ProbeMemory,
    /// The preview of the frame before.
    pub preview: Option<Prepared>,
}

impl Memory {
    /// The memory of a preview's path alone, which depends on the scene and the document.
    pub fn of_path(&self) -> Self {
        Self { preview: self.preview.clone(), ..Self::default() }
    }

    /// The same for a picture of another size: the preview keeps the camera that was fitted to the former size.
    pub fn of_path_sized(&self, image: [u32; 2]) -> Self {
        let mut memory = self.of_path();
        if let Some(prepared) = &mut memory.preview {
            prepared.made_from.1 = image;
        }
        memory
    }
}

/// A preview of the path of a document, with its inputs.
#[derive(Debug, Clone)]
pub struct Prepared {
    pub(super) made_from: (ConstructorDoc, [u32; 2]),
    pub(super) file: Option<InputFile>,
    pub(super) centreline: Option<CentrelineReport>,
    pub(super) walls: Vec<WallReport>,
    pub(super) warnings: Vec<Warning>,
    pub(super) preview: PathPreview,
}

/// Inputs of solvers, besides the document.
pub struct Solving<'a> {
    /// Memory of the frame before.
    pub memory: &'a mut Memory,
    /// Time between frames of a film, seconds.
    pub time_step_s: Option<f64>,
    /// Progress and cancellation.
    pub progress: &'a Progress,
}
