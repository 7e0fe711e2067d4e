//! Description of a volume file.

use crate::BelvedereError;
use belvedere_core::Warning;
use belvedere_io::{Number, VolumeRequest, load_volume};
use belvedere_resolve::volume::{made, one_value};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// A volume.
#[derive(Debug, Clone, JsonSchema, Serialize)]
pub struct VolumeInfo {
    /// The file.
    pub path: String,
    /// Format.
    pub format: &'static str,
    /// Name of the array that is read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub array: Option<String>,
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Type of the samples in the file.
    pub samples: Number,
    /// Spacing of the voxels along x, y, z.
    pub spacing: [f64; 3],
    /// Least and greatest value.
    pub range: [f32; 2],
    /// Smallest coordinates, in the file's own system.
    pub min: [f64; 3],
    /// Largest coordinates.
    pub max: [f64; 3],
    /// Warnings.
    pub warnings: Vec<Warning>,
}

impl VolumeInfo {
    /// # Errors
    /// [`BelvedereError::Io`] with the reason.
    pub(super) fn of(path: &Path) -> Result<Self, BelvedereError> {
        let loaded = load_volume(path, &VolumeRequest::default())?;
        let (format, array, samples) = (loaded.value.format, loaded.value.array.clone(), loaded.value.stored);
        let volume = made(loaded.value).map_err(|e| belvedere_io::IoError::format(path, e.to_string()))?;
        let (axes, bounds) = (volume.axes(), volume.bounds());
        Ok(Self {
            path: path.display().to_string(),
            format,
            array,
            dims: volume.dims(),
            samples,
            spacing: [axes.x_axis, axes.y_axis, axes.z_axis].map(|a| a.length()),
            range: volume.range(),
            min: bounds.min.to_array(),
            max: bounds.max.to_array(),
            warnings: loaded.warnings.into_iter().chain(one_value(&volume).map(|w| w.in_file(path))).collect(),
        })
    }
}
