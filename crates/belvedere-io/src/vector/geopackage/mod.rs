//! GeoPackage (OGC 12-128r19): tables of features in an SQLite database.
//!
//! The file is read once, whole: nothing is written beside it, and the bytes read are those that were hashed.

mod blob;
mod database;
mod odd;
mod wkb;
mod write;

pub use write::{FeatureTable, write_geopackage};

use super::{Geometry, VectorFeature, Vectors, name_of, not_degrees, shorten, vertex};
use crate::crs::{CoordinateSystem, CrsError, Transform};
use crate::sqlite::Value;
use crate::{IoError, Loaded, fs};
use belvedere_core::{Warning, WarningKind};
use database::{Database, Table};
use odd::Odd;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads a table of features, or all.
///
/// * `table`: its name; by default all tables are read, in the order of their names.
pub(super) fn load(path: &Path, table: Option<&str>, bytes: Vec<u8>) -> Result<Loaded<Vectors>, IoError> {
    let fail = |reason: String| IoError::format(path, reason);
    let mut warnings = unwritten(path);
    let database = Database::open(bytes).map_err(fail)?;
    let tables = chosen(database.tables().map_err(fail)?, table).map_err(fail)?;
    let mut features = Vec::new();
    let mut crs: Option<CoordinateSystem> = None;
    let mut counts = Vec::new();
    for table in &tables {
        let (mut read, odd) = rows(&database, table).map_err(|e| fail(format!("table \"{}\"{e}", table.name)))?;
        warnings.extend(odd.warnings(&table.name));
        warnings.extend(computed(&database, table).map_err(|e| fail(format!("table \"{}\"{e}", table.name)))?);
        let own = system_of(&database, table, &read, &mut warnings).map_err(fail)?;
        let common = crs.get_or_insert_with(|| own.clone());
        if own != *common {
            let lost = reproject(&mut read, &own, common).map_err(|e| fail(e.to_string()))?;
            let text =
                format!("table \"{}\" is in {own} and was taken to {common}, the system of the first", table.name);
            warnings.push(Warning::new(WarningKind::Repaired, text));
            let what =
                format!("features of table \"{}\" lie outside the domain of {common} and were dropped", table.name);
            warnings.extend(Warning::counted(WarningKind::Ignored, lost, &what));
        }
        counts.push(format!("\"{}\" ({})", table.name, read.len()));
        features.extend(read);
    }
    let Some(crs) = crs.filter(|_| !features.is_empty()) else {
        let names = counts.join(", ");
        return Err(fail(format!("GeoPackage holds no usable geometry in its tables {names}; choose another file")));
    };
    if tables.len() > 1 {
        let (count, names, first) = (tables.len(), counts.join(", "), &tables[0].name);
        let text = format!("all {count} tables were read: {names}; put ?table={first} behind the name for one of them");
        warnings.push(Warning::new(WarningKind::Assumed, text).with("tables", count as f64));
    }
    let layer = match tables.as_slice() {
        [one] => shorten(&one.identifier),
        _ => String::new(),
    };
    let warnings = warnings.into_iter().map(|w| w.in_file(path)).collect();
    Ok(Loaded::new(
        Vectors { path: path.into(), format: "GeoPackage", layer, crs, crs_stated: true, features },
        warnings,
    ))
}

/// Which columns of a table the file does not hold.
fn computed(database: &Database, table: &Table) -> Result<Option<Warning>, String> {
    let computed = database.computed(table)?;
    let text = format!(
        "columns of table \"{}\" that are computed when they are asked for were not read: {}; make them STORED",
        table.name,
        computed.join(", ")
    );
    Ok((!computed.is_empty()).then(|| Warning::new(WarningKind::Ignored, text).with("columns", computed.len() as f64)))
}

/// Whether a write-ahead log beside the file holds changes that are not yet in it.
fn unwritten(path: &Path) -> Vec<Warning> {
    let beside = |ending: &str| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        let bytes = fs::metadata(PathBuf::from(&name)).ok()?.len();
        (bytes > 0).then(|| {
            let name = PathBuf::from(name);
            let name = name.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            let text = format!("{name} ({bytes} bytes) holds changes that are not in the file yet and were not read; close the program that edits it");
            Warning::new(WarningKind::Ignored, text).with("bytes", bytes as f64)
        })
    };
    ["-wal", "-journal"].into_iter().filter_map(beside).collect()
}

/// The table of a name, whatever its case, else all.
fn chosen(tables: Vec<Table>, wanted: Option<&str>) -> Result<Vec<Table>, String> {
    let Some(wanted) = wanted else { return Ok(tables) };
    let names: Vec<String> = tables.iter().map(|t| t.name.clone()).collect();
    let found: Vec<Table> = tables.into_iter().filter(|t| t.name.eq_ignore_ascii_case(wanted)).collect();
    if found.is_empty() {
        return Err(format!("has no table of features \"{wanted}\"; it has {}", names.join(", ")));
    }
    Ok(found)
}

/// The features of a table, and the oddities among them.
fn rows(database: &Database, table: &Table) -> Result<(Vec<VectorFeature>, Odd), String> {
    let (mut features, mut odd) = (Vec::new(), Odd::default());
    database.each_row(table, |row| {
        let Some(blob) = row.geometry else {
            odd.without_geometry += 1;
            return Ok(());
        };
        let geometries = blob::geometries(blob, table.srs_id, &mut odd).map_err(|e| format!(", {}: {e}", row.place))?;
        let properties: BTreeMap<String, String> =
            row.values.iter().filter_map(|(name, value)| property(name, value)).collect();
        let name = name_of(&properties);
        let feature = |geometry: Geometry| VectorFeature {
            style: None,
            name: name.clone(),
            properties: properties.clone(),
            geometry,
        };
        features.extend(geometries.into_iter().map(feature));
        Ok(())
    })?;
    Ok((features, odd))
}

fn property(name: &str, value: &Value<'_>) -> Option<(String, String)> {
    let text = match value {
        Value::Text(text) => shorten(text),
        Value::Integer(number) => number.to_string(),
        Value::Real(number) => number.to_string(),
        Value::Null | Value::Blob(_) => return None,
    };
    Some((shorten(name), text))
}

/// Advice for tables without a known coordinate system.
const REMEDY: &str = "set it, as by ogr2ogr -a_srs EPSG:n";

/// The coordinate system of a table; an undefined plane (srs_id -1) is that of a scene without georeference.
fn system_of(
    database: &Database,
    table: &Table,
    features: &[VectorFeature],
    warnings: &mut Vec<Warning>,
) -> Result<CoordinateSystem, String> {
    let name = &table.name;
    let crs = match table.srs_id {
        -1 => CoordinateSystem::local(),
        0 => {
            let text = format!("table \"{name}\" is in undefined degrees (srs_id 0), taken as WGS 84");
            warnings.push(Warning::new(WarningKind::Assumed, text));
            CoordinateSystem::wgs84().map_err(|e| e.to_string())?
        }
        id => listed_system(database, id).map_err(|e| format!("table \"{name}\" is in {e}; {REMEDY}"))?,
    };
    match not_degrees(features).filter(|_| crs.is_geographic()) {
        Some(reason) => Err(format!("table \"{name}\": {reason}, but its system is {crs}; {REMEDY}")),
        None => Ok(crs),
    }
}

/// A coordinate system that the file lists: by its EPSG code, else by its text.
fn listed_system(database: &Database, id: i64) -> Result<CoordinateSystem, String> {
    let system = database.system(id)?;
    let system = system.ok_or_else(|| format!("system {id}, which gpkg_spatial_ref_sys does not list"))?;
    let by_code = system.epsg.map(CoordinateSystem::from_epsg);
    let reason = match by_code {
        Some(Ok(crs)) => return Ok(crs),
        Some(Err(e)) => e.to_string(),
        None => "its text is not understood".into(),
    };
    let by_text = system.definitions.iter().find_map(|text| CoordinateSystem::from_wkt(text).ok());
    by_text.ok_or_else(|| format!("\"{}\" (srs_id {id}): {reason}", system.name))
}

/// Transforms features to another system; returns the number outside its domain, which are dropped.
fn reproject(
    features: &mut Vec<VectorFeature>,
    from: &CoordinateSystem,
    to: &CoordinateSystem,
) -> Result<usize, CrsError> {
    let transform = Transform::new(from, to)?;
    let before = features.len();
    features.retain_mut(|feature| {
        feature.geometry.vertices_mut().all(|v| transform.forward_one(v.xy).map(|xy| v.xy = xy).is_some())
    });
    Ok(before - features.len())
}
