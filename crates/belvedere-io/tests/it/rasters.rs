//! SRTM tiles and ESRI ASCII grids.

use crate::atomic::Folder;
use belvedere_io::{Limits, SourceCrs, esri_ascii, hgt};
use belvedere_testkit::data;
use std::fs;

#[test]
fn hgt_tiles_stand_where_their_name_says() {
    let Some(path) = data("andorra/N42E001.hgt") else { return };
    let raster = hgt::read(&path, &Limits::default()).unwrap().value;
    assert_eq!((raster.info.width, raster.info.height), (1201, 1201));
    let m = raster.info.pixel_to_model.unwrap();
    for (c, r, x, y) in [(0.0, 0.0, 1.0, 43.0), (1200.0, 1200.0, 2.0, 42.0), (600.0, 300.0, 1.5, 42.75)] {
        let [lon, lat] = m.apply(c + 0.5, r + 0.5);
        assert!((lon - x).abs() < 1e-12 && (lat - y).abs() < 1e-12, "{lon}, {lat}");
    }
    let voids = (0..1201 * 1201).filter(|i| raster.sample_f64(0, i % 1201, i / 1201).is_none()).count();
    assert_eq!(voids, 7652);
}

#[test]
fn broken_tiles_are_one_sentence() {
    let folder = Folder::new("hgt-broken");
    let cases: [(&str, Vec<u8>, &str); 4] = [
        ("N42E001.hgt", vec![0; 2 * 101 * 101 - 1], "truncated"),
        ("N42E001.hgt", Vec::new(), "truncated"),
        ("mountain.hgt", vec![0; 2 * 101 * 101], "south-west corner"),
        ("N99E001.hgt", vec![0; 2 * 101 * 101], "south-west corner"),
    ];
    for (name, bytes, words) in cases {
        let path = folder.0.join(name);
        fs::write(&path, bytes).unwrap();
        let error = hgt::read(&path, &Limits::default()).unwrap_err().to_string();
        assert!(error.contains(words) && error.contains(name) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn ascii_grids_of_all_dialects() {
    let folder = Folder::new("asc");
    let path = folder.0.join("g.asc");
    let read = |text: &str| {
        fs::write(&path, text).unwrap();
        esri_ascii::read(&path, &Limits::default()).map(|l| (l.value, l.warnings))
    };
    // corners and centres say the same; any case, any line breaks, CRLF, a byte order mark
    let corner = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -1\n1 2 3\n4 -1 6.5\n";
    let centre = "\u{feff}NCOLS 3\r\nNROWS 2\r\nXLLCENTER 105\r\nYLLCENTER 205\r\nDX 10\r\nDY 10\r\nNODATA_value -1\r\n1 2\r\n3 4 -1\r\n6.5";
    let (a, _) = read(corner).unwrap();
    let (b, _) = read(centre).unwrap();
    assert_eq!(a, b);
    assert_eq!(a.info.pixel_to_model.unwrap().apply(0.5, 0.5), [105.0, 215.0]);
    assert_eq!([a.sample_f64(0, 2, 1), a.sample_f64(0, 1, 1)], [Some(6.5), None]);
    assert_eq!(a.info.crs, SourceCrs::Unknown);
    let (_, warnings) = read(&format!("{corner} 7 8")).unwrap();
    assert!(warnings[0].text().contains("2 values"), "{warnings:?}");
    fs::write(path.with_extension("prj"), "GEOGCS[\"x\"]").unwrap();
    assert_eq!(read(corner).unwrap().0.info.crs, SourceCrs::Wkt("GEOGCS[\"x\"]".into()));
}

#[test]
fn broken_ascii_grids_are_one_sentence() {
    let folder = Folder::new("asc-broken");
    let path = folder.0.join("g.asc");
    let head = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
    let cases = [
        (String::new(), "ncols"),
        (format!("{head}1 2 3 4 5"), "truncated"),
        (format!("{head}1 2 3 4 5 x"), "\"x\""),
        ("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\n1 2 3 4 5 6".into(), "cellsize"),
        ("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0\n".into(), "cellsize"),
        ("ncols 999999\nnrows 999999\nxllcorner 0\nyllcorner 0\ncellsize 1\n1".into(), "truncated"),
        ("ncols 1e300\nnrows 2".into(), "ncols"),
        ("ncols -3\nnrows 2".into(), "ncols"),
        ("hello world".into(), "hello"),
        ("ncols".into(), "ncols"),
        ("xllcorner inf".into(), "not finite"),
    ];
    for (text, words) in cases {
        fs::write(&path, &text).unwrap();
        let error = esri_ascii::read(&path, &Limits::default()).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n') && error.len() < 300, "{text:?}: {error}");
    }
}
