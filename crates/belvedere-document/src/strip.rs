//! Stage `strip` of the scene document.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A strip of the ground along a route that is straightened in plan; exactly one of `along` and `path`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StripStageDoc {
    /// Id of the line layer that the strip follows: its longest connected run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<String>,
    /// The route itself, points `[x, y]` in scene coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Vec<[f64; 2]>>,
    /// Largest distance from the smoothed route, metres: what lies farther away is not drawn; by default a tenth of the route's length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_width_m: Option<f64>,
    /// Share of the bends that is taken away, 0..=1; by default 1: the route becomes a straight line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Nothing moves where the route is nearest to this point `[x, y]`; by default to the point that the camera looks at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchor: Option<[f64; 2]>,
    /// Standard deviation of the average along the route that smooths it, metres; by default the least that keeps the strip from folding
    /// and from overlapping itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing_m: Option<f64>,
}
