//! VTK XML ImageData (.vti). Source: "VTK File Formats", Kitware, section XML.

use super::vti_header::{Array, Encoding, Header};
use super::vti_stream::Stream;
use super::{Source, VolumeFile, odd_values};
use crate::base64::Base64;
use crate::{Fault, Loaded};
use glam::{DMat3, DVec3};

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, Fault> {
    let (xml, appended) = parts(source.bytes)?;
    let header = Header::parse(xml)?;
    let extent = header.extent.ok_or("it has no WholeExtent; it is damaged")?;
    match header.pieces {
        1 => {}
        0 => return Err("it has no piece; it is damaged".into()),
        n => return Err(format!("it has {n} pieces, one is read; write it from ParaView as a single piece").into()),
    }
    let piece = header.piece.unwrap_or(extent);
    let array = header.choose(source.request.array.as_deref())?;
    let number = array.number.ok_or_else(|| {
        format!(
            "array \"{}\" is of type {:?}, which is not read; convert it to a number type",
            array.name, array.type_name
        )
    })?;
    let points: [usize; 3] = std::array::from_fn(|a| (piece[2 * a + 1] - piece[2 * a]) as usize + 1);
    let dims = if array.of_cells { points.map(|n| n - 1) } else { points };
    let packed = match header.compressor.as_deref() {
        None => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => {
            let other: String = other.chars().take(40).collect();
            return Err(format!(
                "its data are compressed by {other}, only vtkZLibDataCompressor is read; write it again with zlib"
            )
            .into());
        }
    };
    let stored = match array.encoding {
        Encoding::Appended(_) => source.bytes.len(),
        Encoding::Ascii | Encoding::Inline => array.text.len(),
    };
    let expected = source.expected(dims, number, stored, packed || array.encoding == Encoding::Ascii)?;
    let (values, changed) = match array.encoding {
        Encoding::Ascii => number.parse(&array.text, expected / number.bytes())?,
        _ => {
            let bytes = stream(array, appended)?.array(expected, packed, header.wide, header.order)?;
            number.decode(bytes, header.order)
        }
    };
    let (axes, origin) = place(&header, piece, array.of_cells);
    let array = Some(array.name.clone());
    let file = VolumeFile { format: "VTK XML ImageData", array, stored: number, dims, axes, origin, values };
    Ok(Loaded::new(file, odd_values(source.path, &changed)))
}

/// Data after the XML.
struct Appended<'a> {
    bytes: &'a [u8],
    base64: bool,
}

/// The XML before the appended data, and these.
fn parts(bytes: &[u8]) -> Result<(&str, Option<Appended<'_>>), String> {
    const TAG: &[u8] = b"<AppendedData";
    let start = bytes.windows(TAG.len()).position(|w| w == TAG);
    let (xml, appended) = match start {
        None => (bytes, None),
        Some(start) => {
            let close = bytes[start..]
                .iter()
                .position(|b| *b == b'>')
                .ok_or("its AppendedData tag has no end; it is cut off")?;
            let tag = String::from_utf8_lossy(&bytes[start..start + close]);
            let rest = &bytes[start + close..];
            let first =
                rest.iter().position(|b| *b == b'_').ok_or("its appended data do not begin with _; it is damaged")?;
            (&bytes[..start], Some(Appended { bytes: &rest[first + 1..], base64: tag.contains("base64") }))
        }
    };
    let xml = std::str::from_utf8(xml)
        .map_err(|e| format!("byte {} of its XML is no UTF-8 text; it is damaged", e.valid_up_to()))?;
    Ok((xml, appended))
}

fn stream<'a>(array: &'a Array, appended: Option<Appended<'a>>) -> Result<Stream<'a>, String> {
    let Encoding::Appended(offset) = array.encoding else {
        return Ok(Stream::Base64(Base64::new(array.text.as_bytes())));
    };
    let Appended { bytes, base64 } =
        appended.ok_or("its array is appended and it has no appended data; it is cut off")?;
    let from = usize::try_from(offset).ok().and_then(|o| bytes.get(o..));
    let from = from
        .ok_or_else(|| format!("its array begins {offset} bytes into {} appended ones; it is cut off", bytes.len()))?;
    if base64 {
        let end = from.iter().position(|b| *b == b'<').unwrap_or(from.len());
        return Ok(Stream::Base64(Base64::new(&from[..end])));
    }
    Ok(Stream::Raw(from))
}

/// Axes and the position of the first voxel.
fn place(header: &Header, piece: [i64; 6], of_cells: bool) -> (DMat3, DVec3) {
    let spacing = DVec3::from_array(header.spacing.unwrap_or([1.0; 3]));
    // Written row by row.
    let direction = header.direction.map_or(DMat3::IDENTITY, |d| DMat3::from_cols_array(&d).transpose());
    let axes = direction * DMat3::from_diagonal(spacing);
    let first = DVec3::from_array([piece[0], piece[2], piece[4]].map(|i| i as f64 + if of_cells { 0.5 } else { 0.0 }));
    (axes, DVec3::from_array(header.origin.unwrap_or([0.0; 3])) + axes * first)
}
