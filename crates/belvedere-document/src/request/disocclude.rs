//! `disocclude`: an elevation model on which features are visible from an eye.

use super::Stated;
#[cfg(feature = "clap")]
use super::{args::one_of, value};
use crate::place::Place;
use crate::{SolverMode, SurfaceDoc};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Terrain, features and an eye.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Disocclude {
    /// Elevation model: GeoTIFF, .hgt, ESRI ASCII
    #[cfg_attr(feature = "clap", arg(value_name = "DEM"))]
    pub data: String,
    /// Routes, areas or points: GPX, KML, TCX, GeoJSON, shapefiles, GeoPackages, FlatGeobuf, CSV; - = standard input
    #[cfg_attr(feature = "clap", arg(required = true))]
    pub features: Vec<String>,
    /// Rivers that do not run uphill on the displaced ground: a file of lines, GPX, GeoJSON, shapefile; may be given several times
    #[cfg_attr(feature = "clap", arg(long, value_name = "FILE"))]
    pub rivers: Vec<String>,
    /// Eye: x,y in the system of the elevation model, lon,lat in degrees, or 46.5N,11.3E; and height in metres over its datum, or +20
    /// for 20 m above the ground
    #[cfg_attr(feature = "clap", arg(long, required = true, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = value::with_height))]
    pub eye: Option<Place>,
    /// Point to look at, written as the eye, without a height
    #[cfg_attr(feature = "clap", arg(long, required = true, value_name = "X,Y", allow_hyphen_values = true, value_parser = value::position))]
    pub look: Option<Place>,
    /// Full horizontal field of view, degrees; 70 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = value::number))]
    pub fov: Option<f64>,
    /// Passes of the solver; qp, which guarantees visibility, by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "MODE", value_parser = one_of::<SolverMode>()))]
    pub mode: Option<SolverMode>,
    /// Lift the limits of plausible ground: no lower than a fifth of the relief below the lowest point, no steeper than twice the 99.9th
    /// percentile of the terrain's slopes
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_limits: bool,
    /// Share of the features in view to show, such as 0.95 or 95%: the dearest stretches beyond it are given up, and less ground moves; 100%
    /// shows all, whatever it costs (default: all that leaves the landscape like itself)
    #[cfg_attr(feature = "clap", arg(long, value_name = "SHARE", allow_negative_numbers = true, value_parser = value::share))]
    pub show: Option<f64>,
    /// Most the ground may move, metres: the dearest stretches of the features are given up until it moves no more
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", allow_negative_numbers = true, value_parser = value::number))]
    pub move_at_most: Option<f64>,
    /// Any other key of a terrain_disocclusion stage, such as w=0.6; may be given several times
    #[cfg_attr(feature = "clap", arg(long, value_name = "KEY=VALUE"))]
    pub set: Vec<String>,
    /// Grid of the written heights; input by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "GRID", value_parser = one_of::<WrittenGrid>()))]
    pub grid: Option<WrittenGrid>,
    /// Show what is in view to programs that cut the cells of the heights from north-east to south-west as well: auto, the default, if the
    /// ground moves by less than 1.3 times as much, always or never; without a value always
    #[cfg_attr(feature = "clap", arg(long, value_name = "WHEN", num_args = 0..=1, require_equals = true, default_missing_value = "always", value_parser = one_of::<Robust>()))]
    pub robust: Option<Robust>,
    /// Fill all holes of the elevation model, also in the written heights, instead of leaving them open
    #[cfg_attr(feature = "clap", arg(long))]
    pub fill_voids: bool,
    /// Style of areas in the picture, instead of the one that their properties and names give
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<SurfaceDoc>(), value_name = "STYLE"))]
    pub area_style: Option<SurfaceDoc>,
    /// Lower the ground with the distance, as on a sphere, with refraction
    #[cfg_attr(feature = "clap", arg(long))]
    pub curved_earth: bool,
    /// Coordinate system to solve in: auto, EPSG:n or local
    #[cfg_attr(feature = "clap", arg(long, value_name = "CRS"))]
    pub crs: Option<String>,
    /// What the files do not say.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub stated: Stated,
}

impl Disocclude {
    /// Full horizontal field of view where none is asked for, degrees.
    pub const FOV_X_DEG: f64 = 70.0;
}

/// When what is in view must be seen whichever way a program cuts the cells of the heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Robust {
    /// If the ground moves by less than 1.3 times as much.
    #[default]
    Auto,
    /// However much it moves.
    Always,
    /// Never: only as this program cuts them, from north-west to south-east.
    Never,
}

/// Grid of the written heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WrittenGrid {
    /// The grid of the input, in its coordinate system. Heights are resampled if the solver's grid is another one.
    #[default]
    Input,
    /// The solver's grid, in metres: guarantees hold at every node.
    Scene,
}
