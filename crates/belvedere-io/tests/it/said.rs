//! Oddities that are said rather than passed over: exchanged positions, empty features, encodings of names; and axes that say nothing.

use crate::support_files::Folder;
use belvedere_core::{Warning, WarningKind};
use belvedere_io::{Limits, Loaded, VolumeFile, VolumeRequest, load_city, load_mesh, load_vectors, load_volume};
use belvedere_testkit::data;
use glam::{DVec2, DVec3};

fn tells(warnings: &[Warning], kind: WarningKind, words: &str) -> bool {
    warnings.iter().any(|w| w.kind() == kind && w.text().contains(words))
}

fn line(bbox: &str, positions: &str) -> String {
    format!(
        r#"{{"type":"FeatureCollection",{bbox}"features":[{{"type":"Feature","properties":{{}},"geometry":{{"type":"LineString","coordinates":{positions}}}}}]}}"#
    )
}

#[test]
fn a_geojson_with_latitude_first_is_exchanged_and_told() {
    let folder = Folder::new();
    let first = |text: &str| {
        let loaded = load_vectors(&folder.file("a.geojson", text.as_bytes())).expect("readable");
        let at = loaded.value.features[0].geometry.vertices().next().expect("a vertex").xy;
        (at, tells(&loaded.warnings, WarningKind::Assumed, "latitude before longitude"))
    };
    assert_eq!(first(&line("", "[[36.1,138.2],[36.2,138.3]]")), (DVec2::new(138.2, 36.1), true));
    let alps = "[[46.1,8.2],[46.2,8.3]]";
    assert_eq!(first(&line(r#""bbox":[8,46,9,47],"#, alps)), (DVec2::new(8.2, 46.1), true));
    assert_eq!(first(&line(r#""bbox":[46,8,47,9],"#, alps)), (DVec2::new(46.1, 8.2), false));
    assert_eq!(first(&line("", alps)), (DVec2::new(46.1, 8.2), false));
}

#[test]
fn a_city_whose_stated_extent_has_the_other_order_is_exchanged_and_told() {
    let folder = Folder::new();
    let city = |system: &str, extent: &str| {
        format!(
            r#"{{"type":"CityJSON","version":"1.1","transform":{{"scale":[1,1,1],"translate":[0,0,0]}},"metadata":{{"referenceSystem":"{system}"{extent}}},
            "CityObjects":{{"h":{{"type":"Building","geometry":[{{"type":"MultiSurface","lod":"1","boundaries":[[[0,1,2,3]],[[4,5,6,7]]]}}]}}}},
            "vertices":[[5000000,400000,0],[5000010,400000,0],[5000010,400020,0],[5000000,400020,0],[5000000,400000,9],[5000010,400000,9],[5000010,400020,9],[5000000,400020,9]]}}"#
        )
    };
    let first = |text: &str| {
        let path = folder.file("a.city.json", text.as_bytes());
        let Loaded { value, warnings, .. } = load_city(&path, None, &Limits::default()).expect("readable");
        (
            value.city.buildings[0].faces[0].rings[0][0].x,
            tells(&warnings, WarningKind::Assumed, "latitude before longitude"),
        )
    };
    let system = "https://www.opengis.net/def/crs/EPSG/0/25832";
    let extent = |e: &str| format!(r#","geographicalExtent":{e}"#);
    let (x, told) = first(&city(system, &extent("[400000,5000000,0,400020,5000010,9]")));
    assert!(told && x < 500_000.0, "{x}");
    let (x, told) = first(&city(system, &extent("[5000000,400000,0,5000010,400020,9]")));
    assert!(!told && x > 4_000_000.0, "{x}");
    assert!(!first(&city(system, "")).1);
}

#[test]
fn features_of_no_points_are_counted() {
    let text = r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[8,46]}},
        {"type":"Feature","properties":{},"geometry":{"type":"MultiPoint","coordinates":[]}},
        {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[]}},
        {"type":"Feature","properties":{},"geometry":null}]}"#;
    let loaded = load_vectors(&Folder::new().file("a.geojson", text.as_bytes())).expect("readable");
    assert_eq!(loaded.value.features.len(), 1);
    assert!(tells(&loaded.warnings, WarningKind::Ignored, "3 features without geometry were dropped"));
}

#[test]
fn strips_of_a_ply_are_all_of_its_triangles() {
    let Some(path) = data("cases/files/p06_tristrips.ply") else { return };
    assert_eq!(load_mesh(&path, &Limits::default()).expect("readable").value.triangles.len(), 722);
}

fn npy(shape: &str, count: usize) -> Vec<u8> {
    let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut out = b"\x93NUMPY\x01\0".to_vec();
    out.extend((header.len() as u16).to_le_bytes());
    out.extend(header.bytes());
    out.extend((0..count).map(|k| k as u8));
    out
}

#[test]
fn axes_of_one_value_are_no_axes_of_a_volume() {
    let folder = Folder::new();
    let load = |name: &str, bytes: &[u8]| -> Result<VolumeFile, String> {
        let path = folder.file(name, bytes);
        load_volume(&path, &VolumeRequest::default()).map(|v| v.value).map_err(|e| e.to_string())
    };
    for shape in ["(1, 2, 3, 4)", "(2, 3, 4, 1)", "(1, 2, 3, 4, 1)", "(2, 3, 1, 4)"] {
        assert_eq!(load("a.npy", &npy(shape, 24)).expect(shape).dims, [4, 3, 2], "{shape}");
    }
    assert_eq!(load("a.npy", &npy("(1, 3, 4)", 12)).expect("thin").dims, [4, 3, 1]);
    assert!(load("a.npy", &npy("(2, 3, 4, 5)", 120)).unwrap_err().contains("has 3 dimensions"));
    let nrrd = |fields: &str| {
        let head = format!("NRRD0004\ntype: uchar\nencoding: raw\n{fields}\n\n");
        [head.as_bytes(), &[7; 24]].concat()
    };
    for fields in [
        "dimension: 4\nsizes: 4 3 2 1\nspacings: 1 2 3 nan",
        "dimension: 4\nsizes: 1 4 3 2\nspacings: nan 1 2 3",
        "dimension: 4\nsizes: 1 4 3 2\nspace dimension: 3\nspace directions: none (1,0,0) (0,2,0) (0,0,3)",
        "dimension: 5\nsizes: 1 4 3 2 1\nspace dimension: 3\nspace directions: none (1,0,0) (0,2,0) (0,0,3) none",
    ] {
        let volume = load("a.nrrd", &nrrd(fields)).expect(fields);
        assert_eq!(volume.dims, [4, 3, 2], "{fields}");
        let steps = [volume.axes.x_axis, volume.axes.y_axis, volume.axes.z_axis].map(DVec3::length);
        assert_eq!(steps, [1.0, 2.0, 3.0], "{fields}");
    }
    assert!(load("a.nrrd", &nrrd("dimension: 4\nsizes: 2 2 3 2")).unwrap_err().contains("it has 4 dimensions"));
}

/// A table of one text in each of its rows.
fn dbf(rows: &[&[u8]]) -> Vec<u8> {
    let mut out = vec![3u8, 126, 1, 1];
    out.extend((rows.len() as u32).to_le_bytes());
    out.extend(65u16.to_le_bytes());
    out.extend(11u16.to_le_bytes());
    out.resize(32, 0);
    out.extend(b"NAME\0\0\0\0\0\0\0C\0\0\0\0\x0a\0");
    out.resize(64, 0);
    out.push(0x0d);
    for row in rows {
        out.push(b' ');
        out.extend(*row);
        out.extend(std::iter::repeat_n(b' ', 10 - row.len()));
    }
    out
}

#[test]
fn names_in_another_encoding_than_the_stated_one_are_told() {
    let folder = Folder::new();
    let point = |x: f64| [1i32.to_le_bytes().to_vec(), x.to_le_bytes().to_vec(), 46f64.to_le_bytes().to_vec()].concat();
    let mut shp = [9994i32.to_be_bytes().to_vec(), vec![0; 20], 78i32.to_be_bytes().to_vec()].concat();
    shp.extend([1000i32.to_le_bytes(), 1i32.to_le_bytes()].concat());
    shp.resize(100, 0);
    for (k, x) in [8.0, 9.0].into_iter().enumerate() {
        shp.extend([(k as i32 + 1).to_be_bytes(), 10i32.to_be_bytes()].concat());
        shp.extend(point(x));
    }
    let path = folder.file("a.shp", &shp);
    folder.file("a.dbf", &dbf(&[b"Z\xfcrich", b"Bern"]));
    let read = |page: &str| {
        folder.file("a.cpg", page.as_bytes());
        let loaded = load_vectors(&path).expect("readable");
        (loaded.value.features[0].name.clone(), tells(&loaded.warnings, WarningKind::Suspect, "1 texts of the table"))
    };
    assert_eq!(read("ISO-8859-1"), ("Zürich".into(), false));
    assert_eq!(read("UTF-8"), ("Zürich".into(), true));
    assert_eq!(read("850"), ("Zürich".into(), true));
}
