//! FlatGeobuf: files made field by field, with and without an index, cut off and damaged.

use belvedere_io::{Geometry, Loaded, Vectors, load_vectors};

/// A field of a table.
enum Field {
    Left,
    Number(Vec<u8>),
    /// Number of items, and their bytes.
    List(usize, Vec<u8>),
    Table(Table),
    Tables(Vec<Table>),
}

use Field::{Left, List, Number};

/// Bytes of a table with what it refers to, and where it begins.
#[derive(Clone)]
struct Table {
    bytes: Vec<u8>,
    at: usize,
}

fn table(fields: Vec<Field>) -> Table {
    let at = 4 + 2 * fields.len();
    let mut layout = (at as u16).to_le_bytes().to_vec();
    let (mut own, mut slots) = ((at as i32).to_le_bytes().to_vec(), Vec::new());
    let mut places = Vec::new();
    for field in fields {
        places.push(if matches!(field, Left) { 0 } else { own.len() as u16 });
        match field {
            Left => {}
            Number(bytes) => own.extend(bytes),
            other => {
                slots.push((at + own.len(), other));
                own.extend([0; 4]);
            }
        }
    }
    layout.extend((own.len() as u16).to_le_bytes());
    layout.extend(places.iter().flat_map(|place| place.to_le_bytes()));
    let mut bytes = [layout, own].concat();
    for (slot, field) in slots {
        let start = bytes.len();
        let target = match field {
            List(count, items) => {
                bytes.extend((count as u32).to_le_bytes());
                bytes.extend(items);
                start
            }
            Field::Table(table) => {
                bytes.extend(&table.bytes);
                start + table.at
            }
            Field::Tables(tables) => {
                bytes.extend((tables.len() as u32).to_le_bytes());
                bytes.extend(vec![0; 4 * tables.len()]);
                for (k, table) in tables.into_iter().enumerate() {
                    let at = start + 4 + 4 * k;
                    let offset = (bytes.len() + table.at - at) as u32;
                    bytes[at..at + 4].copy_from_slice(&offset.to_le_bytes());
                    bytes.extend(table.bytes);
                }
                start
            }
            Left | Number(_) => continue,
        };
        bytes[slot..slot + 4].copy_from_slice(&((target - slot) as u32).to_le_bytes());
    }
    Table { bytes, at }
}

/// A table as a buffer of its own, with its length before it.
fn sized(table: Table) -> Vec<u8> {
    let root = (table.at as u32 + 4).to_le_bytes();
    [&(table.bytes.len() as u32 + 4).to_le_bytes()[..], &root, &table.bytes].concat()
}

fn text(text: &str) -> Field {
    List(text.len(), text.as_bytes().to_vec())
}

fn numbers(numbers: &[f64]) -> Field {
    List(numbers.len(), numbers.iter().flat_map(|n| n.to_le_bytes()).collect())
}

/// A geometry of its kind, ends of parts, positions and heights.
fn geometry(kind: u8, ends: &[u32], xy: &[f64], z: &[f64], parts: Vec<Table>) -> Table {
    let list = |empty: bool, field: Field| if empty { Left } else { field };
    let ends = list(ends.is_empty(), List(ends.len(), ends.iter().flat_map(|n| n.to_le_bytes()).collect()));
    let parts = list(parts.is_empty(), Field::Tables(parts));
    table(vec![
        ends,
        list(xy.is_empty(), numbers(xy)),
        list(z.is_empty(), numbers(z)),
        Left,
        Left,
        Left,
        Number(vec![kind]),
        parts,
    ])
}

fn feature(name: &str, geometry: Option<Table>) -> Vec<u8> {
    let name = [&0u16.to_le_bytes()[..], &(name.len() as u32).to_le_bytes(), name.as_bytes()].concat();
    let height = [&1u16.to_le_bytes()[..], &12.5f64.to_le_bytes()].concat();
    let photo = [&2u16.to_le_bytes()[..], &2u32.to_le_bytes(), &[7, 8]].concat();
    let flag = [&3u16.to_le_bytes()[..], &[1]].concat();
    let properties = [name, height, photo, flag].concat();
    sized(table(vec![geometry.map_or(Left, Field::Table), List(properties.len(), properties)]))
}

/// A file.
///
/// * `node`: items of a node of the index; 0 = no index.
fn file(kind: u8, node: u16, code: i32, count: u64, features: &[Vec<u8>]) -> Vec<u8> {
    let column = |name: &str, kind: u8| table(vec![text(name), Number(vec![kind])]);
    let columns = vec![column("name", 11), column("height", 10), column("photo", 14), column("flag", 2)];
    let crs = if code == 0 { Left } else { Field::Table(table(vec![text("EPSG"), Number(code.to_le_bytes().into())])) };
    let header = sized(table(vec![
        text("ways"),
        Left,
        Number(vec![kind]),
        Number(vec![1]),
        Left,
        Left,
        Left,
        Field::Tables(columns),
        Number(count.to_le_bytes().into()),
        Number(node.to_le_bytes().into()),
        crs,
    ]));
    let (mut level, mut nodes) = (count as usize, count as usize);
    let mut is_top = node == 0 || count == 0;
    while !is_top {
        level = level.div_ceil(usize::from(node));
        nodes += level;
        is_top = level == 1;
    }
    let index = vec![0xee; if node > 0 { 40 * nodes } else { 0 }];
    [b"fgb\x03fgb\x00".to_vec(), header, index, features.concat()].concat()
}

fn load(bytes: &[u8]) -> Result<Loaded<Vectors>, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.dat");
    std::fs::write(&path, bytes).unwrap();
    load_vectors(&path).map_err(|e| e.to_string())
}

fn said(loaded: &Loaded<Vectors>) -> String {
    loaded.warnings.iter().map(|w| w.text().to_owned()).collect::<Vec<_>>().join("\n")
}

const SQUARE: [f64; 10] = [0.0, 0.0, 4.0, 0.0, 4.0, 4.0, 0.0, 4.0, 0.0, 0.0];
const HOLE: [f64; 8] = [1.0, 1.0, 2.0, 1.0, 2.0, 2.0, 1.0, 1.0];

#[test]
fn every_kind_of_geometry_is_read() {
    let both = [&SQUARE[..], &HOLE].concat();
    let polygon = |kind| geometry(kind, &[5, 9], &both, &[], Vec::new());
    let point = || geometry(1, &[], &[1.0, 2.0], &[3.0], Vec::new());
    let features = [
        feature("point", Some(point())),
        feature("points", Some(geometry(4, &[], &[1.0, 2.0, 3.0, 4.0], &[], Vec::new()))),
        feature("line", Some(geometry(2, &[], &SQUARE, &[5.0; 5], Vec::new()))),
        feature("lines", Some(geometry(5, &[2, 5], &SQUARE, &[], Vec::new()))),
        feature("one line", Some(geometry(5, &[], &SQUARE, &[], Vec::new()))),
        feature("area", Some(polygon(3))),
        feature("areas", Some(geometry(6, &[], &[], &[], vec![polygon(0), polygon(3)]))),
        feature("mixed", Some(geometry(7, &[], &[], &[], vec![point(), polygon(3)]))),
        feature("curve", Some(geometry(8, &[], &SQUARE, &[], Vec::new()))),
        feature("not finite", Some(geometry(2, &[], &[1.0, f64::INFINITY, 2.0, 3.0], &[], Vec::new()))),
        feature("empty", Some(geometry(1, &[], &[f64::NAN, f64::NAN], &[], Vec::new()))),
        feature("nothing", None),
    ];
    for node in [0, 2, 16] {
        let loaded = load(&file(0, node, 32632, 12, &features)).unwrap();
        let vectors = &loaded.value;
        assert_eq!((vectors.format, vectors.layer.as_str(), vectors.crs.epsg()), ("FlatGeobuf", "ways", Some(32632)));
        let held: Vec<(&str, usize)> =
            vectors.features.iter().map(|f| (f.name.as_str(), f.geometry.vertices().count())).collect();
        let line = [("point", 1), ("points", 2), ("line", 5), ("lines", 5), ("one line", 5)];
        assert_eq!(held, [&line[..], &[("area", 7), ("areas", 14), ("mixed", 1), ("mixed", 7)]].concat());
        let Geometry::Lines(lines) = &vectors.features[3].geometry else { panic!() };
        assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
        let z = |k: usize| vectors.features[k].geometry.vertices().next().unwrap().z;
        assert_eq!((z(0), z(1), z(2)), (Some(3.0), None, Some(5.0)));
        let properties: Vec<String> = vectors.features[0].properties.iter().map(|(k, v)| format!("{k}={v}")).collect();
        assert_eq!(properties, ["flag=true", "height=12.5", "name=point"]);
        for text in ["2 features without geometry", "1 features that are curves", "1 features whose positions"] {
            assert!(said(&loaded).contains(text), "{text}: {}", said(&loaded));
        }
        assert_eq!(loaded.warnings.len(), 3);
    }
    // Geometries without a kind are of that of the layer.
    let plain = [feature("a", Some(geometry(0, &[], &SQUARE, &[], Vec::new())))];
    assert!(matches!(load(&file(2, 16, 4326, 1, &plain)).unwrap().value.features[0].geometry, Geometry::Lines(_)));
    let unstated = load(&file(2, 0, 0, 0, &plain)).unwrap().value;
    assert_eq!((unstated.crs.epsg(), unstated.crs_stated), (Some(4326), false));
}

#[test]
fn cut_and_damaged_files_are_read_up_to_there() {
    let line = |k: usize| geometry(2, &[], &[k as f64, 1.0, k as f64, 2.0], &[1.0, 2.0], Vec::new());
    let features: Vec<Vec<u8>> = (0..100).map(|k| feature(&format!("way {k}"), Some(line(k % 80)))).collect();
    let whole = file(2, 16, 4326, 100, &features);
    let start = whole.len() - features.concat().len();
    assert_eq!(load(&whole).unwrap().warnings, []);
    for k in 0..100 {
        let cut = whole.len() * k / 100;
        let left = cut.saturating_sub(start) / (features.concat().len() / 100);
        match load(&whole[..cut]) {
            Err(text) => assert!(left < 2 && (text.contains("get it again") || cut < 8), "{k} %: {text}"),
            Ok(loaded) => {
                assert!(loaded.value.features.len().abs_diff(left) < 3, "{k} %");
                assert!(said(&loaded).contains("of 100 features; what is whole before"), "{}", said(&loaded));
            }
        }
    }
    for seed in 0..3000usize {
        let mut damaged = whole.clone();
        for j in 0..=seed % 4 {
            let place = if seed % 2 == 0 { seed * 7919 + j * 104_729 } else { start + seed * 31 + j * 17 };
            let at = 8 + place % (damaged.len() - 8);
            damaged[at] = damaged[at].wrapping_mul(31).wrapping_add(101);
        }
        if let Ok(loaded) = load(&damaged) {
            assert!(loaded.value.features.iter().flat_map(|f| f.geometry.vertices()).all(|v| v.xy.is_finite()));
        }
    }
}

#[test]
fn files_that_claim_too_much_are_one_error() {
    let point = feature("a", Some(geometry(1, &[], &[1.0, 2.0], &[], Vec::new())));
    for (bytes, want) in [
        (file(1, 0, 4326, u64::MAX / 2, std::slice::from_ref(&point)), None),
        (file(1, 0, 2, 1, std::slice::from_ref(&point)), Some("is in a system that is not known")),
        (file(1, 0, 4326, 0, &[]), Some("no usable geometry")),
        (file(1, 0, 4326, 1, &[feature("a", Some(geometry(10, &[], &SQUARE, &[], Vec::new())))]), Some("1 curves")),
        (
            file(1, 0, 4326, 1, &[feature("a", Some(geometry(1, &[], &[1.0, 100.0], &[], Vec::new())))]),
            Some("no longitude"),
        ),
        (b"fgb\x03fgb\x00\xff\xff\xff\x7f".to_vec(), Some("cut off inside of its header")),
    ] {
        match (load(&bytes), want) {
            (Err(text), Some(want)) => assert!(text.contains(want), "{text}"),
            (Ok(loaded), None) => assert!(said(&loaded).contains("cut off after 1 of 9223372036854775807")),
            (other, want) => panic!("{want:?}: {:?}", other.map(|l| l.value.features.len())),
        }
    }
    // An index that no file can hold.
    let mut bytes = file(1, 0, 4326, 1 << 62, std::slice::from_ref(&point));
    let count = bytes.windows(8).position(|w| w == (1u64 << 62).to_le_bytes()).unwrap();
    bytes[count + 8] = 16;
    assert!(load(&bytes).unwrap_err().contains("more than a file can"));
    // Parts that repeat each other without end.
    let mut parts = geometry(7, &[], &[], &[], vec![geometry(1, &[], &[1.0, 2.0], &[], Vec::new())]);
    for _ in 0..12 {
        parts = geometry(7, &[], &[], &[], vec![parts.clone()]);
    }
    assert!(load(&file(7, 0, 4326, 1, &[feature("deep", Some(parts))])).is_ok());
}
