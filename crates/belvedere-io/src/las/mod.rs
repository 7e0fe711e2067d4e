//! Clouds of points of the air (LAS, and LAZ, which packs them), gridded to heights.
//!
//! Source: ASPRS, LAS Specification 1.4 R15.

mod grid;
mod header;
mod points;

use crate::{InputFile, IoError, Limits, Loaded, Raster, budget, fs};
use grid::Grid;
use header::Header;
use points::Points;
use std::path::Path;

/// Reads the points as heights on a grid: the mean of ground points (class 2) in each cell, or the highest first return where no point
/// is called ground. Cells without a point are void.
///
/// * `most_nodes`: largest number of cells.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for a file that is damaged, larger than the limits allow, or without points.
pub(crate) fn read(path: &Path, most_nodes: usize, limits: &Limits) -> Result<Loaded<Raster>, IoError> {
    let bad = |e: crate::Fault| IoError::format(path, e);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    let _work = budget::work_on(path);
    limits.ask("the points", length).map_err(|e| bad(e.into()))?;
    let (bytes, file) = InputFile::read(path)?;
    let header = Header::of(&bytes).map_err(|e| bad(e.into()))?;
    // Of each point three numbers are kept.
    let kept = header.count.saturating_mul(size_of::<[i32; 3]>() as u64);
    limits.ask("the points", length.saturating_add(kept)).map_err(|e| bad(e.into()))?;
    let points = Points::of(&header, &bytes).map_err(|e| bad(e.into()))?;
    let grid = Grid::of(&header, points, most_nodes).map_err(|e| bad(e.into()))?;
    let (info, mut warnings) = grid.info(path, &header, &bytes);
    warnings.push(grid.said());
    let samples = grid.heights(limits).map_err(bad)?;
    let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
    Ok(Loaded::new(Raster { info, samples, mask: None }, warnings).with_file(file))
}
