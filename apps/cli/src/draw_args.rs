//! Arguments that all pictures and frames have in common.

use crate::kinds::RendererKind;
use crate::parse::{parse_lod, parse_size};
use belvedere::picture::THRESHOLDS;
use clap::{Args, ValueEnum};

/// How representations of styling sections are put together.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum CompositingKind {
    /// Mixed where they are one surface in different colours, elsewhere as by thresholds; as layers where no two are one surface
    Single,
    /// Each sample shows one of them, by its threshold: one drawing
    Dither,
    /// Each is drawn alone and the pictures are mixed, as published
    Layers,
}

/// How pictures and frames are drawn.
#[derive(Debug, Args)]
pub(crate) struct DrawArgs {
    /// Size in pixels instead of the scene's, such as 1920x1080
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = parse_size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Renderer
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) renderer: RendererKind,
    /// Without the bends
    #[arg(long)]
    pub(crate) straight: bool,
    /// Straight beside bent
    #[arg(long, conflicts_with = "straight")]
    pub(crate) compare: bool,
    /// Coverage samples per pixel: 1, 4 or 16
    #[arg(long, default_value_t = 4, value_name = "N")]
    pub(crate) samples: u32,
    /// Thresholds per pixel where styling sections pass into each other; 1 is a dither
    #[arg(long, default_value_t = THRESHOLDS, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) thresholds: u32,
    /// How representations of styling sections are put together
    #[arg(long, value_enum, default_value = "single")]
    pub(crate) compositing: CompositingKind,
    /// Dark edges and shade behind what stands out, whatever the scene says
    #[arg(long)]
    pub(crate) stylise: bool,
    /// Largest error of terrain drawn in less detail far away, pixels; 0 draws every cell
    #[arg(long, default_value_t = 0.5, value_name = "PX", allow_hyphen_values = true, value_parser = parse_lod)]
    pub(crate) lod: f64,
}
