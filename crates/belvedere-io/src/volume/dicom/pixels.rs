//! Pixels of DICOM: stored as they are, run lengths, JPEG. Source: DICOM PS3.5 2024e, sections 8 and annexes A, G.

use super::image::{Image, Layout, Stored};
use super::packing::Packing;
use crate::geotiff::unpack_bits;
use crate::volume::slice_picture;
use crate::{Fault, Limits, Samples, budget};
use std::borrow::Cow;
use std::path::Path;

/// Decodes frame `index` to samples of 1, 2 or 4 bytes, little-endian, the samples of a pixel next to each other.
///
/// * `bytes`: of the file, inflated.
pub(super) fn frame<'b>(
    image: &Image,
    bytes: &'b [u8],
    index: usize,
    path: &Path,
    limits: &Limits,
) -> Result<Cow<'b, [u8]>, Fault> {
    let layout = &image.layout;
    let size = layout.allocated / 8;
    let length = layout.frame_bytes()?;
    let changed = "is another file now; try again";
    match &image.pixels {
        Stored::Plain(range) => {
            let all = bytes.get(range.clone()).ok_or(changed)?;
            let start = length.checked_mul(index).filter(|start| *start + length <= all.len());
            let start = start.ok_or_else(|| {
                let (frames, has) = (image.frames.len(), all.len());
                format!("its {frames} frames of {length} bytes do not fit into its {has} bytes of pixels; it is cut off, or damaged")
            })?;
            let raw = &all[start..start + length];
            if layout.planar && layout.samples > 1 {
                let plane = length / layout.samples;
                let pixel = |i: usize| (0..layout.samples).map(move |band| raw[band * plane + i]);
                return Ok(Cow::Owned((0..plane).flat_map(pixel).collect()));
            }
            if !image.big_endian || size == 1 {
                return Ok(Cow::Borrowed(raw));
            }
            Ok(Cow::Owned(raw.chunks_exact(size).flat_map(|sample| sample.iter().rev().copied()).collect()))
        }
        Stored::Pieces(pieces) => {
            let packed = piece(image, pieces, bytes, index)?;
            match image.packing {
                Packing::RunLengths => Ok(Cow::Owned(run_lengths(&packed, layout, length)?)),
                Packing::Jpeg => jpeg(path, &packed, layout, limits).map(Cow::Owned),
                _ => Err("its pixels come in pieces, but are said to be uncompressed; it is damaged".into()),
            }
        }
    }
}

/// Compressed bytes of a frame: its piece, or all pieces of the only frame.
fn piece<'b>(
    image: &Image,
    pieces: &[std::ops::Range<usize>],
    bytes: &'b [u8],
    index: usize,
) -> Result<Cow<'b, [u8]>, String> {
    let of = |i: usize| {
        let found = pieces.get(i).and_then(|range| bytes.get(range.clone()));
        found.ok_or_else(|| "is another file now; try again".to_owned())
    };
    match (image.frames.len(), pieces.len().saturating_sub(1)) {
        (frames, pieces) if frames == pieces => of(index + 1).map(Cow::Borrowed),
        (1, 1..) => (1..pieces.len()).map(of).collect::<Result<Vec<_>, _>>().map(|all| Cow::Owned(all.concat())),
        (frames, pieces) => Err(format!(
            "its {frames} frames lie in {pieces} pieces, one for each is read; make it uncompressed, as with dcmdjpeg or gdcmconv"
        )),
    }
}

/// Annex G: a plane of bytes for each byte of a sample, the most significant first.
fn run_lengths(packed: &[u8], layout: &Layout, length: usize) -> Result<Vec<u8>, Fault> {
    let word = |i: usize| {
        let bytes = packed.get(4 * i..).and_then(|rest| rest.first_chunk::<4>());
        bytes.map(|b| u32::from_le_bytes(*b) as usize).ok_or("its run lengths are cut off")
    };
    let size = layout.allocated / 8;
    let planes = size * layout.samples;
    let stated = word(0)?;
    if stated != planes {
        return Err(format!("its run lengths have {stated} planes of bytes, {planes} are needed; it is damaged").into());
    }
    let mut out = budget::room("a frame", length)?;
    out.resize(length, 0);
    let pixels = length / planes;
    let mut plane = vec![0; pixels];
    for k in 0..planes {
        let start = word(k + 1)?;
        let end = if k + 1 < planes { word(k + 2)? } else { packed.len() };
        let raw = packed.get(start..end).ok_or("its run lengths lie outside the frame; it is damaged")?;
        let found = unpack_bits(raw, &mut plane);
        if found < pixels {
            return Err(format!("its run lengths give {found} of {pixels} bytes; it is cut off").into());
        }
        let to = (k / size) * size + size - 1 - k % size;
        out.iter_mut().skip(to).step_by(planes).zip(&plane).for_each(|(out, byte)| *out = *byte);
    }
    Ok(out)
}

fn jpeg(path: &Path, packed: &[u8], layout: &Layout, limits: &Limits) -> Result<Vec<u8>, Fault> {
    let raster = slice_picture::jpeg(path, packed, limits)?;
    let info = &raster.info;
    let found = (info.width, info.height, info.bands, layout.allocated);
    if found != (layout.columns, layout.rows, layout.samples, 8) {
        return Err(format!(
            "its JPEG has {} x {} pixels of {} samples, {} x {} of {} are stated; it is damaged",
            info.width, info.height, info.bands, layout.columns, layout.rows, layout.samples
        )
        .into());
    }
    match raster.samples {
        Samples::U8(samples) => Ok(samples),
        _ => Err("its JPEG has no samples of 8 bits".into()),
    }
}

impl Layout {
    /// Bytes of a frame as it is stored without compression.
    pub(super) fn frame_bytes(&self) -> Result<usize, String> {
        let of = |n: usize, by: usize| n.checked_mul(by);
        let bytes =
            of(self.columns, self.rows).and_then(|n| of(n, self.samples)).and_then(|n| of(n, self.allocated / 8));
        bytes.ok_or_else(|| "its frames are too large for this machine".to_owned())
    }
}
