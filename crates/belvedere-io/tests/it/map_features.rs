//! KML, KMZ, TCX and tables of text: made-up files with unusual values in every field, broken ones, and ones cut off anywhere.

use belvedere_core::WarningKind;
use belvedere_io::{Geometry, Loaded, Vectors, load_vectors};
use std::io::Write;
use std::path::Path;

fn load(name: &str, bytes: impl AsRef<[u8]>) -> Result<Loaded<Vectors>, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    load_vectors(&path).map_err(|e| e.to_string())
}

/// What a file holds: for each feature its name, the letter of its kind, and how many positions each of its parts has.
fn held(vectors: &Vectors) -> Vec<(&str, char, Vec<usize>)> {
    let of = |geometry: &Geometry| match geometry {
        Geometry::Points(points) => ('p', vec![points.len()]),
        Geometry::Lines(lines) => ('l', lines.iter().map(Vec::len).collect()),
        Geometry::Polygons(polygons) => ('a', polygons.iter().flatten().map(Vec::len).collect()),
    };
    let features = vectors.features.iter();
    features.map(|f| (f.name.as_str(), of(&f.geometry))).map(|(name, (kind, parts))| (name, kind, parts)).collect()
}

fn heights(vectors: &Vectors, feature: usize) -> Vec<Option<f64>> {
    vectors.features[feature].geometry.vertices().map(|v| v.z).collect()
}

fn said(loaded: &Loaded<Vectors>) -> String {
    loaded.warnings.iter().map(|w| w.text().to_owned()).collect::<Vec<_>>().join("\n")
}

/// Loads a file cut at each 1 % of its length; the number of features where it is read, which never falls, and what is said.
fn cut(name: &str, whole: &[u8], least_read: usize) -> Vec<Loaded<Vectors>> {
    let (mut read, mut before) = (Vec::new(), 0);
    for k in 0..100 {
        match load(name, &whole[..whole.len() * k / 100]) {
            Err(text) => assert!(before == 0 && text.lines().count() == 1 && text.contains(name), "{k} %: {text}"),
            Ok(loaded) => {
                let vertices = loaded.value.vertex_count();
                assert!(vertices >= before, "{k} %: {vertices} after {before}");
                before = vertices;
                read.push(loaded);
            }
        }
    }
    assert!(read.len() >= least_read, "{} of 100 are read", read.len());
    read
}

const KML: &str = r##"<?xml version="1.0" encoding="UTF-8"?>
<k:kml xmlns:k="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"><k:Document><k:name>Tour &amp; more</k:name>
<k:Schema name="s" id="s"><k:SimpleField name="rank" type="int"/></k:Schema>
<k:NetworkLink><k:Link><k:href>b.kml</k:href></k:Link></k:NetworkLink><k:GroundOverlay><k:name>old map</k:name></k:GroundOverlay>
<k:Folder><k:name>inner</k:name><k:Folder>
<k:Placemark><k:name><![CDATA[Peak <1>]]></k:name><k:description>high</k:description>
  <k:ExtendedData><k:Data name="ref"><k:displayName>no</k:displayName><k:value> 7 </k:value></k:Data>
  <k:SchemaData schemaUrl="#s"><k:SimpleData name="rank">3</k:SimpleData></k:SchemaData></k:ExtendedData>
  <k:Point><k:altitudeMode>absolute</k:altitudeMode><k:coordinates> 10.5,46.5,2000 </k:coordinates></k:Point></k:Placemark>
<k:Placemark><k:name>Way</k:name><k:LineString><k:tessellate>1</k:tessellate><k:coordinates>
  10.5,46.5,0 10.6, 46.6 ,0
	10.7 , 46.6,0 10.8,abc 10.8,46.7,0</k:coordinates></k:LineString></k:Placemark>
</k:Folder></k:Folder>
<k:Placemark><k:name>Lake</k:name><k:Polygon><k:altitudeMode>clampToGround</k:altitudeMode>
  <k:outerBoundaryIs><k:LinearRing><k:coordinates>10,46,5 11,46,5 11,47,5 10,47,5 10,46,5</k:coordinates></k:LinearRing></k:outerBoundaryIs>
  <k:innerBoundaryIs><k:LinearRing><k:coordinates>10.2,46.2 10.4,46.2 10.4,46.4 10.2,46.2</k:coordinates></k:LinearRing></k:innerBoundaryIs>
</k:Polygon></k:Placemark>
<k:Placemark><k:name>Several</k:name><k:MultiGeometry><k:Point><k:coordinates>10.1,46.1,7</k:coordinates></k:Point><k:MultiGeometry>
  <k:LineString><k:coordinates>10,46,1 10.1,46.1,2</k:coordinates></k:LineString>
  <k:LinearRing><k:coordinates>10,46 10.1,46 10.1,46.1</k:coordinates></k:LinearRing><k:Model/></k:MultiGeometry>
  <k:Point><k:coordinates>10.2,46.2,8</k:coordinates></k:Point></k:MultiGeometry></k:Placemark>
<k:Placemark><k:name>Run</k:name><gx:Track><altitudeMode>absolute</altitudeMode><when>2024-07-06T10:00:00Z</when><when>2024-07-06T10:01:00Z</when>
  <when>2024-07-06T10:02:00Z</when><gx:coord>10.5 46.5 900</gx:coord><gx:coord>10.501 46.5 901</gx:coord><gx:coord>10.502 46.501 902</gx:coord></gx:Track></k:Placemark>
<k:Placemark><k:name>nothing</k:name></k:Placemark>
</k:Document></k:kml>"##;

#[test]
fn kml_with_every_field_is_read() {
    let loaded = load("a.kml", KML).unwrap();
    let vectors = &loaded.value;
    assert_eq!((vectors.format, vectors.layer.as_str(), vectors.crs.epsg()), ("KML", "Tour & more", Some(4326)));
    assert_eq!(
        held(vectors),
        [
            ("Peak <1>", 'p', vec![1]),
            ("Way", 'l', vec![4]),
            ("Lake", 'a', vec![4, 3]),
            ("Several", 'p', vec![2]),
            ("Several", 'l', vec![2, 4]),
            ("Run", 'l', vec![3]),
        ]
    );
    let properties: Vec<String> = vectors.features[0].properties.iter().map(|(k, v)| format!("{k}={v}")).collect();
    assert_eq!(properties, ["description=high", "name=Peak <1>", "rank=3", "ref=7"]);
    assert_eq!((heights(vectors, 0), heights(vectors, 3)), (vec![Some(2000.0)], vec![Some(7.0), Some(8.0)]));
    assert!(heights(vectors, 1).iter().chain(&heights(vectors, 2)).all(Option::is_none), "heights that do not count");
    assert_eq!(heights(vectors, 5), [Some(900.0), Some(901.0), Some(902.0)]);
    for text in [
        "1 links to other files were not followed",
        "1 pictures over the map were left out",
        "1 models were left out",
        "1 positions that are no longitude and latitude",
        "1 features without geometry",
    ] {
        assert!(said(&loaded).contains(text), "{text}: {}", said(&loaded));
    }
    assert_eq!(loaded.warnings.len(), 5);
    let times = belvedere_io::vector::track_times(KML).unwrap();
    assert_eq!((times.len(), times[2].1 - times[0].1), (3, 120.0));
    // The content tells the format, whatever the name, the prefix and the encoding.
    let bare = KML.replace("k:", "").replace(" xmlns:k=", " xmlns=");
    assert_eq!(held(&load("data", &bare).unwrap().value), held(vectors));
    let wide: Vec<u8> = bare.replace("UTF-8", "UTF-16").encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(held(&load("a.dat", &wide).unwrap().value), held(vectors));
}

#[test]
fn kml_that_is_cut_off_is_read_up_to_there() {
    let mut count = 0;
    for loaded in cut("a.kml", KML.as_bytes(), 60) {
        assert!(said(&loaded).contains("what is whole before is drawn"), "{}", said(&loaded));
        let all = held(&loaded.value);
        count = count.max(all.len());
        // Areas are whole, or not there.
        assert!(all.iter().all(|(_, kind, parts)| *kind != 'a' || *parts == [4, 3]));
        assert!(
            loaded.value.features.iter().flat_map(|f| f.geometry.vertices()).all(|v| v.xy.x >= 10.0 && v.xy.y >= 46.0)
        );
    }
    assert_eq!(count, 6);
}

#[test]
fn kml_without_features_is_one_error() {
    for (text, want) in [
        ("<kml><Document/></kml>", "KML holds 0 placemarks, but no usable geometry"),
        ("<kml><NetworkLink/></kml>", "0 placemarks, 1 links to other files, but no usable"),
        ("<kml><Placemark><Point><coordinates>200,95</coordinates></Point></Placemark></kml>", "1 placemarks"),
        ("<kml><Placemark><Point>", "ends inside <Point>; the file is cut off, get it again"),
        ("<x:kmls/>", "root <kmls>"),
    ] {
        let error = load("a.kml", text).map(|l| l.value.features.len()).unwrap_err();
        assert!(error.contains(want), "{error}");
    }
    let deep = format!("<kml>{}", "<Folder>".repeat(5000));
    assert!(load("a.kml", deep).unwrap_err().contains("deeper than"));
}

fn zipped(entries: &[(&str, &str)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, content) in entries {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(content.as_bytes()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn the_document_of_a_kmz_is_read() {
    let other = "<kml><Placemark><Point><coordinates>1,2</coordinates></Point></Placemark></kml>";
    for name in ["a.kmz", "a.dat", "a.zip"] {
        let packed = zipped(&[("files/b.kml", other), ("files/icon.png", "?"), ("doc.kml", KML)]);
        assert_eq!(load(name, &packed).unwrap().value.features.len(), 6, "{name}");
        assert_eq!(load(name, zipped(&[("tour.kml", other)])).unwrap().value.features.len(), 1, "{name}");
    }
    let error = load("a.kmz", zipped(&[("a.kml", other), ("b.kml", other)])).unwrap_err();
    assert!(error.contains("2 files of this kind"), "{error}");
    // Links to other documents of the archive are followed, once, and no others.
    let link = |to: &str| format!("<kml><NetworkLink><Link><href>{to}</href></Link></NetworkLink></kml>");
    let doc = format!("{}{}", link("in/b.kml").replace("</kml>", ""), link("../../etc/x.kml").replace("<kml>", ""));
    let back = format!("{}{}", other.replace("</kml>", ""), link("../doc.kml").replace("<kml>", ""));
    let loaded = load("a.kmz", zipped(&[("doc.kml", &doc), ("in/b.kml", &back)])).unwrap();
    assert_eq!((loaded.value.features.len(), loaded.files.len()), (1, 2));
    assert!(said(&loaded).contains("2 links to other files were not followed"), "{}", said(&loaded));
    let whole = zipped(&[("doc.kml", KML)]);
    for k in 0..100 {
        let error = load("a.kmz", &whole[..whole.len() * k / 100]).map(|l| l.value.features.len()).unwrap_err();
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}

fn trackpoint(k: usize, place: bool) -> String {
    let position = format!(
        "<Position><LatitudeDegrees>{}</LatitudeDegrees><LongitudeDegrees>{}</LongitudeDegrees></Position>",
        46.5 + 0.0001 * k as f64,
        10.5 + 0.0001 * k as f64
    );
    let position = if place { position } else { String::new() };
    let watch = "<Extensions><ns3:TPX><ns3:Speed>1.5</ns3:Speed></ns3:TPX></Extensions>";
    format!(
        "<Trackpoint><Time>2024-07-06T10:{:02}:{:02}Z</Time>{position}<AltitudeMeters>{}</AltitudeMeters>{watch}</Trackpoint>\n",
        k / 60,
        k % 60,
        900 + k
    )
}

fn tcx() -> String {
    let lap = |from: usize, to: usize| {
        let points: String = (from..to).map(|k| trackpoint(k, k % 10 != 3)).collect();
        format!("<Lap StartTime='x'><Track>{points}</Track></Lap>")
    };
    let course: String = (0..5).map(|k| trackpoint(k, true)).collect();
    let place = trackpoint(2, true).replace("Trackpoint", "CoursePoint");
    let place = place.replacen("<Time>", "<Name>Hut</Name><PointType>Food</PointType><Time>", 1);
    format!(
        "<?xml version='1.0'?><TrainingCenterDatabase xmlns='x' xmlns:ns3='y'><Folders/><Activities><Activity Sport='Running'><Id>7</Id>{}{}\
         <Lap StartTime='x'><Track>{}</Track></Lap></Activity></Activities><Courses><Course><Name>Round</Name><Track>{course}</Track>{place}\
         </Course></Courses></TrainingCenterDatabase>",
        lap(0, 40),
        lap(40, 80),
        trackpoint(81, false)
    )
}

#[test]
fn tcx_with_laps_and_courses_is_read() {
    let loaded = load("a.tcx", tcx()).unwrap();
    let vectors = &loaded.value;
    assert_eq!((vectors.format, vectors.crs.epsg()), ("TCX", Some(4326)));
    assert_eq!(held(vectors), [("", 'l', vec![36, 36]), ("Hut", 'p', vec![1]), ("Round", 'l', vec![5])]);
    assert_eq!(vectors.features[0].properties["sport"], "Running");
    assert_eq!((vectors.features[0].properties["kind"].as_str(), heights(vectors, 2)[1]), ("track", Some(901.0)));
    assert_eq!(vectors.features[1].properties["pointtype"], "Food");
    assert_eq!(loaded.warnings.len(), 1);
    assert!(said(&loaded).contains("9 points without a position"), "{}", said(&loaded));
    let times = belvedere_io::vector::track_times(&tcx()).unwrap();
    assert_eq!((times.len(), times[71].1 - times[0].1), (77, 79.0));
    assert_eq!(held(&load("watch", tcx()).unwrap().value), held(vectors));
}

#[test]
fn tcx_that_is_cut_off_is_read_up_to_there() {
    for loaded in cut("a.tcx", tcx().as_bytes(), 90) {
        assert!(said(&loaded).contains("what is whole before is drawn"), "{}", said(&loaded));
    }
    let indoors = "<TrainingCenterDatabase><Activities><Activity><Lap><Track><Trackpoint/></Track></Lap></Activity></Activities></TrainingCenterDatabase>";
    let error = load("a.tcx", indoors).unwrap_err();
    assert!(error.contains("1 activities and 0 courses with 1 points without a position"), "{error}");
}

#[test]
fn tables_are_read_by_the_names_of_their_columns() {
    for (name, text, places) in [
        ("a.csv", "name,lat,lon,ele\nHut,46.5,10.5,2000\n\"Peak, \"\"high\"\"\",46.6,10.6,\n", 2),
        ("a.csv", "\u{feff}Name;Länge;Longitude;Latitude;Höhe\r\nHut;x;10,5;46,5;2000,0\r\nSee;;10,6;46,6;\r\n", 2),
        ("a.tsv", "Lng\tLAT\tlabel\n10.5\t46.5\tHut\n\n10.6\t46.6\tSee\n", 2),
        ("a", "id|name|decimalLongitude|decimalLatitude\n1|Hut|10.5|46.5", 1),
    ] {
        let loaded = load(name, text).unwrap();
        let vectors = &loaded.value;
        assert_eq!((vectors.format, vectors.crs.epsg(), vectors.crs_stated), ("CSV", Some(4326), true), "{text}");
        assert_eq!((vectors.features.len(), vectors.features[0].name.as_str()), (places, "Hut"), "{text}");
        let first = vectors.features[0].geometry.vertices().next().unwrap();
        assert_eq!((first.xy.x, first.xy.y), (10.5, 46.5), "{text}");
        assert_eq!(loaded.warnings, [], "{text}");
    }
    let loaded = load("a.csv", "name,lat,lon,ele\nHut,46.5,10.5,2000\n\"Peak, \"\"high\"\"\",46.6,10.6,\n").unwrap();
    assert_eq!(loaded.value.features[1].name, "Peak, \"high\"");
    assert_eq!((heights(&loaded.value, 0), heights(&loaded.value, 1)), (vec![Some(2000.0)], vec![None]));
    // Latin letters of old programs.
    let latin: Vec<u8> = "name;lon;lat\nHütte;10;46\n".chars().map(|c| c as u8).collect();
    assert_eq!(load("a.csv", latin).unwrap().value.features[0].name, "Hütte");
}

#[test]
fn rows_without_coordinates_are_counted() {
    let loaded = load("a.csv", "lon,lat,name\n10,46,a\n,,b\nunknown,46,c\n10\n11,47,d\n").unwrap();
    assert_eq!(loaded.value.features.len(), 2);
    assert!(said(&loaded).contains("3 of 5 rows were dropped") && said(&loaded).contains("\"lon\" and \"lat\""));
    for (text, want) in [
        ("a,b,c\n1,2,3\n", "has no columns of coordinates in its first line (\"a\", \"b\", \"c\"); name them lon"),
        ("lon,lat\n", "CSV holds 0 rows, but no usable geometry"),
        ("lon,lat\nx,y\n", "none of its 1 rows has coordinates in the columns \"lon\" and \"lat\""),
        ("lon,lat\n2600000,1200000\n", "is no longitude and latitude"),
        ("wkt,name\nCIRCULARSTRING (1 2, 3 4, 5 6),a\n", "in the column \"wkt\""),
        ("wkt\nSRID=4326;POINT (1 2)\nSRID=32632;POINT (1 2)\n", "in several systems, SRID 4326, 32632"),
    ] {
        let error = load("a.csv", text).map(|l| l.value.features.len()).unwrap_err();
        assert!(error.contains(want), "{error}");
    }
    let error = load("a.txt", "quite,unlike\n1,2\n").unwrap_err();
    assert!(error.contains("is ESRI ASCII") || error.contains("not routes"), "{error}");
}

#[test]
fn projected_tables_take_their_system_from_beside() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.csv");
    std::fs::write(&path, "Easting;Northing;Name\n500000,5;5150000;a\n").unwrap();
    let read = |path: &Path| load_vectors(path).unwrap().value;
    let vectors = read(&path);
    assert!(vectors.crs.is_local() && !vectors.crs_stated);
    let terrain = belvedere_scene::Crs::Epsg(32632);
    let error = belvedere_io::points_on_terrain(&vectors, terrain, None).unwrap_err().to_string();
    assert!(error.contains("not stated"), "{error}");
    std::fs::write(dir.path().join("a.prj"), "EPSG:32632").unwrap();
    let vectors = read(&path);
    assert_eq!((vectors.crs.epsg(), vectors.crs_stated), (Some(32632), true));
    assert_eq!(vectors.features[0].geometry.vertices().next().unwrap().xy.x, 500_000.5);
    let degrees = load("a.csv", "x,y\n10,46\n").unwrap();
    assert_eq!(degrees.value.crs.epsg(), Some(4326));
    assert_eq!(degrees.warnings[0].kind(), WarningKind::Assumed);
}

#[test]
fn well_known_text_in_a_column_is_read() {
    let rows = [
        ("POINT (10 46)", "p 1"),
        ("point z(10 46 5)", "p 1"),
        ("POINTZ (10 46 5)", "p 1"),
        ("MULTIPOINT ((10 46), (11 47))", "p 2"),
        ("MULTIPOINT (10 46, 11 47)", "p 2"),
        ("LINESTRING M (10 46 9, 11 47 9)", "l 2"),
        ("MULTILINESTRING ((10 46, 11 47), (10 46, 10 47, 11 47))", "l 2 3"),
        ("POLYGON((10 46, 11 46, 11 47, 10 46), (10.5 46.1, 10.6 46.1, 10.6 46.2, 10.5 46.1))", "a 3 3"),
        ("MULTIPOLYGON (((10 46, 11 46, 11 47, 10 46)), EMPTY, ((10 46, 11 46, 11 47, 10 46)))", "a 3 3"),
    ];
    let table: String = rows.iter().map(|(wkt, _)| format!("\"{wkt}\",x\n")).collect();
    let table = format!(
        "WKT,name\n{table}\"GEOMETRYCOLLECTION (POINT (10 46), LINESTRING (10 46, 11 47))\",x\nPOINT EMPTY,x\nPOINT (1),x\n"
    );
    let loaded = load("a.csv", &table).unwrap();
    let found = held(&loaded.value).into_iter();
    let found: Vec<String> = found
        .map(|(_, kind, parts)| parts.iter().fold(kind.to_string(), |text, part| format!("{text} {part}")))
        .collect();
    let want: Vec<&str> = rows.iter().map(|(_, want)| *want).chain(["p 1", "l 2"]).collect();
    assert_eq!(found, want);
    assert_eq!((heights(&loaded.value, 1), heights(&loaded.value, 5)), (vec![Some(5.0)], vec![None, None]));
    assert!(
        said(&loaded).contains("1 of 12 rows were dropped") && said(&loaded).contains("1 features without geometry")
    );
    let deep = format!("wkt,a\n\"{}\",b\n", "GEOMETRYCOLLECTION (".repeat(100_000));
    assert!(load("a.csv", deep).is_err());
    let system = load("a.csv", "wkt;a\nSRID=32632;POINT (500000 5150000)\n").unwrap_err();
    assert!(system.contains("rows"), "a sign between fields parts it: {system}");
    let system = load("a.csv", "wkt,a\nSRID=32632;POINT (500000 5150000),b\n").unwrap().value;
    assert_eq!((system.crs.epsg(), system.crs_stated), (Some(32632), true));
}

#[test]
fn tables_that_are_cut_off_are_read_up_to_there() {
    let rows: String =
        (0..200).map(|k| format!("\"Place {k}\",{:.4},{:.4},x\n", 10.0 + 0.01 * f64::from(k), 46.0)).collect();
    cut("a.csv", format!("name,lon,lat,last\n{rows}").as_bytes(), 97);
}
