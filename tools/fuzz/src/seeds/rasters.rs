//! Elevation models, pictures and grids of height changes.

use super::{CORNER, written};
use belvedere::io::geotiff::write_geotiff;
use belvedere::io::png::{Channels, encode};
use belvedere::io::{Affine, CrsKind, Photometric, Raster, RasterInfo, SampleType, Samples, SourceCrs};

/// Nodes along a side of the ground, and their distance in metres.
const NODES: usize = 12;
const STEP: f64 = 50.0;

fn height(i: usize) -> f64 {
    let (x, y) = ((i % NODES) as f64, (i / NODES) as f64);
    900.0 + 60.0 * (0.7 * x).sin() + 40.0 * (0.5 * y).cos()
}

fn ascii(number: impl Fn(f64) -> String, gap: &str, end: &str) -> Vec<u8> {
    let mut text = format!(
        "ncols {NODES}{end}nrows {NODES}{end}xllcorner {}{end}yllcorner {}{end}cellsize {STEP}{end}NODATA_value -9999{end}",
        CORNER.x, CORNER.y
    );
    for row in 0..NODES {
        let of = |c: usize| if (row, c) == (3, 4) { "-9999".into() } else { number(height(row * NODES + c)) };
        text += &(0..NODES).map(of).collect::<Vec<_>>().join(gap);
        text += end;
    }
    text.into_bytes()
}

/// The ground under other seeds.
pub fn ascii_ground() -> Vec<u8> {
    ascii(|h| format!("{h:.1}"), " ", "\n")
}

/// ESRI ASCII: usual, with decimal commas, in UTF-16.
pub fn ascii_grids() -> Vec<Vec<u8>> {
    let wide = String::from_utf8(ascii_ground()).expect("text").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let commas = ascii(|h| format!("{h:.2}").replace('.', ","), ";", "\r\n");
    vec![ascii_ground(), commas, ascii(|h| format!("{h:.3e}"), "\t", "\n"), [vec![0xff, 0xfe], wide].concat()]
}

/// Grids as lines of coordinates: with blanks, and with names and commas.
pub fn xyz() -> Vec<Vec<u8>> {
    let grid = |gap: &str, head: &str| {
        let line = |i: usize| {
            let (x, y) = (CORNER.x + STEP * (i % NODES) as f64, CORNER.y + STEP * (i / NODES) as f64);
            format!("{x:.1}{gap}{y:.1}{gap}{:.2}\n", height(i))
        };
        (head.to_owned() + &(0..NODES * NODES).map(line).collect::<String>()).into_bytes()
    };
    vec![grid(" ", ""), grid(",", "x,y,z\n")]
}

/// PMTiles of one tile of heights and a directory that is not packed.
pub fn pmtiles() -> Vec<Vec<u8>> {
    const SIDE: usize = 16;
    let pixel = |i: usize| {
        let [_, r, g, b] = (((height(i) + 32_768.0) * 256.0) as u32).to_be_bytes();
        [r, g, b, 255]
    };
    let pixels: Vec<u8> = (0..SIDE * SIDE).flat_map(pixel).collect();
    let mut tile = Vec::new();
    encode(&mut tile, SIDE, SIDE, Channels::Rgba, &pixels, &[]).expect("a picture");
    // One entry: its number, its run, its length in two bytes, and the offset 0.
    let directory = [1, 0, 1, tile.len() as u8 | 0x80, (tile.len() >> 7) as u8, 1];
    let metadata = b"{\"encoding\":\"terrarium\"}";
    let mut head = b"PMTiles\x03".to_vec();
    let mut at = 127u64;
    for length in [directory.len(), metadata.len(), 0, tile.len()] {
        head.extend(at.to_le_bytes());
        head.extend((length as u64).to_le_bytes());
        at += length as u64;
    }
    head.extend([0; 25]);
    head.extend([1, 1, 2]);
    head.resize(127, 0);
    vec![[head.as_slice(), &directory, metadata, &tile].concat()]
}

/// Points of LAS, of an old and a new format.
pub fn las() -> Vec<Vec<u8>> {
    let cloud = |format: u8| {
        let (head, record) = if format < 6 { (227usize, 20usize) } else { (375, 30) };
        let mut out = vec![0u8; head];
        let mut put = |at: usize, bytes: &[u8]| out[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, b"LASF");
        put(24, &[1, if format < 6 { 2 } else { 4 }]);
        put(94, &(head as u16).to_le_bytes());
        put(96, &(head as u32).to_le_bytes());
        put(104, &[format]);
        put(105, &(record as u16).to_le_bytes());
        let count = (NODES * NODES) as u32;
        put(107, &count.to_le_bytes());
        if format >= 6 {
            put(247, &u64::from(count).to_le_bytes());
        }
        for (i, offset) in [CORNER.x, CORNER.y, 0.0].into_iter().enumerate() {
            put(131 + 8 * i, &0.01f64.to_le_bytes());
            put(155 + 8 * i, &offset.to_le_bytes());
        }
        for i in 0..NODES * NODES {
            let at = [STEP * (i % NODES) as f64, STEP * (i / NODES) as f64, height(i)];
            let mut point: Vec<u8> = at.iter().flat_map(|v| ((100.0 * v) as i32).to_le_bytes()).collect();
            point.extend([0, 0, 9, 2, 2]);
            point.resize(record, 0);
            out.extend(point);
        }
        out
    };
    vec![cloud(0), cloud(6)]
}

/// Tiles of SRTM, of 13 and 16 samples along a side.
pub fn srtm() -> Vec<Vec<u8>> {
    let tile = |side: usize| (0..side * side).flat_map(|i| (height(i % 100) as i16).to_be_bytes()).collect();
    vec![tile(13), tile(16)]
}

fn info(kind: SampleType, bands: usize) -> RasterInfo {
    let mut info = RasterInfo::new("a.tif", NODES, NODES, kind);
    let north = CORNER.y + STEP * NODES as f64;
    info.pixel_to_model = Some(Affine([STEP, 0.0, CORNER.x, 0.0, -STEP, north]));
    (info.crs, info.crs_kind, info.bands) = (SourceCrs::Epsg(32632), CrsKind::Projected, bands);
    info
}

fn geotiff(info: RasterInfo, samples: Samples, mask: Option<Vec<bool>>) -> Vec<u8> {
    let raster = Raster { info, samples, mask };
    written("a.tif", |path| write_geotiff(path, &raster, false).expect("written"))
}

/// TIFF without compression, one strip, with an affine map and a code of the system; in both orders of bytes.
fn plain_tiff(is_big: bool) -> Vec<u8> {
    let two = |v: u16| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
    let four = |v: u32| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
    let eight = |v: f64| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
    let samples: Vec<u8> = (0..NODES * NODES).flat_map(|i| two(height(i) as u16)).collect();
    let scale = [STEP, STEP, 0.0].iter().flat_map(|v| eight(*v)).collect::<Vec<u8>>();
    let tie = [0.0, 0.0, 0.0, CORNER.x, CORNER.y + STEP * NODES as f64, 0.0];
    let tie: Vec<u8> = tie.iter().flat_map(|v| eight(*v)).collect();
    let keys = [1u16, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32632];
    let keys: Vec<u8> = keys.iter().flat_map(|v| two(*v)).collect();
    let places = 8 + 2 + 12 * 12 + 4;
    let at = |k: usize| (places + [0, scale.len(), scale.len() + tie.len()][k]) as u32;
    let first = (places + scale.len() + tie.len() + keys.len()) as u32;
    let side = NODES as u32;
    let entries = [
        (256, 4, 1, four(side)),
        (257, 4, 1, four(side)),
        (258, 3, 1, [two(16), two(0)].concat().try_into().expect("four")),
        (259, 3, 1, [two(1), two(0)].concat().try_into().expect("four")),
        (262, 3, 1, [two(1), two(0)].concat().try_into().expect("four")),
        (273, 4, 1, four(first)),
        (277, 3, 1, [two(1), two(0)].concat().try_into().expect("four")),
        (278, 4, 1, four(side)),
        (279, 4, 1, four(samples.len() as u32)),
        (33550, 12, 3, four(at(0))),
        (33922, 12, 6, four(at(1))),
        (34735, 3, 16, four(at(2))),
    ];
    let mut out = if is_big { b"MM".to_vec() } else { b"II".to_vec() };
    out.extend([two(42).to_vec(), four(8).to_vec(), two(entries.len() as u16).to_vec()].concat());
    for (tag, kind, count, value) in entries {
        out.extend([two(tag).to_vec(), two(kind).to_vec(), four(count).to_vec(), value.to_vec()].concat());
    }
    out.extend(four(0));
    [out, scale, tie, keys, samples].concat()
}

/// Elevation models of several types, compressed and not.
pub fn geotiffs() -> Vec<Vec<u8>> {
    let all = || 0..NODES * NODES;
    let mut gaps = info(SampleType::I16, 1);
    gaps.nodata = Some(-9999.0);
    let mask = all().map(|i| i % 17 != 3).collect();
    vec![
        geotiff(info(SampleType::F32, 1), Samples::F32(all().map(|i| height(i) as f32).collect()), None),
        geotiff(gaps, Samples::I16(all().map(|i| height(i) as i16).collect()), Some(mask)),
        geotiff(info(SampleType::F64, 1), Samples::F64(all().map(height).collect()), None),
        plain_tiff(false),
        plain_tiff(true),
    ]
}

/// Pictures with a place: colours, with alpha, and grey of 16 bits.
pub fn pictures() -> Vec<Vec<u8>> {
    let colors = |bands: usize| {
        let mut info = info(SampleType::U8, bands);
        info.photometric = Photometric::Rgb([0, 1, 2]);
        geotiff(info, Samples::U8((0..NODES * NODES * bands).map(|i| (i * 37) as u8).collect()), None)
    };
    let grey = Samples::U16((0..NODES * NODES).map(|i| (i * 400) as u16).collect());
    vec![colors(3), colors(4), geotiff(info(SampleType::U16, 1), grey, None)]
}

/// Grids of height changes.
pub fn deltas() -> Vec<Vec<u8>> {
    let lowered = (0..NODES * NODES).map(|i| -((i % 7) as f64)).collect();
    // As steep as any that is accepted.
    let jagged = (0..NODES * NODES).map(|i| if i % 2 == 0 { 99_000.0 } else { -99_000.0 }).collect();
    [lowered, jagged].map(|values| geotiff(info(SampleType::F64, 1), Samples::F64(values), None)).into()
}

/// A picture of colours.
pub fn png(width: usize, height: usize) -> Vec<u8> {
    let pixels: Vec<u8> = (0..width * height * 3).map(|i| (i * 29) as u8).collect();
    let mut out = Vec::new();
    encode(&mut out, width, height, Channels::Rgb, &pixels, &[("Title", "a seed")]).expect("memory");
    out
}

/// Pictures in colours, with alpha, in grey.
pub fn pngs() -> Vec<Vec<u8>> {
    let made = |channels: Channels| {
        let pixels: Vec<u8> = (0..12 * 9 * channels.count()).map(|i| (i * 29) as u8).collect();
        let mut out = Vec::new();
        encode(&mut out, 12, 9, channels, &pixels, &[]).expect("memory");
        out
    };
    vec![png(12, 9), made(Channels::Rgba), made(Channels::Gray)]
}
