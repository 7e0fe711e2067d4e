//! Slices of one size, piled up into a volume.

use super::number::Changed;
use super::{ByteOrder, Number};
use crate::raster::with_samples;
use crate::{Fault, Limits, Photometric, Raster, RasterInfo, SampleType, Samples, budget};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::VoxelValues;

/// What of a pixel becomes the value.
#[derive(Debug, Clone, PartialEq)]
enum Taken {
    /// The band of this index.
    Band(usize),
    /// The brightness of three bands.
    Brightness([usize; 3]),
    /// The brightness of colours of a palette.
    Palette(Vec<u8>),
}

/// Slices on their way to a volume.
pub(super) struct Pile {
    size: [usize; 2],
    bands: usize,
    sample_type: SampleType,
    taken: Taken,
    /// Samples so far, little-endian.
    bytes: Vec<u8>,
    /// Slices so far.
    slices: usize,
}

/// The type of samples of a raster.
fn number(of: SampleType) -> Number {
    match of {
        SampleType::I8 => Number::Int8,
        SampleType::U8 => Number::UInt8,
        SampleType::I16 => Number::Int16,
        SampleType::U16 => Number::UInt16,
        SampleType::I32 => Number::Int32,
        SampleType::U32 => Number::UInt32,
        SampleType::I64 => Number::Int64,
        SampleType::U64 => Number::UInt64,
        SampleType::F32 => Number::Float32,
        SampleType::F64 => Number::Float64,
    }
}

/// Brightness of a colour (ITU-R BT.601), in the range of its parts.
fn brightness([red, green, blue]: [u32; 3]) -> u32 {
    (299 * red + 587 * green + 114 * blue + 500) / 1000
}

impl Pile {
    /// Room for `slices` slices like the first, if the limits allow it.
    pub(super) fn new(first: &RasterInfo, slices: usize, limits: &Limits) -> Result<Self, Fault> {
        let taken = match &first.photometric {
            Photometric::Palette(colors) => {
                Taken::Palette(colors.iter().map(|c| brightness(c.map(u32::from)) as u8).collect())
            }
            Photometric::Rgb(bands) => match first.sample_type {
                SampleType::U8 | SampleType::U16 => Taken::Brightness(*bands),
                other => {
                    let name = other.name();
                    return Err(
                        format!("its colours are {name}, uint8 and uint16 are read; convert them to grey").into()
                    );
                }
            },
            _ => Taken::Band(0),
        };
        let of_type = number(first.sample_type);
        let pixels = (first.width as u64).saturating_mul(first.height as u64);
        let count = pixels.saturating_mul(slices as u64);
        let one = pixels.saturating_mul((first.bands * first.sample_type.size()) as u64);
        limits.ask("the volume", count.saturating_mul(of_type.peak_bytes()).saturating_add(one))?;
        let bytes = count.saturating_mul(of_type.bytes() as u64);
        let bytes = budget::room("the volume", usize::try_from(bytes).unwrap_or(usize::MAX))?;
        let (size, bands, sample_type) = ([first.width, first.height], first.bands, first.sample_type);
        Ok(Self { size, bands, sample_type, taken, bytes, slices: 0 })
    }

    /// Lays a slice on those that are there.
    pub(super) fn push(&mut self, slice: &Raster) -> Result<(), String> {
        let info = &slice.info;
        if ([info.width, info.height], info.bands, info.sample_type) != (self.size, self.bands, self.sample_type) {
            let ([w, h], bands, kind) = (self.size, self.bands, self.sample_type.name());
            return Err(format!(
                "has {} x {} pixels of {} {}, the first slice has {w} x {h} of {bands} {kind}; slices of a volume must be alike",
                info.width,
                info.height,
                info.bands,
                info.sample_type.name()
            ));
        }
        let (bytes, bands) = (&mut self.bytes, self.bands.max(1));
        let pixel = |i: usize, band: usize| i * bands + band;
        match (&self.taken, &slice.samples) {
            (Taken::Palette(grey), Samples::U8(v)) => {
                bytes.extend(v.iter().step_by(bands).map(|i| grey.get(usize::from(*i)).copied().unwrap_or(0)));
            }
            (Taken::Brightness(of), Samples::U8(v)) => bytes
                .extend((0..v.len() / bands).map(|i| brightness(of.map(|band| u32::from(v[pixel(i, band)]))) as u8)),
            (Taken::Brightness(of), Samples::U16(v)) => bytes.extend(
                (0..v.len() / bands)
                    .flat_map(|i| (brightness(of.map(|band| u32::from(v[pixel(i, band)]))) as u16).to_le_bytes()),
            ),
            (_, samples) => with_samples!(samples, v => {
                bytes.extend(v.iter().step_by(bands).flat_map(|sample| sample.to_le_bytes()));
            }),
        }
        self.slices += 1;
        Ok(())
    }

    /// Voxels along x, y, z, the type of their samples, and their values.
    pub(super) fn finish(self) -> ([usize; 3], Number, VoxelValues, Changed) {
        let number = number(self.sample_type);
        let [width, height] = self.size;
        let (values, changed) = number.decode(self.bytes, ByteOrder::Little);
        ([width, height, self.slices], number, values, changed)
    }

    /// A warning if more than the values of the file is in a pixel.
    pub(super) fn warning(&self) -> Option<Warning> {
        match (&self.taken, self.bands) {
            (Taken::Band(_), 1) => None,
            (Taken::Band(_), bands) => {
                let text = format!("it has {bands} values in each pixel; the first is taken");
                Some(Warning::new(WarningKind::Ignored, text).with("bands", bands as f64))
            }
            _ => Some(Warning::new(WarningKind::Ignored, "its pixels are colours; their brightness is taken")),
        }
    }
}
