//! Cloud-optimised GeoTIFFs: the order of their parts, byte by byte, and what readers find in them.

use belvedere_io::geotiff::write_cloud_geotiff;
use belvedere_io::{Affine, CrsKind, GeoTiff, Limits, Raster, RasterInfo, SampleType, Samples, SourceCrs};
use belvedere_scene::Progress;

const WIDTH: usize = 1301;
const HEIGHT: usize = 700;
const NODATA: f64 = -9999.0;

/// A plane with a hole.
fn plane(kind: SampleType) -> Raster {
    let mut info = RasterInfo::new("plane.tif", WIDTH, HEIGHT, kind);
    info.pixel_to_model = Some(Affine([10.0, 0.0, 500_000.0, 0.0, -10.0, 5_000_000.0]));
    (info.crs, info.crs_kind) = (SourceCrs::Epsg(32632), CrsKind::Projected);
    info.nodata = Some(NODATA);
    let value = |i: usize| {
        let [col, row] = [i % WIDTH, i / WIDTH];
        let hole = (64..96).contains(&col) && (128..192).contains(&row);
        if hole { NODATA } else { 2.0 * col as f64 - 3.0 * row as f64 }
    };
    let values = (0..WIDTH * HEIGHT).map(value);
    let samples = match kind {
        SampleType::F32 => Samples::F32(values.map(|v| v as f32).collect()),
        SampleType::F64 => Samples::F64(values.collect()),
        _ => Samples::I16(values.map(|v| v as i16).collect()),
    };
    Raster { info, samples, mask: None }
}

fn written(raster: &Raster) -> (tempfile::TempDir, std::path::PathBuf, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    write_cloud_geotiff(&path, raster, false).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    // For `rio cogeo validate`, by hand.
    if let Ok(kept) = std::env::var("BELVEDERE_KEEP_COG") {
        let name = format!("{:?}_{}.tif", raster.info.sample_type, raster.info.width);
        std::fs::write(std::path::Path::new(&kept).join(name), &bytes).unwrap();
    }
    (folder, path, bytes)
}

/// Entries of a directory by tag: number of values, and the values of 16 or 32 bits; then where the next one begins.
fn directory(bytes: &[u8], at: usize) -> (Vec<(u16, Vec<usize>)>, usize) {
    let short = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let long = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let entries = (0..short(at)).map(|i| {
        let row = at + 2 + 12 * i;
        let (kind, count) = (short(row + 2), long(row + 4));
        let size = if kind == 3 { 2 } else { 4 };
        let values = if matches!(kind, 3 | 4) {
            let from = if count * size <= 4 { row + 8 } else { long(row + 8) };
            (0..count).map(|k| if size == 2 { short(from + 2 * k) } else { long(from + 4 * k) }).collect()
        } else {
            Vec::new()
        };
        (short(row) as u16, values)
    });
    (entries.collect(), long(at + 2 + 12 * short(at)))
}

#[test]
fn its_parts_stand_in_the_order_that_readers_over_a_network_expect() {
    let (_folder, _, bytes) = written(&plane(SampleType::F32));
    let note = std::str::from_utf8(&bytes[8..51]).unwrap();
    let length: usize = note["GDAL_STRUCTURAL_METADATA_SIZE=".len()..][..6].parse().unwrap();
    let text = std::str::from_utf8(&bytes[51..51 + length]).unwrap();
    assert!(note.ends_with(" bytes\n"), "{note:?}");
    let said = ["LAYOUT=IFDS_BEFORE_DATA", "BLOCK_LEADER=SIZE_AS_UINT4", "BLOCK_TRAILER=LAST_4_BYTES_REPEATED"];
    assert!(said.iter().all(|s| text.lines().any(|line| line == *s)), "{text:?}");
    let mut at = u32::from_le_bytes(bytes[4..8].try_into().unwrap()) as usize;
    assert!(at >= 51 + length);
    let (mut sizes, mut starts, mut last_directory) = (Vec::new(), Vec::new(), 0);
    while at != 0 {
        assert!(at > last_directory && at.is_multiple_of(2));
        last_directory = at;
        let (entries, next) = directory(&bytes, at);
        let get = |tag: u16| entries.iter().find(|(t, _)| *t == tag).map(|(_, v)| v.clone());
        let one = |tag: u16| get(tag).unwrap()[0];
        assert!(entries.windows(2).all(|w| w[0].0 < w[1].0));
        assert_eq!([one(322), one(323), one(259), one(317)], [512, 512, 8, 3]);
        assert_eq!(get(254).map(|v| v[0]), (!sizes.is_empty()).then_some(1), "overviews say that they are");
        assert_eq!(get(34735).is_some(), sizes.is_empty(), "the image alone is placed");
        assert!(get(42113).is_some(), "all name the no-data value");
        let (offsets, counts) = (get(324).unwrap(), get(325).unwrap());
        let mut end = offsets[0] - 4;
        for (offset, count) in offsets.iter().zip(&counts) {
            assert_eq!(*offset, end + 4, "tiles follow each other");
            assert_eq!(bytes[offset - 4..*offset], (*count as u32).to_le_bytes());
            end = offset + count + 4;
            assert_eq!(bytes[end - 4..end], bytes[end - 8..end - 4]);
        }
        sizes.push([one(256), one(257)]);
        starts.push([offsets[0], end]);
        at = next;
    }
    assert_eq!(sizes, [[1301, 700], [651, 350], [326, 175]]);
    assert!(starts.iter().all(|s| s[0] > last_directory), "all directories come before all tiles");
    assert!(starts.windows(2).all(|w| w[1][1] + 4 == w[0][0]), "{starts:?}: the smallest image first");
    assert_eq!(starts[0][1], bytes.len());
}

#[test]
fn readers_find_the_image_and_overviews_in_its_place() {
    for kind in [SampleType::F32, SampleType::F64, SampleType::I16] {
        let mut raster = plane(kind);
        let (_folder, path, _) = written(&raster);
        raster.info.path = path.clone();
        raster.info.overviews = vec![[651, 350], [326, 175]];
        let loaded = GeoTiff::open(&path, Limits::default()).unwrap();
        assert_eq!(loaded.warnings, []);
        let file = loaded.value;
        assert_eq!(file.read(0, &Progress::silent()).unwrap(), raster);
        for level in 1..3 {
            let overview = file.read(level, &Progress::silent()).unwrap();
            let [w, h] = [overview.info.width, overview.info.height];
            let size = 1 << level;
            let mut holes = 0;
            // Values of the plane at the middle of a pixel, at most what a whole number rounds.
            let map = overview.info.pixel_to_model.unwrap();
            for (col, row) in (0..h).flat_map(|row| (0..w).map(move |col| (col, row))) {
                let Some(value) = overview.sample_f64(0, col, row) else {
                    let inside = (64 / size..96 / size).contains(&col) && (128 / size..192 / size).contains(&row);
                    assert!(inside, "{kind:?} {level} {col} {row}");
                    holes += 1;
                    continue;
                };
                let [x, y] = map.apply(col as f64 + 0.5, row as f64 + 0.5);
                let wanted = 2.0 * ((x - 500_000.0) / 10.0 - 0.5) - 3.0 * ((5_000_000.0 - y) / 10.0 - 0.5);
                let near_hole = (60..100).contains(&(col * size)) && (124..196).contains(&(row * size));
                // The columns are an odd number, so a pixel covers a little less than two, and the parts move its mean.
                let most = if near_hole { 8.0 } else { 0.6 * size as f64 };
                assert!((value - wanted).abs() < most, "{kind:?} {level} {col} {row}: {value}, {wanted}");
            }
            assert!(holes > (32 / size - 2) * (64 / size - 2) && holes <= (32 / size) * (64 / size), "{holes}");
        }
    }
}

#[test]
fn another_decoder_reads_it() {
    use tiff::decoder::{Decoder, DecodingResult};
    let raster = plane(SampleType::F32);
    let (_folder, _, bytes) = written(&raster);
    let mut decoder = Decoder::new(std::io::Cursor::new(&bytes)).unwrap();
    let theirs = decoder.read_image().unwrap();
    assert!(matches!((theirs, &raster.samples), (DecodingResult::F32(a), Samples::F32(b)) if a == *b));
    decoder.next_image().unwrap();
    assert_eq!(decoder.dimensions().unwrap(), (651, 350));
    assert!(
        matches!(decoder.read_image().unwrap(), DecodingResult::F32(v) if (v[0] + 0.5).abs() < 0.01 && v.len() == 651 * 350)
    );
}

#[test]
fn a_mean_that_happens_to_be_the_no_data_value_is_no_hole() {
    let mut info = RasterInfo::new("a.tif", 514, 2, SampleType::I16);
    info.nodata = Some(0.0);
    let samples = Samples::I16((0..2 * 514).map(|i| if i % 2 == 0 { 5 } else { -5 }).collect());
    let (_folder, path, _) = written(&Raster { info, samples, mask: None });
    let file = GeoTiff::open(&path, Limits::default()).unwrap().value;
    let overview = file.read(1, &Progress::silent()).unwrap();
    assert!((0..257).all(|col| overview.sample_f64(0, col, 0).is_some_and(|v| v.abs() == 5.0)));
}

#[test]
fn small_images_have_one_tile_and_no_overview() {
    let mut info = RasterInfo::new("a.tif", 3, 2, SampleType::F32);
    info.nodata = Some(f64::NAN);
    let raster = Raster { info, samples: Samples::F32(vec![1.0, 2.0, 3.0, 4.0, 5.0, f32::NAN]), mask: None };
    let (_folder, path, bytes) = written(&raster);
    let file = GeoTiff::open(&path, Limits::default()).unwrap().value;
    let back = file.read(0, &Progress::silent()).unwrap();
    let found: Vec<_> = (0..6).map(|i| back.sample_f64(0, i % 3, i / 3)).collect();
    assert_eq!((found, file.levels()), (vec![Some(1.0), Some(2.0), Some(3.0), Some(4.0), Some(5.0), None], 1));
    assert!(bytes.len() < 20_000, "{} bytes", bytes.len());
}
