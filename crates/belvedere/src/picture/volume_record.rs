//! Record of the volumes of a picture.

use belvedere_scene::{Scene, VolumeLayer};
use serde::Serialize;

/// How a volume was drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VolumeRecord {
    /// Id of the layer.
    pub layer: String,
    /// Name of the transfer function.
    pub transfer: String,
    /// Its points: value, red, green, blue (0..=255), opacity per reference step.
    pub points: Vec<[f64; 5]>,
    /// Distance to which opacities refer, voxel edges.
    pub reference_step: f64,
    /// Distance between samples, voxel edges.
    pub step: f64,
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Type of the values.
    pub values: &'static str,
    /// Least and greatest value.
    pub range: [f32; 2],
}

impl VolumeRecord {
    /// The volumes of a scene.
    pub(super) fn all(scene: &Scene) -> Vec<Self> {
        let records = scene.layers.iter().filter_map(|layer| layer.kind.volume().map(|v| Self::of(&layer.id, v)));
        records.collect()
    }

    fn of(id: &str, layer: &VolumeLayer) -> Self {
        let points = layer.transfer.points().iter().map(|p| {
            let [r, g, b] = [p.color.r, p.color.g, p.color.b].map(f64::from);
            [p.value, r, g, b, p.opacity]
        });
        Self {
            layer: id.to_owned(),
            transfer: layer.transfer.name().to_owned(),
            points: points.collect(),
            reference_step: layer.transfer.reference_step(),
            step: layer.step,
            dims: layer.volume.dims(),
            values: layer.volume.values().type_name(),
            range: layer.volume.range(),
        }
    }
}
