//! What furniture a picture has, for its record.

use serde::Serialize;

/// Furniture of a picture.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FurnitureRecord {
    /// The title.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Number of rows of the legend.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub legend: Option<usize>,
    /// Whom the data ask to be named, as written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub attribution: Option<String>,
    /// The sources, as written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// The date, as written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// The compass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compass: Option<CompassRecord>,
    /// The bars of the local scale.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scale: Vec<ScaleRecord>,
    /// What was asked for and had no place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<&'static str>,
}

impl FurnitureRecord {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// A compass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompassRecord {
    /// Whether it lies on the ground, or stands in a corner.
    pub on_ground: bool,
    /// Place whose directions it shows, scene coordinates.
    pub at: [f64; 3],
    /// Unit vector to the north at that place, scene x and y.
    pub north: [f64; 2],
    /// The same on the picture, a unit vector, x to the right and y down.
    pub north_px: [f64; 2],
}

/// A bar of the local scale.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScaleRecord {
    /// Ends, scene coordinates.
    pub ends: [[f64; 3]; 2],
    /// Their horizontal distance, scene units.
    pub length: f64,
    /// The ends on the picture, pixels.
    pub pixels: [[f64; 2]; 2],
}
