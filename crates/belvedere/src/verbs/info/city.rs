//! Description of a city file.

use crate::BelvedereError;
use crate::verbs::CitySee;
use belvedere_core::Warning;
use belvedere_io::{Limits, load_city};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// A city.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct CityInfo {
    /// Path as given.
    pub path: String,
    /// Name of the format, with its version.
    pub format: String,
    /// Buildings.
    pub buildings: usize,
    /// Buildings that are landmarks by their attributes.
    pub landmarks: usize,
    /// Bridges, trees and other solids.
    pub structures: usize,
    /// Centre lines of streets, railways and rivers.
    pub ways: usize,
    /// Pieces of land cover.
    pub areas: usize,
    /// Source of the heights of buildings.
    pub heights: String,
    /// Levels of detail, ascending.
    pub lods: Vec<String>,
    /// Horizontal coordinate system; null if the file names no known one.
    pub crs: Option<String>,
    /// Coordinate and height reference as named by the file.
    pub reference: String,
    /// What `reveal --see` understands.
    pub see: CitySee,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

impl CityInfo {
    pub(super) fn of(path: &Path) -> Result<Self, BelvedereError> {
        let loaded = load_city(path, None, &Limits::default())?;
        let file = &loaded.value;
        Ok(Self {
            path: path.display().to_string(),
            format: file.format.clone(),
            buildings: file.city.buildings.len(),
            landmarks: file.city.buildings.iter().filter(|b| b.landmark).count(),
            structures: file.city.structures.len(),
            ways: file.city.ways.len(),
            areas: file.city.areas.len(),
            heights: file.heights(),
            lods: file.lods.clone(),
            crs: file.crs.as_ref().map(|crs| crs.name().to_owned()),
            reference: file.reference.clone(),
            see: CitySee::of(file),
            warnings: loaded.warnings,
        })
    }
}
