//! Pictures: options, jobs, results and the trait of renderers.

use crate::{Cancelled, Light, Overlay, PlacedName, Progress, Scene};
use belvedere_core::{DVec2, View};
use std::ops::Range;
use std::sync::Arc;

/// Buffers wanted beside colour, depth and id.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Aux {
    /// True (undisplaced) world position per pixel.
    pub world: bool,
    /// Depth, and the world position if wanted, of the very centre of each pixel by the true map, to 1e-4 of the depth where the surface is
    /// smooth; else as exact as [`RenderOptions::tolerance_px`] makes them, which at grazing ground is less.
    pub exact: bool,
}

/// How to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// Coverage samples per pixel for anti-aliasing: 1, 4 or 16.
    pub samples: u32,
    /// Worst error of the bent image by straight edges, pixels.
    pub tolerance_px: f64,
    /// Worst error of terrain drawn in less detail far away, pixels; 0 draws every cell. Renderers of single rays need none.
    pub lod_px: f64,
    /// Worker threads; 0 = all cores. The picture does not depend on it.
    pub threads: usize,
    /// Extra buffers.
    pub aux: Aux,
    /// Stylisation of the surfaces, before marks are drawn.
    pub stylisation: Stylisation,
    /// Marks that belong to no layer.
    pub overlay: Overlay,
    /// Exposures of each sample, with different thresholds, where representations of styling sections blend, >= 1; 1 = an ordered
    /// dither.
    pub exposures: u32,
    /// How representations of styling sections are put together.
    pub compositing: Compositing,
    /// Draws one representation only, by its number among those of the view's sections, wherever it has a weight; `None` = all.
    pub representation: Option<usize>,
    /// Whether lines, outlines, points and names are drawn, those of the overlay too; else surfaces alone.
    pub marks: bool,
    /// Pixels per unit of the lengths of marks that styles do not state: rims, gaps, leaders, > 0. Widths and heights that styles state are
    /// pixels.
    pub density: f64,
    /// Rectangles of the picture in which no name is written, such as those of legends: upper left and lower right corner, pixels.
    pub keep_clear: Vec<[DVec2; 2]>,
    /// The names of a frame of a film, in the order in which they find room, and no others; a name whose place is taken stands, after
    /// all others, at the best free one. `None`: all names that find room, each at its best place.
    pub names: Option<Arc<[PlacedName]>>,
    /// Memory the renderer may use for one picture, bytes; more is [`RenderError::TooLarge`].
    pub max_bytes: u64,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            samples: 4,
            tolerance_px: 0.5,
            lod_px: 0.5,
            threads: 0,
            aux: Aux::default(),
            stylisation: Stylisation::default(),
            overlay: Overlay::default(),
            exposures: 1,
            compositing: Compositing::default(),
            representation: None,
            marks: true,
            density: 1.0,
            keep_clear: Vec::new(),
            names: None,
            max_bytes: 4 << 30,
        }
    }
}

/// Stylisation of the surfaces of a picture, computed from their depths; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stylisation {
    /// Strength of dark edges where depth or faces break, 0..=1.
    pub edges: f32,
    /// Strength of the shade behind surfaces that stand out (depth unsharp masking), 0..=10; 3 to 6 are usual.
    pub unsharp: f32,
}

/// How representations of styling sections are put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Compositing {
    /// Where they are one surface in different colours it is drawn once and the colours are mixed, and what else there is by thresholds; where
    /// no two share a surface each is drawn alone and the pictures are mixed.
    #[default]
    Single,
    /// Each sample shows one of them, by its threshold: one drawing, no memory beside the picture's.
    Dither,
    /// Each is drawn alone and the pictures are mixed: as many drawings and pictures as there are representations.
    Layers,
}

impl FrameStats {
    /// Sum of the work of two drawings of one scene.
    pub fn and(&self, other: &Self) -> Self {
        Self {
            triangles_in: self.triangles_in.max(other.triangles_in),
            triangles_drawn: self.triangles_drawn + other.triangles_drawn,
            edges_split: self.edges_split + other.edges_split,
            vertices_missed: self.vertices_missed + other.vertices_missed,
            samples: self.samples + other.samples,
            layer_bytes: self.layer_bytes + other.layer_bytes,
            symbols_left_out: self.symbols_left_out + other.symbols_left_out,
            names_left_out: self.names_left_out + other.names_left_out,
            milliseconds: self.milliseconds + other.milliseconds,
        }
    }
}

/// Everything a renderer needs for one picture.
#[derive(Debug, Clone, Copy)]
pub struct RenderJob<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The view.
    pub view: &'a View,
    /// The sun.
    pub light: &'a Light,
    /// Options of the picture.
    pub options: &'a RenderOptions,
    /// Progress and cancellation.
    pub progress: &'a Progress,
}

/// Counts and times of one picture.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct FrameStats {
    /// Triangles handed in.
    pub triangles_in: u64,
    /// Triangles drawn, after subdivision and clipping.
    pub triangles_drawn: u64,
    /// Edges split because their bent image would be more than the tolerance off.
    pub edges_split: u64,
    /// Vertices without an image (behind the eye or outside the domain).
    pub vertices_missed: u64,
    /// Samples of volumes taken.
    pub samples: u64,
    /// Bytes of the pictures of single representations, see [`Compositing::Layers`].
    pub layer_bytes: u64,
    /// Symbols of points that were left out, because they would overlap one that counts more.
    pub symbols_left_out: u64,
    /// Names that found no room.
    pub names_left_out: u64,
    /// Wall time in milliseconds.
    pub milliseconds: f64,
}

/// A finished picture. Row-major, row 0 on top.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Opaque sRGB colour.
    pub color: Vec<[u8; 3]>,
    /// Depth at the pixel centre, scene units; infinite where there is only sky. Surfaces only: lines and points do not change it.
    pub depth: Vec<f32>,
    /// Layer seen at the pixel centre: 0 = sky, else 1 + index of the layer (lines, outlines and points where they are visible, not where
    /// they shine through).
    pub id: Vec<u32>,
    /// True world position of the surface at the pixel centre (NaN where sky), if asked for.
    pub world: Option<Vec<[f64; 3]>>,
    /// Counts and times.
    pub stats: FrameStats,
}

/// Errors of a renderer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// Cancelled through [`Progress`].
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Too large for the memory budget.
    #[error(
        "picture of {width} x {height} pixels at {samples} samples needs about {needed_mib} MiB, more than {limit_mib} MiB; use a smaller picture, fewer samples, or more memory"
    )]
    TooLarge {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Coverage samples per pixel.
        samples: u32,
        /// Memory needed, MiB.
        needed_mib: u64,
        /// Memory allowed, MiB.
        limit_mib: u64,
    },
    /// A picture that is drawn in one piece alone.
    #[error("the picture must be drawn in one piece because of {what}; leave that out to draw it in bands")]
    WholeOnly {
        /// What needs one piece.
        what: &'static str,
    },
    /// A number of coverage samples that no renderer offers.
    #[error("{samples} coverage samples per pixel were asked for; use 1, 4 or 16")]
    Samples {
        /// Samples asked for.
        samples: u32,
    },
}

/// Pixels of a picture at equal distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelGrid {
    /// Column and row of the first.
    pub first: [usize; 2],
    /// Distance of neighbours, pixels, at least 1.
    pub step: usize,
    /// Number across and down.
    pub count: [usize; 2],
}

impl PixelGrid {
    /// Every `step`th column and row of a picture, from column and row `from` on.
    pub fn over(size: [usize; 2], from: usize, step: usize) -> Self {
        Self { first: [from; 2], step, count: size.map(|n| n.saturating_sub(from).div_ceil(step)) }
    }

    /// Column and row of a pixel by its number.
    pub fn pixel(&self, i: usize) -> [usize; 2] {
        let across = self.count[0].max(1);
        [self.first[0] + self.step * (i % across), self.first[1] + self.step * (i / across)]
    }
}

/// A picture whose surfaces are prepared, drawn some rows at a time. Every pixel is that of the picture drawn in one piece.
pub trait PictureRows {
    /// Width and height of the picture, pixels.
    fn size(&self) -> [usize; 2];
    /// Counts of the picture, as in one piece.
    fn stats(&self) -> FrameStats;
    /// Depths of some pixels, before they are drawn.
    ///
    /// * `points`: whether layers and world points are wanted as well; the job must ask for [`Aux::world`].
    ///
    /// # Errors
    /// [`RenderError::Cancelled`].
    fn look(&self, grid: &PixelGrid, points: bool) -> Result<Frame, RenderError>;
    /// Draws rows into the memory of earlier ones.
    ///
    /// * `rows`: the first one a multiple of [`ROWS`].
    ///
    /// # Errors
    /// [`RenderError::Cancelled`].
    fn draw(&self, rows: Range<usize>, frame: &mut Frame) -> Result<(), RenderError>;
}

/// Rows are drawn in multiples of so many.
pub const ROWS: usize = 16;

/// Makes pictures. The result depends on the job alone, not on threads or time.
pub trait Renderer {
    /// Name for reports: `cpu`, `gpu`, `exact`.
    fn name(&self) -> &'static str;
    /// Draws one picture.
    fn render(&self, job: &RenderJob<'_>) -> Result<Frame, RenderError>;
    /// Draws one picture into the memory of an earlier frame, whose content is lost, also after an error.
    fn render_into(&self, job: &RenderJob<'_>, frame: &mut Frame) -> Result<(), RenderError> {
        *frame = self.render(job)?;
        Ok(())
    }
    /// What keeps the renderer from drawing a job some rows at a time; `None` where nothing does.
    fn whole_only(&self, _: &RenderJob<'_>) -> Option<&'static str> {
        Some("this renderer")
    }
    /// Memory that a picture takes, bytes.
    ///
    /// * `rows`: rows that are drawn at a time; `None`: all of them.
    fn bytes_for(&self, _: &RenderJob<'_>, _: Option<usize>) -> u64 {
        0
    }
    /// Prepares a picture, and lets `work` draw it some rows at a time.
    ///
    /// # Errors
    /// [`RenderError::WholeOnly`] where [`Renderer::whole_only`] says so; those of [`Renderer::render`]; those of `work`.
    fn in_rows(
        &self,
        job: &RenderJob<'_>,
        _: &mut dyn FnMut(&dyn PictureRows) -> Result<(), RenderError>,
    ) -> Result<(), RenderError> {
        Err(RenderError::WholeOnly { what: self.whole_only(job).unwrap_or("this renderer") })
    }
}
