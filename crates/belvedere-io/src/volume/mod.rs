//! Volumes of voxels: NRRD, MetaImage, NIfTI, VTK (XML ImageData and legacy structured points), MRC, NumPy, stacks
//! of TIFF, folders of slices, DICOM and raw samples.

mod dicom;
mod folder;
mod meta_image;
mod mrc;
mod nifti;
mod npy;
mod nrrd;
mod number;
mod ome;
mod pile;
mod raw;
mod slice_picture;
mod tiff_stack;
mod voxels;
mod vti;
mod vti_header;
mod vti_stream;
mod vtk;

pub(crate) use folder::is_volume_folder;
pub use number::{ByteOrder, Number};
pub use raw::RawLayout;
pub(crate) use tiff_stack::is_stack;
pub use voxels::Voxels;

use crate::formats::{self, Reader};
use crate::packed::content;
use crate::recognise::{self, explain};
use crate::{Fault, InputFile, IoError, Limits, Loaded, budget, fs};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::VoxelValues;
use flate2::read::{MultiGzDecoder, ZlibDecoder};
use glam::{DMat3, DVec3};
use std::io::Read;
use std::path::Path;

/// Largest expansion of a byte by deflate, and bytes allowed besides for small files: a larger declared size is invalid.
const MOST_GROWTH: u64 = 1040;
const SMALL: u64 = 1 << 16;

/// Content of a volume file, in the file's own coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeFile {
    /// Name of the format.
    pub format: &'static str,
    /// Name of the array, where files have several.
    pub array: Option<String>,
    /// Type of the samples in the file.
    pub stored: Number,
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Steps from a voxel to the next, as columns.
    pub axes: DMat3,
    /// Position of voxel (0, 0, 0).
    pub origin: DVec3,
    /// Values, x fastest.
    pub values: VoxelValues,
}

/// What to read of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VolumeRequest {
    /// Name of the array; `None` = the first one of single values.
    pub array: Option<String>,
    /// Layout of raw samples, where the file name does not state it.
    pub raw: RawLayout,
    /// Bounds on memory.
    pub limits: Limits,
}

/// Reads a volume: a file, or a folder of slices or of a series of DICOM.
///
/// Samples of 8 and 16 bits stay what they are (signed bytes become 16 bits), all others become 32-bit floating point. Values that
/// are not finite become the least value, with a warning.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a file that is damaged, larger than the limits allow, or of a kind that is not supported.
/// Allocations are bounded by the size of the file.
pub fn load_volume(path: &Path, request: &VolumeRequest) -> Result<Loaded<VolumeFile>, IoError> {
    if path.is_dir() {
        return folder::read(path, request);
    }
    let path = &content(path, request.limits.max_bytes, &|p| Reader::Volume.reads(p))?;
    let kind = recognise::readable(path)?.map_or("", |format| format.name);
    match kind {
        formats::TIFF_STACK => return tiff_stack::read(path, request),
        "GeoTIFF" => return tiff_stack::read(path, request).map_err(explain),
        _ => {}
    }
    if kind == dicom::NAME {
        return dicom::read(path, std::slice::from_ref(path), request);
    }
    let format = |fault: Fault| IoError::format(path, fault);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    let _work = budget::work_on(path);
    request.limits.ask("the volume", length).map_err(|e| IoError::format(path, e))?;
    let (bytes, file) = InputFile::read(path)?;
    let source = Source { path, bytes: &bytes, request };
    let mut loaded = match kind {
        "VTK ImageData" => vti::read(&source).map_err(format)?,
        "legacy VTK" => vtk::read(&source).map_err(format)?,
        "NIfTI" => nifti::read(&source).map_err(format)?,
        "MRC" => mrc::read(&source).map_err(format)?,
        "NumPy array" => npy::read(&source).map_err(format)?,
        "MetaImage" => meta_image::read(&source).map_err(explain)?,
        "NRRD" => nrrd::read(&source).map_err(explain)?,
        "raw samples" => raw::read(&source).map_err(format)?,
        _ => return Err(recognise::not_a(path, WANTED)),
    };
    loaded.files.insert(0, file);
    Ok(loaded)
}

/// What a volume may be, for errors.
const WANTED: &str = "a volume that this version reads: VTK XML ImageData (.vti), legacy VTK (.vtk), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI (.nii, .nii.gz), MRC (.mrc, .map), NumPy (.npy), a TIFF stack (.tif), DICOM (.dcm), a folder of slices or raw samples (.raw, .raw.gz)";

/// A file and the request for it.
struct Source<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    request: &'a VolumeRequest,
}

impl Source<'_> {
    /// Bytes of the samples of these dimensions; an error if a file of `stored` bytes cannot hold them.
    fn expected(&self, dims: [usize; 3], number: Number, stored: usize, packed: bool) -> Result<usize, Fault> {
        let [x, y, z] = dims.map(|n| n as u128);
        // Each below 2^64, so that three would overflow.
        let bytes = x.checked_mul(y).and_then(|n| n.checked_mul(z)).and_then(|n| n.checked_mul(number.bytes() as u128));
        let bytes = bytes.and_then(|n| u64::try_from(n).ok()).unwrap_or(u64::MAX);
        let stored = stored as u64;
        let most = if packed { stored.saturating_mul(MOST_GROWTH).saturating_add(SMALL) } else { stored };
        if bytes > most {
            return Err(format!(
                "it declares {} x {} x {} samples of {number}, {bytes} bytes, and has {stored}{}; it is cut off, or its header is wrong",
                dims[0],
                dims[1],
                dims[2],
                if packed { " compressed ones, which cannot be as many" } else { "" }
            )
            .into());
        }
        let peak = (bytes / number.bytes() as u64).saturating_mul(number.peak_bytes());
        self.request.limits.ask("the volume", peak)?;
        usize::try_from(bytes).map_err(|_| format!("its {bytes} bytes are more than this machine can address").into())
    }
}

/// First bytes of gzip streams.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Exactly `expected` bytes out of a gzip stream.
fn gunzip(packed: &[u8], expected: usize) -> Result<Vec<u8>, Fault> {
    exactly(MultiGzDecoder::new(packed), "gzip", expected)
}

/// Exactly `expected` bytes out of a zlib or gzip stream.
fn inflate(packed: &[u8], expected: usize) -> Result<Vec<u8>, Fault> {
    if packed.starts_with(&GZIP) {
        gunzip(packed, expected)
    } else {
        exactly(ZlibDecoder::new(packed), "zlib", expected)
    }
}

fn exactly(stream: impl Read, kind: &str, expected: usize) -> Result<Vec<u8>, Fault> {
    let mut out = budget::room("the volume", expected.saturating_add(64))?;
    let limit = expected as u64 + 1;
    stream.take(limit).read_to_end(&mut out).map_err(|e| {
        format!("its {kind} data cannot be read ({e}) after {} of {expected} bytes; it is damaged", out.len())
    })?;
    match out.len() {
        n if n < expected => Err(format!(
            "its {kind} data ends after {n} of {expected} bytes; it is cut off, or the dimensions are wrong"
        )
        .into()),
        n if n > expected => {
            Err(format!("its {kind} data is longer than the {expected} bytes declared; check dimensions and type")
                .into())
        }
        _ => Ok(out),
    }
}

/// Axes of a file that states no spacing, by the request or of voxels of 1, which a warning says.
fn unspaced(request: &VolumeRequest) -> (DMat3, Option<Warning>) {
    if let Some(spacing) = request.raw.spacing {
        return (DMat3::from_diagonal(DVec3::from_array(spacing)), None);
    }
    let text = "it states no spacing; 1 along each axis is assumed, spacing of its layer settles it";
    (DMat3::IDENTITY, Some(Warning::new(WarningKind::Assumed, text).settled_by("spacing")))
}

/// Warnings about values that were changed.
fn odd_values(path: &Path, changed: &number::Changed) -> Vec<Warning> {
    let least = format!("values that are no finite number became the least value, {}", changed.least);
    let not_finite = Warning::counted(WarningKind::Repaired, changed.not_finite, &least);
    let rounded = Warning::counted(WarningKind::Inexact, changed.rounded, "values were rounded to 24 bits");
    not_finite.into_iter().chain(rounded).map(|w| w.in_file(path)).collect()
}
