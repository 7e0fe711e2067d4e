//! Arrays of NumPy (.npy). Source: NumPy enhancement proposal 1 and the documentation of numpy.lib.format, versions 1 to 3.

use super::{ByteOrder, Number, Source, VolumeFile, odd_values, unspaced};
use crate::{Fault, Loaded, budget};
use glam::DVec3;
use std::borrow::Cow;

/// First bytes of a file.
const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header.
const MAX_HEADER: usize = 1 << 20;

/// What the header says.
struct Header<'b> {
    descr: &'b str,
    fortran: bool,
    shape: Vec<u64>,
    end: usize,
}

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, Fault> {
    let header = Header::of(source.bytes)?;
    let (number, order) = sample_type(header.descr)?;
    let dims = header.dims()?;
    let data = &source.bytes[header.end..];
    let expected = source.expected(dims, number, data.len(), false)?;
    let bytes = if header.fortran {
        let peak = (expected / number.bytes()) as u64 * number.peak_bytes() + expected as u64;
        source.request.limits.ask("the volume", peak)?;
        Cow::Owned(turned(&data[..expected], dims, number.bytes())?)
    } else {
        Cow::Borrowed(&data[..expected])
    };
    let (values, changed) = number.decode(bytes, order);
    let (axes, said) = unspaced(source.request);
    let (format, origin) = ("NumPy array", DVec3::ZERO);
    let file = VolumeFile { format, array: None, stored: number, dims, axes, origin, values };
    let said = said.into_iter().map(|w| w.in_file(source.path));
    Ok(Loaded::new(file, said.chain(odd_values(source.path, &changed)).collect()))
}

/// Samples with x fastest of those with z fastest.
fn turned(data: &[u8], [nx, ny, nz]: [usize; 3], size: usize) -> Result<Vec<u8>, budget::Refusal> {
    let mut out = budget::room("the volume", data.len())?;
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let at = ((x * ny + y) * nz + z) * size;
                out.extend_from_slice(&data[at..at + size]);
            }
        }
    }
    Ok(out)
}

/// The type of samples and their order of bytes.
fn sample_type(descr: &str) -> Result<(Number, ByteOrder), String> {
    let (order, kind) = match descr.split_at_checked(1) {
        Some((">", kind)) => (ByteOrder::Big, kind),
        Some(("<" | "|" | "=", kind)) => (ByteOrder::Little, kind),
        _ => (ByteOrder::Little, descr),
    };
    let number = match kind {
        "b1" | "u1" => Number::UInt8,
        "i1" => Number::Int8,
        "u2" => Number::UInt16,
        "i2" => Number::Int16,
        "u4" => Number::UInt32,
        "i4" => Number::Int32,
        "u8" => Number::UInt64,
        "i8" => Number::Int64,
        "f2" => Number::Float16,
        "f4" => Number::Float32,
        "f8" => Number::Float64,
        _ => {
            let what = match kind.get(..1) {
                Some("c") => "complex numbers",
                Some("O") => "objects of Python",
                Some("U" | "S") => "texts",
                Some("M" | "m") => "times",
                _ => "no plain numbers",
            };
            return Err(format!(
                "its samples are {what} ({descr:.40}), which are not read; save a.astype('float32') or other plain numbers"
            ));
        }
    };
    Ok((number, order))
}

impl<'b> Header<'b> {
    fn of(bytes: &'b [u8]) -> Result<Self, String> {
        let rest = bytes.strip_prefix(MAGIC).ok_or("it does not begin with \\x93NUMPY; it is no NumPy array")?;
        let cut = || "it ends within its header; it is cut off".to_owned();
        let version = *rest.first().ok_or_else(cut)?;
        let (length, start) = match (version, rest) {
            (1, &[_, _, a, b, ..]) => (usize::from(u16::from_le_bytes([a, b])), 10),
            (2 | 3, &[_, _, a, b, c, d, ..]) => (u32::from_le_bytes([a, b, c, d]) as usize, 12),
            (1..=3, _) => return Err(cut()),
            _ => return Err(format!("its version is {version}, 1 to 3 are read; save it with numpy.save")),
        };
        if length > MAX_HEADER {
            return Err(format!("its header has {length} bytes, at most {MAX_HEADER} are possible; it is damaged"));
        }
        let end = start + length;
        let text = std::str::from_utf8(bytes.get(start..end).ok_or_else(cut)?);
        let text = text.map_err(|_| "its header is no text; it is damaged")?;
        let after = |key: &str| {
            let (_, rest) = text.split_once(&format!("'{key}'"))?;
            Some(rest.trim_start().strip_prefix(':')?.trim_start())
        };
        let bad = |key: &str| format!("its header has no {key} that can be read; it is damaged");
        let descr = after("descr").ok_or_else(|| bad("descr"))?;
        if descr.starts_with('[') {
            return Err("its samples have several fields, single values are needed; save one of them, a['name']".into());
        }
        let descr = descr.strip_prefix('\'').and_then(|d| d.split_once('\'')).ok_or_else(|| bad("descr"))?.0;
        let fortran = match after("fortran_order") {
            Some(value) if value.starts_with("True") => true,
            Some(value) if value.starts_with("False") => false,
            _ => return Err(bad("fortran_order")),
        };
        let shape = after("shape").and_then(|s| s.strip_prefix('(')).and_then(|s| s.split_once(')'));
        let sizes = shape.ok_or_else(|| bad("shape"))?.0.split(',').map(str::trim).filter(|s| !s.is_empty());
        let sizes: Result<Vec<u64>, _> = sizes.map(|s| s.trim_end_matches('L').parse()).collect();
        let mut shape = sizes.map_err(|_| bad("shape"))?;
        // Axes of one value alone say nothing.
        while shape.len() > 3
            && let Some(at) = shape.iter().position(|n| *n == 1)
        {
            shape.remove(at);
        }
        Ok(Self { descr, fortran, shape, end })
    }

    /// Voxels along x, y, z of a shape (z, y, x).
    fn dims(&self) -> Result<[usize; 3], String> {
        let shape: Vec<String> = self.shape.iter().take(8).map(u64::to_string).collect();
        let shape = format!("({})", shape.join(", "));
        match self.shape[..] {
            [z, y, x] if x > 0 && y > 0 && z > 0 => {
                let size = |n: u64| usize::try_from(n).map_err(|_| format!("its shape {shape} is too large"));
                Ok([size(x)?, size(y)?, size(z)?])
            }
            [_, _, _] => Err(format!("its shape {shape} holds no values; a volume has some along z, y and x")),
            [_, _] => Err(format!(
                "its shape is {shape}, a volume has 3 dimensions (z, y, x); heights are given as GeoTIFF with their place, or in Python as an array"
            )),
            _ => Err(format!(
                "its shape is {shape}, a volume of single values has 3 dimensions (z, y, x); save one part of it, such as a[0]"
            )),
        }
    }
}
