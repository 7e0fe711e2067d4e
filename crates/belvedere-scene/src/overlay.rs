//! Marks that belong to no layer: grids, figures of the camera, labelled points.

use crate::{Color, Hidden, Symbol};
use belvedere_core::DVec3;

/// Usual height of the letters at the rim of a grid and at distance marks, pixels.
pub const SMALL_LETTERS_PX: f64 = 11.0;

/// A line that belongs to no layer.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlayLine {
    /// Vertices, scene coordinates.
    pub points: Vec<DVec3>,
    /// Whether the line is laid on the ground and its heights are ignored; it ends where the ground ends.
    pub on_ground: bool,
    /// Colour.
    pub color: Color,
    /// Width on screen, pixels.
    pub width_px: f64,
    /// Colour of the rim; `None` = no rim.
    pub casing: Option<Color>,
    /// Style of the parts behind surfaces.
    pub hidden: Hidden,
    /// Text at its visible end nearest to the bottom of the picture; possibly empty.
    pub label: String,
    /// Height of its letters, pixels; usually [`SMALL_LETTERS_PX`].
    pub label_px: f64,
}

/// A convex, flat polygon, translucent.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlayFace {
    /// Corners in order, scene coordinates, at least 3.
    pub corners: Vec<DVec3>,
    /// Colour with opacity; fainter behind surfaces.
    pub color: Color,
}

/// A marker with a text.
#[derive(Debug, Clone, PartialEq)]
pub struct OverlayPoint {
    /// Position, scene coordinates.
    pub position: DVec3,
    /// Shape.
    pub symbol: Symbol,
    /// Diameter on screen, pixels.
    pub size_px: f64,
    /// Colour.
    pub color: Color,
    /// Style behind surfaces.
    pub hidden: Hidden,
    /// Text, possibly empty.
    pub label: String,
}

/// Everything drawn that belongs to no layer; it does not change the id buffer.
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
