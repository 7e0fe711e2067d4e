//! What to draw, and how well.

use crate::scene_file::HighlightMark;
use crate::{CameraPicture, Session};
use belvedere_cpu::ExactRenderer;
use belvedere_scene::{Progress, RenderOptions, Renderer, Stylisation};

/// Thresholds of a pixel, all its samples together, where representations of styling sections pass into each other in pictures at rest.
pub const THRESHOLDS: u32 = 64;

/// What to draw, and how well.
#[derive(Debug, Clone)]
pub struct PictureOptions {
    /// Samples, level of detail, threads and memory; by default with [`THRESHOLDS`].
    pub quality: RenderOptions,
    /// Without the bends.
    pub straight: bool,
    /// Straight beside bent.
    pub compare: bool,
    /// Buffers to write beside the picture.
    pub aux: Vec<AuxBuffer>,
    /// Format of the buffers.
    pub aux_format: AuxFormat,
    /// Who draws.
    pub renderer: RendererChoice,
    /// Edges and shades, whatever the scene says.
    pub stylisation: Option<Stylisation>,
    /// Grid on the ground, whatever the scene says: spacing in scene units, or `Some(None)` for a round one.
    pub grid: Option<Option<f64>>,
    /// Colours for how far the bend moves what is seen, also if the scene does not ask for them.
    pub heatmap: bool,
    /// The straight picture faintly over the bent one, also if the scene does not ask for it.
    pub ghost: bool,
    /// What shows what the bend did, instead of what the scene asks for; empty = as the scene says.
    pub highlight: Vec<HighlightMark>,
    /// No mark on bent pictures, also if the scene does not say so.
    pub no_mark: bool,
    /// A picture of the camera instead of one by it.
    pub camera: Option<CameraPicture>,
    /// Progress and cancellation.
    pub progress: Progress,
}

impl Default for PictureOptions {
    fn default() -> Self {
        let quality = RenderOptions::default();
        Self {
            quality: RenderOptions { exposures: THRESHOLDS.div_ceil(quality.samples), ..quality },
            straight: false,
            compare: false,
            aux: Vec::new(),
            aux_format: AuxFormat::default(),
            renderer: RendererChoice::default(),
            stylisation: None,
            grid: None,
            heatmap: false,
            ghost: false,
            highlight: Vec::new(),
            no_mark: false,
            camera: None,
            progress: Progress::default(),
        }
    }
}

/// Format of buffers beside a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AuxFormat {
    /// One NPY file per buffer, `OUT.NAME.npy`.
    #[default]
    Npy,
    /// One OpenEXR file of all buffers, `OUT.exr`.
    Exr,
}

/// Who draws.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RendererChoice {
    /// The rasteriser.
    #[default]
    Cpu,
    /// The tracer of curved rays: slower, without subdivision.
    Exact,
}

impl RendererChoice {
    /// The renderer itself; the rasteriser is that of the session, with what it remembers.
    pub fn of(self, session: &Session) -> &dyn Renderer {
        match self {
            Self::Cpu => &*session.renderer,
            Self::Exact => &ExactRenderer,
        }
    }
}

/// A buffer beside the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AuxBuffer {
    /// Depth, f32, infinite where sky.
    Depth,
    /// 1 + index of the layer, u32, 0 where sky.
    Id,
    /// World position, 3 x f64, NaN where sky.
    World,
    /// Displaced minus world position, 3 x f64, NaN where sky.
    Displacement,
}

impl AuxBuffer {
    /// Name in options and file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Id => "id",
            Self::World => "world",
            Self::Displacement => "displacement",
        }
    }
}
