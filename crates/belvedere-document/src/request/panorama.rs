//! A picture of the whole circle around a place.

#[cfg(feature = "clap")]
use super::value;
use crate::place::Place;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A panorama from a place, in place of the scene's camera.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Panorama {
    /// Draw the whole circle around a place: x,y of the scene, lon,lat in degrees, or 46.5N,11.3E, and the height of the eye in metres or as +20
    /// over the ground; 2 m over it by default
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "PLACE", allow_hyphen_values = true, conflicts_with = "straighten")
    )]
    pub panorama: Option<Place>,
    /// Direction in the middle of the panorama, degrees clockwise from north; 0 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", requires = "panorama", allow_hyphen_values = true, value_parser = value::number))]
    pub heading: Option<f64>,
    /// Angle from the left to the right side of the panorama, degrees; 360 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", requires = "panorama", value_parser = value::number))]
    pub span: Option<f64>,
    /// Direction of the middle row, degrees below the horizon; 0 by default
    #[cfg_attr(feature = "clap", arg(long, value_name = "DEG", requires = "panorama", allow_hyphen_values = true, value_parser = value::number))]
    pub pitch: Option<f64>,
    /// Unroll it from a sphere, with evenly spaced angles from row to row, instead of a cylinder
    #[cfg_attr(feature = "clap", arg(long, requires = "panorama"))]
    pub sphere: bool,
}
