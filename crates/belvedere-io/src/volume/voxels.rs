//! Voxels in memory.

use super::{ByteOrder, Number, VolumeFile, odd_values};
use crate::shared_bytes::SharedBytes;
use crate::{IoError, Limits, Loaded};
use glam::{DMat3, DVec3};
use serde_json::json;
use std::io::{self, Write};
use std::path::Path;

/// Values on a grid, with its place.
#[derive(Clone)]
pub struct Voxels {
    dims: [usize; 3],
    number: Number,
    spacing: DVec3,
    origin: DVec3,
    values: SharedBytes,
}

impl Voxels {
    /// * `dims`: voxels along x, y, z, at least 2 each.
    /// * `spacing`: distances along x, y, z, above 0; `origin`: position of the first voxel.
    /// * `values`: numbers of the type `number`, little-endian, x fastest.
    ///
    /// # Errors
    /// A sentence for anything else.
    pub fn new(
        dims: [usize; 3],
        number: Number,
        spacing: DVec3,
        origin: DVec3,
        values: SharedBytes,
    ) -> Result<Self, String> {
        let bytes = values.len();
        let expected = dims.into_iter().try_fold(number.bytes(), usize::checked_mul);
        if dims.into_iter().any(|n| n < 2) || expected != Some(bytes) {
            let [x, y, z] = dims;
            return Err(format!("{bytes} bytes are no {x} x {y} x {z} voxels of {number}, at least 2 along each axis"));
        }
        if !(spacing.is_finite() && spacing.min_element() > 0.0 && origin.is_finite()) {
            return Err(format!(
                "the spacing {spacing} from {origin} on is no place; give finite numbers, distances above 0"
            ));
        }
        Ok(Self { dims, number, spacing, origin, values })
    }

    /// The volume, as [`super::load_volume`] makes it of a file: of numbers that are not finite the least becomes the value.
    ///
    /// # Errors
    /// [`IoError::Format`] if it is too large for `limits`.
    pub fn volume(&self, path: &Path, limits: &Limits) -> Result<Loaded<VolumeFile>, IoError> {
        let values = &*self.values;
        let count = (values.len() / self.number.bytes()) as u64;
        let peak = count.saturating_mul(self.number.peak_bytes());
        limits.ask("the volume", peak).map_err(|reason| IoError::format(path, reason))?;
        let (values, changed) = self.number.decode(values, ByteOrder::Little);
        let file = VolumeFile {
            format: "array",
            array: None,
            stored: self.number,
            dims: self.dims,
            axes: DMat3::from_diagonal(self.spacing),
            origin: self.origin,
            values,
        };
        Ok(Loaded::new(file, odd_values(path, &changed)))
    }

    pub(crate) fn layout(&self) -> (serde_json::Value, Vec<&[u8]>) {
        let (spacing, origin) = (self.spacing.to_array(), self.origin.to_array());
        let number = self.number.to_string();
        let header =
            json!({ "array": "voxels", "dims": self.dims, "origin": origin, "spacing": spacing, "type": number });
        (header, vec![&*self.values])
    }

    /// Writes the volume as NRRD.
    pub(crate) fn write_nrrd(&self, out: &mut dyn Write) -> io::Result<()> {
        let ([nx, ny, nz], [dx, dy, dz], [x, y, z]) = (self.dims, self.spacing.to_array(), self.origin.to_array());
        write!(
            out,
            "NRRD0004\ntype: {}\ndimension: 3\nspace dimension: 3\nsizes: {nx} {ny} {nz}\nspace directions: ({dx:?},0,0) (0,{dy:?},0) (0,0,{dz:?})\n\
             space origin: ({x:?},{y:?},{z:?})\nendian: little\nencoding: raw\n\n",
            self.number
        )?;
        out.write_all(&self.values)
    }
}
