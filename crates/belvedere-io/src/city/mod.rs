//! Cities: CityJSON, CityJSONSeq, CityGML and OpenStreetMap's files, and footprints, ways and land cover in GeoJSON,
//! shapefiles and GeoPackages.

mod about;
mod attributes;
mod citygml;
mod cityjson;
mod collect;
mod draped;
mod footprints;
mod gml;
mod looks;
mod osm;
mod parts;
mod pictures;
mod place;
mod plan;
mod reference;
mod roof;
mod roofs;
mod surface;
mod tin;

pub use about::{CityAbout, is_meant};
pub(crate) use osm::vectors as osm_vectors;
pub use place::reproject;
pub use roof::prism_on;
pub use surface::{CityColors, CityGround, plate_extent, surface};

use crate::crs::CoordinateSystem;
use crate::formats::Reader;
use crate::packed::content_for;
use crate::table::split_table;
use crate::text::text_of;
use crate::vector;
use crate::{InputFile, IoError, Limits, Loaded, budget, fs, recognise};
use belvedere_scene::City;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// A city as read from a file.
#[derive(Debug, Clone)]
pub struct CityFile {
    /// The file, for messages.
    pub path: PathBuf,
    /// Format, for messages: "CityJSON 2.0", "CityJSONSeq", "CityGML 2.0", "OSM PBF", "OSM XML", "Overpass JSON", "GeoJSON", "shapefile" or "GeoPackage".
    pub format: String,
    /// Horizontal system of every coordinate; `None` if the file names none.
    pub crs: Option<CoordinateSystem>,
    /// Notes of the file on its system and heights, for messages, possibly empty.
    pub reference: String,
    /// Levels of detail that the file holds, rising.
    pub lods: Vec<String>,
    /// The city, in the file's coordinates: x and y in its system, heights in metres.
    pub city: City,
    /// What the file says of buildings and other solids, by their ids.
    pub about: Vec<CityAbout>,
}

/// Reads a city; the format is told by the content.
///
/// * `lod`: level of detail to take where there is a choice; by default the highest of each object.
///
/// # Errors
/// [`IoError`]: unreadable, none of the formats, broken, too large for `limits`, or without anything to show.
pub fn load_city(path: &Path, lod: Option<&str>, limits: &Limits) -> Result<Loaded<CityFile>, IoError> {
    let path = &meant(path, limits)?;
    let whole = split_table(path).0;
    let size = fs::metadata(whole).map_err(|e| IoError::os(whole, e))?.len();
    // A tree of JSON takes several times the bytes of its text.
    limits.ask("the city", size.saturating_mul(8)).map_err(|reason| IoError::format(path, reason))?;
    let _work = budget::work_on(whole);
    if let Some(model) = model(path)? {
        let (bytes, file) = InputFile::read(path)?;
        let loaded = match model {
            Model::Osm(format) => osm::load(path, &bytes, format)?,
            Model::CityJson => cityjson::load(path, &text(path, &bytes)?, lod, limits)?,
            Model::CityGml => citygml::load(path, &text(path, &bytes)?, lod, limits)?,
        };
        return Ok(loaded.with_file(file));
    }
    let Loaded { value, warnings, files } = vector::load(path, &|_, _| Ok(None))?;
    let mut loaded = footprints::city(value)?;
    loaded.warnings.splice(0..0, warnings);
    Ok(Loaded { files, ..loaded })
}

/// The text of a model in the encoding that it declares.
fn text<'b>(path: &Path, bytes: &'b [u8]) -> Result<Cow<'b, str>, IoError> {
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Ok(text.trim_start_matches('\u{feff}').into());
    }
    let mut doubts = Vec::new();
    let text = text_of(bytes, &mut doubts);
    match doubts.first() {
        None => Ok(text.into()),
        Some(doubt) => Err(IoError::format(path, format!("{doubt}; it is damaged"))),
    }
}

/// Names of the formats of OpenStreetMap.
pub(crate) const OSM: [&str; 3] = ["OSM PBF", "OSM XML", "Overpass JSON"];

/// Formats that hold only cities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Model {
    CityJson,
    CityGml,
    Osm(&'static str),
}

/// Whether a file can only be a city, by its first bytes: CityJSON, CityJSONSeq, CityGML or a file of OpenStreetMap.
///
/// # Errors
/// [`IoError::Os`].
pub fn is_city(path: &Path) -> Result<bool, IoError> {
    model(path).map(|model| model.is_some())
}

/// The city or map inside an archive, or the file itself.
fn meant(path: &Path, limits: &Limits) -> Result<PathBuf, IoError> {
    if split_table(path).1.is_some() { Ok(path.to_owned()) } else { content_for(path, limits.max_bytes, Reader::City) }
}

fn model(path: &Path) -> Result<Option<Model>, IoError> {
    let format = recognise::of_content(split_table(path).0)?.filter(|format| format.reader == Some(Reader::City));
    Ok(format.map(|format| match format.name {
        name if OSM.contains(&name) => Model::Osm(name),
        "CityGML" => Model::CityGml,
        _ => Model::CityJson,
    }))
}

impl CityFile {
    /// Sources of the heights of buildings, in words; empty without buildings.
    pub fn heights(&self) -> String {
        plan::sources(self.city.buildings.iter().map(|b| b.height_source))
    }
}
