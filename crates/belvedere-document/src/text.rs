//! Letters of the scene document.

use super::Paths;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Letters of names. The embedded font sets Latin, Greek and Cyrillic letters; what it lacks is looked for in `fonts`, then in the fonts of
/// the system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TextDoc {
    /// Font files, TrueType or OpenType: one, or several in the order in which letters are looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fonts: Option<Paths>,
    /// Whether fonts of the system are used for letters that no other font has. The record of the picture names them with their hashes.
    pub system_fonts: bool,
    /// Unit of heights below names: `m` or `ft`.
    pub heights: HeightUnit,
}

/// Unit of heights below names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum HeightUnit {
    /// Metres.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Feet of 0.3048 m.
    #[serde(rename = "ft")]
    Foot,
}

impl Default for TextDoc {
    fn default() -> Self {
        Self { fonts: None, system_fonts: true, heights: HeightUnit::Metre }
    }
}
