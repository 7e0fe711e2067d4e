//! A volume prepared for many rays.

use super::bricks::Leaps;
use super::light::SURFACE;
use super::table::Table;
use belvedere_scene::{Volume, VolumeLayer};
use glam::Mat3A;

/// A volume prepared for many rays.
pub(super) struct Prepared<'v> {
    pub(super) layer: &'v VolumeLayer,
    pub(super) table: Table,
    pub(super) leaps: Leaps,
    /// Distance of samples, scene units.
    pub(super) step: f64,
    /// Matrix from lattice gradients to scene normals, per voxel edge.
    pub(super) normal_from_gradient: Mat3A,
    /// Squared gradient per voxel edge at which a sample counts as half a surface.
    pub(super) surface_squared: f32,
}

impl<'v> Prepared<'v> {
    pub(super) fn new(layer: &'v VolumeLayer) -> Self {
        let volume = &*layer.volume;
        let table = Table::new(layer);
        let leaps = Leaps::new(volume, &table);
        let [lo, hi] = volume.range();
        let inverse_transposed = volume.lattice_axes().transpose() * volume.voxel_edge();
        let surface = (SURFACE * (hi - lo)).max(f32::MIN_POSITIVE);
        Self {
            layer,
            table,
            leaps,
            step: layer.step_length(),
            normal_from_gradient: Mat3A::from_cols_array(&inverse_transposed.to_cols_array().map(|v| v as f32)),
            surface_squared: surface * surface,
        }
    }

    pub(super) fn volume(&self) -> &'v Volume {
        &self.layer.volume
    }
}
