//! Heights of a grid.

use crate::crs::CoordinateSystem;
use crate::raster::{Affine, CrsKind, Raster, RasterInfo, SampleType, Samples, SourceCrs};
use crate::shared_bytes::SharedBytes;
use serde_json::json;
use std::ops::Range;
use std::path::Path;

/// Heights in metres on a grid, with their place.
#[derive(Clone)]
pub struct HeightGrid {
    size: [usize; 2],
    transform: Affine,
    epsg: Option<u32>,
    samples: SharedBytes,
}

impl HeightGrid {
    /// * `size`: columns and rows, at least 2 each.
    /// * `transform`: from columns and rows of corners of pixels to coordinates; it has an inverse.
    /// * `epsg`: system of the coordinates; `None` = local.
    /// * `samples`: f32, metres, rows one after the other; what is not finite is a hole.
    ///
    /// # Errors
    /// A sentence for other sizes and transforms.
    pub fn new(size: [usize; 2], transform: Affine, epsg: Option<u32>, samples: SharedBytes) -> Result<Self, String> {
        let [columns, rows] = size;
        let bytes = samples.len();
        if columns < 2 || rows < 2 || columns.checked_mul(rows).and_then(|n| n.checked_mul(4)) != Some(bytes) {
            return Err(format!("{bytes} bytes are no {columns} x {rows} heights of 32 bits, at least 2 x 2"));
        }
        if transform.inverse().is_none() {
            return Err(format!("the transform {:?} is no affine map with an inverse", transform.0));
        }
        Ok(Self { size, transform, epsg, samples })
    }

    /// Samples as bytes of f32, row after row.
    pub(crate) fn samples(&self) -> &[[u8; 4]] {
        self.samples.as_chunks().0
    }

    /// Everything but the samples.
    pub(crate) fn info(&self, path: &Path) -> RasterInfo {
        let [columns, rows] = self.size;
        let mut info = RasterInfo::new(path, columns, rows, SampleType::F32);
        info.pixel_to_model = Some(self.transform);
        if let Some(code) = self.epsg {
            let is_geographic = CoordinateSystem::from_epsg(code).is_ok_and(|system| system.is_geographic());
            info.crs = SourceCrs::Epsg(code);
            info.crs_kind = if is_geographic { CrsKind::Geographic } else { CrsKind::Projected };
        }
        info
    }

    /// Some rows.
    pub(crate) fn rows(&self, path: &Path, rows: Range<usize>) -> Raster {
        let columns = self.size[0];
        let mut info = self.info(path);
        info.height = rows.len();
        info.pixel_to_model = Some(self.transform.after_scale_and_shift(1.0, 1.0, 0.0, rows.start as f64));
        let samples = &self.samples()[rows.start * columns..rows.end * columns];
        let samples = Samples::F32(samples.iter().map(|b| f32::from_le_bytes(*b)).collect());
        Raster { info, samples, mask: None }
    }

    pub(super) fn layout(&self) -> (serde_json::Value, Vec<&[u8]>) {
        let ([columns, rows], transform) = (self.size, self.transform.0);
        let header =
            json!({ "array": "heights", "columns": columns, "epsg": self.epsg, "rows": rows, "transform": transform });
        (header, vec![&*self.samples])
    }

    /// The grid as a raster that can be written: holes are no data.
    pub(super) fn raster(&self, path: &Path) -> Raster {
        const NODATA: f32 = -3.0e38;
        let mut raster = self.rows(path, 0..self.size[1]);
        raster.info.nodata = Some(f64::from(NODATA));
        if let Samples::F32(samples) = &mut raster.samples {
            samples.iter_mut().filter(|h| !h.is_finite()).for_each(|h| *h = NODATA);
        }
        raster
    }
}
