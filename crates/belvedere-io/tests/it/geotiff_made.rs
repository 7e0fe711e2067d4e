//! GeoTIFF: files made by the tests. Round trips through every layout, and headers with wrong values.

use crate::tiff_writer::{Entry, PLAIN, Style};
use belvedere_io::geotiff::write_geotiff;
use belvedere_io::{
    Affine, CrsKind, GeoTiff, IoError, Limits, Loaded, Photometric, Raster, RasterInfo, SampleType, Samples, SourceCrs,
};
use belvedere_scene::Progress;
use belvedere_testkit::Random;
use std::time::{Duration, Instant};

fn open(bytes: &[u8]) -> Result<Loaded<GeoTiff>, IoError> {
    GeoTiff::from_bytes("made.tif", bytes.to_vec(), Limits::default())
}

fn read(bytes: &[u8]) -> Result<Raster, String> {
    let file = open(bytes).map_err(|e| e.to_string())?.value;
    file.read(0, &Progress::silent()).map_err(|e| e.to_string())
}

fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/").to_owned() + name).unwrap()
}

/// The fixtures were written by GDAL 3.10 from this formula.
fn formula(col: usize, row: usize) -> f64 {
    ((col * 7 + row * 13) % 50) as f64 - 20.0
}

fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..20).flat_map(|r| (0..40).map(move |c| (c, r)))
}

#[test]
fn layouts_and_compressions() {
    let pixels = |bits: u64| -> Vec<u64> {
        let mask = u64::MAX >> (64 - bits);
        (0..33 * 21 * 3u64).map(|i| (i * i * 2_654_435_761 + (i % 5) * 0x0101_0101_0101_0101) & mask).collect()
    };
    for (i, (big_endian, big)) in [(false, false), (true, false), (false, true), (true, true)].into_iter().enumerate() {
        for (k, tile) in [None, Some((16, 16)), Some((48, 7))].into_iter().enumerate() {
            for compression in [1, 5, 8, 32773, 32946, 50000] {
                for predictor in if compression == 1 || compression == 32773 { 1..=1 } else { 1..=2 } {
                    let bits = 8 << ((i + k + compression as usize + predictor as usize) % 4);
                    let style = Style { big_endian, big, tile, planar: (i + k) % 2 == 0, compression, predictor };
                    let wanted = pixels(bits);
                    let raster = read(&style.image([33, 21], 3, bits, &wanted, &[])).unwrap();
                    let found = (0..wanted.len()).map(|i| raster.samples.get_f64(i).unwrap());
                    assert!(found.eq(wanted.iter().map(|&v| v as f64)), "{style:?} {bits}");
                }
            }
        }
    }
}

#[test]
fn files_of_another_encoder() {
    use tiff::encoder::{Compression, TiffEncoder, colortype};
    let heights: Vec<f32> = (0..70 * 31).map(|i| (i as f32).sin() * 900.0).collect();
    let depths: Vec<u16> = heights.iter().map(|v| v.abs() as u16).collect();
    let deflate = Compression::Deflate(Default::default());
    for compression in [Compression::Uncompressed, Compression::Lzw, Compression::Packbits, deflate] {
        let mut out = std::io::Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut out).unwrap().with_compression(compression);
        encoder.write_image::<colortype::Gray32Float>(70, 31, &heights).unwrap();
        assert!(read(out.get_ref()).unwrap().samples == Samples::F32(heights.clone()));
    }
    for compression in [Compression::Lzw, deflate] {
        let mut out = std::io::Cursor::new(Vec::new());
        let encoder = TiffEncoder::new_big(&mut out).unwrap().with_compression(compression);
        let mut encoder = encoder.with_predictor(tiff::tags::Predictor::Horizontal);
        encoder.write_image::<colortype::Gray16>(70, 31, &depths).unwrap();
        assert!(read(out.get_ref()).unwrap().samples == Samples::U16(depths.clone()));
    }
}

#[test]
fn zstd_with_predictors() {
    for (name, scale, kind) in [
        ("zstd_predictor2_int16.tif", 1.0, SampleType::I16),
        ("zstd_predictor3_float64_big.tif", 0.125, SampleType::F64),
        ("half_predictor3.tif", 0.125, SampleType::F32),
    ] {
        let raster = read(&fixture(name)).unwrap();
        assert_eq!(raster.info.sample_type, kind);
        for (c, r) in cells() {
            assert_eq!(raster.sample_f64(0, c, r), Some(formula(c, r) * scale), "{name} {c} {r}");
        }
    }
}

#[test]
fn scale_offset_unit_and_missing_tiles() {
    let raster = read(&fixture("scaled_feet_sparse.tif")).unwrap();
    assert_eq!((raster.info.vertical_unit_m, raster.info.nodata), (0.3048, Some(-9.0)));
    for (c, r) in cells() {
        let wanted = (c < 16 && r < 16 && formula(c, r) != -9.0).then(|| formula(c, r) * 0.1 + 100.0);
        assert_eq!(raster.sample_f64(0, c, r), wanted, "{c} {r}");
    }
}

#[test]
fn palette_of_four_bits() {
    let raster = read(&fixture("nbits4_palette.tif")).unwrap();
    let rgba = raster.to_rgba().unwrap();
    for (c, r) in cells() {
        let i = ((c + r) % 16) as u8;
        assert_eq!(rgba[r * 40 + c], [i * 10, 255 - i, 3, 255]);
    }
}

fn bits_of(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn with_tags(extra: &[Entry]) -> Result<Raster, String> {
    read(&PLAIN.image([4, 3], 1, 8, &[7; 12], extra))
}

#[test]
fn ground_control_points() {
    let tie = |c: f64, r: f64, x: f64, y: f64| [c, r, 0.0, x, y, 0.0];
    let place = |c: f64, r: f64| tie(c, r, 500.0 + 10.0 * c + 2.0 * r, 900.0 + 1.0 * c - 9.0 * r);
    let four = [place(0.0, 0.0), place(4.0, 0.0), place(4.0, 3.0), place(0.0, 3.0)].concat();
    let raster = with_tags(&[(33922, 12, bits_of(&four))]).unwrap();
    let Affine(found) = raster.info.pixel_to_model.unwrap();
    for (f, w) in found.iter().zip([10.0, 2.0, 500.0, 1.0, -9.0, 900.0]) {
        assert!((f - w).abs() < 1e-9, "{found:?}");
    }
    let bent = [four, tie(2.0, 2.0, 530.0, 880.0).to_vec()].concat();
    assert!(with_tags(&[(33922, 12, bits_of(&bent))]).unwrap_err().contains("rectify"));
}

#[test]
fn geokeys() {
    let keys = |keys: &[[u64; 4]]| {
        let values = [vec![1, 1, 0, keys.len() as u64], keys.concat()].concat();
        with_tags(&[(34735, 3, values)]).unwrap().info
    };
    let utm = keys(&[[1024, 0, 1, 1], [2048, 0, 1, 4326], [3074, 0, 1, 16133], [3072, 0, 1, 32767]]);
    assert_eq!(utm.crs, SourceCrs::Epsg(32733), "a zone instead of a code");
    let feet = keys(&[[1024, 0, 1, 1], [3072, 0, 1, 2225], [3076, 0, 1, 9003], [4096, 0, 1, 6360]]);
    assert_eq!((feet.linear_unit_m, feet.vertical_epsg), (Some(1200.0 / 3937.0), Some(6360)));
    assert_eq!(feet.vertical_unit_m, 1200.0 / 3937.0);
    let geographic = keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4258], [1025, 0, 1, 2]]);
    assert_eq!((geographic.crs, geographic.pixel_is_point), (SourceCrs::Epsg(4258), true));
}

/// Systems that are given by their parameters: EPSG codes where one fits, else the same place as that of the PROJ string.
#[test]
fn geokeys_of_parameters() {
    use belvedere_io::crs::{CoordinateSystem, Transform};
    let keys = |shorts: &[[u64; 4]], doubles: &[(u64, f64)]| {
        let from_doubles = doubles.iter().enumerate().map(|(k, (id, _))| [*id, 34736, 1, k as u64]);
        let all: Vec<[u64; 4]> = shorts.iter().copied().chain(from_doubles).collect();
        let values = [vec![1, 1, 0, all.len() as u64], all.concat()].concat();
        let values_of: Vec<f64> = doubles.iter().map(|(_, v)| *v).collect();
        with_tags(&[(34735, 3, values), (34736, 12, bits_of(&values_of))]).unwrap().info.crs
    };
    let own = [[1024, 0, 1, 1], [3072, 0, 1, 32767], [3074, 0, 1, 32767], [3076, 0, 1, 9001]];
    let with = |more: &[[u64; 4]]| [own.to_vec(), more.to_vec()].concat();
    // with a code: European LAEA, Lambert 93 with parallels exchanged, UTM 33 on ETRS 89 by its datum
    let laea = keys(
        &with(&[[2048, 0, 1, 4258], [3075, 0, 1, 10]]),
        &[(3089, 52.0), (3088, 10.0), (3082, 4_321_000.0), (3083, 3_210_000.0)],
    );
    assert_eq!(laea, SourceCrs::Epsg(3035));
    let lcc = [(3078, 44.0), (3079, 49.0), (3085, 46.5), (3084, 3.0), (3086, 700_000.0), (3087, 6_600_000.0)];
    assert_eq!(keys(&with(&[[2048, 0, 1, 4171], [3075, 0, 1, 8]]), &lcc), SourceCrs::Epsg(2154));
    let utm = [(3081, 0.0), (3080, 15.0), (3092, 0.9996), (3082, 500_000.0), (3083, 0.0)];
    let by_datum = keys(&with(&[[2048, 0, 1, 32767], [2050, 0, 1, 6258], [3075, 0, 1, 1]]), &utm);
    assert_eq!(by_datum, SourceCrs::Epsg(25833));
    // without one
    let wgs84 = CoordinateSystem::wgs84().unwrap();
    for (method, doubles, proj, at) in [
        (10, vec![(3089, 46.0), (3088, 11.0)], "+proj=laea +lat_0=46 +lon_0=11 +datum=WGS84", [11.2, 46.3]),
        (
            11,
            vec![(3078, 29.5), (3079, 45.5), (3081, 23.0), (3080, -97.0)],
            "+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-97 +datum=WGS84",
            [-100.0, 40.0],
        ),
        (
            15,
            vec![(3081, 71.0), (3095, -45.0)],
            "+proj=stere +lat_0=90 +lat_ts=71 +lon_0=-45 +datum=WGS84",
            [-40.0, 72.0],
        ),
        (
            16,
            vec![(3081, 46.0), (3080, 25.0), (3092, 0.99975)],
            "+proj=sterea +lat_0=46 +lon_0=25 +k=0.99975 +datum=WGS84",
            [25.0, 45.5],
        ),
        (
            9815,
            vec![(3089, 46.0), (3088, 11.0), (3094, 30.0), (3096, 30.0)],
            "+proj=omerc +lat_0=46 +lonc=11 +alpha=30 +gamma=30 +datum=WGS84",
            [11.5, 46.5],
        ),
    ] {
        let found = keys(&with(&[[2048, 0, 1, 4326], [3075, 0, 1, method]]), &doubles);
        let SourceCrs::Wkt(text) = &found else { panic!("{method}: {found}") };
        let of = |s: &CoordinateSystem| Transform::new(&wgs84, s).unwrap().forward_one(at.into()).unwrap();
        let (a, b) =
            (CoordinateSystem::from_text(text).unwrap(), CoordinateSystem::from_proj_string("p", proj).unwrap());
        assert!(of(&a).distance(of(&b)) < 1e-3, "{text} {proj}");
    }
    // another body, an unknown method, other angles
    let mars = keys(&with(&[[2048, 0, 1, 32767], [3075, 0, 1, 17]]), &[(2057, 3_396_190.0), (2058, 3_396_190.0)]);
    assert!(matches!(mars, SourceCrs::OtherBody(_)), "{mars}");
    for odd in [
        with(&[[2048, 0, 1, 4326], [3075, 0, 1, 99]]),
        with(&[[2048, 0, 1, 4326], [2054, 0, 1, 9105], [3075, 0, 1, 10]]),
    ] {
        assert!(matches!(keys(&odd, &[(3089, 46.0)]), SourceCrs::UserDefined(_)));
    }
}

#[test]
fn written_files_come_back() {
    let folder = std::env::temp_dir().join(format!("belvedere-geotiff-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("delta.tif");
    let samples = |kind: SampleType, n: usize| match kind {
        SampleType::F32 => Samples::F32((0..n).map(|i| (i as f32 * 0.37).sin() * 80.0).collect()),
        SampleType::F64 => Samples::F64((0..n).map(|i| (i as f64).sqrt() - 7.0).collect()),
        SampleType::I16 => Samples::I16((0..n).map(|i| (i * 77) as i16).collect()),
        _ => Samples::U8((0..n).map(|i| (i * 3) as u8).collect()),
    };
    let rotated = Affine([17.0, 5.0, 100.0, 10.0, -8.0, 200.0]);
    let straight = Affine([30.0, 0.0, 377_000.0, 0.0, -25.0, 4_712_000.0]);
    for (kind, bands, map, point) in [
        (SampleType::F32, 1, straight, false),
        (SampleType::F64, 1, rotated, true),
        (SampleType::I16, 2, straight, true),
        (SampleType::U8, 3, rotated, false),
    ] {
        let mut info = RasterInfo::new(&path, 701, 203, kind);
        info.bands = bands;
        info.pixel_to_model = Some(map);
        info.pixel_is_point = point;
        (info.crs, info.crs_kind) = (SourceCrs::Epsg(32631), CrsKind::Projected);
        info.nodata = Some(-9.0).filter(|_| kind != SampleType::U8);
        let raster = Raster { samples: samples(kind, 701 * 203 * bands), info, mask: None };
        write_geotiff(&path, &raster, true).unwrap();
        let back = GeoTiff::open(&path, Limits::default()).unwrap();
        assert_eq!(back.warnings, []);
        assert_eq!(back.value.read(0, &Progress::silent()).unwrap(), raster);
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The floating-point predictor counts bytes across the bands of a pixel; the other decoder is the reference.
#[test]
fn float_predictor_with_several_bands() {
    use tiff::decoder::{Decoder, DecodingResult};
    let folder = crate::atomic::Folder::new("predictor3-bands");
    let path = folder.0.join("bands.tif");
    let mut info = RasterInfo::new(&path, 37, 11, SampleType::F32);
    (info.bands, info.photometric) = (3, Photometric::Rgb([0, 1, 2]));
    let values: Vec<f32> = (0..37 * 11 * 3).map(|i| (i as f32 * 0.37).sin() * 10f32.powi(i % 3)).collect();
    let raster = Raster { info, samples: Samples::F32(values.clone()), mask: None };
    write_geotiff(&path, &raster, false).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let theirs = Decoder::new(std::io::Cursor::new(&bytes)).and_then(|mut d| d.read_image()).unwrap();
    assert!(matches!(theirs, DecodingResult::F32(v) if v == values));
    assert_eq!(read(&bytes).unwrap().samples, raster.samples);
}

#[test]
fn a_mask_is_written_as_no_data() {
    let path = std::env::temp_dir().join(format!("belvedere-mask-{}.tif", std::process::id()));
    let mut info = RasterInfo::new(&path, 3, 1, SampleType::F32);
    let samples = Samples::F32(vec![1.0, 2.0, 3.0]);
    let mut raster = Raster { info: info.clone(), samples, mask: Some(vec![true, false, true]) };
    assert!(write_geotiff(&path, &raster, true).unwrap_err().to_string().contains("no-data"));
    info.nodata = Some(-1e9);
    raster.info = info;
    write_geotiff(&path, &raster, true).unwrap();
    let back = GeoTiff::open(&path, Limits::default()).unwrap().value.read(0, &Progress::silent()).unwrap();
    let values: Vec<_> = (0..3).map(|c| back.sample_f64(0, c, 0)).collect();
    assert_eq!(values, [Some(1.0), None, Some(3.0)]);
    std::fs::remove_file(&path).unwrap();
}

/// Reads hostile bytes and checks that it takes no longer than a minute and that an error is one sentence.
fn survive(bytes: &[u8], what: &str) -> Result<Raster, String> {
    let start = Instant::now();
    let result = read(bytes);
    assert!(start.elapsed() < Duration::from_secs(60), "{what} took {:?}", start.elapsed());
    if let Err(text) = &result {
        assert!(!text.contains('\n') && text.starts_with("made.tif: ") && text.len() < 500, "{what}: {text}");
    }
    result
}

fn samples_of_all_kinds() -> Vec<Vec<u8>> {
    let pixels: Vec<u64> = (0..64 * 64).collect();
    let tiled = Style { big_endian: true, big: true, tile: Some((16, 16)), compression: 8, predictor: 2, ..PLAIN };
    let geo = (33550, 12, bits_of(&[1.0, 1.0, 0.0]));
    let tie = (33922, 12, bits_of(&[0.0, 0.0, 0.0, 1.0, 2.0, 0.0]));
    vec![
        PLAIN.image([64, 64], 1, 16, &pixels, &[geo.clone(), tie.clone()]),
        tiled.image([64, 64], 1, 32, &pixels, &[geo, tie]),
        Style { compression: 5, ..PLAIN }.image([64, 64], 1, 8, &pixels, &[]),
        fixture("zstd_predictor3_float64_big.tif"),
        fixture("nbits4_palette.tif"),
        fixture("scaled_feet_sparse.tif"),
    ]
}

#[test]
fn truncated_anywhere() {
    for (k, whole) in samples_of_all_kinds().iter().enumerate() {
        assert!(survive(whole, "whole").is_ok(), "{k}");
        for i in 0..32 {
            let at = whole.len() * i / 32;
            assert!(survive(&whole[..at], "truncated").is_err(), "file {k} cut at {at} of {}", whole.len());
        }
    }
}

#[test]
fn flipped_bits() {
    let mut rng = Random::new(7);
    for whole in samples_of_all_kinds() {
        for _ in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..=rng.below(3) {
                let at = rng.below(bytes.len().min(400));
                bytes[at] ^= 1 << rng.below(8);
            }
            let _ = survive(&bytes, "flipped");
        }
    }
}

#[test]
fn headers_that_lie() {
    let base: Vec<Entry> = vec![
        (256, 4, vec![64]),
        (257, 4, vec![64]),
        (258, 3, vec![8]),
        (259, 3, vec![8]),
        (262, 3, vec![1]),
        (273, 4, vec![8]),
        (277, 3, vec![1]),
        (278, 4, vec![64]),
        (279, 4, vec![40]),
    ];
    let with = |changes: &[Entry]| {
        let mut entries = base.clone();
        for change in changes {
            entries.retain(|e| e.0 != change.0);
            entries.push(change.clone());
        }
        entries.sort_by_key(|e| e.0);
        PLAIN.file(&entries, &[0; 64], 0)
    };
    let huge = i32::MAX as u64;
    let tile = |w: u64, h: u64| [(322, 4, vec![w]), (323, 4, vec![h]), (324, 4, vec![8]), (325, 4, vec![40])];
    let sparse = [(256, 4, vec![huge]), (257, 4, vec![huge]), (322, 4, vec![huge]), (323, 4, vec![huge])];
    let sparse = [&sparse[..], &[(324, 4, vec![0]), (325, 4, vec![0])]].concat();
    for (changes, wanted) in [
        (vec![(256, 4, vec![0])], "width is 0"),
        (vec![(256, 4, vec![u64::from(u32::MAX)])], "width is 4294967295"),
        (vec![(256, 4, vec![huge]), (257, 4, vec![huge]), (278, 4, vec![huge])], "cannot hold"),
        (vec![(278, 4, vec![0])], "strips of 0 rows"),
        (vec![(278, 4, vec![1])], "lists 1 strips, 64 are needed"),
        (tile(0, 16).to_vec(), "tile width is 0"),
        (tile(16, 16).to_vec(), "lists 1 tiles, 16 are needed"),
        (tile(huge, huge).to_vec(), "cannot hold"),
        (sparse, "allow more memory"),
        (vec![(258, 3, vec![13])], "13 bits"),
        (vec![(258, 3, vec![16]), (339, 3, vec![5])], "complex"),
        (vec![(277, 3, vec![0])], "0 samples per pixel"),
        (vec![(259, 3, vec![34887])], "LERC"),
        (vec![(259, 3, vec![7])], "JPEG"),
        (vec![(259, 3, vec![50000])], "ZSTD"),
        (vec![(317, 3, vec![3])], "predictor 3"),
        (vec![(262, 3, vec![5])], "CMYK"),
        (vec![(262, 3, vec![3])], "colour map"),
        (vec![], "deflate"),
        (vec![(33550, 12, bits_of(&[f64::NAN, 1.0, 0.0])), (33922, 12, vec![0; 6])], "cannot be inverted"),
    ] {
        let error = survive(&with(&changes), wanted).expect_err(wanted);
        assert!(error.contains(wanted), "{error} does not say {wanted}");
    }
    let lost = open(&PLAIN.image([4, 3], 1, 8, &[7; 12], &[(330, 4, vec![999_999])])).unwrap();
    assert!(lost.warnings.iter().any(|w| w.text().contains("an overview is ignored")), "{:?}", lost.warnings);
    let looped = PLAIN.file(&base, &[0; 64], 8);
    assert!(survive(&looped, "loop").unwrap_err().contains("loop"));
    let nowhere = [b"II\x2a\0".as_slice(), &[255; 4]].concat();
    assert!(survive(&nowhere, "nowhere").unwrap_err().contains("truncated"));
    for bytes in [&b""[..], b"II", b"II\x2a\0", b"PK\x03\x04 and more bytes", &[0; 4096]] {
        assert!(survive(bytes, "not a TIFF").is_err());
    }
}

#[test]
fn one_band_where_nothing_else_is_said() {
    let entries = |at: u64| -> Vec<Entry> {
        let tags = [(256, 4), (257, 3), (258, 8), (259, 1), (262, 1), (273, at), (278, 3), (279, 12)];
        tags.map(|(number, value)| (number, 4, vec![value])).to_vec()
    };
    let body: Vec<u8> = (0..12).collect();
    let at = PLAIN.body_at(&entries(0)) as u64;
    let raster = read(&PLAIN.file(&entries(at), &body, 0)).unwrap();
    assert_eq!((raster.info.bands, raster.samples), (1, Samples::U8(body)));
}

#[test]
fn predictors_that_do_not_exist_are_refused() {
    for predictor in [0, 4, 34_892] {
        let style = Style { compression: 8, predictor, ..PLAIN };
        let error = read(&style.image([4, 3], 1, 8, &[7; 12], &[])).unwrap_err();
        assert!(error.contains(&format!("predictor {predictor} does not go")), "{error}");
    }
}
