//! Databases that are written whole: tables with their rows, and the indices that unique columns need.

use super::header::{MAGIC, SIZE};
use super::record::Value;

/// Bytes of a page.
const PAGE: usize = 4096;
/// Bytes for cells and their pointers on any page, the first with the header of the file among them.
const ROOM: usize = PAGE - SIZE - 12;
/// Number of the version of SQLite that is said to have written last; a newer one than the format needs.
const VERSION: u32 = 3_040_000;

/// A table that is written.
pub(crate) struct Table<'v> {
    /// Its name.
    pub(crate) name: String,
    /// The statement that makes it.
    pub(crate) sql: String,
    /// Its rows with their numbers, which rise; a column that is the number of the row holds null.
    pub(crate) rows: Vec<(i64, Vec<Value<'v>>)>,
    /// Columns of each of the indices that its statement implies, in its order; their values are texts.
    pub(crate) unique: Vec<Vec<usize>>,
}

/// A database that is written.
pub(crate) struct Database<'v> {
    /// The mark of the program that it is of.
    pub(crate) application: [u8; 4],
    /// Version of what that program writes.
    pub(crate) version: u32,
    /// Its tables.
    pub(crate) tables: Vec<Table<'v>>,
}

/// Trees of tables have the numbers of rows as keys, those of indices their records.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Tree {
    Table,
    Index,
}

/// A cell of a leaf, and the number of its row.
struct Cell {
    bytes: Vec<u8>,
    row: i64,
}

/// The pages of the file.
struct Pages(Vec<Vec<u8>>);

impl Database<'_> {
    /// The bytes of the file.
    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut pages = Pages(vec![Vec::new()]);
        let mut schema: Vec<Vec<Value<'_>>> = Vec::new();
        for table in &self.tables {
            let text = |text: &str| Value::Text(text.to_owned().into());
            let records = table.rows.iter().map(|(row, values)| (*row, record(values)));
            let root = pages.add(Tree::Table, records);
            let name = || text(&table.name);
            schema.push(vec![text("table"), name(), name(), Value::Integer(root), text(&table.sql)]);
            for (k, columns) in table.unique.iter().enumerate() {
                let root = pages.add(Tree::Index, table.keys(columns).into_iter().map(|key| (0, key)));
                let index = text(&format!("sqlite_autoindex_{}_{}", table.name, k + 1));
                schema.push(vec![text("index"), index, name(), Value::Integer(root), Value::Null]);
            }
        }
        let cells: Vec<Cell> = pages.cells(Tree::Table, (1..).zip(schema.iter().map(|row| record(row))));
        pages.tree(Tree::Table, cells, 0);
        let head = self.header(pages.0.len());
        pages.0[0][..SIZE].copy_from_slice(&head);
        pages.0.concat()
    }

    fn header(&self, pages: usize) -> [u8; SIZE] {
        let mut head = [0; SIZE];
        let mut put = |at: usize, bytes: &[u8]| head[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, MAGIC);
        put(16, &(PAGE as u16).to_be_bytes());
        put(18, &[1, 1, 0, 64, 32, 32]);
        // The counts of changes to the file, of its pages, of the schema, its format, and the encoding UTF-8.
        for (at, number) in [(24, 1), (28, pages as u32), (40, 1), (44, 4), (56, 1), (60, self.version), (92, 1)] {
            put(at, &u32::to_be_bytes(number));
        }
        put(68, &self.application);
        put(96, &VERSION.to_be_bytes());
        head
    }
}

impl Table<'_> {
    /// The records of an index, in order: its columns and the number of the row.
    fn keys(&self, columns: &[usize]) -> Vec<Vec<u8>> {
        let mut keys: Vec<(Vec<&str>, i64)> = Vec::new();
        for (row, values) in &self.rows {
            keys.push((columns.iter().filter_map(|c| values.get(*c)?.text()).collect(), *row));
        }
        keys.sort();
        let key = |(texts, row): &(Vec<&str>, i64)| {
            let texts = texts.iter().map(|text| Value::Text((*text).into()));
            record(&texts.chain([Value::Integer(*row)]).collect::<Vec<_>>())
        };
        keys.iter().map(key).collect()
    }
}

impl Pages {
    fn reserve(&mut self) -> usize {
        self.0.push(Vec::new());
        self.0.len() - 1
    }

    /// Adds a tree of records; returns the number of its first page.
    fn add(&mut self, kind: Tree, records: impl Iterator<Item = (i64, Vec<u8>)>) -> i64 {
        let root = self.reserve();
        let cells = self.cells(kind, records);
        self.tree(kind, cells, root);
        root as i64 + 1
    }

    /// The cells of records; what does not fit a page goes to pages of its own.
    fn cells(&mut self, kind: Tree, records: impl Iterator<Item = (i64, Vec<u8>)>) -> Vec<Cell> {
        let least = (PAGE - 12) * 32 / 255 - 23;
        let most = match kind {
            Tree::Table => PAGE - 35,
            Tree::Index => (PAGE - 12) * 64 / 255 - 23,
        };
        let mut cells = Vec::new();
        for (row, record) in records {
            let mut bytes = varint(record.len() as u64);
            if kind == Tree::Table {
                bytes.extend(varint(row as u64));
            }
            let local = match record.len() {
                size if size <= most => size,
                size => {
                    let fit = least + (size - least) % (PAGE - 4);
                    if fit <= most { fit } else { least }
                }
            };
            bytes.extend(&record[..local]);
            let parts: Vec<&[u8]> = record[local..].chunks(PAGE - 4).collect();
            if !parts.is_empty() {
                bytes.extend(number(self.0.len()));
            }
            for (k, part) in parts.iter().enumerate() {
                let next = if k + 1 < parts.len() { number(self.0.len() + 1) } else { [0; 4] };
                let mut page = [&next, *part].concat();
                page.resize(PAGE, 0);
                self.0.push(page);
            }
            cells.push(Cell { bytes, row });
        }
        cells
    }

    /// Lays cells out as a tree whose first page was reserved.
    fn tree(&mut self, kind: Tree, cells: Vec<Cell>, root: usize) {
        // Pages of a level, each without its cells of the next, and what stands between two of them.
        let mut level = cells;
        let mut children: Option<Vec<usize>> = None;
        loop {
            let (pages, between) = split(kind, level, children.is_some());
            let single = pages.len() == 1;
            let mut numbers = Vec::new();
            let mut below = children.iter().flatten().copied();
            for cells in pages {
                let at = if single { root } else { self.reserve() };
                let below: Option<Vec<usize>> =
                    children.as_ref().map(|_| below.by_ref().take(cells.len() + 1).collect());
                self.0[at] = page(kind, &cells, below.as_deref(), if at == 0 { SIZE } else { 0 });
                numbers.push(at);
            }
            if single {
                return;
            }
            level = between;
            children = Some(numbers);
        }
    }
}

/// The cells of each page of a level, and the cell between each two pages, which goes up.
fn split(kind: Tree, cells: Vec<Cell>, is_inside: bool) -> (Vec<Vec<Cell>>, Vec<Cell>) {
    let (mut pages, mut between) = (vec![Vec::new()], Vec::new());
    let (mut left, mut cells) = (ROOM, cells.into_iter().peekable());
    while let Some(cell) = cells.next() {
        let needs = cell.bytes.len() + 2 + 4 * usize::from(is_inside);
        let is_last = cells.peek().is_none();
        // A cell alone fits any page but the first, which never holds just one.
        if let Some(page) = pages.last_mut().filter(|page: &&mut Vec<Cell>| needs <= left || page.is_empty()) {
            left = left.saturating_sub(needs);
            page.push(cell);
            continue;
        }
        left = ROOM;
        let row = cell.row;
        // Cells of leaves of a table stay on leaves; others go up, unless no cell would be left for the next page.
        if kind == Tree::Table && !is_inside {
            left = left.saturating_sub(needs);
            between.push(Cell { bytes: varint((row - 1) as u64), row: row - 1 });
            pages.push(vec![cell]);
        } else if is_last && let Some(up) = pages.last_mut().and_then(Vec::pop) {
            between.push(up);
            pages.push(vec![cell]);
        } else {
            between.push(cell);
            pages.push(Vec::new());
        }
    }
    (pages, between)
}

/// A page with its cells, the pages below before each of them and the last one.
fn page(kind: Tree, cells: &[Cell], below: Option<&[usize]>, start: usize) -> Vec<u8> {
    let mut page = vec![0; PAGE];
    let code = match (kind, below) {
        (Tree::Table, None) => 13,
        (Tree::Table, Some(_)) => 5,
        (Tree::Index, None) => 10,
        (Tree::Index, Some(_)) => 2,
    };
    let (mut free, mut pointer) = (PAGE, start + if below.is_some() { 12 } else { 8 });
    for (k, cell) in cells.iter().enumerate() {
        let child = below.and_then(|below| below.get(k)).map(|child| number(*child));
        let bytes = [child.as_ref().map_or(&[][..], |c| c), &cell.bytes].concat();
        free -= bytes.len();
        page[free..free + bytes.len()].copy_from_slice(&bytes);
        page[pointer..pointer + 2].copy_from_slice(&(free as u16).to_be_bytes());
        pointer += 2;
    }
    page[start] = code;
    page[start + 3..start + 5].copy_from_slice(&(cells.len() as u16).to_be_bytes());
    page[start + 5..start + 7].copy_from_slice(&(free as u16).to_be_bytes());
    if let Some(last) = below.and_then(<[usize]>::last) {
        page[start + 8..start + 12].copy_from_slice(&number(*last));
    }
    page
}

/// The number of a page, which counts from 1 on.
fn number(at: usize) -> [u8; 4] {
    (at as u32 + 1).to_be_bytes()
}

/// A number of 1 to 9 bytes.
fn varint(number: u64) -> Vec<u8> {
    if number >> 56 != 0 {
        let mut out: Vec<u8> = (0..8).map(|k| (number >> (57 - 7 * k)) as u8 | 0x80).collect();
        out.push(number as u8);
        return out;
    }
    let groups = (64 - (number | 1).leading_zeros()).div_ceil(7);
    let group = |k: u32| (number >> (7 * k)) as u8 & 0x7f | if k > 0 { 0x80 } else { 0 };
    (0..groups).rev().map(group).collect()
}

/// The record of a row.
fn record(values: &[Value<'_>]) -> Vec<u8> {
    let (mut types, mut body) = (Vec::new(), Vec::new());
    for value in values {
        types.extend(varint(match value {
            Value::Null => 0,
            Value::Integer(number) => {
                let bits = 65 - (number ^ (number >> 63)).leading_zeros() as usize;
                let sizes = [(1, 1), (2, 2), (3, 3), (4, 4), (6, 5)];
                let (size, code) = sizes.into_iter().find(|(size, _)| bits <= 8 * size).unwrap_or((8, 6));
                body.extend(&number.to_be_bytes()[8 - size..]);
                code
            }
            Value::Real(number) => {
                body.extend(number.to_be_bytes());
                7
            }
            Value::Text(text) => {
                body.extend(text.as_bytes());
                13 + 2 * text.len() as u64
            }
            Value::Blob(bytes) => {
                body.extend(&**bytes);
                12 + 2 * bytes.len() as u64
            }
        }));
    }
    // The length of the head counts itself.
    let size = (1..).find(|size| varint((types.len() + size) as u64).len() == *size).unwrap_or(1);
    [varint((types.len() + size) as u64), types, body].concat()
}
