//! Finished pictures in every format, read by other readers.

use belvedere_io::picture_file::{PictureFile, PictureFormat};
use std::io::Cursor;

const FORMATS: [PictureFormat; 4] = [PictureFormat::Png, PictureFormat::Tiff, PictureFormat::Jpeg, PictureFormat::WebP];
const TEXT: [(&str, &str); 3] = [("Software", "belvedere"), ("Title", "Höhenweg"), ("Comment", "bent view")];

/// Slow waves of colour, so that a lossy format keeps them.
fn pixels(width: usize, height: usize) -> Vec<u8> {
    let wave = |i: usize, n: usize| (127.5 + 120.0 * (i as f64 * 6.0 / n as f64).sin()) as u8;
    (0..width * height).flat_map(|i| [wave(i % width, width), wave(i / width, height), 90]).collect()
}

fn encoded(format: PictureFormat, (width, height): (usize, usize), dpi: Option<f64>) -> Vec<u8> {
    let pixels = pixels(width, height);
    let mut out = Vec::new();
    PictureFile { width, height, pixels: &pixels, dpi, text: &TEXT }.encode(format, &mut out).expect("encoded");
    out
}

fn decoded(format: PictureFormat, bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    match format {
        PictureFormat::Png => {
            let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().expect("a PNG");
            let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
            let info = reader.next_frame(&mut pixels).expect("pixels");
            (info.width as usize, info.height as usize, pixels)
        }
        PictureFormat::Tiff => {
            let mut reader = tiff::decoder::Decoder::new(Cursor::new(bytes)).expect("a TIFF");
            let (w, h) = reader.dimensions().expect("a size");
            let tiff::decoder::DecodingResult::U8(pixels) = reader.read_image().expect("pixels") else { panic!() };
            (w as usize, h as usize, pixels)
        }
        PictureFormat::Jpeg => {
            let mut reader = zune_jpeg::JpegDecoder::new(Cursor::new(bytes));
            let pixels = reader.decode().expect("pixels");
            let (w, h) = reader.dimensions().expect("a size");
            (w, h, pixels)
        }
        PictureFormat::WebP => {
            let mut reader = image_webp::WebPDecoder::new(Cursor::new(bytes)).expect("a WebP");
            let (w, h) = reader.dimensions();
            let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
            reader.read_image(&mut pixels).expect("pixels");
            (w as usize, h as usize, pixels)
        }
    }
}

#[test]
fn every_format_holds_the_pixels() {
    // 700 rows of 701 pixels: several strips of a TIFF.
    for size in [(701, 700), (1, 1), (3, 40)] {
        for format in FORMATS {
            let (width, height, found) = decoded(format, &encoded(format, size, Some(300.0)));
            let wanted = pixels(size.0, size.1);
            assert_eq!((width, height, found.len()), (size.0, size.1, wanted.len()), "{format:?}");
            let off = found.iter().zip(&wanted).map(|(a, b)| a.abs_diff(*b)).max();
            let most = if format == PictureFormat::Jpeg { 16 } else { 0 };
            assert!(off <= Some(most), "{format:?} {size:?}: off by {off:?}");
        }
    }
}

#[test]
fn resolutions_are_those_that_other_readers_find() {
    let png = encoded(PictureFormat::Png, (8, 6), Some(300.0));
    let reader = png::Decoder::new(Cursor::new(png)).read_info().expect("a PNG");
    let dims = reader.info().pixel_dims.expect("pHYs");
    assert_eq!((dims.xppu, dims.yppu, dims.unit), (11_811, 11_811, png::Unit::Meter), "300 per inch");
    let none = encoded(PictureFormat::Png, (8, 6), None);
    assert!(png::Decoder::new(Cursor::new(none)).read_info().expect("a PNG").info().pixel_dims.is_none());

    let file = encoded(PictureFormat::Tiff, (8, 6), Some(254.5));
    let mut reader = tiff::decoder::Decoder::new(Cursor::new(file)).expect("a TIFF");
    use tiff::{decoder::ifd::Value, tags::Tag};
    for tag in [Tag::XResolution, Tag::YResolution] {
        let Value::Rational(n, d) = reader.get_tag(tag).expect("a resolution") else { panic!("no rational") };
        assert_eq!(f64::from(n) / f64::from(d), 254.5);
    }
    assert_eq!(reader.get_tag_u32(Tag::ResolutionUnit).expect("a unit"), 2, "inches");
    assert_eq!(reader.get_tag_ascii_string(Tag::ImageDescription).expect("words"), "Höhenweg: bent view");

    let jpeg = encoded(PictureFormat::Jpeg, (8, 6), Some(600.0));
    let at = jpeg.windows(5).position(|w| w == b"JFIF\0").expect("JFIF");
    assert_eq!(jpeg[at + 7..at + 12], [1, 2, 88, 2, 88], "600 per inch both ways");
    assert!(jpeg.windows(9).any(|w| w == b"bent view"));
}

#[test]
fn sizes_that_a_format_cannot_hold_are_refused_in_one_line() {
    let pixels = vec![0; 3 * 16_385];
    let picture = PictureFile { width: 16_385, height: 1, pixels: &pixels, dpi: None, text: &[] };
    let refused = picture.encode(PictureFormat::WebP, &mut Vec::new()).expect_err("too wide").to_string();
    assert_eq!(
        refused,
        "a WebP has at most 16384 pixels along a side, the picture has 16385 x 1; write a PNG or a TIFF"
    );
    assert!(picture.encode(PictureFormat::Tiff, &mut Vec::new()).is_ok());
    let short = PictureFile { width: 3, height: 3, pixels: &pixels[..26], dpi: None, text: &[] };
    assert!(FORMATS.iter().all(|format| short.encode(*format, &mut Vec::new()).is_err()));
}
