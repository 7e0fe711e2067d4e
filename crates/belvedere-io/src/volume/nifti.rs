//! NIfTI-1 and NIfTI-2 (.nii, alone or packed by gzip). Source: the headers nifti1.h and nifti2.h of the NIfTI Data Format Working Group.

use super::{ByteOrder, Number, Source, VolumeFile, odd_values};
use crate::{Fault, Loaded};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::VoxelValues;
use glam::{DMat3, DQuat, DVec3};

/// Sizes of the headers, which begin with them.
const ONE: u32 = 348;
const TWO: u32 = 540;
/// To the directions of DICOM: the format counts to the right and to the front, DICOM to the left and to the back.
const TO_LPS: DVec3 = DVec3::new(-1.0, -1.0, 1.0);

/// Where the fields of a header are, bytes from its start.
struct Fields {
    wide: bool,
    datatype: usize,
    dim: usize,
    pixdim: usize,
    vox_offset: usize,
    slope: usize,
    units: usize,
    qform: usize,
    quaternion: usize,
    rows: usize,
}

const FIELDS_ONE: Fields = Fields {
    wide: false,
    datatype: 70,
    dim: 40,
    pixdim: 76,
    vox_offset: 108,
    slope: 112,
    units: 123,
    qform: 252,
    quaternion: 256,
    rows: 280,
};
const FIELDS_TWO: Fields = Fields {
    wide: true,
    datatype: 12,
    dim: 16,
    pixdim: 104,
    vox_offset: 168,
    slope: 176,
    units: 500,
    qform: 344,
    quaternion: 352,
    rows: 400,
};

/// A header of whichever version and byte order.
struct Header<'b> {
    bytes: &'b [u8],
    fields: &'static Fields,
    order: ByteOrder,
}

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, Fault> {
    let header = Header::of(source.bytes)?;
    let (dims, number) = (header.dims()?, header.number()?);
    let offset = header.real(header.fields.vox_offset, 0);
    let at = Some(offset).filter(|o| *o >= 0.0 && *o <= source.bytes.len() as f64 && o.fract() == 0.0);
    let at = at.ok_or_else(|| {
        format!("its samples begin at byte {offset}, the file has {}; it is cut off, or damaged", source.bytes.len())
    })?;
    let data = &source.bytes[(at as usize).max(header.bytes.len())..];
    let expected = source.expected(dims, number, data.len(), false)?;
    let [slope, intercept] = [0, 1].map(|i| header.real(header.fields.slope, i));
    let scaled = slope.is_finite() && slope != 0.0 && intercept.is_finite() && [slope, intercept] != [1.0, 0.0];
    if scaled {
        let each = number.peak_bytes() + size_of::<f32>() as u64;
        source.request.limits.ask("the volume", (expected / number.bytes()) as u64 * each)?;
    }
    let (mut values, changed) = number.decode(data[..expected].to_vec(), header.order);
    let mut warnings = odd_values(source.path, &changed);
    if scaled {
        values = scale(&values, slope, intercept);
    }
    let (axes, origin, said) = header.place();
    warnings.extend(said.map(|w| w.in_file(source.path)));
    let file = VolumeFile { format: "NIfTI", array: None, stored: number, dims, axes, origin, values };
    Ok(Loaded::new(file, warnings))
}

/// `slope * value + intercept`.
fn scale(values: &VoxelValues, slope: f64, intercept: f64) -> VoxelValues {
    let of = |v: f32| (slope * f64::from(v) + intercept).clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
    VoxelValues::F32((0..values.len()).map(|i| of(values.at(i))).collect())
}

impl<'b> Header<'b> {
    fn of(bytes: &'b [u8]) -> Result<Self, String> {
        let first: [u8; 4] = *bytes.first_chunk().ok_or("it is too short for a NIfTI header; it is cut off")?;
        let (fields, order) = match (u32::from_le_bytes(first), u32::from_be_bytes(first)) {
            (ONE, _) => (&FIELDS_ONE, ByteOrder::Little),
            (_, ONE) => (&FIELDS_ONE, ByteOrder::Big),
            (TWO, _) => (&FIELDS_TWO, ByteOrder::Little),
            (_, TWO) => (&FIELDS_TWO, ByteOrder::Big),
            _ => {
                return Err(
                    "it does not begin with the size of a NIfTI header (348 or 540); it is no NIfTI file".into()
                );
            }
        };
        let size = if fields.wide { TWO } else { ONE } as usize;
        let header = bytes
            .get(..size)
            .ok_or_else(|| format!("it has {} bytes, its header alone has {size}; it is cut off", bytes.len()))?;
        let magic = if fields.wide { &header[4..8] } else { &header[344..348] };
        match magic {
            b"n+1\0" | b"n+2\0" => Ok(Self { bytes: header, fields, order }),
            b"ni1\0" | b"ni2\0" => Err(
                "it is a header whose samples are in an .img file, which is not read; write both into one .nii, as with nibabel".into(),
            ),
            _ => Err("it lacks the mark of a NIfTI file (n+1 or n+2); it is damaged, or an ANALYZE header".into()),
        }
    }

    fn unsigned(&self, at: usize, size: usize) -> u64 {
        let bytes = &self.bytes[at..at + size];
        let fold = |n: u64, b: &u8| n << 8 | u64::from(*b);
        if self.order == ByteOrder::Big { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) }
    }

    /// The `i`-th real number of a field.
    fn real(&self, at: usize, i: usize) -> f64 {
        if !self.fields.wide {
            return f64::from(f32::from_bits(self.unsigned(at + 4 * i, 4) as u32));
        }
        let bits = self.unsigned(at + 8 * i, 8);
        // This one field is a whole number in version 2.
        if at == self.fields.vox_offset { bits as i64 as f64 } else { f64::from_bits(bits) }
    }

    fn dim(&self, i: usize) -> i64 {
        match self.fields.wide {
            true => self.unsigned(self.fields.dim + 8 * i, 8) as i64,
            false => i64::from(self.unsigned(self.fields.dim + 2 * i, 2) as u16 as i16),
        }
    }

    fn dims(&self) -> Result<[usize; 3], String> {
        let count = self.dim(0);
        if !(1..=7).contains(&count) {
            return Err(format!("it has {count} dimensions, 1 to 7 are possible; it is damaged"));
        }
        let sizes: Vec<i64> = (1..=7).map(|i| if i as i64 <= count { self.dim(i) } else { 1 }).collect();
        let listed: Vec<String> = sizes[..count as usize].iter().map(i64::to_string).collect();
        let listed = listed.join(" x ");
        if sizes[3..].iter().any(|n| *n > 1) {
            return Err(format!(
                "it has {listed} values, a volume of single values has 3 dimensions; take one out of it, as with fslroi or nibabel"
            ));
        }
        let size = |i: usize| usize::try_from(sizes[i]).ok().filter(|n| *n > 0);
        match (size(0), size(1), size(2)) {
            (Some(x), Some(y), Some(z)) => Ok([x, y, z]),
            _ => Err(format!("its dimensions are {listed}, they must be greater than 0; it is damaged")),
        }
    }

    fn number(&self) -> Result<Number, String> {
        let code = self.unsigned(self.fields.datatype, 2);
        Ok(match code {
            2 => Number::UInt8,
            4 => Number::Int16,
            8 => Number::Int32,
            16 => Number::Float32,
            64 => Number::Float64,
            256 => Number::Int8,
            512 => Number::UInt16,
            768 => Number::UInt32,
            1024 => Number::Int64,
            1280 => Number::UInt64,
            _ => {
                let name = match code {
                    1 => "single bits",
                    32 | 1792 | 2048 => "complex numbers",
                    128 | 2304 => "colours",
                    1536 => "128-bit numbers",
                    _ => "an unknown kind",
                };
                return Err(format!(
                    "its samples are {name} (type {code}), which are not read; convert them to a number type, as with nibabel"
                ));
            }
        })
    }

    /// Axes and origin in millimetres, and a warning if the file states no orientation.
    fn place(&self) -> (DMat3, DVec3, Option<Warning>) {
        let unit = match self.unsigned(self.fields.units, if self.fields.wide { 4 } else { 1 }) & 7 {
            1 => 1e3,
            3 => 1e-3,
            _ => 1.0,
        };
        let to_lps = DMat3::from_diagonal(unit * TO_LPS);
        let code = |at: usize| self.unsigned(at, if self.fields.wide { 4 } else { 2 }) as u16 as i16;
        let wide = if self.fields.wide { 4 } else { 2 };
        let usable = |axes: &DMat3, origin: &DVec3| {
            let edges = axes.x_axis.length() * axes.y_axis.length() * axes.z_axis.length();
            axes.is_finite() && origin.is_finite() && axes.determinant().abs() > 1e-6 * edges && edges > 0.0
        };
        let by_rows = (code(self.fields.qform + wide) > 0).then(|| self.by_rows());
        let by_turn = || (code(self.fields.qform) > 0).then(|| self.by_turn());
        let found = by_rows.filter(|(a, o)| usable(a, o)).or_else(|| by_turn().filter(|(a, o)| usable(a, o)));
        if let Some((axes, origin)) = found {
            return (to_lps * axes, unit * TO_LPS * origin, None);
        }
        let text = "it states no orientation that can be used; its axes are taken to point right, to the front and up";
        let said = Warning::new(WarningKind::Assumed, text);
        (to_lps * DMat3::from_diagonal(self.spacing()), DVec3::ZERO, Some(said))
    }

    /// Distances between voxels; 1 where none is stated.
    fn spacing(&self) -> DVec3 {
        let of = |i: usize| Some(self.real(self.fields.pixdim, i).abs()).filter(|s| s.is_finite() && *s > 0.0);
        DVec3::from_array([1, 2, 3].map(|i| of(i).unwrap_or(1.0)))
    }

    /// The affine map as three rows.
    fn by_rows(&self) -> (DMat3, DVec3) {
        let row = |k: usize, i: usize| self.real(self.fields.rows, 4 * k + i);
        let column = |i: usize| DVec3::new(row(0, i), row(1, i), row(2, i));
        (DMat3::from_cols(column(0), column(1), column(2)), column(3))
    }

    /// The affine map as a turn (a quaternion whose first part is left out), distances and an offset.
    fn by_turn(&self) -> (DMat3, DVec3) {
        let [b, c, d] = [0, 1, 2].map(|i| self.real(self.fields.quaternion, i));
        let offset = DVec3::from_array([3, 4, 5].map(|i| self.real(self.fields.quaternion, i)));
        let squared = b * b + c * c + d * d;
        // Rounding may leave it just above 1.
        let turn = if squared > 1.0 {
            DQuat::from_xyzw(b, c, d, 0.0).normalize()
        } else {
            DQuat::from_xyzw(b, c, d, (1.0 - squared).sqrt())
        };
        let mirrored = if self.real(self.fields.pixdim, 0) < 0.0 { -1.0 } else { 1.0 };
        let spacing = self.spacing() * DVec3::new(1.0, 1.0, mirrored);
        (DMat3::from_quat(turn) * DMat3::from_diagonal(spacing), offset)
    }
}
