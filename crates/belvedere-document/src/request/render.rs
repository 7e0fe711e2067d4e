//! `render`: a picture of a scene, or of data as they are.

#[cfg(feature = "clap")]
use super::args::one_of;
use super::{Air, Drawing, Molecules, OfData, Panorama, Paper, Straighten, value};
use crate::place::Place;
use crate::{HighlightMark, SurfaceDoc, SwitchOrLength};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// What makes no sense for pictures of the camera.
#[cfg(feature = "clap")]
const CAMERA_CONFLICTS: [&str; 7] = ["straight", "compare", "aux", "grid", "heatmap", "ghost", "highlight"];

/// A picture of a scene.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Render {
    /// Size, renderer, samples.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub drawing: Drawing,
    /// Paper of the picture.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub paper: Paper,
    /// Draw and write a PNG or TIFF N rows at a time, rounded up to a multiple of 16, in less memory; 0 draws it in one piece. By default
    /// pictures of more than 33 million pixels are drawn so, and those for which there is too little memory. The bytes are the same
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=65_535)))]
    pub band_rows: Option<u32>,
    /// Buffers to write beside the picture
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<AuxBuffer>(), value_delimiter = ',', value_name = "LIST"))]
    pub aux: Vec<AuxBuffer>,
    /// Format of the buffers; npy by default
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<AuxFormat>(), value_name = "FORMAT"))]
    pub aux_format: Option<AuxFormat>,
    /// Draw lines of the coordinate system on the ground, every M metres; by default at a round spacing
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", num_args = 0..=1, require_equals = true, default_missing_value = "true", value_parser = value::contours))]
    pub grid: Option<SwitchOrLength>,
    /// Colour the picture by how far the bend moves what it shows
    #[cfg_attr(feature = "clap", arg(long, conflicts_with = "straight"))]
    pub heatmap: bool,
    /// Draw the ridges and routes of the straight picture faintly over the bent one
    #[cfg_attr(feature = "clap", arg(long, conflicts_with = "straight"))]
    pub ghost: bool,
    /// Show what the bend did: shift = colours by how far points move in the picture, stages = a colour for each stage and turn where it
    /// moves most, revealed = the outline of what the straight picture hides, ghost-box = a box where a required feature would be in
    /// the straight picture, and a leader to it; without a list shift, revealed and ghost-box
    #[cfg_attr(feature = "clap", arg(long, value_delimiter = ',', value_name = "LIST", num_args = 0..=1, require_equals = true, default_missing_value = "shift,revealed,ghost-box", conflicts_with = "straight", value_parser = one_of::<HighlightMark>()))]
    pub highlight: Vec<HighlightMark>,
    /// Leave out the mark in the corner that says that the view is bent, and by how much
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_mark: bool,
    /// Draw the camera itself from above: rays, planes, viewpoints, curve
    #[cfg_attr(feature = "clap", arg(long, conflicts_with_all = CAMERA_CONFLICTS))]
    pub overhead: bool,
    /// Draw the camera itself from another eye: eye and point to look at, in scene coordinates or lon,lat, or auto
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z,X,Y,Z", allow_hyphen_values = true, conflicts_with_all = CAMERA_CONFLICTS, conflicts_with = "overhead"))]
    pub outside: Option<Outside>,
    /// Tint of the terrain instead of the scene's: a name, as of `reveal`, or a file of colours by height (GDAL text, GMT .cpt)
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME|FILE"))]
    pub palette: Option<String>,
    /// Sky, haze and furniture.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub air: Air,
    /// Molecules.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub molecules: Molecules,
    /// A panorama from a place.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub panorama: Panorama,
    /// A line that is straightened.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub straighten: Straighten,
    /// Draw the sea as ordinary ground
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_sea: bool,
    /// Style of the areas of all layers, instead of the scene's; auto = the one that properties and names give
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<SurfaceDoc>(), value_name = "STYLE"))]
    pub area_style: Option<SurfaceDoc>,
    /// What data without a scene file do not say.
    #[cfg_attr(feature = "clap", command(flatten, next_help_heading = "Data without a scene file"))]
    #[serde(flatten)]
    pub data: OfData,
}

/// A buffer beside a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AuxBuffer {
    /// Forward distance of the displaced surface, f32; infinite where sky
    Depth,
    /// 1 + index of the layer, u32; 0 where sky
    Id,
    /// World position, 3 x f64; NaN where sky
    World,
    /// Displaced minus world position, 3 x f64; NaN where sky
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

/// Format of buffers beside a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AuxFormat {
    /// One NumPy array per buffer, OUT.NAME.npy
    #[default]
    Npy,
    /// One OpenEXR of all buffers, OUT.exr; 32-bit, world positions relative to the attribute worldOrigin
    Exr,
}

/// Eye and target of a picture of the camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "true, or eye and target was expected")]
pub enum Outside {
    /// `true`: chosen automatically.
    Auto(bool),
    /// Eye and target, each with a height.
    From([Place; 2]),
}

impl Outside {
    /// Whether a picture is asked for.
    pub fn is_asked(&self) -> bool {
        *self != Self::Auto(false)
    }
}

impl FromStr for Outside {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.trim() == "auto" {
            return Ok(Self::Auto(true));
        }
        let at = text.match_indices(',').nth(2).map(|(at, _)| at);
        let (eye, target) = at.map(|at| (&text[..at], &text[at + 1..])).unwrap_or((text, ""));
        match [eye, target].map(value::with_height) {
            [Ok(eye), Ok(target)] => Ok(Self::From([eye, target])),
            _ => Err("give auto, or eye and target as X,Y,Z,X,Y,Z".into()),
        }
    }
}
