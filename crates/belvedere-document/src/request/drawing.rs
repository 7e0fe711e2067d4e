//! How pictures and frames are drawn.

#[cfg(feature = "clap")]
use super::args::one_of;
#[cfg(feature = "clap")]
use super::value;
use crate::StylisationDoc;
use crate::renderer::RendererName;
use belvedere_scene::Compositing;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How pictures and frames are drawn.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Drawing {
    /// Size in pixels instead of the scene's, such as 1920x1080
    #[cfg_attr(feature = "clap", arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = value::size))]
    pub size: Option<[u32; 2]>,
    /// Renderer: auto (the scene's, else the fastest that there is), cpu (the rasteriser on the processor), exact (the tracer along the curved
    /// ray of every sample: slow, without subdivision error, the reference), or one that the program registers
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", default_value_t))]
    pub renderer: RendererName,
    /// Draw without the bends
    #[cfg_attr(feature = "clap", arg(long))]
    pub straight: bool,
    /// Draw the straight picture beside the bent one
    #[cfg_attr(feature = "clap", arg(long, conflicts_with = "straight"))]
    pub compare: bool,
    /// Coverage samples per pixel: 1, 4 or 16; 4 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", allow_negative_numbers = true, value_parser = value::samples))]
    pub samples: Option<u32>,
    /// Thresholds per pixel in transitions between styling sections, 1 to 4096; 64 by default, 1 is a dither
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=4096)))]
    pub thresholds: Option<u32>,
    /// How representations of styling sections are composited; single by default
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<Compositing>(), value_name = "KIND"))]
    pub compositing: Option<Compositing>,
    /// Draw dark edges and depth unsharp masking instead of what the scene says, of strengths in 0..=1 and 0..=10; 0.7,4 without a value
    #[cfg_attr(feature = "clap", arg(long, value_name = "EDGES[,UNSHARP]", num_args = 0..=1, require_equals = true, default_missing_value = "0.7,4", value_parser = value::stylise))]
    pub stylise: Option<StylisationDoc>,
    /// Largest error of the terrain's level of detail, pixels, 0 to 64; 0.5 by default, 0 draws every grid cell
    #[cfg_attr(feature = "clap", arg(long, value_name = "PX", allow_hyphen_values = true, value_parser = value::lod))]
    pub lod: Option<f64>,
}
