//! PNG: pictures and texts are read as they were written, and the bytes are the same every time.

use crate::atomic::Folder;
use belvedere_io::png::{Channels, encode, read, write};
use belvedere_io::{IoError, Limits};
use std::fs;
use std::io::Cursor;

fn picture(width: usize, height: usize, channels: usize) -> Vec<u8> {
    (0..width * height * channels).map(|i| ((i * i / 97) ^ (i >> 3)) as u8).collect()
}

#[test]
fn pixels_and_text_come_back() {
    for (channels, n) in [(Channels::Gray, 1), (Channels::Rgb, 3), (Channels::Rgba, 4)] {
        for (width, height) in [(1, 1), (3, 2), (257, 31)] {
            let pixels = picture(width, height, n);
            let text = [("Software", "Belvedere 0.1"), ("Title", "Über den Paß"), ("Comment", "")];
            let mut bytes = Vec::new();
            encode(&mut bytes, width, height, channels, &pixels, &text).unwrap();
            let mut again = Vec::new();
            encode(&mut again, width, height, channels, &pixels, &text).unwrap();
            assert_eq!(bytes, again);
            let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().unwrap();
            let mut read = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut read).unwrap();
            assert_eq!((info.width as usize, info.height as usize), (width, height));
            assert_eq!(read, pixels);
            let plain = &reader.info().uncompressed_latin1_text;
            assert_eq!((plain[0].keyword.as_str(), plain[0].text.as_str()), ("Software", "Belvedere 0.1"));
            assert_eq!(plain[1].keyword, "Comment");
            let unicode = &reader.info().utf8_text;
            assert_eq!(unicode[0].keyword, "Title");
            assert_eq!(unicode[0].get_text().unwrap(), "Über den Paß");
            assert!(reader.info().srgb.is_some());
        }
    }
}

#[test]
fn a_smooth_picture_gets_small() {
    let (w, h) = (640, 360);
    let pixels: Vec<u8> = (0..w * h).flat_map(|i| [(i % w / 3) as u8, (i / w / 2) as u8, 120]).collect();
    let mut bytes = Vec::new();
    encode(&mut bytes, w, h, Channels::Rgb, &pixels, &[]).unwrap();
    assert!(bytes.len() * 20 < pixels.len(), "{} bytes of {}", bytes.len(), pixels.len());
}

#[test]
fn wrong_sizes_and_keywords_are_refused() {
    let long = "k".repeat(80);
    let mut out = Vec::new();
    assert!(encode(&mut out, 0, 4, Channels::Rgb, &[], &[]).is_err());
    assert!(encode(&mut out, 2, 2, Channels::Rgb, &[0; 11], &[]).is_err());
    assert!(encode(&mut out, usize::MAX, 2, Channels::Rgb, &[0; 12], &[]).is_err());
    for keyword in ["", &long, "Tïtle", " x", "a\nb"] {
        let error = encode(&mut out, 2, 2, Channels::Rgb, &[0; 12], &[(keyword, "x")]).unwrap_err();
        assert!(error.to_string().contains("keyword"), "{error}");
    }
    assert!(out.is_empty());
}

#[test]
fn pictures_are_read_as_colours_or_refused() {
    let folder = Folder::new("png-read");
    let path = folder.0.join("p.png");
    for (channels, n) in [(Channels::Gray, 1), (Channels::Rgb, 3), (Channels::Rgba, 4)] {
        let pixels = picture(31, 17, n);
        write(&path, true, 31, 17, channels, &pixels, &[]).unwrap();
        let colors = read(&path, &Limits::default()).unwrap().to_rgba().unwrap();
        for (i, color) in colors.iter().enumerate() {
            let p = &pixels[i * n..(i + 1) * n];
            let expected = match *p {
                [g] => [g, g, g, 255],
                [r, g, b] => [r, g, b, 255],
                _ => [p[0], p[1], p[2], p[3]],
            };
            assert_eq!(*color, expected, "pixel {i}");
        }
    }
    let error = read(&path, &Limits { max_bytes: 1000 }).unwrap_err().to_string();
    assert!(error.contains("p.png") && !error.contains('\n'), "{error}");
    let bytes = fs::read(&path).unwrap();
    for keep in [0, 8, 20, 40, bytes.len() / 2] {
        fs::write(&path, &bytes[..keep]).unwrap();
        let error = read(&path, &Limits::default()).unwrap_err();
        assert!(matches!(error, IoError::Format { .. }), "{keep} bytes: {error}");
    }
}
