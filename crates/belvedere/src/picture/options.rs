//! Options for drawing a picture.

use crate::print::Sheet;
use crate::scene_file::HighlightMark;
use crate::scene_file::request::{AuxBuffer, AuxFormat};
use crate::vectors::VectorContent;
use crate::{CameraPicture, RendererName};
use belvedere_scene::{Progress, RenderOptions, Stylisation};

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
    pub renderer: RendererName,
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
    /// Rows that [`crate::Session::render_to`] draws at a time, rounded up to a multiple of 16; 0 = all in one piece. `None` = it depends on size
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
            renderer: RendererName::AUTO,
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
