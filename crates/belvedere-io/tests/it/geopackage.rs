//! GeoPackages: a real one against the GeoJSON made from it, one with unusual values in every field, and broken ones.

use belvedere_io::crs::{CoordinateSystem, Transform};
use belvedere_io::{Geometry, Limits, Loaded, Vectors, lines_on_terrain, load_city, load_vectors};
use belvedere_scene::Crs;
use belvedere_testkit::data;
use rusqlite::{Connection, MAIN_DB, params};
use std::path::{Path, PathBuf};

fn at(path: &Path, table: &str) -> PathBuf {
    format!("{}?table={table}", path.display()).into()
}

fn load(path: &Path) -> Result<Loaded<Vectors>, String> {
    load_vectors(path).map_err(|e| e.to_string())
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// A made-up package in memory, with the tables that every package has.
struct Package(Connection);

const TABLES: &str = "
    PRAGMA application_id = 1196444487;
    CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT, identifier TEXT, srs_id INTEGER);
    CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, geometry_type_name TEXT, srs_id INTEGER, z INTEGER, m INTEGER);
    CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER PRIMARY KEY, organization TEXT, organization_coordsys_id INTEGER, definition TEXT);
    INSERT INTO gpkg_spatial_ref_sys VALUES ('WGS 84', 4326, 'EPSG', 4326, 'undefined'), ('UTM 33N', 32633, 'epsg', 32633, 'undefined'),
        ('mine', 100001, 'NONE', 5, 'PROJCS[\"WGS 84 / UTM zone 33N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",15],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"32633\"]]'),
        ('lost', 100002, 'NONE', 6, 'nonsense');";

impl Package {
    fn new() -> Self {
        let connection = Connection::open_in_memory().unwrap();
        connection.execute_batch(TABLES).unwrap();
        Self(connection)
    }

    fn table(self, name: &str, srs_id: i64) -> Self {
        let sql = format!(
            "CREATE TABLE {} (fid INTEGER PRIMARY KEY, geom BLOB, name TEXT, height REAL, levels INTEGER, photo BLOB)",
            quoted(name)
        );
        self.0.execute_batch(&sql).unwrap();
        self.0
            .execute("INSERT INTO gpkg_contents VALUES (?1, 'features', 'called ' || ?1, ?2)", params![name, srs_id])
            .unwrap();
        self.0
            .execute(
                "INSERT INTO gpkg_geometry_columns VALUES (?1, 'GEOM', 'GEOMETRY', ?2, 0, 0)",
                params![name, srs_id],
            )
            .unwrap();
        self
    }

    fn row(self, table: &str, geometry: Option<Vec<u8>>, name: &str) -> Self {
        self.0
            .execute(&format!("INSERT INTO {} (geom, name) VALUES (?1, ?2)", quoted(table)), params![geometry, name])
            .unwrap();
        self
    }

    fn sql(self, sql: &str) -> Self {
        self.0.execute_batch(sql).unwrap();
        self
    }

    fn bytes(mut self) -> Vec<u8> {
        self.0.serialize(MAIN_DB).unwrap().to_vec()
    }

    fn load(self) -> Result<Loaded<Vectors>, String> {
        load_bytes(&self.bytes())
    }
}

fn load_bytes(bytes: &[u8]) -> Result<Loaded<Vectors>, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gpkg");
    std::fs::write(&path, bytes).unwrap();
    let loaded = load(&path);
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1, "nothing is left beside the file");
    assert!(std::fs::read(&path).unwrap() == bytes, "the file stays as it is");
    loaded
}

/// A header with a kind of envelope, and well-known binary behind it.
fn geometry(srs_id: i32, envelope: u8, little: bool, wkb: &[u8]) -> Vec<u8> {
    let size = [0, 4, 6, 6, 8][usize::from(envelope)];
    let mut out = b"GP\0".to_vec();
    out.push(envelope << 1 | u8::from(little));
    out.extend(if little { srs_id.to_le_bytes() } else { srs_id.to_be_bytes() });
    out.extend(std::iter::repeat_n(7.0f64.to_le_bytes(), size).flatten());
    out.extend(wkb);
    out
}

/// Well-known binary: its kind, counts and numbers.
#[derive(Clone, Copy)]
struct Wkb {
    little: bool,
}

impl Wkb {
    fn head(self, kind: u32) -> Vec<u8> {
        [vec![u8::from(self.little)], self.count(kind)].concat()
    }

    fn count(self, n: u32) -> Vec<u8> {
        if self.little { n.to_le_bytes().to_vec() } else { n.to_be_bytes().to_vec() }
    }

    fn numbers(self, v: &[f64]) -> Vec<u8> {
        v.iter().flat_map(|x| if self.little { x.to_le_bytes() } else { x.to_be_bytes() }).collect()
    }

    fn point(self, kind: u32, v: &[f64]) -> Vec<u8> {
        [self.head(kind), self.numbers(v)].concat()
    }

    fn line(self, kind: u32, size: usize, v: &[f64]) -> Vec<u8> {
        [self.head(kind), self.count((v.len() / size) as u32), self.numbers(v)].concat()
    }

    fn polygon(self, rings: &[&[f64]]) -> Vec<u8> {
        let mut out = [self.head(3), self.count(rings.len() as u32)].concat();
        for ring in rings {
            out.extend([self.count((ring.len() / 2) as u32), self.numbers(ring)].concat());
        }
        out
    }

    fn many(self, kind: u32, parts: &[Vec<u8>]) -> Vec<u8> {
        [self.head(kind), self.count(parts.len() as u32), parts.concat()].concat()
    }
}

const LE: Wkb = Wkb { little: true };
const SQUARE: &[f64] = &[0.0, 0.0, 4.0, 0.0, 4.0, 4.0, 0.0, 4.0, 0.0, 0.0];
const HOLE: &[f64] = &[1.0, 1.0, 2.0, 1.0, 2.0, 2.0, 1.0, 1.0];

#[test]
fn a_real_package_says_what_the_geojson_made_of_it_says() {
    let Some(path) = data("city_bubenec/bubenec.gpkg") else { return };
    let before = std::fs::read(&path).unwrap();
    for (table, count) in [("buildings", 144), ("streets", 35), ("plots", 407)] {
        let Some(json) = data(&format!("city_bubenec/{table}.geojson")) else { continue };
        let (Loaded { value, warnings, files }, json) = (load(&at(&path, table)).unwrap(), load(&json).unwrap().value);
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((value.format, value.layer.as_str(), value.crs.epsg()), ("GeoPackage", table, Some(3857)));
        assert_eq!((value.features.len(), json.features.len()), (count, count));
        assert_eq!((files[0].path.as_path(), files[0].bytes), (path.as_path(), before.len() as u64));
        let to_degrees = Transform::new(&value.crs, &CoordinateSystem::wgs84().unwrap()).unwrap();
        for (ours, theirs) in value.features.iter().zip(&json.features) {
            let pairs: Vec<_> = ours.geometry.vertices().zip(theirs.geometry.vertices()).collect();
            assert_eq!(ours.geometry.vertices().count(), theirs.geometry.vertices().count());
            for (v, w) in pairs {
                // The GeoJSON has seven digits.
                assert!((to_degrees.forward_one(v.xy).unwrap() - w.xy).length() < 1e-7, "{table}: {v:?} {w:?}");
            }
            for (key, value) in &theirs.properties {
                assert_eq!(ours.properties.get(key), Some(value), "{table}: {key}");
            }
        }
    }
    let all = load(&path).unwrap();
    assert_eq!(all.value.features.len(), 144 + 35 + 407 + 144);
    assert!(all.warnings.len() == 1 && all.warnings[0].text().contains("?table=buildings"), "{:?}", all.warnings);
    assert!(load(&at(&path, "dtm")).unwrap_err().contains("it has buildings, plots, streets, tessellation"));
    assert_eq!(std::fs::read(&path).unwrap(), before);
    let folder = std::fs::read_dir(path.parent().unwrap()).unwrap();
    assert!(folder.flatten().all(|f| !f.file_name().to_string_lossy().starts_with("bubenec.gpkg-")));
}

#[test]
fn footprints_and_streets_make_a_city() {
    let Some(path) = data("city_bubenec/bubenec.gpkg") else { return };
    let city = |table| load_city(&at(&path, table), None, &Limits::default()).unwrap().value.city;
    assert_eq!((city("buildings").buildings.len(), city("streets").ways.len()), (144, 35));
    assert_eq!(city("buildings").buildings[0].id, "1", "fid");
    let file = load_city(&at(&path, "buildings"), None, &Limits::default()).unwrap().value;
    let system = file.metric_system(None).unwrap().unwrap();
    assert_eq!((file.crs.unwrap().epsg(), system.epsg()), (Some(3857), Some(32633)), "metres of Web Mercator are none");
}

#[test]
fn every_field_odd() {
    let be = Wkb { little: false };
    let nan = f64::NAN;
    let g = |wkb: Vec<u8>| Some(geometry(32633, 0, true, &wkb));
    let package = Package::new()
        .table("Odd \"one\"", 32633)
        .row("Odd \"one\"", Some(geometry(32633, 1, true, &LE.polygon(&[SQUARE, HOLE]))), "hole")
        .row(
            "Odd \"one\"",
            Some(geometry(32633, 2, false, &be.point(1001, &[1.0, 2.0, 3.0]))),
            "big-endian with height",
        )
        .row("Odd \"one\"", Some(geometry(32633, 3, true, &be.point(2001, &[1.0, 2.0, 3.0]))), "measure, both orders")
        .row(
            "Odd \"one\"",
            Some(geometry(32633, 4, true, &LE.line(3002, 4, &[1.0, 2.0, 3.0, 9.0, 4.0, 5.0, nan, 9.0]))),
            "height and measure",
        )
        .row(
            "Odd \"one\"",
            g(LE.many(4, &[LE.point(1, &[1.0, 2.0]), be.point(1, &[3.0, 4.0]), LE.point(1, &[nan, nan])])),
            "points",
        )
        .row(
            "Odd \"one\"",
            g(LE.many(5, &[LE.line(2, 2, SQUARE), LE.line(2, 2, &[1.0, 1.0]), LE.line(2, 2, &[])])),
            "lines",
        )
        .row(
            "Odd \"one\"",
            g(LE.many(6, &[LE.polygon(&[SQUARE]), LE.polygon(&[&SQUARE[..4], HOLE]), LE.polygon(&[])])),
            "polygons",
        )
        .row(
            "Odd \"one\"",
            g(LE.many(7, &[LE.point(1, &[1.0, 2.0]), LE.many(7, &[LE.line(2, 2, SQUARE)])])),
            "collection",
        )
        .row(
            "Odd \"one\"",
            Some(geometry(4326, 0, true, &LE.line(2, 2, &[1.0, 1.0, f64::INFINITY, 2.0]))),
            "not finite, another system",
        )
        .row("Odd \"one\"", None, "null")
        .row("Odd \"one\"", g(LE.point(1, &[nan, nan])), "empty point")
        .row("Odd \"one\"", g(LE.many(6, &[])), "empty polygons")
        .row(
            "Odd \"one\"",
            Some([b"GP\0\x11".as_slice(), &32633i32.to_le_bytes()].concat()),
            "empty flag without anything",
        )
        .sql("UPDATE \"Odd \"\"one\"\"\" SET height = 12.5, levels = 3, photo = x'0102' WHERE fid = 1");
    let Loaded { value, warnings, .. } = package.load().unwrap();
    assert_eq!((value.crs.epsg(), value.layer.as_str()), (Some(32633), "called Odd \"one\""));
    let names: Vec<&str> = value.features.iter().map(|f| f.name.as_str()).collect();
    let kept =
        ["hole", "big-endian with height", "measure, both orders", "height and measure", "points", "lines", "polygons"];
    assert_eq!(names, [&kept[..], &["collection", "collection"]].concat());
    let first = &value.features[0];
    let properties: Vec<String> = first.properties.iter().map(|(k, v)| format!("{k}={v}")).collect();
    assert_eq!(properties, ["fid=1", "height=12.5", "levels=3", "name=hole"], "no blobs and nothing that is null");
    let Geometry::Polygons(polygons) = &first.geometry else { panic!() };
    assert_eq!(polygons[0].iter().map(Vec::len).collect::<Vec<_>>(), [4, 3]);
    let z = |k: usize| value.features[k].geometry.vertices().map(|v| v.z).collect::<Vec<_>>();
    assert_eq!((z(1), z(2), z(3)), (vec![Some(3.0)], vec![None], vec![Some(3.0), None]));
    let counts: Vec<usize> = value.features.iter().map(|f| f.geometry.vertices().count()).collect();
    assert_eq!(counts, [7, 1, 1, 2, 2, 5, 4, 1, 5]);
    for said in [
        "5 features without geometry",
        "1 features name another coordinate system",
        "1 points, lines and rings with positions that are not finite",
        "1 lines of fewer than 2 points",
        "1 polygon rings of fewer than 3 points",
    ] {
        assert!(warnings.iter().any(|w| w.text().contains(said)), "{said}: {warnings:?}");
    }
    assert_eq!(warnings.len(), 5);
}

#[test]
fn tables_in_several_systems_come_to_that_of_the_first() {
    let line = |at: [f64; 4], srs_id| Some(geometry(srs_id, 0, true, &LE.line(2, 2, &at)));
    let degrees = CoordinateSystem::from_epsg(4326).unwrap();
    let utm = CoordinateSystem::from_epsg(32633).unwrap();
    let package = Package::new()
        .table("a", 100_001)
        .table("b", 4326)
        .row("a", line([500_000.0, 5_500_000.0, 500_100.0, 5_500_100.0], 100_001), "metres")
        .row("b", line([15.0, 49.6, 15.1, 49.7], 4326), "degrees");
    let Loaded { value, warnings, .. } = package.load().unwrap();
    assert_eq!((value.crs.epsg(), value.features.len()), (Some(32633), 2));
    let want = Transform::new(&degrees, &utm).unwrap().forward_one(glam::DVec2::new(15.0, 49.6)).unwrap();
    assert!((value.features[1].geometry.vertices().next().unwrap().xy - want).length() < 1e-6);
    assert!(warnings.iter().any(|w| w.text().contains("taken to EPSG:32633")), "{warnings:?}");
    // Undefined degrees give a warning; an undefined plane fits only scenes without georeference.
    let one = |srs_id: i64| Package::new().table("a", srs_id).row("a", line([1.0, 2.0, 3.0, 4.0], srs_id as i32), "");
    assert!(one(0).load().unwrap().warnings[0].text().contains("taken as WGS 84"));
    let plane = one(-1).load().unwrap().value;
    let lines = lines_on_terrain(&plane, Crs::Local, None).unwrap();
    assert!(lines.value.len() == 1 && lines.warnings.is_empty(), "{:?}", lines.warnings);
    let text = lines_on_terrain(&plane, Crs::Epsg(32633), None).unwrap_err().to_string();
    assert!(text.contains("not stated"), "{text}");
    for (srs_id, said) in [(77, "does not list"), (100_002, "is in \"lost\"")] {
        let text = one(srs_id).load().unwrap_err();
        assert!(text.contains(said) && text.contains("-a_srs"), "{text}");
    }
    let far = Package::new().table("a", 4326).row("a", line([1.0, 200.0, 3.0, 4.0], 4326), "").load().unwrap_err();
    assert!(far.contains("no longitude and latitude"), "{far}");
}

#[test]
fn what_cannot_be_read_is_one_error_with_its_place() {
    let with = |blob: Vec<u8>| Package::new().table("t", 4326).row("t", Some(blob), "x");
    let g = |wkb: Vec<u8>| with(geometry(4326, 0, true, &wkb));
    let curve = LE.line(8, 2, SQUARE);
    let cases: Vec<(Package, &str)> = vec![
        (g(curve.clone()), "table \"t\", fid 1: its geometry is a CircularString"),
        (g(LE.many(9, std::slice::from_ref(&curve))), "CompoundCurve"),
        (g(LE.many(1012, &[])), "MultiSurface"),
        (g(LE.many(7, &[curve])), "fid 1"),
        (g(LE.head(2)), "fid 1: its well-known binary is damaged"),
        (g([LE.head(2), LE.count(u32::MAX)].concat()), "damaged"),
        (g((0..5000).fold(LE.point(1, &[0.0; 2]), |inner, _| LE.many(7, &[inner]))), "damaged"),
        (with(b"\0\x01".to_vec()), "cut off"),
        (with(b"\0\x01\xe6\x10\0\0abcdefgh".to_vec()), "begins with the bytes 00 01"),
        (with(b"GP\0\x21\0\0\0\0".to_vec()), "extended type"),
        (with(b"GP\0\x0f\0\0\0\0".to_vec()), "envelope is of kind 7"),
        (with(b"GP\0\x05\0\0\0\0".to_vec()), "cut off"),
        (with(Vec::new()).sql("UPDATE t SET geom = 'text'"), "its geometry is Text"),
        (Package::new().table("t", 4326), "no usable geometry"),
        (Package::new(), "has no table of features"),
        (Package::new().sql("INSERT INTO gpkg_contents VALUES ('d', 'tiles', 'd', 0)"), "only tiles"),
        (Package::new().sql("DROP TABLE gpkg_geometry_columns"), "without the tables of a GeoPackage"),
        (Package::new().table("t", 4326).sql("DROP TABLE t"), "no such table"),
        (Package::new().table("t", 4326).sql("ALTER TABLE t RENAME COLUMN geom TO shape"), "no column \"GEOM\""),
        (
            Package::new().table("t", 4326).sql("DROP TABLE t; CREATE VIEW t AS SELECT 1 AS fid, NULL AS geom"),
            "table \"t\" is a view",
        ),
        (
            Package::new()
                .table("t", 4326)
                .sql("DROP TABLE t; CREATE TABLE t (fid INTEGER PRIMARY KEY, geom BLOB) WITHOUT ROWID"),
            "WITHOUT ROWID",
        ),
        (
            Package::new().sql("INSERT INTO gpkg_contents VALUES ('d', '2d-gridded-coverage', 'd', 0)"),
            "only 2d-gridded-coverage; its tiles of elevation are not read, gdal_translate",
        ),
    ];
    for (package, said) in cases {
        let start = std::time::Instant::now();
        let text = package.load().map(|l| l.value.features.len()).expect_err(said);
        assert!(text.contains(said) && text.contains("a.gpkg") && text.contains(';'), "{said}: {text}");
        assert!(start.elapsed().as_secs_f64() < 2.0, "{said}");
    }
}

#[test]
fn cut_and_damaged_packages_end_in_one_error() {
    let rows = (0..300).fold(Package::new().table("t", 4326), |p, k| {
        p.row("t", Some(geometry(4326, 0, true, &LE.polygon(&[SQUARE, HOLE]))), &format!("number {k}"))
    });
    let whole = rows.bytes();
    assert_eq!(load_bytes(&whole).unwrap().value.features.len(), 300);
    for k in 0..64 {
        let cut = whole.len() * k / 64;
        let text = load_bytes(&whole[..cut]).map(|l| l.value.features.len()).expect_err("cut");
        assert!(text.contains("get it again") || cut < 16, "{cut}: {text}");
    }
    for seed in 0..200usize {
        let mut damaged = whole.clone();
        for j in 0..8 {
            let at = (seed * 7919 + j * 104_729 + 100) % damaged.len();
            damaged[at] = damaged[at].wrapping_mul(31).wrapping_add(101);
        }
        if let Ok(loaded) = load_bytes(&damaged) {
            assert!(loaded.value.features.iter().flat_map(|f| f.geometry.vertices()).all(|v| v.xy.is_finite()));
        }
    }
}

#[test]
fn a_log_beside_the_file_is_spoken_of_and_files_in_that_mode_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gpkg");
    let mut bytes =
        Package::new().table("t", 4326).row("t", Some(geometry(4326, 0, true, &LE.point(1, &[1.0, 2.0]))), "x").bytes();
    (bytes[18], bytes[19]) = (2, 2);
    std::fs::write(&path, &bytes).unwrap();
    assert_eq!(load(&path).unwrap().warnings, []);
    std::fs::write(dir.path().join("a.gpkg-wal"), b"log").unwrap();
    let loaded = load(&path).unwrap();
    assert!(loaded.warnings[0].text().contains("a.gpkg-wal (3 bytes)"), "{:?}", loaded.warnings);
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
    // The format is recognised by the content, not by the name.
    let other = dir.path().join("a.dat");
    std::fs::write(&other, &bytes).unwrap();
    assert_eq!(load(&other).unwrap().value.format, "GeoPackage");
    std::fs::write(dir.path().join("b.gpkg"), "{}").unwrap();
    assert!(load(&dir.path().join("b.gpkg?table=t")).unwrap_err().contains("no database"));
}

#[test]
fn what_is_written_is_read_again() {
    use belvedere_io::vector::{FeatureTable, write_geopackage};
    use belvedere_io::{VectorFeature, Vertex};
    let v = |x: f64, y: f64, z: f64| Vertex { xy: glam::DVec2::new(500_000.0 + x, 5_000_000.0 + y), z: Some(z) };
    let feature = |name: &str, geometry: Geometry| VectorFeature {
        name: name.into(),
        properties: [("name", name), ("say \"so\"", "it's")].map(|(k, v)| (k.to_owned(), v.to_owned())).into(),
        style: None,
        geometry,
    };
    let line = vec![v(0.0, 0.0, 5.0), v(1.0, 2.0, 6.5), v(4.0, 2.0, -1.0)];
    let ring = vec![v(0.0, 0.0, 1.0), v(9.0, 0.0, 2.0), v(9.0, 9.0, 3.0), v(0.0, 9.0, 4.0)];
    let hole = vec![v(2.0, 2.0, 1.5), v(2.0, 3.0, 1.5), v(3.0, 3.0, 1.5)];
    let of = |name: &str, features: Vec<VectorFeature>| FeatureTable { name: name.into(), features };
    let tables = [
        of("a \"path\"", vec![feature("one", Geometry::Lines(vec![line.clone(), line]))]),
        of("lake", vec![feature("two", Geometry::Polygons(vec![vec![ring, hole]]))]),
        of(
            "peaks",
            vec![
                feature("three", Geometry::Points(vec![v(7.0, 8.0, 9.0)])),
                feature("", Geometry::Points(vec![v(1.0, 1.0, 1.0)])),
            ],
        ),
    ];
    let dir = tempfile::tempdir().unwrap();
    let crs = CoordinateSystem::from_epsg(32633).unwrap();
    let [path, again] = ["a.gpkg", "b.gpkg"].map(|name| dir.path().join(name));
    write_geopackage(&path, &tables, &crs, false).unwrap();
    write_geopackage(&again, &tables, &crs, false).unwrap();
    assert!(std::fs::read(&path).unwrap() == std::fs::read(&again).unwrap(), "the same features give the same bytes");
    for table in &tables {
        let back = load(&at(&path, &table.name)).unwrap();
        assert_eq!((back.warnings, back.value.crs), (Vec::new(), crs.clone()));
        let mut features = back.value.features;
        assert!(features.iter_mut().all(|f| f.properties.remove("fid").is_some()), "rows are numbered");
        assert_eq!(features, table.features, "{}", table.name);
    }
    // What the format itself asks for.
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!((&bytes[68..72], &bytes[60..64]), (&b"GPKG"[..], &10_300u32.to_be_bytes()[..]));
    let connection = Connection::open(&path).unwrap();
    let check: String = connection.query_row("PRAGMA integrity_check", [], |row| row.get(0)).unwrap();
    let broken = connection.prepare("PRAGMA foreign_key_check").unwrap().exists([]).unwrap();
    assert_eq!((check.as_str(), broken), ("ok", false));
    let extent: [f64; 4] = connection
        .query_row("SELECT min_x, min_y, max_x, max_y FROM gpkg_contents WHERE table_name = 'lake'", [], |r| {
            Ok([r.get(0)?, r.get(1)?, r.get(2)?, r.get(3)?])
        })
        .unwrap();
    assert_eq!(extent, [500_000.0, 5_000_000.0, 500_009.0, 5_000_009.0]);
    let fails = |tables: &[FeatureTable], crs: &CoordinateSystem| {
        write_geopackage(&dir.path().join("c.gpkg"), tables, crs, false).unwrap_err().to_string()
    };
    assert!(fails(&[tables[1].clone(), tables[1].clone()], &crs).contains("already exists"));
    // A local system comes back as one.
    let path = dir.path().join("d.gpkg");
    write_geopackage(&path, &tables, &CoordinateSystem::local(), false).unwrap();
    let Vectors { crs, crs_stated, features, .. } = load_vectors(&path).unwrap().value;
    assert!(crs.is_local() && crs_stated && !features.is_empty());
}
