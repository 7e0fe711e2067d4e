//! Requests of few options: `measure`, `generalise`, `export`.

use super::{OfData, RendererName};
#[cfg(feature = "clap")]
use super::{args::one_of, value};
use belvedere_scene::city::Keep;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Visible shares of what a scene requires.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Measure {
    /// Largest distance between samples of a line, metres; by default an eighth of the cell of the terrain
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", allow_negative_numbers = true, value_parser = value::spacing))]
    pub spacing: Option<f64>,
    /// Size in pixels instead of the scene's, such as 1920x1080
    #[cfg_attr(feature = "clap", arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = value::size))]
    pub size: Option<[u32; 2]>,
    /// Renderer of the depth buffers, as of `render`
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", default_value_t))]
    pub renderer: RendererName,
    /// Draw the picture, too, and score the look of its terrain: rules with value, bounds and the option that mends each
    #[cfg_attr(feature = "clap", arg(long))]
    pub picture: bool,
}

/// Buildings and streets.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Generalise {
    /// Buildings with their heights or storeys: CityJSON, CityGML, OSM PBF, or footprints as GeoJSON, shapefile or
    /// GeoPackage (FILE.gpkg?table=NAME)
    #[cfg_attr(feature = "clap", arg())]
    pub city: String,
    /// Streets, railways, rivers and land cover, if the city file has none: GeoJSON, shapefiles, OSM PBF,
    /// GeoPackages
    #[cfg_attr(feature = "clap", arg())]
    pub roads: Vec<String>,
    /// Distance from buildings up to which ground counts as built-up, metres; 20 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = value::number))]
    pub margin: Option<f64>,
    /// What blocks keep of their buildings
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<Keep>(), value_name = "WHAT", default_value = "height"))]
    pub keep: Keep,
}

/// The displaced scene and its camera as GLB.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Export {
    /// Size of the picture that the camera is for, instead of the scene's
    #[cfg_attr(feature = "clap", arg(long, value_name = "WxH", allow_hyphen_values = true, value_parser = value::size))]
    pub size: Option<[u32; 2]>,
    /// The scene without its bends
    #[cfg_attr(feature = "clap", arg(long))]
    pub straight: bool,
    /// Most nodes of the ground, 4 to 4,000,000; of finer ground every second, third ... node is taken; 1,000,000 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(4..=4_000_000)))]
    pub nodes: Option<u32>,
    /// What data without a scene file do not say.
    #[cfg_attr(feature = "clap", command(flatten, next_help_heading = "Data without a scene file"))]
    #[serde(flatten)]
    pub data: OfData,
}
