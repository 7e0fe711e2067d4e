//! MBTiles: tiles in a database of SQLite, rows from the south.
//!
//! Source: Mapbox, MBTiles specification 1.3.

use super::key::Key;
use super::store::{Listed, Store, Tile};
use crate::sqlite::{Database, Value};
use crate::{Fault, InputFile, IoError, Limits, fs};
use std::collections::HashMap;
use std::path::Path;

/// The columns of a place.
const PLACE: [&str; 3] = ["zoom_level", "tile_column", "tile_row"];
/// Tables behind a view `tiles`, which keep equal tiles once: that of places, that of pictures, and the column that joins them.
const JOINED: [[&str; 3]; 2] = [["map", "images", "tile_id"], ["tiles_shallow", "tiles_data", "tile_data_id"]];

/// Lists the tiles of a database.
///
/// # Errors
/// [`IoError::Os`]; [`IoError::Format`] for what is no such database.
pub(super) fn list(path: &Path, limits: &Limits) -> Result<Listed, IoError> {
    let bad = |e: Fault| IoError::format(path, e);
    let length = fs::metadata(path).map_err(|e| IoError::os(path, e))?.len();
    // The file, and the bytes of its tiles.
    limits.ask("the tiles", length.saturating_mul(2)).map_err(|e| bad(e.into()))?;
    let (bytes, file) = InputFile::read(path)?;
    let database = Database::open(bytes).map_err(|e| bad(e.into()))?;
    let metadata = metadata(&database);
    match metadata.get("format").map(String::as_str) {
        Some("pbf" | "mvt") => return Err(bad(super::picture::VECTORS.into())),
        Some("jpg" | "jpeg") => return Err(bad(super::picture::PHOTOS.into())),
        _ => {}
    }
    let mut out = Taken::default();
    out.take(&database).map_err(|e| bad(e.into()))?;
    let encoding = metadata.get("encoding").cloned();
    Ok(Listed { tiles: out.tiles, store: Store::Bytes(out.bytes), encoding, odd: out.odd, file: Some(file) })
}

/// Names and values of the table of metadata; nothing of one that cannot be read.
fn metadata(database: &Database) -> HashMap<String, String> {
    let mut out = HashMap::new();
    let Ok(Some(table)) = database.table("metadata") else { return out };
    let (Some(name), Some(value)) = (table.place("name"), table.place("value")) else { return out };
    let _ = database.each_row(&table, |_, values| {
        if let (Some(name), Some(value)) = (values.get(name).and_then(Value::text), values.get(value)) {
            out.insert(name.to_ascii_lowercase(), value.text().unwrap_or_default().to_owned());
        }
        Ok(())
    });
    out
}

/// What is taken of a database.
#[derive(Default)]
struct Taken {
    tiles: Vec<Tile>,
    bytes: Vec<u8>,
    odd: usize,
}

impl Taken {
    fn take(&mut self, database: &Database) -> Result<(), String> {
        let view = match database.table("tiles") {
            Ok(Some(_)) => return self.take_table(database),
            Ok(None) => {
                return Err("is an SQLite database without a table or view of tiles; choose another file".into());
            }
            Err(view) => view,
        };
        for [places, pictures, id] in JOINED {
            if let (Ok(Some(_)), Ok(Some(_))) = (database.table(places), database.table(pictures)) {
                return self.take_joined(database, [places, pictures, id]);
            }
        }
        Err(format!("{view} (table \"tiles\"), and the tables behind it are not known"))
    }

    fn take_table(&mut self, database: &Database) -> Result<(), String> {
        let columns = [PLACE[0], PLACE[1], PLACE[2], "tile_data"];
        rows(database, "tiles", columns, |_, [zoom, column, row, data]| {
            if let Value::Blob(data) = data {
                let at = self.bytes.len();
                self.bytes.extend_from_slice(data);
                self.push(&[zoom, column, row], (at, data.len()));
            }
        })
    }

    fn take_joined(&mut self, database: &Database, [places, pictures, id]: [&str; 3]) -> Result<(), String> {
        // An id may be a text, or the number of the row.
        let word = |id: &Value<'_>| id.text().map(str::to_owned).or_else(|| id.integer().map(|n| n.to_string()));
        let mut stored = HashMap::new();
        rows(database, pictures, [id, "tile_data"], |row, [id, data]| {
            if let Value::Blob(data) = data {
                let at = self.bytes.len();
                self.bytes.extend_from_slice(data);
                stored.insert(word(id).unwrap_or_else(|| row.to_string()), (at, data.len()));
            }
        })?;
        rows(database, places, [PLACE[0], PLACE[1], PLACE[2], id], |_, [zoom, column, row, id]| {
            match word(id).and_then(|id| stored.get(&id)) {
                Some(found) => self.push(&[zoom, column, row], *found),
                None => self.odd += 1,
            }
        })
    }

    fn push(&mut self, place: &[&Value<'_>; 3], (at, length): (usize, usize)) {
        let [zoom, column, row] = place.map(|value| value.integer().and_then(|n| u64::try_from(n).ok()));
        let key = zoom.zip(column).zip(row).and_then(|((zoom, column), row)| {
            let zoom = u8::try_from(zoom).ok().filter(|zoom| *zoom < 64)?;
            Key::new(zoom, column, ((1u64 << zoom) - 1).checked_sub(row)?)
        });
        match (key, u32::try_from(length)) {
            (Some(key), Ok(length)) => self.tiles.push(Tile { key, at: at as u64, length }),
            _ => self.odd += 1,
        }
    }
}

/// Calls `visit` with the number and some columns of every row of a table.
fn rows<const N: usize>(
    database: &Database,
    name: &str,
    columns: [&str; N],
    mut visit: impl FnMut(i64, [&Value<'_>; N]),
) -> Result<(), String> {
    let Some(table) = database.table(name)? else { return Ok(()) };
    let places = columns.map(|column| table.place(column));
    if let Some(k) = places.iter().position(Option::is_none) {
        return Err(format!("has no column \"{}\" in its table \"{name}\"; export it again", columns[k]));
    }
    database.each_row(&table, |row, values| {
        visit(row, places.map(|at| at.and_then(|at| values.get(at)).unwrap_or(&Value::Null)));
        Ok(())
    })
}
