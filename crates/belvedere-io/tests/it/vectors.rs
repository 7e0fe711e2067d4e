//! Vector files of the data collection and made-up ones: counts, extents, broken files, and lines placed on terrain.

use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::{Geometry, Loaded, Vectors, areas_on_terrain, lines_on_terrain, load_vectors, points_on_terrain};
use belvedere_scene::{Crs, Heightfield, LineFeature, NodeState};
use belvedere_testkit::data;
use glam::DVec2;
use std::path::{Path, PathBuf};

/// File, features, features with a name, vertices without the repeated end of rings, extent: counted by a script that shares no code
/// with the readers.
type Row = (&'static str, usize, usize, usize, [f64; 4]);

#[rustfmt::skip]
const GEOJSON: &[Row] = &[
    ("andorra/buildings.geojson", 292, 39, 1659, [1.4704716, 42.435891, 1.718687, 42.6226844]),
    ("andorra/forest.geojson", 53, 0, 3941, [1.3988039, 42.4311686, 1.713486, 42.6413846]),
    ("andorra/hiking_routes.geojson", 6, 6, 4633, [1.4088716, 42.4384034, 1.8164837, 42.6384469]),
    ("andorra/points.geojson", 208, 201, 208, [1.0437826, 42.4391742, 1.7384087, 42.787788]),
    ("andorra/roads.geojson", 1193, 552, 18141, [1.419351, 42.4356597, 1.7338324, 42.6340018]),
    ("andorra/trails.geojson", 422, 53, 22436, [1.4088716, 42.41714, 1.8164837, 42.6942662]),
    ("andorra/water.geojson", 98, 39, 4161, [1.4281081, 42.4522992, 1.7598183, 42.6561626]),
    ("andorra/waterways.geojson", 111, 30, 6957, [1.4353457, 42.3456485, 1.7528331, 42.6663754]),
    ("baltoro/glacier_centerlines.geojson", 98, 0, 6333, [76.05941981240406, 35.591260914188524, 76.74802564275728, 35.91231764418423]),
    ("baltoro/glacier_outline.geojson", 1, 0, 8327, [76.05818454930112, 35.583668434798575, 76.75632381390463, 35.91669191206544]),
    ("city_bubenec/buildings.geojson", 144, 0, 1662, [14.3999205, 50.1011196, 14.4055423, 50.1048701]),
    ("city_bubenec/plots.geojson", 407, 0, 7336, [14.3983639, 50.0993846, 14.409641, 50.1073311]),
    ("city_bubenec/streets.geojson", 35, 0, 124, [14.3989816, 50.100077, 14.4071436, 50.1057945]),
    ("grand_canyon/colorado_river_line_derived.geojson", 1, 1, 605, [-113.202782, 36.123178, -112.857399, 36.282198]),
    ("grand_canyon/colorado_rivermiles.geojson", 297, 0, 297, [-113.98181055952368, 35.75074907926934, -111.48084582791263, 36.92552635611628]),
    ("grand_canyon/rapids.geojson", 108, 0, 108, [-113.53101316250245, 35.75092921141148, -111.60158136744136, 36.857729346008675]),
    ("odd/antimeridian_line.geojson", 1, 1, 4, [-179.97, -16.85, 179.95, -16.8]),
    ("rmnp/colorado-glaciers.geojson", 134, 0, 134, [-107.99, 37.838, -105.61, 40.868]),
    ("rmnp/continental-div-trail.geojson", 1, 1, 2556, [-113.9354222, 31.4959273, -105.6667763, 48.9998547]),
    ("rmnp/continental-div-trail_clip.geojson", 1, 1, 37, [-105.9125, 40.15911, -105.6936674, 40.339984257659744]),
    ("swellendam/buildings.geojson", 4708, 120, 27157, [20.3605484, -34.076461, 20.5889352, -33.9923726]),
    ("swellendam/protected_areas.geojson", 2, 2, 187, [20.2243233, -34.0948433, 20.5178741, -33.8980064]),
    ("swellendam/rivers.geojson", 12, 11, 1938, [19.167783, -34.232357, 20.5473255, -33.4209048]),
    ("swellendam/roads.geojson", 717, 373, 9652, [20.2289183, -34.2300861, 20.7081324, -33.9740272]),
];

#[rustfmt::skip]
const SHAPEFILES: &[Row] = &[
    ("baltoro/glacier_outline.shp", 1, 0, 8327, [76.05818454930112, 35.583668434798575, 76.75632381390463, 35.91669191206544]),
    ("odd/corrupt_water.shp", 37, 0, 517, [20.4248071, -34.052263, 20.5871397, -33.9960949]),
];

/// File, lines per line feature, waypoints, vertices kept, extent of all points in the file.
type GpxRow = (&'static str, &'static [usize], usize, usize, [f64; 4]);

#[rustfmt::skip]
const GPX: &[GpxRow] = &[
    ("andorra/andorra_for_map_matching.gpx", &[1], 0, 21, [1.532909, 42.621349, 1.540148, 42.623636]),
    ("andorra/gr11_andorra_no_elevation.gpx", &[2], 0, 1741, [1.4088716, 42.4826648, 1.7032433, 42.6124773]),
    ("andorra/hrp_andorra_no_elevation.gpx", &[3], 0, 1804, [1.4611675, 42.5950678, 1.7507836, 42.6384469]),
    ("odd/Mojstrovka.gpx", &[1], 0, 184, [13.738842, 46.43035, 13.748333, 46.435641]),
    ("odd/cerknicko-jezero-without-elevations.gpx", &[1; 7], 7, 303, [14.28863327, 45.735199945, 14.377516648, 45.795349991]),
    ("odd/gpx1.0_with_all_fields.gpx", &[1, 1], 2, 7, [-20.2, 10.0, 46.7, 14.0]),
    ("odd/gpx_with_garmin_extension.gpx", &[], 1, 1, [-122.391386, 37.778259, -122.391386, 37.778259]),
    ("odd/route.gpx", &[1], 0, 55, [13.7244129181, 45.2785197363, 13.7491938472, 45.2916976812]),
    ("odd/tour-with-loop.gpx", &[1, 1], 0, 22, [12.361337, 51.342128, 12.363246, 51.344095]),
    ("odd/track-with-empty-segment.gpx", &[1], 0, 9, [6.0819695, 50.7772126, 6.0827233, 50.7777341]),
    ("odd/unicode.gpx", &[], 6, 6, [14.28863327, 45.735199945, 14.377516648, 45.795349991]),
];

fn assert_extent(v: &Vectors, expected: [f64; 4], file: &str) {
    let [lo, hi] = v.extent().unwrap();
    for (found, expected) in [lo.x, lo.y, hi.x, hi.y].into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{file}: {found} instead of {expected}");
    }
}

fn assert_rows(rows: &[Row], format: &str) {
    for &(file, features, named, vertices, extent) in rows {
        let Some(path) = data(file) else { continue };
        let Loaded { value, warnings, .. } = load_vectors(&path).unwrap();
        assert_eq!(value.format, format, "{file}");
        assert_eq!(value.features.len(), features, "{file}");
        assert_eq!(value.features.iter().filter(|f| !f.name.is_empty()).count(), named, "{file}: names");
        assert_eq!(value.vertex_count(), vertices, "{file}: vertices");
        assert_eq!(value.crs.epsg(), Some(4326), "{file}");
        assert_extent(&value, extent, file);
        assert!(warnings.is_empty(), "{file}: {warnings:?}");
    }
}

#[test]
fn every_geojson_of_the_collection() {
    assert_rows(GEOJSON, "GeoJSON");
}

#[test]
fn every_shapefile_of_the_collection() {
    assert_rows(SHAPEFILES, "shapefile");
    let Some(path) = data("baltoro/glacier_outline.shp") else { return };
    let Geometry::Polygons(polygons) = &load_vectors(&path).unwrap().value.features[0].geometry else { panic!() };
    assert_eq!(polygons.iter().map(Vec::len).collect::<Vec<_>>(), [19], "one glacier with 18 rocks in it");
    let Some(path) = data("odd/corrupt_water.shp") else { return };
    let water = load_vectors(&path).unwrap().value;
    assert_eq!(water.features[0].properties["osm_id"], "220442942");
}

#[test]
fn every_gpx_of_the_collection() {
    for &(file, lines, waypoints, vertices, extent) in GPX {
        let Some(path) = data(file) else { continue };
        let Loaded { value, warnings, .. } = load_vectors(&path).unwrap();
        let line_counts: Vec<usize> = value
            .features
            .iter()
            .filter_map(|f| if let Geometry::Lines(l) = &f.geometry { Some(l.len()) } else { None })
            .collect();
        assert_eq!(line_counts, lines, "{file}");
        assert_eq!(value.features.len() - line_counts.len(), waypoints, "{file}");
        assert_eq!(value.vertex_count(), vertices, "{file}");
        let odd = ["cerknicko", "all_fields", "empty"].iter().any(|n| file.contains(n));
        assert_eq!(warnings.is_empty(), !odd, "{file}: {warnings:?}");
        if !file.contains("all_fields") {
            assert_extent(&value, extent, file);
        }
    }
    let names = |file| {
        data(file).map(|p| load_vectors(&p).unwrap().value.features.into_iter().map(|f| f.name).collect::<Vec<_>>())
    };
    if let Some(names) = names("odd/unicode.gpx") {
        assert_eq!(names[0], "\u{161}\u{111}\u{10d}\u{107}\u{17e}");
    }
    if let Some(path) = data("odd/gpx_with_garmin_extension.gpx") {
        let v = load_vectors(&path).unwrap().value;
        assert_eq!(v.features[0].geometry.vertices().next().unwrap().z, Some(3.4));
    }
}

#[test]
fn gpx_without_any_position_says_so() {
    for file in ["odd/no_trkpt.gpx", "odd/no_trkseg.gpx"] {
        let Some(path) = data(file) else { continue };
        let text = load_vectors(&path).unwrap_err().to_string();
        assert!(text.contains("1 tracks, 0 routes") && text.contains("usable position"), "{text}");
    }
}

fn write(dir: &tempfile::TempDir, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = dir.path().join(name);
    std::fs::write(&path, content).unwrap();
    path
}

#[test]
fn every_geometry_type_of_geojson() {
    let dir = tempfile::tempdir().unwrap();
    let ring = "[[0,0],[4,0],[4,4],[0,0]]";
    let bare = [
        ("{\"type\":\"Point\",\"coordinates\":[1,2,3]}".to_owned(), 1),
        ("{\"type\":\"MultiPoint\",\"coordinates\":[[1,2],[3,4]]}".to_owned(), 2),
        ("{\"type\":\"LineString\",\"coordinates\":[[1,2],[3,4]]}".to_owned(), 2),
        ("{\"type\":\"MultiLineString\",\"coordinates\":[[[1,2],[3,4]],[[1,1],[2,2],[3,3]]]}".to_owned(), 5),
        (format!("{{\"type\":\"Polygon\",\"coordinates\":[{ring}]}}"), 3),
        (format!("{{\"type\":\"MultiPolygon\",\"coordinates\":[[{ring}],[{ring}]]}}"), 6),
    ];
    let all = bare.iter().map(|b| b.0.as_str()).collect::<Vec<_>>().join(",");
    let collection = format!("{{\"type\":\"GeometryCollection\",\"geometries\":[{all}]}}");
    let feature =
        format!("{{\"type\":\"Feature\",\"properties\":{{\"NAME\":\"x\",\"n\":7}},\"geometry\":{collection}}}");
    for (text, vertices) in bare.iter().map(|(t, n)| (t, *n)).chain([(&collection, 19), (&feature, 19)]) {
        let v = load_vectors(&write(&dir, "a.json", text)).unwrap().value;
        assert_eq!(v.vertex_count(), vertices, "{text}");
        if text == &feature {
            assert!(v.features.iter().all(|f| f.name == "x" && f.properties["n"] == "7"));
        }
    }
}

#[test]
fn geojson_states_its_system_or_is_in_degrees() {
    let dir = tempfile::tempdir().unwrap();
    let line = |crs: &str| {
        format!(
            "{{\"type\":\"Feature\",{crs}\"properties\":null,\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[[390478,5819214],[390703,5819553]]}}}}"
        )
    };
    let name = |n: &str| line(&format!("\"crs\":{{\"type\":\"name\",\"properties\":{{\"name\":\"{n}\"}}}},"));
    for n in ["urn:ogc:def:crs:EPSG::25833", "EPSG:25833", "http://www.opengis.net/def/crs/EPSG/0/25833"] {
        assert_eq!(load_vectors(&write(&dir, "a.json", name(n))).unwrap().value.crs.epsg(), Some(25833));
    }
    let unstated = load_vectors(&write(&dir, "a.json", line(""))).unwrap().value;
    assert!(unstated.crs.is_local() && !unstated.crs_stated);
    let text = lines_on_terrain(&unstated, Crs::Epsg(25833), None).unwrap_err().to_string();
    assert!(text.contains("5819214") && text.contains("crs"), "{text}");
    assert_eq!(lines_on_terrain(&unstated, Crs::Local, None).unwrap().value.len(), 1);
    let text = load_vectors(&write(&dir, "a.json", name("my own system"))).unwrap_err().to_string();
    assert!(text.contains("my own system"), "{text}");
    // A local system is stated, too, and numbers that could be degrees are not.
    let small = name("local").replace("[390478,5819214],[390703,5819553]", "[2,3],[20,22]");
    let local = load_vectors(&write(&dir, "a.json", small)).unwrap().value;
    assert!(local.crs.is_local() && local.crs_stated);
    let lines = lines_on_terrain(&local, Crs::Local, None).unwrap();
    assert!(lines.value.len() == 1 && lines.warnings.is_empty(), "{:?}", lines.warnings);
    assert!(lines_on_terrain(&local, Crs::Epsg(25833), None).is_err());
}

#[test]
fn of_a_track_that_is_cut_off_or_damaged_what_is_whole_before_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let point = |k: usize| format!("<trkpt lat='46.{k:03}' lon='8.1'><ele>{k}</ele></trkpt>");
    let points: String = (0..100).map(point).collect();
    let whole = format!("<gpx><trk><name>Rock &amp; Ice</name><trkseg>{points}</trkseg></trk></gpx>");
    let read = |text: &str| {
        let loaded = load_vectors(&write(&dir, "a.gpx", text)).map_err(|e| e.to_string())?;
        let count: usize = loaded.value.features.iter().map(|f| f.geometry.vertices().count()).sum();
        let said = loaded.warnings.iter().find(|w| w.text().contains("what is whole before is drawn"));
        let said = said.map(|w| (w.kind(), w.text().contains(&format!("{count} points"))));
        Ok::<_, String>((count, said, loaded.value.features[0].name.clone()))
    };
    assert_eq!(read(&whole), Ok((100, None, "Rock & Ice".into())));
    let said = Some((belvedere_core::WarningKind::Repaired, true));
    let first = whole.find("<trkseg>").unwrap() + "<trkseg>".len();
    for at in (first + 3 * point(0).len()..whole.len() - 1).step_by(37) {
        let left = whole[..at].matches("</trkpt>").count();
        let (count, told, name) = read(&whole[..at]).unwrap_or_else(|e| panic!("cut at {at}: {e}"));
        assert!(count == left && told == said && name == "Rock & Ice", "cut at {at}: {count} of {left}");
    }
    let (count, told, _) = read(&whole.replacen(&point(60), "<trkpt lat='46.1' lon='8.1'></ele></trkpt>", 1)).unwrap();
    assert_eq!((count, told), (60, said), "a wrong end inside");
    let bare = whole.replace("&amp;", "&");
    assert_eq!(read(&bare), Ok((100, None, "Rock & Ice".into())), "a bare &");
    assert!(read(&whole[..first + 5]).unwrap_err().contains("get it again"));
}

#[test]
fn other_and_broken_files_are_one_clear_error() {
    let dir = tempfile::tempdir().unwrap();
    let cases: [(&str, &[u8], &str); 12] = [
        ("empty.gpx", b"", "is empty"),
        ("a.dae", b"<COLLADA><asset/></COLLADA>", "is COLLADA (triangles), which this version does not read"),
        ("b.gpx", b"<COLLADA><asset/></COLLADA>", "is COLLADA (triangles), which this version does not read"),
        ("a.gpx", b"<gpx><trk><trkseg>", "ends inside <trkseg>"),
        ("a.gpx", b"<gpx><trk></gpx>", "well-formed"),
        ("a.gpx", b"<?xml version='1.0'?>", "no XML element"),
        ("a.txt", b"hello", "not routes, areas or points: GPX"),
        ("a.json", b"[1,2]", "\"type\""),
        ("a.json", b"{\"type\":\"CityJSON\"}", "CityJSON"),
        ("a.json", b"{\"type\":\"Point\",\"coordinates\":[1,\"x\"]}", "two or three numbers"),
        ("a.shp", b"\x00\x00\x27\x0a", "100"),
        ("a.shp", b"nonsense", "9994"),
    ];
    for (name, content, expected) in cases {
        let text = load_vectors(&write(&dir, name, content)).unwrap_err().to_string();
        assert!(text.contains(expected) && text.contains(name), "{text}");
    }
    let deep = "<gpx>".to_owned() + &"<a>".repeat(5000);
    assert!(load_vectors(&write(&dir, "deep.gpx", deep)).is_err());
    let deep = "[".repeat(100_000);
    assert!(load_vectors(&write(&dir, "deep.json", deep)).is_err());
    assert!(load_vectors(&dir.path().join("missing.gpx")).is_err());
}

#[test]
fn gpx_in_other_encodings() {
    let dir = tempfile::tempdir().unwrap();
    let text = "<gpx><wpt lat='1' lon='2'><name>M\u{fc}ller &amp; &#233;t\u{e9}</name></wpt></gpx>";
    let utf16: Vec<u8> = [0xfe, 0xff].into_iter().chain(text.encode_utf16().flat_map(u16::to_be_bytes)).collect();
    let latin1: Vec<u8> = text.chars().map(|c| c as u8).collect();
    let bom = [&[0xef, 0xbb, 0xbf], text.as_bytes()].concat();
    for (bytes, warned) in [(utf16, 0), (latin1, 1), (bom, 0)] {
        let loaded = load_vectors(&write(&dir, "a.gpx", bytes)).unwrap();
        assert_eq!(loaded.value.features[0].name, "M\u{fc}ller & \u{e9}t\u{e9}");
        assert_eq!(loaded.warnings.len(), warned);
    }
}

#[test]
fn cut_and_damaged_files_never_panic() {
    let dir = tempfile::tempdir().unwrap();
    let files = [
        "odd/Mojstrovka.gpx",
        "odd/tour-with-loop.gpx",
        "rmnp/colorado-glaciers.geojson",
        "odd/corrupt_water.shp",
        "baltoro/glacier_outline.shp",
    ];
    for file in files {
        let Some(path) = data(file) else { continue };
        let bytes = std::fs::read(&path).unwrap();
        let name = format!("cut.{}", path.extension().unwrap().to_str().unwrap());
        for k in 0..32 {
            let cut = bytes.len() * k / 32;
            match load_vectors(&write(&dir, &name, &bytes[..cut])) {
                Err(_) => {}
                Ok(loaded) => {
                    let said = loaded.warnings.iter().any(|w| w.text().contains("what is whole before is drawn"));
                    assert!(name == "cut.gpx" && said, "{file} cut at {cut}");
                }
            }
            let mut damaged = bytes.clone();
            for j in 0..3 {
                let at = (k * 7919 + j * 104_729 + 13) % damaged.len();
                damaged[at] = damaged[at].wrapping_mul(31).wrapping_add(101);
            }
            if let Ok(loaded) = load_vectors(&write(&dir, &name, &damaged)) {
                assert!(loaded.value.features.iter().flat_map(|f| f.geometry.vertices()).all(|v| v.xy.is_finite()));
            }
        }
    }
}

/// One shapefile record after another.
fn shapefile(kind: i32, records: &[Vec<u8>]) -> Vec<u8> {
    let mut body = Vec::new();
    for (k, r) in records.iter().enumerate() {
        body.extend((k as i32 + 1).to_be_bytes());
        body.extend((r.len() as i32 / 2).to_be_bytes());
        body.extend(r);
    }
    let mut out = vec![0u8; 100];
    out[..4].copy_from_slice(&9994i32.to_be_bytes());
    out[24..28].copy_from_slice(&((100 + body.len()) as i32 / 2).to_be_bytes());
    out[28..32].copy_from_slice(&1000i32.to_le_bytes());
    out[32..36].copy_from_slice(&kind.to_le_bytes());
    out.extend(body);
    out
}

fn le(ints: &[i32], floats: &[f64]) -> Vec<u8> {
    ints.iter().flat_map(|i| i.to_le_bytes()).chain(floats.iter().flat_map(|f| f.to_le_bytes())).collect()
}

#[test]
fn shapefiles_with_z_and_multipoints_and_null_shapes() {
    let dir = tempfile::tempdir().unwrap();
    let frame = [0.0; 4];
    // polyline Z: 2 parts of 2 points, z array, m array
    let mut line = le(&[13], &frame);
    line.extend(le(
        &[2, 4, 0, 2],
        &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 0.0, 9.0, 10.0, 20.0, 30.0, 40.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ));
    let v = load_vectors(&write(&dir, "a.shp", shapefile(13, &[line, le(&[0], &[])]))).unwrap();
    let Geometry::Lines(lines) = &v.value.features[0].geometry else { panic!() };
    assert_eq!(lines.iter().flatten().map(|v| v.z.unwrap()).collect::<Vec<_>>(), [10.0, 20.0, 30.0, 40.0]);
    assert_eq!(lines[1][1].xy, DVec2::new(7.0, 8.0));
    assert!(
        v.warnings.iter().any(|w| w.text().contains("1 of 2 shapes"))
            && v.warnings.iter().any(|w| w.text().contains(".prj")),
        "{:?}",
        v.warnings
    );
    let point = le(&[11], &[1.5, 2.5, 99.0, 0.0]);
    let v = load_vectors(&write(&dir, "a.shp", shapefile(11, &[point]))).unwrap().value;
    assert_eq!(v.features[0].geometry.vertices().next().unwrap().z, Some(99.0));
    let mut many = le(&[8], &frame);
    many.extend(le(&[2], &[1.0, 2.0, 3.0, 4.0]));
    assert_eq!(load_vectors(&write(&dir, "a.shp", shapefile(8, &[many]))).unwrap().value.vertex_count(), 2);
    let mut lying = le(&[3], &frame);
    lying.extend(le(&[i32::MAX, i32::MAX, 0], &[]));
    let text = load_vectors(&write(&dir, "a.shp", shapefile(3, &[lying]))).unwrap_err().to_string();
    assert!(text.contains("record 1"), "{text}");
}

/// A tilted plane of `n` x `n` nodes, 100 m apart, around a point.
fn plane(middle: DVec2, n: usize, void: impl Fn(usize, usize) -> bool) -> Heightfield {
    let corner = middle + DVec2::new(-50.0, 50.0) * (n - 1) as f64;
    let heights = (0..n * n).map(|i| 1000.0 + (i % n) as f32 * 3.0 - (i / n) as f32 * 2.0).collect();
    let states = (0..n * n).map(|i| if void(i % n, i / n) { NodeState::Void } else { NodeState::Measured }).collect();
    Heightfield::new(corner, DVec2::splat(100.0), n, n, heights, states).unwrap()
}

fn to_utm(lon: f64, lat: f64, epsg: u32) -> DVec2 {
    Transform::between_epsg(4326, epsg).unwrap().forward_one(DVec2::new(lon, lat)).unwrap()
}

fn length(lines: &[LineFeature]) -> f64 {
    lines.iter().flat_map(|l| l.points.windows(2)).map(|w| w[0].truncate().distance(w[1].truncate())).sum()
}

fn geojson_line(dir: &tempfile::TempDir, coordinates: &str) -> Vectors {
    let text = format!("{{\"type\":\"LineString\",\"coordinates\":{coordinates}}}");
    load_vectors(&write(dir, "line.json", text)).unwrap().value
}

#[test]
fn a_long_straight_line_in_degrees_stays_on_its_parallel() {
    let dir = tempfile::tempdir().unwrap();
    let v = geojson_line(&dir, "[[1.0,60.0],[2.0,60.0]]");
    let terrain = plane(to_utm(1.5, 60.0, 32631), 701, |_, _| false);
    let lines = lines_on_terrain(&v, Crs::Epsg(32631), Some(&terrain)).unwrap().value;
    assert_eq!(lines.len(), 1);
    let back = Transform::between_epsg(32631, 4326).unwrap();
    // a chord would leave the parallel by 100 m in the middle
    for p in &lines[0].points {
        let off = (back.forward_one(p.truncate()).unwrap().y - 60.0).abs() * 111_000.0;
        assert!(off < 0.1, "{off} m off the parallel");
    }
}

#[test]
fn lines_are_draped_clipped_and_what_is_cut_off_is_told() {
    let dir = tempfile::tempdir().unwrap();
    // 0.1 degrees at 42.5 north are 8.2 km; the terrain reaches 2.5 km to either side of the middle, with a void stripe of 2 cells
    let v = geojson_line(&dir, "[[1.45,42.5],[1.5,42.5],[1.5,42.5],[1.55,42.5]]");
    let terrain = plane(to_utm(1.5, 42.5, 32631), 51, |c, _| c == 10);
    let loaded = lines_on_terrain(&v, Crs::Epsg(32631), Some(&terrain)).unwrap();
    assert_eq!(loaded.value.len(), 2, "split at the void");
    assert!((length(&loaded.value) - 4800.0).abs() < 10.0, "{}", length(&loaded.value));
    assert!(loaded.warnings[0].text().contains("3.4 of 8.2 km"), "{:?}", loaded.warnings);
    for p in loaded.value.iter().flat_map(|l| &l.points) {
        assert!((terrain.surface_at(p.truncate()).unwrap() - p.z).abs() < 1e-6);
    }
    let distances = loaded.value.iter().flat_map(|l| l.points.windows(2)).map(|w| w[0].distance(w[1]));
    assert!(distances.fold(0.0, f64::max) < 150.0);
    assert!(loaded.value.iter().flat_map(|l| l.points.windows(2)).all(|w| w[0] != w[1]));
}

#[test]
fn a_line_that_misses_the_terrain_names_both_extents() {
    let dir = tempfile::tempdir().unwrap();
    let v = geojson_line(&dir, "[[1.45,43.5],[1.55,43.5]]");
    let terrain = plane(to_utm(1.5, 42.5, 32631), 51, |_, _| false);
    let text = lines_on_terrain(&v, Crs::Epsg(32631), Some(&terrain)).unwrap_err().to_string();
    let x = format!("{:.0}..", terrain.bounds().min.x);
    assert!(text.contains("EPSG:32631") && text.contains(&x) && text.contains("line.json"), "{text}");
    assert!(lines_on_terrain(&v, Crs::Local, Some(&terrain)).unwrap_err().to_string().contains("no coordinate system"));
}

#[test]
fn the_antimeridian_is_crossed_the_short_way() {
    let Some(path) = data("odd/antimeridian_line.geojson") else { return };
    let v = load_vectors(&path).unwrap().value;
    // by Vincenty's inverse geodesic; the scale of UTM is within 0.1 % here
    const ANTIMERIDIAN_M: f64 = 29_463.747;
    for epsg in [32760, 32701] {
        let terrain = plane(to_utm(180.0, -16.83, epsg), 801, |_, _| false);
        for terrain in [Some(&terrain), None] {
            let lines = lines_on_terrain(&v, Crs::Epsg(epsg), terrain).unwrap();
            assert_eq!(lines.value.len(), 1, "EPSG:{epsg}");
            assert!(
                (length(&lines.value) / ANTIMERIDIAN_M - 1.0).abs() < 2e-3,
                "EPSG:{epsg}: {} m",
                length(&lines.value)
            );
            assert!(lines.warnings.is_empty(), "{:?}", lines.warnings);
        }
    }
}

#[test]
fn real_routes_lie_on_flat_ground_of_their_place() {
    // lengths by a geodesic script: 51.7 and 36.0 km
    for (file, km) in [("andorra/gr11_andorra_no_elevation.gpx", 51.7), ("andorra/hrp_andorra_no_elevation.gpx", 36.0)]
    {
        let Some(path) = data(file) else { continue };
        let v = load_vectors(&path).unwrap().value;
        let terrain = plane(to_utm(1.6, 42.5, 32631), 601, |_, _| false);
        let loaded = lines_on_terrain(&v, Crs::Epsg(32631), Some(&terrain)).unwrap();
        assert!((length(&loaded.value) / 1000.0 - km).abs() < 0.1, "{file}: {} m", length(&loaded.value));
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    }
}

#[test]
fn areas_and_points_on_terrain() {
    let terrain = plane(to_utm(1.6, 42.5, 32631), 401, |_, _| false);
    if let Some(path) = data("andorra/water.geojson") {
        let v = load_vectors(&path).unwrap().value;
        let areas = areas_on_terrain(&v, Crs::Epsg(32631), Some(&terrain)).unwrap().value;
        assert_eq!(areas.len(), 98);
        for a in areas.iter() {
            let area = |r: &[DVec2]| {
                (0..r.len()).map(|k| 0.5 * (r[k] - r[0]).perp_dot(r[(k + 1) % r.len()] - r[0])).sum::<f64>()
            };
            assert!(area(&a.rings[0]) > 0.0 && a.rings[1..].iter().all(|r| area(r) < 0.0), "{}", a.name);
        }
    }
    if let Some(path) = data("andorra/points.geojson") {
        let v = load_vectors(&path).unwrap().value;
        let loaded = points_on_terrain(&v, Crs::Epsg(32631), Some(&terrain)).unwrap();
        assert!(loaded.value.len() > 100 && loaded.value.len() < 208);
        assert!(
            loaded.warnings[0].text().contains(&format!("{} of 208", 208 - loaded.value.len())),
            "{:?}",
            loaded.warnings
        );
        assert!(
            lines_on_terrain(&v, Crs::Epsg(32631), Some(&terrain)).unwrap_err().to_string().contains("points only")
        );
    }
}

#[test]
fn the_outline_of_a_polygon_is_closed() {
    let dir = tempfile::tempdir().unwrap();
    let corners = "[[400000,4700000],[403000,4700000],[403000,4704000],[400000,4704000],[400000,4700000]]";
    let text = format!(
        "{{\"type\":\"Polygon\",\"crs\":{{\"properties\":{{\"name\":\"EPSG:32631\"}}}},\"coordinates\":[{corners}]}}"
    );
    let v = load_vectors(&write(&dir, "square.json", text)).unwrap().value;
    let lines = lines_on_terrain(&v, Crs::Epsg(32631), None).unwrap().value;
    assert!((length(&lines) - 14_000.0).abs() < 1e-6, "{} m of 14000", length(&lines));
    assert_eq!(lines[0].points.first(), lines[0].points.last());
}

#[test]
fn unknown_systems_are_refused() {
    assert!(CoordinateSystem::from_epsg(999_999).is_err());
    let dir = tempfile::tempdir().unwrap();
    let v = geojson_line(&dir, "[[1.45,42.5],[1.55,42.5]]");
    assert!(lines_on_terrain(&v, Crs::Epsg(999_999), None).is_err());
    assert!(load_vectors(Path::new("/")).is_err());
}

/// The name of an element that is left out does not pass to the next one.
#[test]
fn gpx_elements_begin_anew_and_what_is_left_out_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let point = |name: &str, lon: f64| format!("<{name} lat=\"42.5\" lon=\"{lon}\"/>");
    let [one, two, bad] = [point("trkpt", 1.5), point("trkpt", 1.6), point("trkpt", 999.0)];
    let [three, four] = [point("rtept", 1.5), point("rtept", 1.6)];
    let text = format!(
        "<gpx><trkseg>{one}{two}</trkseg>\
         <trk><name>short</name><desc>one point</desc><trkseg>{one}</trkseg></trk>\
         <trk>{one}{two}</trk><rte>{three}{four}</rte>\
         <trk><trkseg>{one}{two}{bad}</trkseg><trkseg></trkseg></trk>\
         <wpt lat=\"95\" lon=\"1\"><name>nowhere</name><sym>Flag</sym></wpt>{}</gpx>",
        point("wpt", 1.7)
    );
    let Loaded { value, warnings, .. } = load_vectors(&write(&dir, "a.gpx", text)).unwrap();
    let counts: Vec<usize> = value.features.iter().map(|f| f.geometry.vertices().count()).collect();
    assert_eq!(counts, [2, 2, 2, 1], "a track without segments, a route, a track and a waypoint");
    for feature in &value.features {
        assert!(feature.name.is_empty() && feature.properties.keys().eq(["kind"]), "{feature:?}");
    }
    let told =
        ["2 points without a valid", "1 segments without points", "1 tracks, segments or routes of a single point"];
    assert_eq!(warnings.len(), told.len(), "{warnings:?}");
    assert!(warnings.iter().zip(told).all(|(w, t)| w.text().contains(t)), "{warnings:?}");
}

#[test]
fn a_whole_turn_of_longitude_changes_nothing() {
    let dir = tempfile::tempdir().unwrap();
    for (middle, turn, epsg) in [(1.5, -360.0, 32631), (-1.5, 360.0, 32630)] {
        let terrain = plane(to_utm(middle, 42.5, epsg), 51, |_, _| false);
        let line = |turn: f64| {
            let [a, b] = [middle - 0.01, middle + 0.01].map(|lon| lon + turn);
            let v = geojson_line(&dir, &format!("[[{a:.2},42.5],[{b:.2},42.5]]"));
            lines_on_terrain(&v, Crs::Epsg(epsg), Some(&terrain)).unwrap().value
        };
        let (here, around) = (line(0.0), line(turn));
        // 0.02 degrees of the parallel, within the scale of UTM.
        assert!((length(&here) - 1643.0).abs() < 3.0, "{} m", length(&here));
        assert!((length(&here) - length(&around)).abs() < 1e-3, "{} m at {turn}", length(&around));
        assert!(here[0].points[0].distance(around[0].points[0]) < 1e-3);
    }
}
