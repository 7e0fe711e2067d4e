//! Clouds of points (LAS, LAZ) and grids as lines of coordinates (XYZ) as terrain.

use crate::support_files::Folder;
use belvedere_io::formats::Reader;
use belvedere_io::{Arrays, Known, Limits, LoadedTerrain, TerrainRequest, load_terrain};
use belvedere_scene::{Crs, NodeState, Progress};
use laz::{LasZipCompressor, LazVlr, LazVlrBuilder};
use std::io::{Cursor, Seek, SeekFrom};
use std::path::{Path, PathBuf};

fn load(path: &Path) -> Result<(LoadedTerrain, String), String> {
    load_with(path, &TerrainRequest::default())
}

fn load_with(path: &Path, request: &TerrainRequest) -> Result<(LoadedTerrain, String), String> {
    let loaded = load_terrain(&[PathBuf::from(path)], request, &Progress::silent()).map_err(|e| e.to_string())?;
    let said: Vec<&str> = loaded.warnings.iter().map(|w| w.text()).collect();
    Ok((loaded.value, said.join("\n")))
}

/// A point: place in centimetres from (500000, 5200000, 0), return, returns, class.
type Point = ([i32; 3], u8, u8, u8);

/// A file and how it is made.
#[derive(Clone, Copy)]
struct Cloud {
    format: u8,
    packed: bool,
    /// Whether the system stands in GeoKeys; else as text.
    keys: bool,
}

impl Cloud {
    fn record(self) -> usize {
        [20, 28, 26, 34, 57, 63, 30, 36, 38][usize::from(self.format)]
    }

    fn point(self, ([x, y, z], nth, of, class): Point) -> Vec<u8> {
        let mut out: Vec<u8> = [x, y, z].iter().flat_map(|v| v.to_le_bytes()).collect();
        out.extend([0, 0]);
        match self.format {
            0..=5 => out.extend([nth | of << 3, class]),
            _ => out.extend([nth | of << 4, 0, class]),
        }
        out.resize(self.record(), 0);
        out
    }

    fn vlr(user: &str, number: u16, content: &[u8]) -> Vec<u8> {
        let mut out = vec![0, 0];
        out.extend(user.bytes().chain([0; 16]).take(16));
        out.extend(number.to_le_bytes());
        out.extend((content.len() as u16).to_le_bytes());
        out.extend([0; 32]);
        [out, content.to_vec()].concat()
    }

    fn file(self, points: &[Point]) -> Vec<u8> {
        let mut records = Vec::new();
        if self.keys {
            let keys: [u16; 12] = [1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 25832];
            let keys: Vec<u8> = keys.iter().flat_map(|k| k.to_le_bytes()).collect();
            records.push(Self::vlr("LASF_Projection", 34735, &keys));
        } else {
            let text = b"PROJCS[\"ETRS89 / UTM zone 32N\",GEOGCS[\"ETRS89\",DATUM[\"European_Terrestrial_Reference_System_1989\",SPHEROID[\"GRS 1980\",6378137,298.257222101]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1],AUTHORITY[\"EPSG\",\"25832\"]]\0";
            records.push(Self::vlr("LASF_Projection", 2112, text));
        }
        let laz = self.packed.then(|| self.laz());
        if let Some(vlr) = &laz {
            let mut content = Vec::new();
            vlr.write_to(&mut content).expect("memory");
            records.push(Self::vlr("laszip encoded", 22204, &content));
        }
        let minor = if self.format >= 6 { 4u8 } else { 2 };
        let header = if minor == 4 { 375 } else { 227 };
        let mut out = vec![0u8; header];
        let mut put = |at: usize, bytes: &[u8]| out[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, b"LASF");
        put(24, &[1, minor]);
        put(94, &(header as u16).to_le_bytes());
        let start = header + records.iter().map(Vec::len).sum::<usize>();
        put(96, &(start as u32).to_le_bytes());
        put(100, &(records.len() as u32).to_le_bytes());
        put(104, &[self.format | if self.packed { 0x80 } else { 0 }]);
        put(105, &(self.record() as u16).to_le_bytes());
        let count = points.len() as u64;
        if minor == 4 {
            put(247, &count.to_le_bytes());
        } else {
            put(107, &(count as u32).to_le_bytes());
        }
        for (i, (scale, offset)) in [(0.01f64, 500_000.0f64), (0.01, 5_200_000.0), (0.01, 0.0)].into_iter().enumerate()
        {
            put(131 + 8 * i, &scale.to_le_bytes());
            put(155 + 8 * i, &offset.to_le_bytes());
        }
        out.extend(records.concat());
        let raw: Vec<u8> = points.iter().flat_map(|p| self.point(*p)).collect();
        let Some(vlr) = laz else { return [out, raw].concat() };
        let mut cursor = Cursor::new(out);
        cursor.seek(SeekFrom::End(0)).expect("memory");
        let mut packer = LasZipCompressor::new(cursor, vlr).expect("a packer");
        packer.compress_many(&raw).expect("memory");
        packer.done().expect("memory");
        packer.into_inner().into_inner()
    }

    fn laz(self) -> LazVlr {
        let builder = LazVlrBuilder::default().with_point_format(self.format, 0).expect("a format");
        // Several chunks, so that their borders are tried.
        builder.with_fixed_chunk_size(500).build()
    }
}

/// Height of the made ground, centimetres.
fn ground(x: i32, y: i32) -> i32 {
    10_000 + 2 * x - y
}

/// Ground every 50 cm over 30 m x 20 m, and where `trees` a first return 8 m above each.
fn points(class: u8, trees: bool) -> Vec<Point> {
    let mut out = Vec::new();
    for j in 0..40 {
        for i in 0..60 {
            let (x, y) = (50 * i + 25, 50 * j + 25);
            if trees {
                out.push(([x, y, ground(x, y) + 800], 1, 2, 5));
            }
            out.push(([x, y, ground(x, y)], if trees { 2 } else { 1 }, if trees { 2 } else { 1 }, class));
        }
    }
    // Noise and points that are withheld count nowhere.
    out.push(([100, 100, 900_000], 1, 1, 7));
    out.push(([100, 100, -900_000], 1, 1, 7));
    out
}

const PLAIN: Cloud = Cloud { format: 1, packed: false, keys: true };

/// Heights of the nodes of a terrain: the plane with the given rise, metres.
fn is_plane(found: &LoadedTerrain, rise: f64) {
    let field = &found.heightfield;
    assert_eq!((found.crs, field.spacing().x, field.spacing().y), (Crs::Epsg(25832), 1.0, 1.0));
    assert_eq!((field.cols(), field.rows()), (30, 20));
    for row in 0..field.rows() {
        for col in 0..field.cols() {
            let p = field.node_xy(col, row);
            let (x, y) = (p.x - 500_000.0, p.y - 5_200_000.0);
            let wanted = 100.0 + 2.0 * x - y + rise;
            let height = field.node(col, row).expect("a height").z;
            assert!((height - wanted).abs() < 0.02, "{col} {row}: {height} {wanted}");
        }
    }
}

#[test]
fn ground_points_are_terrain() {
    let folder = Folder::new();
    for format in [0, 1, 2, 3, 6, 7, 8] {
        for packed in [false, true] {
            let cloud = Cloud { format, packed, keys: format % 2 == 0 };
            let bytes = cloud.file(&points(2, true));
            for name in ["a.las", "a.laz", "without_an_ending"] {
                let path = folder.file(name, &bytes);
                let (found, said) = load(&path).expect("it is read");
                is_plane(&found, 0.0);
                let want =
                    "of 4802 points the mean of its 2400 ground points (class 2) in each cell of 1 is its height";
                assert!(said.contains(want), "{said}");
                assert_eq!(Known::of(&path, &Arrays::default()).expect("a file").reader, Some(Reader::Terrain));
            }
        }
    }
}

#[test]
fn without_ground_the_highest_first_return_counts() {
    let folder = Folder::new();
    let all: Vec<Point> = points(0, true).into_iter().collect();
    let (found, said) = load(&folder.file("a.las", &PLAIN.file(&all))).expect("it is read");
    assert!(
        said.contains("none of its points is called ground (class 2), so the highest of 2400 first returns"),
        "{said}"
    );
    let field = &found.heightfield;
    // Of the four first returns of a cell that in the south-east is the highest.
    let p = field.node_xy(3, 4);
    let (x, y) = (p.x - 500_000.0 + 0.25, p.y - 5_200_000.0 - 0.25);
    assert!((field.node(3, 4).expect("a height").z - (108.0 + 2.0 * x - y)).abs() < 0.02);
}

#[test]
fn cells_without_points_are_void_and_many_points_take_larger_cells() {
    let folder = Folder::new();
    let holed: Vec<Point> =
        points(2, false).into_iter().filter(|(p, ..)| !(1000..2000).contains(&p[0]) || p[1] > 1000).collect();
    let path = folder.file("a.las", &PLAIN.file(&holed));
    let (found, _) = load(&path).expect("it is read");
    let field = &found.heightfield;
    let voids = (0..field.rows()).flat_map(|r| (0..field.cols()).map(move |c| (c, r)));
    assert_eq!(voids.filter(|(c, r)| field.states()[r * field.cols() + c] == NodeState::Void).count(), 100);
    let request = TerrainRequest { max_nodes: 200, ..Default::default() };
    let (found, said) = load_with(&path, &request).expect("it is read");
    assert!(found.heightfield.cols() * found.heightfield.rows() <= 200);
    assert!(said.contains("larger cells than the points allow keep the limit of nodes"), "{said}");
}

#[test]
fn damaged_clouds_are_one_error() {
    let folder = Folder::new();
    let few: Vec<Point> = points(2, false).into_iter().take(900).collect();
    for format in [1, 6] {
        for packed in [false, true] {
            let whole = Cloud { format, packed, keys: true }.file(&few);
            for length in (0..500).chain((500..whole.len().min(5000)).step_by(97)) {
                if length < whole.len() {
                    let error = load(&folder.file("cut.las", &whole[..length])).err();
                    // The table of chunks at the end of packed points is not needed.
                    assert!(
                        error.is_some_and(|e| e.lines().count() == 1) || packed && length + 60 > whole.len(),
                        "{length}"
                    );
                }
            }
        }
    }
    let whole = PLAIN.file(&few);
    let with = |at: usize, bytes: &[u8]| {
        let mut odd = whole.clone();
        odd[at..at + bytes.len()].copy_from_slice(bytes);
        load(&folder.file("odd.las", &odd)).expect_err("it is refused")
    };
    for (at, bytes, said) in [
        (25, &[5u8][..], "its version is 1.5"),
        (104, &[11], "format 11"),
        (105, &[5, 0], "have 5 bytes, 28 are needed"),
        (107, &[0; 4], "it has no points"),
        (107, &[0xff; 4], "it declares 4294967295 points and holds 900"),
        (96, &[0xff; 4], "begin at byte 4294967295"),
        (131, &[0; 8], "give no places"),
        (104, &[0x81], "does not say how"),
    ] {
        let error = with(at, bytes);
        assert!(error.contains(said), "{error}");
    }
    // Claims of many points are refused before they are kept.
    let mut many = Cloud { format: 6, packed: true, keys: true }.file(&few);
    many[247..255].copy_from_slice(&1_000_000_000_000u64.to_le_bytes());
    let request = TerrainRequest { limits: Limits { max_bytes: 1 << 30 }, ..Default::default() };
    let error = load_with(&folder.file("many.laz", &many), &request).map(drop).expect_err("too many");
    assert!(error.contains("the points needs") || error.contains("the points need"), "{error}");
}

#[test]
fn damaged_packed_points_never_panic() {
    let folder = Folder::new();
    let few: Vec<Point> = points(2, true).into_iter().take(1200).collect();
    let mut random = belvedere_testkit::Random::new(7);
    for format in [1, 3, 6, 7] {
        let whole = Cloud { format, packed: true, keys: true }.file(&few);
        for _ in 0..150 {
            let mut odd = whole.clone();
            for _ in 0..1 + random.below(4) {
                let at = random.below(odd.len());
                odd[at] = random.below(256) as u8;
            }
            let request =
                TerrainRequest { limits: Limits { max_bytes: 64 << 20 }, max_nodes: 10_000, ..Default::default() };
            if let Err(error) = load_with(&folder.file("odd.laz", &odd), &request) {
                assert_eq!(error.lines().count(), 1, "{error}");
            }
        }
    }
}

#[test]
fn lines_of_coordinates_on_a_grid_are_terrain() {
    let folder = Folder::new();
    let height = |c: usize, r: usize| 100.0 + 3.0 * c as f64 - r as f64;
    let text = |separator: &str, header: &str, end: &str| {
        let mut out = header.to_owned();
        for r in 0..5 {
            for c in 0..7 {
                if (c, r) != (2, 3) {
                    let (x, y) = (2_600_000.5 + 2.0 * c as f64, 1_200_009.0 - 2.0 * r as f64);
                    out.push_str(&format!("{x:.1}{separator}{y:.1}{separator}{:.2}{end}", height(c, r)));
                }
            }
        }
        out
    };
    for (name, content) in [
        ("a.xyz", text(" ", "", "\n")),
        ("b.xyz", text(",", "X,Y,Z\n", "\r\n")),
        ("c.xyz", text(";", "", "\n")),
        ("d.txt", text("\t", "", "\n")),
        ("without_an_ending", text("  ", "x y z\n", "\n")),
    ] {
        let path = folder.file(name, content.as_bytes());
        let request = TerrainRequest { source_crs: Some(2056), ..Default::default() };
        let (found, _) = load_with(&path, &request).expect("it is read");
        let field = &found.heightfield;
        assert_eq!((field.cols(), field.rows(), field.spacing().x), (7, 5, 2.0), "{name}");
        for (c, r) in [(0, 0), (6, 0), (3, 2), (6, 4)] {
            assert_eq!(field.node(c, r).map(|p| p.z), Some(height(c, r)), "{name}");
        }
        assert_eq!(field.states()[3 * 7 + 2], NodeState::Void);
        assert_eq!(Known::of(&path, &Arrays::default()).expect("a file").reader, Some(Reader::Terrain));
    }
    // What is whole before a cut is read.
    let whole = text(" ", "", "\n");
    let (_, said) = load(&folder.file("cut.xyz", &whole.as_bytes()[..whole.len() - 12])).expect("it is read");
    assert!(said.contains("last line, 34, is not whole; the 33 points before are read"), "{said}");
}

#[test]
fn other_lines_are_told() {
    let folder = Folder::new();
    let scattered: String = (0..500)
        .map(|i| format!("{} {} 5\n", (i * 7919 % 1009) as f64 * 0.37, (i * 104_729 % 997) as f64 * 0.73))
        .collect();
    for (content, said) in [
        (scattered.as_str(), "its 500 points do not lie on a grid"),
        ("1 2 3\n1 2 3\n", "its 2 points do not lie on a grid"),
        ("1 2 3\n4 5 x\n7 8 9\n", "line 2 is \"4 5 x\", three numbers x y z are needed"),
        ("", "is empty"),
        (
            "2\nwater\nO 0 0 0\nH 0 0 1\n",
            "holds XYZ of atoms (atoms of a molecule); it is read by layers of kind molecule",
        ),
        ("Lerc2 \0\0\0\0", "is LERC (a raster), which this version does not read"),
    ] {
        let error = load(&folder.file("a.xyz", content.as_bytes())).expect_err("it is refused");
        assert!(error.contains(said), "{error}");
    }
}
