//! Stage `relief` of the scene document.

use super::common::PlaneDoc;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Changes of relief: heights raised or lowered from foreground to background, shown in plan, on a curved horizon, over ground whose
/// large forms are levelled.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ReliefStageDoc {
    /// Factor of heights over the plane, 0.01..=100; or of the foreground and the background.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exaggeration: Option<OneOrTwo>,
    /// Plan oblique relief: how far a height of 1 is moved away from the viewer, 0..=5.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oblique: Option<f64>,
    /// Radius of the curved horizon in the background, metres, > 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizon_radius_m: Option<f64>,
    /// Share of the terrain's large forms that is taken away, 0..=1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levelling: Option<f64>,
    /// Standard deviation of the average that is a large form, metres; by default a fifth of the range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levelling_scale_m: Option<f64>,
    /// Distances from the eye at which the foreground ends and the background begins, metres in plan; by default 0.5 and 1.9 times that of the pivot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_m: Option<[f64; 2]>,
    /// In place of `range_m`: number of the tag point (1 = the nearest) of the spline stage that follows over whose transition the foreground
    /// passes into the background. With an exaggeration of 0.01 there, ground lies flat in the sections behind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_tag: Option<usize>,
    /// Reference plane, from which heights count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneDoc>,
}

/// One number, or one for the foreground and one for the background.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "a number or [foreground, background] was expected")]
pub enum OneOrTwo {
    /// Everywhere.
    One(f64),
    /// In the foreground, and in the background.
    Two([f64; 2]),
}

impl OneOrTwo {
    /// Foreground and background.
    pub fn pair(self) -> [f64; 2] {
        match self {
            Self::One(v) => [v; 2],
            Self::Two(pair) => pair,
        }
    }
}
