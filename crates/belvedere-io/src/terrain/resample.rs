//! Resampling of sources to the axis-aligned grid of a scene.

use super::bilinear::Bilinear;
use super::grid_map::{Geometry, GridMap, Link};
use super::seam::drawn_over;
use super::source::SourceGrid;
use super::{ResampleError, TerrainRequest};
use crate::IoError;
use crate::crs::CoordinateSystem;
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::Progress;
use glam::DVec2;
use rayon::prelude::*;

/// Accuracy of the interpolated map between grids, cells.
const MAP_TOLERANCE: f64 = 1e-3;
/// Slack at the border for that inaccuracy, cells.
const EDGE_MARGIN: f64 = 2e-3;
/// Rounds of correction.
const CORRECTIONS: usize = 2;
/// Finest spacing, relative to the source's.
const FINEST: f64 = 0.5;
/// Bins of the error histogram per metre and in all.
const BINS_PER_M: f32 = 64.0;
const BINS: usize = 1 << 16;

/// The grid of a scene before it becomes a heightfield: NaN = void, infinite = outside every source.
#[derive(Debug, Clone)]
pub(crate) struct SceneGrid {
    pub(crate) geometry: Geometry,
    pub(crate) cols: usize,
    pub(crate) rows: usize,
    pub(crate) heights: Vec<f32>,
}

impl SceneGrid {
    /// Removes border rows and columns without any height; returns the numbers removed at the west and the north.
    pub(super) fn trim(&mut self) -> [usize; 2] {
        let (cols, rows) = (self.cols, self.rows);
        let has = |c: usize, r: usize| self.heights[r * cols + c].is_finite();
        let full_row = |r: &usize| (0..cols).any(|c| has(c, *r));
        let Some(top) = (0..rows).find(full_row) else { return [0; 2] };
        let bottom = (0..rows).rev().find(full_row).unwrap_or(top);
        let full_col = |c: &usize| (top..=bottom).any(|r| has(*c, r));
        let left = (0..cols).find(full_col).unwrap_or(0);
        let right = (0..cols).rev().find(full_col).unwrap_or(left);
        // a heightfield needs two nodes each way
        let widen = |a: usize, b: usize, n: usize| {
            if b > a {
                (a, b)
            } else if b + 1 < n {
                (a, b + 1)
            } else {
                (a.saturating_sub(1), b)
            }
        };
        let ((left, right), (top, bottom)) = (widen(left, right, cols), widen(top, bottom, rows));
        if (left, top, right + 1, bottom + 1) == (0, 0, cols, rows) {
            return [0; 2];
        }
        let kept = |r: usize| self.heights[r * cols + left..=r * cols + right].iter().copied();
        self.heights = (top..=bottom).flat_map(kept).collect();
        self.geometry.north_west = self.geometry.scene_from_index(DVec2::new(left as f64, top as f64));
        (self.cols, self.rows) = (right - left + 1, bottom - top + 1);
        [left, top]
    }
}

/// The source without resampling, if it is axis-aligned in the system of the scene.
pub(super) fn exact(source: &SourceGrid, target: Option<&CoordinateSystem>) -> Option<SceneGrid> {
    if target.is_some() && source.system.as_ref() != target {
        return None;
    }
    let scale = match target {
        None => source.system.as_ref().and_then(CoordinateSystem::metres_per_unit).unwrap_or(1.0),
        Some(_) => 1.0,
    };
    let [a, b, c, d, e, f] = source.model_from_index.0.map(|v| v * scale);
    let (cols, rows) = (source.cols, source.rows);
    let skew = (b * rows as f64).abs().max((d * cols as f64).abs());
    // a skew of less than a millionth of a cell over the whole raster is rounding
    if skew > 1e-6 * a.abs().min(e.abs()) {
        return None;
    }
    let x = if a > 0.0 { c } else { c + a * (cols - 1) as f64 };
    let y = if e < 0.0 { f } else { f + e * (rows - 1) as f64 };
    let mut heights = source.heights.clone();
    if a < 0.0 {
        heights.par_chunks_exact_mut(cols).for_each(<[f32]>::reverse);
    }
    if e > 0.0 {
        heights = heights.chunks_exact(cols).rev().flatten().copied().collect();
    }
    let geometry = Geometry { north_west: DVec2::new(x, y), spacing: DVec2::new(a.abs(), e.abs()) };
    Some(SceneGrid { geometry, cols, rows, heights })
}

/// Resamples to a grid about as fine as the source, or finer (at most twice, and only up to the request's
/// `refine_to_nodes`) where the relief is too rough for the bound on the error at the source's samples.
///
/// Heights are bilinear in the source. Where a single source misses the bound, the residuals at its samples are added
/// back, again bilinearly, within the range of the four samples around each node (iterated back-projection: what the
/// scene's own bilinear surface loses at the samples is given to the nodes around them; ours). With several sources the
/// grid is as fine as the finest.
pub(super) fn resample(
    sources: &[SourceGrid],
    links: &[Link],
    request: &TerrainRequest,
    warnings: &mut Vec<Warning>,
    progress: &Progress,
) -> Result<(SceneGrid, Option<ResampleError>), IoError> {
    let mut planned = plan(sources, links, 1.0)?;
    let nodes = planned.cols as f64 * planned.rows as f64;
    if nodes > request.max_nodes as f64 {
        planned = shrink(planned, sources, links, request.max_nodes, warnings)?;
    } else if sources.len() == 1 && roughness_p99(&sources[0]) > request.max_error_p99_m {
        let allowed = request.refine_to_nodes.min(request.max_nodes) as f64;
        let factor = (1.001 * (nodes / allowed).sqrt()).clamp(FINEST, 1.0);
        if factor < 1.0 {
            planned = plan(sources, links, factor)?;
        }
    }
    progress.tick("resampling terrain", 0.0)?;
    Ok(at_spacing(planned, sources, links, request.max_error_p99_m, warnings))
}

/// 99th percentile of the possible error of resampling to the same spacing at a sample, metres, from second differences `d`:
/// a bilinear surface is off by up to `(|d_x| + |d_y|) / 8` between its nodes, and two of them are used.
fn roughness_p99(source: &SourceGrid) -> f64 {
    let (cols, rows) = (source.cols, source.rows);
    let h = &source.heights;
    let mut histogram = Histogram::new();
    // a sixteenth of the samples suffices
    for r in (1..rows - 1).step_by(4) {
        for c in (1..cols - 1).step_by(4) {
            let i = r * cols + c;
            let along = (h[i - 1] - 2.0 * h[i] + h[i + 1]).abs();
            let across = (h[i - cols] - 2.0 * h[i] + h[i + cols]).abs();
            histogram.add(0.25 * (along + across));
        }
    }
    histogram.percentile(0.99)
}

/// Counts of magnitudes, for percentiles without sorting.
struct Histogram {
    bins: Vec<u32>,
    count: u64,
}

impl Histogram {
    fn new() -> Self {
        Self { bins: vec![0; BINS], count: 0 }
    }

    /// Counts a value unless it is NaN or infinite.
    fn add(&mut self, v: f32) {
        if v.is_finite() {
            self.bins[((v.abs() * BINS_PER_M) as usize).min(BINS - 1)] += 1;
            self.count += 1;
        }
    }

    /// Upper end of the bin where the share is reached; 0 if nothing was counted.
    fn percentile(&self, share: f64) -> f64 {
        let wanted = (self.count as f64 * share).ceil() as u64;
        let mut seen = 0u64;
        let bin = self.bins.iter().position(|&n| {
            seen += u64::from(n);
            self.count > 0 && seen >= wanted
        });
        bin.map_or(0.0, |b| (b + 1) as f64 / f64::from(BINS_PER_M))
    }
}

/// Heights and error on a planned grid.
fn at_spacing(
    mut grid: SceneGrid,
    sources: &[SourceGrid],
    links: &[Link],
    bound_m: f64,
    warnings: &mut Vec<Warning>,
) -> (SceneGrid, Option<ResampleError>) {
    let geometry = grid.geometry;
    let mut maps_inputs = Vec::new();
    for link in links {
        maps_inputs.push(move |index: DVec2| link.index_from_scene(geometry.scene_from_index(index)));
    }
    let map = |exact| GridMap::new(grid.cols, grid.rows, MAP_TOLERANCE, exact);
    if let ([source], [exact]) = (sources, maps_inputs.as_slice()) {
        grid.heights = drawn(&grid, source, &map(exact));
    } else {
        let maps: Vec<GridMap<'_>> = maps_inputs.iter().map(|exact| map(exact)).collect();
        grid.heights = drawn_over([grid.cols, grid.rows], sources, &maps, warnings);
    }
    let ([source], [link], [back]) = (sources, links, maps_inputs.as_slice()) else {
        return (grid, None);
    };
    let forth = |index: DVec2| link.scene_from_index(index).map(|p| geometry.index_from_scene(p));
    let to_scene = GridMap::new(source.cols, source.rows, MAP_TOLERANCE, &forth);
    let mut residual = vec![0.0f32; source.heights.len()];
    let mut error = residuals(&grid, source, &to_scene, &mut residual);
    let to_source = GridMap::new(grid.cols, grid.rows, MAP_TOLERANCE, back);
    for _ in 0..CORRECTIONS {
        if error.p99_m <= bound_m {
            break;
        }
        add_back(&mut grid, source, &to_source, &residual);
        error = residuals(&grid, source, &to_scene, &mut residual);
    }
    (grid, Some(error))
}

/// Geometry of a grid that covers every source, about as fine as the finest, times `factor`.
fn plan(sources: &[SourceGrid], links: &[Link], factor: f64) -> Result<SceneGrid, IoError> {
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let mut spacing = DVec2::INFINITY;
    for (source, link) in sources.iter().zip(links) {
        for p in boundary(source).into_iter().filter_map(|i| link.scene_from_index(i)) {
            min = min.min(p);
            max = max.max(p);
        }
        if let Some(s) = link.spacing_near([source.cols, source.rows]) {
            spacing = spacing.min(s);
        }
    }
    let placed = min.is_finite() && max.is_finite() && spacing.is_finite() && spacing.min_element() > 0.0;
    if !placed {
        let reason =
            "no part of it can be placed in the CRS of the scene; check its georeference or choose another crs";
        return Err(IoError::format(&sources[0].path, reason));
    }
    let spacing = (spacing * factor).map(round_down);
    let size = ((max - min) / spacing).ceil() + 1.0;
    if size.max_element() > 1e6 {
        let reason = format!(
            "its scene grid would have {} x {} nodes; the sources lie too far apart or the projection is unfit there, load fewer or choose another crs",
            size.x, size.y
        );
        return Err(IoError::format(&sources[0].path, reason));
    }
    if let Some(lattice) = sources.first().zip(links.first()).and_then(|(s, l)| l.lattice([s.cols, s.rows]))
        && sources.len() > 1
    {
        return Ok(on_lattice(lattice, min, max));
    }
    // the overhang is shared by both sides
    let overhang = 0.5 * ((size - 1.0) * spacing - (max - min));
    let north_west = DVec2::new(min.x - overhang.x, max.y + overhang.y);
    let (cols, rows) = ((size.x as usize).max(2), (size.y as usize).max(2));
    Ok(SceneGrid { geometry: Geometry { north_west, spacing }, cols, rows, heights: Vec::new() })
}

/// A grid over an extent whose nodes are those of a lattice, so that the finest source keeps its samples.
fn on_lattice(lattice: Geometry, min: DVec2, max: DVec2) -> SceneGrid {
    const ROUNDING: f64 = 1e-6;
    let [first, last] = [DVec2::new(min.x, max.y), DVec2::new(max.x, min.y)].map(|p| lattice.index_from_scene(p));
    let (first, last) = ((first + ROUNDING).floor(), (last - ROUNDING).ceil());
    let [cols, rows] = (last - first + 1.0).to_array().map(|n| (n as usize).max(2));
    let north_west = lattice.scene_from_index(first);
    SceneGrid { geometry: Geometry { north_west, ..lattice }, cols, rows, heights: Vec::new() }
}

/// Extents of grids over the ground that their sources cover, beyond which these lie too far apart.
const MOSTLY_EMPTY: f64 = 16.0;

/// A coarser plan with at most `max_nodes`.
fn shrink(
    grid: SceneGrid,
    sources: &[SourceGrid],
    links: &[Link],
    max_nodes: usize,
    warnings: &mut Vec<Warning>,
) -> Result<SceneGrid, IoError> {
    let nodes = grid.cols as f64 * grid.rows as f64;
    let ground = |(source, link): (&SourceGrid, &Link)| {
        let cell = link.spacing_near([source.cols, source.rows]).unwrap_or(DVec2::ZERO);
        cell.element_product() * source.heights.len() as f64
    };
    let covered: f64 = sources.iter().zip(links).map(ground).sum();
    if nodes * grid.geometry.spacing.element_product() > MOSTLY_EMPTY * covered {
        let reason = format!(
            "its scene grid would have {} x {} nodes, of which the sources cover less than one in {MOSTLY_EMPTY:.0}, the limit is {max_nodes}; they lie too far apart, load fewer",
            grid.cols, grid.rows
        );
        return Err(IoError::format(&sources[0].path, reason));
    }
    let k = (nodes / max_nodes as f64).sqrt() * 1.001;
    let fewer = |n: usize| ((((n - 1) as f64) / k).floor() as usize + 1).max(2);
    let (cols, rows) = (fewer(grid.cols), fewer(grid.rows));
    let span = DVec2::new((grid.cols - 1) as f64, (grid.rows - 1) as f64) * grid.geometry.spacing;
    let spacing = span / DVec2::new((cols - 1) as f64, (rows - 1) as f64);
    if sources.len() > 1 {
        let [finest, taken] = [grid.geometry.spacing, spacing].map(|s| s.max_element());
        let text = format!(
            "the ground is drawn every {taken:.1} m instead of every {finest:.1} m, as the finest file has it, to keep at most {max_nodes} nodes over all of them; crop the coarser ones to what is looked at"
        );
        let warning = Warning::new(WarningKind::Reduced, text).with("spacing_m", taken).with("finest_m", finest);
        warnings.push(warning.with("budget_nodes", max_nodes as f64).in_file(&sources[0].path));
    }
    Ok(SceneGrid { geometry: Geometry { spacing, ..grid.geometry }, cols, rows, heights: Vec::new() })
}

/// Node indices around the source and on a coarse lattice inside.
fn boundary(source: &SourceGrid) -> Vec<DVec2> {
    const N: usize = 128;
    let (w, h) = ((source.cols - 1) as f64, (source.rows - 1) as f64);
    let mut out = Vec::with_capacity(4 * N + 4 + N * N / 16);
    for i in 0..=N {
        let t = i as f64 / N as f64;
        out.extend([(t * w, 0.0), (t * w, h), (0.0, t * h), (w, t * h)].map(DVec2::from));
        if i % 8 == 0 {
            out.extend((0..=N / 8).map(|j| DVec2::new(t * w, 8.0 * j as f64 / N as f64 * h)));
        }
    }
    out
}

/// A spacing rounded down to three significant digits, for reading.
fn round_down(v: f64) -> f64 {
    let digits = v.log10().floor() - 2.0;
    // dividing by a power of ten gives the decimal number's own bits
    let rounded = if digits < 0.0 {
        (v * 10f64.powf(-digits)).floor() / 10f64.powf(-digits)
    } else {
        (v / 10f64.powf(digits)).floor() * 10f64.powf(digits)
    };
    if rounded > 0.0 && rounded.is_finite() { rounded } else { v }
}

/// Bilinear heights of a source on the nodes of a grid.
fn drawn(grid: &SceneGrid, source: &SourceGrid, map: &GridMap<'_>) -> Vec<f32> {
    let of_source = Bilinear::new(&source.heights, [source.cols, source.rows], EDGE_MARGIN);
    let mut heights = vec![f32::INFINITY; grid.cols * grid.rows];
    heights.par_chunks_exact_mut(grid.cols).enumerate().for_each_init(
        || vec![DVec2::ZERO; grid.cols],
        |indices, (r, row)| {
            map.row(r, indices);
            row.iter_mut().zip(indices.iter()).for_each(|(h, &index)| *h = of_source.at(index));
        },
    );
    heights
}

/// Source minus scene at every sample of the source that has both; NaN elsewhere.
fn residuals(grid: &SceneGrid, source: &SourceGrid, map: &GridMap<'_>, out: &mut [f32]) -> ResampleError {
    let cols = source.cols;
    let drawn = Bilinear::new(&grid.heights, [grid.cols, grid.rows], 0.0);
    let per_row: Vec<(f32, f64)> = out
        .par_chunks_exact_mut(cols)
        .zip(source.heights.par_chunks_exact(cols))
        .enumerate()
        .map_init(
            || vec![DVec2::ZERO; cols],
            |indices, (r, (out, heights))| {
                map.row(r, indices);
                let (mut max, mut squares) = (0.0f32, 0.0f64);
                for ((out, &h), &index) in out.iter_mut().zip(heights).zip(indices.iter()) {
                    let e = h - drawn.at(index);
                    *out = if e.is_finite() { e } else { f32::NAN };
                    if e.is_finite() {
                        max = max.max(e.abs());
                        squares += f64::from(e) * f64::from(e);
                    }
                }
                (max, squares)
            },
        )
        .collect();
    let max = per_row.iter().map(|r| r.0).fold(0.0, f32::max);
    let squares: f64 = per_row.iter().map(|r| r.1).sum();
    let mut histogram = Histogram::new();
    out.iter().for_each(|&e| histogram.add(e));
    let p99 = histogram.percentile(0.99).min(f64::from(max));
    ResampleError { max_m: f64::from(max), p99_m: p99, rms_m: (squares / histogram.count.max(1) as f64).sqrt() }
}

/// Adds the residuals to the nodes around them.
fn add_back(grid: &mut SceneGrid, source: &SourceGrid, map: &GridMap<'_>, residual: &[f32]) {
    let cols = grid.cols;
    let [residual, heights] =
        [residual, &source.heights].map(|of| Bilinear::new(of, [source.cols, source.rows], EDGE_MARGIN));
    grid.heights.par_chunks_exact_mut(cols).enumerate().for_each_init(
        || vec![DVec2::ZERO; cols],
        |indices, (r, row)| {
            map.row(r, indices);
            for (h, &index) in row.iter_mut().zip(indices.iter()) {
                if !h.is_finite() {
                    continue;
                }
                let e = residual.at(index);
                if e.is_finite() {
                    // within the samples around it: lakes stay flat, cliffs do not ring
                    let [low, high] = heights.range_around(index);
                    *h = (*h + e).clamp(low, high);
                }
            }
        },
    );
}
