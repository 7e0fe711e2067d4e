//! Terrain: exact where no resampling is needed, with a measured error where it is, and voids never blend into heights.

use crate::atomic::Folder;
use crate::tiff_writer::PLAIN;
use belvedere_core::Warning;
use belvedere_io::crs::Transform;
use belvedere_io::geotiff::write_geotiff;
use belvedere_io::{
    Affine, CrsChoice, CrsKind, IoError, Limits, LoadedTerrain, Raster, RasterInfo, SampleType, Samples, SourceCrs,
    TerrainRequest, hgt, load_terrain,
};
use belvedere_scene::{Crs, NodeState, Progress};
use belvedere_testkit::data;
use glam::DVec2;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(crate) fn load(paths: &[PathBuf], request: &TerrainRequest) -> Result<(LoadedTerrain, Vec<Warning>), IoError> {
    load_terrain(paths, request, &Progress::silent()).map(|l| (l.value, l.warnings))
}

fn simple(path: PathBuf) -> LoadedTerrain {
    load(&[path], &TerrainRequest::default()).unwrap().0
}

/// Writes an ESRI ASCII grid.
pub(crate) fn write_asc(
    path: &Path,
    cols: usize,
    rows: usize,
    x: f64,
    y: f64,
    cell: f64,
    z: &dyn Fn(usize, usize) -> f64,
) {
    let mut text = format!(
        "ncols {cols}\nnrows {rows}\nxllcenter {x:.12}\nyllcenter {y:.12}\ncellsize {cell:.12}\nNODATA_value -9999\n"
    );
    for r in 0..rows {
        for c in 0..cols {
            write!(text, "{} ", z(c, r)).unwrap();
        }
        text.push('\n');
    }
    fs::write(path, text).unwrap();
}

/// Columns, rows and heights by GDAL 3 (through rasterio 1.4.4); positions of pixel centres.
#[test]
fn projected_rasters_are_used_exactly() {
    let cases: [(&str, u32, [usize; 2], DVec2, f64); 6] = [
        ("bigtujunga/bigtujunga.tif", 32611, [0, 0], DVec2::new(376328.6554542635, 3807902.8276283755), 945.0),
        ("bigtujunga/bigtujunga.tif", 32611, [600, 300], DVec2::new(394328.6554542635, 3798902.8276283755), 1201.0),
        ("bigtujunga/bigtujunga.tif", 32611, [1196, 642], DVec2::new(412208.6554542635, 3788642.8276283755), 872.0),
        (
            "grand_canyon/grandcanyon_dem_3857.tif",
            3857,
            [100, 400],
            DVec2::new(-12594032.309864637, 4313456.161674925),
            1833.0,
        ),
        (
            "grand_canyon/grandcanyon_dem_3857.tif",
            3857,
            [511, 511],
            DVec2::new(-12562616.69123943, 4304971.651535272),
            1828.0,
        ),
        (
            "swellendam/srtm_41_19_utm33s.tif",
            32733,
            [400, 300],
            DVec2::new(1002329.6425951082, 6225657.970992579),
            446.0,
        ),
    ];
    for (name, code, [c, r], xy, z) in cases {
        let Some(path) = data(name) else { continue };
        let terrain = simple(path);
        assert_eq!(terrain.crs, Crs::Epsg(code), "{name}");
        assert_eq!(terrain.resample_error, None, "{name}");
        let node = terrain.heightfield.node(c, r).unwrap();
        assert!((node.truncate() - xy).length() < 1e-6, "{name}: {node} is not at {xy}");
        assert_eq!(node.z, z, "{name} node {c}, {r}");
    }
}

#[test]
fn web_mercator_is_said_to_be_too_long() {
    let Some(path) = data("grand_canyon/grandcanyon_dem_3857.tif") else { return };
    let (_, warnings) = load(std::slice::from_ref(&path), &TerrainRequest::default()).unwrap();
    assert!(warnings.iter().any(|w| w.text().contains("1.24 times too long")), "{warnings:?}");
    let request = TerrainRequest { crs: CrsChoice::Epsg(32612), max_error_p99_m: f64::INFINITY, ..Default::default() };
    let (utm, warnings) = load(&[path], &request).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    // 76.437 m of Mercator at latitude 36.17
    assert!((utm.source_spacing_m - DVec2::splat(61.7)).abs().max_element() < 0.2, "{}", utm.source_spacing_m);
}

/// The samples of the source, read without the terrain loader.
struct Tile {
    heights: Vec<f64>,
    side: usize,
    north_west: DVec2,
}

impl Tile {
    fn hgt(path: &Path) -> Self {
        let raster = hgt::read(path, &Limits::default()).unwrap().value;
        let side = raster.info.width;
        let heights = (0..side * side).map(|i| raster.sample_f64(0, i % side, i / side).unwrap_or(f64::NAN)).collect();
        Self { heights, side, north_west: DVec2::new(1.0, 43.0) }
    }

    fn lon_lat(&self, c: usize, r: usize) -> DVec2 {
        let n = (self.side - 1) as f64;
        DVec2::new(self.north_west.x + c as f64 / n, self.north_west.y - r as f64 / n)
    }

    /// Bilinear height, NaN beside a void, `None` outside.
    fn at(&self, lon_lat: DVec2) -> Option<f64> {
        let n = (self.side - 1) as f64;
        let g = DVec2::new((lon_lat.x - self.north_west.x) * n, (self.north_west.y - lon_lat.y) * n);
        if g.min_element() < 0.0 || g.max_element() > n {
            return None;
        }
        let (c, r) = ((g.x as usize).min(self.side - 2), (g.y as usize).min(self.side - 2));
        let (u, v) = (g.x - c as f64, g.y - r as f64);
        let z = |dc: usize, dr: usize| self.heights[(r + dr) * self.side + c + dc];
        Some(z(0, 0) * (1.0 - u) * (1.0 - v) + z(1, 0) * u * (1.0 - v) + z(0, 1) * (1.0 - u) * v + z(1, 1) * u * v)
    }
}

/// Law: without correction every node of the scene is the bilinear height of the source at its exact position, and a
/// void wherever the source has no height there.
#[test]
fn resampled_nodes_are_bilinear_and_voids_do_not_leak() {
    let Some(path) = data("andorra/N42E001.hgt") else { return };
    let tile = Tile::hgt(&path);
    let request = TerrainRequest { max_error_p99_m: f64::INFINITY, ..Default::default() };
    let (terrain, warnings) = load(&[path], &request).unwrap();
    assert_eq!(terrain.crs, Crs::Epsg(32631));
    assert_eq!(terrain.void_samples, 7652);
    assert!(warnings.iter().any(|w| w.text().contains("7652")), "{warnings:?}");
    let to_lon_lat = Transform::between_epsg(32631, 4326).unwrap();
    let h = &terrain.heightfield;
    let (mut measured, mut holes) = (0, 0);
    for r in (0..h.rows()).step_by(3) {
        for c in (0..h.cols()).step_by(3) {
            let truth = tile.at(to_lon_lat.forward_one(h.node_xy(c, r)).unwrap());
            match (h.node(c, r), truth) {
                (Some(node), Some(z)) => {
                    assert!((node.z - z).abs() < 0.15, "node {c}, {r}: {} is not {z}", node.z);
                    measured += 1;
                }
                (None, Some(z)) => {
                    // beside a void, or within the slack of the map at the border
                    holes += usize::from(z.is_nan());
                }
                (Some(node), None) => assert!(node.z.is_finite()),
                (None, None) => {}
            }
        }
    }
    assert!(measured > 150_000 && holes > 700, "{measured} measured, {holes} holes");
    assert!((terrain.source_spacing_m - DVec2::new(68.5, 92.5)).abs().max_element() < 0.1);
}

/// Heights at four points, bilinear in the source, by pyproj and numpy.
#[test]
fn andorra_in_the_scene_is_andorra() {
    let Some(path) = data("andorra/N42E001.hgt") else { return };
    let terrain = simple(path.clone());
    let cases = [
        (377000.0, 4700500.0, 1446.3378234352363),
        (390500.0, 4712000.0, 2312.2171835937975),
        (378553.02, 4707051.28, 1017.4007319357835),
        (360123.0, 4680321.0, 1513.913413756141),
    ];
    for (x, y, z) in cases {
        let got = terrain.heightfield.height_at(DVec2::new(x, y)).unwrap();
        assert!((got - z).abs() < 12.0, "({x}, {y}): {got} against {z}");
    }
    let extent = terrain.extent_deg.unwrap();
    for (got, expected) in extent.iter().zip([1.0, 42.0, 2.0, 43.0]) {
        assert!((got - expected).abs() < 1e-9, "{extent:?}");
    }
    let zipped = simple(path.with_extension("hgt.zip"));
    assert_eq!(zipped.heightfield, terrain.heightfield);
}

/// The reported error is the true one, and correcting lowers it without leaving the range of the source.
#[test]
fn the_error_of_resampling_is_measured_and_small() {
    let Some(path) = data("andorra/N42E001.hgt") else { return };
    let tile = Tile::hgt(&path);
    let to_scene = Transform::between_epsg(4326, 32631).unwrap();
    let plain = TerrainRequest { max_error_p99_m: f64::INFINITY, ..Default::default() };
    let (plain, _) = load(std::slice::from_ref(&path), &plain).unwrap();
    let (corrected, _) = load(&[path], &TerrainRequest::default()).unwrap();
    for terrain in [&plain, &corrected] {
        let mut errors = Vec::new();
        for r in (0..tile.side).step_by(2) {
            for c in (0..tile.side).step_by(2) {
                let xy = to_scene.forward_one(tile.lon_lat(c, r)).unwrap();
                let z = tile.heights[r * tile.side + c];
                errors.extend(terrain.heightfield.height_at(xy).map(|h| (h - z).abs()).filter(|e| e.is_finite()));
            }
        }
        assert!(errors.len() > 350_000);
        errors.sort_by(f64::total_cmp);
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let p99 = errors[errors.len() * 99 / 100];
        let reported = terrain.resample_error.unwrap();
        assert!((reported.rms_m - rms).abs() < 0.02 * rms, "{reported:?} against rms {rms}");
        assert!((reported.p99_m - p99).abs() < 0.02 * p99, "{reported:?} against p99 {p99}");
    }
    let (before, after) = (plain.resample_error.unwrap(), corrected.resample_error.unwrap());
    assert!(after.rms_m < 0.35 * before.rms_m && after.p99_m < 5.0, "{before:?} to {after:?}");
    let [low, high] = corrected.heightfield.z_range();
    assert!(low >= 349.0 && high <= 3100.0, "{low}..{high} leaves 349..3100");
}

#[test]
fn small_rough_terrain_is_refined_and_flat_terrain_is_not() {
    let folder = Folder::new("terrain-refine");
    let path = folder.0.join("a.asc");
    let request = TerrainRequest { source_crs: Some(4326), ..Default::default() };
    write_asc(&path, 60, 60, 10.0, 45.0, 0.001, &|c, r| 500.0 + (c as f64 * 0.9).sin() * 40.0 + r as f64);
    let rough = load(std::slice::from_ref(&path), &request).unwrap().0;
    write_asc(&path, 60, 60, 10.0, 45.0, 0.001, &|c, r| 500.0 + 20.0 * c as f64 + 3.0 * r as f64);
    let plane = load(&[path], &request).unwrap().0;
    assert!(rough.heightfield.cols() > 115 && plane.heightfield.cols() < 65);
    assert!(plane.resample_error.unwrap().max_m < 0.1, "{:?}", plane.resample_error);
    assert!(rough.resample_error.unwrap().p99_m < 6.0, "{:?}", rough.resample_error);
}

#[test]
fn gotthard_has_its_holes_and_filling_closes_only_them() {
    let Some(path) = data("gotthard/N46E008.tif") else { return };
    let open = simple(path.clone());
    assert_eq!(open.void_samples, 103_743);
    assert!((open.void_share - 103_743.0 / 1_442_401.0).abs() < 1e-12);
    let filled = load(&[path], &TerrainRequest { fill_voids: true, ..Default::default() }).unwrap().0;
    let (a, b) = (&open.heightfield, &filled.heightfield);
    assert!((0.07..0.12).contains(&filled.filled_share), "{}", filled.filled_share);
    let [low, high] = a.z_range();
    for i in 0..a.states().len() {
        match (a.states()[i], b.states()[i]) {
            (NodeState::Measured, NodeState::Measured) => assert_eq!(a.heights()[i], b.heights()[i]),
            (NodeState::Void, NodeState::Filled) => {
                assert!((low..=high).contains(&f64::from(b.heights()[i])), "node {i} filled with {}", b.heights()[i]);
            }
            (NodeState::Void, NodeState::Void) => {
                // outside the tile, so at the border of the grid
                let (c, r) = (i % a.cols(), i / a.cols());
                let edge = c.min(r).min(a.cols() - 1 - c).min(a.rows() - 1 - r);
                assert!(edge < 40, "a hole is left at {c}, {r}");
            }
            other => panic!("node {i}: {other:?}"),
        }
    }
}

/// Law: the membrane over a hole in a plane is the plane.
#[test]
fn a_hole_in_a_plane_is_filled_with_the_plane() {
    let folder = Folder::new("terrain-fill");
    let path = folder.0.join("plane.asc");
    let plane = |c: usize, r: usize| 100.0 + 3.0 * c as f64 - 2.0 * r as f64;
    let hole =
        |c: usize, r: usize| (c as f64 - 70.0).hypot(r as f64 - 50.0) < 30.0 || ((111..140).contains(&c) && r == 20);
    write_asc(&path, 150, 120, 5e5, 5e6, 30.0, &|c, r| if hole(c, r) { -9999.0 } else { plane(c, r) });
    let request = TerrainRequest { fill_voids: true, source_crs: Some(32631), ..Default::default() };
    let terrain = load(&[path], &request).unwrap().0;
    let h = &terrain.heightfield;
    let mut worst = 0.0f64;
    for r in 0..h.rows() {
        for c in 0..h.cols() {
            worst = worst.max((h.node(c, r).unwrap().z - plane(c, r)).abs());
            let expected = if hole(c, r) { NodeState::Filled } else { NodeState::Measured };
            assert_eq!(h.states()[r * h.cols() + c], expected);
        }
    }
    assert!(worst < 0.4, "off by {worst} m over a hole of 60 nodes and 180 m");
}

/// Law: a grid cut in two along a shared column is the grid, exact or resampled.
#[test]
fn tiles_join_without_a_seam() {
    let folder = Folder::new("terrain-tiles");
    let names = ["whole.asc", "west.asc", "east.asc"].map(|n| folder.0.join(n));
    let z = |c: usize, r: usize| if (c, r) == (41, 7) { -9999.0 } else { ((c * 37 + r * 61) % 101) as f64 };
    for (code, x, y, cell) in [(32631, 5e5, 5e6, 30.0), (4326, 8.0, 46.0, 0.0005)] {
        write_asc(&names[0], 81, 50, x, y, cell, &z);
        write_asc(&names[1], 41, 50, x, y, cell, &z);
        write_asc(&names[2], 41, 50, x + 40.0 * cell, y, cell, &|c, r| z(c + 40, r));
        let request = TerrainRequest { source_crs: Some(code), ..Default::default() };
        let whole = load(&names[..1], &request).unwrap().0;
        for tiles in [vec![names[1].clone(), names[2].clone()], vec![names[2].clone(), names[1].clone()]] {
            let (joined, _) = load(&tiles, &request).unwrap();
            assert_eq!(joined.heightfield.states(), whole.heightfield.states(), "EPSG:{code}");
            let pairs = joined.heightfield.heights().iter().zip(whole.heightfield.heights());
            let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 0.02, "EPSG:{code}: {off}");
        }
    }
}

#[test]
fn two_systems_of_one_place_agree() {
    let (Some(a), Some(b)) = (data("swellendam/srtm_41_19_4326.tif"), data("swellendam/srtm_41_19_utm33s.tif")) else {
        return;
    };
    let request = TerrainRequest { crs: CrsChoice::Epsg(32734), nodata: Some(0.0), ..Default::default() };
    let degrees = load(std::slice::from_ref(&a), &request).unwrap().0;
    let metres = load(std::slice::from_ref(&b), &request).unwrap().0;
    let both = load(&[a, b], &request).unwrap().0;
    let (mut count, mut squares) = (0usize, 0.0);
    let h = &degrees.heightfield;
    for i in (0..h.heights().len()).step_by(7) {
        let xy = h.node_xy(i % h.cols(), i / h.cols());
        let (Some(p), Some(q)) = (h.height_at(xy), metres.heightfield.height_at(xy)) else { continue };
        squares += (p - q) * (p - q);
        count += 1;
        let around = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
        let inside = |(x, y): &(i32, i32)| h.height_at(xy + 200.0 * DVec2::new(f64::from(*x), f64::from(*y))).is_some();
        assert!(both.heightfield.height_at(xy).is_some() || !around.iter().all(inside), "a gap at {xy}");
    }
    let rms = (squares / count as f64).sqrt();
    assert!(count > 10_000 && rms < 20.0, "{count} nodes, rms {rms} m");
}

#[test]
fn an_undeclared_frame_of_zeros_beside_high_ground_is_void_and_said() {
    let Some(path) = data("swellendam/srtm_41_19_4326.tif") else { return };
    let (as_is, warnings) = load(std::slice::from_ref(&path), &TerrainRequest::default()).unwrap();
    assert!(
        warnings.iter().any(|w| w.text().contains("106658 samples of 0 in a frame") && w.text().contains("nodata")),
        "{warnings:?}"
    );
    assert_eq!(as_is.void_samples, 106_658);
    let (told, _) = load(&[path], &TerrainRequest { nodata: Some(0.0), ..Default::default() }).unwrap();
    assert!(told.void_samples >= 106_658, "{}", told.void_samples);
    assert!(told.heightfield.z_range()[0] > 0.0);
    assert_eq!(as_is.heightfield.states(), told.heightfield.states());
}

#[test]
fn feet_and_rotation_become_metres_and_axes() {
    let folder = Folder::new("terrain-feet");
    let path = folder.0.join("feet.asc");
    // California zone 6, US survey feet: EPSG:2230
    write_asc(&path, 20, 20, 6_331_000.0, 1_944_000.0, 100.0, &|c, r| (c + r) as f64);
    let (terrain, _) =
        load(std::slice::from_ref(&path), &TerrainRequest { source_crs: Some(2230), ..Default::default() }).unwrap();
    assert_eq!(terrain.crs, Crs::Epsg(32611));
    let foot = 1200.0 / 3937.0;
    assert!((terrain.source_spacing_m - 100.0 * foot).abs().max_element() < 0.02, "{}", terrain.source_spacing_m);
    let request = TerrainRequest { source_crs: Some(2230), crs: CrsChoice::Local, ..Default::default() };
    let (local, _) = load(&[path], &request).unwrap();
    assert!((local.heightfield.spacing() - 100.0 * foot).abs().max_element() < 1e-9);
    assert_eq!(local.heightfield.node(3, 4).unwrap().z, 7.0);
    // a raster turned by 30 degrees: a linear field must be reproduced exactly
    let Some(rotated) = data("odd/rotated.tif") else { return };
    let (terrain, _) = load(&[rotated], &TerrainRequest::default()).unwrap();
    assert!(terrain.resample_error.unwrap().max_m < 1e-3, "{:?}", terrain.resample_error);
    assert!((terrain.source_spacing_m - DVec2::new(20.0, 10.0)).abs().max_element() < 1e-6);
}

/// Heights in feet become metres, whatever the type of the samples.
#[test]
fn heights_in_feet_become_metres() {
    let folder = Folder::new("terrain-height-unit");
    let feet = [1000.0, 2000.0, 3000.0, 4000.0];
    let xml = "<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">ft</Item></GDALMetadata>\0";
    let doubles = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<u64>>();
    for (name, bits, format) in [("float32", 32, 3), ("float64", 64, 3), ("int16", 16, 2), ("uint16", 16, 1)] {
        let pixels = feet.map(|h: f64| match (format, bits) {
            (3, 32) => u64::from((h as f32).to_bits()),
            (3, _) => h.to_bits(),
            _ => h as u64,
        });
        let extra = [
            (339, 3, vec![format]),
            (33550, 12, doubles(&[10.0, 10.0, 0.0])),
            (33922, 12, doubles(&[0.0, 0.0, 0.0, 5000.0, 9000.0, 0.0])),
            (42112, 2, xml.bytes().map(u64::from).collect()),
        ];
        let path = folder.0.join(format!("{name}.tif"));
        fs::write(&path, PLAIN.image([2, 2], 1, bits, &pixels, &extra)).unwrap();
        let request = TerrainRequest { crs: CrsChoice::Local, ..Default::default() };
        let terrain = load(&[path], &request).unwrap().0.heightfield;
        for (i, ft) in feet.into_iter().enumerate() {
            let z = terrain.node(i % 2, i / 2).unwrap().z;
            assert!((z - 0.3048 * ft).abs() < 1e-3, "{name}: {ft} ft came out as {z} m");
        }
    }
}

/// Rows that run north and columns that run west: every sample keeps its position.
#[test]
fn flipped_rasters_keep_every_sample_at_its_position() {
    let folder = Folder::new("terrain-flipped");
    let (cols, rows) = (5, 4);
    for (x_step, y_step) in [(30.0, -20.0), (30.0, 20.0), (-30.0, -20.0), (-30.0, 20.0)] {
        let path = folder.0.join("flipped.tif");
        let mut info = RasterInfo::new(&path, cols, rows, SampleType::F32);
        let map = Affine([x_step, 0.0, 400_000.0, 0.0, y_step, 4_700_000.0]);
        info.pixel_to_model = Some(map);
        (info.crs, info.crs_kind) = (SourceCrs::Epsg(32631), CrsKind::Projected);
        let samples = Samples::F32((0..cols * rows).map(|i| (i * i) as f32).collect());
        write_geotiff(&path, &Raster { info, samples, mask: None }, true).unwrap();
        let terrain = simple(path);
        assert_eq!(terrain.resample_error, None, "the samples are the nodes");
        let h = &terrain.heightfield;
        assert_eq!((h.cols(), h.rows()), (cols, rows));
        let nodes: Vec<_> = (0..cols * rows).filter_map(|i| h.node(i % cols, i / cols)).collect();
        for i in 0..cols * rows {
            let xy = DVec2::from(map.apply((i % cols) as f64 + 0.5, (i / cols) as f64 + 0.5));
            let node = nodes.iter().find(|n| n.truncate().distance(xy) < 1e-6);
            assert_eq!(node.map(|n| n.z), Some((i * i) as f64), "steps {x_step}, {y_step}: sample {i} at {xy}");
        }
    }
}

#[test]
fn absurd_grids_are_refused_or_cleaned() {
    let folder = Folder::new("terrain-absurd");
    let path = folder.0.join("a.asc");
    let z = |c: usize, r: usize| (c * r) as f64;
    for (x, cell, code) in
        [(1e300, 30.0, None), (5e5, 1e-12, None), (1e12, 30.0, Some(32631)), (400.0, 1.0, Some(4326))]
    {
        write_asc(&path, 5, 5, x, x, cell, &z);
        let request = TerrainRequest { source_crs: code, ..Default::default() };
        let error = load(std::slice::from_ref(&path), &request).unwrap_err().to_string();
        assert!(error.contains("a.asc") && !error.contains('\n') && error.len() < 600, "{x} {cell}: {error}");
    }
    let wild = |c: usize, r: usize| if c == r { 3.4e38 } else { 5.0 };
    write_asc(&path, 5, 5, 5e5, 5e6, 30.0, &wild);
    let (terrain, warnings) =
        load(std::slice::from_ref(&path), &TerrainRequest { source_crs: Some(32631), ..Default::default() }).unwrap();
    assert_eq!((terrain.void_samples, terrain.heightfield.z_range()), (5, [5.0, 5.0]));
    assert!(warnings.iter().any(|w| w.text().contains("5 samples beyond")), "{warnings:?}");
    write_asc(&path, 5, 5, 5e5, 5e6, 30.0, &|_, _| -9999.0);
    let error = load(&[path], &TerrainRequest::default()).unwrap_err().to_string();
    assert!(error.contains("no data at all"), "{error}");
}

fn write_hgt(path: &Path, side: usize, z: impl Fn(usize, usize) -> i16) {
    let bytes: Vec<u8> = (0..side * side).flat_map(|i| z(i % side, i / side).to_be_bytes()).collect();
    fs::write(path, bytes).unwrap();
}

#[test]
fn the_antimeridian_and_the_pole_are_places_like_others() {
    let folder = Folder::new("terrain-edges");
    let [east, west, pole] = ["N65E179.hgt", "N65W180.hgt", "N89E010.hgt"].map(|n| folder.0.join(n));
    write_hgt(&east, 101, |c, r| (c + r) as i16);
    write_hgt(&west, 101, |c, r| (100 + c + r) as i16);
    write_hgt(&pole, 101, |c, _| c as i16);
    let (terrain, _) = load(&[east, west], &TerrainRequest::default()).unwrap();
    let extent = terrain.extent_deg.unwrap();
    assert!((extent[0] - 179.0).abs() < 1e-9 && (extent[2] - 181.0).abs() < 1e-9, "{extent:?}");
    assert!(terrain.heightfield.cols() < 500, "{} columns", terrain.heightfield.cols());
    let Crs::Epsg(code) = terrain.crs else { panic!("{}", terrain.crs) };
    let t = Transform::between_epsg(4326, code).unwrap();
    for (lon, z) in [(179.5, 100.0), (180.0, 150.0), (-180.0, 150.0), (-179.5, 200.0)] {
        let got = terrain.heightfield.height_at(t.forward_one(DVec2::new(lon, 65.5)).unwrap()).unwrap();
        assert!((got - z).abs() < 0.2, "at {lon}: {got} is not {z}");
    }
    let polar = simple(pole);
    assert_eq!(polar.crs, Crs::Epsg(32661));
    let at = Transform::between_epsg(4326, 32661).unwrap().forward_one(DVec2::new(10.5, 89.2)).unwrap();
    assert!((polar.heightfield.height_at(at).unwrap() - 50.0).abs() < 1.0);
}

#[test]
fn too_large_terrain_is_thinned_out_and_said_so() {
    let Some(path) = data("andorra/N42E001.hgt") else { return };
    let (terrain, warnings) = load(&[path], &TerrainRequest { max_nodes: 100_000, ..Default::default() }).unwrap();
    let h = &terrain.heightfield;
    assert!(h.cols() * h.rows() <= 100_000 && h.cols() * h.rows() > 50_000, "{} x {}", h.cols(), h.rows());
    assert!(warnings.iter().any(|w| w.text().contains("th sample")), "{warnings:?}");
    let z = h.height_at(DVec2::new(390500.0, 4712000.0)).unwrap();
    assert!((z - 2312.0).abs() < 150.0, "{z}");
}

#[test]
fn requests_that_cannot_be_met_are_one_sentence() {
    let Some(path) = data("andorra/N42E001.hgt") else { return };
    let cases = [
        (TerrainRequest { crs: CrsChoice::Epsg(4326), ..Default::default() }, "not projected in metres"),
        (TerrainRequest { crs: CrsChoice::Epsg(1), ..Default::default() }, "EPSG:1"),
        (TerrainRequest { crs: CrsChoice::Local, ..Default::default() }, "degrees"),
        (TerrainRequest { max_nodes: 1, ..Default::default() }, "max_nodes"),
        (TerrainRequest { limits: Limits { max_bytes: 1000 }, ..Default::default() }, "MiB"),
        (TerrainRequest { source_crs: Some(99_999), ..Default::default() }, "99999"),
    ];
    for (request, words) in cases {
        let error = load(std::slice::from_ref(&path), &request).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
    }
    assert!(load(&[], &TerrainRequest::default()).is_err());
    let far = [path.clone(), data("gotthard/N46E008.tif").unwrap_or(path.clone())];
    let error = load(&far, &TerrainRequest { max_nodes: 3_000_000, ..Default::default() }).unwrap_err().to_string();
    assert!(error.contains("too far apart"), "{error}");
    let cancelled = Progress::silent();
    cancelled.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let error = load_terrain(&[path], &TerrainRequest::default(), &cancelled).unwrap_err();
    assert!(matches!(error, IoError::Cancelled(_)), "{error}");
}

/// Every unusual raster gives the right terrain or one clear sentence that names the file, within a minute.
#[test]
fn odd_rasters_end_well() {
    let Some(folder) = data("odd") else { return };
    let mut seen = 0;
    let mut names: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    for path in names {
        let start = Instant::now();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !name.ends_with(".tif") && !name.ends_with(".hgt") && !name.ends_with(".stl") {
            continue;
        }
        seen += 1;
        let result = load(&[path], &TerrainRequest::default());
        // A generous limit, so that other load on the machine does not matter.
        assert!(start.elapsed().as_secs_f64() < 60.0, "{name}: {:?}", start.elapsed());
        let good = ["byte", "float", "gotthard_", "int16", "predictor-3", "rotated", "test_esri"];
        match result {
            Ok((terrain, _)) => {
                assert!(good.iter().any(|g| name.starts_with(g)), "{name} should not load");
                let [low, high] = terrain.heightfield.z_range();
                assert!(low >= -5000.0 && high <= 5000.0, "{name}: {low}..{high}");
            }
            Err(error) => {
                let error = error.to_string();
                assert!(error.contains(&name) && !error.contains('\n') && error.len() < 500, "{name}: {error}");
                assert!(!good.iter().any(|g| name.starts_with(g)), "{error}");
            }
        }
    }
    assert!(seen >= 24, "{seen} rasters");
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let Some(path) = data("baltoro/baltoro_srtm.tif") else { return };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| simple(path.clone()))
    };
    assert_eq!(run(1), run(5));
}

#[test]
fn only_coordinates_that_can_be_degrees_are_taken_for_degrees() {
    let folder = Folder::new("terrain-degrees");
    let path = folder.0.join("unknown.asc");
    // 40 x 40 nodes; west, south and step.
    for (x, y, step, degrees) in [
        (10.0, 45.0, 0.05, true),
        (359.0, 45.0, 0.05, false),
        (-361.0, 45.0, 0.05, false),
        (10.0, 89.0, 0.05, false),
        (10.0, -91.0, 0.05, false),
        (-360.01, 45.0, 0.05, false),
        (10.0, 88.045, 0.05, false),
        (10.0, 45.0, 0.2, false),
    ] {
        write_asc(&path, 40, 40, x, y, step, &|c, r| (c + r) as f64);
        let warned = match load(std::slice::from_ref(&path), &TerrainRequest::default()) {
            Ok((_, warnings)) => warnings.iter().any(|w| w.text().contains("look like degrees")),
            Err(e) => panic!("{x} {y} {step}: {e}"),
        };
        assert_eq!(warned, degrees, "{x} {y} {step}");
    }
}
