//! Lines, areas and points: GPX, TCX, KML, GeoJSON, shapefiles, GeoPackages, FlatGeobuf and tables with coordinates, and how they are laid on
//! the terrain.

mod area_kind;
mod array;
mod beside;
mod collected;
mod csv;
mod flatgeobuf;
mod geojson;
mod geopackage;
mod gpx;
mod kml;
mod line_kind;
mod names;
mod on_terrain;
mod phantom;
mod place_kind;
mod rings;
mod shapefile;
mod tcx;
mod text;
mod tracks;
mod wkt;
mod xml;

pub use geopackage::{FeatureTable, write_geopackage};

pub use area_kind::{AreaKind, area_kind};
pub use array::{FeatureArray, Shape};
pub use line_kind::{line_kind, line_words};
pub use names::name_field;
pub use on_terrain::{OnGround, areas_on_terrain, lines_on_terrain, points_on_terrain};
pub use place_kind::{number, place_kind, stated_height, stated_people};
pub use text::FeatureText;

use crate::crs::CoordinateSystem;
use crate::formats::{Reader, xml_root};
use crate::packed::content_for;
use crate::recognise::{explain, not_a};
use crate::table::split_table;
use crate::text::text_of;
use crate::{InputFile, IoError, Loaded, budget, columns, fs, sqlite};
use belvedere_scene::FeatureStyle;
use glam::DVec2;
use phantom::Phantoms;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Largest file read, bytes.
const MAX_BYTES: u64 = 1 << 30;
/// Bytes that reading takes for each byte of a file.
const TIMES: u64 = 6;
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
    /// Style that the features of a scene made of it have; readers give none.
    pub style: Option<FeatureStyle>,
    /// Shape.
    pub geometry: Geometry,
}

/// Content of a vector file.
#[derive(Debug, Clone)]
pub struct Vectors {
    /// The file, for messages.
    pub path: PathBuf,
    /// Format, for messages: "GPX", "TCX", "KML", "GeoJSON", "shapefile", "GeoPackage", "FlatGeobuf", "CSV", or one of OpenStreetMap.
    pub format: &'static str,
    /// Name of the layer that the file states, possibly empty.
    pub layer: String,
    /// Coordinate system of every vertex; local if the file states none and its numbers are not degrees.
    pub crs: CoordinateSystem,
    /// Whether the file states its system; else it is the one that its format has by default, or local.
    pub crs_stated: bool,
    /// Features, in file order.
    pub features: Vec<VectorFeature>,
}

impl Vectors {
    /// Smallest and largest x and y of all vertices; `None` without a vertex. A line across the antimeridian counts as it is written.
    pub fn extent(&self) -> Option<[DVec2; 2]> {
        let all = self.features.iter().flat_map(|f| f.geometry.vertices());
        all.fold(None, |e: Option<[DVec2; 2]>, v| Some(e.map_or([v.xy; 2], |[lo, hi]| [lo.min(v.xy), hi.max(v.xy)])))
    }

    /// Takes the names of features from one of their properties; features without it have no name.
    ///
    /// # Errors
    /// A sentence, if no feature has it.
    pub fn name_by(&mut self, field: &str) -> Result<(), String> {
        let has = |key: &str| self.features.iter().any(|f| f.properties.contains_key(key));
        let keys = || self.features.iter().flat_map(|f| f.properties.keys());
        let same = || keys().find(|key| key.to_lowercase() == field.to_lowercase()).cloned();
        let Some(found) = has(field).then(|| field.to_owned()).or_else(same) else {
            let known: std::collections::BTreeSet<&String> = keys().collect();
            let known: Vec<&str> = known.into_iter().take(20).map(String::as_str).collect();
            let known = if known.is_empty() { "none".into() } else { known.join(", ") };
            return Err(format!("no feature has the property \"{field}\"; its properties: {known}"));
        };
        for feature in &mut self.features {
            feature.name = feature.properties.get(&found).cloned().unwrap_or_default();
        }
        Ok(())
    }

    /// Takes the names of those features that have a property from it; others keep theirs.
    ///
    /// # Errors
    /// As [`Vectors::name_by`].
    pub fn name_where(&mut self, field: &str) -> Result<(), String> {
        let before: Vec<String> = self.features.iter().map(|f| f.name.clone()).collect();
        self.name_by(field)?;
        for (feature, before) in self.features.iter_mut().zip(before) {
            if feature.name.trim().is_empty() {
                feature.name = before;
            }
        }
        Ok(())
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.features.iter().map(|f| f.geometry.vertices().count()).sum()
    }
}

/// Longitude and latitude, degrees, and time, seconds from 1970 on, of the points of all tracks that have a time, in the order of the file: of a
/// GPX, TCX or KML.
///
/// # Errors
/// A predicate for text of another format.
pub fn track_times(text: &str) -> Result<Vec<(DVec2, f64)>, String> {
    match xml_root(text).as_deref() {
        Some("kml") => kml::times(text),
        Some(tcx::ROOT) => tcx::times(text),
        _ => gpx::times(text),
    }
}

/// A reader of further formats: `None` for files of none of them.
pub(crate) type Other<'a> = &'a dyn Fn(&Path, &[u8]) -> Result<Option<Loaded<Vectors>>, IoError>;

/// As [`crate::load_vectors`], by `other` where it reads the file.
pub(crate) fn load(path: &Path, other: Other<'_>) -> Result<Loaded<Vectors>, IoError> {
    let path = match split_table(path) {
        (_, Some(_)) => path.to_owned(),
        (file, None) => content_for(file, MAX_BYTES, Reader::Features)?,
    };
    without_phantoms(&path, load_known(&path, other).map_err(explain)?)
}

/// The features without positions that nobody was at.
fn without_phantoms(path: &Path, mut loaded: Loaded<Vectors>) -> Result<Loaded<Vectors>, IoError> {
    let mut found = Phantoms::default();
    phantom::drop_zeros(&mut loaded.value, &mut found);
    if !matches!(loaded.value.format, "GPX" | "TCX") {
        phantom::drop_excursions(&mut loaded.value, &mut found);
    }
    loaded.warnings.extend(found.say().map(|said| said.in_file(path)));
    if loaded.value.features.is_empty() {
        return Err(IoError::format(path, "holds nothing but positions at exactly 0, 0; choose another file"));
    }
    Ok(loaded)
}

fn load_known(path: &Path, other: Other<'_>) -> Result<Loaded<Vectors>, IoError> {
    let (path, table) = split_table(path);
    let size = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    if size > MAX_BYTES {
        let mib = size >> 20;
        return Err(IoError::format(
            path,
            format!("is {mib} MiB large, the limit is 1024 MiB; cut out the part you need"),
        ));
    }
    let _work = budget::work_on(path);
    // The bytes, their text, and what is made of them.
    budget::ask("the file", size.saturating_mul(TIMES)).map_err(|reason| IoError::format(path, reason))?;
    let (bytes, file) = InputFile::read(path)?;
    if let Some(loaded) = other(path, &bytes)? {
        return Ok(loaded.with_file(file));
    }
    if bytes.starts_with(sqlite::MAGIC) {
        return Ok(geopackage::load(path, table, bytes)?.with_file(file));
    }
    if let Some(table) = table {
        return Err(IoError::format(
            path,
            format!("is no database, so it has no table \"{table}\"; it is damaged or something else"),
        ));
    }
    if bytes.starts_with(&shapefile::MAGIC) {
        return Ok(shapefile::load(path, &bytes)?.with_file(file));
    }
    if bytes.starts_with(flatgeobuf::MAGIC) {
        return Ok(flatgeobuf::load(path, &bytes)?.with_file(file));
    }
    if has_ending(path, "shp") {
        return Err(IoError::format(
            path,
            "does not begin like a shapefile (file code 9994); it is damaged or something else",
        ));
    }
    let mut loaded = load_text(path, &bytes)?;
    loaded.files.insert(0, file);
    Ok(loaded)
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Reads a format of text, by its beginning.
fn load_text(path: &Path, bytes: &[u8]) -> Result<Loaded<Vectors>, IoError> {
    let mut warnings = Vec::new();
    let text = text_of(bytes, &mut warnings);
    let mut warnings: Vec<_> = warnings.into_iter().map(|w| w.in_file(path)).collect();
    let is_table =
        || ["csv", "tsv"].into_iter().any(|ending| has_ending(path, ending)) || columns::has_coordinates(&text);
    let mut loaded = match text.trim_start().chars().next() {
        Some('<') => match xml_root(&text).as_deref() {
            Some("kml") => kml::load(path, &text)?,
            Some(tcx::ROOT) => tcx::load(path, &text)?,
            _ => gpx::load(path, &text)?,
        },
        Some('{' | '[' | '\u{1e}') => geojson::load(path, &text)?,
        None => return Err(IoError::format(path, "is empty; a GPX, KML, GeoJSON or shapefile is needed")),
        Some(_) if is_table() => csv::load(path, &text)?,
        Some(_) => return Err(not_a(path, "routes, areas or points: GPX, KML, TCX, GeoJSON, shapefile or CSV")),
    };
    warnings.append(&mut loaded.warnings);
    loaded.warnings = warnings;
    Ok(loaded)
}

/// A position; `None` unless both numbers are finite.
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

/// Whether some number is too large to be a mistaken degree, so that the file has another unit.
fn certainly_not_degrees(features: &[VectorFeature]) -> bool {
    features.iter().flat_map(|f| f.geometry.vertices()).any(|v| v.xy.abs().max_element() > 360.0)
}

/// The name among properties, see [`name_field`]; empty if there is none.
fn name_of(properties: &BTreeMap<String, String>) -> String {
    let filled = properties.iter().filter(|(_, v)| !v.is_empty()).map(|(k, _)| k.as_str());
    name_field(filled).and_then(|field| properties.get(field)).cloned().unwrap_or_default()
}

fn shorten(text: &str) -> String {
    text.trim().chars().take(MAX_PROPERTY_CHARS).collect()
}
