//! Stage `ground_moves` of the scene document.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The ground as an author moves it: sideways, and up or down.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GroundMovesStageDoc {
    /// The moves, at least one.
    #[serde(rename = "move")]
    pub moves: Vec<MoveDoc>,
    /// Ids of line layers, rivers, that rise nowhere downstream by more than they do; lines of the classes `river` and `stream` are rivers
    /// as well.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rivers: Vec<String>,
}

/// What a move does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MoveKindDoc {
    /// The ground at a place goes elsewhere by `shift_m`.
    Shift,
    /// The ground turns about a place by `angle_deg`.
    Turn,
    /// The ground at a place rises by `by_m`.
    Raise,
    /// Both sides of a line go away from it by `by_m`.
    Widen,
    /// A line goes by `share` to the straight line between its ends.
    Straighten,
}

/// One move: at a place, or along a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MoveDoc {
    /// What it does: `shift`, `turn` and `raise` have a place, `at`; `widen` and `straighten` have a line, `along` or `path`.
    pub kind: MoveKindDoc,
    /// The place `[x, y]`, scene coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 2]>,
    /// Id of the line layer that is the line: its longest connected run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<String>,
    /// The line itself, points `[x, y]` in scene coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<Vec<[f64; 2]>>,
    /// Only the stretch of the line from here, metres along it; from its start by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_m: Option<f64>,
    /// Only the stretch of the line to here, metres along it; to its end by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_m: Option<f64>,
    /// Displacement of `shift`, metres east and north.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shift_m: Option<[f64; 2]>,
    /// Angle of `turn`, degrees counter-clockwise as seen from above, -170..=170.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<f64>,
    /// Height of `raise`, negative downwards; or how far each side goes away in `widen`, negative towards the line; metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_m: Option<f64>,
    /// Share of the way in `straighten`, 0..=1; 1 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Up to this distance from the place the ground moves in full, metres; in `widen` the distance from the line at which it does, half the
    /// width of the valley. By default a quarter of the reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub core_m: Option<f64>,
    /// Beyond this distance from the place or line nothing moves, metres.
    pub reach_m: f64,
}

impl MoveDoc {
    /// A move of a kind that states nothing yet.
    pub fn of(kind: MoveKindDoc, reach_m: f64) -> Self {
        let (at, along, path, shift_m, core_m) = (None, None, None, None, None);
        let (from_m, to_m, angle_deg, by_m, share) = (None, None, None, None, None);
        Self { kind, at, along, path, from_m, to_m, shift_m, angle_deg, by_m, share, core_m, reach_m }
    }
}
