//! Stages of the scene document.

use super::common::PlaneDoc;
use super::ground_moves::GroundMovesStageDoc;
use super::relief::ReliefStageDoc;
use super::strip::StripStageDoc;
use super::tube::TubeStageDoc;
use super::unroll::UnrollStageDoc;
use belvedere_core::map::curved_rays::{Model, Sharpness};
use belvedere_core::presets::PresetDocument;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

/// One stage.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum StageDoc {
    /// The ground moves so that required features are seen.
    TerrainDisocclusion(TerrainStageDoc),
    /// The ground moves as an author set it.
    GroundMoves(GroundMovesStageDoc),
    /// A strip along a route is straightened.
    Strip(StripStageDoc),
    /// What lies around a line in space is straightened with it.
    Tube(TubeStageDoc),
    /// The circle around the eye is unrolled.
    Unroll(UnrollStageDoc),
    /// Heights are raised, lowered, shown in plan or levelled.
    Relief(ReliefStageDoc),
    /// Space is carried onto a B-spline over the reference plane.
    SplineBend(SplineStageDoc),
    /// Rays bend around occluders.
    CurvedRays(RaysStageDoc),
}

/// Names of the kinds of stages.
pub(super) const STAGE_KINDS: &[&str] =
    &["terrain_disocclusion", "ground_moves", "strip", "tube", "unroll", "relief", "spline_bend", "curved_rays"];

impl StageDoc {
    /// Name of the kind, as files write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::TerrainDisocclusion(_) => "terrain_disocclusion",
            Self::GroundMoves(_) => "ground_moves",
            Self::Strip(_) => "strip",
            Self::Tube(_) => "tube",
            Self::Unroll(_) => "unroll",
            Self::Relief(_) => "relief",
            Self::SplineBend(_) => "spline_bend",
            Self::CurvedRays(_) => "curved_rays",
        }
    }

    /// Whether the stage has to be solved before anything can be drawn.
    pub fn is_terrain_intent(&self) -> bool {
        matches!(self, Self::TerrainDisocclusion(doc) if doc.delta.is_none())
    }
}

/// How the terrain solver works.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum SolverMode {
    /// As published.
    #[serde(rename = "paper")]
    Paper,
    /// As published, finished by a quadratic program.
    #[serde(rename = "paper+qp")]
    PaperQp,
    /// A quadratic program.
    #[serde(rename = "qp")]
    Qp,
}

/// Detail of the terrain that the solver moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DetailDoc {
    /// Scaled with the lowering.
    Scaled,
    /// Kept as it is.
    Plain,
}

/// Terrain disocclusion: `delta`, a solved grid, or an intent for the solver.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TerrainStageDoc {
    /// Grid of height changes, a single-band raster in the scene's system, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delta: Option<String>,
    /// sha256 of the grid, hexadecimal; checked if given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delta_sha256: Option<String>,
    /// Solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mode: Option<SolverMode>,
    /// Cells (mountains) to keep, a whole number; by default the nodes of the terrain / 1600.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<f64>,
    /// Spacing of reference points, cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<f64>,
    /// Height of reference points over the ground, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lift_m: Option<f64>,
    /// Guard width, cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guard: Option<f64>,
    /// Weight eta.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eta: Option<f64>,
    /// Weight mu.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
    /// Weight mu of deviations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu_dev: Option<f64>,
    /// Smoothness weight, for a solver's grid of 129 nodes; by default 0.6, in mode qp 0.3 or as much more as keeps the smoothing
    /// no longer than 450 m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub w: Option<f64>,
    /// Weight of the rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows_weight: Option<f64>,
    /// Time constant of temporal smoothing, seconds; 0 = off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gamma_time_s: Option<f64>,
    /// Nodes of the solver's grid on the longer side, about: its steps are whole ones of the terrain's grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_nodes: Option<u32>,
    /// What happens to detail.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<DetailDoc>,
    /// Most the ground may rise, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rise_limit_m: Option<f64>,
    /// Clearance of lines of sight, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin_m: Option<f64>,
    /// Spacing of candidates, cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub candidates: Option<f64>,
    /// Only features within this path distance, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ahead_m: Option<f64>,
    /// Whether the ground must still look like ground: no more than a fifth of the relief below the lowest, nor more than twice as steep
    /// as all but a thousandth of the terrain; true by default. What cannot be shown then is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits: Option<bool>,
    /// Whether spikes, single samples far above or below all their neighbours, are ground that must make way; by default they are said and
    /// passed over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spikes: Option<bool>,
    /// Ids of line layers, rivers, along which the displaced ground rises downstream by no more than the elevation model does.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rivers: Vec<String>,
    /// Share of the features in view that the ground makes way for at least, 0..=1; the dearest stretches beyond it are given up. By default,
    /// without `move_at_most_m` and with `limits`, all are shown that leave the landscape like itself: slopes, the order of heights and of
    /// summits in the picture. 1 shows all, whatever it costs. Stills only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub show: Option<f64>,
    /// Most the ground may move, metres: the dearest stretches of the features are given up until it moves no more. Stills only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub move_at_most_m: Option<f64>,
    /// Price of a metre of occlusion squared, > 0: what costs more to clear stays covered by ground that is drawn see-through;
    /// by default everything is cleared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slack_price: Option<f64>,
    /// From 0, move the camera a little where that saves ground, to 1, only the ground moves; by default the camera stays.
    /// Stills only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adjust_viewpoint: Option<f64>,
}

/// Spline bend.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SplineStageDoc {
    /// Name of a built-in document, path of a document, or the whole document inline.
    pub presets: PresetsDoc,
    /// Point about which the view turns; by default where the line of sight meets the plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pivot: Option<[f64; 3]>,
    /// Reference plane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneDoc>,
}

/// A built-in name, a path, or a document.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PresetsDoc {
    /// Built-in name, or path of a TOML or JSON document.
    Named(String),
    /// The document.
    Inline(Box<PresetDocument>),
}

impl<'de> Deserialize<'de> for PresetsDoc {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PresetsVisitor;
        impl<'de> Visitor<'de> for PresetsVisitor {
            type Value = PresetsDoc;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("the name of a built-in preset, a path, or a preset document")
            }

            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<PresetsDoc, E> {
                Ok(PresetsDoc::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PresetsDoc, A::Error> {
                PresetDocument::deserialize(MapAccessDeserializer::new(map)).map(Box::new).map(PresetsDoc::Inline)
            }
        }
        deserializer.deserialize_any(PresetsVisitor)
    }
}

/// Curved rays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RaysStageDoc {
    /// Model of the transition.
    #[serde(default)]
    pub model: Model,
    /// The turns, in ray order; at least one, or a split.
    #[serde(default)]
    pub turn: Vec<TurnDoc>,
    /// After these turns the rays part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split: Option<SplitDoc>,
}

/// The rays of the two sides of a seam go different ways.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SplitDoc {
    /// Two points of a straight line across the picture, in shares of its width and height, `[0, 0]` at the top left; upright
    /// in the middle by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seam: Option<[[f64; 2]; 2]>,
    /// The way of the left side (the upper one of a level seam).
    #[serde(default)]
    pub left: WayDoc,
    /// The way of the right side (the lower one of a level seam).
    #[serde(default)]
    pub right: WayDoc,
    /// Where both ways become one again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub merge: Option<MergeDoc>,
}

/// One way: turns, and a further split after them. Without either its rays go on as they come.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WayDoc {
    /// The turns, in ray order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub turn: Vec<TurnDoc>,
    /// After these turns the rays part again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split: Option<Box<SplitDoc>>,
}

/// Both ways go on as from one viewpoint from where the rays along the seam meet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MergeDoc {
    /// The common viewpoint.
    pub viewpoint: [f64; 3],
    /// How far before and behind the meeting the rays bend, scene units.
    pub reach: f64,
}

/// One turn: exactly one of `line` and `normal`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnDoc {
    /// Viewpoint after the turn.
    pub viewpoint: [f64; 3],
    /// A point of the first plane.
    pub t0: [f64; 3],
    /// The bend point.
    pub t1: [f64; 3],
    /// A point of the last plane.
    pub t2: [f64; 3],
    /// Common line of the planes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<AxisDoc>,
    /// Normal of parallel planes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// Bending: a number in [0.2, 20], `bend`, `left` or `mid`.
    #[serde(default)]
    pub m: Sharpness,
}

/// A line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisDoc {
    /// A point of it.
    pub point: [f64; 3],
    /// Its direction, not zero.
    pub dir: [f64; 3],
}
