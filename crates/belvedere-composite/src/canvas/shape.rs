//! Shapes that a canvas records instead of drawing them.

use super::Canvas;
use super::font::Fonts;
use belvedere_core::DVec2;
use belvedere_scene::Color;

/// A shape on the picture; positions and lengths in pixels, (0, 0) the outer corner of the top-left one.
#[derive(Debug, Clone, PartialEq)]
pub enum CanvasShape {
    /// A filled rectangle with rounded corners.
    Rect {
        /// Upper left and lower right corner.
        corners: [DVec2; 2],
        /// Radius of the corners.
        radius: f64,
        /// Colour with opacity.
        color: Color,
    },
    /// A polyline with round ends and joints.
    Line {
        /// Vertices.
        points: Vec<DVec2>,
        /// Width.
        width: f64,
        /// Colour with opacity.
        color: Color,
    },
    /// A filled disc.
    Disc {
        /// Centre.
        at: DVec2,
        /// Radius.
        radius: f64,
        /// Colour with opacity.
        color: Color,
    },
    /// A filled polygon, closed implicitly; holes are oriented against their outer ring.
    Polygon {
        /// Outer rings and holes.
        rings: Vec<Vec<DVec2>>,
        /// Colour with opacity.
        color: Color,
    },
    /// A line of text.
    Text {
        /// Left end of the baseline.
        at: DVec2,
        /// Height of the em square.
        size: f64,
        /// The text as it is set: without control characters, and not too long.
        text: String,
        /// Width of the text in its fonts.
        width: f64,
        /// Fonts of its letters.
        fonts: Fonts,
        /// The baseline of a text that is set along a curve, from its left end on; empty: straight.
        along: Vec<DVec2>,
        /// Colour with opacity.
        color: Color,
        /// Colour and width of the rim around the letters.
        halo: Option<(Color, f64)>,
    },
}

impl Canvas<'_> {
    /// Draws a shape that another canvas recorded; its lengths are pixels of a canvas without scale.
    pub fn put(&mut self, shape: &CanvasShape) {
        match shape {
            CanvasShape::Rect { corners: [lo, hi], radius, color } => self.rect(*lo, *hi, *radius, *color),
            CanvasShape::Line { points, width, color } => self.line(points, *width, *color),
            CanvasShape::Disc { at, radius, color } => self.disc(*at, *radius, *color),
            CanvasShape::Polygon { rings, color } => self.polygon(rings.iter().map(Vec::as_slice), *color),
            CanvasShape::Text { at, size, text, color, halo, .. } => self.text(*at, *size, text, *color, *halo),
        }
    }
}
