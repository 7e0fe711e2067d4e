//! Arrays in memory: drawn as the files are that they are written as, hashed, recorded, and missed in words.

use belvedere::core::DVec3;
use belvedere::io::arrays::{Content, HeightGrid, SharedBytes, Triangles};
use belvedere::io::molecule::{AtomColumns, AtomTable};
use belvedere::io::vector::{FeatureArray, FeatureText, Shape};
use belvedere::io::volume::Voxels;
use belvedere::io::{Affine, Arrays, Number, sha256};
use belvedere::{BelvedereError, OpenOptions, Picture, PictureOptions, Session, output};
use std::path::Path;

fn bytes<const N: usize>(numbers: impl IntoIterator<Item = [u8; N]>) -> SharedBytes {
    numbers.into_iter().flatten().collect::<Vec<u8>>().into()
}

/// Hills of `columns` x `rows` samples 30 m apart in UTM 31, with a hole and heights of all 24 bits.
fn hills(columns: usize, rows: usize) -> HeightGrid {
    let height = |i: usize| {
        let (x, y) = ((i % columns) as f64, (i / columns) as f64);
        let hole = (30.0..34.0).contains(&x) && (20.0..24.0).contains(&y);
        if hole { f32::NAN } else { (300.1 + 60.3 * (x / 9.0).sin() * (y / 7.0).cos() + 0.1 * y) as f32 }
    };
    let samples = bytes((0..columns * rows).map(|i| height(i).to_le_bytes()));
    let transform = Affine([30.0, 0.0, 400_000.0, 0.0, -30.0, 4_700_000.0]);
    HeightGrid::new([columns, rows], transform, Some(32631), samples).expect("a grid")
}

fn ball() -> Voxels {
    let value = |i: usize| {
        let at = [i % 32, i / 32 % 28, i / 896].map(|v| v as f64);
        let off = DVec3::from_array(at) - DVec3::new(15.5, 13.5, 11.5);
        // One value is no number.
        if i == 77 { f64::NAN } else { 100.3 * (1.0 - off.length() / 12.0).max(0.0) }
    };
    let values = bytes((0..32 * 28 * 24).map(|i| value(i).to_le_bytes()));
    let (spacing, origin) = (DVec3::new(1.0, 1.1, 0.9), DVec3::new(-3.3, 0.1, 2.0));
    Voxels::new([32, 28, 24], Number::Float64, spacing, origin, values).expect("voxels")
}

fn cube() -> Triangles {
    let corner = |i: usize| [i >> 2 & 1, i >> 1 & 1, i & 1].map(|v| (v as f64 * 100.1).to_le_bytes());
    let faces: [[u32; 3]; 4] = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]];
    let colors = (0..8).map(|i| [220, 20 * i, 255 - 30 * i]);
    Triangles::new(
        bytes((0..8).flat_map(corner)),
        bytes(faces.as_flattened().iter().map(|v| v.to_le_bytes())),
        Some(bytes(colors)),
    )
    .expect("triangles")
}

fn atoms() -> AtomTable {
    let places = [[0.0, 0.0, 0.0], [1.5, 0.1, 0.0], [2.2, 1.3, 1.0 / 3.0], [9.0, 9.0, 9.0]];
    let words = |words: [&str; 4]| words.map(str::to_owned).to_vec();
    let columns = AtomColumns {
        elements: words(["C", "N", "O", "Fe"]),
        names: words(["CA", "N", "O", "FE"]),
        residues: words(["ALA", "ALA", "ALA", "HEM"]),
        chains: words(["A", "A", "A", "B"]),
        numbers: vec![1, 1, 1, -7],
    };
    AtomTable::new(columns, bytes(places.as_flattened().iter().map(|v: &f64| v.to_le_bytes()))).expect("atoms")
}

fn lines() -> FeatureArray {
    let positions =
        [[400_300.5, 4_699_500.0], [401_900.0, 4_698_700.25], [400_900.0, 4_699_900.0], [400_900.1, 4_699_000.0]];
    let positions = bytes(positions.as_flattened().iter().map(|v: &f64| v.to_le_bytes()));
    FeatureArray::new(Shape::Line, vec!["path".into(), String::new()], vec![2, 2], Some(32631), positions)
        .expect("lines")
}

fn lake() -> FeatureText {
    let text = r#"{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32631"}}, "features": [
        {"type": "Feature", "properties": {"natural": "water"}, "geometry": {"type": "Polygon", "coordinates":
        [[[400300.5, 4698900], [401900, 4698700.25], [401000, 4699500], [400300.5, 4698900]]]}}]}"#;
    FeatureText::new(text.to_owned())
}

fn arrays() -> Arrays {
    let mut arrays = Arrays::default();
    let contents = [
        ("ground", Content::Heights(hills(80, 60))),
        ("ball", Content::Voxels(ball())),
        ("cube", Content::Triangles(cube())),
        ("atoms", Content::Atoms(atoms())),
        ("path", Content::Features(lines())),
        ("lake", Content::Collection(lake())),
    ];
    contents.into_iter().for_each(|(name, content)| arrays.add(name, content).expect("added"));
    arrays
}

const GROUND: &str = "
camera = { eye = [401200.0, 4696500.0, 1200.0], look_at = [401200.0, 4699000.0, 300.0], image = [96, 64], near = 1.0 }
[[layer]]
kind = \"terrain\"
id = \"ground\"
source = \"array:ground\"
[[layer]]
kind = \"line\"
id = \"path\"
source = \"array:path\"
must_see = true
[[layer]]
kind = \"area\"
id = \"lake\"
source = \"array:lake\"
";

fn model(kind: &str, eye: [f64; 3], at: [f64; 3]) -> String {
    let (name, unit, more) = match kind {
        "mesh" => ("cube", "metre", ""),
        "molecule" => ("atoms", "angstrom", ""),
        _ => ("ball", "voxel", "transfer = \"solid\"\n"),
    };
    format!(
        "crs = \"local\"\nunit = \"{unit}\"\ncamera = {{ eye = {eye:?}, look_at = {at:?}, image = [96, 64], near = 0.1 }}\n[[layer]]\nkind = \"{kind}\"\nid = \"{name}\"\n\
         source = \"array:{name}\"\n{more}"
    )
}

fn open(text: &str, arrays: Arrays) -> Result<Session, BelvedereError> {
    let options = OpenOptions { arrays, ..OpenOptions::default() };
    Session::from_text(Path::new("scene.toml"), &format!("format = 1\n{text}"), &options)
}

fn drawn(session: &Session) -> Picture {
    session.render(&PictureOptions::default()).expect("drawn")
}

#[test]
fn arrays_are_drawn_as_the_files_that_they_are_written_as() {
    let (eye, at) = ([-300.0, -250.0, 260.0], [50.0, 50.0, 50.0]);
    let scenes = [
        (GROUND.to_owned(), 3, &["ground.tif", "lake.geojson", "path.geojson"][..]),
        (model("mesh", eye, at), 1, &["cube.ply"]),
        (model("volume", [-60.0, -50.0, 40.0], [14.0, 14.0, 12.0]), 1, &["ball.nrrd"]),
        (model("molecule", [-8.0, -9.0, 5.0], [1.0, 0.5, 0.2]), 1, &["atoms.cif"]),
    ];
    for (text, layers, files) in scenes {
        let folder = tempfile::tempdir().expect("folder");
        let session = open(&text, arrays()).expect("opened");
        let here = drawn(&session);
        for layer in 1..=layers {
            assert!(layer > 1 || here.frame.id.contains(&layer), "layer {layer} of {files:?} is drawn");
        }
        let path = folder.path().join("scene.toml");
        let (document, written) = session.resolved_with_arrays(&path, false).expect("written").expect("a document");
        let names: Vec<_> = written.iter().filter_map(|p| p.file_name()?.to_str()).collect();
        let mut sorted = names.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, files);
        output::write_text(&path, &output::document_toml(&document).expect("text"), false).expect("written");
        let there = Session::open(&path, &OpenOptions::default()).expect("opened again");
        let again = drawn(&there);
        assert!(here.frame.color == again.frame.color && here.frame.depth == again.frame.depth, "{files:?}");
        // What is said differs by the names of the sources alone.
        let kinds = |s: &Session| s.warnings().iter().map(|w| (w.kind(), w.figures().clone())).collect::<Vec<_>>();
        assert_eq!(kinds(&session), kinds(&there), "{files:?}");
        assert!(session.resolved_with_arrays(&path, false).is_err(), "files are not replaced");
    }
}

#[test]
fn arrays_larger_than_a_scene_takes_are_thinned_as_files_are() {
    let mut large = Arrays::default();
    large.add("ground", Content::Heights(hills(4097, 4000))).expect("added");
    let text = GROUND.split("[[layer]]\nkind = \"line\"").next().expect("the ground");
    let session = open(text, large).expect("opened");
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("scene.toml");
    let (document, _) = session.resolved_with_arrays(&path, false).expect("written").expect("a document");
    output::write_text(&path, &output::document_toml(&document).expect("text"), false).expect("written");
    let there = Session::open(&path, &OpenOptions::default()).expect("opened again");
    let ground = |s: &Session| s.scene().terrain().expect("ground").clone();
    assert!(ground(&session) == ground(&there) && ground(&session).cols() == 2049);
}

#[test]
fn the_record_of_an_array_is_the_hash_of_a_line_of_json_and_its_bytes() {
    let session = open(GROUND, arrays()).expect("opened");
    let names = session.inputs().into_iter().map(|input| input.path.display().to_string());
    assert_eq!(
        names.filter(|name| name.starts_with("array:")).collect::<Vec<_>>(),
        ["array:ground", "array:path", "array:lake"]
    );
    let mut layout =
        br#"{"array":"voxels","dims":[2,2,2],"origin":[0.0,0.0,1.5],"spacing":[1.0,1.0,2.0],"type":"uint8"}"#.to_vec();
    layout.extend(b"\n\x01\x02\x03\x04\x05\x06\x07\x08");
    let values = (1..=8).collect::<Vec<u8>>().into();
    let (spacing, origin) = (DVec3::new(1.0, 1.0, 2.0), DVec3::new(0.0, 0.0, 1.5));
    let mut arrays = Arrays::default();
    let voxels = Voxels::new([2, 2, 2], Number::UInt8, spacing, origin, values).expect("voxels");
    arrays.add("v", Content::Voxels(voxels)).expect("added");
    let record = arrays.find(Path::new("array:v")).expect("there").expect("an array").record();
    assert_eq!((record.sha256.as_str(), record.bytes), (sha256(&layout).as_str(), layout.len() as u64));
    let picture = drawn(&session);
    let recorded = |name: &str| picture.sidecar.inputs.iter().any(|input| input.path == Path::new(name));
    assert!(recorded("array:ground") && recorded("array:path"), "{:?}", picture.sidecar.inputs);
    assert!(session.input_paths().iter().all(|path| !path.starts_with("array:ground")), "arrays are no files");
}

#[test]
fn missing_arrays_and_arrays_of_other_kinds_are_told_in_a_line() {
    let ball = model("volume", [0.0; 3], [1.0; 3]);
    for (text, arrays, words) in [
        (GROUND.to_owned(), Arrays::default(), "array:ground: there is no such array, none is in memory"),
        (
            GROUND.replace("array:ground", "array:grund"),
            arrays(),
            "those in memory are atoms, ball, cube, ground, lake, path",
        ),
        (ball.replace("array:ball", "array:cube"), arrays(), "array:cube: it holds triangles, and voxels are needed"),
        (
            GROUND.replace("\"line\"", "\"city\"").replace("must_see = true", ""),
            arrays(),
            "names an array in memory where a file is needed",
        ),
    ] {
        let error = open(&text, arrays).expect_err(words).to_string();
        assert!(error.contains(words) && !error.contains('\n') && error.len() < 500, "{error}");
    }
}

#[test]
fn contents_that_do_not_suit_are_refused() {
    let mut arrays = arrays();
    for name in ["", "a b", "a/b", "..", "ground"] {
        assert!(arrays.add(name, Content::Features(lines())).is_err(), "{name:?}");
    }
    let zeros = |n: usize| SharedBytes::from(vec![0u8; n]);
    let flat = Affine([1.0, 2.0, 0.0, 2.0, 4.0, 0.0]);
    let upright = Affine([1.0, 0.0, 0.0, 0.0, -1.0, 0.0]);
    assert!(HeightGrid::new([2, 2], upright, None, zeros(12)).is_err());
    assert!(HeightGrid::new([2, 2], flat, None, zeros(16)).is_err());
    assert!(HeightGrid::new([2, 2], upright, None, zeros(16)).is_ok());
    assert!(Voxels::new([2, 2, 1], Number::UInt8, DVec3::ONE, DVec3::ZERO, zeros(4)).is_err());
    assert!(Voxels::new([2, 2, 2], Number::UInt8, DVec3::ZERO, DVec3::ZERO, zeros(8)).is_err());
    let face = |v: u32| bytes([0, 1, v].map(u32::to_le_bytes));
    assert!(Triangles::new(zeros(72), face(3), None).is_err() && Triangles::new(zeros(72), face(2), None).is_ok());
    assert!(Triangles::new(zeros(72), face(2), Some(zeros(8))).is_err());
    let column = |word: &str| AtomColumns {
        elements: vec![word.into()],
        names: vec!["C".into()],
        residues: vec!["UNK".into()],
        chains: vec!["A".into()],
        numbers: vec![1],
    };
    for (word, fits) in [("C", true), ("", false), ("a b", false), ("#", false), ("?", false)] {
        assert_eq!(AtomTable::new(column(word), zeros(24)).is_ok(), fits, "{word:?}");
    }
    assert!(AtomTable::new(column("C"), zeros(48)).is_err());
    let of = |shape, counts: &[usize], n| {
        FeatureArray::new(shape, counts.iter().map(|_| String::new()).collect(), counts.to_vec(), None, zeros(n))
    };
    assert!(of(Shape::Point, &[1, 1], 32).is_ok() && of(Shape::Line, &[2], 32).is_ok());
    assert!(of(Shape::Point, &[2], 32).is_err() && of(Shape::Line, &[usize::MAX, 3], 32).is_err());
}
