//! What is told of a file with a city.

use crate::BelvedereError;
use belvedere_io::{Limits, load_city};
use serde::Serialize;
use std::path::Path;

/// A city.
#[derive(Debug, Clone, Serialize)]
pub struct CityInfo {
    /// Path as given.
    pub path: String,
    /// Name of the format, with its version.
    pub format: String,
    /// Buildings.
    pub buildings: usize,
    /// Buildings that their attributes make landmarks.
    pub landmarks: usize,
    /// Bridges, trees and other solids.
    pub structures: usize,
    /// Centre lines of streets, railways and rivers.
    pub ways: usize,
    /// Pieces of land cover.
    pub areas: usize,
    /// Where the heights of buildings are from.
    pub heights: String,
    /// Levels of detail, rising.
    pub lods: Vec<String>,
    /// Horizontal system; null if the file names none that is known.
    pub crs: Option<String>,
    /// What the file says of its system and heights.
    pub reference: String,
    /// What was odd.
    pub warnings: Vec<String>,
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
            warnings: loaded.warnings,
        })
    }
}
