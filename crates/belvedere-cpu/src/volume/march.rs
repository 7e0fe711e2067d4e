//! Fast ray marching: rays side by side, with empty-space skipping.

use super::Gathered;
use super::clip::Segment;
use super::packet::Packet;
use super::prepared::Prepared;
use super::sampler::{Sampler, Voxel};
use super::spans::Spans;
use crate::simd;
use belvedere_core::View;
use belvedere_scene::{Volume, VolumeLayer, VoxelValues};
use belvedere_sight::volume::ENOUGH;

/// Follows rays through a volume.
pub(super) struct Marcher<'v>(Prepared<'v>);

impl<'v> Marcher<'v> {
    pub(super) fn new(layer: &'v VolumeLayer) -> Self {
        Self(Prepared::new(layer))
    }

    /// Whether no part of the volume is visible.
    pub(super) fn is_clear(&self) -> bool {
        self.0.leaps.is_clear()
    }

    /// The pixels of a view that may show it.
    pub(super) fn spans(&self, view: &View) -> Spans {
        Spans::new(view, self.volume(), &self.0.leaps)
    }

    pub(super) fn volume(&self) -> &'v Volume {
        self.0.volume()
    }

    /// Switches empty-space skipping off.
    #[cfg(test)]
    pub(super) fn forget_leaps(&mut self) {
        self.0.leaps.forget();
    }

    /// Light gathered by rays along their segments.
    ///
    /// * `ends`: for each ray the number of segments before its end. `within`: the place of its samples within their steps, 0..=1.
    pub(super) fn gather(&self, segments: &[Segment], ends: &[usize], within: &[f64]) -> Vec<Gathered> {
        let volume = self.volume();
        match volume.values() {
            VoxelValues::U8(v) => self.gather_in(Sampler::new(volume, v), (segments, ends, within)),
            VoxelValues::U16(v) => self.gather_in(Sampler::new(volume, v), (segments, ends, within)),
            VoxelValues::I16(v) => self.gather_in(Sampler::new(volume, v), (segments, ends, within)),
            VoxelValues::F32(v) => self.gather_in(Sampler::new(volume, v), (segments, ends, within)),
        }
    }

    fn gather_in<T: Voxel>(
        &self,
        sampler: Sampler<'_, T>,
        (segments, ends, within): (&[Segment], &[usize], &[f64]),
    ) -> Vec<Gathered> {
        let mut out = vec![Gathered::default(); ends.len()];
        simd::run(Packet { prepared: &self.0, sampler, segments, ends, within, out: &mut out });
        for ray in out.iter_mut().filter(|ray| ray.alpha >= ENOUGH) {
            ray.color /= ray.alpha;
            ray.alpha = 1.0;
        }
        out
    }
}
