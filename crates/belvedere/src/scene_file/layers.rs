//! Layers of the scene document.

use super::by_property::{ColorByDoc, SizeByDoc};
use super::city::CityDoc;
use super::common::{Paths, TransformDoc, is_false, is_opaque};
use super::mesh::MeshDoc;
use super::molecule::MoleculeDoc;
use super::overlay::AutoOrLength;
use super::palette::PaletteDoc;
use super::points::PointLayerDoc;
use super::volume::VolumeDoc;
use belvedere_scene::{Hidden, Relief, Shading};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// One layer.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum LayerDoc {
    /// Ground.
    Terrain(TerrainDoc),
    /// Polylines on the ground.
    Line(LineDoc),
    /// Polygons on the ground.
    Area(AreaDoc),
    /// Upright boxes: inline, or from a JSON or CSV file with the same names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxesDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A JSON file (a list of boxes), a CSV file (`x,y,z,size_x,size_y,size_z[,yaw_deg[,color]]`), or `builtin:street`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// The boxes themselves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boxes: Option<Vec<BoxDoc>>,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// Whether bends carry each box as a rigid body: moved and turned as a whole with the ground under its foot, so that walls stay straight
    /// and nothing of it folds, however tall; neighbours may interpenetrate.
    #[serde(default, skip_serializing_if = "is_false")]
    pub rigid: bool,
    /// How they are drawn.
    #[serde(default)]
    pub style: BoxStyleDoc,
    /// Moves all boxes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDoc>,
    /// Movement: a CSV file of rows `t,x,y,z[,yaw_deg]` (seconds, scene coordinates): where the layer's own origin is, after `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<String>,
}

/// How boxes are drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoxStyleDoc {
    /// Colour of boxes that have none of their own.
    pub color: String,
    /// Opacity, 0..=1: below 1 what is behind is seen through, at 0 the layer is not drawn.
    #[serde(skip_serializing_if = "is_opaque")]
    pub opacity: f64,
}

impl Default for BoxStyleDoc {
    fn default() -> Self {
        Self { color: "#c9c2b8".into(), opacity: 1.0 }
    }
}

/// One upright box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxDoc {
    /// Centre of the base, scene coordinates.
    pub base: [f64; 3],
    /// Full extents along its own x, its own y, and z, scene units, > 0.
    pub size: [f64; 3],
    /// Rotation about z, degrees counter-clockwise.
    #[serde(default)]
    pub yaw_deg: f64,
    /// Colour of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
}
