//! What records say of layers that were read.

use schemars::JsonSchema;
use serde::Serialize;

/// Surface that the areas of a layer are drawn as, and its source.
#[derive(Debug, Clone, PartialEq, Eq, JsonSchema, Serialize)]
pub struct AreaRecord {
    /// Id of the layer.
    pub layer: String,
    /// Surface: water, forest, glacier, park, outline, plain.
    pub kind: &'static str,
    /// Number of areas.
    pub areas: usize,
    /// Source of this choice.
    pub why: String,
}
