//! A volume and how it is drawn.

use super::{TransferFunction, Volume};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Default distance between samples along a ray, voxel edges.
const DEFAULT_STEP: f64 = 0.5;

/// How samples of a volume are coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum VolumeModel {
    /// By the transfer function, shaded by the gradient of the values in light that comes from the eye along the ray.
    #[default]
    Shaded,
    /// By the transfer function alone.
    Plain,
}

/// A volume layer.
#[derive(Debug, Clone)]
pub struct VolumeLayer {
    /// The voxels. Shared, so that copies of a scene do not copy them.
    pub volume: Arc<Volume>,
    /// Colours and opacities.
    pub transfer: TransferFunction,
    /// Distance between samples along a ray, voxel edges, > 0.
    pub step: f64,
    /// Shading.
    pub model: VolumeModel,
}

impl VolumeLayer {
    /// A volume in the usual style: shaded, two samples to a voxel.
    pub fn new(volume: impl Into<Arc<Volume>>, transfer: TransferFunction) -> Self {
        Self { volume: volume.into(), transfer, step: DEFAULT_STEP, model: VolumeModel::default() }
    }

    /// Distance between samples, scene units.
    pub fn step_length(&self) -> f64 {
        self.step * self.volume.voxel_edge()
    }

    /// Distance that opacities are stated for, scene units.
    pub fn reference_length(&self) -> f64 {
        self.transfer.reference_step() * self.volume.voxel_edge()
    }
}
