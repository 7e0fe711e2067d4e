//! Kinds of files that were once refused or misread, made in many variants: meshes, volumes, features, grids.

use crate::support_files::Folder;
use belvedere_io::{Geometry, Limits, MeshFile, TerrainRequest, VolumeRequest, lines_on_terrain, load_mesh};
use belvedere_io::{load_terrain, load_vectors, load_volume};
use belvedere_scene::{Crs, Progress};
use glam::DVec3;

fn mesh(folder: &Folder, name: &str, content: &[u8]) -> Result<MeshFile, String> {
    load_mesh(&folder.file(name, content), &Limits::default()).map(|l| l.value).map_err(|e| e.to_string())
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

#[test]
fn text_stl_of_every_spelling_and_binary_that_begins_like_it() {
    let folder = Folder::new();
    let text = |head: &str, end: &str, line: &str| {
        let facet = |f: &[usize; 3]| {
            let vertices: String =
                f.iter().map(|v| CORNERS[*v]).map(|[x, y, z]| format!("vertex {x:e} {y} {z:.3}{line}")).collect();
            format!("facet normal 0 0 1{line}outer loop{line}{vertices}endloop{line}endfacet{line}")
        };
        format!("{head}{}{end}", FACES.iter().map(facet).collect::<String>())
    };
    let mut spellings: Vec<Vec<u8>> = Vec::new();
    for head in [
        "solid\n",
        "solid name\n",
        "solid\tname\n",
        "solid \r\n",
        "SOLID A\n",
        "Solid\r",
        "  solid x y z\n",
        "\u{feff}solid\n",
    ] {
        for line in ["\n", "\r\n", "\r"] {
            spellings.push(text(head, "endsolid", line).into());
            spellings.push(text(head, "", line).to_uppercase().into());
        }
    }
    spellings.push([b"solid W\xfcrfel\n".to_vec(), text("", "endsolid W", "\n").into_bytes()].concat());
    spellings.push(text("solid\n", "endsolid\n", " ").into());
    let mut binary = b"solid made by a program that says so".to_vec();
    binary.resize(80, b' ');
    binary.extend(4u32.to_le_bytes());
    for face in FACES {
        binary.extend([0u8; 12]);
        face.iter().flat_map(|v| CORNERS[*v]).for_each(|c| binary.extend(c.to_le_bytes()));
        binary.extend([0u8; 2]);
    }
    spellings.push(binary.clone());
    spellings.push([binary, vec![0; 7]].concat());
    for (k, bytes) in spellings.iter().enumerate() {
        let found = mesh(&folder, "a.stl", bytes);
        let shown = String::from_utf8_lossy(&bytes[..40]).into_owned();
        let found = found.unwrap_or_else(|e| panic!("spelling {k} {shown:?}: {e}"));
        assert_eq!((found.triangles.len(), found.positions.len()), (4, 4), "{k} {shown:?}");
    }
    for (broken, want) in [
        (text("solid\n", "", "\n").replace("endloop", "vertex 1 two 3 endloop"), "no three numbers"),
        ("solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n".into(), "cut off"),
    ] {
        let error = mesh(&folder, "a.stl", broken.as_bytes()).unwrap_err();
        assert!(error.contains(want), "{error}");
    }
}

#[test]
fn obj_lines_go_on_and_materials_may_be_odd_or_missing() {
    let folder = Folder::new();
    folder.file("grey.mtl", b"newmtl m\nKd 0.5\nKa spectral x.rfl\nNs much\n");
    let head = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (faces, triangles) in [
        ("f 1 2 \\\n3 4\n", 2),
        ("f 1 2 \\\r\n 3\\\r\n 4\r\n", 2),
        ("f 1 2 3 # the first\nf 1 3 4 # 9 9 9\n", 2),
        ("o W\u{fc}rfel\nf 1 2 3", 1),
        ("mtllib gone.mtl\nusemtl m\nf 1 2 3\n", 1),
        ("mtllib grey.mtl\nusemtl m\nf 1 2 3\n", 1),
    ] {
        let found =
            mesh(&folder, "a.obj", format!("{head}{faces}").as_bytes()).unwrap_or_else(|e| panic!("{faces}: {e}"));
        assert_eq!(found.triangles.len(), triangles, "{faces}");
    }
    let latin = [head.as_bytes(), b"o W\xfcrfel\nf 1 2 3\n"].concat();
    assert_eq!(mesh(&folder, "a.obj", &latin).unwrap().names, ["Würfel"]);
    let loaded = load_mesh(
        &folder.file("a.obj", format!("mtllib grey.mtl\n{head}usemtl m\nf 1 2 3\n").as_bytes()),
        &Limits::default(),
    );
    let loaded = loaded.unwrap();
    assert_eq!(
        loaded.value.colors,
        belvedere_scene::MeshColors::PerTriangle(vec![belvedere_scene::Color::rgb(128, 128, 128)])
    );
    assert!(loaded.warnings.iter().any(|w| w.text().contains("2 lines of its materials")), "{:?}", loaded.warnings);
}

/// A tetrahedron whose corners are stored as integers of a type.
fn quantised(kind: u32, normalized: bool, bytes: &[u8], stride: usize, extension: &str, uri: &str) -> String {
    let count = bytes.len() / stride;
    format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["{extension}"],"extensionsRequired":["{extension}"],"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"scale":[2,2,2]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":{kind},"normalized":{normalized},"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},{{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":{},"byteStride":{stride}}},{{"buffer":0,"byteOffset":{},"byteLength":12}}],"buffers":[{{"byteLength":{},"uri":"{uri}"}}]}}"#,
        bytes.len(),
        bytes.len(),
        bytes.len() + 12
    )
}

#[test]
fn quantised_gltf_is_read_and_what_is_compressed_is_named() {
    let folder = Folder::new();
    let indices: Vec<u8> = FACES.iter().flatten().map(|v| *v as u8).collect();
    let corners = [[0u16, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    for (kind, normalized, largest, size) in [
        (5120, true, 127u16, 1),
        (5121, true, 255, 1),
        (5122, true, 32767, 2),
        (5123, true, 65535, 2),
        (5121, false, 1, 1),
        (5123, false, 1, 2),
    ] {
        let mut bytes = Vec::new();
        for corner in corners {
            for c in corner {
                let stored = (c * largest).to_le_bytes();
                bytes.extend(&stored[..size]);
            }
            bytes.resize(bytes.len() + size, 0); // padding to four
        }
        folder.file("W\u{fc}rfel 1%.bin", &[bytes.clone(), indices.clone()].concat());
        let text = quantised(kind, normalized, &bytes, 4 * size, "KHR_mesh_quantization", "W%C3%BCrfel%201%25.bin");
        let found = mesh(&folder, "a.gltf", text.as_bytes()).unwrap_or_else(|e| panic!("{kind} {normalized}: {e}"));
        let far = found.positions.iter().fold(DVec3::NEG_INFINITY, |a, b| a.max(*b));
        let near = found.positions.iter().fold(DVec3::INFINITY, |a, b| a.min(*b));
        assert!((far - near).distance(DVec3::splat(2.0)) < 1e-9, "{kind} {normalized}: {near} {far}");
        assert_eq!(found.triangles.len(), 4);
    }
    for (extension, want) in [
        ("KHR_draco_mesh_compression", "compressed with Draco"),
        ("EXT_meshopt_compression", "compressed with meshopt"),
        ("MY_extension", "requires the extension MY_extension"),
    ] {
        let error =
            mesh(&folder, "a.gltf", quantised(5121, false, &[0; 16], 4, extension, "x.bin").as_bytes()).unwrap_err();
        assert!(error.contains(want) && error.contains("write it without"), "{error}");
    }
}

#[test]
fn gltf_parts_that_name_parts_that_are_not_there_are_one_sentence() {
    let folder = Folder::new();
    let whole = quantised(5121, false, &[0; 16], 4, "KHR_mesh_quantization", "x.bin");
    for (from, to, want) in [
        ("\"mesh\":0", "\"mesh\":7", "names number 7 of 1 meshes"),
        ("\"nodes\":[0]", "\"nodes\":[3]", "names number 3 of 1 nodes"),
        ("\"POSITION\":0", "\"POSITION\":2", "names number 2 of 2 accessors"),
        ("\"indices\":1", "\"indices\":-1", "names number -1 of 2 accessors"),
        ("\"bufferView\":1", "\"bufferView\":9", "names number 9 of 2 bufferViews"),
        ("\"buffer\":0", "\"buffer\":1", "names number 1 of 1 buffers"),
        ("\"scene\":0", "\"scene\":1", "names number 1 of 1 scenes"),
    ] {
        let error = mesh(&folder, "a.gltf", whole.replacen(from, to, 1).as_bytes()).expect_err(from);
        assert!(error.contains(want), "{from}: {error}");
    }
}

/// One volume, written in the coordinate spaces (NRRD `space`) that programs use.
#[test]
fn volumes_of_one_body_stand_at_one_place() {
    let folder = Folder::new();
    let (dims, origin, step) = ([3usize, 4, 5], DVec3::new(60.0, -120.0, 90.0), DVec3::new(1.0, 1.5, 2.0));
    let place = |name: &str, signs: DVec3| {
        let (o, s) = (signs * origin, signs * step);
        let head = format!(
            "NRRD0005\ntype: uint8\ndimension: 3\nspace: {name}\nsizes: 3 4 5\nspace directions: ({},0,0) (0,{},0) (0,0,{})\nspace origin: ({},{},{})\nencoding: raw\n\n",
            s.x, s.y, s.z, o.x, o.y, o.z
        );
        let values: Vec<u8> = (0..dims.iter().product::<usize>()).map(|k| k as u8).collect();
        let path = folder.file("a.nrrd", &[head.into_bytes(), values].concat());
        let loaded = load_volume(&path, &VolumeRequest::default()).unwrap();
        assert!(loaded.warnings.is_empty(), "{name}: {:?}", loaded.warnings);
        (loaded.value.origin, loaded.value.axes)
    };
    let want = place("left-posterior-superior", DVec3::ONE);
    assert_eq!(want.0, origin);
    for (name, signs) in [
        ("LPS", [1.0, 1.0, 1.0]),
        ("RAS", [-1.0, -1.0, 1.0]),
        ("right-anterior-superior", [-1.0, -1.0, 1.0]),
        ("LAS", [1.0, -1.0, 1.0]),
        ("left-anterior-superior", [1.0, -1.0, 1.0]),
    ] {
        assert_eq!(place(name, DVec3::from_array(signs)), want, "{name}");
    }
    let odd =
        folder.file("b.nrrd", b"NRRD0004\ntype: uint8\ndimension: 3\nspace: XYZ\nsizes: 1 1 1\nencoding: raw\n\n\0");
    assert!(load_volume(&odd, &VolumeRequest::default()).unwrap().warnings[0].text().contains("XYZ"));
}

#[test]
fn sequences_nulls_and_positions_at_nowhere_in_geojson() {
    let folder = Folder::new();
    let feature = |k: i32| {
        format!(
            r#"{{"type":"Feature","properties":{{"Namn":"way {k}"}},"geometry":{{"type":"LineString","coordinates":[[11.4,46.{k}],[11.5,46.{k}]]}}}}"#
        )
    };
    let list: Vec<String> = (1..=4).map(feature).collect();
    for text in
        [list.join("\n"), list.iter().map(|f| format!("\u{1e}{f}\n")).collect(), format!("[{}]", list.join(","))]
    {
        let found = load_vectors(&folder.file("a.geojsonl", text.as_bytes())).unwrap().value;
        assert_eq!(
            found.features.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(),
            ["way 1", "way 2", "way 3", "way 4"]
        );
    }
    let nulls = format!(
        r#"{{"type":"FeatureCollection","crs":null,"name":null,"features":[null,{},{{"type":"Feature","properties":null,"geometry":null}},{{"type":"Feature","geometry":{{"type":"LineString","coordinates":null}}}},{{"type":"Feature","geometry":{{"type":"LineString","coordinates":[[11.4,46.9,null],null,[null,null],[11.5,46.9]]}}}},{{"type":"Feature","geometry":{{"type":"GeometryCollection","geometries":[null]}}}}]}}"#,
        list[0]
    );
    let loaded = load_vectors(&folder.file("n.geojson", nulls.as_bytes())).unwrap();
    assert_eq!((loaded.value.features.len(), loaded.value.vertex_count()), (2, 4));
    let said = loaded.warnings.iter().map(|w| w.text()).collect::<Vec<_>>().join("\n");
    assert!(said.contains("2 features without geometry") && said.contains("4 members that are null"), "{said}");
    let zeros = r#"{"type":"GeometryCollection","geometries":[{"type":"LineString","coordinates":[[11.4,46.9],[11.401,46.9],[0,0],[11.402,46.9],[11.403,46.9]]},{"type":"MultiPoint","coordinates":[[11.4,46.9],[0,0]]},{"type":"Polygon","coordinates":[[[11.4,46.9],[11.41,46.9],[0,0],[11.41,46.91],[11.4,46.9]]]}]}"#;
    let loaded = load_vectors(&folder.file("z.geojson", zeros.as_bytes())).unwrap();
    let sizes: Vec<usize> = loaded.value.features.iter().map(|f| f.geometry.vertices().count()).collect();
    assert_eq!(sizes, [4, 1, 3]);
    assert!(matches!(&loaded.value.features[0].geometry, Geometry::Lines(l) if l.len() == 2));
    assert!(loaded.warnings[0].text().contains("3 positions at exactly 0, 0"), "{:?}", loaded.warnings);
    let one = r#"{"type":"LineString","coordinates":[[11.4,46.9],[11.4,46.9],[11.4,46.9]]}"#;
    assert!(
        load_vectors(&folder.file("o.geojson", one.as_bytes())).unwrap_err().to_string().contains("one position only")
    );
}

#[test]
fn a_segment_per_point_is_a_line() {
    let folder = Folder::new();
    let segment = |k: i32| format!(r#"<trkseg><trkpt lat="46.9" lon="11.40{k}"/></trkseg>"#);
    let text = format!("<gpx><trk>{}</trk></gpx>", (1..=5).map(segment).collect::<String>());
    let loaded = load_vectors(&folder.file("a.gpx", text.as_bytes())).unwrap();
    assert_eq!((loaded.value.features.len(), loaded.value.vertex_count()), (1, 5));
    assert!(
        loaded.warnings[0].text().contains("5 segments, tracks or routes of a single point"),
        "{:?}",
        loaded.warnings
    );
}

/// Records with gaps between them, in any order, are found at the offsets in the index.
#[test]
fn the_index_of_a_shapefile_tells_where_its_records_are() {
    let folder = Folder::new();
    let record = |k: i32| {
        let points = [11.4, 46.9 + 0.01 * f64::from(k), 11.5, 46.9 + 0.01 * f64::from(k)];
        let mut content = 3i32.to_le_bytes().to_vec();
        points.iter().for_each(|v: &f64| content.extend(v.to_le_bytes()));
        [1i32, 2, 0].iter().for_each(|v| content.extend(v.to_le_bytes()));
        points.iter().for_each(|v| content.extend(v.to_le_bytes()));
        let words = (content.len() / 2) as i32;
        [k.to_be_bytes().to_vec(), words.to_be_bytes().to_vec(), content].concat()
    };
    let header = |bytes: usize| {
        let mut out = vec![0u8; 100];
        out[..4].copy_from_slice(&9994i32.to_be_bytes());
        out[24..28].copy_from_slice(&((bytes / 2) as i32).to_be_bytes());
        out[28..32].copy_from_slice(&1000i32.to_le_bytes());
        out[32..36].copy_from_slice(&3i32.to_le_bytes());
        out
    };
    for (gaps, tail) in [([0usize, 0, 0], 0usize), ([0, 44, 0], 0), ([12, 0, 6], 144), ([2, 2, 2], 2), ([0, 0, 0], 99)]
    {
        let (mut body, mut index) = (Vec::new(), Vec::new());
        for (k, gap) in gaps.into_iter().enumerate() {
            body.extend(vec![0xaau8; gap]);
            index.push((100 + body.len(), record(k as i32).len() - 8));
            body.extend(record(k as i32));
        }
        body.extend(vec![0xffu8; tail]);
        let total = 100 + body.len() - body.len() % 2;
        let path = folder.file("a.shp", &[header(total), body].concat());
        let entries =
            index.iter().flat_map(|(at, n)| [(*at / 2) as i32, (*n / 2) as i32].map(i32::to_be_bytes).concat());
        folder.file("a.shx", &[header(100 + 8 * index.len()), entries.collect()].concat());
        let found = load_vectors(&path).unwrap_or_else(|e| panic!("{gaps:?} {tail}: {e}")).value;
        let lats: Vec<f64> =
            found.features.iter().filter_map(|f| f.geometry.vertices().next()).map(|v| v.xy.y).collect();
        assert_eq!(lats.len(), 3, "{gaps:?} {tail}");
        assert!(lats.iter().enumerate().all(|(k, y)| (y - 46.9 - 0.01 * k as f64).abs() < 1e-12), "{lats:?}");
    }
}

fn grid(folder: &Folder, name: &str, number: impl Fn(f64) -> String, odd: &str) -> std::path::PathBuf {
    let mut text = format!(
        "ncols 20\nnrows 20\nxllcorner {}\nyllcorner {}\ncellsize {}\n",
        number(100.0),
        number(200.0),
        number(10.5)
    );
    for k in 0..400 {
        let height = 500.0 + 300.0 * (f64::from(k) * 0.05).sin();
        text += &if k % 57 == 3 && !odd.is_empty() { odd.to_owned() } else { number(height) };
        text.push(if k % 20 == 19 { '\n' } else { ' ' });
    }
    folder.file(name, text.as_bytes())
}

#[test]
fn grids_with_commas_customary_voids_and_feet() {
    let folder = Folder::new();
    let load = |path: &std::path::PathBuf, request: &TerrainRequest| {
        load_terrain(std::slice::from_ref(path), request, &Progress::silent()).unwrap()
    };
    let usual = TerrainRequest::default();
    let point = |v: f64| format!("{v:.2}");
    let want = load(&grid(&folder, "a.asc", point, ""), &usual).value.heightfield;
    let comma = load(&grid(&folder, "b.asc", |v| format!("{v:.2}").replace('.', ","), ""), &usual);
    assert_eq!(comma.value.heightfield.heights(), want.heights());
    assert!(comma.warnings.iter().any(|w| w.text().contains("decimal commas")), "{:?}", comma.warnings);
    for odd in ["-32768", "-99999", "-32767.0", "9999", "-3.4028235e38"] {
        let found = load(&grid(&folder, "c.asc", point, odd), &usual);
        assert_eq!(found.value.void_samples, 7, "{odd}: {:?}", found.warnings);
        assert!(found.warnings.iter().any(|w| w.text().contains("taken as voids")), "{odd}: {:?}", found.warnings);
    }
    // a given no-data value takes precedence
    let said = TerrainRequest { nodata: Some(-1.0), ..usual.clone() };
    assert_eq!(load(&grid(&folder, "c.asc", point, "-32768"), &said).value.void_samples, 0);
    let feet = r#"PROJCS["NAD_1983_StatePlane_New_Mexico_Central_FIPS_3002_Feet",GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",1640416.66666667],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",-106.25],PARAMETER["Scale_Factor",0.9999],PARAMETER["Latitude_Of_Origin",31.0],UNIT["Foot_US",0.304800609601219]]"#;
    folder.file("f.prj", feet.as_bytes());
    let path = grid(&folder, "f.asc", point, "");
    let silent = load(&path, &usual);
    let said = silent.warnings.iter().find(|w| w.text().contains("US survey feet")).expect("said");
    assert!(said.text().contains("3.28 times") && said.text().contains("vertical_unit = \"us-ft\""), "{said}");
    assert_eq!(said.key(), Some("vertical_unit"));
    let settled = load(&path, &TerrainRequest { vertical_unit_m: Some(0.3048), ..usual });
    assert!(!settled.warnings.iter().any(|w| w.text().contains("feet")), "{:?}", settled.warnings);
    let top = |t: &belvedere_io::LoadedTerrain| t.heightfield.z_range()[1];
    assert!((top(&settled.value) / top(&silent.value) - 0.3048).abs() < 1e-3);
}

#[test]
fn features_without_a_system_lie_on_ground_without_one() {
    let folder = Folder::new();
    let path = grid(&folder, "a.asc", |v| v.to_string(), "");
    let ground = TerrainRequest { crs: belvedere_io::CrsChoice::Local, ..TerrainRequest::default() };
    let ground = load_terrain(&[path], &ground, &Progress::silent()).unwrap().value.heightfield;
    // coordinates both outside and inside the range of degrees
    for (a, b) in [([120.0, 380.0], [290.0, 390.0]), ([120.0, 220.0], [290.0, 230.0])] {
        let text = format!(r#"{{"type":"LineString","coordinates":[{a:?},{b:?}]}}"#);
        let text = text.replace("220.0", "85.0").replace("230.0", "86.0");
        let vectors = load_vectors(&folder.file("l.geojson", text.as_bytes())).unwrap().value;
        let found = lines_on_terrain(&vectors, Crs::Local, Some(&ground));
        assert_eq!(found.is_ok(), a[1] > 300.0, "{text}: {found:?}");
    }
    let stated =
        r#"{"type":"LineString","crs":{"properties":{"name":"EPSG:4326"}},"coordinates":[[120.0,85.0],[121.0,86.0]]}"#;
    let vectors = load_vectors(&folder.file("s.geojson", stated.as_bytes())).unwrap().value;
    let error = lines_on_terrain(&vectors, Crs::Local, Some(&ground)).unwrap_err();
    assert_eq!(error.lifted_by(), belvedere_io::LiftedBy::Keys(&["source_crs"]));
    assert!(error.to_string().contains("longitude and latitude"), "{error}");
}
