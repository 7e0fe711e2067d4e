//! Volumes of the data collection, made-up ones in every encoding, and broken files.

use crate::support_files::Folder;
use belvedere_io::{ByteOrder, Limits, Number, RawLayout, VolumeFile, VolumeRequest, load_volume};
use belvedere_scene::{Volume, VoxelValues};
use belvedere_testkit::{Random, data};
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use glam::{DMat3, DVec3};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

fn load(path: &Path) -> Result<VolumeFile, String> {
    load_volume(path, &VolumeRequest::default()).map(|l| l.value).map_err(|e| e.to_string())
}

#[test]
fn real_volumes_hold_what_a_script_reads() {
    // Dimensions, sum of the values, spacing; by a script that shares no code with the readers.
    for (name, dims, sum, spacing) in [
        ("engine_256x256x128_uint8.raw.gz", [256, 256, 128], 187_475_057, [1.0; 3]),
        ("engine.vti", [256, 256, 128], 187_475_057, [1.0; 3]),
        ("aneurism.vti", [256, 256, 256], 17_938_365, [1.0; 3]),
        ("LIDC2.vti", [256, 256, 133], 61_489_178, [1.40625, 1.40625, 2.5]),
    ] {
        let Some(path) = data(&format!("volumes/{name}")) else { continue };
        let file = load(&path).expect("it is read");
        let VoxelValues::U8(values) = &file.values else { panic!("{name}: {:?}", file.stored) };
        assert_eq!((file.dims, file.stored), (dims, Number::UInt8), "{name}");
        assert_eq!(values.iter().map(|v| i64::from(*v)).sum::<i64>(), sum, "{name}");
        assert_eq!(file.axes, DMat3::from_diagonal(DVec3::from_array(spacing)), "{name}");
        Volume::new(file.dims, file.axes, file.origin, file.values).expect("a volume");
    }
}

/// 3 x 4 x 5 values in a type, as bytes in an order.
fn bytes(number: Number, order: ByteOrder) -> Vec<u8> {
    let each = |v: i32| -> Vec<u8> {
        let le = match number {
            Number::Int8 => (v as i8).to_le_bytes().to_vec(),
            Number::UInt8 => (v as u8).to_le_bytes().to_vec(),
            Number::Int16 => (v as i16).to_le_bytes().to_vec(),
            Number::UInt16 => (v as u16).to_le_bytes().to_vec(),
            Number::Int32 => v.to_le_bytes().to_vec(),
            Number::UInt32 => (v as u32).to_le_bytes().to_vec(),
            Number::Int64 => i64::from(v).to_le_bytes().to_vec(),
            Number::UInt64 => (v as u64).to_le_bytes().to_vec(),
            Number::Float32 => (v as f32).to_le_bytes().to_vec(),
            _ => f64::from(v).to_le_bytes().to_vec(),
        };
        if order == ByteOrder::Big { le.into_iter().rev().collect() } else { le }
    };
    expected().flat_map(|v| each(v as i32)).collect()
}

/// The values of the made-up volumes: 7 to 125, so that every type can hold them.
fn expected() -> impl Iterator<Item = f32> {
    (0..60).map(|i| 7.0 + 2.0 * i as f32)
}

fn is_expected(file: &VolumeFile) {
    assert_eq!(file.dims, [3, 4, 5]);
    let found: Vec<f32> = (0..file.values.len()).map(|i| file.values.at(i)).collect();
    assert_eq!(found, expected().collect::<Vec<_>>(), "{:?}", file.stored);
}

const NUMBERS: [(&str, &str, Number); 10] = [
    ("signed char", "Int8", Number::Int8),
    ("uchar", "UInt8", Number::UInt8),
    ("short", "Int16", Number::Int16),
    ("unsigned short int", "UInt16", Number::UInt16),
    ("int", "Int32", Number::Int32),
    ("uint32_t", "UInt32", Number::UInt32),
    ("longlong", "Int64", Number::Int64),
    ("uint64", "UInt64", Number::UInt64),
    ("float", "Float32", Number::Float32),
    ("double", "Float64", Number::Float64),
];

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).expect("memory");
    encoder.finish().expect("memory")
}

fn text() -> String {
    expected().map(|v| format!("{v} ")).collect()
}

#[test]
fn nrrd_in_every_type_and_encoding() {
    let folder = Folder::new();
    for (name, _, number) in NUMBERS {
        for (order, endian) in [(ByteOrder::Little, "little"), (ByteOrder::Big, "big")] {
            let raw = bytes(number, order);
            for (encoding, data) in [("raw", raw.clone()), ("gzip", gzip(&raw)), ("ascii", text().into_bytes())] {
                let head = format!(
                    "NRRD0004\n# a comment\ntype: {name}\ndimension: 3\nsizes: 3 4 5\nspacings: 1 2 0.5\nendian: {endian}\nkey:=value\nencoding: {encoding}\n"
                );
                let whole = [head.as_bytes(), b"\n", &data].concat();
                let file = load(&folder.file("a.nrrd", &whole)).expect("it is read");
                is_expected(&file);
                assert_eq!(file.axes, DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5)));
                folder.file("data.bin", &data);
                let apart = format!("{head}data file: data.bin\n");
                is_expected(&load(&folder.file("b.nhdr", apart.as_bytes())).expect("it is read"));
            }
        }
    }
}

#[test]
fn nrrd_places_and_skips() {
    let folder = Folder::new();
    let head = "NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 3 4 5\nspace directions: (0,2,0) (-3,0,0) (0,0,1.5)\nspace origin: (10, -20, 5e1)\nencoding: raw\n";
    let raw = bytes(Number::UInt8, ByteOrder::Little);
    let made =
        |extra: &str, data: &[u8]| folder.file("c.nrrd", &[head.as_bytes(), extra.as_bytes(), b"\n", data].concat());
    let file = load(&made("", &raw)).expect("it is read");
    is_expected(&file);
    assert_eq!(file.origin, DVec3::new(10.0, -20.0, 50.0));
    assert_eq!(file.axes.x_axis, DVec3::new(0.0, 2.0, 0.0));
    assert_eq!(file.axes.y_axis, DVec3::new(-3.0, 0.0, 0.0));
    is_expected(&load(&made("byte skip: 7\n", &[b"1234567", &raw[..]].concat())).expect("skipped"));
    is_expected(&load(&made("byte skip: -1\n", &[b"1234567", &raw[..]].concat())).expect("the last bytes"));
    is_expected(&load(&made("line skip: 2\n", &[b"one\ntwo\n", &raw[..]].concat())).expect("lines skipped"));
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for part in bytes.chunks(3) {
        let n = part.iter().fold(0u32, |n, b| n << 8 | u32::from(*b)) << (8 * (3 - part.len()));
        for k in 0..4 {
            let digit = DIGITS[(n >> (18 - 6 * k) & 63) as usize];
            out.push(if k <= part.len() { digit as char } else { '=' });
        }
    }
    out
}

/// A length in the byte order and width of a file.
fn length(n: usize, wide: bool, order: ByteOrder) -> Vec<u8> {
    let le = if wide { (n as u64).to_le_bytes().to_vec() } else { (n as u32).to_le_bytes().to_vec() };
    if order == ByteOrder::Big { le.into_iter().rev().collect() } else { le }
}

/// Header and data of an array, compressed in blocks of 16 bytes or as it is.
fn stored(raw: &[u8], packed: bool, wide: bool, order: ByteOrder) -> [Vec<u8>; 2] {
    let len = |n: usize| length(n, wide, order);
    if !packed {
        return [len(raw.len()), raw.to_vec()];
    }
    let blocks = raw.chunks(16).map(|block| {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(block).expect("memory");
        encoder.finish().expect("memory")
    });
    let blocks: Vec<Vec<u8>> = blocks.collect();
    let mut head = [len(blocks.len()), len(16), len(raw.len() % 16)].concat();
    head.extend(blocks.iter().flat_map(|b| len(b.len())));
    [head, blocks.concat()]
}

fn vti(type_name: &str, attributes: &str, format: &str, inline: &str, appended: &[u8], extent: &str) -> Vec<u8> {
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" {attributes}>\n<ImageData WholeExtent=\"{extent}\" Origin=\"1 2 3\" Spacing=\"2 1 0.5\">\n<Piece Extent=\"{extent}\">\n<PointData>\n<DataArray type=\"Float32\" Name=\"flow\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3</DataArray>\n<DataArray type=\"{type_name}\" Name=\"density\" {format}>{inline}</DataArray>\n</PointData>\n<CellData></CellData></Piece></ImageData>\n"
    );
    [head.as_bytes(), appended, b"</VTKFile>\n"].concat()
}

#[test]
fn vtk_image_data_in_every_encoding() {
    let folder = Folder::new();
    let mut read = 0;
    for (_, name, number) in NUMBERS {
        for (order, order_name) in [(ByteOrder::Little, "LittleEndian"), (ByteOrder::Big, "BigEndian")] {
            for (wide, packed) in [(false, false), (true, false), (false, true), (true, true)] {
                let [head, data] = stored(&bytes(number, order), packed, wide, order);
                let header_type = if wide { "UInt64" } else { "UInt32" };
                let compressor = if packed { "compressor=\"vtkZLibDataCompressor\"" } else { "" };
                let attributes = format!("byte_order=\"{order_name}\" header_type=\"{header_type}\" {compressor}");
                let both = if packed { base64(&head) + &base64(&data) } else { base64(&[&head[..], &data].concat()) };
                let inline = format!("\n   {both}\n  ");
                let raw = [b"<AppendedData encoding=\"raw\">\n _junk".to_vec(), head.clone(), data.clone()].concat();
                let text = format!("<AppendedData encoding=\"base64\">\n _AAAA{both}\n</AppendedData>");
                for (format, inline, appended) in [
                    ("format=\"binary\"", inline.as_str(), &b""[..]),
                    ("format=\"ascii\"", &text_of(), b""),
                    ("format=\"appended\" offset=\"4\"", " ", &raw),
                    ("format=\"appended\" offset=\"4\"", "", text.as_bytes()),
                ] {
                    let whole = vti(name, &attributes, format, inline, appended, "4 6 0 3 -1 3");
                    let file =
                        load(&folder.file("d.vti", &whole)).unwrap_or_else(|e| panic!("{attributes} {format}: {e}"));
                    is_expected(&file);
                    assert_eq!((file.stored, file.array.as_deref()), (number, Some("density")));
                    assert_eq!(file.origin, DVec3::new(9.0, 2.0, 2.5));
                    read += 1;
                }
            }
        }
    }
    assert_eq!(read, 320);
}

fn text_of() -> String {
    format!("\n{}\n", text())
}

#[test]
fn arrays_are_chosen_by_name_and_mistakes_are_told() {
    let folder = Folder::new();
    let whole = vti("UInt8", "", "format=\"ascii\"", &text_of(), b"", "0 2 0 3 0 4");
    let path = folder.file("e.vti", &whole);
    let ask = |name: &str| {
        let request = VolumeRequest { array: Some(name.into()), ..VolumeRequest::default() };
        load_volume(&path, &request).map(|l| l.value.array).map_err(|e| e.to_string())
    };
    assert_eq!(ask("density"), Ok(Some("density".into())));
    assert!(ask("flow").unwrap_err().contains("3 components"));
    assert!(ask("heat").unwrap_err().contains("it has \"flow\", \"density\""));
    let directed =
        String::from_utf8(whole).expect("text").replace("Origin=", "Direction=\"0 -1 0 1 0 0 0 0 1\" Origin=");
    let file = load(&folder.file("f.vti", directed.as_bytes())).expect("it is read");
    assert_eq!(file.axes.x_axis, DVec3::new(0.0, 2.0, 0.0), "the first column of the direction");
}

#[test]
fn raw_samples_are_told_by_name_or_by_the_scene() {
    let folder = Folder::new();
    let raw = bytes(Number::UInt16, ByteOrder::Big);
    let path = folder.file("thing.raw", &raw);
    assert!(load(&path).unwrap_err().contains("give dims"));
    let layout = RawLayout {
        dims: Some([3, 4, 5]),
        number: Some(Number::UInt16),
        spacing: Some([1.0, 2.0, 3.0]),
        order: Some(ByteOrder::Big),
    };
    let request = VolumeRequest { raw: layout, ..VolumeRequest::default() };
    is_expected(&load_volume(&path, &request).expect("it is read").value);
    let named = folder.file("thing_3x4x5_uint16.raw.gz", &gzip(&bytes(Number::UInt16, ByteOrder::Little)));
    is_expected(&load(&named).expect("it is read"));
    let short = folder.file("thing_3x4x6_uint16.raw", &raw);
    assert!(load(&short).unwrap_err().contains("144 bytes"), "{:?}", load(&short));
}

#[test]
fn values_that_are_no_numbers_become_the_least_with_a_warning() {
    let folder = Folder::new();
    let values = [1.5f32, f32::NAN, -2.0, f32::INFINITY, 4.0, 5.0, 6.0, 7.0];
    let raw: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    let path = folder.file("n_2x2x2_float32.raw", &raw);
    let loaded = load_volume(&path, &VolumeRequest::default()).expect("it is read");
    assert_eq!(loaded.value.values, VoxelValues::F32(vec![1.5, -2.0, -2.0, -2.0, 4.0, 5.0, 6.0, 7.0]));
    assert!(loaded.warnings[0].text().contains("2 values that are no finite number"), "{:?}", loaded.warnings);
}

#[test]
fn what_is_not_supported_or_damaged_is_one_clear_error() {
    let folder = Folder::new();
    let head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 4 5\n";
    let z = "byte_order=\"LittleEndian\" compressor=\"vtkLZ4DataCompressor\"";
    let huge = "4611686018427387904 4611686018427387904 4611686018427387904";
    for (name, content, wanted) in [
        ("a.nrrd", format!("{head}encoding: bzip2\n\nBZh9"), "\"bzip2\" is not read; raw, gzip and ascii"),
        (
            "b.nrrd",
            "NRRD0004\ntype: float\ndimension: 4\nsizes: 3 2 2 2\nencoding: raw\nendian: little\n\n".into(),
            "4 dimensions",
        ),
        ("c.nrrd", format!("{head}encoding: raw\n\nshort"), "60 bytes, and has 5"),
        ("d.nrrd", format!("{head}encoding: gzip\n\nno gzip at all"), "gzip data cannot be read"),
        ("e.nrrd", format!("{head}encoding: ascii\n\n1 2 three {}", "1 ".repeat(60)), "value 3 is \"three\""),
        ("f.nrrd", format!("{head}encoding: raw\n"), "no end"),
        ("g.nrrd", "NRRD0004\ntype: block\ndimension: 3\nsizes: 3 4 5\nencoding: raw\n\n".into(), "\"block\""),
        ("h.nrrd", head.replace("3 4 5", huge) + "encoding: gzip\n\nxx", "declares"),
        ("i.nhdr", format!("{head}encoding: raw\ndata file: ../../secret\n"), "not a file below its own folder"),
        ("j.nhdr", format!("{head}encoding: raw\ndata file: LIST\na\nb\n\n"), "several files"),
        ("k.nrrd", String::new(), "no NRRD"),
        ("l.vti", "<VTKFile type=\"PolyData\"></VTKFile>".into(), "no VTK XML file of type ImageData"),
        (
            "m.vti",
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0\"/></VTKFile>".into(),
            "six whole numbers",
        ),
        ("n.vti", String::new(), "no VTK XML file of type ImageData"),
        ("o_9999999x9999999x9999999_uint8.raw.gz", "\u{1f}x".into(), "cut off"),
    ] {
        let error = load(&folder.file(name, content.as_bytes())).expect_err(name);
        assert!(error.contains(wanted) && error.lines().count() == 1, "{name}: {error}");
    }
    let packed = vti("UInt8", z, "format=\"binary\"", "AAAA", b"", "0 2 0 3 0 4");
    assert!(load(&folder.file("p.vti", &packed)).unwrap_err().contains("vtkLZ4DataCompressor"));
    // A block count that would take terabytes of sizes.
    let many = base64(
        &[
            length(1 << 40, true, ByteOrder::Little),
            length(0, true, ByteOrder::Little),
            length(60, true, ByteOrder::Little),
        ]
        .concat(),
    );
    let zlib = "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"";
    let many = vti("UInt8", zlib, "format=\"binary\"", &many, b"", "0 2 0 3 0 4");
    assert!(load(&folder.file("q.vti", &many)).unwrap_err().contains("blocks"));
}

#[test]
fn damaged_files_end_in_an_error_and_soon() {
    let folder = Folder::new();
    let raw = bytes(Number::Int16, ByteOrder::Little);
    let [head, data] = stored(&raw, true, true, ByteOrder::Little);
    let both = base64(&head) + &base64(&data);
    let zlib = "byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"";
    let appended = [b"<AppendedData encoding=\"raw\">_".to_vec(), head, data].concat();
    let files = [
        ("inline.vti", vti("Int16", zlib, "format=\"binary\"", &both, b"", "0 2 0 3 0 4")),
        ("appended.vti", vti("Int16", zlib, "format=\"appended\" offset=\"0\"", "", &appended, "0 2 0 3 0 4")),
        (
            "packed.nrrd",
            [
                &b"NRRD0004\ntype: short\ndimension: 3\nsizes: 3 4 5\nendian: little\nencoding: gzip\n\n"[..],
                &gzip(&raw),
            ]
            .concat(),
        ),
        ("named_3x4x5_int16.raw.gz", gzip(&raw)),
    ];
    let mut random = Random::new(11);
    let (mut refused, start) = (0, Instant::now());
    for (name, whole) in &files {
        for i in 0..300usize {
            let mut bytes = whole.clone();
            if i % 3 == 0 {
                bytes.truncate(i * whole.len() / 300);
            } else {
                for _ in 0..=i % 4 {
                    let at = (random.unit() * bytes.len() as f64) as usize;
                    bytes[at] = (random.unit() * 256.0) as u8;
                }
            }
            let limits = Limits { max_bytes: 1 << 24 };
            let request = VolumeRequest { limits, ..VolumeRequest::default() };
            if let Err(e) = load_volume(&folder.file(name, &bytes), &request) {
                assert_eq!(e.to_string().lines().count(), 1, "{name}: {e}");
                refused += 1;
            }
        }
    }
    assert!(refused > 400, "{refused}");
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}
