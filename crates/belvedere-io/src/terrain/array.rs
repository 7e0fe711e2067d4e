//! Heights of an array in memory.

use super::TerrainRequest;
use super::in_bands::{self, Banded};
use super::samples::{Heights, as_requested, check_shape, height_of};
use super::thin::thinning;
use crate::arrays::{Array, HeightGrid};
use crate::{IoError, Loaded, Raster, RasterInfo};
use belvedere_scene::Progress;
use rayon::prelude::*;
use std::ops::Range;
use std::path::Path;

/// The heights of an array, thinned to at most `most_nodes`.
pub(super) fn read(
    array: &Array,
    request: &TerrainRequest,
    most_nodes: usize,
    progress: &Progress,
) -> Result<Loaded<Heights>, IoError> {
    let (grid, path) = (array.heights()?, array.record().path.as_path());
    let info = as_requested(grid.info(path), request);
    check_shape(&info)?;
    let value = match thinning(info.width, info.height, most_nodes) {
        Some(_) => in_bands::read(&Rows { grid, path }, request, most_nodes, progress)?,
        None => whole(grid, info, request)?,
    };
    Ok(Loaded::clean(value).with_file(array.record().clone()))
}

fn whole(grid: &HeightGrid, info: RasterInfo, request: &TerrainRequest) -> Result<Heights, IoError> {
    // Heights, and marks of heights that were looked at.
    let peak = 5 * grid.samples().len() as u64;
    request.limits.check(peak).map_err(|reason| IoError::format(&info.path, reason))?;
    let (nodata, unit) = (info.nodata.map(|n| n as f32), info.vertical_unit_m as f32);
    let samples = grid.samples().par_iter().with_min_len(1 << 16);
    let heights = samples.map(|b| height_of(f32::from_le_bytes(*b), nodata, unit)).collect();
    Ok(Heights::whole(info, heights, 1.0, request))
}

struct Rows<'a> {
    grid: &'a HeightGrid,
    path: &'a Path,
}

impl Banded for Rows<'_> {
    fn info(&self) -> RasterInfo {
        self.grid.info(self.path)
    }

    fn factor(&self) -> f64 {
        1.0
    }

    fn rows_together(&self) -> usize {
        1
    }

    fn rows(&self, rows: Range<usize>, _: &Progress) -> Result<Raster, IoError> {
        Ok(self.grid.rows(self.path, rows))
    }
}
