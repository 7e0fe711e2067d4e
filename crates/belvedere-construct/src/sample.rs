//! A point that stands for a piece of a feature, and the points of a feature.

use belvedere_core::DVec3;
use serde::Serialize;

/// What the amounts of a feature measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// Length along a line, scene units.
    Length,
    /// Area in plan, scene units squared.
    Area,
    /// Area of a surface in space, scene units squared.
    Surface,
    /// Number of points.
    Count,
}

/// One point of a feature, lifted to where it must be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Scene coordinates, `lift_m` above the drawn ground.
    pub p_world: DVec3,
    /// Height of `p_world` over the ground, scene units.
    pub lift: f64,
    /// Length, area or count that the sample stands for.
    pub amount: f64,
    /// Outward unit normal, if the sample stands for a piece of a surface in space, just in front of which it lies.
    pub surface: Option<DVec3>,
    /// Number of the triangle that it lies before: of a mesh, or of a molecule's surface; twelve to a box.
    pub triangle: Option<u32>,
}

/// A feature of interest, sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledFeature {
    /// Index of the layer in the scene.
    pub layer: usize,
    /// Index of the feature in its layer.
    pub feature: usize,
    /// Id of the layer.
    pub layer_id: String,
    /// Name of the feature, possibly empty.
    pub name: String,
    /// What amounts count.
    pub amount: Amount,
    /// Points in order along the feature.
    pub samples: Vec<Sample>,
}
