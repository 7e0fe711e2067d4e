//! Folders that are one volume: pictures as slices.

use crate::tiff_writer::PLAIN;
use belvedere_io::formats::Reader;
use belvedere_io::picture_file::{PictureFile, PictureFormat};
use belvedere_io::{Arrays, Known, Limits, Number, VolumeFile, VolumeRequest, load_volume};
use std::path::Path;

fn load(path: &Path) -> Result<(VolumeFile, Vec<String>), String> {
    let loaded = load_volume(path, &VolumeRequest::default()).map_err(|e| e.to_string())?;
    Ok((loaded.value, loaded.warnings.iter().map(|w| w.text().to_owned()).collect()))
}

fn reader(path: &Path) -> Option<Reader> {
    Known::of(path, &Arrays::default()).expect("a folder").reader
}

/// A grey PNG of one value, of 8 or 16 bits.
fn png_of(width: u32, height: u32, value: u16, depth: png::BitDepth) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    let pixel = if depth == png::BitDepth::Sixteen { value.to_be_bytes().to_vec() } else { vec![value as u8] };
    let mut writer = encoder.write_header().expect("memory");
    writer.write_image_data(&pixel.repeat((width * height) as usize)).expect("memory");
    writer.finish().expect("memory");
    out
}

fn write(folder: &Path, name: &str, bytes: &[u8]) {
    std::fs::write(folder.join(name), bytes).expect("written");
}

/// The value of each slice.
fn slices(file: &VolumeFile) -> Vec<f32> {
    let [x, y, z] = file.dims;
    (0..z).map(|k| file.values.at(k * x * y)).collect()
}

#[test]
fn pictures_lie_in_the_order_of_their_numbers() {
    for depth in [png::BitDepth::Eight, png::BitDepth::Sixteen] {
        let folder = tempfile::tempdir().expect("a folder");
        let scale = if depth == png::BitDepth::Sixteen { 100 } else { 1 };
        for n in [1u16, 2, 3, 9, 10, 11, 12] {
            write(folder.path(), &format!("ct_{n}.png"), &png_of(4, 3, n * scale, depth));
        }
        write(folder.path(), "notes.txt", b"of a scan\n");
        write(folder.path(), ".hidden.png", b"nothing");
        let (file, warnings) = load(folder.path()).expect("it is read");
        assert_eq!(file.dims, [4, 3, 7]);
        let order = [1u16, 2, 3, 9, 10, 11, 12].map(|n| f32::from(n * scale));
        assert_eq!(slices(&file), order);
        assert_eq!(file.stored, if scale == 1 { Number::UInt8 } else { Number::UInt16 });
        let all = warnings.join("\n");
        assert!(all.contains("7 slices from ct_1.png to ct_12.png lie in the order of the numbers"), "{all}");
        assert!(all.contains("5 numbers are missing in the names of its slices (4, 5, 6, 7, 8)"), "{all}");
        assert!(all.contains("states no spacing; 1 along each axis"), "{all}");
        assert_eq!(reader(folder.path()), Some(Reader::Volume));
        let files = load_volume(folder.path(), &VolumeRequest::default()).expect("it is read").files;
        assert_eq!(files.len(), 7);
    }
}

#[test]
fn tiff_and_jpeg_are_slices_too() {
    let folder = tempfile::tempdir().expect("a folder");
    for n in 0..3u64 {
        write(folder.path(), &format!("a{n}.tif"), &PLAIN.image([4, 3], 1, 16, &[1000 * n; 12], &[]));
    }
    write(folder.path(), "preview.png", &png_of(9, 9, 1, png::BitDepth::Eight));
    let (file, warnings) = load(folder.path()).expect("it is read");
    assert_eq!((slices(&file), file.stored), (vec![0.0, 1000.0, 2000.0], Number::UInt16));
    assert!(warnings.iter().any(|w| w.contains("1 other pictures of the folder are left out")), "{warnings:?}");
    let folder = tempfile::tempdir().expect("a folder");
    for n in 0..3u8 {
        let pixels = [40 * n + 20; 3 * 16 * 16];
        let picture = PictureFile { width: 16, height: 16, pixels: &pixels, dpi: None, text: &[] };
        let mut bytes = Vec::new();
        picture.encode(PictureFormat::Jpeg, &mut bytes).expect("memory");
        write(folder.path(), &format!("a{n}.jpg"), &bytes);
    }
    let (file, warnings) = load(folder.path()).expect("it is read");
    for (found, wanted) in slices(&file).into_iter().zip([20.0, 60.0, 100.0]) {
        assert!((found - wanted).abs() <= 1.0, "{found}");
    }
    assert!(warnings.iter().any(|w| w.contains("pixels are colours; their brightness is taken")), "{warnings:?}");
}

#[test]
fn other_folders_are_no_volumes() {
    let map = PLAIN.image([4, 3], 1, 16, &[7; 12], &[(34735, 3, vec![1, 1, 0, 0])]);
    let plain = PLAIN.image([4, 3], 1, 16, &[7; 12], &[]);
    let png = png_of(4, 3, 1, png::BitDepth::Eight);
    let cases: [&[(&str, &[u8])]; 4] = [
        &[("a.tif", &map), ("b.tif", &map)],
        &[("a.tif", &plain)],
        &[("a.png", &png), ("b.png", &png), ("a.pgw", b"1\n0\n0\n-1\n0\n0\n")],
        &[("a.png", &png), ("b.png", &png), ("N46E010.hgt", b"x")],
    ];
    for files in cases {
        let folder = tempfile::tempdir().expect("a folder");
        files.iter().for_each(|(name, bytes)| write(folder.path(), name, bytes));
        assert_eq!(reader(folder.path()), Some(Reader::Terrain), "{:?}", files[0].0);
        let error = load(folder.path()).expect_err("no volume");
        assert!(error.contains("is a folder without slices of a volume"), "{error}");
    }
}

#[test]
fn slices_that_differ_or_are_damaged_are_one_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = png_of(4, 3, 5, png::BitDepth::Eight);
    write(folder.path(), "a1.png", &whole);
    write(folder.path(), "a2.png", &png_of(5, 3, 5, png::BitDepth::Eight));
    let error = load(folder.path()).expect_err("they differ");
    assert!(error.contains("a2.png: has 5 x 3 pixels") && error.contains("the first slice has 4 x 3"), "{error}");
    write(folder.path(), "a2.png", &png_of(4, 3, 5, png::BitDepth::Sixteen));
    assert!(load(folder.path()).expect_err("they differ").contains("of 1 uint16"));
    for length in 0..whole.len() - 12 {
        write(folder.path(), "a2.png", &whole[..length]);
        let error = load(folder.path()).expect_err("it is cut");
        assert!(error.contains("a2.png") && error.lines().count() == 1, "{error}");
    }
    write(folder.path(), "a2.png", &whole);
    let limits = Limits { max_bytes: 20 };
    assert!(load_volume(folder.path(), &VolumeRequest { limits, ..Default::default() }).is_err());
    // A link that leads out of the folder is not followed.
    #[cfg(unix)]
    {
        let outside = tempfile::tempdir().expect("a folder");
        write(outside.path(), "secret.png", &whole);
        std::os::unix::fs::symlink(outside.path().join("secret.png"), folder.path().join("a3.png")).expect("a link");
        let error = load(folder.path()).expect_err("it leads out");
        assert!(error.contains("a link that leads out of its folder"), "{error}");
    }
}
