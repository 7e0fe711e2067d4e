//! Renderers by name.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// A renderer by its name: `auto`, `cpu`, `exact`, or one that a program registers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct RendererName(Cow<'static, str>);

impl RendererName {
    /// The one that the scene names, else the session's own.
    pub const AUTO: Self = Self(Cow::Borrowed("auto"));
    /// The rasteriser on the processor.
    pub const CPU: Self = Self(Cow::Borrowed("cpu"));
    /// The exact tracer of curved rays: slower, without subdivision.
    pub const EXACT: Self = Self(Cow::Borrowed("exact"));

    /// The name.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Default for RendererName {
    fn default() -> Self {
        Self::AUTO
    }
}

impl From<&str> for RendererName {
    fn from(name: &str) -> Self {
        Self(name.trim().to_owned().into())
    }
}

impl fmt::Display for RendererName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
