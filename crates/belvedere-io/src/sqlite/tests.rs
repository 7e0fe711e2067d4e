//! Our reader and writer against SQLite itself, and damaged files.

use super::*;
use rusqlite::types::Value as Theirs;
use rusqlite::{Connection, MAIN_DB, params_from_iter};

/// Numbers that are random enough.
struct Random(u64);

impl Random {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }

    fn value(&mut self, longest: u64) -> Theirs {
        let size = self.next(longest) as usize;
        match self.next(9) {
            0 => Theirs::Null,
            1 => Theirs::Integer(self.next(3) as i64),
            2 => Theirs::Integer((self.0 as i64) >> self.next(60)),
            3 => Theirs::Integer([i64::MIN, i64::MAX, -1, 128, -129, 1 << 47, -(1 << 47) - 1][self.next(7) as usize]),
            4 => Theirs::Real(f64::from_bits(self.0)),
            5 => Theirs::Real(self.next(100) as f64),
            6 => Theirs::Text("é x".repeat(size / 3)),
            7 => Theirs::Text(String::new()),
            _ => Theirs::Blob((0..size).map(|k| (k as u64 ^ self.0) as u8).collect()),
        }
    }
}

fn ours(value: &Value<'_>) -> Theirs {
    match value {
        Value::Null => Theirs::Null,
        Value::Integer(number) => Theirs::Integer(*number),
        Value::Real(number) => Theirs::Real(*number),
        Value::Text(text) => Theirs::Text(text.clone().into_owned()),
        Value::Blob(bytes) => Theirs::Blob(bytes.clone().into_owned()),
    }
}

fn read(bytes: Vec<u8>, table: &str) -> Result<Vec<(i64, Vec<Theirs>)>, String> {
    let database = Database::open(bytes)?;
    let table = database.table(table)?.ok_or("has no such table")?;
    let mut rows = Vec::new();
    database.each_row(&table, |row, values| {
        rows.push((row, values.iter().map(ours).collect()));
        Ok(())
    })?;
    Ok(rows)
}

fn rows_of(connection: &Connection, table: &str) -> Vec<(i64, Vec<Theirs>)> {
    let mut statement = connection.prepare(&format!("SELECT rowid, * FROM {table} ORDER BY rowid")).unwrap();
    let count = statement.column_count();
    let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, (1..count).map(|k| row.get(k)).collect::<Result<_, _>>()?));
    statement.query_map([], row).unwrap().map(Result::unwrap).collect()
}

fn bytes_of(connection: &mut Connection) -> Vec<u8> {
    connection.serialize(MAIN_DB).unwrap().to_vec()
}

/// A database of random rows, of which some were changed and deleted.
fn made(seed: u64, page: u32, pragmas: &str, count: u64) -> Connection {
    let mut random = Random(seed);
    let connection = Connection::open_in_memory().unwrap();
    connection.execute_batch(&format!("PRAGMA page_size = {page}; {pragmas}")).unwrap();
    let sql = "CREATE TABLE other (x); CREATE TABLE t (a, id INTEGER PRIMARY KEY, \"b, (c\" REAL DEFAULT 5, d TEXT, e NUMERIC, f BLOB); BEGIN";
    connection.execute_batch(sql).unwrap();
    let longest = if seed.is_multiple_of(3) { 40 } else { 9000 };
    {
        let mut insert = connection.prepare("INSERT OR REPLACE INTO t VALUES (?, ?, ?, ?, ?, ?)").unwrap();
        for k in 0..count {
            let mut row: Vec<Theirs> = (0..6).map(|_| random.value(longest)).collect();
            row[1] = if seed.is_multiple_of(2) {
                Theirs::Null
            } else {
                Theirs::Integer(random.next(4 * count) as i64 - k as i64)
            };
            insert.execute(params_from_iter(row)).unwrap();
        }
    }
    let kept = random.next(5) + 2;
    connection
        .execute_batch(&format!(
            "DELETE FROM t WHERE rowid % {kept} = 0; UPDATE t SET f = zeroblob(3000) WHERE rowid % 17 = 0; COMMIT;
             ALTER TABLE t ADD COLUMN late REAL DEFAULT 7; ALTER TABLE t ADD COLUMN later TEXT DEFAULT 'it''s';
             ALTER TABLE t ADD COLUMN last NUMERIC DEFAULT -2.5e-3; INSERT INTO t (a) VALUES (1)"
        ))
        .unwrap();
    if seed.is_multiple_of(5) {
        connection.execute_batch("VACUUM").unwrap();
    }
    connection
}

#[test]
fn random_databases_are_read_as_sqlite_reads_them() {
    let pages = [512, 1024, 2048, 4096, 8192, 16_384, 32_768, 65_536];
    let pragmas = [
        "",
        "PRAGMA auto_vacuum = FULL;",
        "PRAGMA encoding = 'UTF-16le';",
        "PRAGMA encoding = 'UTF-16be'; PRAGMA auto_vacuum = INCREMENTAL;",
    ];
    for seed in 0..32u64 {
        let [page, pragma] = [pages[seed as usize % 8].to_string(), pragmas[seed as usize / 8].to_owned()];
        let mut connection = made(seed, page.parse().unwrap(), &pragma, 400);
        let (theirs, ours) = (rows_of(&connection, "t"), read(bytes_of(&mut connection), "T").unwrap());
        assert!(theirs.len() > 100 && theirs == ours, "seed {seed}, page {page}, {pragma}");
        assert_eq!(read(bytes_of(&mut connection), "other").unwrap(), []);
    }
}

#[test]
fn many_rows_are_read_in_their_order() {
    let mut connection = made(6, 4096, "", 230_000);
    let rows = read(bytes_of(&mut connection), "t").unwrap();
    assert!(rows.len() > 100_000 && rows == rows_of(&connection, "t"));
}

#[test]
fn statements_tell_the_columns() {
    let mut connection = Connection::open_in_memory().unwrap();
    for (k, columns) in [
        "a INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, b MEDIUMINT -- one, two\n, c /* ) */ TEXT CHECK (c <> ')')",
        "[x y] TEXT, `z``1` DOUBLE PRECISION, 'w' VARCHAR(3, 4), PRIMARY KEY (\"X Y\")",
        "a INTEGER, b, CONSTRAINT k PRIMARY KEY (a DESC), UNIQUE (b)",
        "a INTEGER PRIMARY KEY DESC, b",
        "a INT PRIMARY KEY, \"check\" INTEGER, PRIMARY_kind",
        "a INTEGER, b INTEGER, PRIMARY KEY (a, b)",
        "a INTEGER PRIMARY KEY, b AS (a + 1), c GENERATED ALWAYS AS (a * 2) STORED, d",
        "größe REAL, \"geom\" BLOB, fid INTEGER NOT NULL PRIMARY KEY",
    ]
    .into_iter()
    .enumerate()
    {
        connection.execute_batch(&format!("CREATE TABLE t{k} ({columns})")).unwrap();
        let query = "SELECT name, pk, hidden FROM pragma_table_xinfo(?1)";
        let known: Vec<(String, i64, i64)> = {
            let mut statement = connection.prepare(query).unwrap();
            let row = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?, row.get(2)?));
            statement.query_map([format!("t{k}")], row).unwrap().map(Result::unwrap).collect()
        };
        let database = Database::open(bytes_of(&mut connection)).unwrap();
        let table = database.table(&format!("T{k}")).unwrap().unwrap();
        let stored: Vec<&str> =
            known.iter().filter(|(_, _, hidden)| *hidden != 2).map(|(name, ..)| name.as_str()).collect();
        assert_eq!(table.names(), stored, "{columns}");
        let key = known.iter().find(|(_, key, _)| *key == 1).map(|(name, ..)| name.as_str());
        assert_eq!(table.key(), key, "{columns}");
    }
    connection
        .execute_batch("INSERT INTO t2 VALUES (7, 8); INSERT INTO t3 VALUES (7, 8); INSERT INTO t6 VALUES (7, 8)")
        .unwrap();
    for table in ["t2", "t3"] {
        assert_eq!(read(bytes_of(&mut connection), table).unwrap(), rows_of(&connection, table), "{table}");
    }
    let [seven, fourteen, eight] = [7, 14, 8].map(Theirs::Integer);
    assert_eq!(read(bytes_of(&mut connection), "t6").unwrap(), [(7, vec![seven, fourteen, eight])]);
}

#[test]
fn what_holds_no_rows_is_refused_by_its_kind() {
    let mut connection = Connection::open_in_memory().unwrap();
    connection
        .execute_batch(
            "CREATE TABLE w (a PRIMARY KEY, b) WITHOUT ROWID; CREATE VIEW v AS SELECT * FROM w; CREATE TABLE t (a) STRICT",
        )
        .unwrap_or_else(|_| connection.execute_batch("CREATE TABLE t (a)").unwrap());
    let database = Database::open(bytes_of(&mut connection)).unwrap();
    let refusal = |name: &str| database.table(name).err().unwrap_or_default();
    assert!(refusal("w").contains("WITHOUT ROWID"), "{}", refusal("w"));
    assert!(refusal("v").contains("is a view"), "{}", refusal("v"));
    assert!(database.table("nothing").unwrap().is_none());
}

#[test]
fn damaged_files_end_in_one_error() {
    let whole = bytes_of(&mut made(1, 1024, "PRAGMA auto_vacuum = FULL;", 120));
    for k in 0..100 {
        let cut = whole.len() * k / 100;
        let text = read(whole[..cut].to_vec(), "t").expect_err("cut");
        assert!(text.contains("get it again") && text.contains("cut off"), "{cut}: {text}");
        // Without a count of pages in its header.
        let mut old = whole[..cut].to_vec();
        if let Some(count) = old.get_mut(92..96) {
            count.fill(0);
        }
        let text = read(old, "t").expect_err("cut");
        assert!(text.contains("get"), "{cut}: {text}");
    }
    let mut random = Random(5);
    let mut refused = 0;
    for _ in 0..3000 {
        let mut damaged = whole.clone();
        for _ in 0..=random.next(8) {
            let page = random.next(damaged.len() as u64 / 1024) as usize * 1024;
            let at = page + if random.next(2) == 0 { random.next(1024) } else { random.next(20) } as usize;
            damaged[at] = random.0 as u8;
        }
        refused += usize::from(read(damaged, "t").is_err());
    }
    assert!(refused > 300, "{refused}");
}

#[test]
fn trees_that_run_in_circles_are_refused() {
    let whole = bytes_of(&mut made(2, 512, "", 200));
    let pages = whole.len() / 512;
    let mut seen = 0;
    for page in 1..pages {
        let mut damaged = whole.clone();
        if damaged[page * 512] != 5 {
            continue;
        }
        seen += 1;
        let itself = (page as u32 + 1).to_be_bytes();
        damaged[page * 512 + 8..page * 512 + 12].copy_from_slice(&itself);
        let text = read(damaged, "t").expect_err("circle");
        assert!(text.contains("two places"), "{text}");
    }
    assert!(seen > 2);
}

/// A database that our writer makes.
fn written(rows: usize, size: usize) -> Vec<u8> {
    let text = |text: String| Value::Text(text.into());
    let row = |k: usize| {
        let name = text(format!("{:05}{}", k * 7919 % 100_000, "n".repeat(k % 7 * size / 8)));
        let number = (k as i64 - 40) << (k % 50);
        vec![
            Value::Null,
            name,
            Value::Integer(number),
            Value::Real(k as f64 / 3.0),
            Value::Blob(vec![k as u8; k % 11 * size].into()),
        ]
    };
    let table = |name: &str, rows: usize| NewTable {
        name: name.into(),
        sql: format!(
            "CREATE TABLE {name} (id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, number INTEGER, part REAL, bytes BLOB)"
        ),
        rows: (0..rows).map(|k| (k as i64 * 3 - 30, row(k))).collect(),
        unique: vec![vec![1]],
    };
    let tables = (0..60).map(|k| table(&format!("t{k}"), if k == 7 { rows } else { k % 4 })).collect();
    NewDatabase { application: *b"GPKG", version: 10_300, tables }.encode()
}

#[test]
fn what_is_written_is_read_by_sqlite_and_by_us() {
    for (rows, size) in [(0, 0), (1, 3), (300, 40), (2000, 900), (30_000, 5)] {
        let bytes = written(rows, size);
        let mut connection = Connection::open_in_memory().unwrap();
        connection.deserialize_read_exact(MAIN_DB, bytes.as_slice(), bytes.len(), true).unwrap();
        let check: String = connection.query_row("PRAGMA integrity_check", [], |row| row.get(0)).unwrap();
        assert_eq!(check, "ok", "{rows} rows");
        for name in ["t7", "t59", "t0"] {
            assert_eq!(read(bytes.clone(), name).unwrap(), rows_of(&connection, name), "{rows} {name}");
        }
        let query = "SELECT count(*) FROM t7 a JOIN t7 b INDEXED BY sqlite_autoindex_t7_1 ON b.name = a.name";
        let count: usize = connection.query_row(query, [], |row| row.get::<_, i64>(0)).unwrap() as usize;
        assert_eq!(count, rows);
    }
}
