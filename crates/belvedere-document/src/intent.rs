//! Constructors and animations of the scene document.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kind of a constructor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConstructorKind {
    /// Bends rays so that a moving target stays visible.
    TargetTracking,
    /// Bends rays along a path.
    PathPreview,
    /// Bends rays into what the straight picture does not show.
    AutoProbe,
    /// The explicit stages, as they are.
    Manual,
}

/// Builds stages from an intent, on top of the explicit stages.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstructorDoc {
    /// Which one.
    pub kind: ConstructorKind,
    /// What to keep in view: the id of a layer, the name of a part of a mesh, or `LAYER/NUMBER`, a box of a layer, the first being 1;
    /// atoms, such as `chain B`; or a point `x,y,z`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// What shows the target where no bend does, or always with kind `manual`: `transparency`, `cutaway` or `explosion` of all that
    /// hides it, or `LAYER:KIND` for one layer; a rule of a layer's own comes first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fallback: Vec<String>,
    /// Depth of the first transition plane, scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z0: Option<f64>,
    /// Largest sideways move of the second viewpoint, scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a: Option<f64>,
    /// Step of the search, in (0, 1].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub f_step: Option<f64>,
    /// Largest change of the state per second of a film; of `auto_probe`: turns that come in per second, 0.5 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cap_per_s: Option<f64>,
    /// Growth of the target's box, pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grow_px: Option<f64>,
    /// The path: a line layer, a layer that moves, or a file: CSV (`x,y,z`), OBJ (its vertices in order), JSON (saved cameras).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// In place of `path`: the centreline between two points of a volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centreline: Option<CentrelineDoc>,
    /// Position along the path, scene units; 0 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_m: Option<f64>,
    /// Length that is previewed, scene units; a quarter of the path by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preview_m: Option<f64>,
    /// Camera of the preview, which takes the place of the scene's own; chosen by what it shows of the path if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lens: Option<LensDoc>,
    /// Of `auto_probe`: turns of the rays at most, 1 to 6; 3 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turns: Option<u32>,
    /// Of `auto_probe`: how far from the eye it looks, scene units; by default three times the median distance of what the straight
    /// picture shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reach_m: Option<f64>,
}

impl ConstructorDoc {
    /// The constructor of a kind with its defaults.
    pub fn of(kind: ConstructorKind) -> Self {
        Self {
            kind,
            target: None,
            fallback: Vec::new(),
            z0: None,
            a: None,
            f_step: None,
            cap_per_s: None,
            grow_px: None,
            path: None,
            centreline: None,
            position_m: None,
            preview_m: None,
            lens: None,
            turns: None,
            reach_m: None,
        }
    }
}

/// A way through voxels of certain values, such as those of a vessel or a bore, that keeps away from their borders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CentrelineDoc {
    /// Id of the volume layer.
    pub volume: String,
    /// Where it begins, scene coordinates.
    pub from: [f64; 3],
    /// Where it ends, scene coordinates.
    pub to: [f64; 3],
    /// Least and greatest value of the voxels that it may use; by default those on the side of the histogram's threshold on which
    /// both points lie.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub values: Option<[f64; 2]>,
}

/// Camera of a path preview, scene units.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LensDoc {
    /// Distance behind the position as from which what lies ahead is seen, and of viewpoints behind turns, > 0; the length of the preview by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub behind_m: Option<f64>,
    /// Width of the picture at the position, > 0; a quarter of the length of the preview by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width_m: Option<f64>,
    /// Height over the path as from which it is seen, >= 0; a tenth of the length of the preview by default over terrain and between boxes, else 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rise_m: Option<f64>,
}

/// A fly-through: exactly one of `along`, `camera`, `sweep`, `turntable`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AnimationDoc {
    /// Line layer to follow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<String>,
    /// JSON file of cameras to pass through: a list of `{ "eye": [x,y,z], "look_at": [x,y,z] }`, each with `up` and `fov_y_deg` if wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
    /// Sweep of the viewing angle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepDoc>,
    /// Turn about the pivot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turntable: Option<TurntableDoc>,
    /// Layer that moves and is followed: eye and target move with the middle of it, of a molecule with `select` with that of the selection,
    /// without its quick motions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub follow: Option<String>,
    /// Number of frames, > 0; by default 250, or as many as speed, sweep or turn need.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<u32>,
    /// Frames per second, > 0; 25 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Along a route: ground speed, metres per second of film; by default the whole route in all frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_mps: Option<f64>,
    /// Along a route: distance from its start at which the film begins, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_m: Option<f64>,
    /// Along a route: distance of the eye behind the walker, metres; 800 by default, less for routes below 10 km, at least 8 cells of
    /// the terrain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub behind_m: Option<f64>,
    /// Along a route: height of the eye over the ground below it and under the walker, metres; 500 by default, less for routes below 10 km,
    /// at least 5 cells of the terrain. Frames that need more to see the ground from above get more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub above_m: Option<f64>,
    /// Along a route: distance of the target ahead of the walker, metres; by default the camera tilts so that the walker lies in the lower
    /// third of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ahead_m: Option<f64>,
    /// Along a route: a mark at the walker, seen through where ground hides it; `false` by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub marker: Option<bool>,
    /// Along a route: the time at the walker, where a GPX file gives times; `false` by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock: Option<bool>,
    /// Along a route: a strip with the heights of the route and the walker's place; `false` by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<bool>,
}

/// Sweep of the viewing angle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepDoc {
    /// First, last, step; degrees.
    pub phi_deg: [f64; 3],
}

/// Turn about the pivot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurntableDoc {
    /// Degrees per second, counter-clockwise seen from above.
    pub deg_per_s: f64,
}
