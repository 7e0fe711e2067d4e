//! Memory of loaders: what adds up, what is shared, what is packed.

use belvedere_io::png::{self, Channels};
use belvedere_io::{GeoTiff, Limits, Samples, VolumeRequest, load_mesh, load_molecule, load_volume};
use belvedere_scene::Progress;
use flate2::{Compression, write::GzEncoder};
use std::io::Write;

/// A file of tiles of 16 x 16 bytes, all of which, but for every `left_out`th, lie at one place.
fn of_one_tile(cols: u32, rows: u32, left_out: usize) -> Vec<u8> {
    let tile: Vec<u8> = (0..=255).collect();
    let tiles = (cols.div_ceil(16) * rows.div_ceil(16)) as usize;
    let at = |i: usize| if left_out > 0 && i.is_multiple_of(left_out) { 0 } else { 8u32 };
    let long = |value: u32| (4u16, 1u32, value);
    let short = |value: u32| (3u16, 1u32, value);
    let lists = 8 + 256;
    let offsets = (4u16, tiles as u32, lists);
    let counts = (4u16, tiles as u32, lists + 4 * tiles as u32);
    let entries = [
        (256u16, long(cols)),
        (257, long(rows)),
        (258, short(8)),
        (259, short(1)),
        (262, short(1)),
        (277, short(1)),
        (322, long(16)),
        (323, long(16)),
        (324, offsets),
        (325, counts),
    ];
    let mut out = b"II*\0".to_vec();
    out.extend((lists + 8 * tiles as u32).to_le_bytes());
    out.extend(tile);
    (0..tiles).for_each(|i| out.extend(at(i).to_le_bytes()));
    (0..tiles).for_each(|_| out.extend(256u32.to_le_bytes()));
    out.extend((entries.len() as u16).to_le_bytes());
    for (tag, (kind, count, value)) in entries {
        out.extend(tag.to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(count.to_le_bytes());
        out.extend(value.to_le_bytes());
    }
    out.extend(0u32.to_le_bytes());
    out
}

#[test]
fn tiles_at_one_place_are_what_they_would_be_apart() {
    for (cols, rows, left_out) in [(200u32, 170u32, 0), (200, 170, 3), (16, 500, 2), (20, 7, 0)] {
        let file =
            GeoTiff::from_bytes("one.tif", of_one_tile(cols, rows, left_out), Limits::default()).expect("opened");
        let raster = file.value.read(0, &Progress::silent()).expect("read");
        let Samples::U8(samples) = raster.samples else { panic!("bytes") };
        let across = cols.div_ceil(16) as usize;
        for (i, sample) in samples.iter().enumerate() {
            let (c, r) = (i % cols as usize, i / cols as usize);
            let is_out = left_out > 0 && (r / 16 * across + c / 16).is_multiple_of(left_out);
            let wanted = if is_out { 0 } else { (r % 16 * 16 + c % 16) as u8 };
            assert_eq!(*sample, wanted, "column {c}, row {r} of {cols} x {rows}");
        }
    }
}

#[test]
fn a_raster_is_refused_before_it_is_decoded() {
    let limits = Limits { max_bytes: 1 << 20 };
    let file = GeoTiff::from_bytes("one.tif", of_one_tile(4096, 4096, 0), limits).expect("opened");
    let error = file.value.read(0, &Progress::silent()).expect_err("too large").to_string();
    assert!(error.contains("the raster needs") && error.contains("more than 1 MiB"), "{error}");
    let part = file.value.read_window(0, 0..64, 0..64, &Progress::silent()).expect("a part fits");
    assert_eq!(part.info.width, 64);
}

/// Each picture fits, their sum does not.
#[test]
fn pictures_of_a_mesh_add_up() {
    let folder = tempfile::tempdir().expect("folder");
    let count = 6;
    let (mut materials, mut text) = (String::new(), "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned());
    for i in 0..count {
        let path = folder.path().join(format!("{i}.png"));
        png::write(&path, false, 256, 256, Channels::Gray, &vec![7; 256 * 256], &[]).expect("written");
        materials += &format!("newmtl m{i}\nKd 1 1 1\nmap_Kd {i}.png\n");
        text += &format!("usemtl m{i}\nf 1 2 3\n");
    }
    std::fs::write(folder.path().join("m.mtl"), materials).expect("written");
    let path = folder.path().join("m.obj");
    std::fs::write(&path, text).expect("written");
    let read = |kib: u64| load_mesh(&path, &Limits { max_bytes: kib << 10 });
    // 768 KiB for the one in work, 384 KiB for each that is held.
    let whole = read(768 + 384 * count).expect("fits").value;
    assert_eq!(whole.texturing.expect("pictures").textures.len(), count as usize);
    let error = read(768 + 384).expect_err("too large").to_string();
    assert!(error.contains("m.obj: picture") && error.contains("allow more memory"), "{error}");
}

#[test]
fn packed_files_are_decoded_no_further_than_memory_allows() {
    let folder = tempfile::tempdir().expect("folder");
    let packed = |head: &[u8], unit: &[u8], count: usize| {
        let mut out = GzEncoder::new(Vec::new(), Compression::best());
        out.write_all(head).expect("packed");
        (0..count).for_each(|_| out.write_all(unit).expect("packed"));
        out.finish().expect("packed")
    };
    let limits = Limits { max_bytes: 2 << 20 };
    let atom = b"ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00  0.00           C  \n";
    let path = folder.path().join("a.pdb.gz");
    std::fs::write(&path, packed(b"", atom, 100_000)).expect("written");
    let error = load_molecule(&path, &limits).expect_err("too large").to_string();
    assert!(error.contains("more than 2 MiB") && error.contains("allow more memory"), "{error}");
    let head = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 256 256 128\nencoding: gzip\n\n";
    let path = folder.path().join("a.nrrd");
    std::fs::write(&path, [&head[..], &packed(b"", &[0; 1 << 16], 128)].concat()).expect("written");
    let error = load_volume(&path, &VolumeRequest { limits, ..Default::default() }).expect_err("too large").to_string();
    assert!(error.contains("the volume needs 8 MiB") && error.contains("more than 2 MiB"), "{error}");
    let limits = Limits { max_bytes: 9 << 20 };
    assert!(load_volume(&path, &VolumeRequest { limits, ..Default::default() }).is_ok());
}

/// A packed file of 2^40 bytes, of which the disk holds one block.
#[test]
fn packed_files_ask_before_they_are_read() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("huge.pdb.gz");
    let mut file = std::fs::File::create(&path).expect("created");
    file.write_all(b"\x1f\x8b\x08\0").expect("written");
    // There is no such file on a disk without sparse files.
    let Ok(()) = file.set_len(1 << 40) else { return };
    let error = load_molecule(&path, &Limits::default()).expect_err("too large").to_string();
    assert!(error.contains("the packed file needs 1048576 MiB") && error.contains("allow more memory"), "{error}");
}
