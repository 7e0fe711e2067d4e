//! Arrays of NumPy and density maps (MRC).

use crate::support_files::Folder;
use belvedere_io::{Number, VolumeFile, VolumeRequest, load_volume};
use flate2::Compression;
use flate2::write::GzEncoder;
use glam::{DMat3, DVec3};
use std::io::Write;
use std::path::Path;

fn load(path: &Path) -> Result<(VolumeFile, Vec<String>), String> {
    let loaded = load_volume(path, &VolumeRequest::default()).map_err(|e| e.to_string())?;
    Ok((loaded.value, loaded.warnings.iter().map(|w| w.text().to_owned()).collect()))
}

/// Values 7, 9, ... of 3 x 4 x 5 voxels.
fn is_expected(file: &VolumeFile) {
    assert_eq!(file.dims, [3, 4, 5]);
    let found: Vec<f32> = (0..file.values.len()).map(|i| file.values.at(i)).collect();
    assert_eq!(found, (0..60).map(|i| 7.0 + 2.0 * i as f32).collect::<Vec<_>>(), "{:?}", file.stored);
}

/// Bytes of a whole number below 2048 in a type of NumPy, little-endian.
fn sample(kind: &str, v: u16) -> Vec<u8> {
    match kind {
        "u1" => vec![v as u8],
        "i1" => vec![v as i8 as u8],
        "u2" | "i2" => v.to_le_bytes().to_vec(),
        "u4" | "i4" => u32::from(v).to_le_bytes().to_vec(),
        "u8" | "i8" => u64::from(v).to_le_bytes().to_vec(),
        "f2" => {
            let exponent = 15 - v.leading_zeros() as u16;
            let mantissa = (u32::from(v) << (10 - exponent)) as u16 & 1023;
            ((exponent + 15) << 10 | mantissa).to_le_bytes().to_vec()
        }
        "f4" => f32::from(v).to_le_bytes().to_vec(),
        _ => f64::from(v).to_le_bytes().to_vec(),
    }
}

/// The 60 values, with x fastest or with z fastest.
fn samples(kind: &str, big_endian: bool, fortran: bool) -> Vec<u8> {
    let at = |i: u16| if fortran { (i % 5) * 12 + (i / 5 % 4) * 3 + i / 20 } else { i };
    let bytes = |i: u16| {
        let mut bytes = sample(kind, 7 + 2 * at(i));
        if big_endian {
            bytes.reverse();
        }
        bytes
    };
    (0..60).flat_map(bytes).collect()
}

fn npy(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let mut out = [b"\x93NUMPY".as_slice(), &[version, 0]].concat();
    match version {
        1 => out.extend((header.len() as u16).to_le_bytes()),
        _ => out.extend((header.len() as u32).to_le_bytes()),
    }
    out.extend(header.as_bytes());
    out.extend(data);
    out
}

#[test]
fn arrays_in_every_type_order_and_version() {
    let folder = Folder::new();
    let kinds = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8"];
    for (i, kind) in kinds.iter().enumerate() {
        for (big_endian, fortran) in [(false, false), (true, false), (false, true), (true, true)] {
            let sign = if big_endian { '>' } else { '<' };
            let order = if fortran { "True" } else { "False" };
            let header =
                format!("{{'descr': '{sign}{kind}', 'fortran_order': {order}, 'shape': (5, 4, 3), }}          \n");
            let bytes = npy(1 + (i % 3) as u8, &header, &samples(kind, big_endian, fortran));
            let name = if fortran { "a.npy" } else { "without_an_ending" };
            let (file, warnings) = load(&folder.file(name, &bytes)).expect("it is read");
            is_expected(&file);
            assert_eq!(file.axes, DMat3::IDENTITY);
            assert!(warnings.iter().any(|w| w.contains("states no spacing; 1 along each axis")), "{warnings:?}");
        }
    }
}

#[test]
fn other_arrays_are_refused_by_what_they_are() {
    let folder = Folder::new();
    let of = |descr: &str, shape: &str| {
        let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': ({shape}), }}\n");
        load(&folder.file("b.npy", &npy(1, &header, &[0; 480]))).expect_err("it is refused")
    };
    for (descr, shape, said) in [
        ("'<f8'", "12, 5", "its shape is (12, 5), a volume has 3 dimensions"),
        ("'<f8'", "60,", "its shape is (60), a volume of single values has 3"),
        ("'<f8'", "", "its shape is ()"),
        ("'<f4'", "2, 5, 4, 3", "save one part of it, such as a[0]"),
        ("'<f8'", "5, 0, 3", "holds no values"),
        ("'<f8'", "1000000000000, 1000000, 1000000", "declares"),
        ("'<f8'", "1000000, 1000000, 1000000", "it is cut off"),
        ("'<f8'", "99999999999999999999999, 4, 3", "no shape that can be read"),
        ("'<c16'", "5, 4, 3", "complex numbers"),
        ("'|O'", "5, 4, 3", "objects of Python"),
        ("[('a', '<f4')]", "5, 4, 3", "several fields"),
    ] {
        let error = of(descr, shape);
        assert!(error.contains(said), "{error}");
    }
    let header = "{'descr': '<i2', 'fortran_order': True, 'shape': (5, 4, 3), }\n";
    let whole = npy(2, header, &samples("i2", false, true));
    for length in 0..whole.len() {
        assert!(load(&folder.file("cut.npy", &whole[..length])).is_err(), "{length}");
    }
    let huge = [b"\x93NUMPY\x02\0".as_slice(), &[0xff; 4], b"{'descr'"].concat();
    assert!(load(&folder.file("huge.npy", &huge)).expect_err("huge").contains("its header has 4294967295 bytes"));
}

/// Words of a header, counted from 1, over a usual one.
fn mrc(big_endian: bool, words: &[(usize, i32)], extended: usize, data: &[u8]) -> Vec<u8> {
    let mut header = vec![0u8; 1024];
    let real = |v: f32| v.to_bits() as i32;
    let usual = [
        (1, 3),
        (2, 4),
        (3, 5),
        (4, 2),
        (8, 3),
        (9, 4),
        (10, 5),
        (11, real(6.0)),
        (12, real(12.0)),
        (13, real(20.0)),
        (14, real(90.0)),
        (15, real(90.0)),
        (16, real(90.0)),
        (17, 1),
        (18, 2),
        (19, 3),
        (23, 1),
        (24, extended as i32),
    ];
    for (word, value) in usual.iter().chain(words) {
        let bytes = if big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        header[4 * (word - 1)..4 * word].copy_from_slice(&bytes);
    }
    header[208..212].copy_from_slice(b"MAP ");
    header[212..214].copy_from_slice(if big_endian { &[0x11, 0x11] } else { &[0x44, 0x44] });
    [header, vec![0xee; extended], data.to_vec()].concat()
}

#[test]
fn maps_in_every_mode_and_order() {
    let folder = Folder::new();
    for (mode, kind, number) in [
        (0, "i1", Number::Int8),
        (1, "i2", Number::Int16),
        (2, "f4", Number::Float32),
        (6, "u2", Number::UInt16),
        (12, "f2", Number::Float16),
    ] {
        for big_endian in [false, true] {
            let bytes = mrc(big_endian, &[(4, mode)], 80, &samples(kind, big_endian, false));
            for name in ["a.mrc", "a.map", "a.ccp4", "a.rec", "without_an_ending"] {
                let (file, warnings) = load(&folder.file(name, &bytes)).expect("it is read");
                is_expected(&file);
                assert_eq!((file.stored, warnings.len()), (number, 0), "{warnings:?}");
                assert_eq!(file.axes, DMat3::from_diagonal(DVec3::new(2.0, 3.0, 4.0)));
                assert_eq!(file.origin, DVec3::ZERO);
            }
            let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(&bytes).expect("memory");
            is_expected(&load(&folder.file("b.map.gz", &encoder.finish().expect("memory"))).expect("it is read").0);
        }
    }
    // A file without a stamp, and bytes that IMOD calls unsigned.
    let mut bytes = mrc(true, &[(4, 1)], 0, &samples("i2", true, false));
    bytes[208..216].fill(0);
    is_expected(&load(&folder.file("old.mrc", &bytes)).expect("it is read").0);
    let bytes = mrc(false, &[(4, 0), (39, 1_146_047_817)], 0, &samples("u1", false, false));
    assert_eq!(load(&folder.file("imod.mrc", &bytes)).expect("it is read").0.stored, Number::UInt8);
}

#[test]
fn maps_lie_where_their_header_says() {
    let folder = Folder::new();
    let data = samples("f4", false, false);
    let real = |v: f32| v.to_bits() as i32;
    let place = |words: &[(usize, i32)]| {
        let (file, warnings) = load(&folder.file("p.mrc", &mrc(false, words, 0, &data))).expect("it is read");
        is_expected(&file);
        (file.axes, file.origin, warnings)
    };
    // Columns run along z, rows along x, sections along y; the cell has 10 x 20 x 30 intervals.
    let words = [(17, 3), (18, 1), (19, 2), (8, 10), (9, 20), (10, 30), (13, real(90.0)), (5, 2), (6, -1), (7, 4)];
    let (axes, origin, _) = place(&words);
    let want = DMat3::from_cols(3.0 * DVec3::Z, DVec3::new(6.0 / 10.0, 0.0, 0.0), DVec3::new(0.0, 12.0 / 20.0, 0.0));
    assert!(axes.abs_diff_eq(want, 1e-6), "{axes}");
    assert!(origin.abs_diff_eq(DVec3::new(-0.6, 2.4, 6.0), 1e-6), "{origin}");
    // An origin goes before starts.
    let (_, origin, _) = place(&[(5, 7), (50, real(1.0)), (51, real(-2.0)), (52, real(0.5))]);
    assert_eq!(origin, DVec3::new(1.0, -2.0, 0.5));
    // Edges of a monoclinic cell.
    let (axes, ..) = place(&[(15, real(120.0))]);
    assert!(axes.z_axis.abs_diff_eq(4.0 * DVec3::new(-0.5, 0.0, 0.75f64.sqrt()), 1e-5), "{axes}");
    let (axes, _, warnings) = place(&[(11, 0)]);
    assert_eq!(axes, DMat3::IDENTITY);
    assert!(warnings[0].contains("no size of its cell"), "{warnings:?}");
    // Two volumes in one file.
    let bytes = mrc(false, &[(3, 10), (23, 401)], 0, &[data.clone(), data.clone()].concat());
    let (file, warnings) = load(&folder.file("two.mrc", &bytes)).expect("it is read");
    is_expected(&file);
    assert!(warnings[0].contains("it has 2 volumes; the first is taken"), "{warnings:?}");
}

#[test]
fn odd_maps_are_refused() {
    let folder = Folder::new();
    let data = samples("f4", false, false);
    for (words, said) in [
        (&[(1, 0)][..], "0 x 4 x 5, they must be greater than 0"),
        (&[(2, -4)], "3 x -4 x 5"),
        (&[(1, i32::MAX), (2, i32::MAX), (3, i32::MAX)], "it is cut off"),
        (&[(4, 4)], "complex numbers (mode 4)"),
        (&[(4, 99)], "unknown kind (mode 99)"),
        (&[(18, 1)], "its axes are [1, 1, 3]"),
        (&[(24, -1)], "extended header has -1 bytes"),
        (&[(24, i32::MAX)], "extended header has 2147483647 bytes"),
    ] {
        let error = load(&folder.file("odd.mrc", &mrc(false, words, 0, &data))).expect_err("it is refused");
        assert!(error.contains(said), "{error}");
    }
    let whole = mrc(false, &[], 16, &data);
    for length in 0..whole.len() {
        assert!(load(&folder.file("cut.mrc", &whole[..length])).is_err(), "{length}");
    }
}
