//! Stacks of images in one TIFF: of ImageJ, OME-TIFF, and of plain pages.

use crate::support_files::Folder;
use crate::tiff_writer::{Entry, PLAIN};
use belvedere_io::formats::Reader;
use belvedere_io::{Arrays, Known, Limits, VolumeFile, VolumeRequest, load_volume};
use belvedere_testkit::data;
use glam::{DMat3, DVec3};
use std::path::Path;

fn load(path: &Path) -> Result<(VolumeFile, Vec<String>), String> {
    let loaded = load_volume(path, &VolumeRequest::default()).map_err(|e| e.to_string())?;
    Ok((loaded.value, loaded.warnings.iter().map(|w| w.text().to_owned()).collect()))
}

fn reader(path: &Path) -> Option<Reader> {
    Known::of(path, &Arrays::default()).expect("a file").reader
}

/// Pages of 4 x 3 pixels of 16 bits, and what the first one says.
struct Stack<'t> {
    big_endian: bool,
    pages: usize,
    description: &'t str,
    /// Pixels per unit.
    resolution: Option<[u32; 2]>,
    extra: Vec<Entry>,
}

const ONE: Stack<'static> = Stack { big_endian: false, pages: 5, description: "", resolution: None, extra: Vec::new() };

/// The value of a pixel of a page.
fn value(page: usize, x: usize, y: usize) -> u16 {
    (1000 * page + 10 * y + x) as u16
}

impl Stack<'_> {
    fn number(&self, v: u32, size: usize) -> Vec<u8> {
        let mut bytes = v.to_le_bytes()[..size].to_vec();
        if self.big_endian {
            bytes.reverse();
        }
        bytes
    }

    fn pixels(&self, page: usize) -> Vec<u8> {
        let of = |i: usize| self.number(u32::from(value(page, i % 4, i / 4)), 2);
        (0..12).flat_map(of).collect()
    }

    fn file(&self) -> Vec<u8> {
        let mut out = if self.big_endian { b"MM".to_vec() } else { b"II".to_vec() };
        out.extend(self.number(42, 2));
        out.extend(self.number(8, 4));
        for page in 0..self.pages {
            let mut tail = self.pixels(page);
            let mut entries: Vec<(u16, u16, u32, Vec<u8>)> = vec![
                (256, 3, 1, self.number(4, 2)),
                (257, 3, 1, self.number(3, 2)),
                (258, 3, 1, self.number(16, 2)),
                (259, 3, 1, self.number(1, 2)),
                (262, 3, 1, self.number(1, 2)),
                (277, 3, 1, self.number(1, 2)),
                (278, 3, 1, self.number(3, 2)),
                (279, 4, 1, self.number(24, 4)),
            ];
            for (number, kind, values) in &self.extra {
                let size = if *kind == 3 { 2 } else { 4 };
                let bytes = values.iter().flat_map(|v| self.number(*v as u32, size)).collect();
                entries.push((*number, *kind, values.len() as u32, bytes));
            }
            let mut far: Vec<(u16, u16, u32, Vec<u8>)> = Vec::new();
            if page == 0 && !self.description.is_empty() {
                let text = [self.description.as_bytes(), b"\0"].concat();
                far.push((270, 2, text.len() as u32, text));
            }
            for (number, per_unit) in [282, 283].into_iter().zip(self.resolution.unwrap_or_default()) {
                if self.resolution.is_some() {
                    far.push((number, 5, 1, [self.number(per_unit, 4), self.number(10, 4)].concat()));
                }
            }
            let count = entries.len() + far.len() + 1;
            let body = out.len() + 2 + 12 * count + 4;
            entries.push((273, 4, 1, self.number(body as u32, 4)));
            for (number, kind, count, bytes) in far {
                entries.push((number, kind, count, self.number((body + tail.len()) as u32, 4)));
                tail.extend(bytes);
            }
            entries.sort_by_key(|e| e.0);
            out.extend(self.number(count as u32, 2));
            for (number, kind, count, mut bytes) in entries {
                bytes.resize(4, 0);
                out.extend(self.number(u32::from(number), 2));
                out.extend(self.number(u32::from(kind), 2));
                out.extend(self.number(count, 4));
                out.extend(bytes);
            }
            let next = if page + 1 < self.pages { (body + tail.len()) as u32 } else { 0 };
            out.extend(self.number(next, 4));
            out.extend(tail);
        }
        out
    }
}

fn spacing(file: &VolumeFile) -> DVec3 {
    assert_eq!(
        file.axes,
        DMat3::from_diagonal(file.axes.to_cols_array_2d().iter().enumerate().fold(
            DVec3::ZERO,
            |mut all, (i, column)| {
                all[i] = column[i];
                all
            }
        ))
    );
    DVec3::new(file.axes.x_axis.x, file.axes.y_axis.y, file.axes.z_axis.z)
}

/// Pages of the slices of a volume.
fn pages_of(file: &VolumeFile) -> Vec<usize> {
    assert_eq!(file.dims[..2], [4, 3]);
    let at = |z: usize, x: usize, y: usize| file.values.at((z * 3 + y) * 4 + x) as u16;
    let page = |z: usize| usize::from(at(z, 0, 0)) / 1000;
    for z in 0..file.dims[2] {
        for (x, y) in [(3, 0), (0, 2), (3, 2)] {
            assert_eq!(at(z, x, y), value(page(z), x, y));
        }
    }
    (0..file.dims[2]).map(page).collect()
}

#[test]
fn the_stack_of_the_cases_is_a_volume() {
    let Some(path) = data("cases/files/v04b_imagej.tif") else { return };
    let (file, warnings) = load(&path).expect("it is read");
    assert_eq!((file.format, file.dims), ("ImageJ stack", [48, 40, 32]));
    assert_eq!((spacing(&file), warnings), (DVec3::new(1.0, 1.0, 2.5), Vec::<String>::new()));
    assert_eq!(reader(&path), Some(Reader::Volume));
}

#[test]
fn stacks_of_imagej_know_channels_times_and_spacing() {
    let folder = Folder::new();
    for big_endian in [false, true] {
        let text =
            "ImageJ=1.54f\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\nunit=micron\nspacing=-2.5\n";
        let made = Stack { big_endian, pages: 12, description: text, resolution: Some([40, 20]), ..ONE };
        let path = folder.file("a.tif", &made.file());
        let (file, warnings) = load(&path).expect("it is read");
        assert_eq!((pages_of(&file), spacing(&file)), (vec![0, 2, 4], DVec3::new(0.25, 0.5, 2.5)));
        assert!(
            warnings[0].contains("2 channels; the first is taken") && warnings[1].contains("2 times"),
            "{warnings:?}"
        );
        assert_eq!(reader(&path), Some(Reader::Volume));
    }
    let times = Stack { pages: 4, description: "ImageJ=1\nimages=4\nframes=4\n", ..ONE };
    let (file, warnings) = load(&folder.file("t.tif", &times.file())).expect("it is read");
    assert_eq!(pages_of(&file), [0, 1, 2, 3]);
    assert!(warnings[0].contains("4 times of one slice; they are taken as slices"), "{warnings:?}");
}

/// ImageJ writes stacks of 4 GiB and more with one directory; the images lie behind it.
#[test]
fn one_directory_stands_for_images_in_a_row() {
    let folder = Folder::new();
    for big_endian in [false, true] {
        let made = Stack { big_endian, pages: 1, description: "ImageJ=1.54f\nimages=6\nslices=6\n", ..ONE };
        let mut bytes = made.file();
        // The description moves before the samples, so that they end the file.
        let at = bytes.windows(7).position(|w| w == b"ImageJ=").expect("text");
        let text = bytes[at..].to_vec();
        let start = at - 24;
        bytes.truncate(start);
        bytes.extend(&text);
        let patch = |bytes: &mut Vec<u8>, from: usize, to: usize| {
            let (from, to) = (made.number(from as u32, 4), made.number(to as u32, 4));
            let place = bytes.windows(4).position(|w| w == from).expect("a place");
            bytes[place..place + 4].copy_from_slice(&to);
        };
        patch(&mut bytes, at, start);
        let samples = bytes.len();
        let place = bytes.windows(4).rposition(|w| w == made.number(start as u32, 4)).expect("a place");
        bytes[place..place + 4].copy_from_slice(&made.number(samples as u32, 4));
        (0..6).for_each(|page| bytes.extend(made.pixels(page)));
        let (file, _) = load(&folder.file("row.tif", &bytes)).expect("it is read");
        assert_eq!(pages_of(&file), [0, 1, 2, 3, 4, 5]);
        bytes.truncate(bytes.len() - 1);
        let cut = load(&folder.file("row.tif", &bytes)).expect_err("it is cut");
        assert!(cut.contains("declares 6 slices and holds 5; it is cut off"), "{cut}");
    }
}

#[test]
fn ome_tiffs_state_planes_and_sizes() {
    let folder = Folder::new();
    let text = "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image ID=\"Image:0\"><Pixels ID=\"P\" DimensionOrder=\"XYCZT\" Type=\"uint16\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"3\" SizeC=\"2\" SizeT=\"1\" PhysicalSizeX=\"0.2\" PhysicalSizeY=\"0.2\" PhysicalSizeZ=\"1500\" PhysicalSizeZUnit=\"nm\"><Channel ID=\"C:0\"/><TiffData/></Pixels></Image></OME>";
    let made = Stack { pages: 6, description: text, ..ONE };
    for name in ["a.ome.tif", "a.tif", "without_an_ending"] {
        let path = folder.file(name, &made.file());
        let (file, warnings) = load(&path).expect("it is read");
        assert_eq!(
            (file.format, pages_of(&file), spacing(&file)),
            ("OME-TIFF", vec![0, 2, 4], DVec3::new(0.2, 0.2, 1.5))
        );
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert_eq!(reader(&path), Some(Reader::Volume), "{name}");
    }
    let several = text.replace(
        "<TiffData/>",
        "<TiffData IFD=\"0\"><UUID FileName=\"a.ome.tif\">u</UUID></TiffData><TiffData FirstZ=\"1\"><UUID FileName=\"b.ome.tif\">v</UUID></TiffData>",
    );
    let made = Stack { pages: 6, description: &several, ..ONE };
    let error = load(&folder.file("a.ome.tif", &made.file())).expect_err("it is in two files");
    assert!(error.contains("planes are in 2 files"), "{error}");
}

#[test]
fn plain_pages_are_a_volume_and_those_with_a_place_are_not() {
    let folder = Folder::new();
    let path = folder.file("plain.tif", &ONE.file());
    let (file, warnings) = load(&path).expect("it is read");
    assert_eq!((pages_of(&file), spacing(&file)), (vec![0, 1, 2, 3, 4], DVec3::ONE));
    assert!(warnings[0].contains("states no spacing; 1 along each axis"), "{warnings:?}");
    assert_eq!(reader(&path), Some(Reader::Volume));
    let request = VolumeRequest {
        raw: belvedere_io::RawLayout { spacing: Some([1.0, 2.0, 3.0]), ..Default::default() },
        ..Default::default()
    };
    let stated = load_volume(&path, &request).expect("it is read");
    assert_eq!((spacing(&stated.value), stated.warnings.len()), (DVec3::new(1.0, 2.0, 3.0), 0));
    // Reduced copies and masks are no slices; a place on the earth makes a map.
    let others = [
        Stack { extra: vec![(254, 4, vec![1])], ..ONE },
        Stack { extra: vec![(34735, 3, vec![1, 1, 0, 0])], ..ONE },
        Stack { pages: 1, ..ONE },
    ];
    for other in others {
        assert_eq!(reader(&folder.file("other.tif", &other.file())), Some(Reader::Terrain));
    }
    let one = PLAIN.image([4, 3], 1, 16, &[7; 12], &[]);
    let error = load(&folder.file("one.tif", &one)).expect_err("one page");
    assert!(error.contains("one page, a volume needs 2"), "{error}");
}

#[test]
fn cut_stacks_have_one_error_and_hostile_ones_are_refused() {
    let folder = Folder::new();
    let whole = Stack { description: "ImageJ=1\nimages=5\nslices=5\n", ..ONE }.file();
    for length in 0..whole.len() {
        let error = load(&folder.file("cut.tif", &whole[..length])).err();
        let tail_only = length > whole.len() - 2;
        assert!(error.is_some_and(|e| !e.is_empty() && e.lines().count() == 1) || tail_only, "{length}");
    }
    for text in [
        "images=2147483648\nslices=2147483648\n",
        "images=5\nslices=99999999999999999999\n",
        "images=5\nslices=-4\n",
        "slices=5\nspacing=nan\n",
    ] {
        let text = format!("ImageJ=1\n{text}");
        let error = load(&folder.file("odd.tif", &Stack { description: &text, ..ONE }.file()));
        assert!(error.is_err(), "{text}");
    }
    let limits = Limits { max_bytes: 100 };
    let path = folder.file("small.tif", &ONE.file());
    let error = load_volume(&path, &VolumeRequest { limits, ..Default::default() }).expect_err("too large").to_string();
    assert!(error.contains("the volume needs"), "{error}");
}
