//! Reading the sources of a terrain: samples as heights in metres, voids as NaN.

use super::in_bands::{self, Banded, Level};
use super::samples::{Heights, MAX_HEIGHT_M, as_requested, check_shape, heights};
use super::stated_system::{is_of_another_body, stated_system};
use super::thin::{thin, thinning};
use super::{CrsChoice, TerrainRequest, array, frame};
use crate::crs::CoordinateSystem;
use crate::formats::{Reader, ends};
use crate::fs::File;
use crate::geotiff::is_tiff;
use crate::packed::content;
use crate::pyramid::{self, Pyramid};
use crate::{Affine, GeoTiff, IoError, Limits, Loaded, Raster, RasterInfo, budget, esri_ascii, hgt, las, vrt, xyz};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Progress;
use glam::DVec2;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Share of the samples from which a frame of one value is worth a warning.
const FRAME_SHARE: f64 = 0.01;

/// Heights of one source (or of several that share a lattice).
#[derive(Debug, Clone)]
pub(crate) struct SourceGrid {
    pub(crate) path: PathBuf,
    pub(crate) cols: usize,
    pub(crate) rows: usize,
    /// Metres; NaN = void, infinite = no source covers it.
    pub(crate) heights: Vec<f32>,
    /// Model coordinates of a node, that is of a pixel centre.
    pub(crate) model_from_index: Affine,
    /// Coordinate system; `None` = not known.
    pub(crate) system: Option<CoordinateSystem>,
    /// Whether its system is of another body than the Earth.
    pub(crate) is_elsewhere: bool,
    /// Samples in the file and how many of them hold no data.
    pub(crate) samples: usize,
    pub(crate) voids: usize,
}

impl SourceGrid {
    pub(crate) fn describe(&self) -> String {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let system = self.system.as_ref().map_or("no CRS", CoordinateSystem::name);
        format!("{name}: {} x {} samples, {system}", self.cols, self.rows)
    }

    /// Model coordinates along the outline and on a lattice inside.
    pub(crate) fn outline(&self) -> impl Iterator<Item = DVec2> + '_ {
        const N: usize = 32;
        let (w, h) = (self.cols as f64 - 1.0, self.rows as f64 - 1.0);
        (0..(N + 1) * (N + 1)).map(move |i| {
            let (u, v) = ((i % (N + 1)) as f64 / N as f64, (i / (N + 1)) as f64 / N as f64);
            DVec2::from(self.model_from_index.apply(u * w, v * h))
        })
    }
}

/// Reads every source.
pub(super) fn read_all(
    paths: &[PathBuf],
    request: &TerrainRequest,
    progress: &Progress,
) -> Result<Loaded<Vec<SourceGrid>>, IoError> {
    let budgets = budgets(paths, request);
    let mut out = Loaded::clean(Vec::with_capacity(paths.len()));
    for (i, (path, budget)) in paths.iter().zip(budgets).enumerate() {
        progress.tick("reading terrain", i as f64 / paths.len() as f64)?;
        let one = read_one(path, request, budget, progress)?;
        out.value.push(one.value);
        out.warnings.extend(one.warnings);
        out.files.extend(one.files);
    }
    Ok(out)
}

/// Nodes that each of several sources may have: small ones all of theirs, others equal parts of what these leave.
fn budgets(paths: &[PathBuf], request: &TerrainRequest) -> Vec<usize> {
    // What an archive holds would have to be unpacked for its size.
    let size = |path: &PathBuf| -> Option<usize> {
        let tiff = path.is_file().then(|| GeoTiff::open(path, request.limits).ok()).flatten()?;
        Some(Level::stored(&tiff.value, 0).samples())
    };
    let sizes: Vec<usize> = match paths {
        [_] => vec![usize::MAX],
        paths => paths.iter().map(|path| size(path).unwrap_or(usize::MAX)).collect(),
    };
    shares(&sizes, request.max_nodes)
}

/// Shares of `total`, of which those of small sizes are not used up.
fn shares(sizes: &[usize], total: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|i| sizes[*i]);
    let (mut left, mut out) = (total, vec![0; sizes.len()]);
    for (done, i) in order.into_iter().enumerate() {
        let part = (left / (sizes.len() - done)).max(4);
        out[i] = part;
        left -= sizes[i].min(part).min(left);
    }
    out
}

/// The raster inside an archive, or the file itself.
pub(crate) fn meant(path: &Path, limits: &Limits) -> Result<PathBuf, IoError> {
    if path.is_dir() {
        return Ok(path.to_owned());
    }
    content(path, limits.max_bytes, &|p| Reader::Terrain.reads(p) && !ends(p, &[".txt"]))
}

fn read_one(
    path: &Path,
    request: &TerrainRequest,
    most_nodes: usize,
    progress: &Progress,
) -> Result<Loaded<SourceGrid>, IoError> {
    let array = request.arrays.find(path)?;
    let path = &array.map_or_else(|| meant(path, &request.limits), |_| Ok(path.to_owned()))?;
    if let Some(files) = vrt::sources(path)? {
        let names: Vec<String> = files.iter().map(|file| format!("\"{}\"", file.display())).collect();
        let reason = format!("is a virtual raster; name its files in its place: [{}]", names.join(", "));
        return Err(IoError::format(path, reason));
    }
    let _work = budget::work_on(path);
    let Loaded { value: read, mut warnings, files } = match array {
        Some(array) => array::read(array, request, most_nodes, progress)?,
        None => read_heights(path, request, most_nodes, progress)?,
    };
    let Heights { info, cols, rows, heights, every, factor, .. } = read;
    let bands = info.bands - usize::from(info.alpha.band().is_some());
    if bands > 1 {
        let text = format!("it has {bands} bands; the first is taken as height");
        warnings.push(Warning::new(WarningKind::Ignored, text).with("bands", bands as f64).in_file(path));
    }
    let beyond = format!(
        "samples beyond +-{MAX_HEIGHT_M:.0} m are taken as voids; nodata of its layer says what they are if the file does not"
    );
    let absurd = Warning::counted(WarningKind::Repaired, read.absurd, &beyond);
    warnings.extend(absurd.map(|w| w.settled_by("nodata").in_file(path)));
    warnings.extend(read.customary.map(|said| said.in_file(path)));
    let system = stated_system(&info, request.source_crs, request.crs == CrsChoice::Local, &mut warnings)?;
    if request.vertical_unit_m.is_none() {
        warnings.extend(unit_unsaid(&info, system.as_ref()).map(|said| said.in_file(path)));
    }
    warn_about_frame(path, &heights, cols, rows, &mut warnings);
    let model_from_index = node_map(&info);
    let model_from_index = model_from_index.after_scale_and_shift(every as f64, every as f64, 0.0, 0.0);
    if info.pixel_to_model.is_none() {
        let text = "it has no georeference; one pixel counts as one metre";
        warnings.push(Warning::new(WarningKind::Assumed, text).in_file(path));
    }
    let is_elsewhere = request.source_crs.is_none() && is_of_another_body(&info.crs);
    let (path, samples, voids) = (path.to_owned(), read.samples, read.voids);
    let grid = SourceGrid { path, cols, rows, heights, model_from_index, system, is_elsewhere, samples, voids };
    Ok(Loaded { value: within(grid, most_nodes, factor, &mut warnings), warnings, files })
}

/// From columns and rows of samples to model coordinates of their centres.
pub(super) fn node_map(info: &RasterInfo) -> Affine {
    let to_model = info.pixel_to_model.unwrap_or(Affine([1.0, 0.0, 0.0, 0.0, -1.0, info.height as f64]));
    to_model.after_scale_and_shift(1.0, 1.0, 0.5, 0.5)
}

fn read_heights(
    path: &Path,
    request: &TerrainRequest,
    most_nodes: usize,
    progress: &Progress,
) -> Result<Loaded<Heights>, IoError> {
    let Loaded { value, warnings, files } = read_raster(path, request, most_nodes, progress)?;
    let (mut raster, factor) = match value {
        Source::Whole(raster, factor) => (raster, factor),
        Source::InBands(heights) => return Ok(Loaded { value: heights, warnings, files }),
    };
    raster.info = as_requested(raster.info, request);
    check_shape(&raster.info)?;
    let heights = heights(&raster);
    Ok(Loaded { value: Heights::whole(raster.info, heights, factor, request), warnings, files })
}

/// A source of at most `budget` nodes; `factor`: ratio of its spacing to that of the file.
pub(super) fn within(mut grid: SourceGrid, budget: usize, factor: f64, warnings: &mut Vec<Warning>) -> SourceGrid {
    let mut thinned = factor;
    if let Some(k) = thinning(grid.cols, grid.rows, budget) {
        (grid.heights, grid.cols, grid.rows) = thin(&grid.heights, grid.cols, grid.rows, k);
        grid.model_from_index = grid.model_from_index.after_scale_and_shift(k as f64, k as f64, 0.0, 0.0);
        thinned *= k as f64;
    }
    if thinned > 1.0 {
        let text =
            format!("only about every {thinned:.0}th sample along each side is used, to keep at most {budget} nodes");
        let warning =
            Warning::new(WarningKind::Reduced, text).with("every", thinned).with("budget_nodes", budget as f64);
        warnings.push(warning.in_file(&grid.path));
    }
    grid
}

/// As [`within`], of a source that is kept.
pub(super) fn copied_within(grid: &SourceGrid, most_nodes: usize, warnings: &mut Vec<Warning>) -> SourceGrid {
    let Some(k) = thinning(grid.cols, grid.rows, most_nodes) else { return grid.clone() };
    let (heights, cols, rows) = thin(&grid.heights, grid.cols, grid.rows, k);
    let SourceGrid { path, system, .. } = grid;
    let (path, system) = (path.clone(), system.clone());
    let model_from_index = grid.model_from_index.after_scale_and_shift(k as f64, k as f64, 0.0, 0.0);
    let (is_elsewhere, samples, voids) = (grid.is_elsewhere, grid.samples, grid.voids);
    let small = SourceGrid { path, cols, rows, heights, model_from_index, system, is_elsewhere, samples, voids };
    within(small, most_nodes, k as f64, warnings)
}

enum Source {
    /// A raster, and the ratio of its spacing to that of the file.
    Whole(Raster, f64),
    InBands(Heights),
}

fn read_raster(
    path: &Path,
    request: &TerrainRequest,
    budget: usize,
    progress: &Progress,
) -> Result<Loaded<Source>, IoError> {
    if path.is_dir() || pyramid::is_pyramid(path) {
        return read_pyramid(path, request, budget, progress);
    }
    let mut magic = [0u8; 4];
    let mut file = File::open(path).map_err(|e| IoError::os(path, e))?;
    let got = file.read(&mut magic).map_err(|e| IoError::os(path, e))?;
    let extension = crate::recognise::ending(path);
    let magic = &magic[..got];
    if is_tiff(magic) {
        return read_tiff(path, request, budget, progress);
    }
    let loaded = match extension.as_str() {
        "hgt" => hgt::read(path, &request.limits)?,
        "xyz" => xyz::read(path, &request.limits)?,
        "txt" if is_xyz(path)? => xyz::read(path, &request.limits)?,
        "asc" | "grd" | "txt" => esri_ascii::read(path, &request.limits)?,
        "las" | "laz" => las::read(path, budget, &request.limits)?,
        _ => {
            let wanted = "an elevation model: GeoTIFF, SRTM .hgt, ESRI ASCII .asc, XYZ on a grid, points of LAS or LAZ, or tiles of heights as .mbtiles, .pmtiles or a folder (all also in .zip and .gz)";
            return Err(crate::recognise::not_a(path, wanted));
        }
    };
    Ok(loaded.map(|raster| Source::Whole(raster, 1.0)))
}

/// Whether a text is a grid as lines of coordinates.
fn is_xyz(path: &Path) -> Result<bool, IoError> {
    Ok(crate::recognise::of_content(path)?.is_some_and(|format| format.name == "XYZ"))
}

fn read_tiff(
    path: &Path,
    request: &TerrainRequest,
    budget: usize,
    progress: &Progress,
) -> Result<Loaded<Source>, IoError> {
    let Loaded { value: tiff, warnings, .. } = GeoTiff::open(path, request.limits)?;
    check_shape(tiff.info())?;
    // the largest level within the budget, else the smallest there is; what was left out of the file costs nothing
    let levels = (0..tiff.levels()).map(|level| Level::stored(&tiff, level));
    let (mut fitting, mut smallest) = (None, None);
    for level in levels {
        if level.samples() <= budget {
            fitting = Some(level);
            break;
        }
        smallest = Some(level);
    }
    let Some(level) = fitting else {
        let level = smallest.unwrap_or_else(|| Level::stored(&tiff, 0));
        let (heights, file) = rayon::join(|| in_bands::read(&level, request, budget, progress), || tiff.input());
        return Ok(Loaded::new(Source::InBands(heights?), warnings).with_file(file?));
    };
    // Samples, heights, and marks of heights that were looked at.
    let info = level.info();
    let stored = info.bands as u64 * info.sample_type.size() as u64;
    let pixels = info.width as u64 * info.height as u64;
    let peak = pixels.saturating_mul(stored + 5);
    request.limits.check(peak).map_err(|reason| IoError::format(path, reason))?;
    let (raster, file) = rayon::join(|| level.read(progress), || tiff.input());
    Ok(Loaded::new(Source::Whole(raster?, level.factor()), warnings).with_file(file?))
}

fn read_pyramid(
    path: &Path,
    request: &TerrainRequest,
    budget: usize,
    progress: &Progress,
) -> Result<Loaded<Source>, IoError> {
    let Loaded { value: pyramid, mut warnings, mut files } = Pyramid::open(path, request.limits)?;
    let last = pyramid.levels() - 1;
    let level = (0..last).find(|level| pyramid.samples(*level) <= budget).unwrap_or(last);
    let raster = pyramid.read(level, progress)?;
    let (of_tiles, damaged) = pyramid.left_behind();
    files.extend(of_tiles);
    warnings.extend(damaged);
    let factor = (level as f64).exp2();
    Ok(Loaded { value: Source::Whole(raster, factor), warnings, files })
}

/// A warning if the unit of heights is not stated, so that metres are taken, and the plane has another unit.
fn unit_unsaid(info: &RasterInfo, system: Option<&CoordinateSystem>) -> Option<Warning> {
    let plane = info.linear_unit_m.or_else(|| system?.metres_per_unit())?;
    if info.vertical_unit_said || (plane - 1.0).abs() < 1e-6 {
        return None;
    }
    let (unit, option) = match plane {
        u if (u - 1200.0 / 3937.0).abs() < 1e-9 => ("US survey feet".to_owned(), "us-ft"),
        u if (u - 0.3048).abs() < 1e-9 => ("feet".to_owned(), "ft"),
        u => (format!("units of {u} m"), "ft"),
    };
    let text = format!(
        "its plane counts in {unit} and nothing says in which unit heights are, so they count as metres; if they are feet the relief is 3.28 times too high: vertical_unit = \"{option}\" of its layer settles it (\"m\" confirms metres)"
    );
    Some(Warning::new(WarningKind::Assumed, text).with("plane_unit_m", plane).settled_by("vertical_unit"))
}

/// Warns about a frame of one value around the data: it may be voids that the file does not declare, or sea, so the heights stay.
fn warn_about_frame(path: &Path, heights: &[f32], cols: usize, rows: usize, warnings: &mut Vec<Warning>) {
    let corners = [0, cols - 1, (rows - 1) * cols, rows * cols - 1].map(|i| heights[i]);
    let Some(value) = corners.into_iter().find(|v| v.is_finite() && corners.iter().filter(|w| *w == v).count() >= 2)
    else {
        return;
    };
    // such values are the lowest or the highest there are
    let known = || heights.iter().filter(|h| h.is_finite());
    if known().any(|h| *h < value) && known().any(|h| *h > value) {
        return;
    }
    let count = frame::at_edge(heights, cols, rows, value);
    let share = count as f64 / heights.len() as f64;
    if share >= FRAME_SHARE && count < heights.len() {
        let text = format!(
            "{count} samples ({:.1} %) at the edge are all exactly {value}: sea, or voids that the file does not declare; nodata = {value} of its layer makes them voids",
            100.0 * share
        );
        let warning = Warning::new(WarningKind::Suspect, text).with("count", count as f64).with("share", share);
        let warning = warning.settled_by("nodata");
        warnings.push(warning.with("height_m", f64::from(value)).in_file(path));
    }
}

#[cfg(test)]
mod tests {
    use super::shares;

    #[test]
    fn small_sizes_leave_what_they_do_not_need_to_large_ones() {
        assert_eq!(shares(&[1 << 20, 25_600, 4 << 20], 100_000), [37_200, 33_333, 37_200]);
        assert_eq!(shares(&[usize::MAX], 1000), [1000]);
        assert_eq!(shares(&[usize::MAX; 4], 1000), [250; 4]);
        assert_eq!(shares(&[10, 10], 5), [4, 4], "never less than a cell");
    }
}
