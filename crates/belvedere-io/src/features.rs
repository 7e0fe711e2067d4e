//! Features of files of all kinds: those made for features, and maps.

use crate::city::{OSM, osm_vectors};
use crate::vector::{self, Vectors};
use crate::{IoError, Loaded, recognise};
use std::path::Path;

/// Reads a GPX, TCX, KML, GeoJSON, shapefile, GeoPackage, FlatGeobuf, table with coordinates or file of OpenStreetMap; the content decides which, not the name.
///
/// * `path`: for a GeoPackage optionally with the wanted table appended, see [`crate::split_table`]; by default all of its tables are read.
///
/// # Errors
/// [`IoError`]: unreadable, none of the formats, broken, without any vertex, or in an unknown coordinate system.
pub fn load_vectors(path: &Path) -> Result<Loaded<Vectors>, IoError> {
    vector::load(path, &|path, bytes| {
        let osm = recognise::of_content(path)?.filter(|format| OSM.contains(&format.name));
        osm.map(|format| osm_vectors(path, bytes, format.name)).transpose()
    })
}
