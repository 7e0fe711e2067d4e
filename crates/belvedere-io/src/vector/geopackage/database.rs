//! The database of a GeoPackage: tables of features, coordinate systems and rows, read by SQLite in memory within bounds.

use rusqlite::config::DbConfig;
use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, MAIN_DB, OptionalExtension};

/// A value of a row.
pub(super) type Value<'r> = ValueRef<'r>;

/// Largest value in a row, bytes, above that of the largest polygons.
const MAX_VALUE: usize = 256 << 20;
/// Most steps of SQLite's machine per byte of a file, besides [`FREE_STEPS`]: rows need fewer than one; endless views are stopped.
const STEPS_PER_BYTE: u64 = 64;
const FREE_STEPS: u64 = 10_000_000;
/// Steps between two checks of the bound.
const STRIDE: u16 = 10_000;
/// Most bytes of geometry per byte of the file: views may repeat a row.
const REPEATS: usize = 8;

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

/// A read-only database in memory.
pub(super) struct Database {
    connection: Connection,
    bytes: usize,
}

fn said(e: rusqlite::Error) -> String {
    match e.sqlite_error_code() {
        Some(rusqlite::ErrorCode::OperationInterrupted) => {
            "takes too many steps for its size; save its view as a table".into()
        }
        Some(rusqlite::ErrorCode::TooBig) => {
            format!("has a value of more than {} MiB; the file is damaged, get it again", MAX_VALUE >> 20)
        }
        _ => format!("is damaged: SQLite says \"{e}\"; get the file again"),
    }
}

impl Database {
    pub(super) fn open(mut bytes: Vec<u8>) -> Result<Self, String> {
        let length = bytes.len();
        complete(&bytes)?;
        // A write-ahead log cannot be in memory; the file itself is complete without it.
        if let Some([write @ 2, read @ 2]) = bytes.get_mut(18..20) {
            (*write, *read) = (1, 1);
        }
        let open = || {
            let mut connection = Connection::open_in_memory()?;
            connection.deserialize_read_exact(MAIN_DB, bytes.as_slice(), length, true)?;
            connection.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
            connection.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
            connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, length.clamp(1 << 20, MAX_VALUE) as i32)?;
            let mut left = (FREE_STEPS + STEPS_PER_BYTE * length as u64) / u64::from(STRIDE);
            let spent = move || {
                left = left.saturating_sub(1);
                left == 0
            };
            connection.progress_handler(STRIDE.into(), Some(spent))?;
            Ok(connection)
        };
        let connection = open().map_err(said)?;
        Ok(Self { connection, bytes: length })
    }

    /// Tables of features, in the order of their names.
    pub(super) fn tables(&self) -> Result<Vec<Table>, String> {
        if !self.has("gpkg_contents")? || !self.has("gpkg_geometry_columns")? {
            return Err(
                "is an SQLite database without the tables of a GeoPackage; export it as GeoPackage or GeoJSON".into()
            );
        }
        let query = "SELECT c.table_name, ifnull(c.identifier, c.table_name), g.column_name, g.srs_id \
             FROM gpkg_contents c JOIN gpkg_geometry_columns g ON lower(g.table_name) = lower(c.table_name) \
             WHERE c.data_type = 'features' ORDER BY c.table_name";
        let read = || {
            let mut statement = self.connection.prepare(query)?;
            let rows = statement.query_map([], |row| {
                Ok(Table { name: row.get(0)?, identifier: row.get(1)?, column: row.get(2)?, srs_id: row.get(3)? })
            })?;
            rows.collect::<rusqlite::Result<Vec<_>>>()
        };
        let tables = read().map_err(said)?;
        if tables.is_empty() {
            return Err(format!("GeoPackage has no table of features{}; choose another file", self.other_contents()));
        }
        Ok(tables)
    }

    fn has(&self, table: &str) -> Result<bool, String> {
        let query = "SELECT count(*) FROM sqlite_master WHERE lower(name) = ?1";
        let count: i64 = self.connection.query_row(query, [table], |row| row.get(0)).map_err(said)?;
        Ok(count > 0)
    }

    /// Kinds of other contents, in words, for the error of a file without features.
    fn other_contents(&self) -> String {
        let query = "SELECT group_concat(DISTINCT data_type) FROM gpkg_contents";
        let kinds: Option<String> = self.connection.query_row(query, [], |row| row.get(0)).unwrap_or_default();
        kinds.map(|kinds| format!(", only {kinds}")).unwrap_or_default()
    }

    /// The coordinate system of a number.
    pub(super) fn system(&self, srs_id: i64) -> Result<Option<System>, String> {
        let query = "SELECT srs_name, organization, organization_coordsys_id, definition FROM gpkg_spatial_ref_sys WHERE srs_id = ?1";
        let read = |row: &rusqlite::Row<'_>| {
            let (name, organization): (String, String) = (row.get(0)?, row.get(1)?);
            let code: i64 = row.get(2)?;
            let epsg = organization.eq_ignore_ascii_case("EPSG").then(|| u32::try_from(code).ok()).flatten();
            Ok(System { name, epsg, definitions: vec![row.get(3)?] })
        };
        let system = self.connection.query_row(query, [srs_id], read).optional().map_err(said)?;
        // A column of newer files, for systems that older texts cannot describe.
        let newer = "SELECT definition_12_063 FROM gpkg_spatial_ref_sys WHERE srs_id = ?1";
        let newer = self.connection.query_row(newer, [srs_id], |row| row.get(0)).ok();
        Ok(system.map(|mut system| {
            system.definitions.extend(newer);
            system
        }))
    }

    /// Calls `visit` with the row in words, the geometry and the other values of every row.
    ///
    /// Error texts continue a sentence that begins with the name of the table.
    pub(super) fn each_row(
        &self,
        table: &Table,
        mut visit: impl FnMut(&str, Option<&[u8]>, &[(String, Value<'_>)]) -> Result<(), String>,
    ) -> Result<(), String> {
        let said = |e| format!(" {}", said(e));
        let key = self.key(table).map_err(said)?;
        let query = format!("SELECT * FROM \"{}\"", table.name.replace('"', "\"\""));
        let mut statement = self.connection.prepare(&query).map_err(said)?;
        let names: Vec<String> = statement.column_names().map(str::to_owned).collect();
        let is = |name: &str, wanted: &str| name.eq_ignore_ascii_case(wanted);
        let geometry = names.iter().position(|n| is(n, &table.column));
        let geometry = geometry.ok_or_else(|| {
            format!(" has no column \"{}\", where its geometry should be; export it again", table.column)
        })?;
        let (mut rows, mut number, mut left) =
            (statement.query([]).map_err(said)?, 0, self.bytes.saturating_mul(REPEATS));
        while let Some(row) = rows.next().map_err(said)? {
            number += 1;
            let mut place = format!("row {number}");
            let mut values = Vec::with_capacity(names.len());
            for (i, name) in names.iter().enumerate().filter(|(i, _)| *i != geometry) {
                let value = row.get_ref(i).map_err(said)?;
                if let (true, ValueRef::Integer(id)) = (is(name, &key), value) {
                    place = format!("{name} {id}");
                }
                values.push((name.clone(), value));
            }
            let blob = match row.get_ref(geometry).map_err(said)? {
                ValueRef::Null => None,
                ValueRef::Blob(blob) => Some(blob),
                other => {
                    return Err(format!(
                        ", {place}: its geometry is {:?}, not binary; export it again",
                        other.data_type()
                    ));
                }
            };
            let size = blob.map_or(0, <[u8]>::len) + 16;
            left = left.checked_sub(size).ok_or_else(|| {
                format!(" shows more than {REPEATS} times what the file holds; save the view as a table")
            })?;
            visit(&place, blob, &values)?;
        }
        Ok(())
    }

    /// Name of the column that numbers the rows, possibly empty.
    fn key(&self, table: &Table) -> rusqlite::Result<String> {
        let query = "SELECT name FROM pragma_table_info(?1) WHERE pk = 1";
        Ok(self.connection.query_row(query, [&table.name], |row| row.get(0)).optional()?.unwrap_or_default())
    }
}

/// Whether the file is as long as its header says.
fn complete(bytes: &[u8]) -> Result<(), String> {
    let cut = |wanted: u64| {
        format!("is {} bytes long, its header says {wanted}; the file is cut off, get it again", bytes.len())
    };
    let number = |at: usize| bytes.get(at..at + 4).map(|b| u64::from(u32::from_be_bytes([b[0], b[1], b[2], b[3]])));
    let page = match bytes.get(16..18) {
        Some(&[0, 1]) => 65_536,
        Some(&[a, b]) => u64::from(u16::from_be_bytes([a, b])),
        _ => 0,
    };
    let (Some(pages), Some(changes), Some(valid_for)) = (number(28), number(24), number(92)) else {
        return Err(format!(
            "is {} bytes long, an SQLite file has a header of 100; the file is cut off, get it again",
            bytes.len()
        ));
    };
    // Old programs leave the count of pages as it was.
    if changes == valid_for && pages * page > bytes.len() as u64 {
        return Err(cut(pages * page));
    }
    Ok(())
}
