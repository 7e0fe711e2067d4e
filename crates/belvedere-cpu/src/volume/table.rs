//! Transfer functions tabulated: linear light and the opacity of one step, by value.

use belvedere_composite::color::{Rgb, linear_of};
use belvedere_scene::volume::absorbed;
use belvedere_scene::{TransferFunction, VolumeLayer};

/// Number of entries: a ramp over a hundredth of the range has forty.
pub(super) const ENTRIES: usize = 4096;

/// Linear red, green, blue of a value.
pub(super) fn light_of(transfer: &TransferFunction, value: f64) -> [f32; 3] {
    let [r, g, b, _] = transfer.at(value);
    let rgb: Rgb = linear_of([r, g, b].map(|c| c as f32));
    rgb.to_array()
}

/// Colour and opacity by value.
pub(super) struct Table {
    /// Opacity of a step, and its change to the next entry.
    pub(super) alphas: Box<[[f32; 2]; ENTRIES]>,
    /// Linear red, green, blue, and nothing.
    pub(super) colors: Box<[[f32; 4]; ENTRIES]>,
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
        let steps = layer.step_length() / layer.reference_length();
        let mut alphas = Box::new([[0.0; 2]; ENTRIES]);
        let mut colors = Box::new([[0.0; 4]; ENTRIES]);
        let mut visible_before = vec![0; ENTRIES + 1];
        for i in 0..ENTRIES {
            let value = lo + per_entry * i as f64;
            colors[i][..3].copy_from_slice(&light_of(&layer.transfer, value));
            alphas[i][0] = absorbed(layer.transfer.opacity(value), steps) as f32;
            visible_before[i + 1] = visible_before[i] + u32::from(alphas[i][0] > 0.0);
        }
        for i in 1..ENTRIES {
            alphas[i - 1][1] = alphas[i][0] - alphas[i - 1][0];
        }
        let scale = if per_entry > 0.0 { (1.0 / per_entry) as f32 } else { 0.0 };
        Self { alphas, colors, least: lo as f32, scale, visible_before }
    }

    /// Whether any value of a range is visible.
    pub(super) fn is_visible(&self, [lo, hi]: [f32; 2]) -> bool {
        let place = |v: f32| (((v - self.least) * self.scale) as i64).clamp(0, ENTRIES as i64 - 1) as usize;
        let (first, last) = (place(lo).saturating_sub(1), (place(hi) + 2).min(ENTRIES));
        self.visible_before[last] > self.visible_before[first]
    }
}
