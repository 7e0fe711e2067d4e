//! Source rasters to one [`Heightfield`] of a scene.
//!
//! Axis-aligned rasters in the scene's own CRS are used exactly: a node is a pixel centre. Everything else is resampled
//! bilinearly to an axis-aligned metric grid of about the source's spacing, and the error at the source's own samples is
//! measured and bounded (see [`ResampleError`]). Voids stay voids unless they are filled, and filled nodes are marked.

mod array;
mod bilinear;
mod fill;
mod frame;
mod grid_map;
mod in_bands;
mod original;
mod resample;
mod samples;
mod sea_voids;
mod seam;
mod sentinels;
mod source;
mod stated_system;
mod survey;
mod thin;
mod together;

use crate::crs::{CoordinateSystem, Transform, utm_epsg};
use crate::{Arrays, Fault, IoError, Limits, Loaded};
use belvedere_core::{Warning, WarningKind};
use belvedere_scene::{Crs, Heightfield, HeightfieldError, NodeState, Progress};
use glam::DVec2;
pub(crate) use grid_map::{Geometry, GridMap, Link};
pub use original::{OriginalTerrain, load_original, moved_terrain};
pub(crate) use stated_system::stated_system;
pub use survey::{TerrainSurvey, survey};

use resample::SceneGrid;
use source::SourceGrid;
use std::path::{Path, PathBuf};

/// Which CRS the scene gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CrsChoice {
    /// The terrain's own if it is projected in metres, else the WGS 84 UTM zone of its centre; local without georeference.
    #[default]
    Auto,
    /// This projected system in metres.
    Epsg(u32),
    /// No georeference: the source's own coordinates, in metres.
    Local,
}

/// How to load terrain.
#[derive(Debug, Clone, PartialEq)]
pub struct TerrainRequest {
    /// CRS of the scene.
    pub crs: CrsChoice,
    /// Closes holes inside the data by a smooth membrane and marks the nodes [`NodeState::Filled`].
    pub fill_voids: bool,
    /// Holes of more than this share of the nodes stay open: filled heights there would be invented.
    pub largest_hole: f64,
    /// Makes holes at the edge that are sea ground at 0, marked [`NodeState::Filled`]: those of at least 100 nodes and a
    /// twentieth of the ground, of whose shore nine of ten nodes stand 0 to 30 m high, and half not above 10 m.
    pub sea: bool,
    /// Sources in memory, which paths `array:NAME` mean.
    pub arrays: Arrays,
    /// Memory for decoded samples.
    pub limits: Limits,
    /// Most nodes of the heightfield; larger sources are thinned out.
    pub max_nodes: usize,
    /// EPSG code of the sources, in place of those in the files.
    pub source_crs: Option<u32>,
    /// Stored value that means "no data", in place of those in the files.
    pub nodata: Option<f64>,
    /// Metres per unit of the heights, in place of those in the files; > 0.
    pub vertical_unit_m: Option<f64>,
    /// Bound on the 99th percentile of the resampling error at the source's samples, metres. Where the relief is too
    /// rough for it the grid is made up to twice as fine as the source, within [`Self::refine_to_nodes`].
    pub max_error_p99_m: f64,
    /// Most nodes that refining for [`Self::max_error_p99_m`] may make; what the source itself needs is always allowed.
    pub refine_to_nodes: usize,
}

impl Default for TerrainRequest {
    fn default() -> Self {
        Self {
            crs: CrsChoice::Auto,
            fill_voids: false,
            largest_hole: 1.0,
            sea: false,
            arrays: Arrays::default(),
            limits: Limits::default(),
            max_nodes: 16_000_000,
            source_crs: None,
            nodata: None,
            vertical_unit_m: None,
            max_error_p99_m: 2.0,
            refine_to_nodes: 2_000_000,
        }
    }
}

/// Error of the resampled surface in height, metres, at the source's samples.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ResampleError {
    /// Largest error.
    pub max_m: f64,
    /// 99th percentile, rounded up to the next 1/64 m.
    pub p99_m: f64,
    /// Root mean square.
    pub rms_m: f64,
}

/// Terrain as loaded.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedTerrain {
    /// Heights in scene coordinates.
    pub heightfield: Heightfield,
    /// CRS of the scene.
    pub crs: Crs,
    /// Share of the source's samples that hold no data, 0..=1.
    pub void_share: f64,
    /// Number of those samples.
    pub void_samples: usize,
    /// Share of the heightfield's nodes that were filled, 0..=1.
    pub filled_share: f64,
    /// One line per source: file, size, CRS.
    pub sources: Vec<String>,
    /// Distance of the first source's samples at its centre along its columns and rows, metres of the scene CRS.
    pub source_spacing_m: DVec2,
    /// Error of resampling; `None` if the samples are used as they are.
    pub resample_error: Option<ResampleError>,
    /// West, south, east and north, degrees; east may pass 180. `None` without georeference.
    pub extent_deg: Option<[f64; 4]>,
}

/// Widest extent east to west from the middle for which a UTM zone is chosen by itself, degrees of the equator.
const UTM_MAX_HALF_WIDTH_DEG: f64 = 20.0;

/// Resampling errors above this give a warning, metres; smaller ones are within the accuracy of global elevation models.
const WARN_P99_M: f64 = 16.0;

/// Loads one or several rasters (GeoTIFF, `.hgt`, zipped `.hgt`, ESRI ASCII, arrays of the request) as the terrain of a scene, in any
/// order. Where several overlap the finest that has data is taken, blended over the others along its border.
///
/// # Errors
/// [`IoError::Os`], [`IoError::Format`] with one sentence that names the file and the remedy, [`IoError::Cancelled`].
pub fn load_terrain(
    paths: &[PathBuf],
    request: &TerrainRequest,
    progress: &Progress,
) -> Result<Loaded<LoadedTerrain>, IoError> {
    let Some(first) = paths.first() else {
        return Err(IoError::format("terrain", "no source is given; name at least one raster"));
    };
    if request.max_nodes < 4 {
        return Err(IoError::format(first, format!("max_nodes is {}, at least 4 are needed", request.max_nodes)));
    }
    let sources = source::read_all(paths, request, progress).map_err(crate::recognise::explain)?;
    in_scene(sources, request, progress)
}

/// The terrain of a scene from sources that were read.
fn in_scene(
    sources: Loaded<Vec<SourceGrid>>,
    request: &TerrainRequest,
    progress: &Progress,
) -> Result<Loaded<LoadedTerrain>, IoError> {
    let Loaded { value: mut sources, mut warnings, files } = sources;
    together::arrange(&mut sources);
    let first = &sources[0].path.clone();
    let void_samples: usize = sources.iter().map(|s| s.voids).sum();
    let samples: usize = sources.iter().map(|s| s.samples).sum();
    let descriptions = sources.iter().map(SourceGrid::describe).collect();
    let target = choose_target(&sources, request, &mut warnings)?;
    let merged = together::merge_aligned(sources, request.max_nodes, &mut warnings);
    let extent_deg = extent(&merged).map(|e| e.bounds);
    progress.tick("placing terrain", 0.0)?;
    let (mut grid, resample_error) = onto_scene_grid(&merged, &target, request, &mut warnings, progress)?;
    let source_spacing_m = Link::new(&merged[0], target.system.as_ref(), first)?.spacing_at_centre(&merged[0]);
    drop(merged);
    let all_columns = grid.cols;
    let sea = if request.sea { sea_voids::fill(grid.cols, &mut grid.heights) } else { Vec::new() };
    let [left, top] = grid.trim();
    let sea = sea.into_iter().map(|i| (i / all_columns - top) * grid.cols + i % all_columns - left).collect();
    if grid.heights.iter().all(|h| !h.is_finite()) {
        return Err(IoError::format(first, "it holds no data at all: every sample is a void; check the no-data value"));
    }
    let reach = grid.geometry.north_west.abs().max_element();
    if grid.geometry.spacing.min_element() < 1e-9 * reach {
        let reason = format!(
            "its samples are {:e} apart at coordinates of {reach:e}, finer than numbers can tell; correct its georeference",
            grid.geometry.spacing.min_element()
        );
        return Err(IoError::format(first, reason));
    }
    let ClosedHoles { states, left_open, sea, open } = states(&mut grid, sea, request, progress)?;
    let heightfield =
        Heightfield::new(grid.geometry.north_west, grid.geometry.spacing, grid.cols, grid.rows, grid.heights, states)
            .map_err(|e: HeightfieldError| IoError::format(first, e.to_string()))?;
    let void_share = void_samples as f64 / samples.max(1) as f64;
    let filled_share = heightfield.share_of(NodeState::Filled);
    if sea > 0 {
        let what = "nodes without data at the edge of a low shore were taken for sea and stand at 0 m; sea = false leaves them holes";
        warnings.extend(Warning::counted(WarningKind::Assumed, sea, what).map(|w| w.in_file(first)));
    }
    let made_up = filled_share - sea as f64 / heightfield.states().len() as f64;
    if sea == 0 || open || made_up > 1e-12 {
        warn_about_voids(first, void_samples, void_share, made_up, left_open, &mut warnings);
    }
    let value = LoadedTerrain {
        heightfield,
        crs: target.crs,
        void_share,
        void_samples,
        filled_share,
        sources: descriptions,
        source_spacing_m,
        resample_error,
        extent_deg,
    };
    progress.tick("placing terrain", 1.0)?;
    Ok(Loaded { value, warnings, files })
}

fn warn_about_voids(path: &Path, voids: usize, share: f64, filled: f64, left_open: usize, warnings: &mut Vec<Warning>) {
    if voids == 0 {
        return;
    }
    let large = match left_open {
        0 => String::new(),
        1 => ", but for a large one, which stays open".to_owned(),
        n => format!(", but for {n} large ones, which stay open"),
    };
    let (kind, fate) = if filled > 0.0 {
        (WarningKind::Repaired, format!("holes were filled, {:.2} % of the nodes{large}", 100.0 * filled))
    } else if left_open > 0 {
        let fate = "they are too large to be filled and stay holes; take terrain with fewer holes";
        (WarningKind::Ignored, fate.to_owned())
    } else {
        (WarningKind::Ignored, "they stay holes; fill_voids = true closes them".to_owned())
    };
    let text = format!("{voids} samples ({:.2} %) hold no data: {fate}", 100.0 * share);
    let warning = Warning::new(kind, text).with("count", voids as f64).with("share", share);
    warnings.push(warning.with("filled_share", filled).with("left_open", left_open as f64).in_file(path));
}

/// States of the nodes after holes were closed.
struct ClosedHoles {
    states: Vec<NodeState>,
    /// Number of holes too large to be filled.
    left_open: usize,
    /// Nodes that became sea.
    sea: usize,
    /// Whether any hole remains.
    open: bool,
}

/// States of all nodes, those of `sea` among the filled ones; makes heights finite where they are filled.
fn states(
    grid: &mut SceneGrid,
    sea: Vec<usize>,
    request: &TerrainRequest,
    progress: &Progress,
) -> Result<ClosedHoles, IoError> {
    let mut states: Vec<NodeState> =
        grid.heights.iter().map(|h| if h.is_finite() { NodeState::Measured } else { NodeState::Void }).collect();
    let mut left_open = 0;
    sea.iter().for_each(|i| states[*i] = NodeState::Filled);
    if request.fill_voids {
        let most = (request.largest_hole.clamp(0.0, 1.0) * grid.heights.len() as f64) as usize;
        left_open = fill::leave_open(grid.cols, &mut grid.heights, most);
        let unknown: Vec<usize> = (0..grid.heights.len()).filter(|&i| grid.heights[i].is_nan()).collect();
        fill::fill(grid.cols, grid.rows, &mut grid.heights, progress)?;
        for i in unknown {
            if grid.heights[i].is_finite() {
                states[i] = NodeState::Filled;
            }
        }
    }
    let open = left_open > 0 || grid.heights.iter().any(|h| h.is_nan());
    for h in grid.heights.iter_mut().filter(|h| !h.is_finite()) {
        *h = 0.0;
    }
    Ok(ClosedHoles { states, left_open, sea: sea.len(), open })
}

/// CRS of the scene; `system` is `None` for a local one.
struct Target {
    crs: Crs,
    system: Option<CoordinateSystem>,
}

fn choose_target(
    sources: &[SourceGrid],
    request: &TerrainRequest,
    warnings: &mut Vec<Warning>,
) -> Result<Target, IoError> {
    let local = Target { crs: Crs::Local, system: None };
    let first = &sources[0];
    let unknown = sources.iter().find(|s| s.system.is_none());
    if request.crs == CrsChoice::Local {
        if let Some(other) = sources.iter().find(|s| s.system != first.system) {
            let reason = format!("it is in another CRS than {}; use crs = \"auto\"", first.path.display());
            return Err(IoError::format(&other.path, reason));
        }
        if first.system.as_ref().is_some_and(CoordinateSystem::is_geographic) {
            let reason =
                "its coordinates are degrees, which no local scene can put beside metres of height; use crs = \"auto\"";
            return Err(IoError::format(&first.path, reason));
        }
        return Ok(local);
    }
    if let Some(source) = unknown {
        if sources.iter().any(|s| s.system.is_some()) || request.crs != CrsChoice::Auto {
            let reason = "the file states no CRS that is understood; set its EPSG code as source_crs of its layer";
            return Err(IoError::format(&source.path, Fault::lifted_by(reason, &["source_crs"])));
        }
        if !source.is_elsewhere {
            let text =
                "no coordinate system is known, so the scene is local; source_crs of its layer places it on the earth";
            let warning = Warning::new(WarningKind::Assumed, text).settled_by("source_crs");
            warnings.push(warning.in_file(&source.path));
        }
        return Ok(local);
    }
    let chosen = match request.crs {
        CrsChoice::Epsg(code) => epsg_target(first, code)?,
        _ => auto_target(sources)?,
    };
    let system = chosen.system.as_ref();
    let mut noted: Vec<&CoordinateSystem> = Vec::new();
    for system in sources.iter().filter_map(|s| s.system.as_ref()).chain(system) {
        if !noted.contains(&system) {
            noted.push(system);
            warnings.extend(system.datum_note());
        }
    }
    warn_about_mercator(sources, &chosen, warnings);
    Ok(chosen)
}

fn epsg_target(first: &SourceGrid, code: u32) -> Result<Target, IoError> {
    let system = CoordinateSystem::from_epsg(code).map_err(|e| IoError::format(&first.path, e.to_string()))?;
    if !system.suits_scenes() {
        let reason = format!(
            "the scene cannot use {system}, it is not projected in metres with x to the east and y to the north; use crs = \"auto\" or such a system"
        );
        return Err(IoError::format(&first.path, reason));
    }
    Ok(Target { crs: Crs::Epsg(code), system: Some(system) })
}

fn auto_target(sources: &[SourceGrid]) -> Result<Target, IoError> {
    let first = &sources[0];
    if let Some(system) = first.system.as_ref().filter(|s| s.suits_scenes())
        && let Some(code) = system.epsg()
    {
        return Ok(Target { crs: Crs::Epsg(code), system: Some(system.clone()) });
    }
    let off_earth = || {
        let reason = "no part of it lies on the earth; check its georeference, or set source_crs of its layer";
        IoError::format(&first.path, Fault::lifted_by(reason, &["source_crs"]))
    };
    let Extent { bounds: [west, south, east, north], .. } = extent(sources).ok_or_else(off_earth)?;
    let centre = DVec2::new(0.5 * (west + east), 0.5 * (south + north));
    let nearest_equator = if south * north < 0.0 { 0.0 } else { south.abs().min(north.abs()) };
    let half_width = 0.5 * (east - west) * nearest_equator.to_radians().cos();
    let code = utm_epsg(centre.x, centre.y).ok_or_else(off_earth)?;
    if half_width > UTM_MAX_HALF_WIDTH_DEG && (32601..=32760).contains(&code) && code != 32661 {
        return Err(IoError::format(
            &first.path,
            format!(
                "it covers {:.0} x {:.0} degrees, too wide for a UTM zone (at most {:.0} degrees of the equator); crop it or set crs to a projected system made for such an area",
                east - west,
                north - south,
                2.0 * UTM_MAX_HALF_WIDTH_DEG
            ),
        ));
    }
    let system = CoordinateSystem::from_epsg(code).map_err(|e| IoError::format(&first.path, e.to_string()))?;
    Ok(Target { crs: Crs::Epsg(code), system: Some(system) })
}

fn warn_about_mercator(sources: &[SourceGrid], target: &Target, warnings: &mut Vec<Warning>) {
    if target.crs != Crs::Epsg(3857) {
        return;
    }
    if let Some(Extent { bounds: [_, south, _, north], .. }) = extent(sources) {
        let lat = 0.5 * (south + north);
        let stretch = 1.0 / lat.to_radians().cos();
        let text = format!(
            "the scene is in Web Mercator (EPSG:3857), whose metres are {stretch:.2} times too long at latitude {lat:.1}: relief looks flatter than it is; set crs to the UTM zone for true proportions"
        );
        let warning = Warning::new(WarningKind::Inexact, text).about("EPSG:3857").with("latitude_deg", lat);
        warnings.push(warning.with("stretch", stretch));
    }
}

struct Extent {
    bounds: [f64; 4],
}

/// Smallest longitude-latitude box around all sources.
fn extent(sources: &[SourceGrid]) -> Option<Extent> {
    let wgs84 = CoordinateSystem::wgs84().ok()?;
    let mut out: Option<[f64; 4]> = None;
    for source in sources {
        let t = Transform::new(source.system.as_ref()?, &wgs84).ok()?;
        for p in source.outline() {
            let Some(mut p) = t.forward_one(p) else { continue };
            if let Some(b) = &mut out {
                // across the antimeridian on the shorter side
                p.x += 360.0 * ((0.5 * (b[0] + b[2]) - p.x) / 360.0).round();
                *b = [b[0].min(p.x), b[1].min(p.y), b[2].max(p.x), b[3].max(p.y)];
            } else {
                out = Some([p.x, p.y, p.x, p.y]);
            }
        }
    }
    // The west lies on this side of the antimeridian, whichever source is the first.
    let turn = out.map_or(0.0, |[west, ..]| 360.0 * ((-180.0 - west) / 360.0).ceil().max(0.0));
    out.map(|[west, south, east, north]| Extent { bounds: [west + turn, south, east + turn, north] })
}

/// The grid of the scene: exact where possible, resampled else.
fn onto_scene_grid(
    sources: &[SourceGrid],
    target: &Target,
    request: &TerrainRequest,
    warnings: &mut Vec<Warning>,
    progress: &Progress,
) -> Result<(SceneGrid, Option<ResampleError>), IoError> {
    if let [source] = sources
        && let Some(grid) = resample::exact(source, target.system.as_ref())
    {
        return Ok((grid, None));
    }
    let links = sources.iter().map(|s| Link::new(s, target.system.as_ref(), &s.path)).collect::<Result<Vec<_>, _>>()?;
    let (grid, error) = resample::resample(sources, &links, request, warnings, progress)?;
    if let Some(e) = error
        && e.p99_m > request.max_error_p99_m.max(WARN_P99_M)
    {
        let text = format!(
            "resampling to the metric grid moves heights by {:.1} m rms, and by more than {:.1} m at 1 % of the samples (wanted: {:.1} m); a smaller part of the terrain is resampled more finely, and a file in a metric system is not resampled",
            e.rms_m, e.p99_m, request.max_error_p99_m
        );
        let warning = Warning::new(WarningKind::Inexact, text).with("rms_m", e.rms_m).with("p99_m", e.p99_m);
        warnings.push(warning.with("wanted_p99_m", request.max_error_p99_m).in_file(&sources[0].path));
    }
    Ok((grid, error))
}
