//! Pyramids of tiles of heights against a GeoTIFF of the same ground, and files that hold something else or are damaged.

use crate::atomic::Folder;
use crate::pyramid_writer::{Code, HALF_M, Tile, folder, mapbox, mbtiles, pixels, pmtiles, terrarium, tile, webp};
use crate::terrain::load;
use belvedere_core::WarningKind;
use belvedere_io::geotiff::write_geotiff;
use belvedere_io::terrain::survey;
use belvedere_io::{
    Affine, Arrays, CrsKind, Known, Limits, LoadedTerrain, Raster, RasterInfo, SampleType, Samples, SourceCrs,
    TerrainRequest, formats::Reader,
};
use belvedere_scene::{NodeState, Progress};
use std::fs;
use std::path::{Path, PathBuf};

/// Tiles of the tests: zoom 12, two columns and two rows in the Alps.
const ZOOM: u64 = 12;
const FIRST: [u64; 2] = [2132, 1446];

/// Hills of 1000 to 1800 m, of wave lengths of some kilometres.
fn hills(x: f64, y: f64) -> Option<f64> {
    Some(1400.0 + 250.0 * (x / 2300.0).sin() + 150.0 * (y / 1700.0).cos())
}

fn tiles(zooms: &[u64], side: usize, code: Code) -> Vec<Tile> {
    let mut out = Vec::new();
    for zoom in zooms {
        let up = ZOOM - zoom;
        for row in FIRST[1] >> up..=(FIRST[1] + 1) >> up {
            for column in FIRST[0] >> up..=(FIRST[0] + 1) >> up {
                out.push(tile([*zoom, column, row], side, code, &hills));
            }
        }
    }
    out
}

/// A GeoTIFF on the lattice of the tiles.
fn geotiff(path: &Path, side: usize) {
    let step = 2.0 * HALF_M / (side as f64 * (1u64 << ZOOM) as f64);
    let [left, top] = FIRST.map(|n| n as f64 * side as f64 * step);
    let mut info = RasterInfo::new(path, 2 * side, 2 * side, SampleType::F32);
    info.pixel_to_model = Some(Affine([step, 0.0, left - HALF_M, 0.0, -step, HALF_M - top]));
    (info.crs, info.crs_kind) = (SourceCrs::Epsg(3857), CrsKind::Projected);
    let height = |i: usize| {
        let (c, r) = ((i % (2 * side)) as f64 + 0.5, (i / (2 * side)) as f64 + 0.5);
        hills(left - HALF_M + c * step, HALF_M - top - r * step).expect("a height") as f32
    };
    let samples = Samples::F32((0..4 * side * side).map(height).collect());
    write_geotiff(path, &Raster { info, samples, mask: None }, true).unwrap();
}

fn same(a: &LoadedTerrain, b: &LoadedTerrain, step: f64) {
    let (a, b) = (&a.heightfield, &b.heightfield);
    assert_eq!([a.cols(), a.rows()], [b.cols(), b.rows()]);
    assert!((a.north_west() - b.north_west()).length() < 1e-6 && (a.spacing() - b.spacing()).length() < 1e-9);
    let off = a.heights().iter().zip(b.heights()).map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
    assert!(off <= 0.5 * step + 2e-4, "heights differ by {off} m, the step is {step} m");
    assert_eq!(a.share_of(NodeState::Void), 0.0);
}

fn failure(path: &Path) -> String {
    load(&[path.to_owned()], &TerrainRequest::default()).expect_err("refused").to_string()
}

#[test]
fn every_kind_of_pyramid_gives_the_heights_of_a_geotiff_of_the_same_ground() {
    let files = Folder::new("pyramid-kinds");
    let request = TerrainRequest::default();
    for (code, step, side) in [(mapbox as Code, 0.1, 256), (terrarium as Code, 1.0 / 256.0, 512)] {
        let name = |ending: &str| files.0.join(format!("{side}.{ending}"));
        geotiff(&name("tif"), side);
        let want = load(&[name("tif")], &request).unwrap().0;
        let tiles = tiles(&[10, 11, 12], side, code);
        mbtiles(&name("mbtiles"), &[("format", "png")], &tiles, false);
        mbtiles(&name("view.mbtiles"), &[], &tiles, true);
        fs::write(name("pmtiles"), pmtiles("{}", &tiles, 2, 100, 2)).unwrap();
        fs::write(name("leaf.pmtiles"), pmtiles("{}", &tiles, 0, 2, 1)).unwrap();
        let folders = [folder(&name("folder"), "png", &tiles)];
        let names = ["mbtiles", "view.mbtiles", "pmtiles", "leaf.pmtiles"].map(name);
        for path in names.iter().chain(&folders) {
            let (found, warnings) = load(std::slice::from_ref(path), &request).unwrap();
            same(&found, &want, step);
            let said = warnings.iter().filter(|w| w.kind() == WarningKind::Assumed).count();
            assert_eq!(said, 1, "{}: {warnings:?}", path.display());
            assert_eq!(Known::of(path, &Arrays::default()).unwrap().reader, Some(Reader::Terrain));
        }
        // Without a name that tells.
        for ending in ["mbtiles", "pmtiles"] {
            fs::copy(name(ending), files.0.join("nameless")).unwrap();
            same(&load(&[files.0.join("nameless")], &request).unwrap().0, &want, step);
        }
    }
}

#[test]
fn tiles_as_webp_and_with_a_border_are_read_and_a_stated_encoding_is_not_doubted() {
    let files = Folder::new("pyramid-webp");
    let [column, row] = FIRST;
    let shown = pixels([ZOOM, column, row], 256, mapbox, &hills);
    let lossless: Vec<Tile> = vec![(12, column, row, webp(256, &shown))];
    let root = folder(&files.0.join("webp"), "webp", &lossless);
    fs::write(root.join("tiles.json"), r#"{"encoding": "mapbox"}"#).unwrap();
    let (plain, warnings) = load(&[root], &TerrainRequest::default()).unwrap();
    assert!(warnings.iter().all(|w| w.kind() != WarningKind::Assumed), "{warnings:?}");
    assert_eq!([plain.heightfield.cols(), plain.heightfield.rows()], [256, 256]);
    // A border of one pixel around 256.
    let bordered: Vec<u8> = (0..258 * 258)
        .flat_map(|i: usize| match (i % 258, i / 258) {
            (1..=256, 1..=256) => shown[(i / 258 - 1) * 256 + i % 258 - 1],
            _ => mapbox(Some(8000.0)),
        })
        .collect();
    let mut bytes = Vec::new();
    belvedere_io::png::encode(&mut bytes, 258, 258, belvedere_io::png::Channels::Rgba, &bordered, &[]).unwrap();
    let root = folder(&files.0.join("border"), "png", &[(12, column, row, bytes)]);
    same(&load(&[root], &TerrainRequest::default()).unwrap().0, &plain, 0.0);
}

#[test]
fn of_what_several_zooms_cover_the_deepest_counts_and_what_none_covers_is_void() {
    let files = Folder::new("pyramid-zooms");
    let [column, row] = FIRST;
    // Three tiles of zoom 12, one of which is half transparent; the fourth only has its ancestor of zoom 11, 1 m higher throughout.
    let half = |x: f64, y: f64| hills(x, y).filter(|_| x > 2.0 * HALF_M * (column as f64 + 0.5) / 4096.0 - HALF_M);
    let higher = |x: f64, y: f64| hills(x, y).map(|h| h + 1.0);
    let deep = vec![
        tile([12, column, row], 256, mapbox, &half),
        tile([12, column + 1, row], 256, mapbox, &hills),
        tile([12, column + 4, row], 256, mapbox, &hills),
    ];
    let above = tile([11, column / 2, row / 2], 256, mapbox, &higher);
    let all = [deep, vec![above]].concat();
    let path = files.0.join("a.mbtiles");
    mbtiles(&path, &[("encoding", "mapbox")], &all, false);
    let (terrain, _) = load(&[path], &TerrainRequest::default()).unwrap();
    let field = &terrain.heightfield;
    // The area of the tiles below which there is none: the transparent half is trimmed.
    assert_eq!([field.cols(), field.rows()], [5 * 256 - 128, 256]);
    assert_eq!(terrain.void_samples, 128 * 256 + 2 * 256 * 256);
    let at = |c: usize, r: usize| field.node(c, r).map(|p| (p.z - hills(p.x, p.y).unwrap()).abs());
    assert!(at(10, 10).unwrap() <= 0.051 && at(300, 200).unwrap() <= 0.051);
    assert_eq!(field.states()[600], NodeState::Void);
}

#[test]
fn a_tile_that_is_damaged_is_made_of_the_one_above_and_is_counted() {
    let files = Folder::new("pyramid-damaged");
    let mut all = tiles(&[11, 12], 256, mapbox);
    let broken = all.last_mut().expect("a tile");
    let length = broken.3.len();
    broken.3.truncate(length / 2);
    let path = files.0.join("a.pmtiles");
    fs::write(&path, pmtiles(r#"{"encoding":"mapbox"}"#, &all, 2, 100, 2)).unwrap();
    let (terrain, warnings) = load(&[path], &TerrainRequest::default()).unwrap();
    let said: Vec<_> = warnings.iter().filter(|w| w.text().contains("cannot be read and count as absent")).collect();
    assert_eq!(said.len(), 1, "{warnings:?}");
    assert!(said[0].text().contains("12/2133/1447"), "{}", said[0].text());
    let field = &terrain.heightfield;
    assert_eq!(field.share_of(NodeState::Void), 0.0);
    let off = (0..512 * 512).map(|i| field.node(i % 512, i / 512).expect("a node"));
    let off = off.map(|p| (p.z - hills(p.x, p.y).unwrap()).abs()).fold(0.0, f64::max);
    assert!(off < 2.0, "{off}");
}

#[test]
fn a_small_budget_of_nodes_takes_lower_zooms_or_means_of_four() {
    let files = Folder::new("pyramid-budget");
    let path = files.0.join("a.pmtiles");
    for zooms in [&[10, 11, 12][..], &[12]] {
        fs::write(&path, pmtiles(r#"{"encoding":"terrarium"}"#, &tiles(zooms, 256, terrarium), 2, 100, 2)).unwrap();
        let request = TerrainRequest { max_nodes: 70_000, ..TerrainRequest::default() };
        let (terrain, warnings) = load(std::slice::from_ref(&path), &request).unwrap();
        let field = &terrain.heightfield;
        assert_eq!([field.cols(), field.rows()], [256, 256]);
        assert!(warnings.iter().any(|w| w.kind() == WarningKind::Reduced), "{warnings:?}");
        let off = (0..256 * 256).map(|i| field.node(i % 256, i / 256).expect("a node"));
        let off = off.map(|p| (p.z - hills(p.x, p.y).unwrap()).abs()).fold(0.0, f64::max);
        assert!(off < 0.5, "{zooms:?}: {off}");
        let survey = survey(&path, &request, &Progress::silent()).unwrap().value;
        assert_eq!(survey.size, [512, 512]);
    }
}

#[test]
fn tiles_far_apart_cost_no_more_than_the_budget() {
    let files = Folder::new("pyramid-far");
    let last = (1 << 20) - 1;
    let all = [[20, 0, 0], [20, last, last]].map(|place| tile(place, 256, mapbox, &|_, _| Some(500.0)));
    let path = files.0.join("a.mbtiles");
    mbtiles(&path, &[("encoding", "mapbox")], &all, false);
    let small = Limits { max_bytes: 64 << 20 };
    let request = TerrainRequest { limits: small, max_nodes: usize::MAX, ..TerrainRequest::default() };
    let refused = load(std::slice::from_ref(&path), &request).unwrap_err();
    assert!(refused.to_string().contains("allow more memory"), "{refused}");
    // Of the whole Earth there is one sample of each tile at most.
    let request = TerrainRequest { limits: small, max_nodes: 100_000, ..TerrainRequest::default() };
    let (terrain, _) = load(&[path], &request).unwrap();
    assert!(terrain.heightfield.heights().len() <= 100_000);
}

#[test]
fn pictures_vectors_and_other_packings_are_refused_by_name() {
    let files = Folder::new("pyramid-refused");
    let write = |name: &str, bytes: &[u8]| -> PathBuf {
        fs::write(files.0.join(name), bytes).unwrap();
        files.0.join(name)
    };
    let picture = |bytes: &[u8]| vec![(3u8, 4, 2, bytes.to_vec())];
    // A photograph: colours that change from pixel to pixel.
    let photo = |x: f64, y: f64| Some((x / 3e4 + 7.0 * (y / 3e4).floor()).abs());
    let colours: Code = |h| [20, 90, 150, 60, 200].map(|k| k + h.unwrap_or(0.0) as u8 % 50)[..4].try_into().expect("4");
    let plain = tiles(&[12], 256, mapbox);
    let zipped = b"\x1f\x8b\x08rest";
    let base = |name: &str, metadata: &[(&str, &str)], tiles: &[Tile]| {
        mbtiles(&files.0.join(name), metadata, tiles, false);
        files.0.join(name)
    };
    let mut other_version = pmtiles("{}", &plain, 2, 100, 2);
    other_version[7] = 2;
    let mut brotli = pmtiles("{}", &plain, 2, 100, 2);
    brotli[97] = 3;
    let cases = [
        (base("v.mbtiles", &[("format", "pbf")], &plain), "ogr2ogr turns them into GeoJSON"),
        (base("w.mbtiles", &[], &picture(zipped)), "holds vector tiles (pbf)"),
        (base("j.mbtiles", &[], &picture(b"\xff\xd8\xff\xe0")), "holds tiles of pictures (JPEG)"),
        (base("p.mbtiles", &[], &[tile([3, 4, 2], 64, colours, &photo)]), "neither terrain-RGB nor Terrarium fits"),
        (base("e.mbtiles", &[], &[]), "holds no tiles"),
        (write("v.pmtiles", &pmtiles("{}", &plain, 1, 100, 2)), "holds vector tiles (pbf)"),
        (write("2.pmtiles", &other_version), "PMTiles of version 2"),
        (write("b.pmtiles", &brotli), "packed by Brotli"),
        (folder(&files.0.join("jpg"), "jpg", &plain), "holds tiles of pictures (JPEG)"),
        (folder(&files.0.join("pbf"), "pbf", &plain), "holds vector tiles (pbf)"),
    ];
    for (path, want) in cases {
        let found = failure(&path);
        assert!(found.contains(want) && found.len() < 500, "{}: {found}", path.display());
    }
}

#[test]
fn heights_that_there_are_not_are_void() {
    let files = Folder::new("pyramid-absurd");
    for (name, code) in [("a.mbtiles", mapbox as Code), ("b.mbtiles", terrarium)] {
        let [column, row] = FIRST;
        let west = 2.0 * HALF_M * (column as f64 + 0.0625) / 4096.0 - HALF_M;
        let height = |x: f64, y: f64| if x < west { Some(-32_768.0) } else { hills(x, y) };
        // Of the first encoding this wraps round to a height far above all mountains.
        let path = files.0.join(name);
        mbtiles(&path, &[], &[tile([ZOOM, column, row], 256, code, &height)], false);
        let (terrain, _) = load(&[path], &TerrainRequest::default()).unwrap();
        assert_eq!((terrain.void_samples, terrain.heightfield.cols()), (16 * 256, 240), "{name}");
        assert!(terrain.heightfield.z_range()[0] > 900.0);
    }
}

#[test]
fn an_encoding_that_is_stated_wrongly_is_told_and_put_right() {
    let files = Folder::new("pyramid-stated");
    let path = files.0.join("a.mbtiles");
    mbtiles(&path, &[("encoding", "mapbox")], &tiles(&[12], 256, terrarium), false);
    let (terrain, warnings) = load(&[path], &TerrainRequest::default()).unwrap();
    assert!(warnings.iter().any(|w| w.text().contains("state the encoding \"mapbox\", which does not fit")));
    let node = terrain.heightfield.node(5, 5).expect("a node");
    assert!((node.z - hills(node.x, node.y).unwrap()).abs() < 0.01);
}

#[test]
fn a_file_of_tiles_that_is_cut_off_gives_one_error() {
    let files = Folder::new("pyramid-cut");
    let plain = tiles(&[11, 12], 256, mapbox);
    let path = files.0.join("a.mbtiles");
    mbtiles(&path, &[], &plain, false);
    for (name, bytes) in [("cut.pmtiles", pmtiles("{}", &plain, 2, 2, 2)), ("cut.mbtiles", fs::read(&path).unwrap())] {
        for k in 0..100 {
            let cut = files.0.join(name);
            fs::write(&cut, &bytes[..bytes.len() * k / 100]).unwrap();
            let error = failure(&cut);
            assert!(!error.contains('\n') && error.len() < 500, "{error}");
        }
    }
}
