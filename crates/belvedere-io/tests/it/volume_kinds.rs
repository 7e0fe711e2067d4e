//! MetaImage, NIfTI and legacy VTK files made by the tests: every type, byte order and placement, and broken ones.

use crate::support_files::Folder;
use belvedere_io::{Limits, Number, VolumeFile, VolumeRequest, load_volume};
use belvedere_scene::VoxelValues;
use belvedere_testkit::Random;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use glam::{DMat3, DQuat, DVec3};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

fn load(path: &Path) -> Result<VolumeFile, String> {
    let loaded = load_volume(path, &VolumeRequest::default()).map_err(|e| e.to_string())?;
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    Ok(loaded.value)
}

/// The values of the made-up volumes, which every type can hold.
fn expected() -> impl Iterator<Item = i32> {
    (0..60).map(|i| 7 + 2 * i)
}

fn is_expected(file: &VolumeFile, number: Number) {
    assert_eq!((file.dims, file.stored), ([3, 4, 5], number));
    let found: Vec<f32> = (0..file.values.len()).map(|i| file.values.at(i)).collect();
    assert_eq!(found, expected().map(|v| v as f32).collect::<Vec<_>>(), "{number:?}");
}

fn bytes(number: Number, big: bool) -> Vec<u8> {
    let each = |v: i32| -> Vec<u8> {
        let le = match number {
            Number::Int8 | Number::UInt8 => vec![v as u8],
            Number::Int16 | Number::UInt16 => (v as i16).to_le_bytes().to_vec(),
            Number::Int32 | Number::UInt32 => v.to_le_bytes().to_vec(),
            Number::Int64 | Number::UInt64 => i64::from(v).to_le_bytes().to_vec(),
            Number::Float32 => (v as f32).to_le_bytes().to_vec(),
            _ => f64::from(v).to_le_bytes().to_vec(),
        };
        if big { le.into_iter().rev().collect() } else { le }
    };
    expected().flat_map(each).collect()
}

fn text() -> String {
    expected().map(|v| format!("{v} ")).collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Types by their name in MetaImage, code in NIfTI, and name in legacy VTK.
const NUMBERS: [(&str, u16, &str, Number); 10] = [
    ("MET_CHAR", 256, "char", Number::Int8),
    ("MET_UCHAR", 2, "unsigned_char", Number::UInt8),
    ("MET_SHORT", 4, "short", Number::Int16),
    ("MET_USHORT", 512, "unsigned_short", Number::UInt16),
    ("MET_INT", 8, "int", Number::Int32),
    ("MET_UINT", 768, "unsigned_int", Number::UInt32),
    ("MET_LONG_LONG", 1024, "long", Number::Int64),
    ("MET_ULONG_LONG", 1280, "vtktypeuint64", Number::UInt64),
    ("MET_FLOAT", 16, "float", Number::Float32),
    ("MET_DOUBLE", 64, "double", Number::Float64),
];

fn meta(kind: &str, more: &str, data_file: &str) -> String {
    format!(
        "ObjectType = Image\nNDims = 3\n{more}DimSize = 3 4 5\nElementSpacing = 1 2 0.5\nElementType = {kind}\nElementDataFile = {data_file}\n"
    )
}

#[test]
fn meta_images_in_every_type_and_encoding() {
    let folder = Folder::new();
    for (kind, _, _, number) in NUMBERS {
        for big in [false, true] {
            let order = if big { "ElementByteOrderMSB = True\n" } else { "BinaryDataByteOrderMSB = False\n" };
            let raw = bytes(number, big);
            for (more, data) in [
                ("BinaryData = True\n", raw.clone()),
                ("CompressedData = True\nCompressedDataSize = 7\n", zlib(&raw)),
                ("CompressedData = True\n", gzip(&raw)),
                ("BinaryData = False\n", text().into_bytes()),
                ("HeaderSize = 5\n", [b"12345", &raw[..]].concat()),
                ("HeaderSize = -1\n", [b"1234567", &raw[..]].concat()),
            ] {
                let more = format!("{more}{order}");
                let whole = [meta(kind, &more, "LOCAL").as_bytes(), &data].concat();
                let file = load(&folder.file("a.mha", &whole)).unwrap();
                is_expected(&file, number);
                assert_eq!(file.axes, DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5)));
                folder.file("a.raw", &data);
                let apart = folder.file("b.mhd", meta(kind, &more, "a.raw").as_bytes());
                is_expected(&load(&apart).unwrap(), number);
                assert_eq!(load_volume(&apart, &VolumeRequest::default()).unwrap().files.len(), 2);
            }
        }
    }
}

/// A NIfTI header and the bytes up to the samples.
struct Nifti {
    bytes: Vec<u8>,
    wide: bool,
    big: bool,
}

impl Nifti {
    fn new(wide: bool, big: bool, code: u16) -> Self {
        let size = if wide { 544 } else { 352 };
        let mut out = Self { bytes: vec![0; size], wide, big };
        out.put(0, &(size as u32 - 4).to_le_bytes());
        let mark: &[u8] = if wide { b"n+2\0\r\n\x1a\n" } else { b"n+1\0" };
        let at = if wide { 4 } else { 344 };
        out.bytes[at..at + mark.len()].copy_from_slice(mark);
        out.put(if wide { 12 } else { 70 }, &code.to_le_bytes());
        [3i64, 3, 4, 5, 1, 1, 1, 1].iter().enumerate().for_each(|(i, n)| out.dim(i, *n));
        [1.0, 1.0, 2.0, 0.5].iter().enumerate().for_each(|(i, v)| out.real(if wide { 104 } else { 76 }, i, *v));
        if wide {
            out.put(168, &(size as i64).to_le_bytes())
        } else {
            out.real(108, 0, size as f64)
        }
        out
    }

    /// Little-endian bytes, in the order of the file.
    fn put(&mut self, at: usize, bytes: &[u8]) {
        let mut bytes = bytes.to_vec();
        if self.big {
            bytes.reverse();
        }
        self.bytes[at..at + bytes.len()].copy_from_slice(&bytes);
    }

    fn dim(&mut self, i: usize, n: i64) {
        if self.wide { self.put(16 + 8 * i, &n.to_le_bytes()) } else { self.put(40 + 2 * i, &(n as i16).to_le_bytes()) }
    }

    fn real(&mut self, at: usize, i: usize, v: f64) {
        if self.wide { self.put(at + 8 * i, &v.to_le_bytes()) } else { self.put(at + 4 * i, &(v as f32).to_le_bytes()) }
    }

    fn scaled(mut self, slope: f64, intercept: f64) -> Self {
        let at = if self.wide { 176 } else { 112 };
        self.real(at, 0, slope);
        self.real(at, 1, intercept);
        self
    }

    fn units(mut self, code: u32) -> Self {
        if self.wide {
            self.put(500, &code.to_le_bytes())
        } else {
            self.bytes[123] = code as u8
        }
        self
    }

    /// Says that a placement counts.
    fn form(&mut self, at: usize) {
        if self.wide { self.put(at, &1u32.to_le_bytes()) } else { self.put(at, &1u16.to_le_bytes()) }
    }

    /// Placed by rows.
    fn rows(mut self, axes: DMat3, origin: DVec3) -> Self {
        let (code, at) = if self.wide { (348, 400) } else { (254, 280) };
        self.form(code);
        for row in 0..3 {
            (0..3).for_each(|col| self.real(at, 4 * row + col, axes.col(col)[row]));
            self.real(at, 4 * row + 3, origin[row]);
        }
        self
    }

    /// Placed by a turn.
    fn turn(mut self, turn: DQuat, mirrored: bool, origin: DVec3) -> Self {
        let (code, at, pixdim) = if self.wide { (344, 352, 104) } else { (252, 256, 76) };
        self.form(code);
        self.real(pixdim, 0, if mirrored { -1.0 } else { 1.0 });
        let turn = if turn.w < 0.0 { -turn } else { turn };
        [turn.x, turn.y, turn.z, origin.x, origin.y, origin.z]
            .iter()
            .enumerate()
            .for_each(|(i, v)| self.real(at, i, *v));
        self
    }

    fn with(self, data: &[u8]) -> Vec<u8> {
        [self.bytes, data.to_vec()].concat()
    }
}

#[test]
fn nifti_in_every_type_version_and_byte_order() {
    let folder = Folder::new();
    for (_, code, _, number) in NUMBERS {
        for (wide, big) in [(false, false), (false, true), (true, false), (true, true)] {
            let header = || Nifti::new(wide, big, code).rows(DMat3::IDENTITY, DVec3::ZERO);
            let raw = bytes(number, big);
            let whole = header().with(&raw);
            is_expected(&load(&folder.file("a.nii", &whole)).unwrap(), number);
            is_expected(&load(&folder.file("b.nii.gz", &gzip(&whole))).unwrap(), number);
            // No scaling is stated by a slope of 0, or by 1 and 0.
            for same in [[0.0, 5.0], [1.0, 0.0]] {
                let whole = header().scaled(same[0], same[1]).with(&raw);
                is_expected(&load(&folder.file("c.nii", &whole)).unwrap(), number);
            }
            let file = load(&folder.file("d.nii", &header().scaled(0.5, -1000.0).with(&raw))).unwrap();
            let want: Vec<f32> = expected().map(|v| 0.5 * v as f32 - 1000.0).collect();
            assert_eq!(file.values, VoxelValues::F32(want));
        }
    }
}

#[test]
fn one_body_stands_at_one_place_in_every_format() {
    let folder = Folder::new();
    let raw = bytes(Number::UInt8, false);
    // A turned, mirrored lattice, in left, posterior, superior.
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.4, 2.0);
    let spacing = DVec3::new(1.0, 2.0, 0.5);
    let origin = DVec3::new(60.0, -120.0, 90.5);
    for mirrored in [false, true] {
        let axes = DMat3::from_quat(turn)
            * DMat3::from_diagonal(spacing * DVec3::new(1.0, 1.0, if mirrored { -1.0 } else { 1.0 }));
        let is_there = |name: &str, content: &[u8]| {
            let file = load(&folder.file(name, content)).unwrap();
            let off = (file.axes - axes).to_cols_array().iter().fold(0.0f64, |a, b| a.max(b.abs()));
            assert!(off < 1e-6 && file.origin.distance(origin) < 1e-4, "{name}: {} {}", file.axes, file.origin);
        };
        let v = |v: DVec3| format!("({},{},{})", v.x, v.y, v.z);
        let nrrd = format!(
            "NRRD0005\ntype: uint8\ndimension: 3\nspace: LPS\nsizes: 3 4 5\nspace directions: {} {} {}\nspace origin: {}\nencoding: raw\n\n",
            v(axes.x_axis),
            v(axes.y_axis),
            v(axes.z_axis),
            v(origin)
        );
        is_there("a.nrrd", &[nrrd.as_bytes(), &raw].concat());
        let unit: Vec<String> =
            [0, 1, 2].iter().flat_map(|i| axes.col(*i).normalize().to_array()).map(|v| v.to_string()).collect();
        let place = format!("TransformMatrix = {}\nOffset = {} {} {}\n", unit.join(" "), origin.x, origin.y, origin.z);
        is_there("a.mha", &[meta("MET_UCHAR", &place, "LOCAL").as_bytes(), &raw].concat());
        // NIfTI counts to the right and to the front.
        let flip = DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0));
        let (ras, at) = (flip * axes, flip * origin);
        let turned = DQuat::from_mat3(&(flip * DMat3::from_quat(turn)));
        for (wide, big) in [(false, false), (true, true)] {
            let header = || Nifti::new(wide, big, 2).units(2);
            is_there("a.nii", &header().rows(ras, at).with(&raw));
            is_there("a.nii", &header().turn(turned, mirrored, at).with(&raw));
            // Both: the rows count. In metres and micrometres they are the same body.
            is_there("a.nii", &header().turn(DQuat::IDENTITY, false, DVec3::ZERO).rows(ras, at).with(&raw));
            is_there("a.nii", &header().rows(ras * 1e-3, at * 1e-3).units(1).with(&raw));
            is_there("a.nii", &header().rows(ras * 1e3, at * 1e3).units(3).with(&raw));
            // Rows that span no space do not count.
            is_there("a.nii", &header().turn(turned, mirrored, at).rows(DMat3::ZERO, at).with(&raw));
        }
    }
    let nowhere = folder.file("b.nii", &Nifti::new(false, false, 2).with(&raw));
    let loaded = load_volume(&nowhere, &VolumeRequest::default()).unwrap();
    assert!(
        loaded.warnings.len() == 1 && loaded.warnings[0].text().contains("no orientation"),
        "{:?}",
        loaded.warnings
    );
    assert_eq!(loaded.value.axes, DMat3::from_diagonal(DVec3::new(-1.0, -2.0, 0.5)));
}

fn vtk(kind: &str, data: &[&[u8]]) -> Vec<u8> {
    let head = format!(
        "# vtk DataFile Version 3.0\nof a test\n{kind}\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 4 5\nORIGIN 1 2 3\nSPACING 1 2 0.5\n"
    );
    [head.as_bytes(), &data.concat()].concat()
}

#[test]
fn legacy_vtk_in_every_type_and_encoding() {
    let folder = Folder::new();
    for (_, _, kind, number) in NUMBERS {
        let table = "LOOKUP_TABLE default\n";
        let (binary, text) = (bytes(number, true), text().into_bytes());
        for (encoding, data) in [("BINARY", &binary), ("ASCII", &text)] {
            let scalars = format!("POINT_DATA 60\nSCALARS density {kind} 1\n{table}");
            let short = format!("POINT_DATA 60\nSCALARS density {kind}\n{table}");
            let field = format!("FIELD FieldData 1\ndensity 1 60 {kind}\n");
            let cells = format!("CELL_DATA 24\nPOINT_DATA 60\n{field}");
            for before in [scalars, short, format!("POINT_DATA 60\n{field}"), cells] {
                let whole = vtk(encoding, &[before.as_bytes(), data, b"\nMETADATA\nINFORMATION 0\n\n"]);
                let file = load(&folder.file("a.vtk", &whole)).unwrap();
                is_expected(&file, number);
                assert_eq!((file.origin, file.array.as_deref()), (DVec3::new(1.0, 2.0, 3.0), Some("density")));
                assert_eq!(file.axes, DMat3::from_diagonal(DVec3::new(1.0, 2.0, 0.5)));
            }
        }
    }
}

#[test]
fn arrays_of_legacy_vtk_are_chosen_by_name() {
    let folder = Folder::new();
    let floats = |n: usize| (0..n).flat_map(|i| (i as f32).to_be_bytes()).collect::<Vec<u8>>();
    let colors = vec![9u8; 60 * 3];
    let whole = vtk(
        "BINARY",
        &[
            b"FIELD FieldData 1\nTIME 1 1 float\n",
            &floats(1),
            b"\nPOINT_DATA 60\nVECTORS flow float\n",
            &floats(180),
            b"\nCOLOR_SCALARS paint 3\n",
            &colors,
            b"\nLOOKUP_TABLE mine 2\n",
            &[1, 2, 3, 4, 5, 6, 7, 8],
            b"\nSCALARS a%20b unsigned_char 1\nLOOKUP_TABLE mine\n",
            &bytes(Number::UInt8, true),
            b"\nCELL_DATA 24\nSCALARS of_cells float\nLOOKUP_TABLE default\n",
            &floats(24),
        ],
    );
    let path = folder.file("a.vtk", &whole);
    let by_name = |name: Option<&str>| {
        let request = VolumeRequest { array: name.map(str::to_owned), ..VolumeRequest::default() };
        load_volume(&path, &request).map(|l| l.value).map_err(|e| e.to_string())
    };
    is_expected(&by_name(None).unwrap(), Number::UInt8);
    is_expected(&by_name(Some("a b")).unwrap(), Number::UInt8);
    let cells = by_name(Some("of_cells")).unwrap();
    assert_eq!((cells.dims, cells.origin), ([2, 3, 4], DVec3::new(1.5, 3.0, 3.25)));
    assert!(by_name(Some("flow")).unwrap_err().contains("3 components"));
    assert!(by_name(Some("heat")).unwrap_err().contains("\"flow\", \"a b\", \"of_cells\""));
}

#[test]
fn what_is_not_read_is_said_with_what_to_do() {
    let folder = Folder::new();
    let raw = bytes(Number::UInt8, false);
    let with = |head: String| [head.into_bytes(), raw.clone()].concat();
    let nifti = |change: &dyn Fn(&mut Nifti)| {
        let mut header = Nifti::new(false, false, 2);
        change(&mut header);
        header.with(&raw)
    };
    let huge = "4611686018427387904 4611686018427387904 4611686018427387904";
    for (name, content, wanted) in [
        ("a.mha", with(meta("MET_UCHAR_ARRAY", "", "LOCAL")), "MET_UCHAR_ARRAY"),
        ("a.mha", with(meta("MET_UCHAR", "ElementNumberOfChannels = 3\n", "LOCAL")), "3 values in each voxel"),
        ("a.mha", with(meta("MET_UCHAR", "", "LOCAL").replace("3 4 5", "3 4 5 6")), "no list of 3 whole numbers"),
        ("a.mha", with(meta("MET_UCHAR", "", "LOCAL").replace("3 4 5", huge)), "declares"),
        ("a.mha", with(meta("MET_UCHAR", "Offset = 1 2 nan\n", "LOCAL")), "3 finite numbers"),
        ("a.mha", with(meta("MET_SHORT", "", "LOCAL")), "120 bytes, and has 60"),
        ("a.mha", with(meta("MET_UCHAR", "CompressedData = True\n", "LOCAL")), "zlib data cannot be read"),
        ("a.mha", b"ObjectType = Image\nNDims = 3\n".to_vec(), "no field ElementDataFile"),
        ("a.mhd", meta("MET_UCHAR", "", "../../secret").into_bytes(), "not a file below its own folder"),
        ("a.mhd", meta("MET_UCHAR", "", "slice%03d.raw 1 9 1").into_bytes(), "several files"),
        ("a.nii", raw.clone(), "no NIfTI file"),
        ("a.nii", nifti(&|h| h.bytes[345] = b'i'), "write both into one .nii"),
        ("a.nii", nifti(&|h| h.put(70, &128u16.to_le_bytes())), "colours"),
        ("a.nii", nifti(&|h| [(0, 4), (4, 8)].iter().for_each(|(i, n)| h.dim(*i, *n))), "3 x 4 x 5 x 8"),
        ("a.nii", nifti(&|h| h.dim(2, -4)), "3 x -4 x 5"),
        ("a.nii", nifti(&|h| h.dim(3, 500)), "6000 bytes, and has 60"),
        ("a.nii", nifti(&|h| h.real(108, 0, 1e9)), "begin at byte 1000000000"),
        ("a.vtk", b"# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\n".to_vec(), "POLYDATA"),
        ("a.vtk", vtk("ASCII", &[b"POINT_DATA 60\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3"]), "cut off"),
        ("a.vtk", vtk("BINARY", &[b"POINT_DATA 60\nSCALARS a bit\nLOOKUP_TABLE default\n12345678"]), "not read"),
        (
            "a.vtk",
            vtk("ASCII", &[b"POINT_DATA 7\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7"]),
            "60 values and has 13 bytes",
        ),
        ("a.vtk", vtk("ASCII", &[b"POINT_DATA 60\nNONSENSE"]), "\"NONSENSE\""),
        ("a.vtk", vtk("ASCII", &[b"POINT_DATA 60\n"]), "no values"),
        ("a.vtk", vtk("EBCDIC", &[]), "ASCII or BINARY"),
    ] {
        let error = load(&folder.file(name, &content)).expect_err(wanted);
        assert!(error.contains(wanted) && error.lines().count() == 1 && error.len() <= 500, "{wanted}: {error}");
    }
}

#[test]
fn damaged_files_end_in_an_error_and_soon() {
    let folder = Folder::new();
    let raw = bytes(Number::Int16, true);
    let scalars = b"POINT_DATA 60\nSCALARS density short 1\nLOOKUP_TABLE default\n";
    let files = [
        ("a.mha", [meta("MET_SHORT", "CompressedData = True\n", "LOCAL").into_bytes(), zlib(&raw)].concat()),
        ("b.mha", [meta("MET_SHORT", "ElementByteOrderMSB = True\n", "LOCAL").into_bytes(), raw.clone()].concat()),
        ("a.nii", Nifti::new(false, true, 4).turn(DQuat::IDENTITY, true, DVec3::ONE).with(&raw)),
        ("b.nii.gz", gzip(&Nifti::new(true, false, 4).rows(DMat3::IDENTITY, DVec3::ONE).with(&raw))),
        ("a.vtk", vtk("BINARY", &[scalars, &raw])),
        ("b.vtk", vtk("ASCII", &[scalars, text().as_bytes()])),
    ];
    let mut random = Random::new(17);
    let (mut refused, start) = (0, Instant::now());
    for (name, whole) in &files {
        for i in 0..400usize {
            let mut bytes = whole.clone();
            if i % 4 == 0 {
                bytes.truncate(i * whole.len() / 400);
            } else {
                for _ in 0..=i % 4 {
                    let at = (random.unit() * bytes.len().min(600) as f64) as usize;
                    bytes[at] = (random.unit() * 256.0) as u8;
                }
            }
            let request = VolumeRequest { limits: Limits { max_bytes: 1 << 24 }, ..VolumeRequest::default() };
            match load_volume(&folder.file(name, &bytes), &request) {
                Ok(loaded) => {
                    let file = loaded.value;
                    assert_eq!(file.values.len(), file.dims.iter().product::<usize>(), "{name} {i}");
                    let finite = (0..file.values.len()).all(|k| file.values.at(k).is_finite());
                    assert!(finite && file.axes.is_finite(), "{name} {i}");
                }
                Err(e) => {
                    let text = e.to_string();
                    assert!(text.lines().count() == 1 && text.len() <= 500, "{name} {i}: {text}");
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > 700 && start.elapsed().as_secs() < 60, "{refused} in {:?}", start.elapsed());
}
