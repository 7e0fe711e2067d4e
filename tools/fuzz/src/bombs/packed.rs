//! Packed files that expand to much.

use super::Bomb;
use flate2::write::{GzEncoder, ZlibEncoder};
use flate2::{Compression, Crc};
use std::fmt::Write as _;
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Files that expand to a quarter of `most` bytes and to `most`.
pub(super) fn all(most: usize) -> Vec<Bomb> {
    let mut out = Vec::new();
    for bytes in [most / 4, most] {
        let mib = bytes >> 20;
        let side = (bytes as f64).sqrt() as usize;
        out.push(Bomb::new(format!("zeros_{mib}.hgt.gz"), gzip(|to| zeros(to, (side / 2).pow(2) * 2))));
        out.push(Bomb::new(format!("zeros_{mib}.asc.gz"), gzip(|to| ascii(to, bytes))));
        out.push(Bomb::new(format!("zeros_{mib}.png"), png(side)));
        out.push(Bomb::new(format!("blanks_{mib}.gpx.gz"), gzip(|to| blanks(to, bytes, b"<gpx>", b"</gpx>"))));
        out.push(Bomb::new(format!("blanks_{mib}.geojson.gz"), gzip(|to| blanks(to, bytes, b"[", b"]"))));
        out.push(Bomb::new(format!("points_{mib}.geojson.gz"), gzip(|to| points(to, bytes))));
        out.push(Bomb::new(format!("atoms_{mib}.pdb.gz"), gzip(|to| atoms(to, bytes))));
        out.push(Bomb::new(format!("zeros_{mib}.nrrd"), nrrd(bytes)));
        out.push(Bomb::new(format!("zeros_{mib}.nii.gz"), gzip(|to| nifti(to, bytes))));
        out.push(Bomb::new(
            format!("zeros_{mib}.zip"),
            zip(|to| {
                to.start_file("a.hgt", SimpleFileOptions::default()).expect("memory");
                zeros(to, bytes);
            }),
        ));
    }
    out.push(Bomb::new(
        "many.zip",
        zip(|to| {
            (0..20_000).for_each(|k| to.start_file(format!("{k}.txt"), SimpleFileOptions::default()).expect("memory"));
        }),
    ));
    let mut inner = gzip(|to| zeros(to, most / 4));
    for _ in 0..6 {
        inner = gzip(|to| to.write_all(&inner).expect("memory"));
    }
    out.push(Bomb::new("within_within.hgt.gz", inner));
    out
}

/// So many zeros as zlib.
pub(super) fn zlib_zeros(bytes: usize) -> Vec<u8> {
    let mut out = ZlibEncoder::new(Vec::new(), Compression::best());
    zeros(&mut out, bytes);
    out.finish().expect("memory")
}

fn gzip(write: impl FnOnce(&mut GzEncoder<Vec<u8>>)) -> Vec<u8> {
    let mut out = GzEncoder::new(Vec::new(), Compression::default());
    write(&mut out);
    out.finish().expect("memory")
}

fn zip(write: impl FnOnce(&mut ZipWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut out = ZipWriter::new(Cursor::new(Vec::new()));
    write(&mut out);
    out.finish().expect("memory").into_inner()
}

fn repeat(to: &mut impl Write, byte: u8, mut bytes: usize) {
    let part = vec![byte; 1 << 20];
    while bytes > 0 {
        let n = bytes.min(part.len());
        to.write_all(&part[..n]).expect("memory");
        bytes -= n;
    }
}

fn zeros(to: &mut impl Write, bytes: usize) {
    repeat(to, 0, bytes);
}

fn blanks(to: &mut impl Write, bytes: usize, before: &[u8], after: &[u8]) {
    to.write_all(before).expect("memory");
    repeat(to, b' ', bytes);
    to.write_all(after).expect("memory");
}

/// A grid of zeros as text.
fn ascii(to: &mut impl Write, bytes: usize) {
    let side = ((bytes / 2) as f64).sqrt() as usize;
    writeln!(to, "ncols {side}\nnrows {side}\nxllcorner 0\nyllcorner 0\ncellsize 10").expect("memory");
    let row = "0 ".repeat(side) + "\n";
    (0..side).for_each(|_| to.write_all(row.as_bytes()).expect("memory"));
}

/// A line of points.
fn points(to: &mut impl Write, bytes: usize) {
    to.write_all(b"{\"type\":\"LineString\",\"coordinates\":[[0,0]").expect("memory");
    let part = ",[1,1],[0,0]".repeat(1000);
    (0..bytes / part.len()).for_each(|_| to.write_all(part.as_bytes()).expect("memory"));
    to.write_all(b"]}").expect("memory");
}

/// Atoms on a lattice.
fn atoms(to: &mut impl Write, bytes: usize) {
    let mut lines = String::new();
    for k in 0..300 {
        let [x, y, z] = [k % 10, k / 10 % 10, k / 100].map(|n| 4.0 * f64::from(n));
        writeln!(lines, "ATOM  {k:>5}  CA  ALA A{:>4}    {x:>8.3}{y:>8.3}{z:>8.3}  1.00  0.00           C  ", k % 9999)
            .expect("memory");
    }
    (0..bytes / lines.len()).for_each(|_| to.write_all(lines.as_bytes()).expect("memory"));
}

fn nrrd(bytes: usize) -> Vec<u8> {
    let side = (bytes as f64).cbrt() as usize;
    let head = format!("NRRD0004\ntype: uint8\ndimension: 3\nsizes: {side} {side} {side}\nencoding: gzip\n\n");
    [head.into_bytes(), gzip(|to| zeros(to, side.pow(3)))].concat()
}

fn nifti(to: &mut impl Write, bytes: usize) {
    let side = (bytes as f64).cbrt() as usize;
    let mut head = [0u8; 352];
    head[..4].copy_from_slice(&348i32.to_le_bytes());
    for (k, n) in [3, side as i16, side as i16, side as i16, 1, 1, 1, 1].into_iter().enumerate() {
        head[40 + 2 * k..42 + 2 * k].copy_from_slice(&n.to_le_bytes());
    }
    // Unsigned bytes, voxels of a millimetre, values behind the head.
    head[70..72].copy_from_slice(&2i16.to_le_bytes());
    head[72..74].copy_from_slice(&8i16.to_le_bytes());
    (0..4).for_each(|k| head[76 + 4 * k..80 + 4 * k].copy_from_slice(&1f32.to_le_bytes()));
    head[108..112].copy_from_slice(&352f32.to_le_bytes());
    head[344..348].copy_from_slice(b"n+1\0");
    to.write_all(&head).expect("memory");
    zeros(to, side.pow(3));
}

/// A black square.
fn png(side: usize) -> Vec<u8> {
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8], data: &[u8]| {
        out.extend((data.len() as u32).to_be_bytes());
        let mut crc = Crc::new();
        crc.update(kind);
        crc.update(data);
        out.extend([kind, data].concat());
        out.extend(crc.sum().to_be_bytes());
    };
    let size = (side as u32).to_be_bytes();
    chunk(b"IHDR", &[&size[..], &size, &[8, 0, 0, 0, 0]].concat());
    chunk(b"IDAT", &zlib_zeros(side * (side + 1)));
    chunk(b"IEND", b"");
    out
}
