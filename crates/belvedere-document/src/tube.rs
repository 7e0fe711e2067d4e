//! Stage `tube` of the scene document.

use super::intent::CentrelineDoc;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What lies around a line in space, such as a vessel, straightened with it; exactly one of `path`, `points` and `centreline`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TubeStageDoc {
    /// The line: a line layer, a layer that moves, or a file: CSV (`x,y,z`), OBJ (its vertices in order), JSON (saved cameras).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// The line itself, points `[x, y, z]` in scene coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<[f64; 3]>>,
    /// The centreline between two points of a volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centreline: Option<CentrelineDoc>,
    /// Largest distance from the smoothed line, scene units: what lies farther away is not drawn; by default four times the median clearance
    /// of a `centreline`, else a tenth of the line's length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// Share of the bends that is taken away, 0..=1; by default 1: the line becomes straight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Nothing moves where the line is nearest to this point `[x, y, z]`; by default in the middle of the line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchor: Option<[f64; 3]>,
    /// Standard deviation of the average along the line that smooths it, scene units; by default the least with which no bend is sharper
    /// than half the median clearance of a `centreline`, else than a tenth of the radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing_m: Option<f64>,
}
