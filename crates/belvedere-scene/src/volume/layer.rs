//! A volume and how it is drawn.

use super::{BRICK, TransferFunction, Volume};
use belvedere_core::{Aabb, DVec3};
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

    /// Positions of voxels that represent the visible part, scene units: the most opaque voxel of each visible brick, of an even selection
    /// of these bricks. Empty if nothing is visible.
    ///
    /// * `most`: largest number of positions, > 0.
    pub fn visible_voxels(&self, most: usize) -> Vec<DVec3> {
        let dims = self.volume.dims();
        let visible = self.visible_bricks();
        let every = visible.len().div_ceil(most.max(1)).max(1);
        let voxel = |brick: &[usize; 3]| {
            let span = |a: usize| brick[a] * BRICK..(brick[a] * BRICK + BRICK + 1).min(dims[a]);
            let mut best = (0.0, [0; 3]);
            for z in span(2) {
                for y in span(1) {
                    for x in span(0) {
                        let value = self.volume.values().at((z * dims[1] + y) * dims[0] + x);
                        let opacity = self.transfer.opacity(f64::from(value));
                        if opacity > best.0 {
                            best = (opacity, [x, y, z]);
                        }
                    }
                }
            }
            let (opacity, at) = best;
            (opacity > 0.0).then(|| self.volume.scene_from_lattice(DVec3::from_array(at.map(|n| n as f64))))
        };
        visible.iter().step_by(every).filter_map(voxel).collect()
    }

    /// Smallest box around the bricks in which anything is visible, scene coordinates; empty where nothing is.
    pub fn visible_bounds(&self) -> Aabb {
        let most = DVec3::from_array(self.volume.dims().map(|n| (n - 1) as f64));
        let corners = self.visible_bricks().into_iter().flat_map(|brick| {
            let min = DVec3::from_array(brick.map(|b| (b * BRICK) as f64));
            Aabb { min, max: (min + BRICK as f64).min(most) }.corners()
        });
        Aabb::of(corners.map(|q| self.volume.scene_from_lattice(q)))
    }

    /// The bricks in which anything is visible.
    fn visible_bricks(&self) -> Vec<[usize; 3]> {
        let bricks = self.volume.bricks();
        let [bx, by, _] = bricks.dims();
        let seen = |(_, [lo, hi]): &(usize, &[f32; 2])| self.transfer.most_opaque(f64::from(*lo), f64::from(*hi)) > 0.0;
        let visible = bricks.ranges().iter().enumerate().filter(seen);
        visible.map(|(i, _)| [i % bx, i / bx % by, i / bx / by]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Color, TransferPoint, VoxelValues};
    use belvedere_core::DMat3;

    #[test]
    fn what_is_visible_is_known_by_box_and_by_voxels() {
        let mut values = vec![0u8; 40 * 40 * 40];
        let at = |x: usize, y: usize, z: usize| (z * 40 + y) * 40 + x;
        (values[at(10, 20, 30)], values[at(11, 20, 30)], values[at(37, 20, 30)]) = (90, 120, 200);
        let volume = Volume::new([40; 3], DMat3::from_diagonal(DVec3::splat(0.5)), DVec3::X, VoxelValues::U8(values));
        let point = |value, opacity| TransferPoint { value, color: Color::rgb(0, 0, 0), opacity };
        let transfer = TransferFunction::new("test", vec![point(80.0, 0.0), point(255.0, 1.0)], 1.0).unwrap();
        let mut layer = VolumeLayer::new(volume.unwrap(), transfer);
        let scene = |x: f64, y: f64, z: f64| DVec3::X + 0.5 * DVec3::new(x, y, z);
        assert_eq!(layer.visible_voxels(9), [scene(11.0, 20.0, 30.0), scene(37.0, 20.0, 30.0)]);
        assert_eq!(layer.visible_voxels(1), [scene(11.0, 20.0, 30.0)]);
        let bounds = layer.visible_bounds();
        assert_eq!((bounds.min, bounds.max), (scene(8.0, 16.0, 24.0), scene(39.0, 24.0, 32.0)));
        layer.transfer = TransferFunction::new("none", vec![point(0.0, 0.0)], 1.0).unwrap();
        assert!(layer.visible_bounds().is_empty() && layer.visible_voxels(9).is_empty());
    }
}
