//! Points of the scene document.

use super::Paths;
use super::by_property::{ColorByDoc, SizeByDoc};
use super::symbol::SymbolDoc;
use belvedere_scene::Hidden;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Points on the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointLayerDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file, or several.
    pub source: Paths,
    /// Property that holds the names of features; by default the one that looks most like a name, which `info` tells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name_field: Option<String>,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// How it is drawn.
    #[serde(default)]
    pub style: PointStyleDoc,
}

/// How points are drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PointStyleDoc {
    /// `#rrggbb` or `#rrggbbaa`.
    pub color: String,
    /// Colour by a property of the file, in place of `color`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color_by: Option<ColorByDoc>,
    /// Shape: `auto`, `dot`, `triangle`, `square`, `pin`, `cross`, `hut`, `pass`, `lift`, `viewpoint`, `parking`, `ring`, `target`, or an
    /// SVG file of filled shapes. With `auto` points that say what they are have its usual symbol, colour and size.
    #[schemars(with = "String")]
    pub symbol: SymbolDoc,
    /// Colour of the rim, or `none`.
    pub casing: String,
    /// Whether names are written, as far as they do not overlap; those of the highest rank first.
    pub labels: bool,
    /// Property whose values are written, such as `name:de`; features without it are written by their name. Names are then written
    /// without `labels`, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Which names are placed first: `auto` (peaks by prominence and dominance over the ground, settlements by population or class, huts,
    /// passes and other places by what they are), `prominence`, `dominance`, `population`, `file` (the order of the file), or a property
    /// that holds numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<String>,
    /// Whether heights are written below names: that of `ele` and its like, else that of the ground; by default those of peaks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label_elevation: Option<bool>,
    /// Height of the letters, pixels, in (0, 200].
    pub label_px: f64,
    /// Diameter on screen, pixels, in (0, 200].
    pub size_px: f64,
    /// Diameter by a property of the file, in place of `size_px`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_by: Option<SizeByDoc>,
    /// What happens to hidden points.
    pub hidden: Hidden,
    /// Height above ground, metres, in [0, 1000].
    pub lift_m: f64,
}

impl Default for PointStyleDoc {
    fn default() -> Self {
        Self {
            color: "#6a3d9a".into(),
            color_by: None,
            symbol: SymbolDoc::Auto,
            casing: "#ffffff".into(),
            labels: false,
            label: None,
            rank: None,
            label_elevation: None,
            label_px: 13.0,
            size_px: 8.0,
            size_by: None,
            hidden: Hidden::Fade,
            lift_m: 1.0,
        }
    }
}
