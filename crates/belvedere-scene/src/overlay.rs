//! Marks of a picture beyond the features themselves: symbols, names, distances, grids, figures of the camera.

use crate::{Color, Hidden};
use belvedere_core::DVec3;
use serde::{Deserialize, Serialize};

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

/// How the points of a layer look beside their colour and size.
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

/// Distance between marks along a line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum DistanceMarkers {
    /// A round distance that gives about ten marks on the longest line of the layer.
    #[default]
    Auto,
    /// So many scene units along the ground, > 0.
    Every(f64),
}

/// A line that belongs to no layer.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlayLine {
    /// Vertices, scene coordinates.
    pub points: Vec<DVec3>,
    /// Whether the line lies on the ground, whatever its heights; it ends where there is none.
    pub on_ground: bool,
    /// Colour.
    pub color: Color,
    /// Width on screen, pixels.
    pub width_px: f64,
    /// Colour of the rim; `None` = no rim.
    pub casing: Option<Color>,
    /// What happens behind surfaces.
    pub hidden: Hidden,
    /// Text at its visible end nearest to the bottom of the picture; possibly empty.
    pub label: String,
}

/// A convex, flat polygon, translucent.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlayFace {
    /// Corners in order, scene coordinates, at least 3.
    pub corners: Vec<DVec3>,
    /// Colour with opacity. Behind surfaces less of it is left.
    pub color: Color,
}

/// A marker with a text.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlayPoint {
    /// Place, scene coordinates.
    pub position: DVec3,
    /// Shape.
    pub symbol: Symbol,
    /// Diameter on screen, pixels.
    pub size_px: f64,
    /// Colour.
    pub color: Color,
    /// What happens behind surfaces.
    pub hidden: Hidden,
    /// Text, possibly empty.
    pub label: String,
}

/// Everything drawn that belongs to no layer and leaves the id buffer alone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overlay {
    /// Lines below those of the layers, such as a grid.
    pub under: Vec<OverlayLine>,
    /// Translucent faces, over `under`.
    pub faces: Vec<OverlayFace>,
    /// Lines over those of the layers.
    pub over: Vec<OverlayLine>,
    /// Points over everything.
    pub points: Vec<OverlayPoint>,
}
