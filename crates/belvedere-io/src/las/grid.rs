//! Points to heights on a grid.

use super::header::Header;
use super::points::Points;
use crate::geotiff::system_of_keys;
use crate::{Affine, Fault, Limits, RasterInfo, SampleType, Samples, SourceCrs, budget};
use belvedere_core::{Warning, WarningKind};
use std::collections::BTreeSet;
use std::path::Path;

/// Points that a cell shall hold, so that few are without one.
const IN_CELL: f64 = 4.0;
/// Cells along a side of the coarse grid that tells where points are.
const COARSE: f64 = 64.0;

/// Cells over the points.
#[derive(Debug)]
pub(super) struct Grid {
    points: Points,
    scale: [f64; 3],
    offset: [f64; 3],
    cell: f64,
    /// Cells from the origin of the coordinates to the left and to the top.
    left: f64,
    top: f64,
    cols: usize,
    rows: usize,
    /// Whether cells are larger than the points allow.
    is_reduced: bool,
}

/// The next size from the row 1, 2, 5, 10, ... up.
fn round_up(size: f64) -> f64 {
    let unit = 10f64.powi(size.log10().floor() as i32);
    // Powers and their products are rounded.
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|n| n * unit).find(|n| *n >= size * (1.0 - 1e-9)).unwrap_or(size)
}

impl Grid {
    pub(super) fn of(header: &Header, points: Points, most_nodes: usize) -> Result<Self, String> {
        let Header { scale, offset, .. } = header;
        let mut bounds = [[i32::MAX, i32::MIN]; 2];
        for place in &points.places {
            for (bound, v) in bounds.iter_mut().zip(place) {
                *bound = [bound[0].min(*v), bound[1].max(*v)];
            }
        }
        let at = |axis: usize, v: i32| scale[axis] * f64::from(v) + offset[axis];
        let [x, y] = [0, 1].map(|axis| {
            let ends = bounds[axis].map(|v| at(axis, v));
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        });
        let (width, height) = (x[1] - x[0], y[1] - y[0]);
        if !(width > 0.0 && height > 0.0 && width.is_finite() && height.is_finite()) {
            return Err(format!(
                "its {} points lie on {width} x {height} of its units, an area is needed; choose another file",
                points.places.len()
            ));
        }
        let coarse = |v: f64, [low, high]: [f64; 2]| ((v - low) / (high - low) * COARSE).min(COARSE - 1.0) as u16;
        let taken: BTreeSet<[u16; 2]> =
            points.places.iter().map(|p| [coarse(at(0, p[0]), x), coarse(at(1, p[1]), y)]).collect();
        let area = width * height * taken.len() as f64 / (COARSE * COARSE);
        let wanted = round_up((IN_CELL * area / points.places.len() as f64).sqrt());
        let mut cell = wanted;
        loop {
            let (left, top) = ((x[0] / cell).floor(), (y[1] / cell).ceil());
            let (cols, rows) = ((x[1] / cell).floor() - left + 1.0, top - (y[0] / cell).ceil() + 1.0);
            if cols * rows <= most_nodes as f64 {
                let (cols, rows, is_reduced) = (cols as usize, rows as usize, cell > wanted);
                return Ok(Self { points, scale: *scale, offset: *offset, cell, left, top, cols, rows, is_reduced });
            }
            cell = round_up(1.1 * cell);
        }
    }

    /// The raster without its samples, and warnings about its system.
    pub(super) fn info(&self, path: &Path, header: &Header, bytes: &[u8]) -> (RasterInfo, Vec<Warning>) {
        let mut info = RasterInfo::new(path, self.cols, self.rows, SampleType::F32);
        let (left, top) = (self.left * self.cell, self.top * self.cell);
        info.pixel_to_model = Some(Affine([self.cell, 0.0, left, 0.0, -self.cell, top]));
        let record = |number: u16| header.record_of(bytes, "LASF_Projection", number).unwrap_or(&[]);
        let directory: Vec<u64> =
            record(34735).as_chunks::<2>().0.iter().map(|b| u64::from(u16::from_le_bytes(*b))).collect();
        let doubles: Vec<f64> = record(34736).as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        let warnings = system_of_keys(&directory, &doubles, record(34737), &mut info);
        let text = String::from_utf8_lossy(record(2112));
        let text = text.trim_matches(|c: char| c == '\0' || c.is_whitespace());
        if !text.is_empty() {
            info.crs = SourceCrs::Wkt(text.to_owned());
        }
        (info, warnings)
    }

    /// What became of the points.
    pub(super) fn said(&self) -> Warning {
        let Points { all, is_ground, places } = &self.points;
        let what = if *is_ground {
            format!("the mean of its {} ground points (class 2)", places.len())
        } else {
            format!("none of its points is called ground (class 2), so the highest of {} first returns", places.len())
        };
        let kind = if self.is_reduced { WarningKind::Reduced } else { WarningKind::Assumed };
        let text = format!("of {all} points {what} in each cell of {} is its height", self.cell);
        let more = if self.is_reduced { "; larger cells than the points allow keep the limit of nodes" } else { "" };
        Warning::new(kind, text + more).with("cell", self.cell).with("points", places.len() as f64)
    }

    /// The height of each cell, NaN where it has no point.
    pub(super) fn heights(self, limits: &Limits) -> Result<Samples, Fault> {
        let cells = self.cols * self.rows;
        limits.ask("the grid of points", (cells * size_of::<(f64, u32)>()) as u64)?;
        let mut sums: Vec<(f64, u32)> = budget::room("the grid of points", cells)?;
        sums.resize(cells, (0.0, 0));
        for place in &self.points.places {
            let [x, y, z] = [0, 1, 2].map(|axis| self.scale[axis] * f64::from(place[axis]) + self.offset[axis]);
            let col = ((x / self.cell).floor() - self.left).max(0.0) as usize;
            let row = (self.top - (y / self.cell).ceil()).max(0.0) as usize;
            let (sum, count) = &mut sums[row.min(self.rows - 1) * self.cols + col.min(self.cols - 1)];
            *sum = if self.points.is_ground || *count == 0 { *sum + z } else { sum.max(z) };
            *count = if self.points.is_ground { *count + 1 } else { 1 };
        }
        let height = |(sum, count): &(f64, u32)| if *count > 0 { (sum / f64::from(*count)) as f32 } else { f32::NAN };
        Ok(Samples::F32(sums.iter().map(height).collect()))
    }
}
