//! How a picture looks.

#[cfg(feature = "clap")]
use super::args::one_of;
use super::molecule::Molecules;
#[cfg(feature = "clap")]
use super::value;
use crate::{FurnitureItem, FurnitureWish, LightDoc, StylisationDoc, SwitchOrLength, SwitchOrVisibility};
use belvedere_scene::{Edge, Hidden, Relief};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Sky, haze and furniture.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Air {
    /// Sky: auto (by the height of the sun), day, dusk, night, white, a colour #rrggbb, or transparent (PNG and SVG)
    #[cfg_attr(feature = "clap", arg(long, visible_alias = "background", value_name = "NAME|COLOUR"))]
    pub sky: Option<String>,
    /// Haze: on (the default: dims the farther part of the view), off, or the visibility in kilometres
    #[cfg_attr(feature = "clap", arg(long, value_name = "on|off|KM", allow_negative_numbers = true, value_parser = value::haze))]
    pub haze: Option<SwitchOrVisibility>,
    /// Quiet clouds over a share of the sky, 0..=1; 0.4 without a value
    #[cfg_attr(feature = "clap", arg(long, value_name = "SHARE", num_args = 0..=1, require_equals = true, default_missing_value = "0.4", allow_negative_numbers = true, value_parser = value::share))]
    pub clouds: Option<f64>,
    /// Draw lines of equal height on the ground, every M metres of true height; by default at an interval that fits the scale
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", num_args = 0..=1, require_equals = true, default_missing_value = "true", value_parser = value::contours))]
    pub contours: Option<SwitchOrLength>,
    /// How the ground ends where its data end: soft (it fades), block (it is cut, with sides), mat (it stands on a plain surface), plain
    #[cfg_attr(feature = "clap", arg(long, value_name = "KIND", value_parser = one_of::<Edge>(), hide_possible_values = true))]
    pub edge: Option<Edge>,
    /// Tint the ground by height alone: no forest, rock or snow by rule, and no relief finer than the data
    #[cfg_attr(feature = "clap", arg(long))]
    pub plain: bool,
    /// What covers the ground instead of a guess by climate and relief: a raster of ESA WorldCover, CORINE or NLCD, or areas of OpenStreetMap
    #[cfg_attr(feature = "clap", arg(long, value_name = "FILE", conflicts_with = "plain"))]
    pub landcover: Option<String>,
    /// Title, legend, attribution, compass and scale.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub furnishing: Furnishing,
}

/// Title, legend, attribution, compass and scale.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Furnishing {
    /// Title in the picture
    #[cfg_attr(feature = "clap", arg(long, value_name = "TEXT"))]
    pub title: Option<String>,
    /// What stands over the picture so that it can be read as a map: any of title, legend, attribution, source, date, compass, scale,
    /// distances; all, or none
    #[cfg_attr(feature = "clap", arg(long, value_name = "LIST"))]
    pub furniture: Option<FurnitureItems>,
}

impl Furnishing {
    /// What documents are asked to hold.
    pub fn wish(&self) -> FurnitureWish {
        FurnitureWish { items: self.furniture.as_ref().map(|items| items.0.clone()), title: self.title.clone() }
    }
}

/// Pieces of furniture: a list of names, or a text with commas.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "Names")]
#[schemars(with = "Names")]
pub struct FurnitureItems(Vec<FurnitureItem>);

#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
enum Names {
    Text(String),
    List(Vec<String>),
}

impl FromStr for FurnitureItems {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        FurnitureItem::listed(text.split(',')).map(Self)
    }
}

impl TryFrom<Names> for FurnitureItems {
    type Error = String;

    fn try_from(names: Names) -> Result<Self, String> {
        match names {
            Names::Text(text) => text.parse(),
            Names::List(list) => FurnitureItem::listed(list.iter().map(String::as_str)).map(Self),
        }
    }
}

/// Look of the picture; all of it is written into the scene file too.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Look {
    /// Light the scene as the sun does over the eye at this time, such as 2026-07-01T15:00:00Z or 2026-07-01T17:00+02:00: shading by
    /// the sun alone while it is up (unless --relief says otherwise), with cast shadows
    #[cfg_attr(feature = "clap", arg(long, value_name = "TIME", value_parser = value::time))]
    pub light_time: Option<String>,
    /// Light from a direction: degrees clockwise from north, and over the horizon; 315,45 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "AZIMUTH,ALTITUDE", allow_hyphen_values = true, conflicts_with = "light_time", value_parser = value::light))]
    pub light: Option<[f64; 2]>,
    /// Sky, haze and furniture.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub air: Air,
    /// Draw cast shadows
    #[cfg_attr(feature = "clap", arg(long))]
    pub shadows: bool,
    /// Draw no shadows on molecules, which have them without --shadows
    #[cfg_attr(feature = "clap", arg(long, conflicts_with_all = ["shadows", "light_time"]))]
    pub no_shadows: bool,
    /// Shading of the terrain; swiss by default, sun with --light-time
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<Relief>(), value_name = "SHADING"))]
    pub relief: Option<Relief>,
    /// Style of hidden parts of features; by default lines are dashed, outlines of areas cut, points faint
    #[cfg_attr(feature = "clap", arg(long, value_parser = one_of::<Hidden>(), value_name = "STYLE"))]
    pub hidden: Option<Hidden>,
    /// Multiply heights over the median height of the terrain by F, 0.01 to 100; the straight picture keeps the true heights
    #[cfg_attr(feature = "clap", arg(long, value_name = "F", allow_negative_numbers = true, value_parser = value::exaggeration))]
    pub exaggeration: Option<f64>,
    /// Draw dark edges and depth unsharp masking, of strengths in 0..=1 and 0..=10; 0.7,4 without a value
    #[cfg_attr(feature = "clap", arg(long, value_name = "EDGES[,UNSHARP]", num_args = 0..=1, require_equals = true, default_missing_value = "0.7,4", value_parser = value::stylise))]
    pub stylise: Option<StylisationDoc>,
    /// Leave out the mark in the corner that says that the view is bent, and by how much; the record still says so
    #[cfg_attr(feature = "clap", arg(long))]
    pub no_mark: bool,
    /// Molecules of the picture.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub molecules: Molecules,
}

impl Look {
    /// The light as a scene states it; `None` if nothing is said of it.
    pub fn light(&self) -> Option<LightDoc> {
        let [azimuth_deg, altitude_deg] = [0, 1].map(|i| self.light.map(|light| light[i]));
        let time = self.light_time.clone();
        let shadows = self.shadows || time.is_some();
        let Air { sky, haze, clouds, .. } = self.air.clone();
        let stated = shadows || self.light.is_some() || sky.is_some() || haze.is_some() || clouds.is_some();
        stated.then_some(LightDoc { azimuth_deg, altitude_deg, time, shadows, sky, haze, clouds })
    }
}
