//! Arguments that all pictures and frames have in common.

use crate::kinds::RendererKind;
use crate::parse::parse_lod;
use belvedere::picture::THRESHOLDS;
use belvedere::request::parse::{samples, size};
use clap::{Args, ValueEnum};

/// How representations of styling sections are put together.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum CompositingKind {
    /// Mix colours where representations share a surface, use thresholds elsewhere; as layers where none share a surface
    Single,
    /// Show one representation per sample, by its threshold, in one drawing
    Dither,
    /// Draw each alone and mix the pictures, as published
    Layers,
}

/// How pictures and frames are drawn.
#[derive(Debug, Args)]
pub(crate) struct DrawArgs {
    /// Size in pixels instead of the scene's, such as 1920x1080
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Renderer
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) renderer: RendererKind,
    /// Draw without the bends
    #[arg(long)]
    pub(crate) straight: bool,
    /// Draw the straight picture beside the bent one
    #[arg(long, conflicts_with = "straight")]
    pub(crate) compare: bool,
    /// Coverage samples per pixel: 1, 4 or 16
    #[arg(long, default_value_t = 4, value_name = "N", allow_negative_numbers = true, value_parser = samples)]
    pub(crate) samples: u32,
    /// Thresholds per pixel in transitions between styling sections; 1 is a dither
    #[arg(long, default_value_t = THRESHOLDS, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) thresholds: u32,
    /// How representations of styling sections are composited
    #[arg(long, value_enum, default_value = "single")]
    pub(crate) compositing: CompositingKind,
    /// Draw dark edges and depth unsharp masking, whatever the scene says
    #[arg(long)]
    pub(crate) stylise: bool,
    /// Largest error of the terrain's level of detail, pixels; 0 draws every grid cell
    #[arg(long, default_value_t = 0.5, value_name = "PX", allow_hyphen_values = true, value_parser = parse_lod)]
    pub(crate) lod: f64,
}
