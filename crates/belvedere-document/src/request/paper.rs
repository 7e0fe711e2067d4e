//! Pictures on paper.

#[cfg(feature = "clap")]
use super::value;
use crate::PrintDoc;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Paper of a picture.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct Paper {
    /// Paper: A0 to A6 (landscape where the picture is wider than high), A3-portrait, A3-landscape, or a size such as 420x297mm; pixels,
    /// widths of lines and heights of letters follow from it
    #[cfg_attr(feature = "clap", arg(long, value_name = "PAPER", value_parser = value::paper))]
    pub paper: Option<String>,
    /// Pixels per inch, 300 with --paper unless --size is given; lengths that the scene states in pixels are 1/96 inch each
    #[cfg_attr(feature = "clap", arg(long, value_name = "DPI", allow_negative_numbers = true, value_parser = value::number))]
    pub dpi: Option<f64>,
    /// White margin of the paper on every side, millimetres; PNG, TIFF, JPEG and WebP leave it out
    #[cfg_attr(feature = "clap", arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = value::number))]
    pub margin_mm: Option<f64>,
}

impl Paper {
    /// The paper as a scene states it.
    pub fn document(&self) -> PrintDoc {
        PrintDoc { paper: self.paper.clone(), dpi: self.dpi, margin_mm: self.margin_mm }
    }
}
