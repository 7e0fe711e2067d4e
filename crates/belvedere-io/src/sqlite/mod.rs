//! SQLite databases, version 3 of the format: their tables read from bytes in memory, whole and in the order of their rows, and small
//! databases written.
//!
//! Queries, views, indices and tables without row numbers are not read, nor is a write-ahead log beside the file.

mod header;
mod pages;
mod record;
mod schema;
mod write;

pub(crate) use header::MAGIC;
pub(crate) use record::Value;
pub(crate) use write::{Database as NewDatabase, Table as NewTable};

use header::Header;
use pages::Pages;
use schema::{Column, Kind, Object};

/// A database in memory.
pub(crate) struct Database {
    bytes: Vec<u8>,
    header: Header,
    objects: Vec<Object>,
}

/// A table that can be read.
pub(crate) struct Table {
    /// Its columns, in order.
    columns: Vec<Column>,
    root: u32,
}

impl Database {
    /// * `bytes`: the whole file.
    ///
    /// # Errors
    /// A predicate ("is …") with its remedy for files that are cut off, damaged, or of another version.
    pub(crate) fn open(bytes: Vec<u8>) -> Result<Self, String> {
        let header = Header::of(&bytes)?;
        let mut objects = Vec::new();
        let pages = Pages::new(&bytes, &header);
        pages.each(1, &mut |_, payload| {
            let values = record::values(payload, header.encoding)?;
            objects.extend(Object::of(&values));
            Ok(())
        })?;
        Ok(Self { bytes, header, objects })
    }

    /// The table of a name, in any case of its letters; `None` if there is none.
    ///
    /// # Errors
    /// A predicate for views and for tables that are stored in ways that are not read.
    pub(crate) fn table(&self, name: &str) -> Result<Option<Table>, String> {
        let Some(object) = self.objects.iter().find(|o| o.name.eq_ignore_ascii_case(name)) else { return Ok(None) };
        match object.kind {
            Kind::View => Err("is a view, which is a query and holds no rows; save the view as a table".into()),
            Kind::Virtual => Err("is a virtual table, which holds no rows of its own; save it as a table".into()),
            Kind::Table => {
                let columns = schema::columns(&object.sql)?;
                Ok(Some(Table { columns, root: object.root }))
            }
        }
    }

    /// Calls `visit` with the number and the values of every row of a table, in the order of the columns that it stores.
    ///
    /// # Errors
    /// A predicate where the file is damaged; those of `visit`.
    pub(crate) fn each_row(
        &self,
        table: &Table,
        mut visit: impl FnMut(i64, &[Value<'_>]) -> Result<(), String>,
    ) -> Result<(), String> {
        let pages = Pages::new(&self.bytes, &self.header);
        let stored = table.stored();
        pages.each(table.root, &mut |row, payload| {
            let mut values = record::values(payload, self.header.encoding)?;
            values.truncate(stored.len());
            // Rows that are older than a column do not hold it.
            values.extend(stored.iter().skip(values.len()).map(|column| column.default()));
            for (value, column) in values.iter_mut().zip(&stored) {
                match value {
                    Value::Null if column.is_row => *value = Value::Integer(row),
                    Value::Integer(number) if column.is_real => *value = Value::Real(*number as f64),
                    _ => {}
                }
            }
            visit(row, &values)
        })
    }
}

impl Table {
    fn stored(&self) -> Vec<&Column> {
        self.columns.iter().filter(|column| column.is_stored).collect()
    }

    /// Names of the columns that it stores, in order.
    pub(crate) fn names(&self) -> Vec<&str> {
        self.stored().into_iter().map(|column| column.name.as_str()).collect()
    }

    /// Names of the columns that are computed when they are asked for.
    pub(crate) fn computed(&self) -> Vec<&str> {
        self.columns.iter().filter(|column| !column.is_stored).map(|column| column.name.as_str()).collect()
    }

    /// Name of the first column of the primary key.
    pub(crate) fn key(&self) -> Option<&str> {
        self.columns.iter().find(|column| column.is_key).map(|column| column.name.as_str())
    }

    /// Place among the stored columns of a name, in any case of its letters.
    pub(crate) fn place(&self, name: &str) -> Option<usize> {
        self.stored().iter().position(|column| column.name.eq_ignore_ascii_case(name))
    }
}

/// The error of a file that does not hold what it should.
fn damaged(what: impl std::fmt::Display) -> String {
    format!("is damaged or cut off: {what}; get the file again")
}

#[cfg(test)]
mod tests;
