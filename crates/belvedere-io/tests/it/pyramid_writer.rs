//! Writes pyramids of tiles of heights as other programs do: folders, MBTiles and PMTiles.

use belvedere_io::png::{self, Channels};
use flate2::Compression;
use flate2::write::GzEncoder;
use image_webp::{ColorType, WebPEncoder};
use rusqlite::{Connection, MAIN_DB, params};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Half the side of the square of Web Mercator, metres.
pub(crate) const HALF_M: f64 = std::f64::consts::PI * 6_378_137.0;

/// Zoom, column, row from the north, and the bytes of a tile.
pub(crate) type Tile = (u8, u64, u64, Vec<u8>);

/// The colour of a height; `None` = void.
pub(crate) type Code = fn(Option<f64>) -> [u8; 4];

pub(crate) fn mapbox(height: Option<f64>) -> [u8; 4] {
    height.map_or([0; 4], |h| {
        let [_, r, g, b] = (((h + 10_000.0) * 10.0).round() as i32).to_be_bytes();
        [r, g, b, 255]
    })
}

pub(crate) fn terrarium(height: Option<f64>) -> [u8; 4] {
    height.map_or([0; 4], |h| {
        let [_, r, g, b] = (((h + 32_768.0) * 256.0).round() as u32).to_be_bytes();
        [r, g, b, 255]
    })
}

/// A tile as PNG.
///
/// * `height`: at x and y of Web Mercator, metres.
pub(crate) fn tile(
    [zoom, column, row]: [u64; 3],
    side: usize,
    code: Code,
    height: &dyn Fn(f64, f64) -> Option<f64>,
) -> Tile {
    let (zoom, pixels) = (zoom as u8, pixels([zoom, column, row], side, code, height));
    let mut bytes = Vec::new();
    png::encode(&mut bytes, side, side, Channels::Rgba, &pixels.concat(), &[]).unwrap();
    (zoom, column, row, bytes)
}

pub(crate) fn pixels(
    [zoom, column, row]: [u64; 3],
    side: usize,
    code: Code,
    height: &dyn Fn(f64, f64) -> Option<f64>,
) -> Vec<[u8; 4]> {
    let step = 2.0 * HALF_M / (side as f64 * (1u64 << zoom) as f64);
    let place = |i: usize| {
        let (c, r) = ((column as usize * side + i % side) as f64, (row as usize * side + i / side) as f64);
        code(height((c + 0.5) * step - HALF_M, HALF_M - (r + 0.5) * step))
    };
    (0..side * side).map(place).collect()
}

/// The bytes of a lossless WebP.
pub(crate) fn webp(side: usize, pixels: &[[u8; 4]]) -> Vec<u8> {
    let mut out = Vec::new();
    WebPEncoder::new(&mut out).encode(&pixels.concat(), side as u32, side as u32, ColorType::Rgba8).unwrap();
    out
}

/// Writes the tiles as files of a folder.
pub(crate) fn folder(root: &Path, ending: &str, tiles: &[Tile]) -> PathBuf {
    for (zoom, column, row, bytes) in tiles {
        let folder = root.join(format!("{zoom}/{column}"));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(format!("{row}.{ending}")), bytes).unwrap();
    }
    root.to_owned()
}

/// Writes MBTiles.
///
/// * `joined`: whether tiles stand in the tables `map` and `images` behind a view.
pub(crate) fn mbtiles(path: &Path, metadata: &[(&str, &str)], tiles: &[Tile], joined: bool) {
    let mut base = Connection::open_in_memory().unwrap();
    base.execute_batch("CREATE TABLE metadata (name text, value text);").unwrap();
    for (name, value) in metadata {
        base.execute("INSERT INTO metadata VALUES (?1, ?2)", params![name, value]).unwrap();
    }
    let place = "zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER";
    let tables = if joined {
        format!(
            "CREATE TABLE map ({place}, tile_id TEXT); CREATE TABLE images (tile_data BLOB, tile_id TEXT);
             CREATE VIEW tiles AS SELECT map.zoom_level AS zoom_level, map.tile_column AS tile_column, map.tile_row AS tile_row,
             images.tile_data AS tile_data FROM map JOIN images ON images.tile_id = map.tile_id;"
        )
    } else {
        format!("CREATE TABLE tiles ({place}, tile_data BLOB);")
    };
    base.execute_batch(&tables).unwrap();
    for (zoom, column, row, bytes) in tiles {
        let row = (1u64 << zoom) - 1 - row;
        if joined {
            let id = format!("{}-{}", bytes.len(), bytes.iter().fold(7u32, |n, b| n.wrapping_mul(31) + u32::from(*b)));
            base.execute("INSERT INTO map VALUES (?1, ?2, ?3, ?4)", params![zoom, *column as i64, row as i64, id])
                .unwrap();
            let sql = "INSERT INTO images SELECT ?1, ?2 WHERE NOT EXISTS (SELECT 1 FROM images WHERE tile_id = ?2)";
            base.execute(sql, params![bytes, id]).unwrap();
        } else {
            base.execute("INSERT INTO tiles VALUES (?1, ?2, ?3, ?4)", params![zoom, *column as i64, row as i64, bytes])
                .unwrap();
        }
    }
    fs::write(path, &*base.serialize(MAIN_DB).unwrap()).unwrap();
}

fn varint(out: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap()
}

/// The number of a tile along the curves of Hilbert of all zooms.
fn id_of(zoom: u8, mut x: u64, mut y: u64) -> u64 {
    let mut id = (0..zoom).map(|z| 1u64 << (2 * z)).sum();
    let side = 1u64 << zoom;
    for k in (0..zoom).rev() {
        let half = 1u64 << k;
        let (right, down) = (u64::from(x & half > 0), u64::from(y & half > 0));
        id += half * half * ((3 * right) ^ down);
        if down == 0 {
            if right == 1 {
                (x, y) = (side - 1 - x, side - 1 - y);
            }
            (x, y) = (y, x);
        }
    }
    id
}

/// The bytes of a PMTiles file.
///
/// * `per_leaf`: entries of a leaf directory; all stand in the root if it has room for them.
/// * `packed`: compression of directories and metadata, 1 none or 2 gzip.
pub(crate) fn pmtiles(json: &str, tiles: &[Tile], kind: u8, per_leaf: usize, packed: u8) -> Vec<u8> {
    let mut sorted: Vec<(u64, &Vec<u8>)> = tiles.iter().map(|(z, x, y, bytes)| (id_of(*z, *x, *y), bytes)).collect();
    sorted.sort();
    let (mut data, mut entries) = (Vec::new(), Vec::<[u64; 4]>::new());
    let mut last: Option<&Vec<u8>> = None;
    for (id, bytes) in sorted {
        match entries.last_mut() {
            Some([first, run, ..]) if last == Some(bytes) && *first + *run == id => *run += 1,
            _ => {
                entries.push([id, 1, bytes.len() as u64, data.len() as u64]);
                data.extend_from_slice(bytes);
            }
        }
        last = Some(bytes);
    }
    let pack = |bytes: Vec<u8>| if packed == 2 { gzip(&bytes) } else { bytes };
    let directory = |entries: &[[u64; 4]]| {
        let mut out = Vec::new();
        varint(&mut out, entries.len() as u64);
        let mut before = 0;
        for [id, ..] in entries {
            varint(&mut out, id - before);
            before = *id;
        }
        entries.iter().for_each(|[_, run, ..]| varint(&mut out, *run));
        entries.iter().for_each(|[_, _, length, _]| varint(&mut out, *length));
        for (k, [.., offset]) in entries.iter().enumerate() {
            let follows = k > 0 && entries[k - 1][2] + entries[k - 1][3] == *offset;
            varint(&mut out, if follows { 0 } else { offset + 1 });
        }
        pack(out)
    };
    let (mut leaves, mut root) = (Vec::new(), entries.clone());
    if entries.len() > per_leaf {
        root.clear();
        for part in entries.chunks(per_leaf) {
            let leaf = directory(part);
            root.push([part[0][0], 0, leaf.len() as u64, leaves.len() as u64]);
            leaves.extend(leaf);
        }
    }
    let (root, json) = (directory(&root), pack(json.as_bytes().to_vec()));
    let mut head = b"PMTiles\x03".to_vec();
    let mut at = 127;
    for part in [&root, &json, &leaves, &data] {
        head.extend((at as u64).to_le_bytes());
        head.extend((part.len() as u64).to_le_bytes());
        at += part.len();
    }
    head.extend([0; 25]);
    head.extend([packed, 1, kind]);
    head.resize(127, 0);
    [head, root, json, leaves, data].concat()
}
