//! Options that Python gives as JSON.

use crate::errors::{raised, wrong};
use belvedere::picture::{AuxBuffer, PictureOptions, RendererChoice};
use belvedere::places::Place;
use belvedere::print::Sheet;
use belvedere::request::OfData;
use belvedere::scene::{Compositing, Progress};
use belvedere::scene_file::{FurnitureItem, FurnitureWish, HighlightMark, PrintDoc, StylisationDoc};
use belvedere::vectors::VectorContent;
use belvedere::{CameraPicture, OpenOptions};
use pyo3::PyResult;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// Options from their JSON text.
pub(crate) fn read<T: DeserializeOwned>(what: &str, text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|e| {
        let said = e.to_string();
        // Python gave no text, so that it has no lines.
        let words = said.rsplit_once(" at line ").map_or(said.as_str(), |(words, _)| words);
        wrong(&format!("{what}: {words}"))
    })
}

/// A place as Python gives it.
pub(crate) fn place(what: &str, text: &str) -> PyResult<Place> {
    text.parse().map_err(|e: String| wrong(&format!("{what}: {e}")))
}

/// Eye and target: both or neither.
pub(crate) fn places(eye: Option<&str>, look: Option<&str>) -> PyResult<Option<[Place; 2]>> {
    match (eye, look) {
        (None, None) => Ok(None),
        (Some(eye), Some(look)) => Ok(Some([place("eye", eye)?, place("look_at", look)?])),
        _ => Err(wrong("eye and look_at belong together; give both, or neither")),
    }
}

/// How a scene is opened.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Opening {
    allow_roots: Vec<PathBuf>,
    size: Option<[u32; 2]>,
    seed: Option<u64>,
    fonts: Vec<PathBuf>,
    /// What data without a scene file do not say.
    pub(crate) data: OfData,
    unsolved: bool,
}

impl Opening {
    /// The options of the facade.
    pub(crate) fn options(self, progress: Progress) -> OpenOptions {
        OpenOptions {
            allow_roots: self.allow_roots,
            image: self.size,
            seed: self.seed,
            fonts: self.fonts,
            unsolved: self.unsolved,
            max_bytes: Some(belvedere::io::budget::bytes()),
            progress,
            ..OpenOptions::default()
        }
    }
}

/// Renderers by name.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RendererName {
    #[default]
    Auto,
    Cpu,
    Exact,
}

impl From<RendererName> for RendererChoice {
    fn from(name: RendererName) -> Self {
        match name {
            RendererName::Auto | RendererName::Cpu => Self::Cpu,
            RendererName::Exact => Self::Exact,
        }
    }
}

/// How a picture is drawn.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Drawing {
    straight: bool,
    compare: bool,
    renderer: RendererName,
    samples: Option<u32>,
    lod_px: Option<f64>,
    thresholds: Option<u32>,
    compositing: Compositing,
    stylise: Option<StylisationDoc>,
    /// Spacing, scene units; 0 = automatic.
    grid: Option<f64>,
    heatmap: bool,
    ghost: bool,
    highlight: Vec<HighlightMark>,
    no_mark: bool,
    furniture: Option<Vec<String>>,
    title: Option<String>,
    overhead: bool,
    outside: Option<[[f64; 3]; 2]>,
    from_outside: bool,
    buffers: bool,
    vectors: Vectors,
    /// The whole paper, as [`Sheet::document`] tells it.
    print: PrintDoc,
}

/// Marks that are drawn as vectors.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Vectors {
    #[default]
    Nothing,
    OverRaster,
    Alone,
}

impl From<Vectors> for VectorContent {
    fn from(vectors: Vectors) -> Self {
        match vectors {
            Vectors::Nothing => Self::Nothing,
            Vectors::OverRaster => Self::OverRaster,
            Vectors::Alone => Self::Alone,
        }
    }
}

/// All buffers beside a picture but displacements.
pub(crate) const BUFFERS: [AuxBuffer; 3] = [AuxBuffer::Depth, AuxBuffer::Id, AuxBuffer::World];

/// Furniture by its names: see `FurnitureItem::listed`.
pub(crate) fn furniture(names: Option<&[String]>, title: Option<&str>) -> PyResult<FurnitureWish> {
    let items = names.map(|names| FurnitureItem::listed(names.iter().map(String::as_str))).transpose();
    let items = items.map_err(|reason| wrong(&format!("furniture: {reason}")))?;
    Ok(FurnitureWish { items, title: title.map(str::to_owned) })
}

impl Drawing {
    /// The furniture that is asked for.
    pub(crate) fn furniture(&self) -> PyResult<FurnitureWish> {
        furniture(self.furniture.as_deref(), self.title.as_deref())
    }

    /// The options of the facade.
    pub(crate) fn options(&self, progress: Progress) -> PyResult<PictureOptions> {
        let mut options = PictureOptions {
            straight: self.straight,
            compare: self.compare,
            renderer: self.renderer.into(),
            grid: self.grid.map(|spacing| (spacing > 0.0).then_some(spacing)),
            heatmap: self.heatmap,
            ghost: self.ghost,
            highlight: self.highlight.clone(),
            no_mark: self.no_mark,
            vectors: self.vectors.into(),
            progress,
            ..PictureOptions::default()
        };
        let thresholds = self.thresholds.unwrap_or(belvedere::picture::THRESHOLDS);
        options.quality.samples = self.samples.unwrap_or(options.quality.samples);
        options.quality.lod_px = self.lod_px.unwrap_or(options.quality.lod_px);
        options.quality.exposures = thresholds.div_ceil(options.quality.samples.max(1));
        options.quality.compositing = self.compositing;
        options.quality.max_bytes = belvedere::io::budget::bytes();
        if let Some(stylise) = &self.stylise {
            options.stylisation = Some(stylise.strengths().map_err(|(_, reason)| wrong(&reason))?);
        }
        options.camera = match (self.overhead, self.from_outside) {
            (true, true) => return Err(wrong("camera: overhead and outside are two pictures; give one of them")),
            (true, false) => Some(CameraPicture::Overhead),
            (false, true) => Some(CameraPicture::Outside(self.outside)),
            (false, false) => None,
        };
        if self.buffers {
            options.aux = BUFFERS.to_vec();
        }
        // With paper and pixels per inch no size is left open.
        match Sheet::of(&self.print, None, [1, 1]).map_err(|e| raised(&e))? {
            Some(sheet) => Ok(options.on(sheet)),
            None => Ok(options),
        }
    }
}
