//! STL, text and binary.

use super::MeshFile;
use crate::{IoError, Limits, Loaded};
use glam::DVec3;
use std::io::Cursor;
use std::path::Path;

/// Bytes before the triangles of a binary file, and of a triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

pub(super) fn read(path: &Path, bytes: &[u8], _: &Limits) -> Result<Loaded<MeshFile>, IoError> {
    let bad = |reason: String| IoError::format(path, reason);
    // Many binary files begin with the word that marks text: the size tells.
    let declared = bytes.get(80..HEAD).and_then(|b| b.try_into().ok()).map_or(0, |b| u32::from_le_bytes(b) as usize);
    let is_binary = bytes.len() >= HEAD && bytes.len() - HEAD == declared.saturating_mul(TRIANGLE);
    let text = bytes.trim_ascii_start();
    let mut warnings = Vec::new();
    let triangles = if is_binary {
        binary(&bytes[HEAD..])
    } else if text.starts_with(b"solid") {
        let mut text = Cursor::new(text);
        let mesh = stl_io::read_stl(&mut text).map_err(|e| bad(format!("{e}; it is damaged or no STL file")))?;
        let corner = |i: usize| mesh.vertices[i].0;
        mesh.faces.iter().map(|f| f.vertices.map(corner)).collect()
    } else {
        let whole = bytes.len().saturating_sub(HEAD) / TRIANGLE;
        if whole == 0 || whole < declared {
            return Err(bad(format!(
                "it declares {declared} triangles and has room for {whole}; it is truncated or no STL file, get it again"
            )));
        }
        warnings.push(format!(
            "{}: {} bytes after the {declared} triangles are ignored",
            path.display(),
            bytes.len() - HEAD - declared * TRIANGLE
        ));
        binary(&bytes[HEAD..HEAD + declared * TRIANGLE])
    };
    Ok(Loaded::new(joined(&triangles), warnings))
}

fn binary(bytes: &[u8]) -> Vec<[[f32; 3]; 3]> {
    let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let position = |b: &[u8]| [number(&b[0..4]), number(&b[4..8]), number(&b[8..12])];
    bytes.chunks_exact(TRIANGLE).map(|t| [position(&t[12..24]), position(&t[24..36]), position(&t[36..48])]).collect()
}

/// Corners at exactly the same position become one vertex.
fn joined(triangles: &[[[f32; 3]; 3]]) -> MeshFile {
    let mut out = MeshFile { format: "STL", ..MeshFile::default() };
    let mut known = std::collections::HashMap::new();
    for triangle in triangles {
        out.triangles.push(triangle.map(|p| {
            let next = out.positions.len() as u32;
            *known.entry(p.map(f32::to_bits)).or_insert_with(|| {
                out.positions.push(DVec3::from_array(p.map(f64::from)));
                next
            })
        }));
    }
    out
}
