//! Density maps of electron microscopy and crystallography (MRC, CCP4).
//!
//! Source: Cheng et al. 2015, "MRC2014: Extensions to the MRC format header for electron cryo-microscopy and tomography"; the bits of IMOD's
//! mode 0 from its documentation of MRC files.

use super::{ByteOrder, Number, Source, VolumeFile, odd_values};
use crate::{Fault, Loaded};
use belvedere_core::{Warning, WarningKind};
use glam::{DMat3, DVec3};

/// Bytes of the header before the extended one.
const HEADER: usize = 1024;
/// Mark of IMOD in word 39.
const IMOD: i32 = 1_146_047_817;

/// A header and its order of bytes.
struct Header<'b> {
    bytes: &'b [u8; HEADER],
    order: ByteOrder,
}

pub(super) fn read(source: &Source<'_>) -> Result<Loaded<VolumeFile>, Fault> {
    let Some(bytes) = source.bytes.first_chunk::<HEADER>() else {
        let bytes = source.bytes.len();
        return Err(format!("it has {bytes} bytes, its header alone has {HEADER}; it is cut off").into());
    };
    let header = Header::of(bytes)?;
    let mut warnings = Vec::new();
    let (dims, number) = (header.dims(&mut warnings)?, header.number()?);
    let extended = header.int(24);
    let skipped = usize::try_from(extended).ok().and_then(|n| source.bytes.get(HEADER..)?.get(n..));
    let data = skipped.ok_or_else(|| {
        let bytes = source.bytes.len();
        format!("its extended header has {extended} bytes, the file has {bytes}; it is cut off, or damaged")
    })?;
    let expected = source.expected(dims, number, data.len(), false)?;
    let (axes, origin) = header.place(&mut warnings)?;
    let (values, changed) = number.decode(&data[..expected], header.order);
    let file = VolumeFile { format: "MRC", array: None, stored: number, dims, axes, origin, values };
    let said = warnings.into_iter().map(|w| w.in_file(source.path));
    Ok(Loaded::new(file, said.chain(odd_values(source.path, &changed)).collect()))
}

impl<'b> Header<'b> {
    fn of(bytes: &'b [u8; HEADER]) -> Result<Self, String> {
        let order = match bytes[212..214] {
            [0x44, 0x44 | 0x41] => ByteOrder::Little,
            [0x11, 0x11] => ByteOrder::Big,
            // Old files have no stamp; their type of samples is a small number.
            _ => match [ByteOrder::Little, ByteOrder::Big].map(|order| Header { bytes, order }.int(4)) {
                [0..=127, _] => ByteOrder::Little,
                [_, 0..=127] => ByteOrder::Big,
                [mode, _] => return Err(format!("its mode is {mode} in either order of bytes; it is no MRC file")),
            },
        };
        Ok(Self { bytes, order })
    }

    fn word(&self, number: usize) -> [u8; 4] {
        let at = 4 * (number - 1);
        std::array::from_fn(|i| self.bytes[at + i])
    }

    /// Whole number in a word, counted from 1 as the format does.
    fn int(&self, number: usize) -> i32 {
        let word = self.word(number);
        if self.order == ByteOrder::Big { i32::from_be_bytes(word) } else { i32::from_le_bytes(word) }
    }

    fn real(&self, number: usize) -> f64 {
        f64::from(f32::from_bits(self.int(number) as u32))
    }

    fn reals(&self, first: usize) -> [f64; 3] {
        [0, 1, 2].map(|i| self.real(first + i))
    }

    /// Voxels along columns, rows and sections; of a stack of volumes those of the first.
    fn dims(&self, warnings: &mut Vec<Warning>) -> Result<[usize; 3], String> {
        let sizes = [1, 2, 3].map(|word| self.int(word));
        let [x, y, mut z] = sizes.map(|n| usize::try_from(n).unwrap_or(0));
        if x == 0 || y == 0 || z == 0 {
            let [x, y, z] = sizes;
            return Err(format!("its dimensions are {x} x {y} x {z}, they must be greater than 0; it is damaged"));
        }
        let (group, intervals) = (self.int(23), usize::try_from(self.int(10)).unwrap_or(0));
        if group >= 401 && intervals > 0 && z > intervals {
            let text = format!("it has {} volumes; the first is taken", z / intervals);
            warnings.push(Warning::new(WarningKind::Ignored, text));
            z = intervals;
        }
        if group == 0 && intervals == 1 && z > 1 {
            let text = format!("its header calls it {z} single images; they are taken as slices");
            warnings.push(Warning::new(WarningKind::Assumed, text));
        }
        Ok([x, y, z])
    }

    fn number(&self) -> Result<Number, String> {
        Ok(match self.int(4) {
            // IMOD says by a bit whether bytes are signed.
            0 if self.int(39) == IMOD && self.int(40) & 1 == 0 => Number::UInt8,
            0 => Number::Int8,
            1 => Number::Int16,
            2 => Number::Float32,
            6 => Number::UInt16,
            12 => Number::Float16,
            mode => {
                let what = match mode {
                    3 | 4 => "complex numbers",
                    16 => "colours",
                    101 => "numbers of 4 bits",
                    _ => "of an unknown kind",
                };
                return Err(format!(
                    "its samples are {what} (mode {mode}), which are not read; modes 0, 1, 2, 6 and 12 are: convert it, as with newstack or mrcfile"
                ));
            }
        })
    }

    /// Axes and origin, ångström.
    fn place(&self, warnings: &mut Vec<Warning>) -> Result<(DMat3, DVec3), String> {
        let order = [17, 18, 19].map(|word| self.int(word));
        let mut sorted = order;
        sorted.sort_unstable();
        let order = match sorted {
            [1, 2, 3] => order.map(|axis| axis as usize - 1),
            // Old files leave it out.
            [0, 0, 0] => [0, 1, 2],
            _ => return Err(format!("its axes are {order:?}, they must be 1, 2 and 3 in some order; it is damaged")),
        };
        let (cell, intervals) = (self.reals(11), [8, 9, 10].map(|word| f64::from(self.int(word))));
        let steps = [0, 1, 2].map(|i| cell[i] / intervals[i]);
        let is_stated = steps.iter().all(|step| step.is_finite() && *step > 0.0);
        let edges = if is_stated {
            cell_axes(self.reals(14)) * DMat3::from_diagonal(steps.into())
        } else {
            let text = "it states no size of its cell; voxels of 1 along each axis are assumed";
            warnings.push(Warning::new(WarningKind::Assumed, text));
            DMat3::IDENTITY
        };
        let axes = DMat3::from_cols(edges.col(order[0]), edges.col(order[1]), edges.col(order[2]));
        let origin = DVec3::from_array(self.reals(50));
        if origin.is_finite() && origin != DVec3::ZERO {
            return Ok((axes, origin));
        }
        let start = DVec3::from_array([5, 6, 7].map(|word| f64::from(self.int(word))));
        Ok((axes, axes * start))
    }
}

/// Directions of the edges of a cell of these angles, degrees: a along x, b in the plane of x and y.
fn cell_axes(angles_deg: [f64; 3]) -> DMat3 {
    let is_right = angles_deg.iter().all(|a| (a - 90.0).abs() < 1e-4 || *a == 0.0);
    let [alpha, beta, gamma] = angles_deg.map(|a| a.to_radians().cos());
    let sin = (1.0 - gamma * gamma).sqrt();
    let y = (alpha - beta * gamma) / sin;
    let axes = DMat3::from_cols(
        DVec3::X,
        DVec3::new(gamma, sin, 0.0),
        DVec3::new(beta, y, (1.0 - beta * beta - y * y).sqrt()),
    );
    if is_right || !axes.is_finite() { DMat3::IDENTITY } else { axes }
}
