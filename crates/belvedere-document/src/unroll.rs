//! Stage `unroll` of the scene document.

use belvedere_core::map::unroll::Roll;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The circle around the eye, unrolled: a panorama of up to 360 degrees about the camera's eye, its direction in the middle. It fills the
/// picture's width; the camera's field of view does not count.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct UnrollStageDoc {
    /// Angle from the left to the right side of the picture, degrees, in (0, 360]; by default 360.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub span_deg: Option<f64>,
    /// What it is unrolled from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<Roll>,
}
