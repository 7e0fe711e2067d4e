//! Layers of voxels in the scene document.

use super::common::TransformDoc;
use belvedere_scene::VolumeModel;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Voxels from a file: VTK XML ImageData (.vti), legacy VTK (.vtk), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI (.nii, .nii.gz),
/// MRC (.mrc, .map), NumPy (.npy), a TIFF stack (.tif), DICOM (.dcm), or raw samples (.raw, .raw.gz); or from a folder of slices or DICOM.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VolumeDoc {
    /// Unique id within the scene.
    pub id: String,
    /// A file, a folder of slices or of a series of DICOM, `builtin:engine` or `builtin:tube`.
    pub source: String,
    /// Name of the array in files that have several; by default the first of single values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub array: Option<String>,
    /// Colours and opacities by value: `auto`, `solid`, `engine`, `ct-bone`, `ct-soft`, `vessels`, `grey`, a file, or points,
    /// `points VALUE:#rrggbb:OPACITY ...`; `wall` for the wall
    /// around the path of a preview alone, which is also what `auto` means for a volume that holds most of such a path.
    #[serde(default = "auto")]
    pub transfer: String,
    /// Whether constructors and measures work for it.
    #[serde(default)]
    pub must_see: bool,
    /// Distance between samples along a ray, voxel edges, in [0.01, 8].
    #[serde(default = "half")]
    pub step: f64,
    /// How it is coloured.
    #[serde(default)]
    pub shading: VolumeModel,
    /// Placement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDoc>,
    /// Raw samples: how many along x, y, z; by default what the name tells, such as `engine_256x256x128_uint8.raw`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dims: Option<[usize; 3]>,
    /// Raw samples: their type, such as `uint8`, `int16`, `float32`; by default what the name tells.
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    pub sample_type: Option<String>,
    /// Distances along x, y, z of raw samples and of other files that state none, scene units, > 0; 1 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<[f64; 3]>,
    /// Raw samples of several bytes: whether the most significant comes first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub big_endian: Option<bool>,
}

impl VolumeDoc {
    /// A file in the usual style.
    pub fn of(id: String, source: &str) -> Self {
        Self {
            id,
            source: source.to_owned(),
            array: None,
            transfer: auto(),
            must_see: false,
            step: half(),
            shading: VolumeModel::default(),
            transform: None,
            dims: None,
            sample_type: None,
            spacing: None,
            big_endian: None,
        }
    }
}

fn auto() -> String {
    "auto".into()
}

fn half() -> f64 {
    0.5
}
