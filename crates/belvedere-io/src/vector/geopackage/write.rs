//! GeoPackages of features: one table for each layer.

use super::{Geometry, VectorFeature};
use crate::IoError;
use crate::atomic::write_atomic;
use crate::crs::CoordinateSystem;
use crate::sqlite::{NewDatabase, NewTable, Value};
use crate::vector::Vertex;
use glam::DVec2;
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
const LAST_CHANGE: &str = "1970-01-01T00:00:00.000Z";
const SYSTEMS: &str = "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT)";
const CONTENTS: &str = "CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT UNIQUE, description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')), min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,
  srs_id INTEGER, CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id))";
const COLUMNS: &str = "CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL, CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name), CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents(table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys(srs_id))";

fn encode(tables: &[FeatureTable], crs: &CoordinateSystem) -> Result<Vec<u8>, String> {
    let srs_id = match crs.epsg() {
        _ if crs.is_local() => UNDEFINED_PLANE,
        Some(code) => i32::try_from(code).map_err(|e| e.to_string())?,
        None => return Err(format!("coordinate system {crs} has no EPSG code to write; write GeoJSON")),
    };
    if srs_id > 0 && crs.well_known_text().is_none() {
        return Err(format!("the well-known text of {crs}, which a GeoPackage holds, is not known; write GeoJSON"));
    }
    let mut names =
        BTreeSet::from(["gpkg_spatial_ref_sys", "gpkg_contents", "gpkg_geometry_columns"].map(str::to_owned));
    for table in tables {
        let name = table.name.to_ascii_lowercase();
        if name.starts_with("sqlite_") || !names.insert(name) {
            return Err(format!(
                "cannot be written: table \"{}\" already exists, or is of SQLite; rename it",
                table.name
            ));
        }
    }
    let mut database = NewDatabase { application: *b"GPKG", version: 10_300, tables: vec![systems(crs)] };
    database.tables.push(NewTable {
        name: "gpkg_contents".into(),
        sql: CONTENTS.into(),
        rows: (1..).zip(tables.iter().map(|table| contents(table, srs_id))).collect(),
        unique: vec![vec![0], vec![2]],
    });
    database.tables.push(NewTable {
        name: "gpkg_geometry_columns".into(),
        sql: COLUMNS.into(),
        rows: (1..).zip(tables.iter().map(|table| column(table, srs_id))).collect(),
        unique: vec![vec![0, 1], vec![0]],
    });
    for table in tables {
        database.tables.push(features(table, srs_id)?);
    }
    Ok(database.encode())
}

fn text(text: &str) -> Value<'_> {
    Value::Text(text.into())
}

/// The table of systems, which lists WGS 84 and the undefined ones in every GeoPackage.
fn systems(crs: &CoordinateSystem) -> NewTable<'static> {
    let row = |name: &str, id: i64, organization: &'static str, definition: &'static str| {
        let name = Value::Text(name.to_owned().into());
        (id, vec![name, Value::Null, text(organization), Value::Integer(id), text(definition), Value::Null])
    };
    let mut rows = vec![
        row("Undefined Cartesian SRS", UNDEFINED_PLANE.into(), "NONE", "undefined"),
        row("Undefined geographic SRS", 0, "NONE", "undefined"),
    ];
    let wgs84 = CoordinateSystem::wgs84().ok();
    for system in wgs84.iter().chain(Some(crs).filter(|c| c.epsg() != Some(4326))) {
        let (Some(code), Some(definition)) = (system.epsg(), system.well_known_text()) else { continue };
        rows.push(row(system.name(), code.into(), "EPSG", definition));
    }
    rows.sort_by_key(|(id, _)| *id);
    NewTable { name: "gpkg_spatial_ref_sys".into(), sql: SYSTEMS.into(), rows, unique: Vec::new() }
}

/// The row of a table in the list of contents.
fn contents(table: &FeatureTable, srs_id: i32) -> Vec<Value<'_>> {
    let [low, high] = extent(&table.features);
    let name = text(&table.name);
    let mut row = vec![name.clone(), text("features"), name, text(""), text(LAST_CHANGE)];
    row.extend([low.x, low.y, high.x, high.y].map(Value::Real));
    row.push(Value::Integer(srs_id.into()));
    row
}

/// The row of a table in the list of geometries, which have heights and no measures.
fn column(table: &FeatureTable, srs_id: i32) -> Vec<Value<'_>> {
    let mut row = vec![text(&table.name), text("geom"), text(kind(table))];
    row.extend([srs_id.into(), 1, 0].map(Value::Integer));
    row
}

fn kind(table: &FeatureTable) -> &'static str {
    match table.features.first().map(|f| &f.geometry) {
        Some(Geometry::Lines(_)) => "MULTILINESTRING",
        Some(Geometry::Polygons(_)) => "MULTIPOLYGON",
        Some(Geometry::Points(_)) => "MULTIPOINT",
        None => "GEOMETRY",
    }
}

/// The table of a layer.
fn features(table: &FeatureTable, srs_id: i32) -> Result<NewTable<'_>, String> {
    let columns: BTreeSet<&String> = table.features.iter().flat_map(|f| f.properties.keys()).collect();
    let mut names = BTreeSet::from(["fid".to_owned(), "geom".to_owned()]);
    if let Some(twice) = columns.iter().find(|column| !names.insert(column.to_ascii_lowercase())) {
        return Err(format!("cannot be written: table \"{}\" has two columns \"{twice}\"; rename one", table.name));
    }
    let quoted = |name: &str| format!("\"{}\"", name.replace('"', "\"\""));
    let listed: String = columns.iter().map(|c| format!(", {} TEXT", quoted(c))).collect();
    let sql = format!("CREATE TABLE {} (fid INTEGER PRIMARY KEY NOT NULL, geom BLOB{listed})", quoted(&table.name));
    let mut rows = Vec::new();
    for (number, feature) in (1..).zip(&table.features) {
        let mut row = vec![Value::Null, Value::Blob(blob(feature, srs_id).into())];
        row.extend(columns.iter().map(|c| feature.properties.get(*c).map_or(Value::Null, |value| text(value))));
        rows.push((number, row));
    }
    Ok(NewTable { name: table.name.clone(), sql, rows, unique: Vec::new() })
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
