//! Features in memory.

use super::{TIMES, Vectors, geojson, without_phantoms};
use crate::{IoError, Loaded, budget};
use serde_json::json;
use std::path::Path;

/// Lines, areas and points as the text of a GeoJSON document.
#[derive(Debug, Clone)]
pub struct FeatureText(String);

impl FeatureText {
    /// * `text`: one GeoJSON value; its member `crs` may name a system, or `local`.
    pub fn new(text: String) -> Self {
        Self(text)
    }

    /// The features, as [`crate::load_vectors`] reads them from a file.
    ///
    /// # Errors
    /// [`IoError::Format`] as those of a file.
    pub fn vectors(&self, path: &Path) -> Result<Loaded<Vectors>, IoError> {
        let peak = (self.0.len() as u64).saturating_mul(TIMES);
        budget::ask("the features", peak).map_err(|reason| IoError::format(path, reason))?;
        without_phantoms(path, geojson::load(path, &self.0)?)
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.0
    }

    pub(crate) fn layout(&self) -> (serde_json::Value, Vec<&[u8]>) {
        (json!({ "array": "geojson" }), vec![self.0.as_bytes()])
    }
}
