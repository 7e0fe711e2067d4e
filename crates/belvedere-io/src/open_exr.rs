//! OpenEXR: pictures of any number of channels, 32-bit float or unsigned.

use crate::{IoError, atomic};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec, Text,
    WritableImage,
};
use std::io::{self, Cursor};
use std::path::Path;

/// Samples of a channel, row-major, row 0 on top.
#[derive(Debug, Clone, PartialEq)]
pub enum Channel {
    /// 32-bit floats; infinity and NaN stay.
    Float(Vec<f32>),
    /// 32-bit unsigned integers.
    Uint(Vec<u32>),
}

/// Writes named channels (letters, digits, dots) into one layer, without loss, see [`atomic::write_atomic`].
/// `text` adds attributes to the header.
///
/// # Errors
/// [`IoError::Exists`], [`IoError::Os`]; among the latter a channel that has not `width * height` samples.
pub fn write(
    path: &Path,
    overwrite: bool,
    width: usize,
    height: usize,
    channels: Vec<(String, Channel)>,
    text: &[(&str, &str)],
) -> Result<(), IoError> {
    let bytes = encode(width, height, channels, text).map_err(|e| IoError::os(path, e))?;
    atomic::write_atomic(path, overwrite, |out| out.write_all(&bytes))
}

fn encode(width: usize, height: usize, channels: Vec<(String, Channel)>, text: &[(&str, &str)]) -> io::Result<Vec<u8>> {
    let mut list: SmallVec<[AnyChannel<FlatSamples>; 4]> = SmallVec::new();
    for (name, samples) in channels {
        let (count, samples) = match samples {
            Channel::Float(v) => (v.len(), FlatSamples::F32(v)),
            Channel::Uint(v) => (v.len(), FlatSamples::U32(v)),
        };
        if count != width * height || count == 0 {
            let reason = format!(
                "channel {name} has {count} samples, an EXR of {width} x {height} pixels needs as many as pixels"
            );
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        list.push(AnyChannel::new(name.as_str(), samples));
    }
    let mut attributes = LayerAttributes::default();
    for (key, value) in text {
        attributes.other.insert(Text::from(*key), AttributeValue::Text(Text::from(*value)));
    }
    let layer = Layer::new((width, height), attributes, Encoding::FAST_LOSSLESS, AnyChannels::sort(list));
    let mut bytes = Vec::new();
    Image::from_layer(layer).write().non_parallel().to_buffered(Cursor::new(&mut bytes)).map_err(io::Error::other)?;
    Ok(bytes)
}
