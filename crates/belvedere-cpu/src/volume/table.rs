//! Transfer functions tabulated: linear light and the opacity of one step, by value.

use crate::simd::nearest;
use belvedere_composite::color::{Rgb, linear_of};
use belvedere_scene::volume::absorbed;
use belvedere_scene::{TransferFunction, VolumeLayer};
use glam::Vec3A;

/// Number of entries: a ramp over a hundredth of the range has forty.
pub(super) const ENTRIES: usize = 4096;

/// Linear red, green, blue of a value, and the opacity of a reference step.
pub(super) fn light_and_opacity(transfer: &TransferFunction, value: f64) -> ([f32; 3], f64) {
    let [r, g, b, _] = transfer.at(value);
    let rgb: Rgb = linear_of([r, g, b].map(|c| c as f32));
    (rgb.to_array(), transfer.opacity(value))
}

/// Parts of a step that the table is made for: a step takes the longest ones over which values change little.
pub(super) const PARTS: u32 = 8;

/// What the table holds for a value.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Entry {
    /// Opacity of a part of a step, and its change to the next entry.
    alpha: f32,
    change: f32,
    /// Numbers of entries that are not transparent: before this one, and up to the next one.
    before: u32,
    after: u32,
}

impl Entry {
    /// Whether anything between two values is visible.
    ///
    /// * `self`, `other`: entries at or just before the values.
    #[inline(always)]
    pub(super) fn sees(&self, other: &Self) -> bool {
        self.after.max(other.after) > self.before.min(other.before)
    }
}

/// Colour and opacity by value.
pub(super) struct Table {
    entries: Box<[Entry; ENTRIES]>,
    /// Linear red, green, blue.
    colors: Box<[Vec3A; ENTRIES]>,
    /// Maps a value to an index: `(value - least) * scale`.
    pub(super) least: f32,
    pub(super) scale: f32,
    /// Number of entries before this one that are not transparent.
    visible_before: Vec<u32>,
}

impl Table {
    pub(super) fn new(layer: &VolumeLayer) -> Self {
        let [lo, hi] = layer.volume.range().map(f64::from);
        let per_entry = (hi - lo) / (ENTRIES - 1) as f64;
        let steps = layer.step_length() / layer.reference_length() / f64::from(PARTS);
        let mut entries = Box::new([Entry::default(); ENTRIES]);
        let mut colors = Box::new([Vec3A::ZERO; ENTRIES]);
        let mut visible_before = vec![0; ENTRIES + 1];
        for i in 0..ENTRIES {
            let (rgb, opacity) = light_and_opacity(&layer.transfer, lo + per_entry * i as f64);
            colors[i] = Vec3A::from_array(rgb);
            entries[i].alpha = absorbed(opacity, steps) as f32;
            visible_before[i + 1] = visible_before[i] + u32::from(entries[i].alpha > 0.0);
        }
        for i in 0..ENTRIES {
            entries[i].change = entries.get(i + 1).map_or(0.0, |next| next.alpha - entries[i].alpha);
            (entries[i].before, entries[i].after) = (visible_before[i], visible_before[(i + 2).min(ENTRIES)]);
        }
        let scale = if per_entry > 0.0 { (1.0 / per_entry) as f32 } else { 0.0 };
        Self { entries, colors, least: lo as f32, scale, visible_before }
    }

    /// Number of the entry at or just before an index, perhaps the one before for a whole one, which gives the same.
    ///
    /// * `at`: 0 to [`ENTRIES`] - 1.
    #[inline(always)]
    pub(super) fn number(at: f32) -> usize {
        nearest(at - 0.5).max(0) as usize & (ENTRIES - 1)
    }

    #[inline(always)]
    pub(super) fn entry(&self, number: usize) -> &Entry {
        &self.entries[number & (ENTRIES - 1)]
    }

    /// Opacity of a part of a step, and linear colour, at an index.
    #[inline(always)]
    pub(super) fn at(&self, at: f32) -> (f32, Vec3A) {
        let number = Self::number(at);
        let entry = self.entries[number];
        (entry.alpha + (at - number as f32) * entry.change, self.colors[number])
    }

    /// Whether any value of a range is visible.
    pub(super) fn is_visible(&self, [lo, hi]: [f32; 2]) -> bool {
        let place = |v: f32| (((v - self.least) * self.scale) as i64).clamp(0, ENTRIES as i64 - 1) as usize;
        let (first, last) = (place(lo).saturating_sub(1), (place(hi) + 2).min(ENTRIES));
        self.visible_before[last] > self.visible_before[first]
    }
}
