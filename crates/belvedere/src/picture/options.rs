//! Options for drawing a picture.

use crate::print::Sheet;
use crate::scene_file::HighlightMark;
use crate::vectors::VectorContent;
use crate::{CameraPicture, Session};
use belvedere_cpu::ExactRenderer;
use belvedere_scene::{Progress, RenderOptions, Renderer, Stylisation};

/// Thresholds per pixel, over all its samples, for transitions between styling sections in pictures at rest.
pub const THRESHOLDS: u32 = 64;

/// Options for drawing a picture.
#[derive(Debug, Clone)]
pub struct PictureOptions {
    /// Samples, level of detail, threads and memory; by default with [`THRESHOLDS`].
    pub quality: RenderOptions,
    /// Draws the view without bends.
    pub straight: bool,
    /// Draws the straight picture beside the bent one.
    pub compare: bool,
    /// Buffers to write beside the picture.
    pub aux: Vec<AuxBuffer>,
    /// Format of the buffers.
    pub aux_format: AuxFormat,
    /// Renderer that draws the picture.
    pub renderer: RendererChoice,
    /// Stylisation instead of the scene's.
    pub stylisation: Option<Stylisation>,
    /// Grid on the ground instead of the scene's: spacing in scene units, or `Some(None)` for an automatic one.
    pub grid: Option<Option<f64>>,
    /// Draws the heat map of displacements, even if the scene does not ask for it.
    pub heatmap: bool,
    /// Draws the straight picture faintly over the bent one, even if the scene does not ask for it.
    pub ghost: bool,
    /// Highlights of the bend instead of the scene's; empty: those of the scene.
    pub highlight: Vec<HighlightMark>,
    /// Draws no mark on bent pictures, even if the scene does not ask for that.
    pub no_mark: bool,
    /// Draws the mark without figures and also where nothing is bent, as frames of a film do.
    pub steady_mark: bool,
    /// Draws a picture of the camera instead of the picture that it takes.
    pub camera: Option<CameraPicture>,
    /// Widths of lines and marks and heights of names, in multiples of those that the scene states: pixels per point of a
    /// screen. 1 for pictures that are written without a paper.
    pub density: f64,
    /// The picture's place on paper; its files say so. See [`PictureOptions::on`].
    pub print: Option<Sheet>,
    /// Lines, areas, points, names and legends that become shapes instead of pixels, see [`Picture::vectors`](super::Picture::vectors).
    pub vectors: VectorContent,
    /// Rows that [`Session::render_to`] draws at a time, rounded up to a multiple of 16; 0 = all in one piece. `None` = it depends on size
    /// and memory.
    pub band_rows: Option<usize>,
    /// Progress and cancellation.
    pub progress: Progress,
}

impl PictureOptions {
    /// The same picture on paper: lengths that the scene states in pixels are 1/96 inch each.
    pub fn on(self, sheet: Sheet) -> Self {
        Self { density: sheet.density(), print: Some(sheet), ..self }
    }
}

impl Default for PictureOptions {
    fn default() -> Self {
        let quality = RenderOptions { max_bytes: belvedere_io::budget::bytes(), ..RenderOptions::default() };
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
            steady_mark: false,
            camera: None,
            density: 1.0,
            print: None,
            vectors: VectorContent::Nothing,
            band_rows: None,
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

/// Choice of the renderer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RendererChoice {
    /// The rasteriser.
    #[default]
    Cpu,
    /// The exact tracer of curved rays: slower, without subdivision.
    Exact,
}

impl RendererChoice {
    /// The renderer; the rasteriser is the session's own, with its caches.
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
