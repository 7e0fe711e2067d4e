//! Tints of terrain.

use crate::DocumentError;
pub use belvedere_scene::PaletteName;
use schemars::JsonSchema;
use serde::de::Deserializer;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Tint by height: a name, or a file of colours by height (GDAL colour-relief text, or GMT `.cpt`).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PaletteDoc {
    /// A built-in one.
    Named(PaletteName),
    /// A file.
    File(String),
}

impl Default for PaletteDoc {
    fn default() -> Self {
        Self::Named(PaletteName::Auto)
    }
}

impl PaletteDoc {
    /// Why a name means no palette, and what to give.
    pub fn unknown(name: &str) -> String {
        let names = PaletteName::ALL.map(|(name, _)| name);
        format!(
            "palette \"{}\" is neither the name of a palette nor a file of colours by height; {}",
            super::doc_error::shorten(name),
            super::suggestion(name, &names)
        )
    }

    /// The built-in one of that name, else a file.
    pub fn of(text: &str) -> Self {
        let named = PaletteName::ALL.iter().find(|(name, _)| *name == text);
        named.map_or_else(|| Self::File(text.to_owned()), |(_, palette)| Self::Named(*palette))
    }
}

impl PaletteDoc {
    /// The palette with the full path of its file, whose folder is allowed from now on.
    pub fn located(&self, allowed: &mut Vec<PathBuf>) -> Result<Self, DocumentError> {
        let Self::File(name) = self else { return Ok(self.clone()) };
        let path = belvedere_io::fs::canonicalize(name).map_err(|_| DocumentError::Palette(Self::unknown(name)))?;
        allowed.extend(path.parent().map(Path::to_owned));
        path.to_str().map(|path| Self::File(path.to_owned())).ok_or_else(|| DocumentError::not_utf8(name))
    }
}

impl<'de> Deserialize<'de> for PaletteDoc {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|text| Self::of(&text))
    }
}
