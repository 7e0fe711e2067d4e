//! Paper of the scene document.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Paper of pictures: their size in pixels follows from it, and so do the sizes of lines, symbols and letters, which are lengths on paper: one
/// pixel of a style is 0.75 points, 1/96 inch.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PrintDoc {
    /// `A0` to `A6`, which lie where the picture is wider than high, `A3-portrait`, `A3-landscape`, or a size such as `420x297mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paper: Option<String>,
    /// Pixels per inch, in 10..=2400; with a paper 300 unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dpi: Option<f64>,
    /// White margin around the picture, millimetres, in 0..=1000. Files of pixels leave it out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin_mm: Option<f64>,
}
