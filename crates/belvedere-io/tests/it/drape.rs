//! Pictures draped over terrain are at the right position.

use crate::atomic::Folder;
use belvedere_core::{Warning, WarningKind};
use belvedere_io::crs::Transform;
use belvedere_io::png::{self, Channels};
use belvedere_io::{DrapeRequest, GeoTiff, Limits, TerrainRequest, load_drape, load_terrain};
use belvedere_scene::{Crs, Drape, Heightfield, NodeState, Progress};
use belvedere_testkit::data;
use glam::DVec2;
use std::fs;
use std::path::Path;
use std::time::Instant;

/// A flat heightfield over a box.
fn flat(west: f64, south: f64, east: f64, north: f64) -> Heightfield {
    let spacing = DVec2::new((east - west) / 10.0, (north - south) / 10.0);
    Heightfield::new(DVec2::new(west, north), spacing, 11, 11, vec![0.0; 121], vec![NodeState::Measured; 121]).unwrap()
}

fn terrain(name: &str) -> Option<(Crs, Heightfield)> {
    let loaded = load_terrain(&[data(name)?], &TerrainRequest::default(), &Progress::silent()).unwrap().value;
    Some((loaded.crs, loaded.heightfield))
}

fn drape(path: &Path, crs: Crs, h: &Heightfield, request: &DrapeRequest) -> Result<(Drape, Vec<Warning>), String> {
    let loaded = load_drape(path, crs, h, request, &Progress::silent());
    loaded.map(|l| (l.value, l.warnings)).map_err(|e| e.to_string())
}

fn pixel_of(d: &Drape, p: DVec2) -> DVec2 {
    let a = d.pixel_from_scene;
    DVec2::new(a[0] * p.x + a[1] * p.y + a[2], a[3] * p.x + a[4] * p.y + a[5])
}

/// Law: in another CRS the colour at a point is that of the source at the same point.
#[test]
fn reprojected_drapes_keep_their_places() {
    for (dem, picture) in [
        ("swellendam/srtm_41_19_utm33s.tif", "swellendam/aerial_3320D_2010_315_RGB.tif"),
        ("rmnp/rmnp_dem.tif", "rmnp/rmnp_rgb.tif"),
    ] {
        let (Some((crs, h)), Some(path)) = (terrain(dem), data(picture)) else { continue };
        let Crs::Epsg(code) = crs else { panic!("{crs}") };
        let start = Instant::now();
        let (d, warnings) = drape(&path, crs, &h, &DrapeRequest::default()).unwrap();
        assert!(start.elapsed().as_secs_f64() < 60.0);
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(d.pixels.len(), d.width * d.height);
        let tiff = GeoTiff::open(&path, Limits::default()).unwrap().value;
        let source = tiff.read(0, &Progress::silent()).unwrap();
        let colors = source.to_rgba().unwrap();
        let to_pixel = source.info.pixel_to_model.unwrap().inverse().unwrap();
        let to_lon_lat = Transform::between_epsg(code, 4326).unwrap();
        let (mut count, mut sum, mut beside) = (0u32, 0u32, 0u32);
        for i in (0..d.pixels.len()).step_by(97) {
            let [r, g, b, a] = d.pixels[i];
            let (c, row) = ((i % d.width) as f64 + 0.5, (i / d.width) as f64 + 0.5);
            let m = d.pixel_from_scene;
            let xy = DVec2::new((c - m[2]) / m[0], (row - m[5]) / m[4]);
            let p = to_lon_lat.forward_one(xy).unwrap();
            let [x, y] = to_pixel.apply(p.x, p.y);
            let inside = x >= 0.0 && y >= 0.0 && x < (source.info.width - 2) as f64 && y < source.info.height as f64;
            if !inside || a < 255 {
                continue;
            }
            let off = |shift: usize| {
                let truth = colors[y as usize * source.info.width + x as usize + shift];
                u32::from(r.abs_diff(truth[0])) + u32::from(g.abs_diff(truth[1])) + u32::from(b.abs_diff(truth[2]))
            };
            count += 1;
            sum += off(0);
            beside += off(2);
        }
        let mean = f64::from(sum) / f64::from(3 * count);
        // nearest against bilinear differs by about half a pixel of detail, an offset of two pixels by far more
        assert!(count > 500 && 2 * sum < beside, "{picture}: {count} pixels, {mean} levels off, {beside} beside {sum}");
    }
}

#[test]
fn pictures_in_the_scene_crs_are_taken_as_they_are() {
    let folder = Folder::new("drape-direct");
    let path = folder.0.join("p.png");
    let pixels: Vec<u8> = (0..20 * 10).flat_map(|i| [i as u8, (i / 20) as u8, 7]).collect();
    png::write(&path, false, 20, 10, Channels::Rgb, &pixels, &[]).unwrap();
    let h = flat(1000.0, 2000.0, 1100.0, 2100.0);
    let request = DrapeRequest { source_crs: Some(32631), ..Default::default() };
    let error = drape(&path, Crs::Epsg(32631), &h, &request).unwrap_err();
    assert!(error.contains("no georeference"), "{error}");
    // pixels of 5 m; the first one's centre at (1002.5, 2097.5)
    fs::write(path.with_extension("pgw"), "5\n0\n0\n-5\n1002.5\n2097.5\n").unwrap();
    for crs in [Crs::Epsg(32631), Crs::Local] {
        let (d, _) = drape(&path, crs, &h, &request).unwrap();
        assert_eq!((d.width, d.height), (20, 10));
        assert_eq!(pixel_of(&d, DVec2::new(1002.5, 2097.5)), DVec2::new(0.5, 0.5));
        assert_eq!(pixel_of(&d, DVec2::new(1100.0, 2050.0)), DVec2::new(20.0, 10.0));
        assert_eq!(d.pixels[3 * 20 + 4], [64, 3, 7, 255]);
    }
    let (_, warnings) = drape(&path, Crs::Epsg(32631), &h, &DrapeRequest::default()).unwrap();
    assert!(warnings.iter().any(|w| w.text().contains("that of the scene")), "{warnings:?}");
    // only what the terrain needs is kept
    let (d, _) = drape(&path, Crs::Epsg(32631), &flat(1040.0, 2060.0, 1060.0, 2080.0), &request).unwrap();
    assert!(d.width <= 8 && d.height <= 8, "{} x {}", d.width, d.height);
    let p = pixel_of(&d, DVec2::new(1052.5, 2072.5));
    assert_eq!(d.pixels[p.y as usize * d.width + p.x as usize], [(5 * 20 + 10) as u8, 5, 7, 255]);
    fs::write(path.with_extension("pgw"), "5 0 zero").unwrap();
    let error = drape(&path, Crs::Local, &h, &request).unwrap_err();
    assert!(error.contains("six numbers"), "{error}");
    fs::write(path.with_extension("pgw"), "0 0 0 0 1 1").unwrap();
    let error = drape(&path, Crs::Local, &h, &request).unwrap_err();
    assert!(error.contains("singular"), "{error}");
}

#[test]
fn a_picture_of_another_place_tells_both_places() {
    let (Some((crs, h)), Some(path)) =
        (terrain("grand_canyon/grandcanyon_dem_3857.tif"), data("grand_canyon/usgs_drg_24k_grand_canyon.tif"))
    else {
        return;
    };
    let start = Instant::now();
    let error = drape(&path, crs, &h, &DrapeRequest::default()).unwrap_err();
    assert!(start.elapsed().as_secs_f64() < 60.0);
    // README of the data: lon -112.261..-112.114 lat 35.983..36.133, and lon -113.203..-112.852 lat 36.031..36.315
    for words in ["-112.26", "-112.11", "35.98", "36.13", "-113.20", "-112.85", "36.03", "36.31"] {
        assert!(error.contains(words), "{words} is missing in: {error}");
    }
}

#[test]
fn large_pictures_are_reduced_and_said_so() {
    let Some(path) = data("grand_canyon/usgs_drg_24k_grand_canyon.tif") else { return };
    let h = flat(387000.0, 3983000.0, 399000.0, 3999000.0);
    let request = DrapeRequest { max_pixels: 1_000_000, ..Default::default() };
    let (d, warnings) = drape(&path, Crs::Epsg(26712), &h, &request).unwrap();
    assert!(d.pixels.len() <= 1_000_000 && d.pixels.len() > 500_000, "{}", d.pixels.len());
    let said = warnings.iter().find(|w| w.kind() == WarningKind::Reduced).unwrap();
    assert!(said.text().contains("times coarser") && said.figure("coarser").is_some_and(|f| f > 2.0), "{said:?}");
    let corner = pixel_of(&d, DVec2::new(387000.0, 3999000.0));
    assert!(corner.x > -1.0 && corner.x < 3.0 && corner.y > -1.0 && corner.y < 3.0, "{corner}");
    assert!(d.pixels.iter().any(|p| *p != d.pixels[0]));
    // and in the neighbouring datum's UTM zone
    let (d, warnings) = drape(&path, Crs::Epsg(32612), &h, &request).unwrap();
    assert!(d.pixels.len() <= 1_010_000, "{}", d.pixels.len());
    let said = warnings.iter().find(|w| w.kind() == WarningKind::Inexact).unwrap();
    assert!(said.text().contains("NAD27") && said.figure("off_m") == Some(10.0), "{said:?}");
}

#[test]
fn odd_rasters_as_drapes_end_well() {
    let Some(folder) = data("odd") else { return };
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    let good =
        ["RGBA.uint16.tif", "alpha.tif", "byte.tif", "cogeo.tif", "rgb_lzw.tif", "rotated.tif", "all-nodata.tif"];
    let mut seen = 0;
    for path in names {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !name.ends_with(".tif") && !name.ends_with(".hgt") {
            continue;
        }
        // over the extent of the picture, where it has one
        let corners = GeoTiff::open(&path, Limits::default()).ok().and_then(|t| t.value.info().corners());
        let corners = corners.unwrap_or([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]);
        let side = |k: usize, f: fn(f64, f64) -> f64| corners.iter().map(|c| c[k]).reduce(f).unwrap();
        let h = flat(side(0, f64::min), side(1, f64::min), side(0, f64::max), side(1, f64::max));
        let crs = match name.as_str() {
            "RGBA.uint16.tif" => Crs::Epsg(32612),
            "alpha.tif" | "cogeo.tif" | "corrupt.tif" => Crs::Epsg(3857),
            "rgb_lzw.tif" => Crs::Epsg(32618),
            "byte.tif" => Crs::Epsg(26711),
            "all-nodata.tif" => Crs::Epsg(32628),
            _ => Crs::Local,
        };
        let start = Instant::now();
        let result = drape(&path, crs, &h, &DrapeRequest::default());
        assert!(start.elapsed().as_secs_f64() < 60.0, "{name}: {:?}", start.elapsed());
        match result {
            Ok((d, _)) => {
                assert_eq!(d.pixels.len(), d.width * d.height, "{name}");
                assert!(d.pixel_from_scene.iter().all(|v| v.is_finite()), "{name}");
                seen += usize::from(good.contains(&name.as_str()));
            }
            Err(error) => {
                assert!(error.contains(&name) && !error.contains('\n') && error.len() < 500, "{name}: {error}");
                assert!(!good.contains(&name.as_str()), "{error}");
            }
        }
    }
    assert_eq!(seen, good.len());
}
