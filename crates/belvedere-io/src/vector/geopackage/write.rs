//! GeoPackages of features: one table for each layer, made by SQLite in memory and written whole.

use super::{Geometry, VectorFeature};
use crate::IoError;
use crate::atomic::write_atomic;
use crate::crs::CoordinateSystem;
use crate::vector::Vertex;
use glam::DVec2;
use rusqlite::{Connection, MAIN_DB, params};
use std::collections::BTreeSet;
use std::path::Path;

/// The features of one layer.
#[derive(Debug, Clone)]
pub struct FeatureTable {
    /// Name of the table.
    pub name: String,
    /// Features, all points, all lines or all polygons, with heights; each has a column for each property of any of them.
    pub features: Vec<VectorFeature>,
}

/// Writes features as a GeoPackage (OGC 12-128r19, version 1.3). Same features, same bytes: the time of the last change that the format
/// wants is always the same.
///
/// * `crs`: system of all vertices; a local one becomes the undefined Cartesian system (-1).
///
/// # Errors
/// [`IoError`] if the file cannot be written, two tables have the same name, or the system has no EPSG code whose text is known.
pub fn write_geopackage(
    path: &Path,
    tables: &[FeatureTable],
    crs: &CoordinateSystem,
    overwrite: bool,
) -> Result<(), IoError> {
    let bytes = encode(tables, crs).map_err(|reason| IoError::format(path, reason))?;
    write_atomic(path, overwrite, |out| out.write_all(&bytes))
}

/// Number of a plane without georeference.
const UNDEFINED_PLANE: i32 = -1;
/// What every GeoPackage has.
const TABLES: &str = "PRAGMA application_id = 1196444487;
PRAGMA user_version = 10300;
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE, description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')), min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
  srs_id INTEGER, CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL, CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name), CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id));
INSERT INTO gpkg_spatial_ref_sys VALUES ('Undefined Cartesian SRS', -1, 'NONE', -1, 'undefined', NULL),
  ('Undefined geographic SRS', 0, 'NONE', 0, 'undefined', NULL);";
const LAST_CHANGE: &str = "1970-01-01T00:00:00.000Z";

fn encode(tables: &[FeatureTable], crs: &CoordinateSystem) -> Result<Vec<u8>, String> {
    let srs_id = match crs.epsg() {
        _ if crs.is_local() => UNDEFINED_PLANE,
        Some(code) => i32::try_from(code).map_err(|e| e.to_string())?,
        None => return Err(format!("coordinate system {crs} has no EPSG code to write; write GeoJSON")),
    };
    let made = || {
        let mut connection = Connection::open_in_memory()?;
        connection.execute_batch(TABLES)?;
        // Every GeoPackage lists WGS 84.
        let wgs84 = CoordinateSystem::wgs84().ok();
        for system in wgs84.iter().chain(Some(crs).filter(|c| c.epsg() != Some(4326))) {
            let (Some(code), Some(text)) = (system.epsg(), system.well_known_text()) else { continue };
            let sql = "INSERT INTO gpkg_spatial_ref_sys VALUES (?1, ?2, 'EPSG', ?2, ?3, NULL)";
            connection.execute(sql, params![system.name(), code, text])?;
        }
        let transaction = connection.transaction()?;
        tables.iter().try_for_each(|table| fill(&transaction, table, srs_id))?;
        transaction.commit()?;
        Ok(connection.serialize(MAIN_DB)?.to_vec())
    };
    if srs_id > 0 && crs.well_known_text().is_none() {
        return Err(format!("the well-known text of {crs}, which a GeoPackage holds, is not known; write GeoJSON"));
    }
    made().map_err(|e: rusqlite::Error| format!("cannot be written: SQLite says \"{e}\""))
}

/// A name as SQL writes it.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

fn fill(connection: &Connection, table: &FeatureTable, srs_id: i32) -> rusqlite::Result<()> {
    let columns: BTreeSet<&String> = table.features.iter().flat_map(|f| f.properties.keys()).collect();
    let name = quoted(&table.name);
    let listed: String = columns.iter().map(|c| format!(", {} TEXT", quoted(c))).collect();
    connection.execute_batch(&format!("CREATE TABLE {name} (fid INTEGER PRIMARY KEY NOT NULL, geom BLOB{listed})"))?;
    let [low, high] = extent(&table.features);
    connection.execute(
        "INSERT INTO gpkg_contents VALUES (?1, 'features', ?1, '', ?2, ?3, ?4, ?5, ?6, ?7)",
        params![table.name, LAST_CHANGE, low.x, low.y, high.x, high.y, srs_id],
    )?;
    let kind = match table.features.first().map(|f| &f.geometry) {
        Some(Geometry::Lines(_)) => "MULTILINESTRING",
        Some(Geometry::Polygons(_)) => "MULTIPOLYGON",
        Some(Geometry::Points(_)) => "MULTIPOINT",
        None => "GEOMETRY",
    };
    connection.execute(
        "INSERT INTO gpkg_geometry_columns VALUES (?1, 'geom', ?2, ?3, 1, 0)",
        params![table.name, kind, srs_id],
    )?;
    let places: String = (2..columns.len() + 2).map(|i| format!(", ?{i}")).collect();
    let names: String = columns.iter().map(|c| format!(", {}", quoted(c))).collect();
    let mut insert = connection.prepare(&format!("INSERT INTO {name} (geom{names}) VALUES (?1{places})"))?;
    for feature in &table.features {
        insert.raw_bind_parameter(1, blob(feature, srs_id))?;
        for (i, column) in columns.iter().enumerate() {
            insert.raw_bind_parameter(i + 2, feature.properties.get(*column))?;
        }
        insert.raw_execute()?;
    }
    Ok(())
}

/// Smallest and largest position; zeros without a vertex.
fn extent(features: &[VectorFeature]) -> [DVec2; 2] {
    let all = features.iter().flat_map(|f| f.geometry.vertices()).map(|v| v.xy);
    all.fold(None, |e: Option<[DVec2; 2]>, p| Some(e.map_or([p; 2], |[lo, hi]| [lo.min(p), hi.max(p)])))
        .unwrap_or_default()
}

/// Well-known binary of a little-endian geometry with heights.
struct Wkb(Vec<u8>);

impl Wkb {
    /// Begins a geometry: 1 point, 2 line, 3 polygon, 4 to 6 several of them.
    fn begin(&mut self, kind: u32) -> &mut Self {
        self.0.push(1);
        self.0.extend((1000 + kind).to_le_bytes());
        self
    }

    fn count(&mut self, count: usize) -> &mut Self {
        self.0.extend((count as u32).to_le_bytes());
        self
    }

    fn vertex(&mut self, v: &Vertex) {
        [v.xy.x, v.xy.y, v.z.unwrap_or(0.0)].iter().for_each(|n| self.0.extend(n.to_le_bytes()));
    }

    fn vertices<'v>(&mut self, count: usize, vertices: impl Iterator<Item = &'v Vertex>) {
        self.count(count);
        vertices.for_each(|v| self.vertex(v));
    }
}

/// Geometry of a feature: the header of the format with the extent, then well-known binary.
fn blob(feature: &VectorFeature, srs_id: i32) -> Vec<u8> {
    let mut out = Wkb(b"GP\0\x03".to_vec());
    out.0.extend(srs_id.to_le_bytes());
    let [low, high] = extent(std::slice::from_ref(feature));
    [low.x, high.x, low.y, high.y].iter().for_each(|n| out.0.extend(n.to_le_bytes()));
    match &feature.geometry {
        Geometry::Points(points) => {
            out.begin(4).count(points.len());
            for point in points {
                out.begin(1).vertex(point);
            }
        }
        Geometry::Lines(lines) => {
            out.begin(5).count(lines.len());
            for line in lines {
                out.begin(2).vertices(line.len(), line.iter());
            }
        }
        Geometry::Polygons(polygons) => {
            out.begin(6).count(polygons.len());
            for rings in polygons {
                out.begin(3).count(rings.len());
                for ring in rings {
                    let closed = ring.len() + usize::from(!ring.is_empty());
                    out.vertices(closed, ring.iter().chain(ring.first()));
                }
            }
        }
    }
    out.0
}
