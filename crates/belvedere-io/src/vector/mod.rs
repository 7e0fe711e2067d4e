//! Lines, areas and points: GPX, GeoJSON, shapefiles and GeoPackages, and how they come to lie on the terrain.

mod area_kind;
mod geojson;
#[cfg(feature = "geopackage")]
mod geopackage;
mod gpx;
mod on_terrain;
mod rings;
mod shapefile;
mod table;

pub use area_kind::{AreaKind, area_kind};
pub use on_terrain::{areas_on_terrain, lines_on_terrain, points_on_terrain};
pub use table::{join_table, split_table};

use crate::crs::CoordinateSystem;
use crate::recognise::explain;
use crate::{InputFile, IoError, Loaded, fs};
use glam::DVec2;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Endings of the files that [`load_vectors`] reads, beside `.json`, which may be anything.
pub const ENDINGS: &[&str] = &[
    "gpx",
    "geojson",
    "shp",
    #[cfg(feature = "geopackage")]
    "gpkg",
];
/// Largest file read, bytes.
const MAX_BYTES: u64 = 1 << 30;
/// Most characters kept of one property.
const MAX_PROPERTY_CHARS: usize = 1000;

/// A position as the file gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// East or longitude, north or latitude, in the source's coordinate system; finite.
    pub xy: DVec2,
    /// Height as given, metres in most files, its datum unknown; finite.
    pub z: Option<f64>,
}

/// Shape of a feature.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// One or more points.
    Points(Vec<Vertex>),
    /// One or more lines of at least 2 vertices.
    Lines(Vec<Vec<Vertex>>),
    /// One or more polygons: the outer ring, then its holes, closed implicitly, at least 3 vertices each, any orientation.
    Polygons(Vec<Vec<Vec<Vertex>>>),
}

impl Geometry {
    /// Every vertex, in order.
    pub fn vertices(&self) -> Box<dyn Iterator<Item = &Vertex> + '_> {
        match self {
            Self::Points(p) => Box::new(p.iter()),
            Self::Lines(l) => Box::new(l.iter().flatten()),
            Self::Polygons(p) => Box::new(p.iter().flatten().flatten()),
        }
    }

    /// Every vertex, in order, to be changed.
    pub fn vertices_mut(&mut self) -> Box<dyn Iterator<Item = &mut Vertex> + '_> {
        match self {
            Self::Points(p) => Box::new(p.iter_mut()),
            Self::Lines(l) => Box::new(l.iter_mut().flatten()),
            Self::Polygons(p) => Box::new(p.iter_mut().flatten().flatten()),
        }
    }
}

/// One feature.
#[derive(Debug, Clone, PartialEq)]
pub struct VectorFeature {
    /// Name, possibly empty.
    pub name: String,
    /// Properties that are not null, as text.
    pub properties: BTreeMap<String, String>,
    /// Shape.
    pub geometry: Geometry,
}

/// What a vector file holds.
#[derive(Debug, Clone)]
pub struct Vectors {
    /// The file, for messages.
    pub path: PathBuf,
    /// Format, for messages: "GPX", "GeoJSON", "shapefile" or "GeoPackage".
    pub format: &'static str,
    /// Name of the layer that the file states, possibly empty.
    pub layer: String,
    /// Coordinate system of every vertex.
    pub crs: CoordinateSystem,
    /// Features, in file order.
    pub features: Vec<VectorFeature>,
}

impl Vectors {
    /// Smallest and largest x and y of all vertices; `None` without a vertex. A line across the antimeridian counts as it is written.
    pub fn extent(&self) -> Option<[DVec2; 2]> {
        let all = self.features.iter().flat_map(|f| f.geometry.vertices());
        all.fold(None, |e: Option<[DVec2; 2]>, v| Some(e.map_or([v.xy; 2], |[lo, hi]| [lo.min(v.xy), hi.max(v.xy)])))
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.features.iter().map(|f| f.geometry.vertices().count()).sum()
    }
}

/// Reads a GPX, GeoJSON, shapefile or (with the feature `geopackage`) GeoPackage; which of them is told by the content, not by the name.
///
/// * `path`: of a GeoPackage with the table that is wanted behind it, see [`split_table`]; by default all of its tables are read.
///
/// # Errors
/// [`IoError`]: unreadable, none of the formats, broken, without any vertex, or in an unknown coordinate system.
pub fn load_vectors(path: &Path) -> Result<Loaded<Vectors>, IoError> {
    load_known(path).map_err(explain)
}

fn load_known(path: &Path) -> Result<Loaded<Vectors>, IoError> {
    let (path, table) = split_table(path);
    let size = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    if size > MAX_BYTES {
        let mib = size >> 20;
        return Err(IoError::format(
            path,
            format!("is {mib} MiB large, the limit is 1024 MiB; cut out the part you need"),
        ));
    }
    let (bytes, file) = InputFile::read(path)?;
    #[cfg(feature = "geopackage")]
    if bytes.starts_with(geopackage::MAGIC) {
        return Ok(geopackage::load(path, table, bytes)?.with_file(file));
    }
    if let Some(table) = table.filter(|_| !bytes.starts_with(b"SQLite format 3\0")) {
        return Err(IoError::format(
            path,
            format!("is no database, so it has no table \"{table}\"; it is damaged or something else"),
        ));
    }
    if bytes.starts_with(&shapefile::MAGIC) {
        return Ok(shapefile::load(path, &bytes)?.with_file(file));
    }
    let named = |ext: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ext));
    if named("shp") {
        return Err(IoError::format(
            path,
            "does not begin like a shapefile (file code 9994); it is damaged or something else",
        ));
    }
    let mut warnings = Vec::new();
    let text = text_of(&bytes, &mut warnings);
    let loaded = match text.trim_start().chars().next() {
        Some('<') => gpx::load(path, &text)?,
        Some('{' | '[') => geojson::load(path, &text)?,
        None => return Err(IoError::format(path, "is empty; a GPX, GeoJSON or shapefile is needed")),
        Some(_) => {
            return Err(IoError::format(path, "is no GPX (XML), GeoJSON or shapefile; convert it to one of these"));
        }
    };
    warnings.extend(loaded.warnings);
    Ok(Loaded::new(loaded.value, warnings).with_file(file))
}

/// UTF-8 (with or without byte order mark), UTF-16 with byte order mark, else Latin-1 with a warning.
fn text_of(bytes: &[u8], warnings: &mut Vec<String>) -> String {
    let utf16 = |unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).skip(1).map(|c| unit([c[0], c[1]]));
        char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    match bytes {
        [0xff, 0xfe, ..] => return utf16(u16::from_le_bytes),
        [0xfe, 0xff, ..] => return utf16(u16::from_be_bytes),
        _ => {}
    }
    let bytes = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    String::from_utf8(bytes.to_vec()).unwrap_or_else(|e| {
        let at = e.utf8_error().valid_up_to();
        warnings.push(format!("text is not UTF-8 (byte {at}); read as Latin-1, so names may look odd"));
        bytes.iter().map(|&b| char::from(b)).collect()
    })
}

/// Drops NaN and infinities: `None` unless both are finite.
fn vertex(x: f64, y: f64, z: Option<f64>) -> Option<Vertex> {
    let xy = DVec2::new(x, y);
    xy.is_finite().then_some(Vertex { xy, z: z.filter(|z| z.is_finite()) })
}

/// Why these vertices cannot be degrees, if they cannot.
fn not_degrees(features: &[VectorFeature]) -> Option<String> {
    let all = features.iter().flat_map(|f| f.geometry.vertices());
    all.map(|v| v.xy)
        .find(|p| p.y.abs() > 90.0 || p.x.abs() > 360.0)
        .map(|p| format!("position ({}, {}) is no longitude and latitude (limits 360 and 90 degrees)", p.x, p.y))
}

/// The name among properties: `name` in any spelling, else the first of some usual substitutes.
fn name_of(properties: &BTreeMap<String, String>) -> String {
    ["name", "ref", "title", "label"]
        .iter()
        .find_map(|key| properties.iter().find(|(k, v)| k.eq_ignore_ascii_case(key) && !v.is_empty()))
        .map(|(_, v)| v.clone())
        .unwrap_or_default()
}

fn shorten(text: &str) -> String {
    text.trim().chars().take(MAX_PROPERTY_CHARS).collect()
}
