//! From stored samples of DICOM to values in the unit that the file means, such as Hounsfield units.

use super::Slice;
use super::image::Layout;
use crate::volume::Number;
use crate::{Fault, Limits, budget};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::VoxelValues;

/// Values of slices on their way to a volume.
pub(super) struct Values<'l> {
    layout: &'l Layout,
    out: VoxelValues,
}

impl<'l> Values<'l> {
    /// Room for slices of a layout. Whole values stay whole where 16 bits hold them.
    pub(super) fn new(layout: &'l Layout, slices: &[Slice], limits: &Limits) -> Result<Self, Fault> {
        let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
        let mut is_whole = true;
        for [slope, intercept] in slices.iter().map(|slice| slice.frame.rescale) {
            is_whole &= slope.fract() == 0.0 && intercept.fract() == 0.0;
            for stored in layout.range() {
                let value = slope * stored + intercept;
                (least, most) = (least.min(value), most.max(value));
            }
        }
        let fits = |low: f64, high: f64| is_whole && least >= low && most <= high;
        let count = (layout.columns as u64 * layout.rows as u64).saturating_mul(slices.len() as u64);
        // The frame in work, too, as stored and packed.
        let frame = 2 * layout.frame_bytes()? as u64;
        let room = |size: u64| limits.ask("the volume", count.saturating_mul(size).saturating_add(frame));
        let n = usize::try_from(count).unwrap_or(usize::MAX);
        let out = if fits(0.0, 255.0) {
            room(1)?;
            VoxelValues::U8(budget::room("the volume", n)?)
        } else if fits(f64::from(i16::MIN), f64::from(i16::MAX)) {
            room(2)?;
            VoxelValues::I16(budget::room("the volume", n)?)
        } else if fits(0.0, f64::from(u16::MAX)) {
            room(2)?;
            VoxelValues::U16(budget::room("the volume", n)?)
        } else {
            room(4)?;
            VoxelValues::F32(budget::room("the volume", n)?)
        };
        Ok(Self { layout, out })
    }

    /// Adds the samples of a frame.
    pub(super) fn push(&mut self, samples: &[u8], [slope, intercept]: [f64; 2]) {
        let layout = self.layout;
        let size = layout.allocated / 8;
        let pixels = samples.chunks_exact(size * layout.samples);
        let values = pixels.map(|pixel| slope * layout.value(pixel) + intercept);
        match &mut self.out {
            VoxelValues::U8(out) => out.extend(values.map(|v| v as u8)),
            VoxelValues::I16(out) => out.extend(values.map(|v| v as i16)),
            VoxelValues::U16(out) => out.extend(values.map(|v| v as u16)),
            VoxelValues::F32(out) => {
                out.extend(values.map(|v| v.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32));
            }
        }
    }

    /// Type of the samples in the file.
    pub(super) fn number(&self) -> Number {
        match (self.layout.allocated, self.layout.signed) {
            (8, false) => Number::UInt8,
            (8, true) => Number::Int8,
            (16, false) => Number::UInt16,
            (16, true) => Number::Int16,
            (_, false) => Number::UInt32,
            (_, true) => Number::Int32,
        }
    }

    pub(super) fn finish(self) -> VoxelValues {
        self.out
    }

    /// A warning about pixels whose values are not what is seen.
    pub(super) fn warning(&self) -> Option<Warning> {
        if self.layout.samples > 1 {
            return Some(Warning::new(WarningKind::Ignored, "its pixels are colours; their brightness is taken"));
        }
        let text = "its low values are meant to be shown bright (MONOCHROME1); values stay as they are";
        (self.layout.photometric == "MONOCHROME1").then(|| Warning::new(WarningKind::Ignored, text))
    }
}

impl Layout {
    /// Least and greatest number that a sample can hold.
    fn range(&self) -> [f64; 2] {
        let bits = self.stored as i32;
        if self.signed {
            let half = 2f64.powi(bits - 1);
            [-half, half - 1.0]
        } else {
            [0.0, 2f64.powi(bits) - 1.0]
        }
    }

    /// The number in a pixel, little-endian.
    fn value(&self, pixel: &[u8]) -> f64 {
        if self.samples == 3 {
            return self.brightness(pixel);
        }
        let raw = pixel.iter().rev().fold(0u32, |all, byte| all << 8 | u32::from(*byte));
        // The bits that count come first, then the sign is carried on.
        let top = raw << (31 - self.high_bit);
        let shift = 32 - self.stored;
        if self.signed { f64::from(top as i32 >> shift) } else { f64::from(top >> shift) }
    }

    /// Brightness of a colour (ITU-R BT.601).
    fn brightness(&self, pixel: &[u8]) -> f64 {
        let [a, b, c] = [0, 1, 2].map(|i| f64::from(pixel.get(i).copied().unwrap_or(0)));
        // Of a YCbCr that is stored as it is the first sample is the brightness.
        if self.photometric.starts_with("YBR") { a } else { (0.299 * a + 0.587 * b + 0.114 * c).round() }
    }
}
