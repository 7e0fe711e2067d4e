//! Series of DICOM in folders, and files of several frames.

use crate::dicom_writer::Syntax;
use crate::support_files::Folder;
use belvedere_io::formats::Reader;
use belvedere_io::picture_file::{PictureFile, PictureFormat};
use belvedere_io::{Arrays, Known, Limits, Number, VolumeFile, VolumeRequest, load_volume};
use belvedere_scene::VoxelValues;
use glam::{DMat3, DVec3};
use std::path::Path;

const SYNTAXES: [Syntax; 5] =
    [Syntax::Implicit, Syntax::Explicit, Syntax::BigEndian, Syntax::Deflated, Syntax::RunLengths];

fn load(path: &Path) -> Result<(VolumeFile, Vec<String>), String> {
    let loaded = load_volume(path, &VolumeRequest::default()).map_err(|e| e.to_string())?;
    Ok((loaded.value, loaded.warnings.iter().map(|w| w.text().to_owned()).collect()))
}

/// A slice of 4 x 3 pixels.
#[derive(Clone)]
struct Slice {
    syntax: Syntax,
    series: &'static str,
    number: usize,
    /// First of its values.
    value: i16,
    position: Option<[f64; 3]>,
    orientation: [f64; 6],
    rescale: [f64; 2],
}

const SLICE: Slice = Slice {
    syntax: Syntax::Explicit,
    series: "1.2.3",
    number: 1,
    value: 100,
    position: None,
    orientation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    rescale: [1.0, -1024.0],
};

fn list(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join("\\")
}

/// Samples of 12 of 16 bits; the four above are of no meaning.
fn samples(first: i16) -> Vec<u8> {
    (0..12).flat_map(|i| ((first + i) as u16 | 0xa000).to_le_bytes()).collect()
}

/// Elements that state 4 x 3 pixels.
fn layout(s: Syntax, bits: [u16; 2], signed: bool) -> Vec<Vec<u8>> {
    vec![
        s.short(0x0028_0002, 1),
        s.text(0x0028_0004, b"CS", "MONOCHROME2"),
        s.short(0x0028_0010, 3),
        s.short(0x0028_0011, 4),
        s.text(0x0028_0030, b"DS", "0.5\\0.25"),
        s.short(0x0028_0100, bits[0]),
        s.short(0x0028_0101, bits[1]),
        s.short(0x0028_0102, bits[1] - 1),
        s.short(0x0028_0103, u16::from(signed)),
    ]
}

impl Slice {
    fn file(&self) -> Vec<u8> {
        let s = self.syntax;
        let mut elements = vec![
            s.text(0x0008_0060, b"CS", "CT"),
            s.text(0x0008_103e, b"LO", "Thorax"),
            s.sequence(0x0008_1140, &[s.text(0x0008_1155, b"UI", "1.9")], s != Syntax::Implicit),
            s.text(0x0018_0050, b"DS", "3"),
            s.text(0x0020_000e, b"UI", self.series),
            s.text(0x0020_0013, b"IS", &self.number.to_string()),
        ];
        if let Some(position) = self.position {
            elements.push(s.text(0x0020_0032, b"DS", &list(&position)));
            elements.push(s.text(0x0020_0037, b"DS", &list(&self.orientation)));
        }
        elements.extend(layout(s, [16, 12], false));
        elements.push(s.text(0x0028_1052, b"DS", &self.rescale[1].to_string()));
        elements.push(s.text(0x0028_1053, b"DS", &self.rescale[0].to_string()));
        elements.push(s.pixels(&[samples(self.value)], 2));
        s.file(&elements)
    }
}

fn write(folder: &Path, name: &str, slice: &Slice) {
    std::fs::write(folder.join(name), slice.file()).expect("written");
}

/// First value of each slice.
fn firsts(file: &VolumeFile) -> Vec<f32> {
    (0..file.dims[2]).map(|k| file.values.at(12 * k)).collect()
}

#[test]
fn a_series_lies_along_its_normal_in_hounsfield_units() {
    for syntax in SYNTAXES {
        let folder = tempfile::tempdir().expect("a folder");
        // Names and numbers run against the positions; coronal slices.
        for k in 0..5 {
            let orientation = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0];
            let position = Some([-10.0, 20.0 - 2.5 * k as f64, 30.0]);
            let slice = Slice { syntax, number: 50 + k, value: 100 * k as i16, position, orientation, ..SLICE };
            write(folder.path(), &format!("IM{:04}", 9 - k), &slice);
        }
        std::fs::write(folder.path().join("README.txt"), "notes").expect("written");
        let (file, warnings) = load(folder.path()).expect("it is read");
        assert_eq!((file.dims, file.stored), ([4, 3, 5], Number::UInt16), "{syntax:?}");
        assert_eq!(firsts(&file), [-624.0, -724.0, -824.0, -924.0, -1024.0], "{syntax:?}");
        assert_eq!(file.values.at(11), -613.0);
        assert!(matches!(file.values, VoxelValues::I16(_)) && warnings.is_empty(), "{warnings:?}");
        // The normal of x and -z is y.
        let axes = DMat3::from_cols(DVec3::new(0.25, 0.0, 0.0), DVec3::new(0.0, 0.0, -0.5), DVec3::new(0.0, 2.5, 0.0));
        assert!(file.axes.abs_diff_eq(axes, 1e-12), "{}", file.axes);
        assert_eq!(file.origin, DVec3::new(-10.0, 10.0, 30.0));
        assert_eq!(Known::of(folder.path(), &Arrays::default()).expect("a folder").reader, Some(Reader::Volume));
    }
}

#[test]
fn gaps_duplicates_and_other_series_are_said() {
    let folder = tempfile::tempdir().expect("a folder");
    for (k, z) in [0.0, 2.0, 4.0, 10.0, 12.0, 12.0].into_iter().enumerate() {
        let position = Some([0.0, 0.0, z]);
        write(folder.path(), &format!("a{k}.dcm"), &Slice { number: k, value: 10 * k as i16, position, ..SLICE });
    }
    for k in 0..2 {
        let orientation = [0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let position = Some([f64::from(k), 0.0, 0.0]);
        write(folder.path(), &format!("b{k}.dcm"), &Slice { position, orientation, ..SLICE });
    }
    write(folder.path(), "c.dcm", &Slice { series: "9.9", position: Some([0.0; 3]), ..SLICE });
    let (file, warnings) = load(folder.path()).expect("it is read");
    assert_eq!(firsts(&file), [-1024.0, -1014.0, -1004.0, -994.0, -984.0]);
    assert_eq!(file.axes.z_axis, DVec3::new(0.0, 0.0, 3.0));
    let all = warnings.join("\n");
    assert!(
        all.contains("it holds 3 series; that of most images is taken (6), left out are \"CT Thorax\" with 2"),
        "{all}"
    );
    assert!(all.contains("1 images at a position of another are left out"), "{all}");
    assert!(all.contains("2.0000 to 6.0000 mm apart, usually 2.0000, as if 2 slices were missing"), "{all}");
}

#[test]
fn images_without_positions_lie_by_their_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    for k in 0..3usize {
        write(
            folder.path(),
            &format!("x{k}.dcm"),
            &Slice { number: 12 - k, value: k as i16, rescale: [0.5, 0.25], ..SLICE },
        );
    }
    let (file, warnings) = load(folder.path()).expect("it is read");
    assert_eq!(firsts(&file), [1.25, 0.75, 0.25]);
    assert_eq!(file.axes, DMat3::from_diagonal(DVec3::new(0.25, 0.5, 3.0)));
    assert!(warnings[0].contains("lie in the order of their numbers"), "{warnings:?}");
    let alone = load(&folder.path().join("x0.dcm")).expect_err("one image");
    assert!(alone.contains("it holds one image at one position, a volume needs 2 or more"), "{alone}");
}

/// Frames of an enhanced object, each of which says where it lies.
fn frames(s: Syntax, open: bool) -> Vec<u8> {
    let per_frame: Vec<Vec<u8>> = [4.0, 0.0, 2.0]
        .map(|z| {
            let position = s.text(0x0020_0032, b"DS", &list(&[1.0, 2.0, z]));
            s.sequence(0x0020_9113, &[position], open)
        })
        .to_vec();
    let turn = s.sequence(0x0020_9116, &[s.text(0x0020_0037, b"DS", "1\\0\\0\\0\\1\\0")], open);
    let scale = [s.text(0x0028_1052, b"DS", "-5"), s.text(0x0028_1053, b"DS", "2")].concat();
    let shared = [turn, s.sequence(0x0028_9145, &[scale], open)].concat();
    let mut elements = vec![s.text(0x0020_000e, b"UI", "7"), s.text(0x0028_0008, b"IS", "3")];
    elements.extend(layout(s, [16, 16], true));
    elements.sort_by_key(|e| e[..4].to_vec());
    elements.push(s.sequence(0x5200_9229, &[shared], open));
    elements.push(s.sequence(0x5200_9230, &per_frame, open));
    let of = |first: i16| (0..12).flat_map(|i| (first - i).to_le_bytes()).collect();
    elements.push(s.pixels(&[of(0), of(100), of(200)], 2));
    s.file(&elements)
}

#[test]
fn one_file_of_several_frames() {
    let folder = Folder::new();
    for syntax in SYNTAXES {
        for open in [false, true] {
            let path = folder.file("frames.dcm", &frames(syntax, open));
            let (file, warnings) = load(&path).expect("it is read");
            assert_eq!(firsts(&file), [195.0, 395.0, -5.0], "{syntax:?}");
            assert_eq!(file.values.at(1), 193.0);
            assert_eq!((file.axes.z_axis, file.origin), (DVec3::new(0.0, 0.0, 2.0), DVec3::new(1.0, 2.0, 0.0)));
            assert!(warnings.is_empty(), "{warnings:?}");
            assert_eq!(Known::of(&path, &Arrays::default()).expect("a file").reader, Some(Reader::Volume));
        }
    }
}

#[test]
fn pixels_as_jpeg() {
    let folder = Folder::new();
    let s = Syntax::Jpeg;
    let jpeg = |value: u8| {
        let pixels = [value; 3 * 16 * 16];
        let mut bytes = Vec::new();
        let picture = PictureFile { width: 16, height: 16, pixels: &pixels, dpi: None, text: &[] };
        picture.encode(PictureFormat::Jpeg, &mut bytes).expect("memory");
        bytes
    };
    let elements = [
        s.short(0x0028_0002, 3),
        s.text(0x0028_0004, b"CS", "YBR_FULL_422"),
        s.text(0x0028_0008, b"IS", "2"),
        s.short(0x0028_0010, 16),
        s.short(0x0028_0011, 16),
        s.short(0x0028_0100, 8),
        s.short(0x0028_0101, 8),
        s.short(0x0028_0102, 7),
        s.pixels(&[jpeg(30), jpeg(200)], 1),
    ];
    let (file, warnings) = load(&folder.file("color.dcm", &s.file(&elements))).expect("it is read");
    assert!((file.values.at(0) - 30.0).abs() <= 1.0 && (file.values.at(256) - 200.0).abs() <= 1.0);
    assert!(warnings.iter().any(|w| w.contains("their brightness is taken")), "{warnings:?}");
}

#[test]
fn what_is_not_read_is_named_with_its_remedy() {
    let folder = Folder::new();
    for (end, name) in [
        (".4.70", "lossless JPEG"),
        (".4.51", "JPEG of 12 bits"),
        (".4.80", "JPEG-LS"),
        (".4.90", "JPEG 2000"),
        (".4.201", "High-Throughput JPEG 2000"),
        (".4.102", "a film (MPEG)"),
        (".9", "an unknown way"),
    ] {
        let slice = Slice { syntax: Syntax::Named(end), ..SLICE };
        let error = load(&folder.file("a.dcm", &slice.file())).expect_err("it is refused");
        assert!(error.contains(name) && error.contains("gdcmconv --raw"), "{error}");
    }
    let s = Syntax::Explicit;
    let with = |tag: u32, element: Vec<u8>| {
        let mut elements = [layout(s, [16, 12], false), vec![s.text(0x0028_0008, b"IS", "2")]].concat();
        elements.retain(|e| e[..4] != element[..4] || tag == 0);
        elements.push(element);
        elements.sort_by_key(|e| [e[1], e[0], e[3], e[2]]);
        elements.push(s.pixels(&[samples(1), samples(2)], 2));
        load(&folder.file("b.dcm", &s.file(&elements)))
    };
    assert!(with(1, s.text(0x0028_0004, b"CS", "MONOCHROME2")).is_ok());
    for (element, said) in [
        (s.short(0x0028_0100, 1), "its samples have 12 of 1 bits"),
        (s.text(0x0028_0004, b"CS", "PALETTE COLOR"), "PALETTE COLOR of 1 samples"),
        (s.text(0x0028_0008, b"IS", "70000"), "it has 70000 frames"),
        (s.text(0x0028_0008, b"IS", "60000"), "do not fit into its 48 bytes of pixels"),
        (s.short(0x0028_0011, 65535), "do not fit into its 48 bytes"),
    ] {
        let error = with(1, element).expect_err("it is refused");
        assert!(error.contains(said), "{error}");
    }
    let limits = Limits { max_bytes: 300 };
    let path = folder.file("frames.dcm", &frames(Syntax::Explicit, false));
    assert!(load_volume(&path, &VolumeRequest { limits, ..Default::default() }).is_err());
}

#[test]
fn cut_files_have_one_error() {
    let folder = Folder::new();
    for syntax in SYNTAXES {
        let whole = frames(syntax, syntax != Syntax::Deflated);
        for length in 0..whole.len() {
            let error = load(&folder.file("cut.dcm", &whole[..length])).expect_err("it is cut");
            assert_eq!(error.lines().count(), 1, "{syntax:?} {length}");
        }
    }
}

#[test]
fn sequences_in_sequences_end() {
    let folder = Folder::new();
    let s = Syntax::Explicit;
    let mut deep = s.text(0x0008_1155, b"UI", "1");
    for _ in 0..60 {
        deep = s.sequence(0x0008_1140, &[deep], true);
    }
    let error = load(&folder.file("deep.dcm", &s.file(&[deep]))).expect_err("too deep");
    assert!(error.contains("16 sequences in each other"), "{error}");
}
