//! Raw samples without a header: file name and scene state their layout.

use super::{ByteOrder, Number, Source, VolumeFile, gunzip, odd_values};
use crate::{Fault, Loaded};
use glam::{DMat3, DVec3};

/// Layout of raw samples in a file; missing values are taken from a name such as `engine_256x256x128_uint8.raw.gz`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RawLayout {
    /// Samples along x, y, z, x fastest.
    pub dims: Option<[usize; 3]>,
    /// Type of the samples.
    pub number: Option<Number>,
    /// Distances between samples, also of other files that state none; 1 where not given.
    pub spacing: Option<[f64; 3]>,
    /// Order of the bytes; little-endian where not given.
    pub order: Option<ByteOrder>,
}

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, Fault> {
    let name = source.path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let (named_dims, named_number) = told_by(&name);
    let layout = &source.request.raw;
    let dims = layout.dims.or(named_dims).ok_or(
        "raw samples do not say how many they are; give dims = [x, y, z], or a name such as engine_256x256x128_uint8.raw",
    )?;
    let number = layout.number.or(named_number).ok_or(
        "raw samples do not say their type; give type = \"uint8\", \"uint16\", \"int16\" or \"float32\", or a name such as engine_256x256x128_uint8.raw",
    )?;
    let packed = source.bytes.starts_with(&[0x1f, 0x8b]);
    let expected = source.expected(dims, number, source.bytes.len(), packed)?;
    let bytes = if packed {
        gunzip(source.bytes, expected)?
    } else if source.bytes.len() == expected {
        source.bytes.to_vec()
    } else {
        return Err(format!(
            "{} x {} x {} samples of {number} are {expected} bytes, the file has {}; check dims and type",
            dims[0],
            dims[1],
            dims[2],
            source.bytes.len()
        )
        .into());
    };
    let (values, changed) = number.decode(bytes, layout.order.unwrap_or_default());
    let axes = DMat3::from_diagonal(DVec3::from_array(layout.spacing.unwrap_or([1.0; 3])));
    let (format, origin) = ("raw", DVec3::ZERO);
    let file = VolumeFile { format, array: None, stored: number, dims, axes, origin, values };
    Ok(Loaded::new(file, odd_values(source.path, &changed)))
}

/// Dimensions and type from a name such as `engine_256x256x128_uint8.raw`.
fn told_by(name: &str) -> (Option<[usize; 3]>, Option<Number>) {
    let words = || name.split(['_', '.', '-', ' ']);
    let dims = words().find_map(|w| {
        let sizes: Vec<usize> = w.split('x').map(str::parse).collect::<Result<_, _>>().ok()?;
        <[usize; 3]>::try_from(sizes).ok()
    });
    (dims, words().find_map(Number::named))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_dimensions_and_type() {
        assert_eq!(told_by("engine_256x256x128_uint8.raw.gz"), (Some([256, 256, 128]), Some(Number::UInt8)));
        assert_eq!(told_by("fuel-64x64x64-float.raw"), (Some([64; 3]), Some(Number::Float32)));
        assert_eq!(told_by("64x64_data.raw"), (None, None));
    }
}
