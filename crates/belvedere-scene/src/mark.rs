//! How marks look: hidden parts, symbols, rims, distances.

use crate::Color;
use serde::{Deserialize, Serialize};

/// What happens to the parts of a line, area outline or point that the terrain hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Hidden {
    /// Drawn as if nothing were in front.
    Show,
    /// Drawn faintly.
    Fade,
    /// Drawn dashed and thinner.
    #[default]
    Dash,
    /// Not drawn.
    Cut,
}

/// Shape of a point marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Symbol {
    /// A disc.
    #[default]
    Dot,
    /// A triangle with its tip up: a summit.
    #[serde(alias = "peak")]
    Triangle,
    /// An upright square.
    Square,
    /// A drop whose tip stands on the point.
    Pin,
    /// A diagonal cross.
    Cross,
}

/// Style of the points of a layer, besides colour and size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointStyle {
    /// Shape.
    pub symbol: Symbol,
    /// Colour of the rim; `None` = no rim.
    pub casing: Option<Color>,
    /// Height of the letters of names, pixels; `None` = no names. Names that would overlap earlier ones are left out.
    pub label_px: Option<f64>,
}

impl Default for PointStyle {
    fn default() -> Self {
        Self { symbol: Symbol::Dot, casing: Some(Color::rgb(255, 255, 255)), label_px: None }
    }
}

/// Style of one feature, where it differs from that of its layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureStyle {
    /// Colour, or fill of an area; `None` = that of the layer.
    pub color: Option<Color>,
    /// Width of a line or diameter of a point in those of its layer, > 0; areas ignore it.
    pub scale: f64,
}

impl Default for FeatureStyle {
    fn default() -> Self {
        Self { color: None, scale: 1.0 }
    }
}

/// Distance between marks along a line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum DistanceMarkers {
    /// A round distance that gives about ten marks on the longest line of the layer.
    #[default]
    Auto,
    /// Distance along the ground, scene units, > 0.
    Every(f64),
}
