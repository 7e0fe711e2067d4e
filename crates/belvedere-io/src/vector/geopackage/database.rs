//! The database of a GeoPackage: tables of features, coordinate systems and rows.

use crate::sqlite::{Database as Sqlite, Table as Stored, Value};
use std::collections::BTreeSet;

/// A table of features.
pub(super) struct Table {
    pub(super) name: String,
    /// Readable name.
    pub(super) identifier: String,
    /// Number of its coordinate system in this file.
    pub(super) srs_id: i64,
    column: String,
}

/// A coordinate system as the file has it.
pub(super) struct System {
    pub(super) name: String,
    pub(super) epsg: Option<u32>,
    /// Well-known texts.
    pub(super) definitions: Vec<String>,
}

/// A row of features: its words in errors, its geometry, and its other values with the names of their columns.
pub(super) struct Row<'r> {
    pub(super) place: String,
    pub(super) geometry: Option<&'r [u8]>,
    pub(super) values: Vec<(&'r str, &'r Value<'r>)>,
}

/// A GeoPackage in memory.
pub(super) struct Database(Sqlite);

impl Database {
    pub(super) fn open(bytes: Vec<u8>) -> Result<Self, String> {
        Sqlite::open(bytes).map(Self)
    }

    /// Some columns of every row of a table that every GeoPackage has, null where it lacks the column; `None` without the table.
    fn read<const N: usize>(&self, name: &str, columns: [&str; N]) -> Result<Option<Vec<[Value<'static>; N]>>, String> {
        let place = |e: String| format!("{e} (table \"{name}\")");
        let Some(table) = self.0.table(name).map_err(place)? else { return Ok(None) };
        let places = columns.map(|column| table.place(column));
        let mut rows = Vec::new();
        self.0.each_row(&table, |_, values| {
            rows.push(places.map(|at| at.and_then(|at| values.get(at)).map_or(Value::Null, Value::to_owned)));
            Ok(())
        })?;
        Ok(Some(rows))
    }

    /// Tables of features, in the order of their names.
    pub(super) fn tables(&self) -> Result<Vec<Table>, String> {
        let contents = self.read("gpkg_contents", ["table_name", "data_type", "identifier"])?;
        let columns = self.read("gpkg_geometry_columns", ["table_name", "column_name", "srs_id"])?;
        let Some((contents, columns)) = contents.zip(columns) else {
            return Err(
                "is an SQLite database without the tables of a GeoPackage; export it as GeoPackage or GeoJSON".into()
            );
        };
        let mut tables = Vec::new();
        for [name, kind, identifier] in &contents {
            let Some(name) = name.text().filter(|_| kind.text() == Some("features")) else { continue };
            let is_own = |row: &&[Value<'_>; 3]| row[0].text().is_some_and(|of| of.eq_ignore_ascii_case(name));
            for [_, column, srs_id] in columns.iter().filter(is_own) {
                tables.push(Table {
                    name: name.into(),
                    identifier: identifier.text().unwrap_or(name).into(),
                    column: column.text().unwrap_or_default().into(),
                    srs_id: srs_id.integer().unwrap_or_default(),
                });
            }
        }
        tables.sort_by(|a, b| a.name.cmp(&b.name));
        if tables.is_empty() {
            return Err(without_features(contents.iter().filter_map(|[_, kind, _]| kind.text()).collect()));
        }
        Ok(tables)
    }

    /// The coordinate system of a number.
    pub(super) fn system(&self, srs_id: i64) -> Result<Option<System>, String> {
        // The last column is of newer files, for systems that older texts cannot describe.
        let columns =
            ["srs_id", "srs_name", "organization", "organization_coordsys_id", "definition", "definition_12_063"];
        let rows = self.read("gpkg_spatial_ref_sys", columns)?.unwrap_or_default();
        let found = rows.into_iter().find(|row| row[0].integer() == Some(srs_id));
        Ok(found.map(|[_, name, organization, code, definition, newer]| {
            let is_epsg = organization.text().is_some_and(|name| name.eq_ignore_ascii_case("EPSG"));
            System {
                name: name.text().unwrap_or_default().into(),
                epsg: code.integer().filter(|_| is_epsg).and_then(|code| u32::try_from(code).ok()),
                definitions: [definition, newer].iter().filter_map(Value::text).map(str::to_owned).collect(),
            }
        }))
    }

    /// Calls `visit` with every row, whose number counts from 1 on.
    ///
    /// Error texts continue a sentence that begins with the name of the table.
    pub(super) fn each_row(
        &self,
        table: &Table,
        mut visit: impl FnMut(Row<'_>) -> Result<(), String>,
    ) -> Result<(), String> {
        let stored = self.stored(table)?;
        let names = stored.names();
        let geometry = stored.place(&table.column).ok_or_else(|| {
            format!(" has no column \"{}\", where its geometry should be; export it again", table.column)
        })?;
        let key = stored.key().and_then(|key| stored.place(key));
        let mut number = 0;
        let visited = self.0.each_row(&stored, |_, values| {
            number += 1;
            let id = key.and_then(|key| Some((names[key], values.get(key)?.integer()?)));
            let place = id.map_or_else(|| format!("row {number}"), |(key, id)| format!("{key} {id}"));
            let blob = match values.get(geometry) {
                None | Some(Value::Null) => None,
                Some(Value::Blob(blob)) => Some(&**blob),
                Some(other) => {
                    return Err(format!(", {place}: its geometry is {}, not binary; export it again", other.kind()));
                }
            };
            let others = names.iter().zip(values).enumerate().filter(|(k, _)| *k != geometry);
            visit(Row { place, geometry: blob, values: others.map(|(_, (name, value))| (*name, value)).collect() })
        });
        visited.map_err(|e| if e.starts_with([' ', ',']) { e } else { format!(" {e}") })
    }

    fn stored(&self, table: &Table) -> Result<Stored, String> {
        let stored = self.0.table(&table.name).map_err(|e| format!(" {e}"))?;
        stored.ok_or_else(|| " is listed, but the file has no such table; export it again".into())
    }

    /// Columns of a table that are computed when they are asked for.
    pub(super) fn computed(&self, table: &Table) -> Result<Vec<String>, String> {
        Ok(self.stored(table)?.computed().into_iter().map(str::to_owned).collect())
    }
}

/// The error of a file that holds other kinds of contents.
fn without_features(kinds: BTreeSet<&str>) -> String {
    let remedy = if kinds.contains("2d-gridded-coverage") {
        "its tiles of elevation are not read, gdal_translate turns them into GeoTIFF"
    } else {
        "choose another file"
    };
    let kinds: Vec<&str> = kinds.into_iter().collect();
    let kinds = if kinds.is_empty() { String::new() } else { format!(", only {}", kinds.join(",")) };
    format!("GeoPackage has no table of features{kinds}; {remedy}")
}
