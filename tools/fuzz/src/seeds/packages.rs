//! Packed files.

use super::vectors::gpx;
use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Bytes as gzip.
pub(super) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut out = GzEncoder::new(Vec::new(), Compression::fast());
    out.write_all(bytes).and_then(|()| out.finish()).expect("memory")
}

/// Bytes as zlib.
pub(super) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut out = ZlibEncoder::new(Vec::new(), Compression::fast());
    out.write_all(bytes).and_then(|()| out.finish()).expect("memory")
}

fn zip(entries: &[(&str, &[u8])], method: CompressionMethod) -> Vec<u8> {
    let mut out = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        out.start_file(*name, SimpleFileOptions::default().compression_method(method)).expect("memory");
        out.write_all(bytes).expect("memory");
    }
    out.finish().expect("memory").into_inner()
}

/// A track as gzip.
pub fn gzips() -> Vec<Vec<u8>> {
    gpx().iter().map(|bytes| gzip(bytes)).collect()
}

/// A track as ZIP: stored, packed, in a folder, within another ZIP.
pub fn zips() -> Vec<Vec<u8>> {
    let way = &gpx()[0];
    let stored = zip(&[("a.gpx", way)], CompressionMethod::Stored);
    let packed = zip(&[("notes.txt", b"a seed"), ("ways/a.gpx", way)], CompressionMethod::Deflated);
    let nested = zip(&[("inner.zip", &stored)], CompressionMethod::Deflated);
    vec![stored, packed, nested]
}
