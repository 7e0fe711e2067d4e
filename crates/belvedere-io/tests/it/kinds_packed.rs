//! Every kind of file is also read from gzip and ZIP, whatever else is in the archive, and other archives are errors.

use crate::support_files::Folder;
use belvedere_io::formats::Reader;
use belvedere_io::{Arrays, Known, inside, load_vectors, load_volume};
use belvedere_io::{Limits, TerrainRequest, VolumeRequest, load_city, load_mesh, load_molecule, load_terrain};
use belvedere_scene::Progress;
use std::io::Write;
use std::path::Path;

const LINE: &str = r#"{"type":"LineString","coordinates":[[11.40,46.92],[11.41,46.93],[11.42,46.92]]}"#;
const GPX: &str = r#"<gpx><trk><name>Way</name><trkseg><trkpt lat="46.92" lon="11.40"/><trkpt lat="46.93" lon="11.41"/></trkseg></trk></gpx>"#;
const ATOM: &str = "ATOM      1  O5'  DC A   1      18.935  34.195  25.617  1.00 64.35           O\n";
const CITY: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"vertices":[[0,0,0],[9,0,0],[9,9,0],[0,9,0],[0,0,5],[9,0,5],[9,9,5],[0,9,5]],"CityObjects":{"b":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]}]}}}"#;

/// A shapefile of one line, with its coordinate system and names.
fn shapefile() -> Vec<(&'static str, Vec<u8>)> {
    let points: [f64; 4] = [11.40, 46.92, 11.41, 46.93];
    let mut content = 3i32.to_le_bytes().to_vec();
    [points[0], points[1], points[2], points[3]].iter().for_each(|v| content.extend(v.to_le_bytes()));
    [1i32, 2, 0].iter().for_each(|v| content.extend(v.to_le_bytes()));
    points.iter().for_each(|v| content.extend(v.to_le_bytes()));
    let mut shp = vec![0u8; 100];
    shp[..4].copy_from_slice(&9994i32.to_be_bytes());
    let words = (108 + content.len()) as i32 / 2;
    shp[24..28].copy_from_slice(&words.to_be_bytes());
    shp[28..32].copy_from_slice(&1000i32.to_le_bytes());
    shp[32..36].copy_from_slice(&3i32.to_le_bytes());
    shp.extend(1i32.to_be_bytes());
    shp.extend((content.len() as i32 / 2).to_be_bytes());
    shp.extend(content);
    let prj = r#"GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]"#;
    vec![("way.shp", shp), ("way.prj", prj.into())]
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(content).expect("packed");
    packed.finish().expect("packed")
}

fn zip(entries: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    for (name, content) in entries {
        archive.start_file(*name, options).expect("begun");
        archive.write_all(content).expect("packed");
    }
    archive.finish().expect("packed").into_inner()
}

/// The result of loading a file: a text that identifies the content, or the error.
fn read(path: &Path, kind: &str) -> Result<String, String> {
    let limits = Limits::default();
    let error = |e: belvedere_io::IoError| e.to_string();
    match kind {
        "vector" => load_vectors(path).map(|l| format!("{:?} {:?}", l.value.crs, l.value.features)).map_err(error),
        "terrain" => load_terrain(&[path.to_owned()], &TerrainRequest::default(), &Progress::silent())
            .map(|l| format!("{} {:?}", l.value.crs, l.value.heightfield.z_range()))
            .map_err(error),
        "mesh" => {
            load_mesh(path, &limits).map(|l| format!("{:?} {:?}", l.value.positions, l.value.colors)).map_err(error)
        }
        "volume" => {
            load_volume(path, &VolumeRequest::default()).map(|l| format!("{:?}", l.value.values)).map_err(error)
        }
        "molecule" => load_molecule(path, &limits).map(|l| format!("{:?}", l.value.molecule.atoms())).map_err(error),
        _ => load_city(path, None, &limits).map(|l| format!("{:?}", l.value.city)).map_err(error),
    }
}

/// A kind of file, and names and bytes of an example and its sidecar files.
type Kind = (&'static str, Vec<(&'static str, Vec<u8>)>);

fn kinds() -> Vec<Kind> {
    let asc = "ncols 3\nnrows 2\nxllcorner 680000\nyllcorner 5196000\ncellsize 60\n1 2 3\n4 5 6\n";
    let utm = r#"PROJCS["WGS_1984_UTM_Zone_32N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],UNIT["Meter",1.0]]"#;
    let hgt: Vec<u8> = (0..101 * 101).flat_map(|k: i32| ((k % 900) as i16).to_be_bytes()).collect();
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let stl = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    let nrrd =
        b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n\0\x01\x02\x03\x04\x05\x06\x07".to_vec();
    vec![
        ("vector", vec![("way.gpx", GPX.into())]),
        ("vector", vec![("way.geojson", LINE.into())]),
        ("vector", shapefile()),
        ("terrain", vec![("dem.asc", asc.into()), ("dem.prj", utm.into())]),
        ("terrain", vec![("N46E011.hgt", hgt)]),
        ("mesh", vec![("a.obj", obj.into()), ("m.mtl", "newmtl m\nKd 1 0 0\n".into())]),
        ("mesh", vec![("a.stl", stl.into())]),
        ("volume", vec![("a.nrrd", nrrd)]),
        ("molecule", vec![("a.pdb", ATOM.into())]),
        ("city", vec![("town.city.json", CITY.into())]),
    ]
}

#[test]
fn every_kind_is_read_out_of_archives() {
    for (kind, files) in kinds() {
        let folder = Folder::new();
        let plain: Vec<_> = files.iter().map(|(name, content)| folder.file(name, content)).collect();
        let want = read(&plain[0], kind).unwrap_or_else(|e| panic!("{kind}: {e}"));
        let name = files[0].0;
        let as_dyn = |list: &[(String, Vec<u8>)]| -> Vec<u8> {
            zip(&list.iter().map(|(n, c)| (n.as_str(), c.clone())).collect::<Vec<_>>())
        };
        let owned = |prefix: &str| files.iter().map(|(n, c)| (format!("{prefix}{n}"), c.clone())).collect::<Vec<_>>();
        let mut cluttered = owned("data set/");
        cluttered.insert(0, (format!("__MACOSX/data set/._{name}"), b"Mac OS X".to_vec()));
        cluttered.insert(1, ("data set/.DS_Store".into(), b"\0\0".to_vec()));
        cluttered.push((format!("data set/._{name}"), b"Mac OS X".to_vec()));
        cluttered.push(("data set/Thumbs.db".into(), b"x".to_vec()));
        cluttered.push(("data set/readme.txt".into(), b"Read me".to_vec()));
        let mut archives = vec![("plain.zip", as_dyn(&owned(""))), ("Cluttered.ZIP", as_dyn(&cluttered))];
        let nested = as_dyn(&[(format!("{name}.gz"), gzip(&files[0].1))]);
        let packed = format!("{name}.gz");
        if files.len() == 1 {
            archives.push((packed.as_str(), gzip(&files[0].1)));
            archives.push(("nested.zip", nested));
        }
        for (archive, bytes) in archives {
            let path = folder.file(archive, &bytes);
            assert_eq!(read(&path, kind), Ok(want.clone()), "{archive} of {name}");
            let meant = inside(&path).unwrap();
            assert!(meant.starts_with(&path) && meant.ends_with(name), "{}", meant.display());
            assert_eq!(read(&meant, kind), Ok(want.clone()), "{}", meant.display());
        }
    }
}

#[test]
fn the_record_is_that_of_the_archive() {
    let folder = Folder::new();
    let packed = gzip(GPX.as_bytes());
    let path = folder.file("way.gpx.gz", &packed);
    let files = load_vectors(&path).unwrap().files;
    assert_eq!((files.len(), &files[0].path, files[0].bytes), (1, &path, packed.len() as u64));
    assert_eq!(files[0].sha256, belvedere_io::sha256(&packed));
}

#[test]
fn archives_that_do_not_tell_what_is_meant_are_one_sentence() {
    let folder = Folder::new();
    let two = zip(&[("a.gpx", GPX.into()), ("b.gpx", GPX.into())]);
    for (name, bytes, want) in [
        ("two.zip", two, "name the one that is meant"),
        (
            "none.zip",
            zip(&[("a.doc", b"x".to_vec()), ("b.doc", b"y".to_vec())]),
            "no file of this kind (it holds a.doc, b.doc)",
        ),
        ("mac.zip", zip(&[("__MACOSX/._a.gpx", b"x".to_vec())]), "holds no file"),
        ("cut.zip", zip(&[("a.gpx", GPX.into())])[..60].to_vec(), "cannot be unpacked"),
        ("cut.gpx.gz", gzip(GPX.as_bytes())[..30].to_vec(), "cannot be unpacked"),
    ] {
        let path = folder.file(name, &bytes);
        let error = load_vectors(&path).expect_err(name).to_string();
        assert!(error.contains(want) && error.contains(name) && error.lines().count() == 1, "{name}: {error}");
    }
    let one = folder.file("two.zip", &zip(&[("a.gpx", GPX.into()), ("b.gpx", GPX.into())])).join("b.gpx");
    assert_eq!(load_vectors(&one).unwrap().value.features.len(), 1);
    let error = load_vectors(&one.with_file_name("c.gpx")).unwrap_err().to_string();
    assert!(error.contains("holds no c.gpx"), "{error}");
}

/// Archives of zeros, which expand to far more than their size.
#[test]
fn archives_do_not_grow_beyond_the_limits() {
    let folder = Folder::new();
    let zeros = vec![b'0'; 8 << 20];
    let limits = Limits { max_bytes: 1 << 20 };
    for (name, bytes) in [("a.stl.gz", gzip(&zeros)), ("a.zip", zip(&[("a.stl", zeros.clone())]))] {
        assert!(bytes.len() < 1 << 17);
        let error = load_mesh(&folder.file(name, &bytes), &limits).expect_err(name).to_string();
        assert!(error.contains("more than 1 MiB"), "{error}");
    }
}

#[test]
fn an_archive_of_elevation_models_alone_is_a_folder_of_tiles() {
    let folder = Folder::new();
    let tile = |west: usize| {
        let head = format!("ncols 2\nnrows 2\nxllcorner {}\nyllcorner 5196000\ncellsize 60\n", 680_000 + 120 * west);
        format!("{head}{west} 2\n3 4\n").into_bytes()
    };
    let tiles = [("in/b.asc", tile(1)), ("in/a.asc", tile(0)), ("in/readme.txt", b"notes".to_vec())];
    let path = folder.file("tiles.zip", &zip(&tiles));
    let found = belvedere_io::tiles(&path).expect("an archive");
    assert_eq!(found, [path.join("in/a.asc"), path.join("in/b.asc")]);
    let known = Known::of(&path, &Arrays::default()).expect("known");
    assert_eq!((known.reader, &known.path), (Some(Reader::Terrain), &path.canonicalize().expect("a path")));
    let ground = load_terrain(&found, &TerrainRequest::default(), &Progress::silent()).expect("one terrain");
    assert_eq!((ground.value.heightfield.cols(), ground.value.heightfield.rows()), (4, 2));
    let mixed = [("a.asc", tile(0)), ("b.asc", tile(1)), ("c.gpx", GPX.into())];
    for entries in [&mixed[..], &mixed[..1]] {
        let path = folder.file("other.zip", &zip(entries));
        assert_eq!(belvedere_io::tiles(&path).expect("an archive"), Vec::<std::path::PathBuf>::new());
    }
}
