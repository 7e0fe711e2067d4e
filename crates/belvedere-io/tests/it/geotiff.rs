//! GeoTIFF: real files against figures obtained with GDAL 3.10, odd files, round trips, hostile headers.

use belvedere_io::{Affine, CrsKind, GeoTiff, Limits, Photometric, Raster, SampleType, Samples, SourceCrs};
use belvedere_scene::Progress;
use belvedere_testkit::data;
use std::time::{Duration, Instant};

fn read(name: &str) -> Option<Raster> {
    let file = GeoTiff::open(&data(name)?, Limits::default()).unwrap_or_else(|e| panic!("{e}")).value;
    Some(file.read(0, &Progress::silent()).unwrap_or_else(|e| panic!("{e}")))
}

/// CRC-32 of the samples as little-endian bytes, interleaved by pixel.
fn crc(samples: &Samples) -> u32 {
    macro_rules! bytes {
        ($v:expr) => {
            $v.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()
        };
    }
    let bytes = match samples {
        Samples::I8(v) => bytes!(v),
        Samples::U8(v) => bytes!(v),
        Samples::I16(v) => bytes!(v),
        Samples::U16(v) => bytes!(v),
        Samples::I32(v) => bytes!(v),
        Samples::U32(v) => bytes!(v),
        Samples::I64(v) => bytes!(v),
        Samples::U64(v) => bytes!(v),
        Samples::F32(v) => bytes!(v),
        Samples::F64(v) => bytes!(v),
    };
    let mut crc = flate2::Crc::new();
    crc.update(&bytes);
    crc.sum()
}

/// Name, width, height, bands, type, CRC-32 of the samples, EPSG code (0 = unknown), no data.
type Row = (&'static str, usize, usize, usize, SampleType, u32, u32, Option<f64>);

use SampleType::{F32, I16, U8, U16};

#[rustfmt::skip]
const LOSSLESS: [Row; 26] = [
    ("baltoro/baltoro_srtm.tif", 860, 430, 1, I16, 0x68f1_3a30, 4326, Some(-32768.0)),
    ("bigtujunga/bigtujunga.tif", 1197, 643, 1, I16, 0xcbfe_14c4, 32611, Some(32767.0)),
    ("gotthard/N46E008.tif", 1201, 1201, 1, I16, 0xa516_5d30, 4326, Some(-32767.0)),
    ("grand_canyon/grandcanyon_dem_3857.tif", 512, 512, 1, I16, 0x3c47_ad62, 3857, Some(-32768.0)),
    ("grand_canyon/usgs_drg_24k_grand_canyon.tif", 5327, 6782, 1, U8, 0xb6fe_6864, 26712, None),
    ("odd/BigTIFF.tif", 64, 64, 3, U8, 0xf2e0_f767, 0, None),
    ("odd/RGBA.uint16.tif", 634, 411, 4, U16, 0x65c8_00be, 32612, None),
    ("odd/all-nodata.tif", 71, 2475, 4, U16, 0x02d3_4858, 32628, Some(0.0)),
    ("odd/byte.tif", 20, 20, 1, U8, 0xd405_7158, 26711, None),
    ("odd/float32.tif", 3, 2, 1, F32, 0xdd3e_a498, 0, None),
    ("odd/gotthard_bigendian.tif", 256, 256, 1, I16, 0xfca9_88d8, 4326, Some(-32767.0)),
    ("odd/gotthard_bigtiff_tiled_deflate_pred2.tif", 512, 512, 1, I16, 0x3e9f_658a, 4326, Some(-32767.0)),
    ("odd/gotthard_float32_lzw_pred3.tif", 256, 256, 1, F32, 0x2581_bfa9, 4326, Some(-32767.0)),
    ("odd/int16.tif", 64, 64, 1, I16, 0xe717_5fc6, 0, None),
    ("odd/predictor-3-gray-f32.tif", 200, 200, 1, F32, 0x0132_e826, 0, None),
    ("odd/rgb_lzw.tif", 791, 718, 3, U8, 0x4aa2_c539, 32618, Some(0.0)),
    ("odd/rotated.tif", 10, 15, 1, U8, 0x1070_9edd, 0, None),
    ("odd/test_esri_wkt.tif", 2, 2, 1, U16, 0x9299_1416, 0, None),
    ("odd/world.byte.tif", 2880, 1200, 1, U8, 0xb9bc_7d3f, 4326, None),
    ("odd/float_raster_with_nodata.tif", 13, 12, 1, F32, 0x8cdd_a8a3, 0, Some(-3.4e38)),
    ("rmnp/rmnp_dem.tif", 152, 187, 1, U16, 0xa28a_6e67, 4326, Some(65535.0)),
    ("rmnp/rmnp_rgb.tif", 485, 373, 3, U8, 0xc373_3573, 4326, Some(255.0)),
    ("swellendam/aerial_3320D_2010_315_RGB.tif", 1089, 1093, 4, U8, 0x6d90_b508, 4326, None),
    ("swellendam/aerial_3420B_2010_328_RGB.tif", 1098, 3039, 4, U8, 0x3246_8cfc, 4326, None),
    ("swellendam/srtm_41_19_4326.tif", 919, 619, 1, F32, 0x9200_a92f, 4326, Some(3.402_823_466_385_288_6e38)),
    ("swellendam/srtm_41_19_utm33s.tif", 837, 661, 1, I16, 0x9145_c4f3, 32733, None),
];

#[test]
fn every_sample_of_lossless_files() {
    for (name, width, height, bands, kind, sum, epsg, nodata) in LOSSLESS {
        let Some(raster) = read(name) else { continue };
        let info = &raster.info;
        assert_eq!((info.width, info.height, info.bands, info.sample_type), (width, height, bands, kind), "{name}");
        assert_eq!(raster.samples.len(), width * height * bands, "{name}");
        assert_eq!(crc(&raster.samples), sum, "{name}");
        match epsg {
            0 => assert!(!matches!(info.crs, SourceCrs::Epsg(_)), "{name}: {}", info.crs),
            code => assert_eq!(info.crs, SourceCrs::Epsg(code), "{name}"),
        }
        assert_eq!(info.nodata, nodata, "{name}");
    }
}

fn close(found: Option<Affine>, wanted: [f64; 6], name: &str) {
    let Some(Affine(found)) = found else { panic!("{name} is not georeferenced") };
    for (f, w) in found.iter().zip(wanted) {
        assert!((f - w).abs() <= 1e-12 * w.abs().max(1.0), "{name}: {found:?} is not {wanted:?}");
    }
}

/// GDAL's transform starts at the corner of the first pixel, with PixelIsPoint as well.
#[test]
fn transforms() {
    let third = 1.0 / 1200.0;
    for (name, wanted) in [
        ("gotthard/N46E008.tif", [third, 0.0, 8.0 - third / 2.0, 0.0, -third, 47.0 + third / 2.0]),
        (
            "grand_canyon/grandcanyon_dem_3857.tif",
            [76.437_028_285_174_16, 0.0, -12_601_714.231_207_296, 0.0, -76.437_028_285_168_71, 4_344_069.191_503_136],
        ),
        ("odd/rotated.tif", [17.320_508_075_688_775, 5.0, 100.0, 10.0, -8.660_254_037_844_387, 200.0]),
        ("bigtujunga/bigtujunga.tif", [30.0, 0.0, 376_313.655_454_263_5, 0.0, -30.0, 3_807_917.827_628_375_5]),
        ("rmnp/rmnp_dem.tif", [0.00275, 0.0, -105.9125, 0.0, -0.00211, 40.553_678_069_620_155]),
    ] {
        let Some(raster) = read(name) else { continue };
        close(raster.info.pixel_to_model, wanted, name);
        assert_eq!(raster.info.pixel_is_point, name.starts_with("g"), "{name}");
    }
}

#[test]
fn systems_without_a_code_say_what_they_are() {
    if let Some(raster) = read("odd/test_esri_wkt.tif") {
        assert!(matches!(&raster.info.crs, SourceCrs::Wkt(t) if t.starts_with("PROJCS[") && t.ends_with(']')));
    }
    if let Some(raster) = read("odd/goes.tif") {
        assert!(matches!(&raster.info.crs, SourceCrs::Wkt(t) if t.contains("Geostationary_Satellite")));
    }
    if let Some(raster) = read("odd/float_raster_with_nodata.tif") {
        // given by its parameters alone
        let SourceCrs::Wkt(text) = &raster.info.crs else { panic!("{}", raster.info.crs) };
        assert!(text.contains("+proj=laea +lat_0="), "{text}");
        assert_eq!(raster.info.crs_kind, CrsKind::Projected);
    }
    if let Some(raster) = read("odd/float32.tif") {
        assert_eq!(raster.info.crs, SourceCrs::Unknown);
    }
}

#[test]
fn no_data_is_none() {
    let Some(raster) = read("gotthard/N46E008.tif") else { return };
    let cells = || (0..1201).flat_map(|r| (0..1201).map(move |c| (c, r)));
    let voids = cells().filter(|&(c, r)| raster.sample_f64(0, c, r).is_none()).count();
    assert_eq!(voids, 103_743);
    let heights = cells().filter_map(|(c, r)| raster.sample_f64(0, c, r));
    let range = heights.fold([f64::MAX, f64::MIN], |[lo, hi], h| [lo.min(h), hi.max(h)]);
    assert_eq!(range, [187.0, 4173.0]);
    let count = |name: &str| {
        let raster = read(name)?;
        let info = &raster.info;
        let cells = (0..info.height).flat_map(|r| (0..info.width).map(move |c| (c, r)));
        Some(cells.filter(|&(c, r)| raster.sample_f64(0, c, r).is_none()).count())
    };
    assert_eq!(count("odd/float_nan.tif"), Some(1));
    assert_eq!(count("odd/float_raster_with_nodata.tif"), Some(58));
    assert_eq!(count("odd/float_raster_with_extra_nodata.tif"), Some(518));
    assert_eq!(count("odd/all-nodata.tif"), Some(71 * 2475));
}

/// JPEG decoders differ by a few steps; GDAL's sums per band are the reference.
#[test]
fn jpeg_tiles_masks_and_overviews() {
    let progress = Progress::silent();
    for (name, sums) in [
        ("odd/cogeo.tif", &[115_316_060.0, 126_529_703.0, 133_121_711.0][..]),
        ("odd/goes.tif", &[5_899_417.0, 7_355_704.0, 9_903_134.0]),
        ("odd/alpha.tif", &[3_111_868.0, 3_393_494.0, 2_551_092.0, 5_810_452.0]),
    ] {
        let Some(raster) = read(name) else { continue };
        let Samples::U8(bytes) = &raster.samples else { panic!("{name} has no bytes") };
        for (band, &sum) in sums.iter().enumerate() {
            let found: f64 = bytes.iter().skip(band).step_by(raster.info.bands).map(|&b| f64::from(b)).sum();
            assert!((found / sum - 1.0).abs() < 3e-3, "{name}, band {band}: {found} instead of {sum}");
        }
        assert_eq!(raster.info.photometric, Photometric::Rgb([0, 1, 2]), "{name}");
        assert_eq!(raster.mask.is_some(), name != "odd/alpha.tif", "{name}");
    }
    if let Some(path) = data("odd/goes.tif") {
        let file = GeoTiff::open(&path, Limits::default()).unwrap().value;
        for (level, masked) in [(0, 63_712), (1, 15_103)] {
            let raster = file.read(level, &progress).unwrap();
            let mask = raster.mask.as_ref().unwrap();
            assert_eq!(mask.iter().filter(|&&valid| !valid).count(), masked);
            assert_eq!(raster.to_rgba().unwrap().iter().filter(|p| p[3] == 0).count(), masked);
            assert_eq!(raster.sample_f64(0, 0, 0), None);
        }
    }
    let Some(path) = data("odd/cogeo.tif") else { return };
    let file = GeoTiff::open(&path, Limits::default()).unwrap().value;
    assert_eq!(file.info().overviews, [[512, 512], [256, 256], [128, 128], [64, 64], [32, 32], [16, 16]]);
    let level = file.level_for(100);
    assert_eq!((level, file.level_for(2000), file.level_for(1)), (3, 0, 6));
    let small = file.read(level, &progress).unwrap();
    assert_eq!((small.info.width, small.samples.len()), (128, 128 * 128 * 3));
    let corner = |info: &belvedere_io::RasterInfo| info.corners().unwrap()[2];
    for (a, b) in corner(&small.info).into_iter().zip(corner(file.info())) {
        assert!((a - b).abs() < 1e-6);
    }
}

#[test]
fn a_window_is_a_part_of_the_whole() {
    let progress = Progress::silent();
    for name in ["grand_canyon/grandcanyon_dem_3857.tif", "odd/all-nodata.tif", "odd/world.byte.tif", "odd/goes.tif"] {
        let Some(path) = data(name) else { continue };
        let file = GeoTiff::open(&path, Limits::default()).unwrap().value;
        let whole = file.read(0, &progress).unwrap();
        let (w, h) = (whole.info.width, whole.info.height);
        for (cols, rows) in [(0..1, 0..1), (w / 3..w, h / 2..h), (w / 4..w / 2 + 1, 5..h - 7)] {
            let part = file.read_window(0, cols.clone(), rows.clone(), &progress).unwrap();
            assert_eq!((part.info.width, part.info.height), (cols.len(), rows.len()));
            for (r, c) in rows.clone().flat_map(|r| cols.clone().map(move |c| (r, c))) {
                for band in 0..whole.info.bands {
                    let (pc, pr) = (c - cols.start, r - rows.start);
                    assert_eq!(part.sample_f64(band, pc, pr), whole.sample_f64(band, c, r), "{name} {c} {r}");
                }
            }
            let (a, b) = (part.info.pixel_to_model.unwrap(), whole.info.pixel_to_model.unwrap());
            let [x, y] = b.apply(cols.start as f64, rows.start as f64);
            let [px, py] = a.apply(0.0, 0.0);
            assert!((px - x).abs() + (py - y).abs() < 1e-6);
        }
        assert!(file.read_window(0, 0..w + 1, 0..1, &progress).is_err());
        assert!(file.read_window(99, 0..1, 0..1, &progress).is_err());
    }
}

#[test]
fn pictures_become_rgba() {
    if let Some(raster) = read("grand_canyon/usgs_drg_24k_grand_canyon.tif") {
        let Photometric::Palette(colors) = &raster.info.photometric else { panic!("no palette") };
        assert_eq!((colors.len(), colors[1]), (256, [255, 255, 255]));
        let rgba = raster.to_rgba().unwrap();
        let Samples::U8(indices) = &raster.samples else { panic!("no indices") };
        assert!(rgba.iter().zip(indices).all(|(p, &i)| p[..3] == colors[usize::from(i)] && p[3] == 255));
    }
    if let Some(raster) = read("odd/RGBA.uint16.tif") {
        assert_eq!(raster.info.photometric, Photometric::Rgb([2, 1, 0]), "colours are stored blue first");
        let rgba = raster.to_rgba().unwrap();
        let opaque = rgba.iter().filter(|p| p[3] == 255).count();
        assert_eq!(opaque, 32_465_580 / 255, "an alpha band of 0..=255 in 16 bits");
        assert_eq!(rgba[0][..3], [39; 3]);
    }
    if let Some(raster) = read("gotthard/N46E008.tif") {
        assert!(raster.to_rgba().unwrap_err().contains("int16"));
    }
}

#[test]
fn damaged_files_fail_with_one_sentence() {
    for (name, wanted) in [
        ("odd/corrupt.tif", "tile 4 of 4 should be 47086 bytes at byte 260000"),
        ("odd/truncated_dem.tif", "the file ends at byte 600000"),
        ("odd/corrupt_water.shp", "is not a TIFF file"),
        ("odd", "folder"),
    ] {
        let Some(path) = data(name) else { continue };
        let start = Instant::now();
        let opened = GeoTiff::open(&path, Limits::default());
        let error = opened.and_then(|f| f.value.read(0, &Progress::silent())).expect_err(name).to_string();
        assert!(error.contains(wanted) && !error.contains('\n') && error.contains("odd"), "{name}: {error}");
        assert!(start.elapsed() < Duration::from_secs(60));
    }
}

#[test]
fn memory_limit_names_its_option() {
    let Some(path) = data("gotthard/N46E008.tif") else { return };
    let file = GeoTiff::open(&path, Limits { max_bytes: 1 << 20 }).unwrap().value;
    let error = file.read(0, &Progress::silent()).unwrap_err().to_string();
    assert!(error.contains("allow more memory") && error.contains("MiB"), "{error}");
    assert!(file.read_window(0, 0..300, 0..300, &Progress::silent()).is_ok(), "a window fits");
}

#[test]
fn cancelling_stops_reading() {
    let Some(path) = data("gotthard/N46E008.tif") else { return };
    let progress = Progress::silent();
    progress.cancel_flag().store(true, std::sync::atomic::Ordering::Relaxed);
    let file = GeoTiff::open(&path, Limits::default()).unwrap().value;
    assert!(matches!(file.read(0, &progress), Err(belvedere_io::IoError::Cancelled(_))));
}
