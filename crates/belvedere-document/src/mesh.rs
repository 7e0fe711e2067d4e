//! Layers of triangles in the scene document.

use super::common::{Paths, TransformDoc, is_false, is_opaque};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Triangles from a file: OBJ, PLY, STL, glTF or GLB.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file, several, or `builtin:church`.
    pub source: Paths,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// Names of parts (nodes, objects, groups), separated by commas, that `must_see` means; by default the whole mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub select: Option<String>,
    /// Whether bends carry each part of the file (node, object, group; without parts the mesh) as a rigid body: moved and turned as a whole with the ground under its foot, so that walls stay straight
    /// and nothing of it folds, however tall; neighbours may interpenetrate.
    #[serde(default, skip_serializing_if = "is_false")]
    pub rigid: bool,
    /// How it is drawn.
    #[serde(default)]
    pub style: MeshStyleDoc,
    /// Placement; either this or `crs`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDoc>,
    /// `EPSG:n` of the file's x and y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crs: Option<String>,
    /// Movement: a CSV file of rows `t,x,y,z[,yaw_deg]` (seconds, scene coordinates): where the layer's own origin is, after `transform`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<String>,
}

impl MeshDoc {
    /// A file in the usual style.
    pub fn of(id: String, source: &str) -> Self {
        Self {
            id,
            source: Paths::One(source.to_owned()),
            must_see: false,
            select: None,
            rigid: false,
            style: MeshStyleDoc::default(),
            transform: None,
            crs: None,
            motion: None,
        }
    }
}

/// How a mesh is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MeshStyleDoc {
    /// Colour of meshes that have none of their own.
    pub color: String,
    /// Opacity, 0..=1: below 1 what is behind is seen through, at 0 the layer is not drawn.
    #[serde(skip_serializing_if = "is_opaque")]
    pub opacity: f64,
    /// Whether normals of the file smooth the shading.
    pub smooth: bool,
    /// Ambient occlusion: how far away something may be that takes light, scene units, > 0. Computed when the scene is opened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient_occlusion: Option<f64>,
}

impl Default for MeshStyleDoc {
    fn default() -> Self {
        Self { color: "#c9c2b8".into(), opacity: 1.0, smooth: true, ambient_occlusion: None }
    }
}
