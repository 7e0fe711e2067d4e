//! Reads and writes solved grids of terrain disocclusion as GeoTIFF files.

use crate::BelvedereError;
use belvedere_core::DVec2;
use belvedere_core::grid::Grid;
use belvedere_io::geotiff::{GeoTiff, write_geotiff};
use belvedere_io::{Affine, CrsKind, Limits, Raster, RasterInfo, SampleType, Samples, SourceCrs};
use belvedere_scene::{Crs, Progress};
use std::path::Path;

/// Largest height change, metres.
const MOST_M: f64 = 100_000.0;

/// The grid of height changes in a GeoTIFF: one band, in the scene's coordinate system, no-data = 0.
pub(super) fn read(path: &Path, bytes: Vec<u8>, crs: Crs) -> Result<Grid, String> {
    let file = GeoTiff::from_bytes(path, bytes, Limits::default()).map_err(|e| e.to_string())?.value;
    let info = file.info();
    let shown = path.display();
    if info.bands != 1 {
        return Err(format!(
            "{shown}: a delta has one band, this raster has {}; give the height changes alone",
            info.bands
        ));
    }
    if let (SourceCrs::Epsg(found), Crs::Epsg(scene)) = (&info.crs, crs)
        && *found != scene
    {
        return Err(format!(
            "{shown}: the delta is in EPSG:{found}, the scene in EPSG:{scene}; solve it for this scene, or set crs"
        ));
    }
    let map = info
        .pixel_to_model
        .filter(|m| m.is_north_up())
        .ok_or_else(|| format!("{shown}: the delta has no georeference with rows along the axes; write it with one"))?;
    let raster = file.read(0, &Progress::silent()).map_err(|e| e.to_string())?;
    let (cols, rows) = (info.width, info.height);
    let value = |i: usize| raster.sample_f64(0, i % cols, i / cols).filter(|v| v.is_finite()).unwrap_or(0.0);
    let values: Vec<f64> = (0..cols * rows).map(value).collect();
    if let Some(i) = values.iter().position(|v| v.abs() > MOST_M) {
        return Err(format!(
            "{shown}: the height change in column {}, row {} is {:e} m, at most {MOST_M} m either way can be drawn; solve it again",
            i % cols,
            i / cols,
            values[i]
        ));
    }
    let [x, y] = map.apply(0.5, 0.5);
    let spacing = DVec2::new(map.0[0], -map.0[4]);
    Grid::new(DVec2::new(x, y), spacing, cols, rows, values).map_err(|e| format!("{shown}: {e}"))
}

/// Writes a grid of height changes so that reading it returns the same values.
pub fn write(path: &Path, grid: &Grid, crs: Crs, overwrite: bool) -> Result<(), BelvedereError> {
    let mut info = RasterInfo::new(path, grid.cols(), grid.rows(), SampleType::F64);
    let (start, step) = (grid.north_west(), grid.spacing());
    // A node is the centre of a pixel.
    let corner = Affine([step.x, 0.0, start.x, 0.0, -step.y, start.y]).after_scale_and_shift(1.0, 1.0, -0.5, -0.5);
    info.pixel_to_model = Some(corner);
    if let Crs::Epsg(code) = crs {
        (info.crs, info.crs_kind) = (SourceCrs::Epsg(code), CrsKind::Projected);
    }
    let raster = Raster { info, samples: Samples::F64(grid.values().to_vec()), mask: None };
    Ok(write_geotiff(path, &raster, overwrite)?)
}
