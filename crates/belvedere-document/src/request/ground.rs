//! What callers say of files that the files do not say themselves.

#[cfg(feature = "clap")]
use super::args::one_of;
use crate::VerticalUnit;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What files do not say.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Stated {
    /// The terrain's file.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub raster: StatedRaster,
    /// Property that holds the names of features, instead of the one that looks most like a name
    #[cfg_attr(feature = "clap", arg(long, value_name = "PROPERTY"))]
    pub name_field: Option<String>,
}

impl Stated {
    /// A terrain whose file does not state its coordinate system.
    ///
    /// * `source_crs`: `EPSG:n`.
    pub fn in_crs(source_crs: &str) -> Self {
        Self {
            raster: StatedRaster { source_crs: Some(source_crs.into()), ..StatedRaster::default() },
            name_field: None,
        }
    }
}

/// What the file of a terrain does not say.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct StatedRaster {
    /// Coordinate system of the terrain's file, instead of the stated one
    #[cfg_attr(feature = "clap", arg(long, value_name = "EPSG:n"))]
    pub source_crs: Option<String>,
    /// Stored value of the terrain that means "no data", instead of the stated one
    #[cfg_attr(feature = "clap", arg(long, value_name = "VALUE", allow_negative_numbers = true))]
    pub nodata: Option<f64>,
    /// Unit of the terrain's heights, instead of the stated one
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<VerticalUnit>(), value_name = "UNIT"))]
    pub vertical_unit: Option<VerticalUnit>,
}

/// What data without a scene file do not say.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct OfData {
    /// Coordinate system of the picture of data alone: auto, EPSG:n or local
    #[cfg_attr(feature = "clap", arg(long, value_name = "CRS"))]
    pub crs: Option<String>,
    /// Lower the ground of data alone with the distance, as on a sphere, with refraction
    #[cfg_attr(feature = "clap", arg(long))]
    pub curved_earth: bool,
    /// The file.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub raster: StatedRaster,
}

impl OfData {
    /// Names of the options.
    pub const OPTIONS: [&'static str; 5] = ["crs", "curved_earth", "source_crs", "nodata", "vertical_unit"];
    /// Those of them that say something of a terrain alone.
    pub const OF_TERRAIN: [&'static str; 3] = ["curved_earth", "nodata", "vertical_unit"];
}
