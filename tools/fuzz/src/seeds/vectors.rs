//! Lines, areas and points.

use super::{CORNER, degrees, square, walk};
use belvedere::io::crs::CoordinateSystem;
use belvedere::io::vector::{FeatureTable, write_geopackage};
use belvedere::io::{Geometry, VectorFeature, Vertex};

fn trackpoints(name: &str) -> String {
    let one = |(i, [x, y]): (usize, [f64; 2])| {
        let [lon, lat] = degrees(x, y);
        format!(
            "<{name} lat=\"{lat:.6}\" lon=\"{lon:.6}\"><ele>{}</ele><time>2026-05-01T10:{i:02}:00Z</time></{name}>",
            900 + i
        )
    };
    walk().into_iter().enumerate().map(one).collect()
}

/// Tracks, routes and waypoints.
pub fn gpx() -> Vec<Vec<u8>> {
    let head =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" xmlns=\"http://www.topografix.com/GPX/1/1\">";
    let track = format!("<trk><name>T\u{e4}lchen &amp; Weg</name><trkseg>{}</trkseg></trk>", trackpoints("trkpt"));
    let route = format!("<rte><name><![CDATA[Route]]></name>{}</rte>", trackpoints("rtept"));
    vec![
        format!("{head}{track}</gpx>").into_bytes(),
        format!("{head}\n{route}<!-- end -->\n{track}\n</gpx>").into_bytes(),
    ]
}

/// A line in a folder, an area with a hole and a track with times.
pub fn kml() -> Vec<Vec<u8>> {
    let tuples = |list: &[[f64; 2]], sign: &str| {
        let one = |p: &[f64; 2]| degrees(p[0], p[1]).map(|n| format!("{n:.6}")).join(sign);
        list.iter().map(|p| format!("{}{sign}905", one(p))).collect::<Vec<_>>()
    };
    let line = format!("<LineString><coordinates>{}</coordinates></LineString>", tuples(&walk(), ",").join(" "));
    let ring = |half: f64| {
        let ring = tuples(&square(280.0, 260.0, half), ",").join("\n");
        format!("<LinearRing><coordinates>{ring}</coordinates></LinearRing>")
    };
    let (outer, inner) = (ring(120.0), ring(40.0));
    let area = format!(
        "<Polygon><outerBoundaryIs>{outer}</outerBoundaryIs><innerBoundaryIs>{inner}</innerBoundaryIs></Polygon>"
    );
    let times: String = (0..walk().len()).map(|k| format!("<when>2026-05-01T10:{k:02}:00Z</when>")).collect();
    let coords: String = tuples(&walk(), " ").iter().map(|c| format!("<gx:coord>{c}</gx:coord>")).collect();
    let data = "<ExtendedData><Data name=\"height\"><value>12.5</value></Data></ExtendedData>";
    let text = format!(
        "<kml xmlns:gx=\"g\"><Document><Folder><Placemark><name>Weg &amp; See</name>{data}<MultiGeometry>{line}{area}</MultiGeometry></Placemark></Folder>\
         <Placemark><gx:Track>{times}{coords}</gx:Track></Placemark></Document></kml>"
    );
    vec![text.into_bytes()]
}

/// An activity of one lap.
pub fn tcx() -> Vec<Vec<u8>> {
    let one = |(k, [x, y]): (usize, [f64; 2])| {
        let [lon, lat] = degrees(x, y);
        format!(
            "<Trackpoint><Time>2026-05-01T10:{k:02}:00Z</Time><Position><LatitudeDegrees>{lat:.6}</LatitudeDegrees>\
             <LongitudeDegrees>{lon:.6}</LongitudeDegrees></Position><AltitudeMeters>{}</AltitudeMeters></Trackpoint>",
            900 + k
        )
    };
    let points: String = walk().into_iter().enumerate().map(one).collect();
    let text = format!(
        "<TrainingCenterDatabase><Activities><Activity Sport=\"Hiking\"><Lap><Track>{points}</Track></Lap></Activity></Activities></TrainingCenterDatabase>"
    );
    vec![text.into_bytes()]
}

/// Points by columns, and as well-known text.
pub fn csv() -> Vec<Vec<u8>> {
    let places: Vec<[String; 2]> = walk().iter().map(|p| degrees(p[0], p[1]).map(|n| format!("{n:.6}"))).collect();
    let rows: String =
        places.iter().map(|[lon, lat]| format!("\"Ort, {lon}\";{lat};{};905,5\n", lon.replace('.', ","))).collect();
    let texts: String = places.iter().map(|[lon, lat]| format!("\"POINT Z ({lon} {lat} 905)\",Ort\n")).collect();
    vec![format!("name;lat;lon;ele\n{rows}").into_bytes(), format!("WKT,name\n{texts}").into_bytes()]
}

fn positions(list: &[[f64; 2]], height: bool) -> String {
    let one = |p: &[f64; 2]| {
        let [lon, lat] = degrees(p[0], p[1]);
        if height { format!("[{lon:.6},{lat:.6},905.5]") } else { format!("[{lon:.6},{lat:.6}]") }
    };
    format!("[{}]", list.iter().map(one).collect::<Vec<_>>().join(","))
}

fn feature(kind: &str, coordinates: &str, name: &str) -> String {
    format!(
        r#"{{"type":"Feature","id":7,"properties":{{"name":"{name}","height":12.5,"levels":"3","natural":"water","x":null,"tags":["a",{{"b":1}}]}},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
    )
}

fn collection(features: &[String]) -> Vec<u8> {
    format!(r#"{{"type":"FeatureCollection","name":"seed","features":[{}]}}"#, features.join(",\n")).into_bytes()
}

/// Lines, one with heights, one of several parts; and a sequence.
pub fn geojson_lines() -> Vec<Vec<u8>> {
    let line = feature("LineString", &positions(&walk(), true), "Weg");
    let parts = format!("[{},{}]", positions(&walk()[..5], false), positions(&walk()[6..], false));
    let many = feature("MultiLineString", &parts, "W\u{fc}rm");
    let sequence = format!("\u{1e}{line}\n\u{1e}{many}\n").into_bytes();
    vec![collection(&[line, many]), sequence]
}

fn areas() -> Vec<String> {
    let ring = |half| positions(&square(280.0, 260.0, half), false);
    let holed = feature("Polygon", &format!("[{},{}]", ring(120.0), ring(40.0)), "See");
    let many = feature(
        "MultiPolygon",
        &format!("[[{}],[{}]]", ring(30.0), positions(&square(450.0, 400.0, 50.0), false)),
        "Wald",
    );
    vec![holed, many]
}

/// Areas with a hole and of two parts.
pub fn geojson_areas() -> Vec<Vec<u8>> {
    vec![collection(&areas())]
}

/// Points.
pub fn geojson_points() -> Vec<Vec<u8>> {
    let [lon, lat] = degrees(200.0, 300.0);
    let one = feature("Point", &format!("[{lon:.6},{lat:.6},905.5]"), "Ort");
    let many = feature("MultiPoint", &positions(&walk(), false), "Orte");
    vec![collection(std::slice::from_ref(&many)), collection(&[many, one])]
}

/// All kinds of geometry.
pub fn geojson_all() -> Vec<Vec<u8>> {
    [geojson_lines(), geojson_areas(), geojson_points()].concat()
}

fn le(ints: &[i32], floats: &[f64]) -> Vec<u8> {
    ints.iter().flat_map(|i| i.to_le_bytes()).chain(floats.iter().flat_map(|f| f.to_le_bytes())).collect()
}

fn shapefile(kind: i32, records: &[Vec<u8>]) -> Vec<u8> {
    let mut body = Vec::new();
    for (k, record) in records.iter().enumerate() {
        body.extend([k as i32 + 1, record.len() as i32 / 2].iter().flat_map(|v| v.to_be_bytes()));
        body.extend(record);
    }
    let mut out = vec![0u8; 100];
    out[..4].copy_from_slice(&9994i32.to_be_bytes());
    out[24..28].copy_from_slice(&((100 + body.len()) as i32 / 2).to_be_bytes());
    out[28..36].copy_from_slice(&le(&[1000, kind], &[]));
    [out, body].concat()
}

fn flat() -> Vec<f64> {
    walk().into_iter().flat_map(|[x, y]| [CORNER.x + x, CORNER.y + y]).collect()
}

/// Two lines, one of them in two parts.
pub fn shapefile_lines() -> Vec<u8> {
    let line = |parts: &[i32]| {
        let head = [&[parts.len() as i32, 12], parts].concat();
        [le(&[3], &[0.0; 4]), le(&head, &flat())].concat()
    };
    shapefile(3, &[line(&[0]), line(&[0, 6])])
}

/// Lines, and lines with heights.
pub fn shapefiles() -> Vec<Vec<u8>> {
    let heights: Vec<f64> = (0..14 + 14).map(|i| 900.0 + f64::from(i)).collect();
    let line = [le(&[13], &[0.0; 4]), le(&[1, 12, 0], &flat()), le(&[], &heights)].concat();
    vec![shapefile_lines(), shapefile(13, &[line, le(&[0], &[])])]
}

/// The table of [`shapefile_lines`].
pub fn dbf() -> Vec<u8> {
    let (records, fields) = (2u32, [("NAME", b'C', 10u8), ("H", b'N', 6)]);
    let size = 1 + fields.iter().map(|f| u16::from(f.2)).sum::<u16>();
    let mut out = vec![3, 126, 11, 26];
    out.extend(records.to_le_bytes());
    out.extend((32 + 32 * fields.len() as u16 + 1).to_le_bytes());
    out.extend(size.to_le_bytes());
    out.resize(32, 0);
    for (name, kind, length) in fields {
        let mut field = [0u8; 32];
        field[..name.len()].copy_from_slice(name.as_bytes());
        (field[11], field[16]) = (kind, length);
        out.extend(field);
    }
    out.push(13);
    out.extend(b" Weg        12.50");
    out.extend(b" Bach         -3 ");
    out.push(26);
    out
}

/// A package with a table of lines.
pub fn geopackages() -> Vec<Vec<u8>> {
    let line: Vec<Vertex> = flat().chunks(2).map(|p| Vertex { xy: [p[0], p[1]].into(), z: None }).collect();
    let way = |name: &str| VectorFeature {
        name: name.into(),
        properties: [("name".to_owned(), name.to_owned())].into(),
        style: None,
        geometry: Geometry::Lines(vec![line.clone()]),
    };
    let ways = FeatureTable { name: "ways".into(), features: vec![way("Weg"), way("Bach")] };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.gpkg");
    let system = CoordinateSystem::from_epsg(32632).expect("a system");
    write_geopackage(&path, &[ways], &system, false).expect("a package");
    vec![std::fs::read(path).expect("bytes")]
}
