//! What one DICOM file says of its pixels, their meaning and place. Source: DICOM PS3.3 2024e, C.7.6 and C.7.6.16.

use super::data_set::{Encoding, PIXELS, Parser, Value, View};
use super::packing::Packing;
use crate::Fault;
use crate::volume::{MOST_GROWTH, exactly};
use flate2::read::DeflateDecoder;
use glam::DVec3;
use std::borrow::Cow;
use std::io::Read;
use std::ops::Range;

const TRANSFER_SYNTAX: u32 = 0x0002_0010;
const MODALITY: u32 = 0x0008_0060;
const SERIES_TITLE: u32 = 0x0008_103e;
const SLICE_THICKNESS: u32 = 0x0018_0050;
const SLICE_SPACING: u32 = 0x0018_0088;
const SERIES: u32 = 0x0020_000e;
const NUMBER: u32 = 0x0020_0013;
const POSITION: u32 = 0x0020_0032;
const ORIENTATION: u32 = 0x0020_0037;
const SAMPLES: u32 = 0x0028_0002;
const PHOTOMETRIC: u32 = 0x0028_0004;
const PLANAR: u32 = 0x0028_0006;
const FRAMES: u32 = 0x0028_0008;
const ROWS: u32 = 0x0028_0010;
const COLUMNS: u32 = 0x0028_0011;
const SPACING: u32 = 0x0028_0030;
const ALLOCATED: u32 = 0x0028_0100;
const STORED: u32 = 0x0028_0101;
const HIGH_BIT: u32 = 0x0028_0102;
const SIGNED: u32 = 0x0028_0103;
const INTERCEPT: u32 = 0x0028_1052;
const SLOPE: u32 = 0x0028_1053;
const FRAME_OFFSETS: u32 = 0x3004_000c;
const SHARED: u32 = 0x5200_9229;
const PER_FRAME: u32 = 0x5200_9230;
/// Sequences of a frame in which values of it stand.
const IN_FRAME: [u32; 4] = [0x0028_9110, 0x0020_9113, 0x0020_9116, 0x0028_9145];

/// Most frames of a file.
const MAX_FRAMES: f64 = 65_536.0;

/// Layout of the samples of a frame.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Layout {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// 1, or 3 of colours.
    pub(super) samples: usize,
    /// Bits that a sample takes in the file: 8, 16 or 32.
    pub(super) allocated: usize,
    /// Bits that count.
    pub(super) stored: usize,
    pub(super) high_bit: usize,
    pub(super) signed: bool,
    /// Whether colours lie one plane after the other.
    pub(super) planar: bool,
    pub(super) photometric: String,
}

/// One frame: where it lies and what its values mean.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    /// Index in its file.
    pub(super) index: usize,
    /// Of the centre of the first pixel, mm.
    pub(super) position: Option<DVec3>,
    /// Direction in which columns count, then that in which rows do.
    pub(super) axes: Option<[DVec3; 2]>,
    /// Distances of rows and of columns, mm.
    pub(super) spacing: Option<[f64; 2]>,
    /// Distance of slices as stated, mm.
    pub(super) step: Option<f64>,
    /// Slope and intercept.
    pub(super) rescale: [f64; 2],
    pub(super) number: f64,
}

/// Bytes of the pixels of a file.
#[derive(Debug, Clone)]
pub(super) enum Stored {
    Plain(Range<usize>),
    Pieces(Vec<Range<usize>>),
}

/// The content of a file without its pixels.
#[derive(Debug, Clone)]
pub(super) struct Image {
    pub(super) series: String,
    pub(super) title: String,
    pub(super) layout: Layout,
    pub(super) packing: Packing,
    pub(super) big_endian: bool,
    pub(super) pixels: Stored,
    pub(super) frames: Vec<Frame>,
}

/// The transfer syntax, and the bytes with all elements readable: inflated, where a file is deflated.
pub(super) fn unpacked(bytes: &[u8]) -> Result<(Cow<'_, [u8]>, usize, String), Fault> {
    if bytes.get(128..132) != Some(b"DICM") {
        return Err("it has no mark DICM at byte 128; it is no DICOM file, or is cut off: write it with its header, as with dcmconv".into());
    }
    let explicit = Encoding { explicit: true, big_endian: false };
    let (meta, end) = Parser::new(bytes, 132, explicit).read(|tag| tag >> 16 == 2)?;
    let meta = View { set: &meta, bytes, big_endian: false };
    let syntax = meta.text(TRANSFER_SYNTAX).ok_or("it does not say how it is stored (0002,0010); it is damaged")?;
    if syntax != "1.2.840.10008.1.2.1.99" {
        return Ok((Cow::Borrowed(bytes), end, syntax));
    }
    let packed = &bytes[end..];
    let mut counted = DeflateDecoder::new(packed).take(MOST_GROWTH * packed.len() as u64 + 1);
    let length = std::io::copy(&mut counted, &mut std::io::sink())
        .map_err(|e| format!("its deflate data cannot be read ({e}); it is damaged"))?;
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    Ok((Cow::Owned(exactly(DeflateDecoder::new(packed), "deflate", length)?), 0, syntax))
}

impl Image {
    /// Of the bytes of a file; `None` for one without pixels, such as a report or a directory.
    pub(super) fn of(bytes: &[u8]) -> Result<Option<Self>, Fault> {
        let (bytes, start, syntax) = unpacked(bytes)?;
        let (packing, encoding) = Packing::of(&syntax);
        let (set, _) = Parser::new(&bytes, start, encoding).read(|tag| tag <= PIXELS)?;
        let view = View { set: &set, bytes: &bytes, big_endian: encoding.big_endian };
        let pixels = match set.0.get(&PIXELS) {
            Some(Value::Bytes(range)) => Stored::Plain(range.clone()),
            Some(Value::Fragments(pieces)) => Stored::Pieces(pieces.clone()),
            _ => return Ok(None),
        };
        let mut layout = Layout::of(view)?;
        if packing == Packing::Jpeg && layout.samples == 3 {
            // The decoder gives colours so, whatever was stored.
            (layout.photometric, layout.planar) = ("RGB".to_owned(), false);
        }
        let count = view.decimal(FRAMES).unwrap_or(1.0);
        if !(1.0..=MAX_FRAMES).contains(&count) {
            return Err(format!("it has {count} frames, 1 to {MAX_FRAMES} are possible; it is damaged").into());
        }
        let title = [view.text(MODALITY), view.text(SERIES_TITLE)].into_iter().flatten().collect::<Vec<_>>().join(" ");
        let (series, big_endian) = (view.text(SERIES).unwrap_or_default(), encoding.big_endian);
        let frames = frames(view, count as usize);
        Ok(Some(Self { series, title, layout, packing, big_endian, pixels, frames }))
    }
}

impl Layout {
    fn of(view: View<'_>) -> Result<Self, String> {
        let need = |tag: u32, what: &str| {
            let value = view.short(tag).map(usize::from).filter(|n| *n > 0);
            value.ok_or_else(|| format!("it has no {what}; it is damaged"))
        };
        let (columns, rows) = (need(COLUMNS, "number of columns")?, need(ROWS, "number of rows")?);
        let (allocated, samples) = (need(ALLOCATED, "bits of samples")?, view.short(SAMPLES).unwrap_or(1).into());
        let stored = view.short(STORED).map_or(allocated, usize::from);
        let high_bit = view.short(HIGH_BIT).map_or(stored.saturating_sub(1), usize::from);
        let photometric = view.text(PHOTOMETRIC).unwrap_or_else(|| "MONOCHROME2".to_owned());
        if !matches!(allocated, 8 | 16 | 32) || stored == 0 || stored > high_bit + 1 || high_bit >= allocated {
            return Err(format!(
                "its samples have {stored} of {allocated} bits up to bit {high_bit}; 8, 16 and 32 bits are read: convert it, as with dcmconv"
            ));
        }
        let is_color = samples == 3 && allocated == 8 && !photometric.starts_with("MONO");
        if !(is_color || samples == 1 && photometric.starts_with("MONO")) {
            return Err(format!(
                "its pixels are {photometric:.30} of {samples} samples, grey and RGB are read; convert it, as with dcmdjpeg or gdcmconv"
            ));
        }
        let (signed, planar) = (view.short(SIGNED) == Some(1), view.short(PLANAR) == Some(1));
        Ok(Self { columns, rows, samples, allocated, stored, high_bit, signed, planar, photometric })
    }
}

/// Frames of a file: those of enhanced objects say where each of them lies.
fn frames(view: View<'_>, count: usize) -> Vec<Frame> {
    let shared: Vec<View<'_>> = view.items(SHARED).collect();
    let own: Vec<View<'_>> = view.items(PER_FRAME).take(count).collect();
    let offsets = view.decimals(FRAME_OFFSETS).filter(|offsets| offsets.len() == count);
    let of = |index: usize| {
        let groups = own.get(index).into_iter().chain(&shared);
        let places: Vec<View<'_>> =
            groups.flat_map(|g| IN_FRAME.into_iter().flat_map(|tag| g.items(tag))).chain([view]).collect();
        let some = |tag: u32| places.iter().find_map(|place| place.decimal(tag));
        let vector = |tag: u32| places.iter().find_map(|place| place.some::<3>(tag)).map(DVec3::from_array);
        let axes = places.iter().find_map(|place| place.some::<6>(ORIENTATION)).and_then(|v| {
            let [row, column] = [DVec3::new(v[0], v[1], v[2]), DVec3::new(v[3], v[4], v[5])];
            Some([row.try_normalize()?, column.try_normalize()?]).filter(|[a, b]| a.cross(*b).length() > 1e-3)
        });
        let spacing = places.iter().find_map(|place| place.some::<2>(SPACING)).filter(|s| s.iter().all(|s| *s > 0.0));
        let along = axes.zip(offsets.as_ref()).map(|([a, b], offsets)| a.cross(b) * (offsets[index] - offsets[0]));
        let position = match (vector(POSITION), along) {
            (Some(position), Some(along)) => Some(position + along),
            // One position of several frames is that of none of them.
            (found, None) if count == 1 || own.len() > index => found,
            _ => None,
        };
        let step = some(SLICE_SPACING).or_else(|| some(SLICE_THICKNESS)).map(f64::abs).filter(|step| *step > 0.0);
        let rescale = [some(SLOPE).filter(|slope| *slope != 0.0).unwrap_or(1.0), some(INTERCEPT).unwrap_or(0.0)];
        let number = if count == 1 { some(NUMBER).unwrap_or(0.0) } else { index as f64 };
        Frame { index, position, axes, spacing, step, rescale, number }
    };
    (0..count).map(of).collect()
}
