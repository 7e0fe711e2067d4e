//! Kinds of files that strangers bring, in variants that are drawn by seed: sizes, orders, spellings, encodings, packings.

use crate::support_files::Folder;
use belvedere_io::{Geometry, Limits, TerrainRequest, load_mesh, load_terrain, load_vectors, readable};
use belvedere_scene::Progress;
use belvedere_testkit::Random;
use glam::DVec2;
use std::io::Write;
use std::path::PathBuf;

const VARIANTS: u64 = 40;

fn pick<T: Copy>(random: &mut Random, list: &[T]) -> T {
    list[random.below(list.len())]
}

/// A walk of some positions, longitudes and latitudes.
fn walk(random: &mut Random) -> Vec<DVec2> {
    let n = 12 + random.below(60);
    let mut at = DVec2::new(random.range(-170.0, 170.0), random.range(-70.0, 70.0));
    let heading = random.range(0.0, std::f64::consts::TAU);
    let step = random.range(0.0001, 0.001);
    let turns: Vec<f64> = (0..n).map(|_| heading + random.range(-0.8, 0.8)).collect();
    turns
        .into_iter()
        .map(|turn| {
            at += step * DVec2::from_angle(turn);
            at
        })
        .collect()
}

/// Text in one of the encodings that a reader must tell by itself.
fn encoded(random: &mut Random, text: &str) -> Vec<u8> {
    let units = || text.encode_utf16();
    match random.below(7) {
        0 => [b"\xef\xbb\xbf", text.as_bytes()].concat(),
        1 => [0xff, 0xfe].into_iter().chain(units().flat_map(u16::to_le_bytes)).collect(),
        2 => [0xfe, 0xff].into_iter().chain(units().flat_map(u16::to_be_bytes)).collect(),
        3 => units().flat_map(u16::to_le_bytes).collect(),
        4 => units().flat_map(u16::to_be_bytes).collect(),
        5 => [0xff, 0xfe, 0, 0].into_iter().chain(text.chars().flat_map(|c| u32::from(c).to_le_bytes())).collect(),
        _ => text.as_bytes().to_vec(),
    }
}

/// Packed, or as it is.
fn packed(random: &mut Random, name: &str, bytes: Vec<u8>) -> (String, Vec<u8>) {
    let gzip = |bytes: &[u8]| {
        let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        out.write_all(bytes).expect("packed");
        out.finish().expect("packed")
    };
    let zip = |entries: &[(String, &[u8])], stored: bool| {
        let method = if stored { zip::CompressionMethod::Stored } else { zip::CompressionMethod::Deflated };
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        let mut out = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for (name, bytes) in entries {
            out.start_file(name.as_str(), options).expect("begun");
            out.write_all(bytes).expect("packed");
        }
        out.finish().expect("packed").into_inner()
    };
    match random.below(7) {
        0 => (format!("{name}.gz"), gzip(&bytes)),
        1 => (name.to_owned(), gzip(&bytes)),
        2 => ("no_ending".into(), gzip(&bytes)),
        3 => ("data.zip".into(), zip(&[(name.to_owned(), &bytes)], random.below(2) == 0)),
        4 => {
            let entries = [
                (format!("__MACOSX/._{name}"), &b"x"[..]),
                (format!("a b/{name}"), &bytes),
                ("a b/map.png".into(), b"x"),
            ];
            ("Data.ZIP".into(), zip(&entries, false))
        }
        5 => {
            let inner = zip(&[(name.to_owned(), &bytes)], false);
            ("outer.zip".into(), zip(&[("inner.zip".into(), &inner)], true))
        }
        _ => (name.to_owned(), bytes),
    }
}

#[test]
fn tracks_in_many_spellings() {
    let folder = Folder::new();
    for seed in 0..VARIANTS {
        let random = &mut Random::new(seed);
        let way = walk(random);
        let comma = random.below(3) == 0;
        let number = |v: f64| if comma { format!("{v:.6}").replace('.', ",") } else { format!("{v:.6}") };
        let (lat, lon) = pick(random, &[("lat", "lon"), ("LAT", "LON"), ("Lat", "Lon")]);
        let point = |p: &DVec2| format!("<trkpt {lon}='{}' {lat}='{}'><ele>12</ele></trkpt>", number(p.x), number(p.y));
        let points: Vec<String> = way.iter().map(point).collect();
        let (body, many) = match random.below(5) {
            0 => (format!("<trk><name>Tälchen</name><trkseg>{}</trkseg></trk>", points.concat()), false),
            1 => (format!("<trk><name>Tälchen</name>{}</trk>", points.concat()), false),
            2 => {
                let segments: String = points.iter().map(|p| format!("<trkseg>{p}</trkseg>")).collect();
                (format!("<trk><name>Tälchen</name>{segments}</trk>"), true)
            }
            3 => {
                let track = |p: &String| format!("<trk><name>Tälchen</name><trkseg>{p}</trkseg></trk>");
                (points.iter().map(track).collect(), true)
            }
            _ => {
                let route = |p: &String| format!("<rte><name>Tälchen</name>{}</rte>", p.replace("trkpt", "rtept"));
                (points.iter().map(route).collect(), true)
            }
        };
        let mut text = format!("<?xml version=\"1.0\"?><gpx version=\"1.1\">{body}</gpx>");
        if random.below(2) == 0 {
            text = text.replace("><", ">\r\n\t<");
        }
        let bytes = encoded(random, &text);
        let name = pick(random, &["way.gpx", "Way.GPX"]);
        let (name, bytes) = packed(random, name, bytes);
        let path = folder.file(&name, &bytes);
        let loaded = load_vectors(&path).unwrap_or_else(|e| panic!("seed {seed}, {name}: {e}"));
        let features = &loaded.value.features;
        assert_eq!((features.len(), features[0].name.as_str()), (1, "Tälchen"), "seed {seed}, {name}");
        let found: Vec<DVec2> = features[0].geometry.vertices().map(|v| v.xy).collect();
        assert_eq!(found.len(), way.len(), "seed {seed}, {name}: {:?}", loaded.warnings);
        assert!(found.iter().zip(&way).all(|(a, b)| a.distance(*b) < 1e-6), "seed {seed}");
        assert_eq!(
            loaded.warnings.iter().any(|w| w.text().contains("were joined")),
            many,
            "seed {seed}: {:?}",
            loaded.warnings
        );
    }
}

/// Phantom positions among those of a walk, in tracks and in lines of other formats.
#[test]
fn phantom_positions_split_what_they_interrupt() {
    let folder = Folder::new();
    for seed in 0..VARIANTS {
        let random = &mut Random::new(seed);
        let way: Vec<DVec2> = walk(random);
        let middle = 4 + random.below(way.len() - 8);
        let odd = match random.below(3) {
            0 => DVec2::ZERO,
            1 => way[middle] + DVec2::new(0.7, 0.4),
            _ => DVec2::new(way[middle].x, 0.0),
        };
        let count = 1 + random.below(3);
        let mut places = way.clone();
        places[middle..middle + count].fill(odd);
        let is_gpx = random.below(2) == 0;
        let text = if is_gpx {
            let points: String = places.iter().map(|p| format!("<trkpt lat='{}' lon='{}'/>", p.y, p.x)).collect();
            format!("<gpx><trk><trkseg>{points}</trkseg></trk></gpx>")
        } else {
            let points: Vec<String> = places.iter().map(|p| format!("[{},{}]", p.x, p.y)).collect();
            format!(r#"{{"type":"LineString","coordinates":[{}]}}"#, points.join(","))
        };
        let path = folder.file(if is_gpx { "a.gpx" } else { "a.geojson" }, text.as_bytes());
        let loaded = load_vectors(&path).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        let lines: Vec<usize> = loaded
            .value
            .features
            .iter()
            .flat_map(|f| match &f.geometry {
                Geometry::Lines(lines) => lines.iter().map(Vec::len).collect(),
                _ => Vec::new(),
            })
            .collect();
        let kept: usize = lines.iter().sum();
        let long = |a: &Vec<DVec2>| a.windows(2).map(|w| w[0].distance(w[1])).fold(0.0, f64::max);
        assert!(kept >= way.len() - count && lines.len() >= 2, "seed {seed}: {lines:?}");
        let vertices = || loaded.value.features.iter().flat_map(|f| f.geometry.vertices());
        let near = vertices().filter(|v| v.xy.distance(way[middle]) < long(&way) * way.len() as f64).count();
        assert!(near >= way.len() - count, "seed {seed}: {near}");
        let said = loaded.warnings.iter().map(|w| w.text()).collect::<Vec<_>>().join("\n");
        assert!(said.contains("split"), "seed {seed}: {said}");
    }
}

#[test]
fn geojson_with_odd_members() {
    let folder = Folder::new();
    for seed in 0..VARIANTS {
        let random = &mut Random::new(seed);
        let way = walk(random);
        let quoted = random.below(3) == 0;
        let z = pick(random, &["", ",5", ",5,7.5", ",null"]);
        let position = |p: &DVec2| {
            if quoted { format!("[\"{}\",\"{}\"{z}]", p.x, p.y) } else { format!("[{},{}{z}]", p.x, p.y) }
        };
        let points: Vec<String> = way.iter().map(position).collect();
        let odd = pick(random, &["\"h\":NaN,", "\"h\":-Infinity,\"t\":\"NaN, \\\"Infinity\\\"\",", "\"h\":null,", ""]);
        let field =
            pick(random, &["name", "NAME", "Naam", "name:en", "NAMN1", "naam_nl", "NAZ_OBJ", "Название", "名称"]);
        let feature = format!(
            r#"{{"type":"Feature","properties":{{"id":7,{odd}"file_name":"x","{field}":"Way {seed}"}},"geometry":{{"type":"LineString","coordinates":[{}]}}}}"#,
            points.join(",")
        );
        let nothing = pick(
            random,
            &[
                r#"{"type":"Feature","properties":null,"geometry":null}"#,
                r#"{"type":"Feature","properties":{},"geometry":{}}"#,
                r#"{"type":"Feature","properties":{}}"#,
                r#"{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[]}}"#,
            ],
        );
        let list = [nothing, feature.as_str(), nothing];
        let text = match random.below(5) {
            0 => format!(r#"{{"type":"FeatureCollection","crs":null,"features":[{}]}}"#, list.join(",")),
            1 => list.join("\n"),
            2 => list.iter().map(|f| format!("\u{1e}{f}\r\n")).collect(),
            3 => format!("\n\n{}\n\n", list.join("\n\n")),
            _ => format!("[{}]", list.join(",")),
        };
        let bytes = encoded(random, &text);
        let ending = pick(random, &["geojson", "geojsonl", "GeoJSON", "ndjson", "json"]);
        let (name, bytes) = packed(random, &format!("way.{ending}"), bytes);
        let path = folder.file(&name, &bytes);
        let loaded = load_vectors(&path).unwrap_or_else(|e| panic!("seed {seed}, {name}: {e}\n{text}"));
        let features = &loaded.value.features;
        assert_eq!((features.len(), features[0].name.clone()), (1, format!("Way {seed}")), "seed {seed}, {field}");
        assert_eq!(features[0].geometry.vertices().count(), way.len(), "seed {seed}");
        assert!(
            loaded.warnings.iter().any(|w| w.text().contains("2 features without geometry")),
            "{:?}",
            loaded.warnings
        );
    }
}

#[test]
fn grids_in_many_spellings() {
    let folder = Folder::new();
    for seed in 0..VARIANTS {
        let random = &mut Random::new(seed);
        let (cols, rows) = (5 + random.below(20), 5 + random.below(20));
        let base = random.range(100.0, 2000.0);
        let heights: Vec<f64> = (0..cols * rows).map(|_| base + random.range(0.0, 300.0)).collect();
        let style = random.below(6);
        let thousands = |v: f64| {
            let text = format!("{v:.2}");
            let (whole, part) = text.split_once('.').expect("two");
            let groups: Vec<&str> =
                whole.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).expect("digits")).collect();
            format!("{}.{part}", groups.join(","))
        };
        let number = |v: f64| match style {
            1 => format!("{v:.2}").replace('.', ","),
            2 => thousands(v),
            3 => thousands(v).replace('.', ";").replace(',', ".").replace(';', ","),
            4 => format!("{v:.8e}").replace('.', ","),
            _ => format!("{v:.2}"),
        };
        let gap = match style {
            5 => pick(random, &[",", ", ", ";"]),
            1 => pick(random, &[" ", "\t", ";"]),
            _ => pick(random, &[" ", "\t", "  "]),
        };
        let void = pick(random, &["-9999", "-32768", "32767", "9999", "-88888", "nan", "1.#QNAN", "NA", "1e30"]);
        let voids: Vec<usize> = (0..heights.len()).filter(|k| k % 11 == 3).collect();
        let end = pick(random, &["\n", "\r\n"]);
        let mut head = vec![
            format!("ncols {cols}"),
            format!("nrows {rows}"),
            format!("xllcorner {}", number(680_000.0)),
            format!("yllcorner {}", number(5_196_000.0)),
            format!("cellsize {}", number(25.0)),
        ];
        if random.below(2) == 0 {
            head.swap(0, 4);
            head.iter_mut().for_each(|l| *l = l.to_uppercase());
        }
        let row = |r: usize| -> String {
            let word = |k: usize| if voids.contains(&k) { void.to_owned() } else { number(heights[k]) };
            (r * cols..(r + 1) * cols).map(word).collect::<Vec<_>>().join(gap)
        };
        let text = head.into_iter().chain((0..rows).map(row)).map(|l| l + end).collect::<String>();
        let bytes = encoded(random, &text);
        let (name, bytes) =
            packed(random, pick(&mut Random::new(seed + 99), &["dem.asc", "DEM.ASC", "dem.grd"]), bytes);
        let path = folder.file(&name, &bytes);
        let loaded = load_terrain(&[path], &TerrainRequest::default(), &Progress::silent()).unwrap_or_else(|e| {
            panic!("seed {seed}, {name}, style {style}, {void}: {e}\n{}", &text[..200.min(text.len())])
        });
        let terrain = &loaded.value;
        assert_eq!(terrain.void_samples, voids.len(), "seed {seed}, {void}, style {style}: {:?}", loaded.warnings);
        let known = || heights.iter().enumerate().filter(|(k, _)| !voids.contains(k)).map(|(_, h)| *h);
        let [low, high] = terrain.heightfield.z_range();
        let want = [known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max)];
        assert!(
            (f64::from(low as f32) - want[0]).abs() < 0.02 && (f64::from(high as f32) - want[1]).abs() < 0.02,
            "seed {seed}: {low} {high} {want:?}"
        );
    }
}

/// The same place by an old text of ARC/INFO, a PROJ string, a code, well-known text in two bytes; beside files in capital letters.
#[test]
fn systems_beside_a_grid_are_found_and_understood() {
    let folder = Folder::new();
    let wkt = r#"PROJCS["WGS_1984_UTM_Zone_32N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["Central_Meridian",9.0],PARAMETER["Scale_Factor",0.9996],UNIT["Meter",1.0]]"#;
    let arc = "Projection    UTM\r\nZone          32\r\nDatum         WGS84\r\nZunits        NO\r\nUnits         METERS\r\nSpheroid      WGS84\r\nXshift        0.0\r\nYshift        0.0\r\nParameters\r\n";
    let proj = "+proj=utm +zone=32 +datum=WGS84 +units=m +no_defs";
    let grid = "ncols 3\nnrows 3\nxllcorner 680000\nyllcorner 5196000\ncellsize 60\n1 2 3\n4 5 6\n7 8 9\n";
    for (k, text) in [wkt, arc, proj, "EPSG:32632", "urn:ogc:def:crs:EPSG::32632"].into_iter().enumerate() {
        for (j, ending) in ["prj", "PRJ", "Prj", "asc.prj"].into_iter().enumerate() {
            let random = &mut Random::new((10 * k + j) as u64);
            let stem = format!("dem{k}{j}");
            folder.file(&format!("{stem}.{ending}"), &encoded(random, text));
            let path = folder.file(&format!("{stem}.asc"), grid.as_bytes());
            let loaded = load_terrain(&[path], &TerrainRequest::default(), &Progress::silent());
            let loaded = loaded.unwrap_or_else(|e| panic!("{ending}, {text}: {e}"));
            let [west, south, ..] = loaded.value.extent_deg.unwrap_or_else(|| panic!("{ending}: {text}"));
            assert!((west - 11.363_37).abs() < 1e-4 && (south - 46.893_37).abs() < 1e-4, "{west} {south}: {text}");
        }
    }
    folder.file("none.prj", b" \r\n");
    let path = folder.file("none.asc", grid.as_bytes());
    assert_eq!(load_terrain(&[path], &TerrainRequest::default(), &Progress::silent()).unwrap().value.extent_deg, None);
}

/// Materials under every spelling of their file's name, colours of some vertices, headers of old and foreign programs.
#[test]
fn meshes_in_many_spellings() {
    let folder = Folder::new();
    folder.file("a b.mtl", b"newmtl r\nKd 1 0 0\n");
    folder.file("T\u{fc}r.mtl", b"newmtl r\nKd 1 0 0\n");
    let red = belvedere_scene::MeshColors::PerTriangle(vec![belvedere_scene::Color::rgb(255, 0, 0)]);
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let names =
        ["a b.mtl", "\"a b.mtl\"", "a%20b.mtl", ".\\a b.mtl", "C:\\models\\T\u{fc}r.mtl", "gone.mtl T\u{fc}r.mtl"];
    for (seed, name) in names.into_iter().enumerate() {
        let random = &mut Random::new(seed as u64);
        let end = pick(random, &["\n", "\r\n", "\r"]);
        let text = format!("mtllib {name}\nusemtl r\n{points}f 1 2 3\n").replace('\n', end);
        for bytes in [encoded(random, &text), encoded(random, &text)] {
            let found =
                load_mesh(&folder.file("a.obj", &bytes), &Limits::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!((found.value.triangles.len(), &found.value.colors), (1, &red), "{name}: {:?}", found.warnings);
            assert_eq!(found.files.len(), 2, "{name}");
        }
    }
    let some = format!("{}f 1 2 3\n", points.replace("v 1 0 0", "v 1 0 0 1 0 0"));
    assert_eq!(load_mesh(&folder.file("c.obj", some.as_bytes()), &Limits::default()).unwrap().value.triangles.len(), 1);
    let ply = "ply\nformat ascii 1.0\ncomment T\u{fc}r\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let latin: Vec<u8> = ply.chars().map(|c| c as u8).collect();
    let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(ply.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    for bytes in [latin, wide, ply.replace('\n', "\r").into_bytes(), ply.replace('\n', "\r\n").into_bytes()] {
        let found = load_mesh(&folder.file("a.ply", &bytes), &Limits::default());
        let found = found.unwrap_or_else(|e| panic!("{}: {e}", String::from_utf8_lossy(&bytes)));
        assert_eq!(found.value.triangles, [[0, 1, 2]]);
    }
}

#[test]
fn swapped_axes_are_named() {
    let folder = Folder::new();
    let grid = "ncols 3\nnrows 3\nxllcorner 11.35\nyllcorner 46.87\ncellsize 0.05\n1 2 3\n4 5 6\n7 8 9\n";
    let path = folder.file("dem.asc", grid.as_bytes());
    let ground = load_terrain(&[path], &TerrainRequest::default(), &Progress::silent()).unwrap().value;
    for (points, swapped) in [("[46.93,11.41],[46.94,11.42]", true), ("[7.93,11.41],[7.94,11.42]", false)] {
        let text = format!(r#"{{"type":"LineString","coordinates":[{points}]}}"#);
        let vectors = load_vectors(&folder.file("way.geojson", text.as_bytes())).unwrap().value;
        let error = belvedere_io::lines_on_terrain(&vectors, ground.crs, Some(&ground.heightfield)).unwrap_err();
        assert_eq!(error.to_string().contains("axes are swapped"), swapped, "{error}");
    }
}

#[test]
fn names_come_from_the_property_that_is_asked_for() {
    let folder = Folder::new();
    let text = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a","PEAK":"Alp"},"geometry":{"type":"Point","coordinates":[11,46]}},{"type":"Feature","properties":{"name":"b"},"geometry":{"type":"Point","coordinates":[11,46]}}]}"#;
    let mut vectors = load_vectors(&folder.file("p.geojson", text.as_bytes())).unwrap().value;
    for field in ["PEAK", "peak"] {
        vectors.name_by(field).unwrap();
        assert_eq!(vectors.features.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["Alp", ""]);
    }
    let error = vectors.name_by("summit").unwrap_err();
    assert!(error.contains("\"summit\"") && error.contains("PEAK, name"), "{error}");
}

/// Ground of other bodies is drawn in a local scene, and features in its plane lie on it.
#[test]
fn other_bodies_are_local() {
    let folder = Folder::new();
    for (name, axis) in [("Mars_2000", 3_396_190.0), ("Moon_2000", 1_737_400.0), ("Titan", 2_575_000.0)] {
        let prj = format!(
            r#"PROJCS["Equirectangular {name}",GEOGCS["GCS_{name}",DATUM["D_{name}",SPHEROID["{name}",{axis},0.0]],PRIMEM["Reference_Meridian",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Equidistant_Cylindrical"],PARAMETER["Central_Meridian",0.0],PARAMETER["Standard_Parallel_1",0.0],UNIT["Meter",1.0]]"#
        );
        folder.file("dem.prj", prj.as_bytes());
        let grid = "ncols 3\nnrows 3\nxllcorner 1000\nyllcorner 2000\ncellsize 60\n-1 2 3\n4 5 6\n7 8 9\n";
        let path = folder.file("dem.asc", grid.as_bytes());
        let loaded = load_terrain(&[path], &TerrainRequest::default(), &Progress::silent()).unwrap();
        assert_eq!((loaded.value.crs, loaded.value.extent_deg), (belvedere_scene::Crs::Local, None), "{name}");
        let said = loaded.warnings.iter().map(|w| w.text()).collect::<Vec<_>>().join("\n");
        assert!(said.contains(name) && said.contains("another body"), "{said}");
        let line = folder.file("way.geojson", br#"{"type":"LineString","coordinates":[[1010,2100],[1150,2150]]}"#);
        let vectors = load_vectors(&line).unwrap().value;
        let found =
            belvedere_io::lines_on_terrain(&vectors, loaded.value.crs, Some(&loaded.value.heightfield)).unwrap();
        assert_eq!(found.value.len(), 1, "{name}");
    }
}

#[test]
fn names_that_tell_nothing_leave_it_to_the_content() {
    let folder = Folder::new();
    let stl = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1,5 0,0 0,0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(stl.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    for (name, bytes) in [
        ("a", stl.as_bytes().to_vec()),
        ("a.dat", stl.as_bytes().to_vec()),
        ("b.stl", wide),
        ("c.stl", format!("# made by hand\n{stl}").into_bytes()),
    ] {
        let found = load_mesh(&folder.file(name, &bytes), &Limits::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(found.value.triangles.len(), 1, "{name}");
        assert_eq!(found.value.positions[1].x, 1.5, "{name}");
    }
    let city = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"vertices":[[0,0,0],[9,0,0],[9,9,0],[0,9,0],[0,0,5],[9,0,5],[9,9,5],[0,9,5]],"CityObjects":{"Häuschen":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]}]}}}"#;
    for seed in 0..12 {
        let path = folder.file("town.city.json", &encoded(&mut Random::new(seed), city));
        let found = belvedere_io::load_city(&path, None, &Limits::default()).unwrap_or_else(|e| panic!("{seed}: {e}"));
        assert_eq!(found.value.city.buildings.len(), 1);
    }
    for count in [0u32, u32::MAX] {
        let mut bytes = vec![b' '; 80];
        bytes.extend(count.to_le_bytes());
        for corner in [[0f32; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
            corner.iter().for_each(|c| bytes.extend(c.to_le_bytes()));
        }
        bytes.extend([0, 0]);
        let found = load_mesh(&folder.file("d.stl", &bytes), &Limits::default()).unwrap();
        assert_eq!(found.value.triangles.len(), 1);
        assert!(found.warnings[0].text().contains("the 1 in it are read"), "{:?}", found.warnings);
    }
    let html = folder.file("dem.tif", b"<!DOCTYPE html><html><body>404 Not Found</body></html>");
    let error = load_terrain(&[html], &TerrainRequest::default(), &Progress::silent()).unwrap_err().to_string();
    assert!(error.contains("a page of the web") && error.contains("again"), "{error}");
    let pointer = folder.file("way.gpx", b"version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 2\n");
    let error = load_vectors(&pointer).unwrap_err().to_string();
    assert!(error.contains("git lfs pull"), "{error}");
    assert!(readable(&folder.file("x.unknown", b"hello")).unwrap().is_none());
}

/// The data collection's own cases of reading: each is read, by the loader of its kind.
#[test]
fn cases_of_the_collection_are_read() {
    let Some(folder) = belvedere_testkit::data("cases") else { return };
    let at = |name: &str| -> PathBuf { folder.join(name) };
    for (name, lines, points) in [
        ("c01_zero_points.gpx", 1, 0),
        ("c03_mixed.geojson", 1, 1),
        ("c04_route.gpx.gz", 1, 0),
        ("c10_latin1_declared.gpx", 1, 0),
        ("c42_gap_between_records.shp", 3, 0),
        ("c42b_bytes_after_last_record.shp", 3, 0),
        ("c48_900913.geojson", 1, 0),
        ("c49_shapefile.zip", 3, 0),
    ] {
        let found = load_vectors(&at(name)).unwrap_or_else(|e| panic!("{e}")).value;
        let count = |wanted: fn(&Geometry) -> bool| found.features.iter().filter(|f| wanted(&f.geometry)).count();
        assert_eq!(count(|g| matches!(g, Geometry::Lines(_))), lines, "{name}");
        assert_eq!(count(|g| matches!(g, Geometry::Points(_))), points, "{name}");
    }
    for name in
        ["c26_decimal_comma.asc", "c27_no_crs.asc", "c28_undeclared_9999.tif", "c33_stereo70.tif", "c37_mars.tif"]
    {
        let loaded = load_terrain(&[at(name)], &TerrainRequest::default(), &Progress::silent());
        let loaded = loaded.unwrap_or_else(|e| panic!("{e}")).value;
        assert!(loaded.heightfield.z_range()[1] < 3000.0, "{name}");
    }
    for (name, triangles) in [
        ("c50_solid_tab.stl", 12),
        ("c50b_solid_no_name.stl", 12),
        ("c50c_upper_case.stl", 12),
        ("c50d_latin1.stl", 12),
        ("c52_line_continuation.obj", 12),
        ("c54_quantized.gltf", 12),
        ("panic_mtl.obj", 1),
    ] {
        let found = load_mesh(&at(name), &Limits::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(found.value.triangles.len(), triangles, "{name}");
    }
}
