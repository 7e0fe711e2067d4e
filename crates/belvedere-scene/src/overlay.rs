//! Marks that belong to no layer: grids, figures of the camera, labelled points.

use crate::{Color, Hidden, Symbol};
use belvedere_core::DVec3;

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
