//! STL, text and binary.

use super::MeshFile;
use crate::text::text_of;
use crate::{IoError, Limits, Loaded};
use belvedere_core::{Warning, WarningKind};
use glam::DVec3;
use std::path::Path;

/// Bytes before the triangles of a binary file, and of a triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;
/// Bytes of a text in which its first facet is looked for; names of solids may be long.
const TEXT_HEAD: usize = 4096;

/// Numbers of triangles that stand for an unknown one.
const UNCOUNTED: [usize; 2] = [0, u32::MAX as usize];

type Triangle = [[f32; 3]; 3];

/// The text of a file in UTF-16, by its byte order mark.
fn wide(bytes: &[u8]) -> Option<Vec<u8>> {
    matches!(bytes, [0xff, 0xfe, _, 0, ..] | [0xfe, 0xff, 0, ..]).then(|| text_of(bytes, &mut Vec::new()).into_bytes())
}

pub(super) fn read(path: &Path, bytes: &[u8], _: &Limits) -> Result<Loaded<MeshFile>, IoError> {
    let decoded = wide(bytes);
    let bytes = decoded.as_deref().unwrap_or(bytes);
    let bad = |reason: String| IoError::format(path, reason);
    // Many binary files begin with the word that marks text: the size tells.
    let declared = bytes.get(80..HEAD).and_then(|b| b.try_into().ok()).map_or(0, |b| u32::from_le_bytes(b) as usize);
    let is_binary = bytes.len() >= HEAD && bytes.len() - HEAD == declared.saturating_mul(TRIANGLE);
    let mut warnings = Vec::new();
    let triangles = if is_binary {
        binary(&bytes[HEAD..])
    } else if is_text(bytes) {
        let (triangles, is_cut) = text(bytes).map_err(bad)?;
        if is_cut {
            let count = triangles.len();
            let text = format!("it ends without endsolid, so it is cut off; the {count} triangles before are read");
            warnings.push(Warning::new(WarningKind::Repaired, text).with("triangles", count as f64).in_file(path));
        }
        triangles
    } else {
        let room = bytes.len().saturating_sub(HEAD);
        let whole = room / TRIANGLE;
        let uncounted = whole > 0 && room.is_multiple_of(TRIANGLE) && UNCOUNTED.contains(&declared);
        if uncounted {
            let text = format!(
                "it states {declared} triangles, as programs do that do not know the number beforehand; the {whole} in it are read"
            );
            warnings.push(Warning::new(WarningKind::Repaired, text).with("triangles", whole as f64).in_file(path));
            return Ok(Loaded::new(joined(&binary(&bytes[HEAD..])), warnings));
        }
        if whole == 0 || whole < declared {
            return Err(bad(format!(
                "it declares {declared} triangles and has room for {whole}; it is truncated or no STL file, get it again"
            )));
        }
        let rest = bytes.len() - HEAD - declared * TRIANGLE;
        let text = format!("{rest} bytes after the {declared} triangles are ignored");
        warnings.push(Warning::new(WarningKind::Ignored, text).with("bytes", rest as f64).in_file(path));
        binary(&bytes[HEAD..HEAD + declared * TRIANGLE])
    };
    Ok(Loaded::new(joined(&triangles), warnings))
}

/// Whether a file that is not as long as its binary header says is text: "solid" first, in any case and perhaps after comments, and a
/// facet or the end soon after.
fn is_text(bytes: &[u8]) -> bool {
    let mut bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    while let Some(comment) = bytes.strip_prefix(b"#").or_else(|| bytes.strip_prefix(b"//")) {
        let end = comment.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(comment.len());
        bytes = comment[end..].trim_ascii_start();
    }
    let head = bytes[..bytes.len().min(TEXT_HEAD)].to_ascii_lowercase();
    let holds = |word: &[u8]| head.windows(word.len()).any(|w| w == word);
    head.starts_with(b"solid") && !head.contains(&0) && (holds(b"facet") || holds(b"endsolid"))
}

/// Triangles of a text, and whether it ends too early: the vertices of each loop. Words count in any case; what stands on the line of
/// `solid` is its name.
fn text(bytes: &[u8]) -> Result<(Vec<Triangle>, bool), String> {
    let (mut out, mut corners): (Vec<Triangle>, Vec<[f32; 3]>) = (Vec::new(), Vec::new());
    let mut is_closed = false;
    let mut lines = bytes.split(|b| matches!(b, b'\n' | b'\r')).enumerate().peekable();
    while let Some((k, line)) = lines.next() {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        // Some writers put a whole facet on one line.
        while let Some(word) = words.next() {
            let is = |name: &[u8]| word.eq_ignore_ascii_case(name);
            if is(b"solid") || is(b"endsolid") || word.starts_with(b"#") || word.starts_with(b"//") {
                is_closed |= is(b"endsolid");
                break;
            }
            is_closed = false;
            if is(b"vertex") {
                let mut number = || number(std::str::from_utf8(words.next()?).ok()?);
                let corner = [number(), number(), number()];
                let [Some(x), Some(y), Some(z)] = corner else {
                    if lines.peek().is_none() && !out.is_empty() {
                        return Ok((out, true));
                    }
                    return Err(format!("the vertex on line {} has no three numbers; it is damaged", k + 1));
                };
                corners.push([x, y, z]);
            } else if is(b"endloop") || is(b"endfacet") {
                if matches!(corners.len(), 1 | 2) {
                    return Err(format!("the facet that ends on line {} has no three vertices; it is damaged", k + 1));
                }
                out.extend(corners.windows(2).skip(1).map(|w| [corners[0], w[0], w[1]]));
                corners.clear();
            }
        }
    }
    if out.is_empty() && !corners.is_empty() {
        return Err("it ends inside its first facet; it is cut off, get it again".into());
    }
    Ok((out, !is_closed))
}

/// A number, with a decimal point or comma.
fn number(word: &str) -> Option<f32> {
    word.parse().ok().or_else(|| word.replacen(',', ".", 1).parse().ok())
}

fn binary(bytes: &[u8]) -> Vec<Triangle> {
    let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let position = |b: &[u8]| [number(&b[0..4]), number(&b[4..8]), number(&b[8..12])];
    bytes.chunks_exact(TRIANGLE).map(|t| [position(&t[12..24]), position(&t[24..36]), position(&t[36..48])]).collect()
}

/// Corners at exactly the same position become one vertex.
fn joined(triangles: &[Triangle]) -> MeshFile {
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
